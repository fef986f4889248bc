/* SPDX-License-Identifier: MIT */
/*
 * What the head of gyroakf.h promises of every function, over a table of all that take a series: arguments that are refused, results
 * that are not written, numbers that do not depend on the floating-point environment, which comes back as it was; nothing printed.
 */
#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* feenableexcept */
#endif
#include "check.h"
#include "modes.h"
#include "threads.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { n = 2000, arrays = 3, most_of_options = 512 };

/* What a call gets, and where its results go. */
typedef struct call {
  const double *x; /* [length] */
  int64_t length;
  const void *opt;        /* NULL: defaults */
  double *array[arrays];  /* [n + 1] results */
  unsigned char *figures; /* other results */
} call;

static double series[n], filled[n];
static int lost; /* a handle after a failure, or none after a success */

static int made(int status, const void *handle) {
  if ((status == GYROAKF_OK) != (handle != NULL)) lost++;
  return status;
}

/* ------------------------------------------------------------------------------------------------------------------------ the table */

static void copy_record(gyroakf_record *r, call *c) {
  if (r != NULL) memcpy(c->array[0], gyroakf_record_values(r, 0), (size_t)gyroakf_record_samples(r) * sizeof(double));
  gyroakf_record_free(r);
}

static int record_new(call *c) {
  const double *values[1];
  gyroakf_record *r = (gyroakf_record *)c;
  int status;
  values[0] = c->x;
  status = gyroakf_record_new(values, 1, c->length, 0.01, NULL, "deg/s", &r, &err);
  made(status, r);
  copy_record(r, c);
  return status;
}

static int allan_new(call *c) {
  gyroakf_allan *a = (gyroakf_allan *)c;
  const int status = gyroakf_allan_new(c->x, c->length, 0.01, (const gyroakf_allan_options *)c->opt, &a, &err);
  made(status, a);
  if (a != NULL) memcpy(c->array[0], gyroakf_allan_deviation(a), (size_t)gyroakf_allan_size(a) * sizeof(double));
  if (a != NULL) memcpy(c->array[1], gyroakf_allan_upper(a), (size_t)gyroakf_allan_size(a) * sizeof(double));
  gyroakf_allan_free(a);
  return status;
}

static int noise_fit(call *c) {
  static gyroakf_allan *a; /* of the series, once: this table's calls differ in the options alone */
  if (c->x == NULL) {
    gyroakf_allan_free(a);
    a = NULL;
    return GYROAKF_INVALID_ARGUMENT;
  }
  if (a == NULL) gyroakf_allan_new(filled, n, 0.01, NULL, &a, NULL);
  return gyroakf_noise_fit(a, (const gyroakf_fit_options *)c->opt, (gyroakf_noise *)(void *)c->figures, &err);
}

static int mark_outliers(call *c) {
  return gyroakf_mark_outliers(c->x, c->length, (const gyroakf_outlier_options *)c->opt, (int8_t *)c->figures + 1024,
                               (gyroakf_outliers *)(void *)c->figures, &err);
}

static int clean(call *c) {
  return gyroakf_clean(c->x, c->length, (const gyroakf_outlier_options *)c->opt, c->array[0],
                       (gyroakf_outliers *)(void *)c->figures, &err);
}

static int filter_design(call *c) {
  gyroakf_filter *f = (gyroakf_filter *)c;
  const int status = gyroakf_filter_identify("akf", c->x, c->length, 0.01, (const gyroakf_run_options *)c->opt, &f,
                                           (double *)(void *)c->figures, &err);
  made(status, f);
  gyroakf_filter_free(f);
  return status;
}

static int adf_test(call *c) {
  return gyroakf_adf_test(c->x, c->length, (const gyroakf_adf_options *)c->opt, (gyroakf_adf *)(void *)c->figures, &err);
}

static int kpss_test(call *c) {
  return gyroakf_kpss_test(c->x, c->length, (const gyroakf_kpss_options *)c->opt, (gyroakf_kpss *)(void *)c->figures, &err);
}

static int ar_fit(call *c) {
  return gyroakf_ar_fit(c->x, c->length, (const gyroakf_ar_options *)c->opt, 5, (int32_t *)(void *)c->figures, c->array[0],
                        (double *)(void *)(c->figures + 64), (double *)(void *)(c->figures + 128), &err);
}

static int filter_new(call *c) {
  gyroakf_filter *f = (gyroakf_filter *)c;
  const int status = gyroakf_filter_new(3, c->x, 1.0, 1.0, (const gyroakf_filter_options *)c->opt, &f, &err);
  made(status, f);
  if (f != NULL) gyroakf_filter_get(f, (gyroakf_filter_state *)(void *)c->figures);
  gyroakf_filter_free(f);
  return status;
}

static int filter_run(call *c) {
  const double phi[2] = {0.8, 0.1};
  gyroakf_filter_options opt;
  gyroakf_filter *f = NULL;
  int64_t size = 0;
  int status;
  gyroakf_filter_options_init(&opt);
  opt.estimate_measurement_variance = 1;
  opt.huber = 2.5;
  opt.measurement_form = "exact";
  if (gyroakf_filter_new(2, phi, 0.1, 1.0, &opt, &f, NULL) != GYROAKF_OK) abort();
  status = gyroakf_filter_run(f, c->x, c->length, c->array[0], &err);
  if (status == GYROAKF_OK && gyroakf_filter_save(f, c->figures, 4096, &size, NULL) != GYROAKF_OK) lost++;
  gyroakf_filter_free(f);
  return status;
}

/* Padding of a model: set here, so that models can be compared as bytes. */
static void fill_gap(gyroakf_drift_model *model) {
  const size_t gap = offsetof(gyroakf_drift_model, count) + sizeof model->count;
  const size_t tail = offsetof(gyroakf_drift_model, slow) + sizeof model->slow;
  memset((char *)model + gap, 0x5a, offsetof(gyroakf_drift_model, phi) - gap);
  memset((char *)model + tail, 0x5a, sizeof *model - tail);
}

