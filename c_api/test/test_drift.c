/* SPDX-License-Identifier: MIT */
/* The drift: identified, filtered, smoothed; filters saved, restored, reset. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"

enum { N = 6000 };

/* A random walk of steps 0.05 in noise of standard deviation 1 (sums of twelve uniform values). */
static void make_series(double *z) {
  static double u[24 * N];
  double level = 0, w, v;
  int i, k;
  uniform(u, 24 * N, 271828);
  for (i = 0; i < N; i++) {
    w = v = -6;
    for (k = 0; k < 12; k++) {
      w += u[24 * i + k];
      v += u[24 * i + 12 + k];
    }
    level += 0.05 * w;
    z[i] = level + v;
  }
}

static void test_identify(const double *z, gyroakf_drift_model *model) {
  static double holes[N], drift[N], variance[N], adaptive[N], by_step[N];
  gyroakf_filter_options opt;
  gyroakf_filter *f;
  double rough = 0, smooth = 0, spread = 0;
  int i;
  memcpy(holes, z, sizeof holes);
  for (i = 100; i < 150; i++) holes[i] = NAN;
  gyroakf_drift_model_init(model);
  check(model->struct_size == sizeof *model && model->count == 0, "an empty model");
  check_success(gyroakf_drift_identify(holes, N, NULL, model, &err), "identify");
  for (i = 0; i < model->count && model->phi[i] < 1; i++) continue;
  check(i < model->count && model->slow[i] == 1, "the walk is the drift");
  check(fabs(model->q[i] - 0.0025) < 0.002 && fabs(model->r - 1) < 0.1, "its numbers");
  check_success(gyroakf_drift_filter_new(model, NULL, &f, &err), "drift filter");
  check_success(gyroakf_filter_run(f, holes, N, by_step, &err), "run it");
  gyroakf_filter_free(f);
  check_success(gyroakf_drift_smooth(model, holes, N, drift, variance, NULL, &err), "smooth");
  check_success(gyroakf_drift_smooth(model, holes, N, by_step, NULL, NULL, &err), "smooth without variance");
  check(memcmp(drift, by_step, sizeof drift) == 0, "the same");
  gyroakf_filter_options_init(&opt);
  opt.estimate_measurement_variance = 1;
  opt.forgetting = 0.995;
  opt.huber = 2.5;
  check_success(gyroakf_drift_smooth(model, holes, N, adaptive, NULL, &opt, &err), "smooth, R adapted");
  for (i = 1; i < N; i++) {
    rough += (z[i] - z[i - 1]) * (z[i] - z[i - 1]);
    smooth += (drift[i] - drift[i - 1]) * (drift[i] - drift[i - 1]);
    spread += (adaptive[i] - drift[i]) * (adaptive[i] - drift[i]);
  }
  check(smooth < 0.01 * rough && spread < 0.05 * N, "the drift is smooth");
  check(isfinite(drift[125]) && variance[125] > variance[1000] && variance[1000] > 0, "less is known in a gap");
}

