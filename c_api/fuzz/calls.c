/* SPDX-License-Identifier: MIT */
/*
 * Calls every function of gyroakf.h with random arguments, good and bad, and checks what the header promises for all of them: a
 * status that is known, a message that can be shown, nothing changed behind a const, nothing written beyond an array or after a
 * failure, the floating-point environment of the program as it was.
 *
 *   calls RUNS [SEED]
 *
 * A run is a sequence of some calls; run i has seed SEED + i (1), so that "calls 1 SEED" repeats it alone. The last lines are the
 * calls made and "N passed, N failed", N runs. Built and run by ci/fuzz/calls.sh.
 */
#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* feenableexcept */
#endif
#include "gyroakf.h"
#include "modes.h"
#include "seal.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

/* The functions, and how often each is called (what takes long, seldom). ci/fuzz/calls.sh compares them with the header. */
#define FUNCTIONS(F) \
  F(version, 1) F(version_string, 1) F(status_string, 8) \
  F(reader_options_init, 1) F(record_read, 8) F(record_parse, 120) F(record_new, 40) F(record_new_watched, 20) F(record_samples, 8) F(record_channels, 8) \
  F(record_values, 8) F(record_present, 8) F(record_name, 8) F(record_unit, 8) F(record_to_si, 8) F(record_sample_interval, 8) \
  F(record_rate_source, 8) F(record_format, 8) F(record_warnings, 8) F(record_warning, 8) F(record_audit, 16) F(record_free, 30) \
  F(simulate_options_init, 1) F(simulate, 30) \
  F(run_options_init, 1) F(run, 2) F(result_json, 8) F(result_free, 8) \
  F(allan_options_init, 1) F(allan_new, 60) F(allan_size, 8) F(allan_tau, 8) F(allan_deviation, 8) F(allan_lower, 8) \
  F(allan_upper, 8) F(allan_edf, 8) F(allan_free, 30) \
  F(fit_options_init, 1) F(noise_fit, 4) F(allan_fit, 4) \
  F(outlier_options_init, 1) F(mark_outliers, 80) F(clean, 60) \
  F(adf_options_init, 1) F(adf_test, 60) \
  F(kpss_options_init, 1) F(kpss_test, 80) \
  F(ar_options_init, 1) F(ar_fit, 60) \
  F(filter_options_init, 1) F(filter_new, 120) F(filter_identify, 1) F(filter_step, 200) F(filter_freeze, 40) F(filter_run, 100) \
  F(filter_run_watched, 60) F(filter_get, 60) \
  F(filter_free, 60) F(filter_reset, 30) F(filter_save, 60) F(filter_restore, 60) \
  F(drift_model_init, 1) F(drift_options_init, 1) F(drift_identify, 6) F(drift_filter_new, 60) \
  F(drift_smooth, 40) F(drift_smooth_watched, 20)

typedef struct entry {
  const char *name;
  void (*call)(void);
  int weight;
} entry;

#define DECLARE(name, weight) static void call_##name(void);
#define ENTRY(name, weight) {"gyroakf_" #name, call_##name, weight},
FUNCTIONS(DECLARE)
static const entry functions[] = {FUNCTIONS(ENTRY){NULL, NULL, 0}};
enum { function_count = (int)(sizeof functions / sizeof functions[0]) - 1 };

/* ------------------------------------------------------------------------------------------------------------ failures */

static uint64_t seed_of_run;
static const char *current = "nothing";
static int inside;  /* a call is being made */
static int failed;  /* in this run */
static int64_t calls_made[function_count];

static void tell_place(void) { fprintf(stderr, "FAILED: %s, repeat it with: calls 1 %llu\n", current, (unsigned long long)seed_of_run); }

static void promise(int kept, const char *what) {
  if (kept) return;
  failed = 1;
  fprintf(stderr, "broken promise: %s\n", what);
  tell_place();
}

static void at_exit(void) {
  if (inside) tell_place();
}

static void at_signal(int number) {
  fprintf(stderr, "signal %d\n", number);
  tell_place();
  _exit(2);
}

/* -------------------------------------------------------------------------------------------------------------- chance */

static uint64_t state;

static uint64_t bits(void) { /* splitmix64 */
  uint64_t z = (state += UINT64_C(0x9e3779b97f4a7c15));
  z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
  z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
  return z ^ (z >> 31);
}

static int below(int n) { return (int)(bits() % (uint64_t)n); }
static int one_in(int n) { return below(n) == 0; }
static double uniform(void) { return (double)(bits() >> 11) / 9007199254740992.0; }
static double normal(void) { return uniform() + uniform() + uniform() + uniform() - 2.0; }

static double any_double(void) {
  static const double odd[] = {0.0,   -0.0,   1.0,    -1.0,   0.5,   2.0,   1e-300, 1e300, -1e300, 5e-324, -5e-324, 2.3e-308,
                               1e-310, 1.7976931348623157e308, -1.7976931348623157e308, 1e18, 9.3e18, 4.6e18, 1e-16, 3.0, 1e9, 1e-9};
  double x;
  uint64_t b;
  switch (below(6)) {
    case 0: return uniform();
    case 1: return 100.0 * normal();
    case 2: return one_in(2) ? (double)NAN : one_in(2) ? (double)INFINITY : -(double)INFINITY;
    case 3:
      b = bits();
      memcpy(&x, &b, sizeof x);
      return x;
    default: return odd[below((int)(sizeof odd / sizeof odd[0]))];
  }
}

static int32_t any_int(void) {
  static const int32_t odd[] = {0, 1, -1, 2, 3, -2, 7, 10, 999, 1000, 1001, 100000, INT32_MAX, INT32_MIN, INT32_MAX - 1};
  if (one_in(2)) return below(30);
  if (one_in(8)) return (int32_t)bits();
  return odd[below((int)(sizeof odd / sizeof odd[0]))];
}

static int64_t any_long(void) {
  static const int64_t odd[] = {INT64_MAX, INT64_MIN, INT64_MAX - 1, (int64_t)1 << 44, ((int64_t)1 << 44) + 1, -1, 0, 1, 2, 8, INT32_MAX};
  if (one_in(2)) return below(400);
  if (one_in(8)) return (int64_t)bits();
  return odd[below((int)(sizeof odd / sizeof odd[0]))];
}

/* --------------------------------------------------------------------------------------------------- memory of a call */

#ifdef __SANITIZE_ADDRESS__
enum { guard = 0 }; /* the sanitizer sees what is read and written beyond an array, too */
#ifdef __cplusplus
extern "C"
#endif
void __sanitizer_set_death_callback(void (*callback)(void));
#else
enum { guard = 32 };
#endif

