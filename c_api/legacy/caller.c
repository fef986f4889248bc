/* SPDX-License-Identifier: MIT */
/*
 * A C program that calls the FORTRAN 77 names, as older C code does: an underscore behind the name, every argument by its address.
 * It tests them: they give what the C interface gives, and say which argument is bad. The last line is "N passed, N failed".
 */
#include "gyroakf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef __cplusplus
extern "C" {
#endif
void gyadev_(const int32_t *n, const double *x, const double *dt, const int32_t *kind, const int32_t *maxt, int32_t *nt, double *tau,
             double *dev, double *dlo, double *dhi, double *edf, int32_t *info);
void gynfit_(const int32_t *n, const double *x, const double *dt, double *coef, double *se, double *upper, int32_t *idet,
             double *chi2, int32_t *info);
void gyadft_(const int32_t *n, const double *x, const int32_t *maxlag, double *stat, double *pval, double *crit, int32_t *lag,
             int32_t *info);
void gyarft_(const int32_t *n, const double *x, const int32_t *method, const int32_t *maxp, int32_t *ip, double *phi, double *var,
             double *xmean, int32_t *info);
void gyfini_(const int32_t *ip, const double *phi, const double *q, const double *r, const int32_t *iadapt, const double *b,
             double *work, const int32_t *lwork, int32_t *info);
void gyfstp_(double *work, const double *z, double *x, int32_t *info);
void gyfrun_(double *work, const int32_t *n, const double *z, double *x, int32_t *info);
void gyfget_(const double *work, double *state, int32_t *info);
void gyffrz_(double *work, const int32_t *ifrz, int32_t *info);
void gyclen_(const int32_t *n, const double *x, const int32_t *ideg, double *z, int32_t *nrem, int32_t *info);
void gyfdes_(const int32_t *n, const double *x, const double *dt, const int32_t *kind, double *xmean, int32_t *ih, int32_t *info);
void gyhstp_(const int32_t *ih, const double *z, double *x, int32_t *info);
void gyhfrz_(const int32_t *ih, const int32_t *ifrz, int32_t *info);
void gyhfre_(int32_t *ih);
#ifdef __cplusplus
}
#endif

enum { samples = 4000, points = 64, room = 100 };

static int passed, failed;

static void check(int good, const char *what) {
  if (good) {
    passed++;
  } else {
    failed++;
    printf("FAILED: %s\n", what);
  }
}

static int same(const double *a, const double *b, int64_t n) { return memcmp(a, b, (size_t)n * sizeof *a) == 0; }

static double x[samples];
static int32_t n = samples, info;

