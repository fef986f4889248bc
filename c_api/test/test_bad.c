/* SPDX-License-Identifier: MIT */
/* Arguments that no caller should give, found by c_api/fuzz/calls.c: they are refused, and nothing is written. */
#include "check.h"

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
  check_failure(gyroakf_autocorrelation(x, n, 4, acf, NULL, place, &err), GYROAKF_INVALID_ARGUMENT, "odd address of limits");
  check_failure(gyroakf_welch_spectrum(x, n, 1.0, 8, NULL, place, NULL, &err), GYROAKF_INVALID_ARGUMENT, "odd address of densities");
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

/* After a failure results are as they were. */
static void test_nothing_written(void) {
  gyroakf_fisher g, before;
  gyroakf_spectral_line line;
  double freedom = 77.0;
  int32_t count = 77;
  memset(&g, 0x5a, sizeof g);
  before = g;
  check_failure(gyroakf_fisher_g(x, 2, &g, &err), GYROAKF_TOO_FEW_SAMPLES, "Fisher's test: two samples");
  check(memcmp(&g, &before, sizeof g) == 0, "nothing was written by Fisher's test");
  check_any_failure(gyroakf_welch_spectrum(x, n, 1.0, 1, NULL, NULL, &freedom, &err), "spectrum: segments of 1");
  check(freedom == 77.0, "nothing was written by the spectrum");
  check_failure(gyroakf_spectral_lines(x, 20, 1.0, 1, &line, &count, &err), GYROAKF_TOO_FEW_SAMPLES, "lines of 20 samples");
  check(count == 77, "nothing was written by the lines");
}

/* Values near the largest number: results that would be infinite or no numbers. */
static void test_overflow(void) {
  double huge[n], acf[5];
  gyroakf_allan *a;
  gyroakf_whiteness white;
  int i;
  for (i = 0; i < n; i++) huge[i] = i % 2 ? 1e308 : -1e308;
  check_failure(gyroakf_allan_new(huge, n, 1.0, NULL, &a, &err), GYROAKF_NON_FINITE, "Allan deviation of huge values");
  check(a == NULL, "no curve of huge values");
  check_failure(gyroakf_autocorrelation(huge, n, 4, acf, NULL, NULL, &err), GYROAKF_NON_FINITE, "correlation of huge values");
  check_failure(gyroakf_ljung_box(huge, n, 4, 0, &white, &err), GYROAKF_NON_FINITE, "whiteness of huge values");
  check_failure(gyroakf_welch_spectrum(huge, n, 1.0, 8, NULL, acf, NULL, &err), GYROAKF_NON_FINITE, "spectrum of huge values");
}

/* An order that is given counts, whatever the largest of those compared. */
static void test_given_order(void) {
  gyroakf_arma_options opt;
  gyroakf_arma model;
  gyroakf_arma_options_init(&opt);
  opt.q = 2;
  opt.max_p = 1;
  opt.max_q = 0;
  check_success(gyroakf_arma_fit(x, n, &opt, &model, &err), "q = 2 is given, p is chosen");
  check(model.q == 2 && model.p >= 0 && model.p <= 1, "the orders");
}

/* Messages that repeat a number or a text of the caller. */
static void test_messages(void) {
  gyroakf_error said;
  gyroakf_normality normality;
  gyroakf_adf_options opt;
  gyroakf_adf adf;
  check(gyroakf_normality_test(x, n, INT64_MIN, &normality, &said) == GYROAKF_INVALID_ARGUMENT, "a long number");
  check(strstr(said.message, "-9223372036854775808") != NULL, "the number is in the message");
  gyroakf_adf_options_init(&opt);
  opt.regression = "a\x01\xff\xf0\x1b[31m";
  check(gyroakf_adf_test(x, n, &opt, &adf, &said) == GYROAKF_INVALID_ARGUMENT, "bytes that are no text");
  check(strstr(said.message, "a?\xc3\xbf") != NULL && strchr(said.message, '\x1b') == NULL, "it can be shown");
}

void test_bad(void) {
  uniform(x, n, 4711);
  test_odd_addresses();
  test_nothing_written();
  test_overflow();
  test_given_order();
  test_messages();
}