/* input: not changed. output: not changed after a failure. always: written in any case (err, *out). */
enum use { input, output, always };

typedef struct area {
  unsigned char *block, *copy, *data;
  size_t before, bytes, total;
  enum use use;
} area;

enum { most_areas = 24, most_bad = 20 };
static area areas[most_areas];
static int area_count;

/* Memory between guards; offset: so many bytes from an address that suits every type. */
static void *take(size_t bytes, size_t offset, enum use use) {
  area *a = &areas[area_count++];
  if (area_count > most_areas) abort();
  a->before = guard + offset;
  a->bytes = bytes;
  a->total = a->before + bytes + guard;
  a->block = (unsigned char *)malloc(a->total ? a->total : 1);
  a->copy = (unsigned char *)malloc(a->total ? a->total : 1);
  if (!a->block || !a->copy) abort();
  memset(a->block, 0xa5, a->total);
  a->data = a->block + a->before;
  a->use = use;
  return a->data;
}

static size_t any_offset(void) { return one_in(24) ? 1 + (size_t)below(7) : 0; }

/* A place for a result, seldom NULL. */
static void *place(size_t bytes) { return one_in(40) ? NULL : take(bytes, 0, output); }

/* An array for results, seldom at an odd address or the input itself; NULL as often as given. */
static void *results(size_t bytes, int null_in) {
  int i;
  if (one_in(null_in)) return NULL;
  if (one_in(40)) {
    for (i = 0; i < area_count; i++) {
      if (areas[i].bytes < bytes || areas[i].use == always || areas[i].before != guard) continue;
      areas[i].use = always;
      return areas[i].data;
    }
  }
  return take(bytes, any_offset(), output);
}

enum { longest_series = 5000 };

/* A series and its length, which is wrong only where no value can be looked at: <= 0, or beyond any memory. */
static const double *series(int64_t *n) {
  static const int64_t wrong[] = {0, -1, INT64_MIN, INT64_MAX, ((int64_t)1 << 44) + 1};
  int i, k, length = one_in(8) ? below(12) : 1 + below(300), kind = below(16);
  double step = 0.0, level = one_in(4) ? 1e6 : 0.0, scale = one_in(6) ? any_double() : 1.0, value = 0.0;
  size_t offset = any_offset();
  unsigned char *data;
  if (kind == 15 && one_in(200)) length = longest_series;
  *n = length;
  if (one_in(40)) *n = wrong[below(5)];
  if (one_in(60)) return NULL;
  data = (unsigned char *)take((size_t)length * sizeof value, offset, input);
  if (!isfinite(scale)) scale = 1e-320;
  for (i = 0; i < length; i++) {
    switch (kind) {
      case 0: value = level; break;
      case 1: value = step += normal(); break;
      case 2: value = (double)i; break;
      case 3: value = sin(0.3 * i) + (one_in(3) ? normal() : 0.0); break;
      case 4: value = floor(4.0 * normal()) * 0.125; break;
      case 5: value = one_in(3) ? (double)NAN : normal(); break;
      case 6: value = one_in(30) ? any_double() : normal(); break;
      case 7: value = (double)NAN; break;
      case 8: value = (i & 1) ? 1e308 : -1e308; break;
      case 9: value = one_in(length) ? 1.0 : 0.0; break;
      case 10: value = any_double(); break;
      case 11: value = (i & 1) ? 1.0 : -1.0; break;
      case 12: value = i < length / 2 ? (double)NAN : normal(); break;
      case 13: value = step = 0.95 * step + normal(); break;
      default: value = level + normal(); break;
    }
    if (isinf(value) && !one_in(400)) value = 3.0;
    if (kind != 0 && kind != 8 && kind != 10) value *= scale;
    memcpy(data + (size_t)i * sizeof value, &value, sizeof value);
  }
  for (k = one_in(5) ? 1 + below(3) : 0; k > 0 && length > 0; k--) {
    value = any_double();
    memcpy(data + (size_t)below(length) * sizeof value, &value, sizeof value);
  }
  return (const double *)(const void *)data;
}

/* A word: NULL, one that is known somewhere, or anything. */
static const char *text(void) {
  static const char *const words[] = {
      "auto",   "none",  "text",    "npy",     "f64",    "i16be",   "oadev", "adev",   "mdev",   "tdev",       "hdev",  "ohdev", "totdev",
      "octave", "all",   "decade",  "log:3",   "log:0",  "log:-1",  "0.5,1,2", "1e9",  "nan",    "1,,2",       "QNBKR", "N",     "S",
      "M",      "QQ",    "linear",  "log",     "pauta",  "mad",     "hampel", "n",  "c",          "ct",    "ctt",   "aic",
      "bic",    "t",     "legacy",  "yw",      "burg",   "ols",     "aicc",   "hqic",   "fpe",        "residual", "exact", "biased",
      "paper",  "default", "rate",  "increment", "angle", "deg/s",  "rad/s", "1",      "2",      "gx,gy",      "time",  "index", "nearest",
      "360",    "",      " ",       "log:9999999999", "1e400", "-1", "inf",  "QNBKRMS"};
  char *any;
  int i, length;
  if (one_in(4)) return NULL;
  if (!one_in(8)) return words[below((int)(sizeof words / sizeof words[0]))];
  length = one_in(60) ? 70000 : below(40);
  any = (char *)take((size_t)length + 1, 0, input);
  for (i = 0; i < length; i++) any[i] = (char)(one_in(3) ? 1 + below(255) : 32 + below(95));
  any[length] = 0;
  return any;
}

static size_t any_size(size_t size) {
  static const size_t wrong[] = {0, 1, (size_t)-1, 8};
  return one_in(40) ? wrong[below(4)] : one_in(60) ? size + 8 : size;
}

static gyroakf_error *error_place(void) { return one_in(8) ? NULL : (gyroakf_error *)take(sizeof(gyroakf_error), 0, always); }

/* ------------------------------------------------------------------------------------------------------------- handles */

enum kind { records, allans, filters, runs, kinds };
enum { most_handles = 4 };
static void *handles[kinds][most_handles];
static int handle_count[kinds];

static void release(enum kind kind, void *handle) {
  switch (kind) {
    case records: gyroakf_record_free((gyroakf_record *)handle); break;
    case allans: gyroakf_allan_free((gyroakf_allan *)handle); break;
    case filters: gyroakf_filter_free((gyroakf_filter *)handle); break;
    default: gyroakf_result_free((gyroakf_result *)handle); break;
  }
}