static void test_allan(void) {
  static const char *const kinds[7] = {"oadev", "adev", "mdev", "tdev", "hdev", "ohdev", "totdev"};
  double tau[points], dev[points], lower[points], upper[points], edf[points], dt = 0.01, bad = -1.0;
  double coef[5], se[5], limit[5], chi2;
  int32_t kind, nt, most = points, few = 2, one = 1, none = 0, detected[5];
  gyroakf_allan_options opt;
  gyroakf_allan *a = NULL;
  gyroakf_noise noise;
  gyroakf_allan_options_init(&opt);
  for (kind = 7; kind >= 1; kind--) {
    opt.kind = kinds[kind - 1];
    gyroakf_allan_free(a);
    check(gyroakf_allan_new(x, n, dt, &opt, &a, NULL) == GYROAKF_OK, opt.kind);
    gyadev_(&n, x, &dt, &kind, &most, &nt, tau, dev, lower, upper, edf, &info);
    check(info == 0 && nt == gyroakf_allan_size(a), opt.kind);
    check(same(tau, gyroakf_allan_tau(a), nt) && same(dev, gyroakf_allan_deviation(a), nt), opt.kind);
    if (kind == 1) check(gyroakf_allan_fit(a, NULL, &noise, NULL) == GYROAKF_OK, "the limits of the fit");
    check(same(lower, gyroakf_allan_lower(a), nt) && same(upper, gyroakf_allan_upper(a), nt), opt.kind);
    check(same(edf, gyroakf_allan_edf(a), nt), opt.kind);
  }
  gynfit_(&n, x, &dt, coef, se, limit, detected, &chi2, &info); /* a is the curve of oadev now */
  check(info == 0 && gyroakf_noise_fit(a, NULL, &noise, NULL) == GYROAKF_OK, "noise coefficients");
  check(coef[1] == noise.n.value && se[1] == noise.n.std_error && limit[3] == noise.k.upper_limit, "noise coefficients");
  check(detected[1] == noise.n.detected && chi2 == noise.chi2_reduced, "noise coefficients");
  gyroakf_allan_free(a);
  gyadev_(&one, x, &dt, &one, &most, &nt, tau, dev, lower, upper, edf, &info);
  check(info == -1, "GYADEV: N = 1");
  gyadev_(&n, x, &dt, &none, &most, &nt, tau, dev, lower, upper, edf, &info);
  check(info == -4, "GYADEV: KIND = 0");
  gyadev_(&n, x, &dt, &one, &few, &nt, tau, dev, lower, upper, edf, &info);
  check(info == -5 && nt > few, "GYADEV: MAXT too small, NT says how many");
  gyadev_(&n, x, &bad, &one, &most, &nt, tau, dev, lower, upper, edf, &info);
  check(info == GYROAKF_INVALID_ARGUMENT, "GYADEV: DT < 0");
  gynfit_(&one, x, &dt, coef, se, limit, detected, &chi2, &info);
  check(info == -1, "GYNFIT: N = 1");
}

static void test_models(void) {
  double stat, p, crit[3], phi[5], expected[5], var, mean, variance, center, constant[50];
  int32_t usual = -1, bad = -2, lag, order, chosen, method = 1, most = 5, none = 0, few = 50, i;
  gyroakf_adf adf;
  gyadft_(&n, x, &usual, &stat, &p, crit, &lag, &info);
  check(info == 0 && gyroakf_adf_test(x, n, NULL, &adf, NULL) == GYROAKF_OK, "unit-root test");
  check(stat == adf.statistic && p == adf.p_value && same(crit, adf.critical, 3) && lag == adf.lag, "unit-root test");
  gyadft_(&n, x, &bad, &stat, &p, crit, &lag, &info);
  check(info == -3, "GYADFT: MAXLAG = -2");
  gyarft_(&n, x, &method, &most, &order, phi, &var, &mean, &info);
  check(info == 0 && gyroakf_ar_fit(x, n, NULL, 5, &chosen, expected, &variance, &center, NULL) == GYROAKF_OK, "AR model");
  check(order == chosen && same(phi, expected, 5) && var == variance && mean == center, "AR model");
  gyarft_(&n, x, &none, &most, &order, phi, &var, &mean, &info);
  check(info == -3, "GYARFT: METHOD = 0");
  gyarft_(&n, x, &method, &bad, &order, phi, &var, &mean, &info);
  check(info == -4, "GYARFT: MAXP < 0");
  for (i = 0; i < 50; i++) constant[i] = 1.0;
  gyarft_(&few, constant, &method, &most, &order, phi, &var, &mean, &info);
  check(info == GYROAKF_CONSTANT_INPUT, "GYARFT: a constant");
}