static int drift_identify(call *c) {
  gyroakf_drift_model *model = (gyroakf_drift_model *)(void *)c->figures, before, fresh;
  int status;
  memcpy(&before, model, sizeof before);
  gyroakf_drift_model_init(model);
  memcpy(&fresh, model, sizeof fresh);
  status = gyroakf_drift_identify(c->x, c->length, (const gyroakf_drift_options *)c->opt, model, &err);
  fill_gap(model);
  if (status == GYROAKF_OK) return status;
  fill_gap(&fresh);
  if (memcmp(&fresh, model, sizeof fresh) != 0) lost++;
  memcpy(model, &before, sizeof before);
  return status;
}

static gyroakf_drift_model drift_model(void) {
  gyroakf_drift_model model;
  gyroakf_drift_model_init(&model);
  model.count = model.slow[0] = 1;
  model.phi[0] = 0.99;
  model.q[0] = 0.01;
  model.r = 1.0;
  return model;
}

static int drift_smooth(call *c) {
  const gyroakf_drift_model model = drift_model();
  return gyroakf_drift_smooth(&model, c->x, c->length, c->array[0], c->array[1], (const gyroakf_filter_options *)c->opt, &err);
}

static int drift_filter_new(call *c) {
  const gyroakf_drift_model model = drift_model();
  gyroakf_filter *f = (gyroakf_filter *)c;
  const int status = gyroakf_drift_filter_new(&model, (const gyroakf_filter_options *)c->opt, &f, &err);
  made(status, f);
  gyroakf_filter_free(f);
  return status;
}

static int simulate(call *c) {
  gyroakf_record *r = (gyroakf_record *)c;
  const int status = gyroakf_simulate((const gyroakf_simulate_options *)c->opt, &r, &err);
  made(status, r);
  copy_record(r, c);
  return status;
}

static const char *parsed = "0.1\n-2.5e-3\nnan\n7e22\n0.3\n"; /* a recording */

static int record_parse(call *c) {
  gyroakf_record *r = (gyroakf_record *)c;
  const int status = gyroakf_record_parse(parsed, (int64_t)strlen(parsed), (const gyroakf_reader_options *)c->opt, &r, &err);
  made(status, r);
  copy_record(r, c);
  return status;
}

static const double *recorded = filled; /* of the recording that is analyzed */
static int64_t recorded_length = n;

static int run(call *c) {
  const double *values[1];
  gyroakf_record *r = NULL;
  gyroakf_result *result = (gyroakf_result *)c;
  int status;
  values[0] = recorded;
  if (gyroakf_record_new(values, 1, recorded_length, 0.01, NULL, "deg/s", &r, NULL) != GYROAKF_OK) abort();
  status = gyroakf_run(r, (const gyroakf_run_options *)c->opt, &result, &err);
  made(status, result);
  if (result != NULL) strncpy((char *)c->figures, gyroakf_result_json(result), 16000);
  gyroakf_result_free(result);
  gyroakf_record_free(r);
  return status;
}

static void init_simulation(void *opt) {
  gyroakf_simulate_options *o = (gyroakf_simulate_options *)opt;
  gyroakf_simulate_options_init(o);
  o->samples = n;
  o->n = o->q = o->b = o->k = 0.1;
}

#define INIT(name) \
  static void init_##name(void *opt) { gyroakf_##name##_options_init((gyroakf_##name##_options *)opt); }
INIT(reader)
INIT(run)
INIT(allan)
INIT(fit)
INIT(outlier)
INIT(adf)
INIT(kpss)
INIT(ar)
INIT(filter)
INIT(drift)

typedef struct row {
  const char *name;
  int (*call)(call *c);
  int takes_series, takes_length, results; /* x and its length are looked at; so many arrays of doubles are written */
  void (*init)(void *opt);                 /* NULL: no options */
  size_t size;                             /* of the options */
} row;

#define OPTIONS(name) init_##name, sizeof(gyroakf_##name##_options)
#define NONE NULL, 0
static const row table[] = {
    {"record_new", record_new, 1, 1, 0, NONE},
    {"record_parse", record_parse, 0, 0, 0, OPTIONS(reader)},
    {"simulate", simulate, 0, 0, 0, init_simulation, sizeof(gyroakf_simulate_options)},
    {"run", run, 0, 0, 0, OPTIONS(run)},
    {"allan_new", allan_new, 1, 1, 0, OPTIONS(allan)},
    {"noise_fit", noise_fit, 0, 0, 0, OPTIONS(fit)},
    {"mark_outliers", mark_outliers, 1, 1, 0, OPTIONS(outlier)},
    {"clean", clean, 1, 1, 1, OPTIONS(outlier)},
    {"filter_design", filter_design, 1, 1, 0, OPTIONS(run)},
    {"adf_test", adf_test, 1, 1, 0, OPTIONS(adf)},
    {"kpss_test", kpss_test, 1, 1, 0, OPTIONS(kpss)},
    {"ar_fit", ar_fit, 1, 1, 1, OPTIONS(ar)},
    {"filter_new", filter_new, 1, 0, 0, OPTIONS(filter)},
    {"filter_run", filter_run, 1, 1, 1, NONE},
    {"drift_identify", drift_identify, 1, 1, 0, OPTIONS(drift)},
    {"drift_smooth", drift_smooth, 1, 1, 2, OPTIONS(filter)},
    {"drift_filter_new", drift_filter_new, 0, 0, 0, OPTIONS(filter)},
};
enum { rows = (int)(sizeof table / sizeof *table) };

/* ------------------------------------------------------------------------------------------------------------------------- a call */

/* Results of a call, and the bytes around them. */
typedef struct results {
  double array[arrays][n + 2];
  unsigned char figures[16384];
} results;

