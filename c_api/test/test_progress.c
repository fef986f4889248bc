/* SPDX-License-Identifier: MIT */
/* Long calls tell how far they are, and can be cancelled at every place where they do. */
#include "check.h"
#include "threads.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { samples = 400000 };

typedef struct listener {
  int calls, last; /* so far; the call that is answered with "cancel", 0: none */
  int good;        /* 1: everything told so far makes sense */
  char stage[81];
} listener;

static int32_t listen(void *user, const char *stage, int64_t done, int64_t total) {
  listener *l = (listener *)user;
  l->calls++;
  l->good = l->good && strlen(stage) > 3 && strlen(stage) < sizeof l->stage && done >= 0 && (total == 0 || done <= total) &&
            !omp_in_parallel();
  if (l->calls == 1) strcpy(l->stage, stage);
  return l->calls == l->last;
}

static double *x;

static int run_allan(listener *l) {
  gyroakf_allan_options opt;
  gyroakf_allan *a = (gyroakf_allan *)l;
  int status;
  gyroakf_allan_options_init(&opt);
  opt.taus = "log:30";
  opt.progress = listen;
  opt.progress_user = l;
  status = gyroakf_allan_new(x, samples, 0.01, &opt, &a, &err);
  check((status == GYROAKF_OK) == (a != NULL), "*out is NULL after a failure");
  gyroakf_allan_free(a);
  return status;
}

static int run_kind(listener *l, const char *kind, const char *taus) {
  gyroakf_allan_options opt;
  gyroakf_allan *a = NULL;
  int status;
  gyroakf_allan_options_init(&opt);
  opt.kind = kind;
  opt.taus = taus;
  opt.progress = listen;
  opt.progress_user = l;
  status = gyroakf_allan_new(x, samples, 0.01, &opt, &a, &err);
  gyroakf_allan_free(a);
  return status;
}

static int run_mdev(listener *l) { return run_kind(l, "mdev", "log:3"); }
static int run_ohdev(listener *l) { return run_kind(l, "ohdev", "log:3"); }
static int run_totdev(listener *l) { return run_kind(l, "totdev", "log:3"); }
static int run_hdev(listener *l) { return run_kind(l, "hdev", "log:3"); }

static int run_gapped(listener *l, const char *kind) {
  double kept = x[1000];
  int status;
  memset(&x[1000], 0xff, sizeof x[1000]); /* NaN */
  status = run_kind(l, kind, "log:3");
  x[1000] = kept;
  return status;
}

static int run_gapped_mdev(listener *l) { return run_gapped(l, "mdev"); }
static int run_gapped_ohdev(listener *l) { return run_gapped(l, "ohdev"); }
static int run_gapped_totdev(listener *l) { return run_gapped(l, "totdev"); }

static int run_kpss(listener *l) {
  gyroakf_kpss_options opt;
  gyroakf_kpss out;
  gyroakf_kpss_options_init(&opt);
  opt.regression = "ct";
  opt.lags = 300;
  opt.progress = listen;
  opt.progress_user = l;
  return gyroakf_kpss_test(x, samples, &opt, &out, &err);
}

static int run_ar_by(listener *l, const char *method) {
  gyroakf_ar_options opt;
  double phi[8], variance;
  int32_t order = -7;
  int status;
  gyroakf_ar_options_init(&opt);
  opt.method = method;
  opt.progress = listen;
  opt.progress_user = l;
  status = gyroakf_ar_fit(x, samples, &opt, 8, &order, phi, &variance, NULL, &err);
  check((status == GYROAKF_OK) == (order != -7), "no order after a failure");
  return status;
}

static int run_ar(listener *l) { return run_ar_by(l, "yw"); }
static int run_least_squares(listener *l) { return run_ar_by(l, "ols"); }

static int run_gapped_burg(listener *l) {
  double kept = x[1000];
  int status;
  memset(&x[1000], 0xff, sizeof x[1000]); /* NaN */
  status = run_ar_by(l, "burg");
  x[1000] = kept;
  return status;
}

static int run_outliers(listener *l) {
  gyroakf_outlier_options opt;
  int8_t *inlier = (int8_t *)malloc(samples);
  int status;
  if (inlier == NULL) abort();
  gyroakf_outlier_options_init(&opt);
  opt.progress = listen;
  opt.progress_user = l;
  status = gyroakf_mark_outliers(x, samples, &opt, inlier, NULL, &err);
  free(inlier);
  return status;
}

static int run_hampel(listener *l) {
  gyroakf_outlier_options opt;
  int8_t *inlier = (int8_t *)malloc(samples);
  int status;
  if (inlier == NULL) abort();
  gyroakf_outlier_options_init(&opt);
  opt.method = "hampel";
  opt.half_width = 2000;
  opt.degree = -1;
  opt.progress = listen;
  opt.progress_user = l;
  status = gyroakf_mark_outliers(x, samples, &opt, inlier, NULL, &err);
  free(inlier);
  return status;
}

