/* SPDX-License-Identifier: MIT */
/*
 * Tests of the C interface: every function, reference numbers, every failure, floating-point traps of the program.
 * The last line is "N passed, N failed"; the exit code is not 0 if a test failed.
 */
#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* feenableexcept */
#endif
#include "check.h"
#include "gyroakf.h"

#include <fenv.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int passed, failed;

void check(int good, const char *what) {
  if (good) {
    passed++;
  } else {
    failed++;
    printf("FAILED: %s\n", what);
  }
}

/* |a - b| <= tolerance |b|; false for NaN */
static int close_to(double a, double b, double tolerance) { return fabs(a - b) <= tolerance * fabs(b); }

gyroakf_error err;

void check_failure(int status, int expected, const char *what) {
  check(status == expected, what);
  check(err.code == status && strlen(err.message) > 5, what);
  if (status != expected) printf("  status %d: %s\n", status, err.message);
  memset(&err, 0x55, sizeof err);
}

void check_any_failure(int status, const char *what) {
  check(status != GYROAKF_OK && err.code == status && strlen(err.message) > 5, what);
  memset(&err, 0x55, sizeof err);
}

void check_success(int status, const char *what) {
  check(status == GYROAKF_OK && err.code == GYROAKF_OK && err.message[0] == '\0', what);
  if (status != GYROAKF_OK) printf("  status %d: %s\n", status, err.message);
  memset(&err, 0x55, sizeof err);
}

void uniform(double *x, int n, int64_t seed) {
  int64_t s = seed;
  int i;
  for (i = 0; i < n; i++) {
    x[i] = (double)s / 2147483647.0;
    s = 16807 * s % 2147483647;
  }
}

/* The values of the NBS test set (W. Riley, NIST SP 1065). */
static void nbs(double *x, int n) { uniform(x, n, 1234567890); }

/* AR(1) of unit innovations, made from sums of twelve of those values; deterministic. */
static void autoregressive(double *x, int n, double phi) {
  int64_t s = 1234567890;
  double before = 0.0;
  int i, k;
  for (i = -100; i < n; i++) {
    double g = -6.0;
    for (k = 0; k < 12; k++) {
      g += (double)s / 2147483647.0;
      s = 16807 * s % 2147483647;
    }
    before = phi * before + g;
    if (i >= 0) x[i] = before;
  }
}

static void test_release(void) {
  char text[64];
  int i, j;
  snprintf(text, sizeof text, "%d.%d.%d", GYROAKF_VERSION_MAJOR, GYROAKF_VERSION_MINOR, GYROAKF_VERSION_PATCH);
  check(gyroakf_version() == GYROAKF_VERSION, "the library has the version of the header");
  check(strcmp(gyroakf_version_string(), text) == 0, "version string");
  check(strcmp(GYROAKF_VERSION_STRING, text) == 0, "version string of the header");
  check(strcmp(gyroakf_status_string(GYROAKF_OK), "ok") == 0, "text of GYROAKF_OK");
  check(strcmp(gyroakf_status_string(GYROAKF_UNSTABLE), "model not stationary") == 0, "text of GYROAKF_UNSTABLE");
  check(strcmp(gyroakf_status_string(GYROAKF_USAGE), "wrong usage") == 0, "text of GYROAKF_USAGE");
  check(strcmp(gyroakf_status_string(-1), "unknown status") == 0, "text of -1");
  check(strcmp(gyroakf_status_string(GYROAKF_USAGE + 1), "unknown status") == 0, "text of a status too large");
  for (i = GYROAKF_OK; i <= GYROAKF_USAGE; i++) {
    for (j = GYROAKF_OK; j < i; j++) {
      if (strcmp(gyroakf_status_string(i), gyroakf_status_string(j)) == 0) check(0, "two statuses have one text");
    }
  }
}

/* NIST SP 1065: 9 rates, and 1000 rates at m = 1, 10, 100; exact values computed with rational numbers. */
static void test_allan_values(void) {
  static const double nine[9] = {892, 809, 823, 798, 671, 644, 883, 903, 677};
  double x[1000];
  gyroakf_allan_options opt;
  gyroakf_allan *a = NULL;
  gyroakf_allan_options_init(&opt);
  opt.kind = "oadev";
  opt.taus = "1,2";
  check_success(gyroakf_allan_new(nine, 9, 1.0, &opt, &a, &err), "deviation of 9 rates");
  check(gyroakf_allan_size(a) == 2, "two averaging times");
  if (gyroakf_allan_size(a) == 2) {
    check(gyroakf_allan_tau(a)[0] == 1.0 && gyroakf_allan_tau(a)[1] == 2.0, "averaging times");
    check(close_to(gyroakf_allan_deviation(a)[0], 91.22944974074983, 1e-12), "9 rates, m = 1");
    check(close_to(gyroakf_allan_deviation(a)[1], 85.95286983768101, 1e-12), "9 rates, m = 2");
  }
  gyroakf_allan_free(a);
  nbs(x, 1000);
  opt.taus = "1,10,100";
  check_success(gyroakf_allan_new(x, 1000, 1.0, &opt, &a, &err), "deviation of 1000 rates");
  check(gyroakf_allan_size(a) == 3, "three averaging times");
  if (gyroakf_allan_size(a) == 3) {
    check(close_to(gyroakf_allan_deviation(a)[0], .2922318781067592, 1e-12), "1000 rates, m = 1");
    check(close_to(gyroakf_allan_deviation(a)[1], .09159953420118654, 1e-12), "1000 rates, m = 10");
    check(close_to(gyroakf_allan_deviation(a)[2], .03241343026056984, 1e-12), "1000 rates, m = 100");
  }
  gyroakf_allan_free(a);
}

/* Stable32 1.60 for the same 1000 rates at m = 1, white noise, 68.3 %: limits 0.28515 and 0.29987 (five digits printed);
   the degrees of freedom by Greenhall and Riley (2003). */
static void test_allan_limits(void) {
  double x[1000];
  gyroakf_allan *a = NULL;
  int64_t i;
  nbs(x, 1000);
  check_success(gyroakf_allan_new(x, 1000, 0.5, NULL, &a, &err), "default options");
  check(gyroakf_allan_size(a) >= 8, "octaves of 1000 samples");
  if (gyroakf_allan_size(a) > 0) {
    check(close_to(gyroakf_allan_tau(a)[0], 0.5, 1e-15), "the first averaging time is the sample interval");
    check(close_to(gyroakf_allan_lower(a)[0], .28515, 1e-3), "lower limit");
    check(close_to(gyroakf_allan_upper(a)[0], .29987, 1e-3), "upper limit");
    check(close_to(gyroakf_allan_edf(a)[0], 782.0303, 1e-3), "degrees of freedom");
  }
  for (i = 0; i < gyroakf_allan_size(a); i++) {
    check(gyroakf_allan_lower(a)[i] < gyroakf_allan_deviation(a)[i], "the lower limit is below the deviation");
    check(gyroakf_allan_upper(a)[i] > gyroakf_allan_deviation(a)[i], "the upper limit is above the deviation");
  }
  gyroakf_allan_free(a);
}