static results now_written, untouched, usual;
static unsigned char options[most_of_options], options_before[most_of_options];
static const double fair[3] = {0.3, 0.2, 0.1};

static call usual_call(const row *r, results *to) {
  call c;
  int k;
  memset(to, 0x5a, sizeof *to);
  memset(options, 0, sizeof options);
  if (r->init != NULL) r->init(options);
  c.x = r->call == filter_new ? fair : series;
  c.length = n;
  c.opt = r->init != NULL ? options : NULL;
  for (k = 0; k < arrays; k++) c.array[k] = to->array[k];
  c.figures = to->figures;
  return c;
}

static char what[200];

static void make_series(void) {
  int i;
  uniform(series, n, 31415);
  for (i = 1; i < n; i++) series[i] = 0.5 * series[i - 1] + series[i] + 1e-4 * i;
  memcpy(filled, series, sizeof filled);
  memset(&untouched, 0x5a, sizeof untouched);
}

/* The call is refused with this status (0: with any), and nothing is written. */
static void refused(const row *r, call *c, int expected, const char *why) {
  int status;
  snprintf(what, sizeof what, "%s: %s", r->name, why);
  memcpy(options_before, options, sizeof options);
  lost = 0;
  status = r->call(c);
  if (expected == 0) check_any_failure(status, what);
  else check_failure(status, expected, what);
  snprintf(what, sizeof what, "%s: %s: nothing is written, *out is NULL", r->name, why);
  check(memcmp(&now_written, &untouched, sizeof untouched) == 0 && lost == 0, what);
  check(memcmp(options, options_before, sizeof options) == 0, "options are not changed");
}

static void test_usual(const row *r) {
  call c = usual_call(r, &now_written);
  int status = r->call(&c);
  snprintf(what, sizeof what, "%s: the usual call", r->name);
  check_success(status, what);
  check(lost == 0 && memcmp(series, filled, sizeof series) == 0, "the series is not changed");
}

static void test_lengths(const row *r) {
  static const int64_t wrong[] = {0, -1, INT64_MIN, ((int64_t)1 << 44) + 1, (int64_t)1 << 62, INT64_MAX};
  size_t k;
  for (k = 0; k < sizeof wrong / sizeof *wrong; k++) {
    call c = usual_call(r, &now_written);
    c.length = wrong[k];
    refused(r, &c, GYROAKF_INVALID_ARGUMENT, "a length that none has");
  }
}

static void test_addresses(const row *r) {
  int k, shift;
  call c = usual_call(r, &now_written);
  if (r->takes_series) {
    c.x = NULL;
    refused(r, &c, GYROAKF_INVALID_ARGUMENT, "no series");
  }
  for (shift = 1; shift < 8; shift++) {
    if (r->takes_series) {
      c = usual_call(r, &now_written);
      c.x = (const double *)(const void *)((const char *)c.x + shift);
      refused(r, &c, GYROAKF_INVALID_ARGUMENT, "a series at an odd address");
    }
    for (k = 0; k < r->results; k++) {
      c = usual_call(r, &now_written);
      c.array[k] = (double *)(void *)((char *)c.array[k] + shift);
      refused(r, &c, GYROAKF_INVALID_ARGUMENT, "a result at an odd address");
    }
  }
}

/* A result that shares the first or the last sample with the series, or a value with another result, is refused; one behind it is not. */
static void test_overlaps(const row *r) {
  static double buffer[2 * n], before[2 * n];
  call c;
  int k, other;
  memset(buffer, 0x5a, sizeof buffer);
  for (k = 0; k < r->results; k++) {
    memcpy(buffer + n / 2, series, sizeof series);
    memcpy(before, buffer, sizeof buffer);
    c = usual_call(r, &now_written);
    c.x = buffer + n / 2;
    c.array[k] = buffer + n / 2 - 1;
    refused(r, &c, GYROAKF_INVALID_ARGUMENT, "a result before the series and over it");
    c.array[k] = buffer + n / 2 + n - 1;
    refused(r, &c, GYROAKF_INVALID_ARGUMENT, "a result over the end of the series");
    check(memcmp(before, buffer, sizeof buffer) == 0, "the series is not changed");
    c.x = series;
    c.array[k] = buffer;
    for (other = 0; other < k; other++) {
      c.array[other] = buffer + 1;
      refused(r, &c, GYROAKF_INVALID_ARGUMENT, "a result over another one");
      c.array[other] = now_written.array[other];
    }
    check(memcmp(before, buffer, sizeof buffer) == 0, "the other result is not changed");
    c.length = n / 2;
    c.x = buffer + n / 2;
    c.array[k] = buffer + n;
    check_success(r->call(&c), "a result right behind the series");
  }
}

/* The same of results that are no doubles. */
static void test_overlapping_marks(void) {
  static double buffer[n + 100], before[n + 100];
  double *x = buffer + 100;
  void *last = x + n - 1, *apart = buffer;
  int8_t *const marks[3] = {(int8_t *)x - 1, (int8_t *)last + 7, (int8_t *)apart};
  int k;
  memcpy(x, series, sizeof series);
  memcpy(before, buffer, sizeof buffer);
  for (k = 0; k < 2; k++) {
    check_failure(gyroakf_mark_outliers(x, n, NULL, marks[k], NULL, &err), GYROAKF_INVALID_ARGUMENT, "marks over the series");
  }
  check(memcmp(before, buffer, sizeof buffer) == 0, "the series is not changed");
  check_success(gyroakf_mark_outliers(x, 800, NULL, marks[2], NULL, &err), "marks before the series");
  check(memcmp(x, series, sizeof series) == 0, "the series is not changed");
}

