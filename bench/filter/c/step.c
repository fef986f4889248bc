/* SPDX-License-Identifier: MIT */
/*
 * Time of gyroakf_filter_step from C, sample by sample, and what it asks of the system meanwhile (ci/realtime/counted.h).
 * Processor time, medians of 51 runs of 100,000 steps; run.sh reads the lines.
 */
#define _GNU_SOURCE
#include <gyroakf.h>

#include "counted.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define STEPS 100000
#define RUNS 51

static double z[STEPS], x[STEPS];

static double nanoseconds(void) {
  struct timespec now;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e9 * (double)now.tv_sec + (double)now.tv_nsec;
}

static int ascending(const void *a, const void *b) {
  double d = *(const double *)a - *(const double *)b;
  return (d > 0) - (d < 0);
}

/* An AR(1) series of normal numbers from a small generator of its own. */
static void make_series(void) {
  uint64_t state = 1;
  int i, k;
  for (i = 0; i < STEPS; i++) {
    double sum = -6;
    for (k = 0; k < 12; k++) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      sum += (double)(state >> 11) / 9007199254740992.0;
    }
    z[i] = sum + (i ? 0.4 * z[i - 1] : 0);
  }
}

/* One line: name, median and fastest nanoseconds a step, allocations and locks within all the steps. */
static void report(const char *name, int order, int q, int r, double huber, double goal) {
  const double phi[4] = {0.4, 0.2, -0.1, 0.05};
  double time[RUNS];
  gyroakf_filter_options options;
  gyroakf_filter *filter;
  gyroakf_error error;
  long before = allocations, made, allocated, locked;
  int i, k;

  gyroakf_filter_options_init(&options);
  options.estimate_process_variance = q;
  options.estimate_measurement_variance = r;
  options.huber = huber;
  if (q) options.measurement_form = "paper";
  if (gyroakf_filter_new(order, phi, 1.0, 1.2, &options, &filter, &error)) {
    fprintf(stderr, "%s\n", error.message);
    exit(1);
  }
  made = allocations - before;
  allocated = allocations;
  locked = locks;
  for (i = 0; i < RUNS; i++) {
    double start = nanoseconds();
    for (k = 0; k < STEPS; k++) gyroakf_filter_step(filter, z[k], &x[k]);
    time[i] = (nanoseconds() - start) / STEPS;
  }
  allocated = allocations - allocated;
  locked = locks - locked;
  gyroakf_filter_free(filter);
  qsort(time, RUNS, sizeof *time, ascending);
  printf("%-30s%9.1f%9.1f%8.0f%12ld%8ld%15ld\n", name, time[RUNS / 2], time[0], goal, allocated, locked, made);
}

int main(void) {
  make_series();
  printf("%-30s%9s%9s%8s%12s%8s%15s\n", "C, step by step", "median", "fastest", "goal", "allocated", "locked", "gyroakf_..new");
  report("Kalman", 1, 0, 0, 0.0, 25);
  report("Sage-Husa Q R", 1, 1, 1, 0.0, 25);
  report("Sage-Husa R, Huber", 1, 0, 1, 2.5, 25);
  report("Kalman, AR(4)", 4, 0, 0, 0.0, 120);
  report("Sage-Husa Q R, AR(4)", 4, 1, 1, 0.0, 120);
  return 0;
}
