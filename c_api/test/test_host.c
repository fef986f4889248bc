/* SPDX-License-Identifier: MIT */
/*
 * Programs that changed the floating-point environment: results are the same to the last bit, and the environment is as it was
 * after every call. While it is changed this file computes nothing.
 */
#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* feenableexcept */
#endif
#include "check.h"
#include "modes.h"
#include "threads.h"
#include "work.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void usual(void) {}
static void upward(void) { fesetround(FE_UPWARD); }
static void to_zero(void) {
  fesetround(FE_TOWARDZERO);
  feraiseexcept(FE_INEXACT | FE_UNDERFLOW);
}
#if defined(__GLIBC__) && defined(__x86_64__)
static void traps(void) { feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW); }
static void all_traps(void) { feenableexcept(FE_ALL_EXCEPT); }
#endif
#if defined(__x86_64__)
static void flushing(void) { _mm_setcsr(_mm_getcsr() | 0x8040U); }
static void all_together(void) {
  upward();
  flushing();
#if defined(__GLIBC__)
  traps();
#endif
}
#endif

typedef struct tiny_results {
  double stepped[100], run[100], read[2];
} tiny_results;

/* A filter, a step at a time and all at once, and a recording with numbers below the smallest normal one. */
static void use_tiny(tiny_results *tiny, const double *z) {
  static const char text[] = "3e-310\n5e-310\n1\n";
  const double phi = 0.5;
  gyroakf_filter *f = NULL;
  gyroakf_record *r = NULL;
  gyroakf_reader_options opt;
  gyroakf_error error;
  int i;
  gyroakf_filter_new(1, &phi, 1e-3, 1.0, NULL, &f, &error);
  for (i = 0; i < 100; i++) gyroakf_filter_step(f, z[i], &tiny->stepped[i]);
  gyroakf_filter_free(f);
  gyroakf_filter_new(1, &phi, 1e-3, 1.0, NULL, &f, &error);
  gyroakf_filter_run(f, z, 100, tiny->run, &error);
  gyroakf_filter_free(f);
  gyroakf_reader_options_init(&opt);
  opt.scale = 0.5;
  gyroakf_record_parse(text, (int64_t)strlen(text), &opt, &r, &error);
  if (gyroakf_record_samples(r) == 3) memcpy(tiny->read, gyroakf_record_values(r, 0), sizeof tiny->read);
  gyroakf_record_free(r);
}

/* The work in an environment that `change` makes, beside the same in the usual one. */
static void compare(void (*change)(void), const char *what, const char *text, const double *z) {
  results *expected = (results *)calloc(1, sizeof *expected), *found = (results *)calloc(1, sizeof *found);
  tiny_results *tiny = (tiny_results *)calloc(2, sizeof *tiny);
  modes before, between, after;
  fenv_t mine;
  if (expected == NULL || found == NULL || tiny == NULL) abort();
  expected->seed = found->seed = 1;
  work(expected, text);
  use_tiny(&tiny[0], z);
  fegetenv(&mine);
  feclearexcept(FE_ALL_EXCEPT);
  change();
  before = now();
  work(found, text);
  between = now();
  use_tiny(&tiny[1], z);
  after = now();
  fesetenv(&mine);
  check(expected->status == 0 && found->status == 0, what);
  check(memcmp(expected, found, sizeof *found) == 0, what);
  check(memcmp(&tiny[0], &tiny[1], sizeof tiny[0]) == 0, what);
  check(memcmp(tiny[0].stepped, tiny[0].run, sizeof tiny[0].run) == 0, "step by step as all at once");
  check(tiny[0].read[0] == 0.5 * 3e-310 && tiny[0].read[1] == 0.5 * 5e-310, "tiny numbers are kept");
  check(before.rounding == between.rounding && before.rounding == after.rounding, what);
  check(before.trapped == between.trapped && before.trapped == after.trapped, what);
  if (change != usual) { /* a step in the usual environment may raise flags */
    check(memcmp(&before, &between, sizeof before) == 0, what);
    check(memcmp(&before, &after, sizeof before) == 0, what);
  }
  free(expected);
  free(found);
  free(tiny);
}

void test_host(void) {
  char *text = make_recording(1);
  double z[100];
  int threads = omp_get_max_threads();
  uniform(z, 100, 4711);
  omp_set_num_threads(1); /* sums of several threads may differ in the last bit */
  compare(usual, "the usual environment", text, z);
  compare(upward, "rounding upward", text, z);
  compare(to_zero, "rounding toward zero, two flags raised", text, z);
#if defined(__GLIBC__) && defined(__x86_64__)
  compare(traps, "traps for invalid operations, division by zero and overflow", text, z);
  compare(all_traps, "all traps", text, z);
#endif
#if defined(__x86_64__)
  compare(flushing, "tiny numbers flushed to zero", text, z);
  compare(all_together, "all of it", text, z);
#endif
  omp_set_num_threads(threads);
  free(text);
}