/* A filter may write over the series that it reads. */
static void test_filter_in_place(void) {
  static double x[n], buffer[n];
  const double phi[2] = {0.8, 0.1};
  gyroakf_filter *f;
  check_success(gyroakf_filter_new(2, phi, 0.1, 1.0, NULL, &f, &err), "a filter");
  check_success(gyroakf_filter_run(f, series, n, x, &err), "apart");
  check_success(gyroakf_filter_reset(f, &err), "again");
  memcpy(buffer, series, sizeof buffer);
  check_success(gyroakf_filter_run(f, buffer, n, buffer, &err), "in place");
  check(memcmp(x, buffer, sizeof x) == 0, "the same estimates");
  gyroakf_filter_free(f);
}

static void test_infinite(const row *r) {
  const double infinite[2] = {INFINITY, -INFINITY};
  const int places[3] = {0, n / 2, n - 1};
  static double bad[n];
  int k;
  for (k = 0; k < 6; k++) {
    call c = usual_call(r, &now_written);
    memcpy(bad, series, sizeof bad);
    bad[places[k / 2]] = infinite[k % 2];
    c.x = bad;
    refused(r, &c, GYROAKF_NON_FINITE, "an infinite value");
  }
}

static void test_sizes(const row *r) {
  size_t size;
  for (size = 0; size <= r->size + 65; size++) {
    const size_t given = size > r->size + 64 ? (size_t)-1 : size;
    call c = usual_call(r, &now_written);
    memcpy(options, &given, sizeof given);
    if (given == r->size) {
      check_success(r->call(&c), r->name);
    } else {
      refused(r, &c, given > r->size && given != (size_t)-1 ? GYROAKF_NOT_SUPPORTED : GYROAKF_INVALID_ARGUMENT, "struct_size");
    }
  }
}

/* Values near the largest and the smallest numbers, constant ones, and none: a status, and after a success finite numbers. */
static void test_extremes(const row *r) {
  static const double factor[] = {1e308, 1e155, 1e-155, 1e-307, 5e-324, 0.0};
  static double bad[n];
  size_t k;
  int i;
  for (k = 0; k <= sizeof factor / sizeof *factor; k++) {
    call c = usual_call(r, &now_written);
    int status;
    for (i = 0; i < n; i++) {
      if (k < sizeof factor / sizeof *factor) bad[i] = (series[i] - 0.5) * factor[k];
      else memset(&bad[i], 0xff, sizeof *bad); /* NaN */
    }
    c.x = bad;
    lost = 0;
    status = r->call(&c);
    snprintf(what, sizeof what, "%s: values about %g", r->name, k < 6 ? factor[k] : NAN);
    check(status == err.code && status >= GYROAKF_OK && status <= GYROAKF_CANCELLED && lost == 0, what);
    check((status == GYROAKF_OK) == (err.message[0] == '\0'), what);
    if (status != GYROAKF_OK && r->call != filter_run && r->call != drift_smooth) {
      check(memcmp(&now_written, &untouched, sizeof untouched) == 0, what);
    }
    for (i = 0; status == GYROAKF_OK && r->call != record_new && i < r->results * (n + 2); i++) {
      if (!isfinite(now_written.array[i / (n + 2)][i % (n + 2)])) {
        check(0, what);
        break;
      }
    }
  }
}

/* ------------------------------------------------------------------------------------------------------------ the environment */

static void downward(void) { fesetround(FE_DOWNWARD); }
static void upward(void) {
  fesetround(FE_UPWARD);
  feraiseexcept(FE_DIVBYZERO);
}
static void to_zero(void) {
  fesetround(FE_TOWARDZERO);
  feraiseexcept(FE_INVALID | FE_INEXACT);
}
#if defined(__GLIBC__) && defined(__x86_64__)
static void all_traps(void) { feenableexcept(FE_ALL_EXCEPT); }
#endif
#if defined(__x86_64__)
static void flushing(void) { _mm_setcsr(_mm_getcsr() | 0x8040U); }
#endif

static void (*const changes[])(void) = {downward, upward, to_zero,
#if defined(__GLIBC__) && defined(__x86_64__)
                                        all_traps,
#endif
#if defined(__x86_64__)
                                        flushing,
#endif
};

static void test_environments(const row *r) {
  size_t k;
  call c = usual_call(r, &usual);
  modes before, after;
  fenv_t mine;
  int status;
  check_success(r->call(&c), r->name);
  for (k = 0; k < sizeof changes / sizeof *changes; k++) {
    c = usual_call(r, &now_written);
    fegetenv(&mine);
    feclearexcept(FE_ALL_EXCEPT);
    changes[k]();
    before = now();
    status = r->call(&c);
    after = now();
    fesetenv(&mine);
    snprintf(what, sizeof what, "%s: environment %d", r->name, (int)k);
    check_success(status, what);
    check(memcmp(&before, &after, sizeof before) == 0, what);
    check(memcmp(&now_written, &usual, sizeof usual) == 0, what);
  }
}

/* A progress function that leaves an environment of its own behind. */
static int32_t disturb(void *user, const char *stage, int64_t done, int64_t total) {
  size_t *k = (size_t *)user;
  (void)stage;
  (void)done;
  (void)total;
  changes[++*k % (sizeof changes / sizeof *changes)]();
  return 0;
}

static void test_disturbing_progress(void) {
  static double calm[n], disturbed[n];
  gyroakf_filter_options opt;
  const gyroakf_drift_model model = drift_model();
  modes before = now(), after;
  fenv_t mine;
  size_t k = 0;
  int status;
  gyroakf_filter_options_init(&opt);
  opt.estimate_measurement_variance = 1;
  check_success(gyroakf_drift_smooth(&model, series, n, calm, NULL, &opt, &err), "a smoother");
  fegetenv(&mine);
  before = now();
  status = gyroakf_drift_smooth_watched(&model, series, n, disturbed, NULL, &opt, disturb, &k, &err);
  after = now();
  fesetenv(&mine);
  check_success(status, "a smoother that is disturbed");
  check(k > 0 && memcmp(calm, disturbed, sizeof calm) == 0, "the same drift");
  check(memcmp(&before, &after, sizeof before) == 0, "the environment is as it was before the call");
}