static void *handle(enum kind kind) { return handle_count[kind] == 0 || one_in(30) ? NULL : handles[kind][below(handle_count[kind])]; }

/* Takes one out of those that are kept; seldom NULL. */
static void *drop(enum kind kind) {
  int i;
  void *taken;
  if (handle_count[kind] == 0 || one_in(20)) return NULL;
  i = below(handle_count[kind]);
  taken = handles[kind][i];
  handles[kind][i] = handles[kind][--handle_count[kind]];
  return taken;
}

/* After a call that makes a handle. */
static void keep(enum kind kind, int status, void **out) {
  void *made;
  if (!out) {
    promise(status == GYROAKF_INVALID_ARGUMENT, "no place for a handle is an error");
    return;
  }
  memcpy(&made, out, sizeof made);
  promise((made != NULL) == (status == GYROAKF_OK), "there is a handle after a success, and NULL after a failure");
  if (!made) return;
  if (handle_count[kind] == most_handles) {
    release(kind, drop(kind));
    if (handle_count[kind] == most_handles) {
      release(kind, made);
      return;
    }
  }
  handles[kind][handle_count[kind]++] = made;
}

static void free_all(void) {
  int left;
  do {
    int k, first = below(kinds);
    left = 0;
    for (k = 0; k < kinds; k++) {
      enum kind kind = (enum kind)((first + k) % kinds);
      release(kind, drop(kind));
      left += handle_count[kind];
    }
  } while (left > 0);
}

/* ------------------------------------------------------------------------------------------------------------ progress */

static int told, cancel_at, cancelled; /* in this call; cancelled: calls after the one that said so, from 1 */
static char user;

static int32_t progress(void *handed, const char *stage, int64_t done, int64_t total) {
  promise(handed == &user, "progress gets its user pointer");
  promise(stage && strlen(stage) < 100, "progress gets a stage");
  promise(done >= 0 && total >= 0 && (total == 0 || done <= total), "progress counts up to its total");
  promise(cancelled == 0, "progress is not called again after it has cancelled");
  if (++told != cancel_at) return 0;
  cancelled++;
  return 1 + below(1000);
}

static gyroakf_progress_fn any_progress(void) {
  cancel_at = one_in(2) ? 1 + below(4) : 0;
  return one_in(2) ? progress : NULL;
}

/* ------------------------------------------------------------------------------------------------------- around a call */

static modes host;

/* The last thing before a call: what it must not change is copied, the environment made odd in one of four. */
static void begin(void) {
  static const int directions[4] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO, FE_TONEAREST};
  int i, odd = one_in(4), direction = directions[below(4)];
#if defined(__x86_64__)
  int flush = one_in(2);
#endif
#if defined(__GLIBC__) && defined(__x86_64__)
  int trap = one_in(2);
#endif
  for (i = 0; i < area_count; i++) memcpy(areas[i].copy, areas[i].block, areas[i].total);
  told = cancelled = 0;
  inside = 1;
  fesetenv(FE_DFL_ENV);
  if (odd) {
    fesetround(direction);
#if defined(__x86_64__)
    if (flush) _mm_setcsr(_mm_getcsr() | 0x8040U);
#endif
#if defined(__GLIBC__) && defined(__x86_64__)
    if (trap) feenableexcept(FE_ALL_EXCEPT);
#endif
  }
  host = now();
}

/* The first thing after it. */
static void leave(int may_raise) {
  modes after = now();
  fesetenv(FE_DFL_ENV);
  inside = 0;
  if (may_raise) {
    after.raised = host.raised;
    after.control = (after.control & ~0x3fU) | (host.control & 0x3fU);
  }
  promise(memcmp(&after, &host, sizeof after) == 0, "the floating-point environment is as it was");
}

static void check_areas(int ok) {
  int i;
  for (i = 0; i < area_count; i++) {
    const area *a = &areas[i];
    if (a->use == input) promise(memcmp(a->block, a->copy, a->total) == 0, "nothing is changed behind a const");
    else if (a->use == output && !ok) promise(memcmp(a->block, a->copy, a->total) == 0, "no result is written after a failure");
    promise(memcmp(a->block, a->copy, a->before) == 0, "nothing is written before an array");
    promise(memcmp(a->data + a->bytes, a->copy + a->before + a->bytes, a->total - a->before - a->bytes) == 0,
            "nothing is written beyond an array");
  }
}

/* Text of UTF-8 without control characters other than line feeds. */
static int is_clean(const char *message) {
  const unsigned char *p = (const unsigned char *)message;
  while (*p) {
    int more = *p < 0x80 ? 0 : *p >= 0xf0 ? 3 : *p >= 0xe0 ? 2 : *p >= 0xc0 ? 1 : -1;
    if (more < 0 || (*p < 0x20 && *p != '\n') || *p == 0x7f) return 0;
    for (p++; more > 0; more--, p++) {
      if ((*p & 0xc0) != 0x80) return 0;
    }
  }
  return 1;
}

/* After a call with a status. */
static void end_step(int status, const gyroakf_error *err, int may_raise) {
  leave(may_raise);
  promise(status >= GYROAKF_OK && status < GYROAKF_INTERNAL, "a status that is known, and no defect");
  promise((status == GYROAKF_CANCELLED) == (cancelled > 0), "cancelled where progress said so, and only there");
  if (err) {
    promise(err->code == status, "err has the status");
    promise(memchr(err->message, 0, sizeof err->message) != NULL, "the message ends");
    err = memchr(err->message, 0, sizeof err->message) ? err : NULL;
  }
  if (err) {
    promise((err->message[0] == 0) == (status == GYROAKF_OK), "there is a message after a failure, none after a success");
    promise(is_clean(err->message), "the message can be shown");
    if (!is_clean(err->message)) fprintf(stderr, "  %s\n", err->message);
  }
  check_areas(status == GYROAKF_OK);
}

static void end(int status, const gyroakf_error *err) { end_step(status, err, 0); }

/* Results after a success are numbers, and finite. */
static void promise_numbers(int status, const double *x, int64_t n) {
  int64_t i;
  for (i = 0; status == GYROAKF_OK && x && i < n; i++) {
    promise(isfinite(x[i]), "results are finite");
    if (!isfinite(x[i])) return;
  }
}

/* After a call without. */
static void done(void) {
  leave(0);
  check_areas(1);
}

static void clear(void) {
  while (area_count > 0) {
    area_count--;
    free(areas[area_count].block);
    free(areas[area_count].copy);
  }
}

/* ------------------------------------------------------------------------------------------------------------- options */