/* The cleaned series, and the filters that are made for it. */
static void test_designed(void) {
  static const char *const kinds[4] = {"kf", "akf", "drift_kf", "drift_akf"};
  static double walk[samples];
  double z[samples], expected[samples], mean, xmean, dt = 0.01, a, b;
  int32_t ih[2], kind, none = 0, five = 5, line = 1, ten = 10, removed, i, on = 1;
  gyroakf_outlier_options opt;
  gyroakf_outliers figures;
  gyroakf_filter *f;
  for (i = 1; i < samples; i++) walk[i] = walk[i - 1] + 0.1 * (x[i] - 0.5);
  for (i = 0; i < samples; i++) walk[i] += x[samples - 1 - i];
  gyroakf_outlier_options_init(&opt);
  opt.degree = 1;
  gyclen_(&n, walk, &line, z, &removed, &info);
  check(info == 0 && gyroakf_clean(walk, n, &opt, expected, &figures, NULL) == GYROAKF_OK, "GYCLEN");
  check(same(z, expected, n) && removed == figures.removed, "GYCLEN");
  gyclen_(&n, walk, &ten, z, &removed, &info);
  check(info == -3, "GYCLEN: IDEG = 10");
  for (kind = 1; kind <= 4; kind++) {
    gyfdes_(&n, walk, &dt, &kind, &xmean, ih, &info);
    check(info == 0 && gyroakf_filter_identify(kinds[kind - 1], walk, n, dt, NULL, &f, &mean, NULL) == GYROAKF_OK, "GYFDES");
    check(xmean == mean, "GYFDES: XMEAN");
    for (i = 0; i < samples; i++) {
      const double sample = walk[i] - xmean;
      gyhstp_(ih, &sample, &a, &info);
      check(info == 0 && gyroakf_filter_step(f, sample, &b) == GYROAKF_OK && same(&a, &b, 1), "GYHSTP");
      if (i == samples / 2) {
        gyhfrz_(ih, &on, &info);
        check(info == 0 && gyroakf_filter_freeze(f, 1) == GYROAKF_OK, "GYHFRZ");
      }
    }
    gyroakf_filter_free(f);
    gyhfre_(ih);
    gyhstp_(ih, &dt, &a, &info);
    check(info == -1, "GYHSTP: no filter");
  }
  gyfdes_(&n, walk, &dt, &five, &xmean, ih, &info);
  check(info == -4 && ih[0] == 0 && ih[1] == 0, "GYFDES: KIND = 5");
  gyfdes_(&none, walk, &dt, &line, &xmean, ih, &info);
  check(info == -1, "GYFDES: N = 0");
}

/* Order p, adapting what `adapt` says, beside the C interface; with gaps, a part frozen, the state copied to another array. */
static void test_filter(int32_t p, const int32_t *adapt, double tolerance) {
  static const double phi[3] = {0.5, 0.2, 0.1};
  double work[room], copy[room], q = 1.0, r = 2.0, b = 0.99, z[samples], y[samples], expected[samples], run[samples], state[9];
  double worst = 0.0;
  int32_t lwork = -1, i, on = 1, off = 0, bad = 0;
  gyroakf_filter_options opt;
  gyroakf_filter_state after;
  gyroakf_filter *f = NULL;
  memcpy(z, x, sizeof z);
  for (i = 100; i < 120; i++) z[i] = NAN;
  gyroakf_filter_options_init(&opt);
  opt.estimate_process_mean = adapt[0];
  opt.estimate_measurement_mean = adapt[1];
  opt.estimate_process_variance = adapt[2];
  opt.estimate_measurement_variance = adapt[3];
  opt.forgetting = b;
  check(gyroakf_filter_new(p, phi, q, r, &opt, &f, NULL) == GYROAKF_OK, "a filter");
  gyfini_(&p, phi, &q, &r, adapt, &b, work, &lwork, &info);
  lwork = (int32_t)work[0];
  check(info == 0 && lwork == 40 + 5 * p + p * p && lwork <= room, "GYFINI: the length that is needed");
  gyfini_(&p, phi, &q, &r, adapt, &b, work, &lwork, &info);
  check(info == 0, "GYFINI");
  for (i = 0; i < samples; i++) {
    if (i == 1000 || i == 2000) {
      gyroakf_filter_freeze(f, i == 1000);
      gyffrz_(work, i == 1000 ? &on : &off, &info);
      bad += info != 0;
    }
    gyroakf_filter_step(f, z[i], &expected[i]);
    gyfstp_(work, &z[i], &y[i], &info);
    bad += info != 0;
    if (i == 500) { /* all of the filter is in the array */
      memcpy(copy, work, sizeof copy);
      memset(work, 0, sizeof work);
      memcpy(work, copy, sizeof work);
    }
    if (fabs(y[i] - expected[i]) > worst) worst = fabs(y[i] - expected[i]);
  }
  check(bad == 0 && worst <= tolerance, "GYFSTP as gyroakf_filter_step");
  if (worst > tolerance) printf("  order %d: %g\n", (int)p, worst);
  gyfget_(work, state, &info);
  gyroakf_filter_get(f, &after);
  check(info == 0 && state[0] == y[samples - 1] && fabs(state[0] - after.x) <= tolerance, "GYFGET: x");
  check(fabs(state[1] - after.p) <= tolerance && fabs(state[2] - after.gain) <= tolerance, "GYFGET: P and gain");
  check(fabs(state[7] - after.q) <= tolerance && fabs(state[8] - after.r) <= tolerance, "GYFGET: Q and R");
  gyroakf_filter_free(f);
  gyfini_(&p, phi, &q, &r, adapt, &b, work, &lwork, &info);
  gyfini_(&p, phi, &q, &r, adapt, &b, copy, &lwork, &info);
  for (i = 0; i < samples; i++) gyfstp_(copy, &z[i], &y[i], &info);
  gyfrun_(work, &n, z, run, &info);
  check(info == 0 && same(run, y, samples), "GYFRUN as step by step");
}

