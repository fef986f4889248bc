/* SPDX-License-Identifier: MIT */
/*
 * How long the long calls of the C interface say nothing: before they call their progress function for the first time, between two
 * calls of it, and behind the last. That long a program waits at most until a call that it wants to cancel comes back.
 *
 *   silence SAMPLES [WORD]     WORD: only the calls in whose name it stands
 *
 * For each call: its wall time, how often it told, the longest silence in seconds of the processor (of the whole process: for one
 * thread; other programs do not count) and of the clock on the wall, and behind which stage and share the first of them was.
 */
#define _POSIX_C_SOURCE 200809L
#include "gyroakf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ------------------------------------------------------------------------------------------------------------------ the listener */

typedef struct instant {
  double processor, wall;
} instant;

static struct {
  instant begin, last, longest;
  long told;
  char now[80], where[80];
} ear;
static const char *wanted;
static double worst;

static double seconds(clockid_t clock) {
  struct timespec t;
  clock_gettime(clock, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static instant now(void) {
  instant t;
  t.processor = seconds(CLOCK_PROCESS_CPUTIME_ID);
  t.wall = seconds(CLOCK_MONOTONIC);
  return t;
}

static void hear(void) {
  instant t = now();
  if (t.processor - ear.last.processor > ear.longest.processor) {
    ear.longest.processor = t.processor - ear.last.processor;
    memcpy(ear.where, ear.now, sizeof ear.where);
  }
  if (t.wall - ear.last.wall > ear.longest.wall) ear.longest.wall = t.wall - ear.last.wall;
  ear.last = t;
}

static int32_t listen(void *user, const char *stage, int64_t done, int64_t total) {
  (void)user;
  hear();
  ear.told++;
  snprintf(ear.now, sizeof ear.now, "%.40s, %lld of %lld", stage, (long long)done, (long long)total);
  ear.last = now();
  return 0;
}

static int begin(const char *name) {
  if (wanted != NULL && strstr(name, wanted) == NULL) return 0;
  memset(&ear, 0, sizeof ear);
  strcpy(ear.now, "the beginning");
  ear.begin = ear.last = now();
  return 1;
}

static void end(const char *name, int status) {
  hear();
  printf("%-32s %8.2f %8ld %9.3f %9.3f  %s%s%s\n", name, ear.last.wall - ear.begin.wall, ear.told, ear.longest.processor,
         ear.longest.wall, ear.where, status == GYROAKF_OK ? "" : ": ", status == GYROAKF_OK ? "" : gyroakf_status_string(status));
  fflush(stdout);
  if (ear.longest.processor > worst) worst = ear.longest.processor;
}

/* a call with options of this type, whose members the statement may set before it sets status */
#define WITH(name, type, statement) \
  do { \
    if (begin(name)) { \
      int status; \
      gyroakf_##type##_options opt; \
      gyroakf_##type##_options_init(&opt); \
      opt.progress = listen; \
      statement; \
      end(name, status); \
    } \
  } while (0)

/* a call that is handed the listener itself */
#define WATCHED(name, statement) \
  do { \
    if (begin(name)) { \
      int status; \
      statement; \
      end(name, status); \
    } \
  } while (0)

/* --------------------------------------------------------------------------------------------------------------------- the calls */

static double *x, *y;
static int64_t n;

static void allan(void) {
  static const char *const kinds[] = {"oadev", "adev", "mdev", "tdev", "hdev", "ohdev", "totdev"};
  char name[40];
  size_t k;
  gyroakf_allan *a;
  for (k = 0; k < sizeof kinds / sizeof *kinds; k++) {
    snprintf(name, sizeof name, "Allan, %s", kinds[k]);
    WITH(name, allan, opt.kind = kinds[k]; status = gyroakf_allan_new(x, n, 0.01, &opt, &a, NULL); gyroakf_allan_free(a));
  }
}

static void outliers(void) {
  static const char *const methods[] = {"auto", "pauta", "mad", "hampel"};
  int8_t *inlier = (int8_t *)malloc((size_t)n);
  char name[40];
  size_t k;
  if (inlier == NULL) exit(2);
  for (k = 0; k < sizeof methods / sizeof *methods; k++) {
    snprintf(name, sizeof name, "outliers, %s", methods[k]);
    WITH(name, outlier, opt.method = methods[k]; status = gyroakf_mark_outliers(x, n, &opt, inlier, NULL, NULL));
  }
  WITH("outliers, auto, no trend", outlier, opt.degree = -1; status = gyroakf_mark_outliers(x, n, &opt, inlier, NULL, NULL));
  WITH("outliers, hampel, 1000 wide", outlier, opt.method = "hampel"; opt.half_width = 500;
       status = gyroakf_mark_outliers(x, n, &opt, inlier, NULL, NULL));
  WITH("outliers, hampel, widest, a part", outlier, opt.method = "hampel"; opt.half_width = 100000;
       status = gyroakf_mark_outliers(x, n / 100, &opt, inlier, NULL, NULL));
  free(inlier);
}

static void tests(void) {
  gyroakf_adf adf;
  gyroakf_kpss kpss;
  WITH("ADF", adf, status = gyroakf_adf_test(x, n, &opt, &adf, NULL));
  WITH("ADF, ctt, by t", adf, opt.regression = "ctt"; opt.criterion = "t"; status = gyroakf_adf_test(x, n, &opt, &adf, NULL));
  WITH("KPSS", kpss, status = gyroakf_kpss_test(x, n, &opt, &kpss, NULL));
  WITH("KPSS, line", kpss, opt.regression = "ct"; status = gyroakf_kpss_test(x, n, &opt, &kpss, NULL));
}

static void models(void) {
  static const char *const methods[] = {"yw", "burg", "ols"};
  double phi[40];
  int32_t order;
  char name[40];
  size_t k;
  for (k = 0; k < sizeof methods / sizeof *methods; k++) {
    snprintf(name, sizeof name, "AR, %s", methods[k]);
    WITH(name, ar, opt.method = methods[k]; status = gyroakf_ar_fit(x, n, &opt, 12, &order, phi, NULL, NULL, NULL));
  }
}

static void filters(void) {
  const double phi[8] = {0.3, 0.2, 0.1, 0.05, 0.04, 0.03, 0.02, 0.01};
  gyroakf_filter_options adaptive, both;
  gyroakf_drift_model model;
  gyroakf_filter *f;
  gyroakf_filter_options_init(&adaptive);
  adaptive.estimate_measurement_variance = 1;
  both = adaptive;
  both.measurement_form = "exact";
  both.estimate_process_variance = both.estimate_process_mean = 1;
  gyroakf_filter_new(1, phi, 1e-4, 1e-2, &adaptive, &f, NULL);
  WATCHED("filter, one coefficient", status = gyroakf_filter_run_watched(f, x, n, y, listen, NULL, NULL));
  gyroakf_filter_free(f);
  gyroakf_filter_new(8, phi, 1e-4, 1e-2, &both, &f, NULL);
  WATCHED("filter, eight coefficients", status = gyroakf_filter_run_watched(f, x, n, y, listen, NULL, NULL));
  gyroakf_filter_free(f);
  WITH("drift, identification", drift, gyroakf_drift_model_init(&model); status = gyroakf_drift_identify(x, n, &opt, &model, NULL));
  WITH("drift, long part", drift, gyroakf_drift_model_init(&model); opt.most_samples = n/10 + 50;
       status = gyroakf_drift_identify(x, n, &opt, &model, NULL));
  gyroakf_drift_model_init(&model);
  model.count = model.slow[0] = 1;
  model.phi[0] = 1.0;
  model.q[0] = 1e-6;
  model.r = 1e-2;
  WATCHED("smoother", status = gyroakf_drift_smooth_watched(&model, x, n, y, NULL, NULL, listen, NULL, NULL));
  WATCHED("smoother, adaptive", status = gyroakf_drift_smooth_watched(&model, x, n, y, NULL, &adaptive, listen, NULL, NULL));
}

static void recordings(void) {
  const int64_t length = 10 * n; /* "-1.234567\n" */
  char *bytes = (char *)malloc((size_t)length);
  const double *values[2];
  gyroakf_record *r;
  gyroakf_result *result;
  int64_t i;
  if (bytes == NULL) exit(2);
  for (i = 0; i < n; i++) {
    char line[32];
    snprintf(line, sizeof line, "%+9.6f\n", x[i] == x[i] ? fmod(x[i], 10) : 0.0);
    memcpy(bytes + 10 * i, line, 10);
  }
  WITH("reading text", reader, status = gyroakf_record_parse(bytes, length, &opt, &r, NULL); gyroakf_record_free(r));
  WITH("reading raw numbers", reader, opt.format = "i16le"; opt.unit = "deg/s"; opt.rate_hz = 100;
       status = gyroakf_record_parse(bytes, 2 * n, &opt, &r, NULL); gyroakf_record_free(r));
  WITH("reading angles", reader, opt.format = "i16le"; opt.unit = "deg"; opt.rate_hz = 100; opt.input = "angle"; opt.wrap = "65536";
       status = gyroakf_record_parse(bytes, 2 * n, &opt, &r, NULL); gyroakf_record_free(r));
  free(bytes);
  values[0] = values[1] = x;
  WATCHED("a recording of two arrays", status = gyroakf_record_new_watched(values, 2, n, 0.01, NULL, "deg/s", &r, listen, NULL, NULL);
          gyroakf_record_free(r));
  if (gyroakf_record_new(values, 1, n, 0.01, NULL, "deg/s", &r, NULL) != GYROAKF_OK) exit(2);
  WITH("the whole job", run, status = gyroakf_run(r, &opt, &result, NULL); gyroakf_result_free(result));
  WITH("the whole job, paper", run, opt.preset = "paper";
       status = gyroakf_run(r, &opt, &result, NULL); gyroakf_result_free(result));
  gyroakf_record_free(r);
}

int main(int argc, char **argv) {
  gyroakf_record *r = NULL;
  gyroakf_simulate_options opt;
  int gaps;
  int64_t i;
  n = argc > 1 ? strtoll(argv[1], NULL, 10) : 0;
  if (n < 1000) {
    fprintf(stderr, "usage: silence SAMPLES [WORD]\n");
    return 2;
  }
  wanted = NULL;
  printf("%-32s %8s %8s %9s %9s\n", "", "", "", "longest", "silence");
  printf("%-32s %8s %8s %9s %9s  behind\n", argv[1], "wall, s", "told", "cpu, s", "wall, s");
  gyroakf_simulate_options_init(&opt);
  opt.progress = listen;
  opt.samples = n;
  opt.q = opt.n = opt.b = opt.k = 0.01;
  opt.ar_phi = 0.5;
  opt.ar_variance = 1e-4;
  opt.outliers = n / 1000;
  opt.outlier_size = 8;
  begin("");
  end("simulation", gyroakf_simulate(&opt, &r, NULL));
  wanted = argc > 2 ? argv[2] : NULL;
  x = (double *)malloc((size_t)n * sizeof *x);
  y = (double *)malloc((size_t)n * sizeof *y);
  if (x == NULL || y == NULL || r == NULL) return 2;
  memcpy(x, gyroakf_record_values(r, 0), (size_t)n * sizeof *x);
  gyroakf_record_free(r);
  for (gaps = 0; gaps < 2; gaps++) {
    if (gaps) {
      printf("with gaps\n");
      for (i = 100; i < n; i += 1000) memset(&x[i], 0xff, sizeof *x); /* NaN */
    }
    allan();
    outliers();
    tests();
    models();
    filters();
    recordings();
  }
  printf("figure: longest silence of a call, %s samples, s | %.3f | <= 0.2\n", argv[1], worst);
  free(x);
  free(y);
  return 0;
}