/* X *X_of(): options that are as _init makes them, or with odd members; or NULL */
#define OPTIONS(name, members) \
  static gyroakf_##name *any_##name(void) { \
    gyroakf_##name *o; \
    if (one_in(4)) return NULL; \
    o = (gyroakf_##name *)take(sizeof *o, 0, input); \
    gyroakf_##name##_init(o); \
    promise(o->struct_size == sizeof *o, "the size of the struct"); \
    members \
    o->struct_size = any_size(sizeof *o); \
    return o; \
  } \
  static void call_##name##_init(void) { \
    gyroakf_##name *o = (gyroakf_##name *)place(sizeof *o); \
    begin(); \
    gyroakf_##name##_init(o); \
    done(); \
  }
#define ODD(member, value) if (one_in(3)) o->member = value;
#define TOLD o->progress = any_progress(); o->progress_user = &user;

/* so many samples as fit, or more than any machine holds */
static int64_t any_samples(void) { return one_in(8) ? (one_in(2) ? -below(2) : ((int64_t)1 << 44) + below(2)) : below(one_in(50) ? 5000 : 100); }

OPTIONS(reader_options,
        if (one_in(2)) {
          ODD(format, text()) ODD(columns, text()) ODD(time_column, text()) ODD(skip, any_long()) ODD(bad_lines_missing, any_int())
          ODD(input, text()) ODD(unit, text()) ODD(scale, any_double()) ODD(rate_hz, any_double()) ODD(from, any_double())
          ODD(to, any_double()) ODD(resample, text()) ODD(wrap, text()) ODD(channels, any_long())
          ODD(decimal_comma, any_int()) ODD(memory, any_long())
        } TOLD)
OPTIONS(simulate_options,
        o->samples = any_samples();
        ODD(preset, one_in(200) ? "paper" : one_in(9) ? "odd" : NULL) ODD(seed, any_long()) ODD(rate_hz, any_double()) ODD(unit, text())
        ODD(q, any_double()) ODD(n, any_double()) ODD(b, any_double()) ODD(k, any_double()) ODD(r, any_double())
        ODD(ar_phi, any_double()) ODD(ar_variance, any_double()) ODD(offset, any_double()) ODD(outlier_size, any_double())
        ODD(outliers, any_long()) ODD(lsb, any_double()) ODD(missing, any_double()) TOLD)
OPTIONS(run_options,
        ODD(preset, text()) ODD(tests, any_int() & 1) ODD(ar, any_int() & 1) ODD(filters, any_int() & 1) ODD(allan, any_int() & 1) TOLD)
OPTIONS(allan_options, ODD(kind, text()) ODD(taus, text()) ODD(confidence, any_double()) ODD(min_coverage, any_double()) TOLD)
OPTIONS(fit_options, ODD(terms, text()) ODD(tau_min, any_double()) ODD(tau_max, any_double()) ODD(lsb, any_double()))
OPTIONS(outlier_options,
        ODD(method, text()) ODD(threshold, any_double()) ODD(rounds, any_int()) ODD(half_width, any_int()) ODD(degree, any_int()) TOLD)
OPTIONS(adf_options, ODD(regression, text()) ODD(lags, any_int()) ODD(max_lags, any_int()) ODD(criterion, text()) TOLD)
OPTIONS(kpss_options, ODD(regression, text()) ODD(rule, text()) ODD(lags, any_long()) TOLD)
OPTIONS(ar_options, ODD(method, text()) ODD(criterion, text()) ODD(order, any_int()) TOLD)
OPTIONS(filter_options,
        ODD(estimate_process_mean, any_int()) ODD(estimate_measurement_mean, any_int()) ODD(estimate_process_variance, any_int())
        ODD(estimate_measurement_variance, any_int()) ODD(allow_unobservable, any_int())
        if (one_in(2)) {
          ODD(forgetting, any_double()) ODD(measurement_form, text()) ODD(burn_in, any_int()) ODD(huber, any_double())
          ODD(r_scale, any_double()) ODD(initial_variance, any_double()) ODD(q_lower, any_double()) ODD(q_upper, any_double())
          ODD(r_lower, any_double()) ODD(r_upper, any_double())
        })

OPTIONS(drift_options,
        ODD(drift_samples, any_double()) ODD(most_samples, any_long()) TOLD)

/* A model, often a good one. */
static gyroakf_drift_model *any_drift_model(void) {
  gyroakf_drift_model *m;
  int i, odd = one_in(4);
  if (one_in(40)) return NULL;
  m = (gyroakf_drift_model *)take(sizeof *m, 0, input);
  gyroakf_drift_model_init(m);
  m->count = odd && one_in(4) ? any_int() : 1 + below(3);
  m->r = odd && one_in(3) ? any_double() : uniform();
  for (i = 0; i < 3; i++) {
    m->phi[i] = odd && one_in(3) ? any_double() : i == 0 && one_in(3) ? 1.0 : 0.9 * uniform() + 0.09;
    m->q[i] = odd && one_in(3) ? any_double() : 0.01 * uniform();
    m->slow[i] = odd && one_in(3) ? any_int() : i == 0;
  }
  m->struct_size = any_size(sizeof *m);
  return m;
}

/* ------------------------------------------------------------------------------------------------------------- release */

static void call_version(void) {
  int version;
  begin();
  version = gyroakf_version();
  done();
  promise(version == GYROAKF_VERSION, "the version is that of the header");
}

static void call_version_string(void) {
  const char *version;
  begin();
  version = gyroakf_version_string();
  done();
  promise(strcmp(version, GYROAKF_VERSION_STRING) == 0, "the version's text is that of the header");
}

static void call_status_string(void) {
  int status = any_int();
  const char *said;
  begin();
  said = gyroakf_status_string(status);
  done();
  promise(said && *said && is_clean(said), "a status has a text");
  promise((strcmp(said, "unknown status") == 0) == (status < 0 || status > GYROAKF_USAGE), "unknown is what is no status");
}

/* ---------------------------------------------------------------------------------------------------------- recordings */