static int run_simulate(listener *l) {
  gyroakf_simulate_options opt;
  gyroakf_record *r = NULL;
  int status;
  gyroakf_simulate_options_init(&opt);
  opt.samples = samples;
  opt.q = opt.n = opt.b = opt.k = 0.1;
  opt.progress = listen;
  opt.progress_user = l;
  status = gyroakf_simulate(&opt, &r, &err);
  check((status == GYROAKF_OK) == (r != NULL), "*out is NULL after a failure");
  gyroakf_record_free(r);
  return status;
}

/* A filter goes on where it was cancelled; the estimates up to there are those of a whole run. */
static int run_filter(listener *l) {
  const double phi = 0.9;
  gyroakf_filter_state state;
  gyroakf_filter *f = NULL;
  double *whole = (double *)malloc(2 * samples * sizeof *whole), *part = whole + samples;
  int status, i, good = 1;
  if (whole == NULL) abort();
  check_success(gyroakf_filter_new(1, &phi, 1.0, 1.0, NULL, &f, &err), "a filter");
  check_success(gyroakf_filter_run(f, x, samples, whole, &err), "the whole series");
  check_success(gyroakf_filter_reset(f, &err), "again");
  status = gyroakf_filter_run_watched(f, x, samples, part, listen, l, &err);
  check(gyroakf_filter_get(f, &state) == GYROAKF_OK && (state.steps == samples) == (status == GYROAKF_OK), "steps made");
  for (i = 0; i < state.steps; i++) good = good && part[i] == whole[i];
  check(good, "the estimates up to there");
  if (status == GYROAKF_CANCELLED) {
    gyroakf_error kept = err;
    check_success(gyroakf_filter_run(f, x + state.steps, samples - state.steps, part + state.steps, &err), "the rest");
    check(memcmp(part, whole, samples * sizeof *whole) == 0, "a filter goes on where it was cancelled");
    err = kept;
  }
  gyroakf_filter_free(f);
  free(whole);
  return status;
}

static int run_smoother(listener *l) {
  gyroakf_drift_model model;
  gyroakf_filter_options opt;
  double *drift = (double *)malloc(samples * sizeof *drift);
  int status;
  if (drift == NULL) abort();
  gyroakf_drift_model_init(&model);
  model.count = model.slow[0] = 1;
  model.phi[0] = 0.99;
  model.q[0] = 0.01;
  model.r = 1.0;
  gyroakf_filter_options_init(&opt);
  opt.estimate_measurement_variance = 1;
  status = gyroakf_drift_smooth_watched(&model, x, samples, drift, NULL, &opt, listen, l, &err);
  free(drift);
  return status;
}

static int run_gapped_allan(listener *l) {
  double kept = x[1000];
  int status;
  memset(&x[1000], 0xff, sizeof x[1000]); /* NaN */
  status = run_allan(l);
  x[1000] = kept;
  return status;
}

static int run_adf(listener *l) {
  gyroakf_adf_options opt;
  gyroakf_adf adf;
  gyroakf_adf_options_init(&opt);
  opt.progress = listen;
  opt.progress_user = l;
  return gyroakf_adf_test(x, samples, &opt, &adf, &err);
}

static int run_drift(listener *l) {
  gyroakf_drift_options opt;
  gyroakf_drift_model model;
  gyroakf_drift_options_init(&opt);
  gyroakf_drift_model_init(&model);
  opt.most_samples = 4000;
  opt.progress = listen;
  opt.progress_user = l;
  return gyroakf_drift_identify(x, samples, &opt, &model, &err);
}

static int run_parse(listener *l) {
  static const char line[] = "0.125 -7.25e-3 12345.678\n";
  const size_t rows = 100000, length = sizeof line - 1;
  char *text = (char *)malloc(rows * length);
  gyroakf_reader_options opt;
  gyroakf_record *r = NULL;
  size_t i;
  int status;
  if (text == NULL) abort();
  for (i = 0; i < rows; i++) memcpy(text + i * length, line, length);
  gyroakf_reader_options_init(&opt);
  opt.progress = listen;
  opt.progress_user = l;
  status = gyroakf_record_parse(text, (int64_t)(rows * length), &opt, &r, &err);
  check((status == GYROAKF_OK) == (r != NULL), "*out is NULL after a failure");
  gyroakf_record_free(r);
  free(text);
  return status;
}

static int run_arrays(listener *l) {
  enum { many = 2200000 };
  double *values = (double *)malloc(many * sizeof *values);
  const double *channels[2];
  gyroakf_record *r = (gyroakf_record *)l;
  int status, i;
  if (values == NULL) abort();
  for (i = 0; i < many; i++) values[i] = x[i % samples];
  channels[0] = channels[1] = values;
  status = gyroakf_record_new_watched(channels, 2, many, 0.01, NULL, "deg/s", &r, listen, l, &err);
  check((status == GYROAKF_OK) == (r != NULL), "*out is NULL after a failure");
  gyroakf_record_free(r);
  free(values);
  return status;
}

/* Stages of the whole job within which it is told how far it is. */
static const char *const stages[] = {"stationarity test", "unit-root test", "residuals of the AR model", "normality test",
                                     "steps of the samples"};
enum { stage_count = (int)(sizeof stages / sizeof *stages) };