/* A step in the usual environment raises nothing but FE_INEXACT and FE_UNDERFLOW, whatever is measured. */
static void test_flags_of_a_step(void) {
  static const uint64_t odd[] = {0x7ff0000000000001U, 0xfff4000000000000U, 0x7ff8000000000000U, 0x7ff0000000000000U,
                                 0xfff0000000000000U, 0x7fefffffffffffffU, 0xffefffffffffffffU, 1U, 0x8000000000000001U, 0U};
  const double phi[3] = {0.5, 0.2, 0.1};
  gyroakf_filter_options opt;
  const gyroakf_drift_model model = drift_model();
  gyroakf_filter *f;
  double z, x;
  size_t k;
  int p, raised;
  gyroakf_filter_options_init(&opt);
  opt.estimate_measurement_variance = 1;
  opt.huber = 2.5;
  for (p = 0; p <= 4; p++) {
    if (p < 4) check_success(gyroakf_filter_new(p, phi, 1e-3, 1.0, p % 2 ? &opt : NULL, &f, &err), "a filter");
    else check_success(gyroakf_drift_filter_new(&model, &opt, &f, &err), "a filter of a drift");
    for (k = 0; k < 4 * sizeof odd / sizeof *odd; k++) {
      memcpy(&z, &odd[k / 4], sizeof z);
      feclearexcept(FE_ALL_EXCEPT);
      check(gyroakf_filter_step(f, z, &x) == GYROAKF_OK && isfinite(x), "a step of an odd measurement");
      raised = fetestexcept(FE_ALL_EXCEPT);
      check((raised & ~(FE_INEXACT | FE_UNDERFLOW)) == 0, "flags of a step");
      feclearexcept(FE_ALL_EXCEPT);
    }
    gyroakf_filter_free(f);
  }
}

/* -------------------------------------------------------------------------------------------------------------------- memory */

#if defined(__GLIBC__)
#include <malloc.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/wait.h>

enum { many = 100000, channels = 60, steps = 2500 };

/* Address space in bytes; 0 where that of a tool that watches the program hides it. */
static size_t address_space(void) {
  const char *loaded = getenv("LD_PRELOAD");
  unsigned long long pages = 0;
  FILE *file = fopen("/proc/self/statm", "r");
  if (file == NULL) return 0;
  if (fscanf(file, "%llu", &pages) != 1 || (loaded != NULL && strstr(loaded, "vgpreload") != NULL)) pages = 0;
  fclose(file);
  pages *= (unsigned long long)sysconf(_SC_PAGESIZE);
  return pages > (1ULL << 36) ? 0 : (size_t)pages;
}

/* Makes the stack larger: one that cannot grow ends a program, whoever calls. */
static void grow_stack(void) {
  volatile char buffer[1 << 20];
  size_t k;
  for (k = 0; k < sizeof buffer; k += 1024) buffer[k] = 1;
}

/* The call with so many samples of a longer series; its results go to buffer. */
static call long_call(const row *r, const double *longer, int64_t length, char *buffer) {
  call c = usual_call(r, &now_written);
  int i;
  if (r->takes_series && r->call != filter_new) c.x = longer;
  if (r->takes_series && r->takes_length) c.length = length;
  for (i = 0; i < arrays; i++) c.array[i] = (double *)(void *)buffer + i * many;
  c.figures = (unsigned char *)buffer + arrays * sizeof(double) * many;
  return c;
}

/* How a call by a child ended, as its exit code; a runtime library ends a program with 1 or 2. */
enum { done = 10, no_memory, too_few_requests, no_good_end };

/* The call by a process that has only so much more memory. */
static int call_within(const row *r, call c, size_t bytes) {
  int status, code = no_good_end;
  pid_t child;
  fflush(NULL);
  child = fork();
  if (child < 0) return code;
  if (child == 0) {
    struct rlimit limit;
    grow_stack();
    limit.rlim_cur = limit.rlim_max = address_space() + bytes;
    mallopt(M_MMAP_THRESHOLD, 1 << 18); /* long arrays are not taken from what is free */
    setrlimit(RLIMIT_AS, &limit);
    lost = 0;
    status = r->call(&c);
    _exit(lost > 0 || err.code != status ? no_good_end : status == GYROAKF_OK ? done : status == GYROAKF_NO_MEMORY ? no_memory : no_good_end);
  }
  if (waitpid(child, &status, 0) == child && WIFEXITED(status)) code = WEXITSTATUS(status);
  return code;
}

/* The call with more and more memory, until that is enough. */
static void within_limits(const row *r, const double *longer, char *buffer) {
  size_t bytes = 1 << 20;
  int code = no_memory;
  while (code == no_memory && bytes < ((size_t)1 << 31)) {
    code = call_within(r, long_call(r, longer, many, buffer), bytes);
    bytes += bytes / 4;
  }
  snprintf(what, sizeof what, "%s: within %lld bytes", r->name, (long long)bytes);
  check(code == done, what);
}

/* Memory that is too little for a long series: a status; the program goes on. The first of all tests: nothing is free in the heap yet. */
void test_memory(void) {
  double *longer = (double *)malloc(many * sizeof *longer);
  char *buffer = (char *)malloc(8 * sizeof(double) * many);
  int k, i;
  const int threads = omp_get_max_threads();
  if (longer == NULL || buffer == NULL) abort();
  make_series();
  omp_set_num_threads(1);
  for (i = 0; i < many; i++) longer[i] = series[i % n];
  for (k = 0; k < rows && address_space() > 0; k++) {
    if (table[k].takes_length && table[k].takes_series) within_limits(&table[k], longer, buffer);
  }
  omp_set_num_threads(threads);
  free(longer);
  free(buffer);
}

/* ------------------------------------------------------------------------------------------------------- children and small stacks */

static char *recording; /* of many columns, with stamps and a gap */