/* The content of a file: rows of numbers, spoilt or not, or anything. */
static unsigned char *any_bytes(int *n) {
  static const char *const pieces[] = {"nan", ",", ";", "\t", "\n", "\r\n", "# rate: 100 Hz\n", "time,gx,gy\n", "t (s);wx (deg/s)\n", "1e999",
                                       "2021-03-04T05:06:07.5Z", "\"", "\x93NUMPY\x01", "1_0", "0x1p3", "\xef\xbb\xbf", "unit=deg/h\n"};
  static char content[4096];
  unsigned char *bytes;
  int i, rows = 1 + below(25), columns = 1 + below(3), used = 0, step = below(3);
  if (one_in(3)) used += sprintf(content + used, "%s", pieces[6 + below(3)]);
  for (i = 0; i < rows * columns && used < 3000; i++) {
    if (i % columns == 0 && step) used += sprintf(content + used, "%.3f,", 0.01 * (i / columns));
    used += sprintf(content + used, one_in(9) ? "%.0f" : "%.6g", one_in(30) ? any_double() : normal());
    used += sprintf(content + used, "%s", (i + 1) % columns ? "," : "\n");
    if (one_in(80)) used += sprintf(content + used, "%s", pieces[below((int)(sizeof pieces / sizeof pieces[0]))]);
  }
  if (one_in(6)) {
    used = 1 + below(200);
    for (i = 0; i < used; i++) content[i] = (char)bits();
  }
  for (i = one_in(3) ? below(4) : 0; i > 0; i--) content[below(used)] = (char)bits();
  bytes = (unsigned char *)take((size_t)used, 0, input);
  memcpy(bytes, content, (size_t)used);
  *n = used;
  return bytes;
}

static void call_record_parse(void) {
  static const int64_t wrong[] = {0, -1, INT64_MIN, INT64_MAX, ((int64_t)1 << 47) + 1};
  int n, status;
  const unsigned char *bytes = any_bytes(&n);
  gyroakf_reader_options *opt = any_reader_options();
  gyroakf_record **out = one_in(40) ? NULL : (gyroakf_record **)take(sizeof *out, 0, always);
  gyroakf_error *err = error_place();
  int64_t length = one_in(30) ? wrong[below(5)] : n;
  if (one_in(40)) bytes = NULL;
  begin();
  status = gyroakf_record_parse(bytes, length, opt, out, err);
  end(status, err);
  keep(records, status, (void **)out);
}

static void try_record_new(int watched) {
  gyroakf_progress_fn listener = any_progress();
  int64_t n = 0, shorter;
  int32_t channels = 1 + below(3), i;
  const double **values = (const double **)take(3 * sizeof *values, 0, input), *x;
  const char **names = one_in(2) ? NULL : (const char **)take(3 * sizeof *names, 0, input);
  const char *unit = text();
  double dt = one_in(3) ? any_double() : 0.01;
  gyroakf_record **out = one_in(40) ? NULL : (gyroakf_record **)take(sizeof *out, 0, always);
  gyroakf_error *err = error_place();
  int status;
  for (i = 0; i < 3; i++) {
    x = series(&shorter);
    values[i] = i == 0 || (shorter >= n && n > 0 && shorter <= longest_series) ? x : values[0];
    if (i == 0) n = shorter;
    if (names) names[i] = text();
  }
  if (one_in(40)) values = NULL;
  if (one_in(20)) channels = one_in(2) ? -below(3) : 100001;
  begin();
  if (watched) status = gyroakf_record_new_watched(values, channels, n, dt, names, unit, out, listener, &user, err);
  else status = gyroakf_record_new(values, channels, n, dt, names, unit, out, err);
  end(status, err);
  keep(records, status, (void **)out);
}

static void call_record_new(void) { try_record_new(0); }
static void call_record_new_watched(void) { try_record_new(1); }

static void call_record_read(void) {
  static const char *const paths[] = {"", "no-such-file", "/dev/null", ".", "-", "no/such/folder/file.csv", "/"};
  const char *path = one_in(9) ? text() : one_in(20) ? NULL : paths[below(7)];
  gyroakf_reader_options *opt = any_reader_options();
  gyroakf_record **out = one_in(40) ? NULL : (gyroakf_record **)take(sizeof *out, 0, always);
  gyroakf_error *err = error_place();
  int status;
  begin();
  status = gyroakf_record_read(path, opt, out, err);
  end(status, err);
  keep(records, status, (void **)out);
}

static void call_simulate(void) {
  gyroakf_simulate_options *opt = any_simulate_options();
  gyroakf_record **out = one_in(40) ? NULL : (gyroakf_record **)take(sizeof *out, 0, always);
  gyroakf_error *err = error_place();
  int status;
  begin();
  status = gyroakf_simulate(opt, out, err);
  end(status, err);
  keep(records, status, (void **)out);
}

static int32_t any_channel(const gyroakf_record *r) {
  return one_in(3) || gyroakf_record_channels(r) == 0 ? any_int() : below((int)gyroakf_record_channels(r));
}

/* What a function says of a handle, from argument r; check of the value it returns */
#define TELLS(name, handle_type, kind, type, promised) \
  static void call_##name(void) { \
    const handle_type *r = (const handle_type *)handle(kind); \
    type value; \
    begin(); \
    value = gyroakf_##name(r); \
    done(); \
    promise(promised, "what it tells"); \
  }
#define TELLS_OF(name, type, promised) \
  static void call_##name(void) { \
    const gyroakf_record *r = (const gyroakf_record *)handle(records); \
    int32_t i = any_channel(r); \
    int there = i >= 0 && i < gyroakf_record_channels(r); \
    type value; \
    begin(); \
    value = gyroakf_##name(r, i); \
    done(); \
    (void)there; \
    promise(promised, "what it tells of a channel"); \
  }

static int is_values(const gyroakf_record *r, const double *value) {
  int64_t i;
  for (i = 0; i < gyroakf_record_samples(r); i++) {
    if (isinf(value[i])) return 0;
  }
  return 1;
}

TELLS(record_samples, gyroakf_record, records, int64_t, (value > 0) == (r != NULL))
TELLS(record_channels, gyroakf_record, records, int32_t, (value > 0) == (r != NULL))
TELLS(record_sample_interval, gyroakf_record, records, double, r ? isfinite(value) && value > 0 : value == 0)
TELLS(record_rate_source, gyroakf_record, records, const char *, r ? value && is_clean(value) : !value)
TELLS(record_format, gyroakf_record, records, const char *, r ? value && is_clean(value) : !value)
TELLS(record_warnings, gyroakf_record, records, int32_t, r ? value >= 0 : value == 0)
TELLS(result_json, gyroakf_result, runs, const char *, r ? value && value[0] == '{' && is_clean(value) : !value)
TELLS(allan_size, gyroakf_allan, allans, int64_t, (value > 0) == (r != NULL))
TELLS(allan_tau, gyroakf_allan, allans, const double *, r ? value && value[0] > 0 : !value)
TELLS(allan_deviation, gyroakf_allan, allans, const double *, r ? value && value[0] >= 0 : !value)
TELLS(allan_lower, gyroakf_allan, allans, const double *, r ? value && value[0] >= 0 : !value)
TELLS(allan_upper, gyroakf_allan, allans, const double *, r ? value && value[0] >= 0 : !value)
TELLS(allan_edf, gyroakf_allan, allans, const double *, r ? value && value[0] >= 0 : !value)
TELLS_OF(record_values, const double *, there ? value && is_values(r, value) : !value)
TELLS_OF(record_present, const int8_t *, there ? !value || value[0] == 0 || value[0] == 1 : !value)
TELLS_OF(record_name, const char *, there ? value && is_clean(value) : !value)
TELLS_OF(record_unit, const char *, there ? value && is_clean(value) : !value)
TELLS_OF(record_to_si, double, there ? isfinite(value) && value >= 0 : value == 0)