/* NaN is a missing sample: 5 % lost change the deviation by little, and the array is as it was. */
static void test_allan_missing(void) {
  double x[1000], lost[1000];
  gyroakf_allan *a = NULL, *b = NULL;
  int i;
  nbs(x, 1000);
  memcpy(lost, x, sizeof x);
  for (i = 0; i < 50; i++) lost[(i * 379) % 1000] = NAN;
  check_success(gyroakf_allan_new(x, 1000, 1.0, NULL, &a, &err), "whole series");
  check_success(gyroakf_allan_new(lost, 1000, 1.0, NULL, &b, &err), "series with missing samples");
  check(gyroakf_allan_size(a) > 0 && gyroakf_allan_size(b) > 0, "both have a curve");
  if (gyroakf_allan_size(a) > 0 && gyroakf_allan_size(b) > 0) {
    check(close_to(gyroakf_allan_deviation(b)[0], gyroakf_allan_deviation(a)[0], 0.03), "deviation with missing samples");
  }
  check(isnan(lost[0]) && lost[1] == x[1], "the caller's array is not changed");
  gyroakf_allan_free(a);
  gyroakf_allan_free(b);
}

static void test_allan_failures(void) {
  double x[4] = {1, 2, 4, 3}, bad[4] = {1, INFINITY, 2, 3}, nothing[4] = {NAN, NAN, NAN, NAN};
  gyroakf_allan *a = (gyroakf_allan *)x;
  check_failure(gyroakf_allan_new(NULL, 4, 1.0, NULL, &a, &err), GYROAKF_INVALID_ARGUMENT, "rates NULL");
  check(a == NULL, "*out is NULL after a failure");
  check_failure(gyroakf_allan_new(x, 4, 1.0, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "out NULL");
  check_failure(gyroakf_allan_new(x, 0, 1.0, NULL, &a, &err), GYROAKF_INVALID_ARGUMENT, "n = 0");
  check_failure(gyroakf_allan_new(x, -5, 1.0, NULL, &a, &err), GYROAKF_INVALID_ARGUMENT, "n < 0");
  check_failure(gyroakf_allan_new(x, INT64_MAX, 1.0, NULL, &a, &err), GYROAKF_INVALID_ARGUMENT, "n huge");
  check_failure(gyroakf_allan_new(x, 1, 1.0, NULL, &a, &err), GYROAKF_TOO_FEW_SAMPLES, "one sample");
  check_failure(gyroakf_allan_new(nothing, 4, 1.0, NULL, &a, &err), GYROAKF_TOO_FEW_SAMPLES, "all missing");
  check_failure(gyroakf_allan_new(x, 4, 0.0, NULL, &a, &err), GYROAKF_INVALID_ARGUMENT, "dt = 0");
  check_any_failure(gyroakf_allan_new(x, 4, NAN, NULL, &a, &err), "dt NaN");
  check_failure(gyroakf_allan_new(bad, 4, 1.0, NULL, &a, &err), GYROAKF_NON_FINITE, "an infinite rate");
  check(gyroakf_allan_new(x, 0, 1.0, NULL, &a, NULL) == GYROAKF_INVALID_ARGUMENT, "err NULL");
  check(gyroakf_allan_size(NULL) == 0, "size of NULL");
  check(gyroakf_allan_tau(NULL) == NULL && gyroakf_allan_deviation(NULL) == NULL, "tau and deviation of NULL");
  check(gyroakf_allan_lower(NULL) == NULL && gyroakf_allan_upper(NULL) == NULL, "limits of NULL");
  check(gyroakf_allan_edf(NULL) == NULL, "degrees of freedom of NULL");
  gyroakf_allan_free(NULL);
}

static void test_allan_options(void) {
  double x[4] = {1, 2, 4, 3};
  gyroakf_allan_options opt;
  gyroakf_allan *a = NULL;
  gyroakf_allan_options_init(&opt);
  opt.kind = "sdev";
  check_any_failure(gyroakf_allan_new(x, 4, 1.0, &opt, &a, &err), "unknown kind");
  opt.kind = "a kind with a very long name";
  check_failure(gyroakf_allan_new(x, 4, 1.0, &opt, &a, &err), GYROAKF_INVALID_ARGUMENT, "unknown long kind");
  gyroakf_allan_options_init(&opt);
  opt.taus = "1,x";
  check_failure(gyroakf_allan_new(x, 4, 1.0, &opt, &a, &err), GYROAKF_INVALID_ARGUMENT, "taus that are no numbers");
  gyroakf_allan_options_init(&opt);
  opt.confidence = 1.5;
  check_failure(gyroakf_allan_new(x, 4, 1.0, &opt, &a, &err), GYROAKF_INVALID_ARGUMENT, "confidence > 1");
  opt.confidence = NAN;
  check_any_failure(gyroakf_allan_new(x, 4, 1.0, &opt, &a, &err), "confidence NaN");
  gyroakf_allan_options_init(&opt);
  opt.min_coverage = -1.0;
  check_failure(gyroakf_allan_new(x, 4, 1.0, &opt, &a, &err), GYROAKF_INVALID_ARGUMENT, "coverage < 0");
  memset(&opt, 0, sizeof opt);
  check_failure(gyroakf_allan_new(x, 4, 1.0, &opt, &a, &err), GYROAKF_INVALID_ARGUMENT, "options not initialized");
  gyroakf_allan_options_init(&opt);
  opt.struct_size += 8;
  check_failure(gyroakf_allan_new(x, 4, 1.0, &opt, &a, &err), GYROAKF_NOT_SUPPORTED, "options of a later version");
  check(a == NULL, "no curve after any of these");
  gyroakf_allan_options_init(NULL);
}

/* White noise of variance 1/12 at 1 Hz: N = sqrt(1/12), no random walk, no ramp. */
static void test_noise(void) {
  static double x[20000];
  gyroakf_allan *a = NULL;
  gyroakf_fit_options opt;
  gyroakf_noise noise, same;
  double before;
  nbs(x, 20000);
  check_success(gyroakf_allan_new(x, 20000, 1.0, NULL, &a, &err), "deviation of white noise");
  if (a == NULL) return;
  before = gyroakf_allan_upper(a)[3];
  check_success(gyroakf_noise_fit(a, NULL, &noise, &err), "fit of white noise");
  check(noise.n.detected == 1 && noise.n.fitted == 1, "N is detected");
  check(fabs(noise.n.value - sqrt(1.0 / 12.0)) < 4 * noise.n.std_error, "N");
  check(noise.n.std_error > 0.001 * noise.n.value && noise.n.std_error < 0.02 * noise.n.value, "standard error of N");
  check(noise.n.upper_limit > noise.n.value, "upper limit of N");
  check(noise.q.value >= 0 && noise.b.value >= 0 && noise.k.value >= 0 && noise.r.value >= 0, "nothing is negative");
  check(!noise.k.detected && !noise.r.detected, "no random walk and no ramp");
  check(noise.points > 5 && noise.chi2_reduced > 0 && noise.chi2_reduced < 5, "points and chi-square");
  check(gyroakf_allan_upper(a)[3] == before, "the curve is not changed");
  check_success(gyroakf_allan_fit(a, NULL, &same, &err), "fit with limits");
  check(memcmp(&same.n, &noise.n, sizeof noise.n) == 0, "the same N");
  check(gyroakf_allan_upper(a)[3] != before, "the curve has the limits of the fit");
  gyroakf_fit_options_init(&opt);
  opt.terms = "N";
  opt.tau_max = 100.0;
  check(noise.left_out == 0 && noise.cut_off == 0 && noise.described == 1 && noise.tau_first == 1.0 &&
            noise.tau_last == 4096.0 && noise.floor == 0, "every octave was fitted");
  check(noise.chi2_probability > 1e-4 && noise.chi2_probability <= 1, "chance of chi-square");
  check_success(gyroakf_noise_fit(a, &opt, &noise, &err), "fit of one term");
  check(noise.n.fitted == 1 && noise.q.fitted == 0 && noise.k.fitted == 0, "only N was fitted");
  check(noise.n_unquantized.fitted == 0 && noise.lsb_ratio == 0, "no step of the samples");
  opt.lsb = 0.05;
  check_success(gyroakf_noise_fit(a, &opt, &noise, &err), "fit of rounded samples");
  check(fabs(noise.n_unquantized.value - sqrt(noise.n.value * noise.n.value - 0.0025 / 12)) < 1e-12, "N without quantization");
  opt.lsb = -1;
  check_failure(gyroakf_noise_fit(a, &opt, &noise, &err), GYROAKF_INVALID_ARGUMENT, "negative step");
  gyroakf_allan_free(a);
}

static void test_noise_failures(void) {
  double x[1000];
  gyroakf_allan *a = NULL;
  gyroakf_fit_options opt;
  gyroakf_noise noise;
  nbs(x, 1000);
  check_success(gyroakf_allan_new(x, 1000, 1.0, NULL, &a, &err), "a curve for the failures of its fit");
  gyroakf_fit_options_init(&opt);
  check_failure(gyroakf_noise_fit(NULL, NULL, &noise, &err), GYROAKF_INVALID_ARGUMENT, "fit of NULL");
  check_failure(gyroakf_noise_fit(a, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "fit into NULL");
  check_failure(gyroakf_allan_fit(NULL, NULL, &noise, &err), GYROAKF_INVALID_ARGUMENT, "fit of NULL with limits");
  check_failure(gyroakf_allan_fit(a, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "fit with limits into NULL");
  opt.terms = "NX";
  check_failure(gyroakf_noise_fit(a, &opt, &noise, &err), GYROAKF_INVALID_ARGUMENT, "unknown term");
  opt.terms = "QNBKRQNBKR";
  check_failure(gyroakf_noise_fit(a, &opt, &noise, &err), GYROAKF_INVALID_ARGUMENT, "too many terms");
  gyroakf_fit_options_init(&opt);
  opt.tau_min = 1e9;
  check_any_failure(gyroakf_noise_fit(a, &opt, &noise, &err), "no points left");
  opt.tau_min = NAN;
  check_any_failure(gyroakf_noise_fit(a, &opt, &noise, &err), "tau_min NaN");
  gyroakf_fit_options_init(&opt);
  opt.struct_size = 0;
  check_failure(gyroakf_noise_fit(a, &opt, &noise, &err), GYROAKF_INVALID_ARGUMENT, "fit options not initialized");
  gyroakf_fit_options_init(NULL);
  gyroakf_allan_free(a);
}

/* A stationary series and its sums, which have a unit root. */
static void test_outliers(void) {
  double x[2000], before[2000];
  int8_t inlier[2000];
  gyroakf_outlier_options opt;
  gyroakf_outliers out;
  int i, marked;
  nbs(x, 2000);
  for (i = 0; i < 2000; i++) x[i] += 0.001 * i;
  x[100] += 30;
  x[1999] -= 30;
  x[7] = NAN;
  memcpy(before, x, sizeof x);
  check_success(gyroakf_mark_outliers(x, 2000, NULL, inlier, &out, &err), "marks of outliers");
  for (i = 0, marked = 0; i < 2000; i++) marked += !inlier[i];
  check(marked == 3 && !inlier[100] && !inlier[1999] && !inlier[7], "two outliers and one missing sample");
  check(out.removed == 2 && out.converged == 1 && out.expected < 1 && out.variance > 0, "the figures");
  check(memcmp(before, x, sizeof x) == 0, "the series is as it was");
  gyroakf_outlier_options_init(&opt);
  opt.method = "hampel";
  opt.half_width = 10;
  opt.threshold = 6;
  check_success(gyroakf_mark_outliers(x, 2000, &opt, inlier, NULL, &err), "hampel");
  check(!inlier[100] && !inlier[1999], "a spike at the end is found too");
  opt.half_width = 0;
  check_failure(gyroakf_mark_outliers(x, 2000, &opt, inlier, &out, &err), GYROAKF_INVALID_ARGUMENT, "no window");
  gyroakf_outlier_options_init(&opt);
  opt.method = "sigma";
  check_failure(gyroakf_mark_outliers(x, 2000, &opt, inlier, &out, &err), GYROAKF_INVALID_ARGUMENT, "unknown rule");
  check_failure(gyroakf_mark_outliers(x, 2000, NULL, NULL, &out, &err), GYROAKF_INVALID_ARGUMENT, "marks NULL");
  check_failure(gyroakf_mark_outliers(NULL, 2000, NULL, inlier, &out, &err), GYROAKF_INVALID_ARGUMENT, "series NULL");
  check_failure(gyroakf_mark_outliers(x, 2, NULL, inlier, &out, &err), GYROAKF_TOO_FEW_SAMPLES, "two samples");
  gyroakf_outlier_options_init(NULL);
}

static void test_adf(void) {
  double x[2000], sum[2000];
  gyroakf_adf_options opt;
  gyroakf_adf adf;
  int i;
  autoregressive(x, 2000, 0.5);
  for (i = 0, sum[0] = x[0]; i < 1999; i++) sum[i + 1] = sum[i] + x[i + 1];
  check_success(gyroakf_adf_test(x, 2000, NULL, &adf, &err), "test of a stationary series");
  check(adf.statistic < adf.critical[0] && adf.p_value < 0.01, "it is stationary");
  check(adf.critical[0] < adf.critical[1] && adf.critical[1] < adf.critical[2], "critical values");
  /* MacKinnon (2010), a constant, 5 %: -2.86154 - 2.8903/T - 4.234/T^2 */
  check(fabs(adf.critical[1] + 2.86154 + 2.8903 / (double)adf.observations) < 1e-4, "critical value at 5 %");
  check(adf.lag >= 0 && adf.observations > 1900 && adf.observations < 2000, "lag and observations");
  check_success(gyroakf_adf_test(sum, 2000, NULL, &adf, &err), "test of a random walk");
  check(adf.statistic > adf.critical[1] && adf.p_value > 0.05, "it is not stationary");
  gyroakf_adf_options_init(&opt);
  opt.regression = "ct";
  opt.lags = 3;
  check_success(gyroakf_adf_test(x, 2000, &opt, &adf, &err), "given lags");
  check(adf.lag == 3 && adf.observations == 1996, "3 lags leave 1996 observations");
  for (i = 0; i < 6; i++) x[300 * i] = NAN;
  check_success(gyroakf_adf_test(x, 2000, NULL, &adf, &err), "missing samples");
  check(adf.statistic < adf.critical[0], "still stationary");
}

/* A stationary series, white noise, and its sums: KPSS. */
static void test_kpss(void) {
  double x[2000], sum[2000];
  gyroakf_kpss_options opt;
  gyroakf_kpss kpss;
  int i;
  autoregressive(x, 2000, 0.5);
  for (i = 0, sum[0] = x[0]; i < 1999; i++) sum[i + 1] = sum[i] + x[i + 1];
  check_success(gyroakf_kpss_test(x, 2000, NULL, &kpss, &err), "KPSS of a stationary series");
  check(kpss.statistic < kpss.critical[1] && kpss.p_value >= 0.05 && kpss.critical[1] == 0.463, "it is stationary");
  check(kpss.lags > 0 && kpss.observations == 2000 && kpss.long_run_variance > kpss.variance, "bandwidth and variances");
  check_success(gyroakf_kpss_test(sum, 2000, NULL, &kpss, &err), "KPSS of a random walk");
  check(kpss.p_bound == -1 && kpss.p_value == 0.01 && kpss.p_asymptotic < 0.01, "it is not stationary");
  gyroakf_kpss_options_init(&opt);
  opt.regression = "ct";
  opt.lags = 7;
  check_success(gyroakf_kpss_test(x, 2000, &opt, &kpss, &err), "given bandwidth");
  check(kpss.lags == 7 && kpss.critical[1] == 0.146, "about a line");
  for (i = 0; i < 6; i++) x[300 * i] = NAN;
  check_success(gyroakf_kpss_test(x, 2000, NULL, &kpss, &err), "missing samples");
  check(kpss.observations == 1994, "those present");
}

static void test_kpss_failures(void) {
  double x[100], flat[100] = {0};
  gyroakf_kpss_options opt;
  gyroakf_kpss kpss;
  nbs(x, 100);
  check_failure(gyroakf_kpss_test(NULL, 100, NULL, &kpss, &err), GYROAKF_INVALID_ARGUMENT, "series NULL");
  check_failure(gyroakf_kpss_test(x, 100, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "result NULL");
  check_failure(gyroakf_kpss_test(flat, 100, NULL, &kpss, &err), GYROAKF_CONSTANT_INPUT, "constant series");
  check_failure(gyroakf_kpss_test(x, 2, NULL, &kpss, &err), GYROAKF_TOO_FEW_SAMPLES, "two samples");
  gyroakf_kpss_options_init(&opt);
  opt.lags = INT64_MAX;
  check_failure(gyroakf_kpss_test(x, 100, &opt, &kpss, &err), GYROAKF_TOO_FEW_SAMPLES, "lags huge");
  gyroakf_kpss_options_init(&opt);
  opt.regression = "ctt";
  check_failure(gyroakf_kpss_test(x, 100, &opt, &kpss, &err), GYROAKF_INVALID_ARGUMENT, "unknown regression");
  opt.struct_size = 0;
  check_failure(gyroakf_kpss_test(x, 100, &opt, &kpss, &err), GYROAKF_INVALID_ARGUMENT, "options not initialized");
  gyroakf_kpss_options_init(NULL);
}

static void test_adf_failures(void) {
  double x[100], flat[100] = {0};
  gyroakf_adf_options opt;
  gyroakf_adf adf;
  nbs(x, 100);
  check_failure(gyroakf_adf_test(NULL, 100, NULL, &adf, &err), GYROAKF_INVALID_ARGUMENT, "series NULL");
  check_failure(gyroakf_adf_test(x, 100, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "result NULL");
  check_failure(gyroakf_adf_test(x, 0, NULL, &adf, &err), GYROAKF_INVALID_ARGUMENT, "n = 0");
  check_failure(gyroakf_adf_test(x, INT64_MAX, NULL, &adf, &err), GYROAKF_INVALID_ARGUMENT, "n huge");
  check_failure(gyroakf_adf_test(x, 3, NULL, &adf, &err), GYROAKF_TOO_FEW_SAMPLES, "three samples");
  check_any_failure(gyroakf_adf_test(flat, 100, NULL, &adf, &err), "constant series");
  gyroakf_adf_options_init(&opt);
  opt.regression = "cttt";
  check_failure(gyroakf_adf_test(x, 100, &opt, &adf, &err), GYROAKF_INVALID_ARGUMENT, "unknown regression");
  gyroakf_adf_options_init(&opt);
  opt.criterion = "abc";
  check_failure(gyroakf_adf_test(x, 100, &opt, &adf, &err), GYROAKF_INVALID_ARGUMENT, "unknown criterion");
  gyroakf_adf_options_init(&opt);
  opt.lags = INT32_MAX;
  check_any_failure(gyroakf_adf_test(x, 100, &opt, &adf, &err), "lags huge");
  opt.lags = -2;
  check_any_failure(gyroakf_adf_test(x, 100, &opt, &adf, &err), "lags < -1");
  opt.lags = -1;
  opt.max_lags = INT32_MAX;
  gyroakf_adf_test(x, 100, &opt, &adf, &err); /* either way, but it returns */
  opt.struct_size = 1000;
  check_failure(gyroakf_adf_test(x, 100, &opt, &adf, &err), GYROAKF_NOT_SUPPORTED, "options of a later version");
  gyroakf_adf_options_init(NULL);
}

/* A small case by hand, and AR(1) with phi = 0.5 about 10. */
static void test_ar(void) {
  static double x[20000];
  const double five[5] = {1, 3, -1, 5, 2}; /* about the mean 2: -1 1 -3 3 0; r0 = 20/5, r1 = (-1 - 3 - 9)/5 */
  double phi[12], variance = -1, mean = -1;
  int32_t order = -1, i;
  gyroakf_ar_options opt;
  gyroakf_ar_options_init(&opt);
  opt.order = 1;
  check_success(gyroakf_ar_fit(five, 5, &opt, 1, &order, phi, &variance, &mean, &err), "five samples");
  check(order == 1 && close_to(phi[0], -0.65, 1e-14) && close_to(mean, 2.0, 1e-15), "coefficient and mean by hand");
  check(close_to(variance, 4.0 * (1 - 0.65 * 0.65), 1e-14), "noise variance by hand");
  autoregressive(x, 20000, 0.5);
  for (i = 0; i < 20000; i++) x[i] += 10.0;
  opt.order = -1;
  opt.criterion = "bic";
  phi[11] = 7.0;
  check_success(gyroakf_ar_fit(x, 20000, &opt, 12, &order, phi, &variance, &mean, &err), "20000 samples");
  check(order == 1, "order by BIC");
  check(fabs(phi[0] - 0.5) < 4 * sqrt(0.75 / 20000) && phi[1] == 0.0 && phi[11] == 0.0, "coefficients");
  check(fabs(variance - 1.0) < 0.05 && fabs(mean - 10.0) < 0.06, "noise variance and mean");
  check_success(gyroakf_ar_fit(x, 20000, NULL, 3, &order, phi, NULL, NULL, &err), "results that are not wanted");
  check_success(gyroakf_ar_fit(x, 20000, NULL, 0, &order, NULL, &variance, NULL, &err), "order 0 needs no coefficients");
  check(order == 0 && fabs(variance - 4.0 / 3.0) < 0.08, "order 0");
  {
    const char *const method[3] = {"yw", "burg", "ols"};
    opt.order = 2;
    for (i = 0; i < 3; i++) {
      opt.method = method[i];
      check_success(gyroakf_ar_fit(x, 20000, &opt, 3, &order, phi, &variance, &mean, &err), method[i]);
      check(order == 2 && fabs(phi[0] - 0.5) < 0.03 && fabs(phi[1]) < 0.03 && fabs(variance - 1.0) < 0.05, method[i]);
    }
    opt.order = -1;
    opt.method = NULL;
  }
  for (i = 0; i < 60; i++) x[331 * i] = NAN;
  check_success(gyroakf_ar_fit(x, 20000, &opt, 3, &order, phi, &variance, &mean, &err), "missing samples");
  check(order == 1 && fabs(phi[0] - 0.5) < 0.03, "coefficient with missing samples");
}

static void test_ar_failures(void) {
  double x[100], phi[12];
  int32_t order = 77;
  gyroakf_ar_options opt;
  nbs(x, 100);
  check_failure(gyroakf_ar_fit(NULL, 4, NULL, 1, &order, phi, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "series NULL");
  check_failure(gyroakf_ar_fit(x, 100, NULL, 1, NULL, phi, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "order NULL");
  check_failure(gyroakf_ar_fit(x, 100, NULL, 1, &order, NULL, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "phi NULL");
  check_failure(gyroakf_ar_fit(x, 100, NULL, -1, &order, phi, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "max_order < 0");
  check_failure(gyroakf_ar_fit(x, 100, NULL, INT32_MAX, &order, phi, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT,
                "max_order huge");
  check_failure(gyroakf_ar_fit(x, 0, NULL, 1, &order, phi, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "n = 0");
  check_failure(gyroakf_ar_fit(x, 1, NULL, 1, &order, phi, NULL, NULL, &err), GYROAKF_TOO_FEW_SAMPLES, "one sample");
  gyroakf_ar_options_init(&opt);
  opt.order = 5;
  check_failure(gyroakf_ar_fit(x, 100, &opt, 3, &order, phi, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "order > max_order");
  gyroakf_ar_options_init(&opt);
  opt.criterion = "zzz";
  check_failure(gyroakf_ar_fit(x, 100, &opt, 3, &order, phi, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "unknown criterion");
  gyroakf_ar_options_init(&opt);
  opt.method = "guess";
  check_failure(gyroakf_ar_fit(x, 100, &opt, 3, &order, phi, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "unknown method");
  opt.struct_size = 3;
  check_failure(gyroakf_ar_fit(x, 100, &opt, 3, &order, phi, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "struct_size 3");
  check(order == 77, "a failure leaves the results alone");
  gyroakf_ar_options_init(NULL);
}

/* The paper's filter: phi = 0.409975, Q = 1 - phi^2, R = 1. Closed forms of the steady state: K = 0.4770139142617331,
   share of a constant K/(1 - phi (1 - K)) = 0.607205610250273. */
static void test_filter_values(void) {
  const double phi = 0.409975;
  gyroakf_filter *f = NULL;
  gyroakf_filter_state state;
  double x = 0.0;
  int i;
  check_success(gyroakf_filter_new(1, &phi, 1 - phi * phi, 1.0, NULL, &f, &err), "the paper's filter");
  if (f == NULL) return;
  check(gyroakf_filter_get(f, &state) == GYROAKF_OK && state.steps == 0, "no step yet");
  check(close_to(state.p, 1.0, 1e-14), "it starts from the stationary variance");
  for (i = 0; i < 200; i++) check(gyroakf_filter_step(f, 1.0, &x) == GYROAKF_OK, "step");
  check(gyroakf_filter_get(f, &state) == GYROAKF_OK, "state");
  check(close_to(state.gain, 0.4770139142617331, 1e-12), "steady gain");
  check(close_to(x, 0.607205610250273, 1e-12) && state.x == x, "share of a constant that passes");
  check(close_to(state.p, state.gain, 1e-12), "P = K R");
  check(close_to(state.innovation, 1.0 - phi * x, 1e-12), "innovation");
  check(close_to(state.innovation_variance, 1.0 / (1.0 - state.gain), 1e-12), "innovation variance R/(1 - K)");
  check(close_to(state.q, 1 - phi * phi, 1e-15) && state.r == 1.0, "Q and R");
  check(state.q_mean == 0.0 && state.r_mean == 0.0, "q and r");
  check(state.steps == 200, "steps");
  check(gyroakf_filter_step(f, NAN, &x) == GYROAKF_OK && close_to(x, phi * state.x, 1e-14), "NaN: the prediction");
  check(gyroakf_filter_step(f, INFINITY, &x) == GYROAKF_OK && close_to(x, phi * phi * state.x, 1e-14), "infinite: too");
  check(gyroakf_filter_get(f, &state) == GYROAKF_OK && state.steps == 202, "these are steps");
  gyroakf_filter_free(f);
}

/* A filter of one of three kinds: 0 fixed, 1 adaptive, 2 of order 3. */
static gyroakf_filter *filter_of_kind(int kind) {
  const double phi[3] = {0.5, -0.2, 0.1};
  gyroakf_filter_options opt;
  gyroakf_filter *f = NULL;
  gyroakf_filter_options_init(&opt);
  if (kind == 1) {
    opt.estimate_process_mean = 1;
    opt.estimate_measurement_mean = 1;
    opt.allow_unobservable = 1;
    opt.estimate_process_variance = 1;
    opt.estimate_measurement_variance = 1;
    opt.measurement_form = "paper";
  }
  check_success(gyroakf_filter_new(kind == 2 ? 3 : 1, phi, 1.0, 1.0, &opt, &f, &err), "filter of a kind");
  return f;
}

/* Run, run in place and step by step give the same numbers, to the last bit. */
static void test_filter_run(void) {
  static double z[5000], by_step[5000], by_run[5000], in_place[5000];
  int kind, i;
  autoregressive(z, 5000, 0.5);
  z[100] = NAN;
  for (kind = 0; kind < 3; kind++) {
    gyroakf_filter *f = filter_of_kind(kind), *g = filter_of_kind(kind), *h = filter_of_kind(kind);
    for (i = 0; i < 5000; i++) gyroakf_filter_step(f, z[i], &by_step[i]);
    check_success(gyroakf_filter_run(g, z, 5000, by_run, &err), "run");
    memcpy(in_place, z, sizeof z);
    check_success(gyroakf_filter_run(h, in_place, 5000, in_place, &err), "run in place");
    check(memcmp(by_step, by_run, sizeof z) == 0, "a run gives the same as steps");
    check(memcmp(by_step, in_place, sizeof z) == 0, "a run in place gives the same");
    check(isnan(z[100]) && !isnan(by_run[100]), "a missing measurement has an estimate");
    gyroakf_filter_free(f);
    gyroakf_filter_free(g);
    gyroakf_filter_free(h);
  }
}

/* While frozen R stays, afterwards it goes on. */
static void test_filter_freeze(void) {
  static double z[3000], x[3000];
  const double phi = 0.5;
  gyroakf_filter_options opt;
  gyroakf_filter *f = NULL;
  gyroakf_filter_state before, after;
  int i;
  autoregressive(z, 3000, 0.5);
  for (i = 0; i < 3000; i++) z[i] *= 3.0;
  gyroakf_filter_options_init(&opt);
  opt.estimate_measurement_variance = 1;
  check_success(gyroakf_filter_new(1, &phi, 1.0, 1.0, &opt, &f, &err), "adaptive filter");
  if (f == NULL) return;
  gyroakf_filter_run(f, z, 1000, x, NULL);
  gyroakf_filter_get(f, &before);
  check(before.r != 1.0 && before.r > 0.0, "R was adapted");
  check(gyroakf_filter_freeze(f, 1) == GYROAKF_OK, "freeze");
  gyroakf_filter_run(f, z + 1000, 1000, x, NULL);
  gyroakf_filter_get(f, &after);
  check(after.r == before.r && after.steps == 2000, "R stays while the state goes on");
  check(gyroakf_filter_freeze(f, 0) == GYROAKF_OK, "go on adapting");
  gyroakf_filter_run(f, z + 2000, 1000, x, NULL);
  gyroakf_filter_get(f, &after);
  check(after.r != before.r, "R is adapted again");
  gyroakf_filter_free(f);
}

static void test_filter_failures(void) {
  const double phi = 0.5, unstable = 1.5, nan_phi = NAN;
  gyroakf_filter_options opt;
  gyroakf_filter *f = (gyroakf_filter *)&opt;
  check_failure(gyroakf_filter_new(1, NULL, 1, 1, NULL, &f, &err), GYROAKF_INVALID_ARGUMENT, "phi NULL");
  check(f == NULL, "*out is NULL after a failure");
  check_failure(gyroakf_filter_new(1, &phi, 1, 1, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "out NULL");
  check_failure(gyroakf_filter_new(-1, &phi, 1, 1, NULL, &f, &err), GYROAKF_INVALID_ARGUMENT, "order < 0");
  check_failure(gyroakf_filter_new(INT32_MAX, &phi, 1, 1, NULL, &f, &err), GYROAKF_INVALID_ARGUMENT, "order huge");
  check_failure(gyroakf_filter_new(1, &unstable, 1, 1, NULL, &f, &err), GYROAKF_UNSTABLE, "not stationary");
  check_failure(gyroakf_filter_new(1, &nan_phi, 1, 1, NULL, &f, &err), GYROAKF_NON_FINITE, "phi NaN");
  check_failure(gyroakf_filter_new(1, &phi, NAN, 1, NULL, &f, &err), GYROAKF_NON_FINITE, "q NaN");
  check_failure(gyroakf_filter_new(1, &phi, 1, INFINITY, NULL, &f, &err), GYROAKF_NON_FINITE, "r infinite");
  check_failure(gyroakf_filter_new(1, &phi, -1, 1, NULL, &f, &err), GYROAKF_INVALID_ARGUMENT, "q < 0");
  check_failure(gyroakf_filter_new(1, &phi, 0, 0, NULL, &f, &err), GYROAKF_INVALID_ARGUMENT, "q and r 0");
  gyroakf_filter_options_init(&opt);
  opt.forgetting = 0.0;
  check_failure(gyroakf_filter_new(1, &phi, 1, 1, &opt, &f, &err), GYROAKF_INVALID_ARGUMENT, "forgetting 0");
  gyroakf_filter_options_init(&opt);
  opt.huber = NAN;
  check_failure(gyroakf_filter_new(1, &phi, 1, 1, &opt, &f, &err), GYROAKF_NON_FINITE, "gate NaN");
  gyroakf_filter_options_init(&opt);
  opt.measurement_form = "nonsense";
  check_failure(gyroakf_filter_new(1, &phi, 1, 1, &opt, &f, &err), GYROAKF_INVALID_ARGUMENT, "unknown form");
  opt.struct_size--;
  check_failure(gyroakf_filter_new(1, &phi, 1, 1, &opt, &f, &err), GYROAKF_INVALID_ARGUMENT, "options not initialized");
  gyroakf_filter_free(NULL);
  gyroakf_filter_options_init(NULL);
}

static void test_filter_null(void) {
  double x[2] = {1, 2};
  gyroakf_filter *g = filter_of_kind(0);
  gyroakf_filter_state state;
  check(gyroakf_filter_step(NULL, 1.0, x) == GYROAKF_INVALID_ARGUMENT, "step of NULL");
  check(gyroakf_filter_step(g, 1.0, NULL) == GYROAKF_INVALID_ARGUMENT, "step into NULL");
  check(gyroakf_filter_freeze(NULL, 1) == GYROAKF_INVALID_ARGUMENT, "freeze of NULL");
  check(gyroakf_filter_get(NULL, &state) == GYROAKF_INVALID_ARGUMENT, "get of NULL");
  check(gyroakf_filter_get(g, NULL) == GYROAKF_INVALID_ARGUMENT, "get into NULL");
  check_failure(gyroakf_filter_run(NULL, x, 2, x, &err), GYROAKF_INVALID_ARGUMENT, "run of NULL");
  check_failure(gyroakf_filter_run(g, NULL, 2, x, &err), GYROAKF_INVALID_ARGUMENT, "run from NULL");
  check_failure(gyroakf_filter_run(g, x, 2, NULL, &err), GYROAKF_INVALID_ARGUMENT, "run into NULL");
  check_failure(gyroakf_filter_run(g, x, 0, x, &err), GYROAKF_INVALID_ARGUMENT, "run of 0 samples");
  check_failure(gyroakf_filter_run(g, x, INT64_MAX, x, &err), GYROAKF_INVALID_ARGUMENT, "run of too many samples");
  check(gyroakf_filter_get(g, &state) == GYROAKF_OK && state.steps == 0, "none of that was a step");
  gyroakf_filter_free(g);
}

/* A message longer than its place is cut at a whole character and ended. */
static void test_long_message(void) {
  char name[2000];
  double x[4] = {1, 2, 4, 3};
  gyroakf_allan_options opt;
  gyroakf_allan *a = NULL;
  int i;
  size_t length;
  for (i = 0; i < 1998; i += 2) memcpy(name + i, "\303\274", 2); /* u with two dots in UTF-8 */
  name[1998] = '\0';
  gyroakf_allan_options_init(&opt);
  opt.kind = name;
  check(gyroakf_allan_new(x, 4, 1.0, &opt, &a, &err) == GYROAKF_INVALID_ARGUMENT, "a very long kind");
  length = strlen(err.message);
  check(length >= 250 && length <= 255, "the message fills its place");
  check(length > 2 && err.message[length - 1] == '\274' && err.message[length - 2] == '\303', "it ends with a whole character");
}

/* A program with floating-point traps on: the library does not die of them, and traps and flags are as they were. */
static void test_environment(void) {
#if defined(__GLIBC__) && defined(__x86_64__)
  double x[64], bad[64], y;
  gyroakf_allan *a = NULL;
  gyroakf_filter *f = NULL;
  gyroakf_record *r = NULL;
  gyroakf_noise noise;
  gyroakf_adf adf;
  double phi = 0.5;
  int32_t order;
  int i, before;
  nbs(x, 64);
  for (i = 0; i < 64; i++) bad[i] = i % 2 ? NAN : x[i];
  feclearexcept(FE_ALL_EXCEPT);
  feraiseexcept(FE_INEXACT);
  before = fegetexcept() | FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW;
  feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
  if (fegetexcept() != before) { /* valgrind is such a processor */
    puts("this processor has no floating-point traps: they are not tested");
    return;
  }
  gyroakf_record_parse("0 1e308 1\n1 nan 2\n1e308 inf 3\n", 30, NULL, &r, &err);
  gyroakf_record_free(r);
  gyroakf_record_parse("time gx\n0 1e308\nnan 5\n1e308 1\n", 30, NULL, &r, &err);
  gyroakf_record_free(r);
  gyroakf_allan_new(x, 64, 1.0, NULL, &a, &err);
  gyroakf_noise_fit(a, NULL, &noise, &err);
  gyroakf_allan_free(a);
  gyroakf_allan_new(bad, 64, NAN, NULL, &a, &err);
  gyroakf_adf_test(x, 64, NULL, &adf, &err);
  gyroakf_adf_test(bad, 64, NULL, &adf, &err);
  gyroakf_ar_fit(bad, 64, NULL, 1, &order, &phi, NULL, NULL, &err);
  phi = 0.5;
  gyroakf_filter_new(1, &phi, NAN, 1.0, NULL, &f, &err);
  phi = 0.5;
  gyroakf_filter_new(1, &phi, 1.0, 1.0, NULL, &f, &err);
  check(fegetexcept() == before, "traps are on again");
  check(fetestexcept(FE_ALL_EXCEPT) == FE_INEXACT, "flags are as they were");
  gyroakf_filter_run(f, bad, 64, bad, &err);
  gyroakf_filter_step(f, NAN, &y);
  gyroakf_filter_step(f, INFINITY, &y);
  gyroakf_filter_step(f, 1e200, &y);
  check(fegetexcept() == before, "steps cause no trap");
  gyroakf_filter_free(f);
  fedisableexcept(FE_ALL_EXCEPT);
#endif
}

/* Writes a file for a test, reads it and removes it. */
static int read_text(const char *text, const gyroakf_reader_options *opt, gyroakf_record **r) {
  const char *path = "test_c_api.tmp";
  FILE *file = fopen(path, "wb");
  int status;
  check(file != NULL, "a file can be written");
  if (!file) return GYROAKF_IO;
  fputs(text, file);
  fclose(file);
  status = gyroakf_record_read(path, opt, r, &err);
  remove(path);
  return status;
}

/* A file with names, units, a time column and a lost sample: all that is known about it. */
static void test_record_values(void) {
  static const char text[] =
    "time_s,gx [deg/s],ax [m/s^2]\n0.0,1.5,-2\n0.1,nan,-3\n0.2,2.5,-4\n0.3,3.5,-5\n0.5,4.5,-6\n0.5,5.5,-7\n";
  gyroakf_record *r = NULL;
  gyroakf_audit audit;
  const double *x;
  check_success(read_text(text, NULL, &r), "a file with two channels");
  check(gyroakf_record_channels(r) == 2 && gyroakf_record_samples(r) >= 6, "two channels, six samples or more");
  x = gyroakf_record_values(r, 0);
  check(x && x[0] == 1.5 && isnan(x[1]) && x[2] == 2.5, "values, NaN where missing");
  check(gyroakf_record_values(r, 1) && gyroakf_record_values(r, 1)[2] == -4.0, "values of the other channel");
  check(gyroakf_record_present(r, 0) && gyroakf_record_present(r, 0)[1] == 0 && gyroakf_record_present(r, 0)[2] == 1, "marks");
  check(strcmp(gyroakf_record_name(r, 0), "gx") == 0 && strcmp(gyroakf_record_name(r, 1), "ax") == 0, "names");
  check(strcmp(gyroakf_record_unit(r, 0), "deg/s") == 0 && strcmp(gyroakf_record_unit(r, 1), "m/s^2") == 0, "units");
  check(close_to(gyroakf_record_to_si(r, 0), 0.017453292519943295, 1e-15) && gyroakf_record_to_si(r, 1) == 1.0, "units in SI");
  check(close_to(gyroakf_record_sample_interval(r), 0.1, 0.05), "sample interval of the time stamps");
  check(strcmp(gyroakf_record_rate_source(r), "timestamps") == 0, "where the rate is from");
  check(strcmp(gyroakf_record_format(r), "text") == 0, "format");
  check(gyroakf_record_warnings(r) > 0 && strlen(gyroakf_record_warning(r, 0)) > 10, "a warning");
  check(gyroakf_record_warning(r, gyroakf_record_warnings(r)) == NULL && gyroakf_record_warning(r, -1) == NULL, "no warning");
  audit.struct_size = sizeof audit;
  check(gyroakf_record_audit(r, &audit) == GYROAKF_OK, "audit");
  check(audit.struct_size == sizeof audit && audit.samples == gyroakf_record_samples(r), "audit: samples");
  check(audit.has_stamps == 1 && audit.missing >= 1 && audit.bad_lines == 0, "audit: stamps, missing samples");
  check(audit.duplicates == 1 && audit.first_duplicate == 7 && audit.first_backward_step == 0, "audit: equal stamp");
  gyroakf_record_free(r);
}

/* Bytes in memory, every option. */
static void test_record_options(void) {
  static const char text[] = "garbage\n1 10 7\n2 x 7\n4 30 7\n7 40 7\n";
  gyroakf_reader_options opt;
  gyroakf_record *r = NULL;
  const double *x;
  gyroakf_reader_options_init(&opt);
  opt.skip = 1;
  opt.bad_lines_missing = 1;
  opt.columns = "2,1";
  opt.rate_hz = 10.0;
  opt.unit = "rad/s";
  opt.scale = 2.0;
  opt.format = "text";
  opt.to = 0.3;
  check_success(gyroakf_record_parse(text, sizeof text - 1, &opt, &r, &err), "bytes with options");
  check(gyroakf_record_channels(r) == 2 && gyroakf_record_samples(r) == 3, "part of the bytes");
  x = gyroakf_record_values(r, 0);
  check(x && x[0] == 20.0 && isnan(x[1]) && x[2] == 60.0, "chosen, scaled, a bad line missing");
  check(gyroakf_record_sample_interval(r) == 0.1, "rate given");
  check(strcmp(gyroakf_record_rate_source(r), "option") == 0, "rate from the option");
  check(strcmp(gyroakf_record_name(r, 0), "column2") == 0 && strcmp(gyroakf_record_unit(r, 1), "rad/s") == 0, "names, units");
  gyroakf_record_free(r);
  gyroakf_reader_options_init(&opt);
  opt.input = "angle";
  opt.time_column = "1";
  opt.columns = "2";
  check_success(gyroakf_record_parse("0.0 1\n0.5 2\n1.0 4\n", 18, &opt, &r, &err), "angles");
  x = gyroakf_record_values(r, 0);
  check(gyroakf_record_samples(r) == 2 && x && x[0] == 2.0 && x[1] == 4.0, "rates of angles");
  check(gyroakf_record_present(r, 0) == NULL, "no marks where nothing is missing");
  check(gyroakf_record_to_si(r, 0) == 0.0 && strcmp(gyroakf_record_unit(r, 0), "") == 0, "an unknown unit");
  gyroakf_record_free(r);
}

/* Numbers that are no text. */
static void test_record_raw(void) {
  static const double rows[6] = {1.0, -1.0, 2.0, NAN, 3.0, -3.0};
  gyroakf_reader_options opt;
  gyroakf_record *r = NULL;
  gyroakf_reader_options_init(&opt);
  opt.format = "f64";
  opt.channels = 2;
  check_success(gyroakf_record_parse(rows, sizeof rows, &opt, &r, &err), "raw numbers");
  check(gyroakf_record_samples(r) == 3 && gyroakf_record_channels(r) == 2, "raw numbers: shape");
  check(gyroakf_record_values(r, 0)[2] == 3.0 && isnan(gyroakf_record_values(r, 1)[1]), "raw numbers: values");
  check(strcmp(gyroakf_record_format(r), "f64le") == 0, "raw numbers: format");
  gyroakf_record_free(r);
  gyroakf_reader_options_init(&opt);
  opt.decimal_comma = 1;
  check_success(gyroakf_record_parse("1,5 2\n3,5 4", 11, &opt, &r, &err), "decimal commas");
  check(gyroakf_record_values(r, 0)[1] == 3.5, "decimal commas: a value");
  gyroakf_record_free(r);
}

static void test_record_failures(void) {
  gyroakf_record *r = (gyroakf_record *)&err;
  gyroakf_reader_options opt;
  gyroakf_audit audit;
  gyroakf_reader_options_init(NULL);
  check_failure(gyroakf_record_read(NULL, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "no path");
  check(r == NULL, "no recording after a failure");
  check_failure(gyroakf_record_read("c_api", NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "no place for the recording");
  check_failure(gyroakf_record_read("", NULL, &r, &err), GYROAKF_IO, "an empty path");
  check_failure(gyroakf_record_read(".", NULL, &r, &err), GYROAKF_IO, "a directory");
  check_failure(gyroakf_record_read("no such file", NULL, &r, &err), GYROAKF_IO, "no such file");
  check_failure(gyroakf_record_parse(NULL, 3, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "no bytes");
  check_failure(gyroakf_record_parse("1 2", 0, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "a count of 0");
  check_failure(gyroakf_record_parse("1 2", -1, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "a negative count");
  check_failure(gyroakf_record_parse("1 2", INT64_MAX, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "an absurd count");
  check(gyroakf_record_parse("1 2\n3 x\n", 8, NULL, &r, &err) == GYROAKF_PARSE, "no number");
  check(strncmp(err.message, "<memory>:2:3: ", 14) == 0, "the place of what is wrong");
  check(gyroakf_record_parse("1 2", 3, NULL, &r, NULL) == GYROAKF_OK, "no err");
  check(gyroakf_record_samples(NULL) == 0 && gyroakf_record_channels(NULL) == 0, "nothing in NULL");
  check(!gyroakf_record_values(NULL, 0) && !gyroakf_record_values(r, 2) && !gyroakf_record_values(r, -1), "no such values");
  check(!gyroakf_record_present(NULL, 0) && !gyroakf_record_present(r, 2), "no such marks");
  check(!gyroakf_record_name(NULL, 0) && !gyroakf_record_name(r, 2) && !gyroakf_record_unit(r, INT32_MIN), "no such channel");
  check(gyroakf_record_to_si(r, 2) == 0.0 && !gyroakf_record_format(NULL) && !gyroakf_record_rate_source(NULL), "none of these");
  check(gyroakf_record_warnings(NULL) == 0 && gyroakf_record_sample_interval(NULL) == 0.0, "nor of these");
  audit.struct_size = 0;
  check(gyroakf_record_audit(r, &audit) == GYROAKF_INVALID_ARGUMENT, "struct_size of the audit");
  check(gyroakf_record_audit(r, NULL) == GYROAKF_INVALID_ARGUMENT, "no audit");
  check(gyroakf_record_audit(NULL, &audit) == GYROAKF_INVALID_ARGUMENT, "audit of NULL");
  gyroakf_record_free(r);
  gyroakf_record_free(NULL);
  gyroakf_reader_options_init(&opt);
  opt.struct_size = 8;
  check_failure(gyroakf_record_parse("1", 1, &opt, &r, &err), GYROAKF_INVALID_ARGUMENT, "struct_size of the options");
}

/* One option out of its range: refused. */
static void test_record_options_failures(void) {
  gyroakf_record *r = NULL;
  gyroakf_reader_options good, opt;
  gyroakf_reader_options_init(&good);
#define REFUSED(member, value) \
  opt = good; \
  opt.member = value; \
  check_any_failure(gyroakf_record_parse("1 2\n3 4\n", 8, &opt, &r, &err), #member " " #value); \
  check(r == NULL, #member " " #value)
  REFUSED(format, "jpeg");
  REFUSED(format, "");
  REFUSED(columns, "3");
  REFUSED(columns, "no such name");
  REFUSED(columns, "");
  REFUSED(time_column, "9");
  REFUSED(skip, -1);
  REFUSED(skip, 2);
  REFUSED(input, "position");
  REFUSED(input, "increment");
  REFUSED(unit, "furlong");
  REFUSED(scale, 0.0);
  REFUSED(scale, NAN);
  REFUSED(scale, INFINITY);
  REFUSED(rate_hz, -1.0);
  REFUSED(rate_hz, NAN);
  REFUSED(rate_hz, INFINITY);
  REFUSED(from, -1.0);
  REFUSED(from, NAN);
  REFUSED(to, NAN);
  REFUSED(to, 0.0);
  REFUSED(memory, 1);
  REFUSED(resample, "cubic");
  REFUSED(wrap, "sometimes");
  REFUSED(channels, -1);
  REFUSED(channels, 2);
#undef REFUSED
}

/* Without an argument all tests; "threads": those of two threads alone, for tools that watch threads; "faults": with ci/faults. */
int main(int argc, char **argv) {
  memset(&err, 0x55, sizeof err);
  if (argc > 1 && strcmp(argv[1], "threads") == 0) {
    test_threads_briefly();
    printf("%d passed, %d failed\n", passed, failed);
    return failed > 0;
  }
  if (argc > 1 && strcmp(argv[1], "faults") == 0) {
    test_faults();
    printf("%d passed, %d failed\n", passed, failed);
    return failed > 0;
  }
  test_memory();
  test_release();
  test_record_values();
  test_record_options();
  test_record_raw();
  test_record_failures();
  test_record_options_failures();
  test_allan_values();
  test_allan_limits();
  test_allan_missing();
  test_allan_failures();
  test_allan_options();
  test_noise();
  test_noise_failures();
  test_outliers();
  test_adf();
  test_adf_failures();
  test_kpss();
  test_kpss_failures();
  test_ar();
  test_ar_failures();
  test_filter_values();
  test_filter_run();
  test_filter_freeze();
  test_filter_failures();
  test_filter_null();
  test_long_message();
  test_environment();
  test_progress();
  test_run();
  test_drift();
  test_bad();
  test_promises();
  test_children();
  test_host();
  test_threads();
  printf("%d passed, %d failed\n", passed, failed);
  return failed > 0;
}