typedef struct stage_listener {
  int told[stage_count];
  int stage, cancel; /* the time that this stage is answered with "cancel", 0: never */
} stage_listener;

static int32_t listen_to_stages(void *user, const char *stage, int64_t done, int64_t total) {
  stage_listener *s = (stage_listener *)user;
  int k;
  (void)done;
  (void)total;
  for (k = 0; k < stage_count; k++) {
    if (strcmp(stage, stages[k]) == 0) s->told[k]++;
  }
  return s->cancel > 0 && s->told[s->stage] == s->cancel;
}

/* The job ends where it is asked to for the last time within a stage. */
static void test_stages_of_the_job(void) {
  const double *channel[1];
  gyroakf_record *r = NULL;
  gyroakf_result *result;
  gyroakf_run_options opt;
  stage_listener whole, part;
  int k;
  channel[0] = x;
  check_success(gyroakf_record_new(channel, 1, 100000, 0.01, NULL, "deg/s", &r, &err), "a recording");
  gyroakf_run_options_init(&opt);
  opt.allan = opt.filters = 0;
  opt.progress = listen_to_stages;
  opt.progress_user = &whole;
  memset(&whole, 0, sizeof whole);
  check_success(gyroakf_run(r, &opt, &result, &err), "the whole job");
  gyroakf_result_free(result);
  opt.progress_user = &part;
  for (k = 0; k < stage_count; k++) {
    check(whole.told[k] > 0, stages[k]);
    memset(&part, 0, sizeof part);
    part.stage = k;
    part.cancel = whole.told[k];
    check_failure(gyroakf_run(r, &opt, &result, &err), GYROAKF_CANCELLED, stages[k]);
    check(result == NULL && part.told[k] == part.cancel, "no result, and nothing more is told");
  }
  gyroakf_record_free(r);
}

/* It is told so often at least: there is no long silence. */
static void check_often(int (*run)(listener *), int least, const char *what) {
  listener whole;
  memset(&whole, 0, sizeof whole);
  whole.good = 1;
  check_success(run(&whole), what);
  check(whole.calls >= least && whole.good, what);
  if (whole.calls < least) printf("  %d calls\n", whole.calls);
}

/* All that is told, then the same cancelled at the first, a middle and the last call. */
static void check_progress(int (*run)(listener *), const char *what, const char *stage) {
  listener whole, part;
  int k;
  memset(&whole, 0, sizeof whole);
  whole.good = 1;
  check_success(run(&whole), what);
  check(whole.calls > 0 && whole.good, what);
  check(strstr(whole.stage, stage) != NULL, what);
  if (strstr(whole.stage, stage) == NULL) printf("  stage %s\n", whole.stage);
  for (k = 0; k < 3 && whole.calls > 0; k++) {
    memset(&part, 0, sizeof part);
    part.good = 1;
    part.last = k == 0 ? 1 : (whole.calls * k + 1) / 2;
    check_failure(run(&part), GYROAKF_CANCELLED, what);
    check(part.calls == part.last && part.good, "cancelled: nothing more is told");
  }
}

void test_progress(void) {
  x = (double *)malloc(samples * sizeof *x);
  if (x == NULL) abort();
  uniform(x, samples, 99);
  check_progress(run_allan, "progress of the Allan deviation", "Allan");
  check_progress(run_gapped_allan, "progress of the Allan deviation with gaps", "Allan");
  check_progress(run_mdev, "progress of mdev", "Allan");
  check_progress(run_ohdev, "progress of ohdev", "Allan");
  check_progress(run_totdev, "progress of totdev", "Allan");
  check_progress(run_hdev, "progress of hdev", "Allan");
  check_progress(run_gapped_mdev, "progress of mdev with gaps", "Allan");
  check_progress(run_gapped_ohdev, "progress of ohdev with gaps", "Allan");
  check_progress(run_gapped_totdev, "progress of totdev with gaps", "Allan");
  check_progress(run_kpss, "progress of the KPSS test", "stationarity");
  check_progress(run_ar, "progress of the AR model", "autocovariances");
  check_progress(run_least_squares, "progress of the AR model by least squares", "autocovariances");
  check_progress(run_gapped_burg, "progress of the AR model by Burg's recursion", "autocovariances");
  check_progress(run_outliers, "progress of the outliers", "outliers");
  check_progress(run_hampel, "progress of the Hampel filter", "cleaning");
  check_often(run_hampel, 10, "windows of the Hampel filter");
  check_progress(run_simulate, "progress of a simulation", "simulating");
  check_progress(run_filter, "progress of a filter", "filtering");
  check_progress(run_smoother, "progress of the smoother", "weighing");
  check_progress(run_adf, "progress of the ADF test", "unit-root");
  check_progress(run_drift, "progress of the drift", "identifying");
  check_progress(run_arrays, "progress of a recording of arrays", "copying");
  check_often(run_arrays, 6, "samples that are copied");
  check_often(run_gapped_burg, 100, "chunks of Burg's recursion");
  test_stages_of_the_job();
  check_progress(run_parse, "progress of the reader", "reading");
  free(x);
}