static void call_record_warning(void) {
  const gyroakf_record *r = (const gyroakf_record *)handle(records);
  int32_t i = one_in(2) ? any_int() : 0;
  const char *value;
  begin();
  value = gyroakf_record_warning(r, i);
  done();
  promise((value != NULL) == (i >= 0 && i < gyroakf_record_warnings(r)), "a warning where there is one");
  promise(!value || is_clean(value), "a warning can be shown");
}

static void call_record_audit(void) {
  const gyroakf_record *r = (const gyroakf_record *)handle(records);
  gyroakf_audit *out = (gyroakf_audit *)place(sizeof *out);
  int status;
  if (out) out->struct_size = any_size(sizeof *out);
  begin();
  status = gyroakf_record_audit(r, out);
  end(status, NULL);
  if (status == GYROAKF_OK) promise(out->samples == gyroakf_record_samples(r), "the audit counts the samples");
}

#define FREES(name, handle_type, kind) \
  static void call_##name(void) { \
    handle_type *h = (handle_type *)drop(kind); \
    begin(); \
    gyroakf_##name(h); \
    done(); \
  }
FREES(record_free, gyroakf_record, records)
FREES(allan_free, gyroakf_allan, allans)
FREES(filter_free, gyroakf_filter, filters)
FREES(result_free, gyroakf_result, runs)

static void call_run(void) {
  const gyroakf_record *r = (const gyroakf_record *)handle(records);
  gyroakf_run_options *opt = any_run_options();
  gyroakf_result **out = one_in(40) ? NULL : (gyroakf_result **)take(sizeof *out, 0, always);
  gyroakf_error *err = error_place();
  int status;
  begin();
  status = gyroakf_run(r, opt, out, err);
  end(status, err);
  keep(runs, status, (void **)out);
}

/* ----------------------------------------------------------------------------------------------------------- of series */

static void call_allan_new(void) {
  int64_t n;
  const double *x = series(&n);
  double dt = one_in(3) ? any_double() : 0.01;
  gyroakf_allan_options *opt = any_allan_options();
  gyroakf_allan **out = one_in(40) ? NULL : (gyroakf_allan **)take(sizeof *out, 0, always);
  gyroakf_error *err = error_place();
  int status;
  begin();
  status = gyroakf_allan_new(x, n, dt, opt, out, err);
  end(status, err);
  if (status == GYROAKF_OK) {
    promise_numbers(status, gyroakf_allan_tau(*out), gyroakf_allan_size(*out));
    promise_numbers(status, gyroakf_allan_deviation(*out), gyroakf_allan_size(*out));
    promise_numbers(status, gyroakf_allan_lower(*out), gyroakf_allan_size(*out));
    promise_numbers(status, gyroakf_allan_upper(*out), gyroakf_allan_size(*out));
    promise_numbers(status, gyroakf_allan_edf(*out), gyroakf_allan_size(*out));
  }
  keep(allans, status, (void **)out);
}

static void call_noise_fit(void) {
  const gyroakf_allan *a = (const gyroakf_allan *)handle(allans);
  gyroakf_fit_options *opt = any_fit_options();
  gyroakf_noise *out = (gyroakf_noise *)place(sizeof *out);
  gyroakf_error *err = error_place();
  int status;
  begin();
  status = gyroakf_noise_fit(a, opt, out, err);
  end(status, err);
  if (out) promise_numbers(status, &out->n.value, 3);
}

static void call_allan_fit(void) {
  gyroakf_allan *a = (gyroakf_allan *)handle(allans);
  gyroakf_fit_options *opt = any_fit_options();
  gyroakf_noise *out = (gyroakf_noise *)place(sizeof *out);
  gyroakf_error *err = error_place();
  int status;
  begin();
  status = gyroakf_allan_fit(a, opt, out, err);
  end(status, err);
  if (out) promise_numbers(status, &out->n.value, 3);
  if (a && status == GYROAKF_OK) promise_numbers(status, gyroakf_allan_upper(a), gyroakf_allan_size(a));
}

static void call_mark_outliers(void) {
  int64_t n;
  const double *x = series(&n);
  gyroakf_outlier_options *opt = any_outlier_options();
  int8_t *inlier = (int8_t *)results(n > 0 && n < 6000 ? (size_t)n : 0, 40);
  gyroakf_outliers *out = (gyroakf_outliers *)place(sizeof *out);
  gyroakf_error *err = error_place();
  int status;
  begin();
  status = gyroakf_mark_outliers(x, n, opt, inlier, out, err);
  end(status, err);
  if (out) promise_numbers(status, &out->expected, 5);
}

static void call_clean(void) {
  int64_t n;
  const double *x = series(&n);
  gyroakf_outlier_options *opt = any_outlier_options();
  double *cleaned = (double *)results((n > 0 && n < 6000 ? (size_t)n : 0) * sizeof *cleaned, 40);
  gyroakf_outliers *out = (gyroakf_outliers *)place(sizeof *out);
  gyroakf_error *err = error_place();
  int status;
  begin();
  status = gyroakf_clean(x, n, opt, cleaned, out, err);
  end(status, err);
  if (out) promise_numbers(status, &out->expected, 5);
}

/* A test of a series with options; its result begins with count doubles. */
#define TESTS(name, result, count) \
  static void call_##name##_test(void) { \
    int64_t n; \
    const double *x = series(&n); \
    gyroakf_##name##_options *opt = any_##name##_options(); \
    gyroakf_##result *out = (gyroakf_##result *)place(sizeof *out); \
    gyroakf_error *err = error_place(); \
    int status; \
    begin(); \
    status = gyroakf_##name##_test(x, n, opt, out, err); \
    end(status, err); \
    promise_numbers(status, (const double *)out, count); \
  }