static void make_columns(void) {
  size_t used = 0;
  int i, k;
  recording = (char *)malloc(12 * steps * (channels + 1) + 1000);
  if (recording == NULL) abort();
  for (i = 0; i < steps; i++) {
    used += (size_t)sprintf(recording + used, "%.2f", 0.01 * (i + (i > 900 ? 3 : 0)));
    for (k = 0; k < channels; k++) used += (size_t)sprintf(recording + used, ",%.5f", series[(i + k) % n]);
    recording[used++] = '\n';
  }
  recording[used] = '\0';
}

/* The recording as a file. */
static int read_file(gyroakf_record **r) {
  char path[] = "/tmp/gyroakf_XXXXXX";
  const int file = mkstemp(path);
  int status;
  if (file < 0 || write(file, recording, strlen(recording)) != (ssize_t)strlen(recording) || close(file) != 0) abort();
  status = gyroakf_record_read(path, NULL, r, &err);
  unlink(path);
  return status;
}

/* What the table has not: a file, all that a recording and a curve are asked for, a filter that is saved, restored and begun again, the
 * smoother of white noise that changes. */
static int others(call *c) {
  const gyroakf_drift_model model = drift_model();
  gyroakf_filter_options adaptive;
  gyroakf_filter_state state;
  gyroakf_audit audit;
  gyroakf_record *r = NULL;
  gyroakf_allan *a = NULL;
  gyroakf_filter *f = NULL, *again = NULL;
  double x;
  int64_t size;
  int status = read_file(&r), i;
  gyroakf_filter_options_init(&adaptive);
  adaptive.estimate_measurement_variance = 1;
  audit.struct_size = sizeof audit;
  status |= gyroakf_record_audit(r, &audit) | (audit.gaps != 1) | (gyroakf_record_channels(r) != channels);
  for (i = 0; i < gyroakf_record_channels(r); i++) {
    status |= gyroakf_record_name(r, i) == NULL || gyroakf_record_unit(r, i) == NULL || gyroakf_record_to_si(r, i) < 0;
  }
  for (i = 0; i < gyroakf_record_warnings(r); i++) status |= gyroakf_record_warning(r, i) == NULL;
  status |= gyroakf_allan_new(c->x, c->length, 0.01, NULL, &a, &err) | (gyroakf_allan_tau(a)[0] <= 0);
  status |= gyroakf_drift_filter_new(&model, &adaptive, &f, &err) | gyroakf_filter_run(f, c->x, c->length, c->array[0], &err);
  status |= gyroakf_filter_freeze(f, 1) | gyroakf_filter_step(f, 1.0, &x) | gyroakf_filter_get(f, &state);
  status |= gyroakf_filter_save(f, c->figures, 4096, &size, &err) | gyroakf_filter_restore(c->figures, size, &again, &err);
  status |= gyroakf_filter_reset(f, &err);
  status |= gyroakf_drift_smooth(&model, c->x, c->length, c->array[0], c->array[1], &adaptive, &err);
  gyroakf_filter_free(f);
  gyroakf_filter_free(again);
  gyroakf_allan_free(a);
  gyroakf_record_free(r);
  return status;
}

static int call_status;
static call of_child;

static void *call_in_thread(void *argument) {
  call_status = ((const row *)argument)->call(&of_child);
  return NULL;
}