static void test_filter_failures(void) {
  double phi = 2.0, q = 1.0, r = 1.0, b = 1.0, work[room], z = 1.0, y, state[9];
  int32_t p = 1, minus = -1, lwork = room, small = 45, adapt[4] = {0, 0, 0, 0};
  memset(work, 0, sizeof work);
  gyfini_(&minus, &phi, &q, &r, adapt, &b, work, &lwork, &info);
  check(info == -1, "GYFINI: IP < 0");
  gyfini_(&p, &phi, &q, &r, adapt, &b, work, &small, &info);
  check(info == -8, "GYFINI: LWORK too small");
  gyfini_(&p, &phi, &q, &r, adapt, &b, work, &lwork, &info);
  check(info == GYROAKF_UNSTABLE, "GYFINI: not stationary");
  gyfstp_(work, &z, &y, &info);
  check(info == -1, "GYFSTP: no filter in WORK");
  gyfrun_(work, &p, &z, &y, &info);
  check(info == -1, "GYFRUN: no filter in WORK");
  gyfget_(work, state, &info);
  check(info == -1, "GYFGET: no filter in WORK");
  gyffrz_(work, &p, &info);
  check(info == -1, "GYFFRZ: no filter in WORK");
  phi = 0.5;
  gyfini_(&p, &phi, &q, &r, adapt, &b, work, &lwork, &info);
  gyfrun_(work, &minus, &z, &y, &info);
  check(info == -2, "GYFRUN: N < 0");
}

int main(void) {
  static const int32_t fixed[4] = {0, 0, 0, 0}, all[4] = {1, 0, 1, 1};
  int64_t s = 1234567890;
  int32_t i, p;
  double before = 0.0;
  for (i = 0; i < samples; i++) { /* AR(1) of uniform noise */
    before = 0.5 * before + ((double)s / 2147483647.0 - 0.5);
    x[i] = before;
    s = 16807 * s % 2147483647;
  }
  test_allan();
  test_models();
  test_designed();
  for (p = 1; p <= 3; p++) { /* of order 1 the library computes in another order: equal but for rounding */
    test_filter(p, fixed, p == 1 ? 1e-13 : 0.0);
    test_filter(p, all, p == 1 ? 1e-12 : 0.0);
  }
  test_filter_failures();
  printf("%d passed, %d failed\n", passed, failed);
  return failed > 0;
}