TESTS(adf, adf, 5)
TESTS(kpss, kpss, 10)

static void call_ar_fit(void) {
  int64_t n;
  const double *x = series(&n);
  gyroakf_ar_options *opt = any_ar_options();
  int32_t most = one_in(6) ? any_int() : below(8), *order = (int32_t *)place(sizeof *order);
  double *phi = (double *)results((most > 0 && most <= 1000 ? (size_t)most : 0) * sizeof *phi, 30);
  double *variance = (double *)place(sizeof *variance), *mean = (double *)place(sizeof *mean);
  gyroakf_error *err = error_place();
  int status;
  begin();
  status = gyroakf_ar_fit(x, n, opt, most, order, phi, variance, mean, err);
  end(status, err);
  promise_numbers(status, phi, most);
  promise_numbers(status, variance, 1);
  promise_numbers(status, mean, 1);
  if (status == GYROAKF_OK) promise(*order >= 0 && *order <= most, "the order is one of those compared");
}

/* -------------------------------------------------------------------------------------------------------------- filter */

static void call_filter_new(void) {
  int32_t p = one_in(20) ? (one_in(2) ? -below(3) : 1001 + below(2)) : one_in(40) ? below(60) : one_in(2000) ? below(1001) : below(5);
  double q = one_in(5) ? any_double() : uniform(), r = one_in(5) ? any_double() : uniform(), value;
  int i, count = p > 0 && p <= 1000 ? (int)p : 0, odd = one_in(5);
  unsigned char *phi = one_in(40) ? NULL : (unsigned char *)take((size_t)count * sizeof(double), any_offset(), input);
  gyroakf_filter_options *opt = any_filter_options();
  gyroakf_filter **out = one_in(40) ? NULL : (gyroakf_filter **)take(sizeof *out, 0, always);
  gyroakf_error *err = error_place();
  int status;
  for (i = 0; phi && i < count; i++) {
    value = odd ? any_double() : 1.8 * (uniform() - 0.5) / count;
    memcpy(phi + (size_t)i * sizeof value, &value, sizeof value);
  }
  begin();
  status = gyroakf_filter_new(p, (const double *)(const void *)phi, q, r, opt, out, err);
  end(status, err);
  keep(filters, status, (void **)out);
}

static void call_filter_identify(void) {
  static const char *const kinds[] = {"kf", "akf", "drift_kf", "drift_akf"};
  const char *kind = one_in(20) ? text() : kinds[below(4)];
  int64_t n;
  const double *x = series(&n);
  double dt = one_in(5) ? any_double() : uniform(), *mean = (double *)place(sizeof *mean);
  gyroakf_run_options *opt = any_run_options();
  gyroakf_filter **out = one_in(40) ? NULL : (gyroakf_filter **)take(sizeof *out, 0, always);
  gyroakf_error *err = error_place();
  int status;
  begin();
  status = gyroakf_filter_identify(kind, x, n, dt, opt, out, mean, err);
  end(status, err);
  promise_numbers(status, mean, 1);
  keep(filters, status, (void **)out);
}

static void call_filter_step(void) {
  gyroakf_filter *f = (gyroakf_filter *)handle(filters);
  double z = one_in(4) ? any_double() : normal(), *x = (double *)place(sizeof *x);
  int status;
  begin();
  status = gyroakf_filter_step(f, z, x);
  end_step(status, NULL, 1);
  promise_numbers(status, x, 1);
}

static void call_filter_freeze(void) {
  gyroakf_filter *f = (gyroakf_filter *)handle(filters);
  int32_t frozen = any_int();
  int status;
  begin();
  status = gyroakf_filter_freeze(f, frozen);
  end(status, NULL);
}

/* A run that is cancelled, or fails in the middle, has written a part of x. */
static void try_filter_run(int watched) {
  int64_t n;
  gyroakf_filter *f = (gyroakf_filter *)handle(filters);
  const double *z = series(&n);
  double *x = (double *)results(n > 0 && n < 6000 ? (size_t)n * sizeof *x : 0, 40);
  gyroakf_error *err = error_place();
  gyroakf_progress_fn listener = any_progress();
  int status, i;
  begin();
  if (watched) status = gyroakf_filter_run_watched(f, z, n, x, listener, &user, err);
  else status = gyroakf_filter_run(f, z, n, x, err);
  for (i = 0; i < area_count && (status == GYROAKF_CANCELLED || status == GYROAKF_NON_FINITE); i++) {
    if ((void *)areas[i].data == (void *)x) areas[i].use = always;
  }
  end(status, err);
  promise_numbers(status, x, n);
}

static void call_filter_run(void) { try_filter_run(0); }
static void call_filter_run_watched(void) { try_filter_run(1); }

static void call_filter_get(void) {
  const gyroakf_filter *f = (const gyroakf_filter *)handle(filters);
  gyroakf_filter_state *out = (gyroakf_filter_state *)place(sizeof *out);
  int status;
  begin();
  status = gyroakf_filter_get(f, out);
  end(status, NULL);
  promise_numbers(status, (const double *)out, 9);
  if (status == GYROAKF_OK) promise(out->steps >= 0, "steps are counted");
}

static void call_filter_reset(void) {
  gyroakf_filter *f = (gyroakf_filter *)handle(filters);
  gyroakf_error *err = error_place();
  int status;
  begin();
  status = gyroakf_filter_reset(f, err);
  end(status, err);
}

/* A saved filter, and how much of it there is. */
static unsigned char saved[65536];
static int64_t saved_bytes;

static void call_filter_save(void) {
  const gyroakf_filter *f = (const gyroakf_filter *)handle(filters);
  int64_t capacity = one_in(4) ? any_long() : (int64_t)sizeof saved, room = capacity;
  int64_t *size = one_in(40) ? NULL : (int64_t *)take(sizeof *size, 0, always); /* says what is needed */
  gyroakf_error *err = error_place();
  unsigned char *bytes;
  int status;
  if (room < 0) room = 0;
  if (room > (int64_t)sizeof saved) room = capacity = (int64_t)sizeof saved;
  bytes = one_in(8) ? NULL : (unsigned char *)take((size_t)room, any_offset(), output);
  begin();
  status = gyroakf_filter_save(f, bytes, capacity, size, err);
  end(status, err);
  if (status != GYROAKF_OK) return;
  promise(*size > 0 && *size % 8 == 0 && (!bytes || *size <= capacity), "a saved filter has a size");
  if (!bytes) return;
  memcpy(saved, bytes, (size_t)*size);
  saved_bytes = *size;
}