/* The status of a call by a forked child, in a thread of its own with so large a stack where that is not 0; -1: no good end. */
static int status_of_child(const row *r, call c, size_t stack) {
  int status;
  pid_t child;
  fflush(NULL);
  of_child = c;
  child = fork();
  if (child < 0) return -1;
  if (child == 0) {
    pthread_attr_t attributes;
    pthread_t thread;
    alarm(300);
    call_status = -1;
    if (stack == 0) {
      call_in_thread((void *)(uintptr_t)r);
    } else {
      pthread_attr_init(&attributes);
      pthread_attr_setstacksize(&attributes, stack);
      if (pthread_create(&thread, &attributes, call_in_thread, (void *)(uintptr_t)r) == 0) pthread_join(thread, NULL);
    }
    _exit(call_status < 0 ? 255 : call_status);
  }
  if (waitpid(child, &status, 0) != child || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

/* Every call in a thread with a stack of 64 kB, and in a child of a process that has made parallel calls. */
void test_children(void) {
  static const row more = {"others", others, 1, 1, 0, NONE};
  const int threads = omp_get_max_threads(), length = many / 5;
  const char *usually = parsed;
  double *longer = (double *)malloc(many * sizeof *longer);
  char *buffer = (char *)malloc(8 * sizeof(double) * many);
  gyroakf_allan *a = NULL;
  int k, i;
  if (longer == NULL || buffer == NULL) abort();
  make_series();
  make_columns();
  for (i = 0; i < many; i++) longer[i] = series[i % n];
  omp_set_num_threads(2);
  recorded = longer;
  recorded_length = length;
  parsed = recording;
  for (k = 0; k <= rows && address_space() > 0; k++) {
    const row *r = k < rows ? &table[k] : &more;
    snprintf(what, sizeof what, "%s: in a thread with a stack of 64 kB", r->name);
    check(status_of_child(r, long_call(r, longer, length, buffer), 65536) == GYROAKF_OK, what);
  }
  check_success(gyroakf_allan_new(longer, many, 0.01, NULL, &a, &err), "a parallel call of the parent");
  gyroakf_allan_free(a);
  for (k = 0; k <= rows; k++) {
    const row *r = k < rows ? &table[k] : &more;
    snprintf(what, sizeof what, "%s: in a forked child", r->name);
    check(status_of_child(r, long_call(r, longer, length, buffer), 0) == GYROAKF_OK, what);
  }
  omp_set_num_threads(threads);
  recorded = filled;
  recorded_length = n;
  parsed = usually;
  free(recording);
  free(longer);
  free(buffer);
}

/* ------------------------------------------------------------------------------------------------------- one request that fails */

/* Of ci/faults/memory.c, where that is loaded. */
extern void faults_begin(long number) __attribute__((weak));
extern long faults_requests(void) __attribute__((weak));

/* The whole analysis of many channels. */
static int run_channels(call *c) {
  const double *values[channels];
  gyroakf_record *r = NULL;
  gyroakf_result *result = NULL;
  int status, i;
  for (i = 0; i < channels; i++) values[i] = c->x + i;
  status = gyroakf_record_new(values, channels, steps, 0.01, NULL, "deg/s", &r, &err);
  if (status == GYROAKF_OK) status = gyroakf_run(r, NULL, &result, &err);
  gyroakf_result_free(result);
  gyroakf_record_free(r);
  return status;
}

static int parse_columns(call *c) {
  gyroakf_record *r = NULL;
  const int status = gyroakf_record_parse(recording, (int64_t)strlen(recording), NULL, &r, &err);
  (void)c;
  gyroakf_record_free(r);
  return status;
}

static int read_columns(call *c) {
  gyroakf_record *r = NULL;
  const int status = read_file(&r);
  (void)c;
  gyroakf_record_free(r);
  return status;
}

/* Orders with which matrices and the work space of LAPACK are large. */
enum { large_order = 100 };

static int ar_fit_of(call *c, const char *method) {
  double phi[large_order];
  int32_t order;
  gyroakf_ar_options opt;
  gyroakf_ar_options_init(&opt);
  opt.method = method;
  opt.order = large_order;
  return gyroakf_ar_fit(c->x, c->length, &opt, large_order, &order, phi, NULL, NULL, &err);
}

static int ar_fit_squares(call *c) { return ar_fit_of(c, "ols"); }

static int ar_fit_recursion(call *c) { return ar_fit_of(c, "yw"); }

static int ar_fit_burg(call *c) { return ar_fit_of(c, "burg"); }

static int adf_test_lags(call *c) {
  gyroakf_adf_options opt;
  gyroakf_adf result;
  gyroakf_adf_options_init(&opt);
  opt.max_lags = large_order;
  return gyroakf_adf_test(c->x, c->length, &opt, &result, &err);
}

static int filter_of(int32_t order) {
  static const double phi[large_order] = {0.5, 0.1};
  gyroakf_filter *f = NULL;
  const int status = gyroakf_filter_new(order, phi, 1.0, 1.0, NULL, &f, &err);
  gyroakf_filter_free(f);
  return status;
}

static int filter_of_order(call *c) {
  (void)c;
  return filter_of(large_order);
}

/* Its steady gain by doubling */
static int filter_doubling(call *c) {
  (void)c;
  return filter_of(large_order / 2 - 1);
}

/* A call by a child whose request of that number fails. */
static int call_without(const row *r, call c, long number) {
  int status;
  pid_t child;
  fflush(NULL);
  child = fork();
  if (child < 0) return no_good_end;
  if (child == 0) {
    alarm(60);
    lost = 0;
    faults_begin(number);
    status = r->call(&c);
    if (lost > 0 || err.code != status || (status != GYROAKF_OK && strlen(err.message) < 5)) _exit(no_good_end);
    if (faults_requests() < number) _exit(status == GYROAKF_OK ? too_few_requests : no_good_end);
    if (status != GYROAKF_OK && status != GYROAKF_NO_MEMORY) fprintf(stderr, "%s: status %d: %s\n", r->name, status, err.message);
    _exit(status == GYROAKF_OK ? done : status == GYROAKF_NO_MEMORY ? no_memory : no_good_end);
  }
  if (waitpid(child, &status, 0) == child && WIFEXITED(status)) return WEXITSTATUS(status);
  return no_good_end;
}

/* Every large request of a call fails once; of many channels those of the first and some. */
void test_faults(void) {
  static const row more[] = {{"run of 60 channels", run_channels, 1, 0, 0, NONE},
                             {"60 columns", parse_columns, 1, 0, 0, NONE},
                             {"60 columns of a file", read_columns, 1, 0, 0, NONE},
                             {"least squares of order 100", ar_fit_squares, 1, 0, 0, NONE},
                             {"Yule-Walker of order 100", ar_fit_recursion, 1, 0, 0, NONE},
                             {"Burg of order 100", ar_fit_burg, 1, 0, 0, NONE},
                             {"adf_test of 100 lags", adf_test_lags, 1, 0, 0, NONE},
                             {"filter_new of order 49", filter_doubling, 1, 0, 0, NONE},
                             {"filter_new of order 100", filter_of_order, 1, 0, 0, NONE}};
  double *longer = (double *)malloc(many * sizeof *longer);
  char *buffer = (char *)malloc(8 * sizeof(double) * many);
  long number, step;
  int k, i, code, tried, went_on;
  if (faults_begin == NULL || faults_requests == NULL || longer == NULL || buffer == NULL) abort();
  make_series();
  make_columns();
  omp_set_num_threads(1);
  for (i = 0; i < many; i++) longer[i] = series[i % n] + 1e-6 * i;
  for (k = 0; k < rows + (int)(sizeof more / sizeof *more); k++) {
    const row *r = k < rows ? &table[k] : &more[k - rows];
    tried = went_on = 0;
    step = 1;
    for (number = 1; number < 100000; number += step) {
      call c = long_call(r, longer, many / 5, buffer);
      code = call_without(r, c, number);
      if (code == too_few_requests) break;
      snprintf(what, sizeof what, "%s: large request %ld fails", r->name, number);
      check(code == no_memory || code == done, what);
      tried++;
      went_on += code == done;
      if (r->call == run_channels && number > 100) step = number / 2;
    }
    printf("%-26s %5d requests failed one by one, %d of them of no account\n", r->name, tried, went_on);
  }
  free(longer);
  free(buffer);
  free(recording);
}
#else
void test_memory(void) {}
void test_children(void) {}
void test_faults(void) {}
#endif

/* -------------------------------------------------------------------------------------------------------------- and the rest */

/* Structs of the caller that begin with their size. */
static void test_other_structs(void) {
  gyroakf_drift_model model, fresh;
  gyroakf_audit audit;
  gyroakf_record *r;
  gyroakf_filter *f;
  size_t size;
  double drift[8];
  gyroakf_drift_model_init(&fresh);
  check_success(gyroakf_record_parse("1\n2\n3\n", 6, NULL, &r, &err), "a recording");
  for (size = 0; size <= sizeof model + 64; size++) {
    model = drift_model();
    model.struct_size = size;
    if (size != sizeof model) {
      const int expected = size > sizeof model ? GYROAKF_NOT_SUPPORTED : GYROAKF_INVALID_ARGUMENT;
      check_failure(gyroakf_drift_smooth(&model, series, 8, drift, NULL, NULL, &err), expected, "size of a model");
      check_failure(gyroakf_drift_identify(series, n, NULL, &model, &err), expected, "size of a model");
      check_failure(gyroakf_drift_filter_new(&model, NULL, &f, &err), expected, "size of a model");
      check(f == NULL, "no filter");
    }
    if (size != sizeof audit) {
      memset(&audit, 0x5a, sizeof audit);
      audit.struct_size = size;
      check(gyroakf_record_audit(r, &audit) == GYROAKF_INVALID_ARGUMENT && audit.samples == 0x5a5a5a5a5a5a5a5a, "size of an audit");
    }
  }
  audit.struct_size = sizeof audit;
  check(gyroakf_record_audit(r, NULL) == GYROAKF_INVALID_ARGUMENT && gyroakf_record_audit(NULL, &audit) == GYROAKF_INVALID_ARGUMENT,
        "an audit of nothing");
  gyroakf_record_free(r);
}

/* Counts that none has, beside those of series. */
static void test_counts(void) {
  static const int32_t wrong[] = {-1, INT32_MIN};
  gyroakf_filter *f;
  gyroakf_record *r;
  const double *values[1];
  double acf[4];
  int64_t size = 77;
  size_t k;
  values[0] = series;
  for (k = 0; k < 2; k++) {
    check_failure(gyroakf_filter_new(wrong[k], series, 1.0, 1.0, NULL, &f, &err), GYROAKF_INVALID_ARGUMENT, "an order below 0");
    check_failure(gyroakf_record_new(values, wrong[k], n, 1.0, NULL, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "channels below 0");
    check_failure(gyroakf_record_parse("1\n", wrong[k], NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "bytes below 0");
    check_failure(gyroakf_filter_restore(acf, wrong[k], &f, &err), GYROAKF_INVALID_ARGUMENT, "a filter of no bytes");
    check_success(gyroakf_filter_new(0, NULL, 1.0, 1.0, NULL, &f, &err), "a filter");
    check_failure(gyroakf_filter_save(f, acf, wrong[k], &size, &err), GYROAKF_INVALID_ARGUMENT, "a buffer of no bytes");
    gyroakf_filter_free(f);
  }
  check(size > 0, "how many bytes a filter takes");
}

/* A series of one and of few samples, each function of the table. */
static void test_short(const row *r) {
  int64_t k;
  for (k = 1; k <= 60; k++) {
    call c = usual_call(r, &now_written);
    int status;
    c.length = k;
    lost = 0;
    status = r->call(&c);
    snprintf(what, sizeof what, "%s: %d samples", r->name, (int)k);
    check(status == err.code && lost == 0 && status != GYROAKF_INTERNAL && status != GYROAKF_NON_FINITE, what);
    if (status != GYROAKF_OK) check(memcmp(&now_written, &untouched, sizeof untouched) == 0, what);
    if (status == GYROAKF_OK && r->results > 0) check(isfinite(now_written.array[0][0]), what);
  }
}

static void run_table(void) {
  int k;
  for (k = 0; k < rows; k++) {
    const row *r = &table[k];
    test_usual(r);
    test_addresses(r);
    if (r->takes_length) test_lengths(r);
    if (r->takes_length && r->takes_series) test_overlaps(r);
    if (r->takes_length && r->takes_series && r->call != filter_run) test_infinite(r);
    if (r->takes_length && r->takes_series) test_extremes(r);
    if (r->takes_length) test_short(r);
    if (r->init != NULL) test_sizes(r);
    test_environments(r);
  }
}

/* Nothing is printed: both streams lead to a file meanwhile, which is empty then but for what `check` has to say. */
static void test_silence(void) {
  FILE *caught = tmpfile();
  int out, error, k;
  long length;
  if (caught == NULL) return;
  fflush(stdout);
  out = dup(1);
  error = dup(2);
  dup2(fileno(caught), 1);
  dup2(fileno(caught), 2);
  for (k = 0; k < rows; k++) {
    call c = usual_call(&table[k], &now_written);
    table[k].call(&c);
    c.length = -1;
    table[k].call(&c);
    c.length = 1;
    table[k].call(&c);
  }
  fflush(NULL);
  dup2(out, 1);
  dup2(error, 2);
  close(out);
  close(error);
  fseek(caught, 0, SEEK_END);
  length = ftell(caught);
  fclose(caught);
  check(length == 0, "nothing is printed");
  memset(&err, 0x55, sizeof err);
}

void test_promises(void) {
  call last;
  int threads = omp_get_max_threads();
  omp_set_num_threads(1); /* sums of several threads may differ in the last bit */
  make_series();
  run_table();
  test_overlapping_marks();
  test_filter_in_place();
  test_disturbing_progress();
  test_flags_of_a_step();
  test_other_structs();
  test_counts();
  test_silence();
  memset(&last, 0, sizeof last);
  noise_fit(&last); /* frees its curve */
  check(memcmp(series, filled, sizeof series) == 0, "the series is as it was");
  omp_set_num_threads(threads);
}
