/* SPDX-License-Identifier: MIT */
/* Long calls tell how far they are, and can be cancelled at every place where they do. */
#include "check.h"

#include <omp.h>
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

static int run_arma(listener *l) {
  gyroakf_arma_options opt;
  gyroakf_arma arma;
  gyroakf_arma_options_init(&opt);
  opt.max_p = opt.max_q = 1;
  opt.max_samples = 4000;
  opt.progress = listen;
  opt.progress_user = l;
  return gyroakf_arma_fit(x, samples, &opt, &arma, &err);
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
  check_progress(run_adf, "progress of the ADF test", "unit-root");
  check_progress(run_arma, "progress of the ARMA model", "ARMA");
  check_progress(run_drift, "progress of the drift", "identifying");
  check_progress(run_parse, "progress of the reader", "reading");
  free(x);
}