static void call_filter_restore(void) {
  static const int64_t wrong[] = {0, -1, INT64_MIN, INT64_MAX, ((int64_t)1 << 44) + 1};
  int64_t n = one_in(4) ? below(400) : saved_bytes, length;
  unsigned char *bytes = (unsigned char *)take((size_t)n, any_offset(), input);
  gyroakf_filter **out = one_in(40) ? NULL : (gyroakf_filter **)take(sizeof *out, 0, always);
  gyroakf_error *err = error_place();
  int64_t i;
  int status, whole;
  for (i = 0; i < n; i++) bytes[i] = i < saved_bytes && !one_in(2000) ? saved[i] : (unsigned char)bits();
  for (i = one_in(3) ? below(4) : 0; i > 0 && n > 0; i--) bytes[below((int)n)] = (unsigned char)bits();
  for (i = one_in(3) ? below(4) : 0; i > 0 && n >= 48; i--) {
    double value = any_double();
    int64_t number = any_long();
    memcpy(bytes + 8 * (4 + below((int)n / 8 - 4)), one_in(2) ? (void *)&value : (void *)&number, 8);
  }
  if (!one_in(4)) seal(bytes, n);
  whole = n > 0 && n == saved_bytes && memcmp(bytes, saved, (size_t)n) == 0;
  length = one_in(30) ? wrong[below(5)] : n;
  if (one_in(40)) bytes = NULL;
  begin();
  status = gyroakf_filter_restore(bytes, length, out, err);
  end(status, err);
  if (bytes && out && length == n && whole) promise(status == GYROAKF_OK, "what was saved can be restored");
  keep(filters, status, (void **)out);
}

/* --------------------------------------------------------------------------------------------------------------- drift */

static void call_drift_model_init(void) {
  gyroakf_drift_model *m = (gyroakf_drift_model *)place(sizeof *m);
  begin();
  gyroakf_drift_model_init(m);
  done();
}

static void call_drift_identify(void) {
  int64_t n;
  const double *z = series(&n);
  gyroakf_drift_options *opt = any_drift_options();
  gyroakf_drift_model *model = (gyroakf_drift_model *)place(sizeof *model);
  gyroakf_error *err = error_place();
  int status;
  if (model) model->struct_size = any_size(sizeof *model);
  begin();
  status = gyroakf_drift_identify(z, n, opt, model, err);
  end(status, err);
  if (status == GYROAKF_OK) promise(model->count >= 0 && model->count <= 3 && model->r >= 0, "a model is one");
}

static void call_drift_filter_new(void) {
  gyroakf_drift_model *model = any_drift_model();
  gyroakf_filter_options *opt = any_filter_options();
  gyroakf_filter **out = one_in(40) ? NULL : (gyroakf_filter **)take(sizeof *out, 0, always);
  gyroakf_error *err = error_place();
  int status;
  begin();
  status = gyroakf_drift_filter_new(model, opt, out, err);
  end(status, err);
  keep(filters, status, (void **)out);
}

static void try_drift_smooth(int watched) {
  gyroakf_progress_fn listener = any_progress();
  int64_t n;
  const gyroakf_drift_model *model = any_drift_model();
  const double *z = series(&n);
  gyroakf_filter_options *opt = any_filter_options();
  size_t bytes = n > 0 && n < 6000 ? (size_t)n * sizeof(double) : 0;
  double *drift = one_in(40) ? NULL : (double *)take(bytes, any_offset(), always); /* holds anything after a failure */
  double *variance = one_in(3) ? NULL : (double *)take(bytes, any_offset(), always);
  gyroakf_error *err = error_place();
  int status, same = one_in(40);
  if (same && variance) variance = drift;
  begin();
  if (watched) status = gyroakf_drift_smooth_watched(model, z, n, drift, variance, opt, listener, &user, err);
  else status = gyroakf_drift_smooth(model, z, n, drift, variance, opt, err);
  end(status, err);
  promise_numbers(status, drift, n);
  promise_numbers(status, variance, n);
  if (same && variance) promise(status != GYROAKF_OK, "drift and variance must differ");
}

static void call_drift_smooth(void) { try_drift_smooth(0); }
static void call_drift_smooth_watched(void) { try_drift_smooth(1); }

/* ---------------------------------------------------------------------------------------------------------------- main */

static void run(int weights) {
  int i, calls = 1 + below(8);
  saved_bytes = 0;
  for (; calls > 0; calls--) {
    int at = below(weights);
    for (i = 0; at >= functions[i].weight; i++) at -= functions[i].weight;
    current = functions[i].name;
    calls_made[i]++;
    functions[i].call();
    clear();
  }
  current = "the end";
  free_all();
}

/* So many seconds of processor time from now on; 0: no limit any more. */
static void limit_time(int seconds) {
  struct itimerval timer;
  memset(&timer, 0, sizeof timer);
  timer.it_value.tv_sec = seconds;
  setitimer(ITIMER_PROF, &timer, NULL);
}

int main(int argc, char **argv) {
  static const int signals[] = {SIGSEGV, SIGFPE, SIGABRT, SIGILL, SIGBUS, SIGPROF};
  uint64_t runs = argc > 1 ? strtoull(argv[1], NULL, 10) : 0, first = argc > 2 ? strtoull(argv[2], NULL, 10) : 1, i;
  int64_t calls = 0, bad = 0;
  int k, weights = 0;
  if (runs == 0) {
    fprintf(stderr, "usage: calls RUNS [SEED]\n");
    return 2;
  }
  if (!freopen("/dev/null", "r", stdin)) return 2;
#ifdef __SANITIZE_ADDRESS__
  __sanitizer_set_death_callback(tell_place);
#else
  for (k = 0; k < (int)(sizeof signals / sizeof signals[0]); k++) signal(signals[k], at_signal);
#endif
  signal(signals[5], at_signal);
  atexit(at_exit);
  for (k = 0; k < function_count; k++) weights += functions[k].weight;
  for (i = 0; i < runs && bad < most_bad; i++) {
    seed_of_run = first + i;
    state = seed_of_run * UINT64_C(0xd1342543de82ef95);
    failed = 0;
    limit_time(120);
    run(weights);
    bad += failed;
  }
  limit_time(0);
  for (k = 0; k < function_count; k++) {
    calls += calls_made[k];
    if (runs >= 100000 && calls_made[k] == 0) {
      printf("FAILED: %s was never called\n", functions[k].name);
      bad++;
    }
  }
  printf("%lld calls\n%lld passed, %lld failed\n", (long long)calls, (long long)i - bad, (long long)bad);
  return bad > 0;
}
