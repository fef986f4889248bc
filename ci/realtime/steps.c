/* SPDX-License-Identifier: MIT */
/*
 * A step of a filter, gyroakf_filter_step or GYFSTP, asks nothing of the system: no allocation and no mutex (counted), and no system
 * call: the steps are made by a process, too, that the kernel ends at the first one. Filters of orders up to 9, with everything that
 * can be adapted, and of drifts; some measurements are missing, infinite or wild; frozen half of the time. The last line is
 * "N passed, N failed".
 */
#define _GNU_SOURCE
#include <gyroakf.h>

#include "counted.h"

#include <linux/seccomp.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

void gyfini_(const int32_t *ip, const double *phi, const double *q, const double *r, const int32_t *iadapt, const double *b,
             double *work, const int32_t *lwork, int32_t *info);
void gyfstp_(double *work, const double *z, double *x, int32_t *info);
void gyffrz_(double *work, const int32_t *ifrz, int32_t *info);

enum { steps = 3000, most = 2000, room = 200 };

/* Of the C interface, or of the FORTRAN 77 one. */
typedef struct filter {
  gyroakf_filter *f;
  double work[room];
} filter;

static filter filters[most];
static const int32_t orders[] = {0, 1, 2, 4, 9};
static const double phi[9] = {0.4, 0.2, -0.1, 0.05, 0.04, 0.03, -0.02, 0.01, 0.01};
static int count, passed, failed;

static void check(int good, const char *what) {
  if (good) passed++;
  else failed++;
  if (!good) printf("FAILED: %s\n", what);
}

static double measurement(int k) {
  static uint64_t state = 1;
  state = state * 6364136223846793005U + 1442695040888963407U;
  if (k % 7 == 3) return NAN;
  if (k % 101 == 50) return k % 2 ? INFINITY : -INFINITY;
  if (k % 103 == 51) return 1e300;
  return (double)(state >> 11) / 9007199254740992.0 * (k % 97 == 40 ? 1e6 : 1.0) - 0.5;
}

/* What cannot be adapted together is refused, and left out. */
static int add(int status, gyroakf_filter **f) {
  if (status == GYROAKF_OK && count < most) filters[count++].f = *f;
  return status == GYROAKF_OK;
}

static void add_legacy(int32_t order, int i) {
  const double q = 0.1, r = 1.0, b = 0.98;
  const int32_t adapt[4] = {i & 1, i >> 1 & 1, i >> 2 & 1, i >> 3 & 1}, lwork = room;
  int32_t info = 1;
  if (count == most) return;
  gyfini_(&order, phi, &q, &r, adapt, &b, filters[count].work, &lwork, &info);
  if (info == 0) count++;
}

static void make_filters(void) {
  static const char *const forms[] = {"residual", "exact", "biased", "paper"};
  gyroakf_filter_options opt;
  gyroakf_drift_model model;
  gyroakf_filter *f;
  int i, k;
  for (i = 0; i < 5 * 4 * 64; i++) {
    gyroakf_filter_options_init(&opt);
    opt.measurement_form = forms[i / 64 % 4];
    opt.estimate_process_mean = i & 1;
    opt.estimate_measurement_mean = i >> 1 & 1;
    opt.estimate_process_variance = i >> 2 & 1;
    opt.estimate_measurement_variance = i >> 3 & 1;
    opt.huber = i & 16 ? 2.5 : 0.0;
    opt.allow_unobservable = 1;
    opt.burn_in = i & 32 ? -1 : 0;
    add(gyroakf_filter_new(orders[i / 256], phi, 0.1, 1.0, &opt, &f, NULL), &f);
  }
  check(count > 1000, "filters of AR models");
  i = count;
  for (k = 0; k < 5 * 16; k++) add_legacy(orders[k / 16], k);
  check(count > i + 40, "filters of FORTRAN 77");
  for (i = 1; i <= 3; i++) {
    for (k = 0; k < 4; k++) {
      gyroakf_drift_model_init(&model);
      gyroakf_filter_options_init(&opt);
      model.count = i;
      model.phi[0] = 1.0;
      model.phi[1] = 0.99;
      model.phi[2] = 0.6;
      model.q[0] = model.q[1] = model.q[2] = 0.01;
      model.slow[0] = 1;
      model.r = 1.0;
      opt.estimate_measurement_variance = k & 1;
      opt.huber = k & 2 ? 3.0 : 0.0;
      check(add(gyroakf_drift_filter_new(&model, &opt, &f, NULL), &f), "the filter of a drift");
    }
  }
}

/* The steps of one filter: how many failed. */
static int run(filter *g) {
  double z, x;
  int32_t status, frozen;
  int k, odd = 0;
  for (k = 0; k < steps; k++) {
    frozen = k / 500 % 2;
    if (k % 500 == 0 && g->f) gyroakf_filter_freeze(g->f, frozen);
    else if (k % 500 == 0) gyffrz_(g->work, &frozen, &status);
    z = measurement(k);
    if (g->f) status = gyroakf_filter_step(g->f, z, &x);
    else gyfstp_(g->work, &z, &x, &status);
    if (status != GYROAKF_OK) odd++;
  }
  return odd;
}

/* Waits for a child that may make no system call but exit, read and write. `ask`: it makes one. 0: it has made none. */
static int strict_child(filter *g, int ask) {
  int status;
  pid_t child = fork();
  if (child < 0) return -1;
  if (child == 0) {
    if (prctl(PR_SET_SECCOMP, SECCOMP_MODE_STRICT) != 0) syscall(SYS_exit, 99);
    if (ask) getppid();
    syscall(SYS_exit, run(g) == 0 ? 0 : 98);
  }
  if (waitpid(child, &status, 0) != child) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int main(void) {
  long allocated, locked;
  int i, code;
  make_filters();
  check(allocations > count, "allocations are counted");
  code = strict_child(&filters[0], 1);
  if (code == 99) printf("skipped: this kernel has no strict mode\n");
  else check(code != 0, "a system call is noticed");
  for (i = 0; i < count; i++) {
    if (code != 99) check(strict_child(&filters[i], 0) == 0, "steps without a system call");
    allocated = allocations;
    locked = locks;
    check(run(&filters[i]) == 0, "the status of a step");
    check(allocations == allocated && locks == locked, "steps without allocation and lock");
    gyroakf_filter_free(filters[i].f);
  }
  printf("%d filters, %d steps each\n%d passed, %d failed\n", count, steps, passed, failed);
  return failed > 0;
}
