/* SPDX-License-Identifier: MIT */
/* Arguments that no caller should give, found by c_api/fuzz/calls.c: they are refused, and nothing is written. */
#include "check.h"
#include "seal.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { n = 100 };
static double x[n];

/* Arrays of doubles at an odd address. */
static void test_odd_addresses(void) {
  static unsigned char room[(n + 1) * sizeof(double)];
  const double *odd = (const double *)(const void *)(room + 3);
  double *place = (double *)(void *)(room + 5), acf[5];
  gyroakf_kpss kpss;
  gyroakf_filter *f;
  gyroakf_drift_model model;
  int32_t order;
  memcpy(room + 3, x, sizeof x);
  check_failure(gyroakf_kpss_test(odd, n, NULL, &kpss, &err), GYROAKF_INVALID_ARGUMENT, "odd address of a series");
  check_failure(gyroakf_ar_fit(x, n, NULL, 2, &order, place, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "odd address of phi");
  check_failure(gyroakf_filter_new(1, odd, 1.0, 1.0, NULL, &f, &err), GYROAKF_INVALID_ARGUMENT, "odd address of coefficients");
  check(f == NULL, "no filter");
  check_success(gyroakf_filter_new(0, NULL, 1.0, 1.0, NULL, &f, &err), "a filter");
  check_failure(gyroakf_filter_run(f, x, n, place, &err), GYROAKF_INVALID_ARGUMENT, "odd address of estimates");
  check_failure(gyroakf_filter_run(f, odd, 9, acf, &err), GYROAKF_INVALID_ARGUMENT, "odd address of measurements");
  gyroakf_filter_free(f);
  gyroakf_drift_model_init(&model);
  model.count = model.slow[0] = 1;
  model.phi[0] = model.q[0] = model.r = 0.5;
  check_failure(gyroakf_drift_smooth(&model, x, n, place, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "odd address of a drift");
  check(memcmp(room + 3, x, sizeof x) == 0, "nothing was written");
}

/* Values near the largest number, and so small that no square is a number: results that would be infinite or no numbers. */
static void test_overflow(void) {
  double huge[n], phi[2];
  int32_t order;
  gyroakf_allan *a;
  gyroakf_drift_model drift;
  int i;
  for (i = 0; i < n; i++) huge[i] = i % 2 ? 1e308 : -1e308;
  gyroakf_drift_model_init(&drift);
  check_failure(gyroakf_drift_identify(huge, n, NULL, &drift, &err), GYROAKF_NON_FINITE, "drift of huge values");
  check_failure(gyroakf_allan_new(huge, n, 1.0, NULL, &a, &err), GYROAKF_NON_FINITE, "Allan deviation of huge values");
  check(a == NULL, "no curve of huge values");
  check_failure(gyroakf_ar_fit(huge, n, NULL, 2, &order, phi, NULL, NULL, &err), GYROAKF_NON_FINITE, "AR model of huge values");
}

/* A gate that nothing passes, whose weight overflows. */
static void test_gate(void) {
  const double phi[3] = {0.3, 0.1, -0.2}, gates[4] = {1e-290, 9e-4, 2e6, -1.0};
  gyroakf_filter_options opt;
  gyroakf_filter *f;
  double out[n];
  int i, k;
  gyroakf_filter_options_init(&opt);
  for (i = 0; i < 4; i++) {
    opt.huber = gates[i];
    check_failure(gyroakf_filter_new(3, phi, 1.0, 1.0, &opt, &f, &err), GYROAKF_INVALID_ARGUMENT, "a gate out of range");
  }
  opt.huber = 1e-3;
  for (i = 1; i <= 3; i += 2) {
    check_success(gyroakf_filter_new(i, phi, 1e-307, 1e-307, &opt, &f, &err), "the smallest gate");
    for (k = 0; k < n; k++) out[k] = k % 2 ? 9e148 : -9e148;
    check_success(gyroakf_filter_run(f, out, n, out, &err), "the largest measurements");
    for (k = 0; k < n; k++) check(fabs(out[k]) < 1e150, "the estimates are finite");
    gyroakf_filter_free(f);
  }
}

/* A state that no filter comes to, out of a file: estimates that overflow are said, not written. */
static void test_overflowing_state(void) {
  static unsigned char bytes[4096], fresh[4096];
  const double phi[2] = {1.5, -0.7}, large[2] = {1.7e308, -1.7e308};
  gyroakf_filter_state state;
  gyroakf_filter *f;
  double estimate = 77.0, out[n];
  int64_t size = 0, i, at = 0;
  check_success(gyroakf_filter_new(2, phi, 1.0, 1.0, NULL, &f, &err), "a filter");
  gyroakf_filter_step(f, 0.0, &estimate);
  check_success(gyroakf_filter_save(f, fresh, sizeof fresh, &size, &err), "it is saved");
  gyroakf_filter_step(f, 1.0, &estimate);
  check_success(gyroakf_filter_save(f, bytes, sizeof bytes, &size, &err), "and again");
  for (i = 40; at == 0 && i + 16 < size; i += 8) { /* the first number that differs is the estimate */
    if (memcmp(bytes + i, fresh + i, 8) != 0) at = i;
  }
  memcpy(bytes + at, large, sizeof large);
  seal(bytes, size);
  gyroakf_filter_free(f);
  check_success(gyroakf_filter_restore(bytes, size, &f, &err), "it is restored with another state");
  estimate = 77.0;
  check(gyroakf_filter_step(f, 1.0, &estimate) == GYROAKF_NON_FINITE && estimate == 77.0, "an estimate that overflows");
  check(gyroakf_filter_get(f, &state) == GYROAKF_NON_FINITE, "a state that overflows");
  check_failure(gyroakf_filter_run(f, x, n, out, &err), GYROAKF_NON_FINITE, "estimates that overflow");
  check_success(gyroakf_filter_reset(f, &err), "it is reset");
  check_success(gyroakf_filter_run(f, x, n, out, &err), "and runs again");
  gyroakf_filter_free(f);
}

/* Many coefficients: made within a second, not a minute, and as the same model without the zeros. */
static void test_many_coefficients(void) {
  static double phi[1000];
  gyroakf_filter_options opt;
  gyroakf_filter *many, *few;
  double a[n], b[n];
  int k;
  phi[0] = 0.9;
  phi[1] = -0.2;
  gyroakf_filter_options_init(&opt);
  opt.burn_in = -1;
  opt.estimate_measurement_variance = 1;
  check_success(gyroakf_filter_new(1000, phi, 1.0, 2.0, NULL, &many, &err), "a filter of 1000 coefficients");
  gyroakf_filter_free(many);
  check_success(gyroakf_filter_new(60, phi, 1.0, 2.0, &opt, &many, &err), "a filter of 60 coefficients");
  check_success(gyroakf_filter_new(2, phi, 1.0, 2.0, &opt, &few, &err), "one of 2");
  check_success(gyroakf_filter_run(many, x, n, a, &err), "60 coefficients");
  check_success(gyroakf_filter_run(few, x, n, b, &err), "2 coefficients");
  for (k = 0; k < n; k++) check(fabs(a[k] - b[k]) < 1e-12, "coefficients of 0 change nothing");
  gyroakf_filter_free(many);
  gyroakf_filter_free(few);
  check_failure(gyroakf_filter_new(1001, phi, 1.0, 2.0, NULL, &many, &err), GYROAKF_INVALID_ARGUMENT, "too many coefficients");
}

/* What is beyond the processes of a model is not looked at, nor saved. */
static void test_rest_of_model(void) {
  static unsigned char bytes[4096];
  gyroakf_drift_model model;
  gyroakf_filter *f, *again;
  int64_t size;
  gyroakf_drift_model_init(&model);
  model.count = model.slow[0] = 1;
  model.phi[0] = model.q[0] = model.r = 0.5;
  memset(&model.q[2], 0xff, sizeof model.q[2]); /* NaN */
  memset(&model.phi[1], 0xff, sizeof model.phi[1]);
  check_success(gyroakf_drift_filter_new(&model, NULL, &f, &err), "a model of one process");
  check_success(gyroakf_filter_save(f, bytes, sizeof bytes, &size, &err), "its filter is saved");
  check_success(gyroakf_filter_restore(bytes, size, &again, &err), "and restored");
  gyroakf_filter_free(f);
  gyroakf_filter_free(again);
}

/* A size that is that of no version, and that of a later one. */
static void check_sizes(int (*call)(void *), size_t known) {
  void *old = calloc(1, 1024);
  size_t wrong;
  if (old == NULL) abort();
  for (wrong = 0; wrong < known; wrong += 8) {
    memcpy(old, &wrong, sizeof wrong);
    check_failure(call(old), GYROAKF_INVALID_ARGUMENT, "struct_size of no version");
  }
  wrong = known + 8;
  memcpy(old, &wrong, sizeof wrong);
  check_failure(call(old), GYROAKF_NOT_SUPPORTED, "struct_size of a later version");
  free(old);
}

static int call_kpss(void *opt) {
  gyroakf_kpss out;
  return gyroakf_kpss_test(x, n, (gyroakf_kpss_options *)opt, &out, &err);
}

static int call_ar(void *opt) {
  double phi[3];
  int32_t order;
  return gyroakf_ar_fit(x, n, (gyroakf_ar_options *)opt, 3, &order, phi, NULL, NULL, &err);
}

static int call_outliers(void *opt) {
  int8_t inlier[n];
  return gyroakf_mark_outliers(x, n, (gyroakf_outlier_options *)opt, inlier, NULL, &err);
}

static int call_simulate(void *opt) {
  gyroakf_record *r;
  int status = gyroakf_simulate((gyroakf_simulate_options *)opt, &r, &err);
  gyroakf_record_free(r);
  return status;
}

static int call_allan(void *opt) {
  gyroakf_allan *a;
  int status = gyroakf_allan_new(x, n, 1.0, (gyroakf_allan_options *)opt, &a, &err);
  gyroakf_allan_free(a);
  return status;
}

static void test_struct_sizes(void) {
  check_sizes(call_kpss, sizeof(gyroakf_kpss_options));
  check_sizes(call_ar, sizeof(gyroakf_ar_options));
  check_sizes(call_outliers, sizeof(gyroakf_outlier_options));
  check_sizes(call_simulate, sizeof(gyroakf_simulate_options));
  check_sizes(call_allan, sizeof(gyroakf_allan_options));
}

/* A message that repeats a text of the caller. */
static void test_messages(void) {
  gyroakf_error said;
  gyroakf_adf_options opt;
  gyroakf_adf adf;
  gyroakf_adf_options_init(&opt);
  opt.regression = "a\x01\xff\xf0\x1b[31m";
  check(gyroakf_adf_test(x, n, &opt, &adf, &said) == GYROAKF_INVALID_ARGUMENT, "bytes that are no text");
  check(strstr(said.message, "a?\xc3\xbf") != NULL && strchr(said.message, '\x1b') == NULL, "it can be shown");
}

void test_bad(void) {
  uniform(x, n, 4711);
  test_odd_addresses();
  test_overflow();
  test_gate();
  test_overflowing_state();
  test_many_coefficients();
  test_rest_of_model();
  test_struct_sizes();
  test_messages();
}