static void test_failures(double *z, const gyroakf_drift_model *good) {
  static double drift[N];
  gyroakf_drift_model model;
  gyroakf_drift_options opt;
  gyroakf_filter_options filter;
  gyroakf_filter *f;
  memset(&model, 0, sizeof model);
  check_failure(gyroakf_drift_identify(z, N, NULL, &model, &err), GYROAKF_INVALID_ARGUMENT, "not initialized");
  check_failure(gyroakf_drift_identify(z, N, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "no model");
  gyroakf_drift_model_init(&model);
  check_failure(gyroakf_drift_identify(NULL, N, NULL, &model, &err), GYROAKF_INVALID_ARGUMENT, "no series");
  check_failure(gyroakf_drift_identify(z, 20, NULL, &model, &err), GYROAKF_TOO_FEW_SAMPLES, "20 samples");
  gyroakf_drift_options_init(&opt);
  opt.drift_samples = NAN;
  check_failure(gyroakf_drift_identify(z, N, &opt, &model, &err), GYROAKF_INVALID_ARGUMENT, "NaN for the limit");
  gyroakf_drift_options_init(&opt);
  opt.most_samples = 10;
  check_failure(gyroakf_drift_identify(z, N, &opt, &model, &err), GYROAKF_INVALID_ARGUMENT, "a part of 10");
  check(model.count == 0, "nothing was written");
  check_failure(gyroakf_drift_filter_new(&model, NULL, &f, &err), GYROAKF_INVALID_ARGUMENT, "no process");
  check(f == NULL, "no filter");
  model = *good;
  memset(model.slow, 0, sizeof model.slow);
  check_failure(gyroakf_drift_filter_new(&model, NULL, &f, &err), GYROAKF_INVALID_ARGUMENT, "nothing slow");
  model = *good;
  model.phi[0] = 1.5;
  check_any_failure(gyroakf_drift_filter_new(&model, NULL, &f, &err), "unstable");
  gyroakf_filter_options_init(&filter);
  filter.estimate_process_variance = 1;
  check_failure(gyroakf_drift_filter_new(good, &filter, &f, &err), GYROAKF_INVALID_ARGUMENT, "Q adapted");
  check_failure(gyroakf_drift_filter_new(good, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "no place");
  check_failure(gyroakf_drift_smooth(good, z, N, z, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "in place");
  check_failure(gyroakf_drift_smooth(good, z, N, drift, drift, NULL, &err), GYROAKF_INVALID_ARGUMENT, "one array twice");
  check_failure(gyroakf_drift_smooth(good, z, N, NULL, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "no drift");
  check_failure(gyroakf_drift_smooth(NULL, z, N, drift, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "no model");
  gyroakf_drift_model_init(NULL);
  gyroakf_drift_options_init(NULL);
}

static void test_saving(const double *z, const gyroakf_drift_model *model) {
  static double x[N], y[N];
  gyroakf_filter_options opt;
  gyroakf_filter *f, *g;
  unsigned char *bytes;
  int64_t size, again;
  gyroakf_filter_options_init(&opt);
  opt.estimate_measurement_variance = 1;
  opt.huber = 2.5;
  check_success(gyroakf_drift_filter_new(model, &opt, &f, &err), "adaptive drift filter");
  gyroakf_filter_run(f, z, 1000, x, NULL);
  check_success(gyroakf_filter_save(f, NULL, 0, &size, &err), "how many bytes");
  bytes = (unsigned char *)malloc((size_t)size + 1);
  if (!bytes) return;
  check_failure(gyroakf_filter_save(f, bytes, size - 1, &again, &err), GYROAKF_INVALID_ARGUMENT, "too few bytes");
  check(again == size, "it says how many");
  check_success(gyroakf_filter_save(f, bytes + 1, size, &again, &err), "save, at an odd address");
  gyroakf_filter_run(f, z + 1000, N - 1000, x + 1000, NULL);
  check_success(gyroakf_filter_restore(bytes + 1, size, &g, &err), "restore");
  gyroakf_filter_run(g, z + 1000, N - 1000, y + 1000, NULL);
  check(memcmp(x + 1000, y + 1000, (N - 1000) * sizeof *x) == 0, "to the last bit");
  check_success(gyroakf_filter_reset(g, &err), "reset");
  gyroakf_filter_run(g, z, N, y, NULL);
  check(memcmp(x, y, sizeof x) == 0, "from the beginning");
  gyroakf_filter_free(g);
  bytes[size / 2] ^= 16;
  check_failure(gyroakf_filter_restore(bytes + 1, size, &g, &err), GYROAKF_PARSE, "damaged");
  check(g == NULL, "no filter of it");
  check_failure(gyroakf_filter_restore(bytes + 1, size - 8, &g, &err), GYROAKF_PARSE, "cut short");
  check_failure(gyroakf_filter_restore(bytes + 1, 3, &g, &err), GYROAKF_PARSE, "three bytes");
  check_failure(gyroakf_filter_restore(NULL, size, &g, &err), GYROAKF_INVALID_ARGUMENT, "no bytes");
  check_failure(gyroakf_filter_restore(bytes, size, NULL, &err), GYROAKF_INVALID_ARGUMENT, "no place");
  check_failure(gyroakf_filter_save(NULL, bytes, size, &again, &err), GYROAKF_INVALID_ARGUMENT, "no filter");
  check_failure(gyroakf_filter_save(f, bytes, size, NULL, &err), GYROAKF_INVALID_ARGUMENT, "no size");
  check_failure(gyroakf_filter_reset(NULL, &err), GYROAKF_INVALID_ARGUMENT, "no filter to reset");
  gyroakf_filter_free(f);
  free(bytes);
}

void test_drift(void) {
  static double z[N];
  gyroakf_drift_model model;
  make_series(z);
  test_identify(z, &model);
  test_failures(z, &model);
  test_saving(z, &model);
}
