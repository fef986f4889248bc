/* SPDX-License-Identifier: MIT */
/* See work.h. Nothing is computed here, so that the floating-point environment matters in the library only. */
#include "work.h"

#include "check.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { text_size = 200000 };

static void add_text(results *r, const char *text) {
  size_t used = strlen(r->texts);
  if (text != NULL) snprintf(r->texts + used, work_texts - used, "%s|", text);
}

/* A recording with a head, stamps that jitter, a gap and lost values, different for each seed. */
char *make_recording(int32_t seed) {
  static const char *const unit[2] = {"deg/s", "millidegrees per second"};
  double *x = (double *)malloc(work_samples * sizeof *x);
  char *text = (char *)malloc(text_size);
  size_t used = 0;
  int i;
  if (x == NULL || text == NULL) abort();
  uniform(x, work_samples, 1234567 + seed);
  used += (size_t)snprintf(text, text_size, "time_%s,rate of sensor number %d [%s]\n", seed % 2 ? "s" : "ms", 10 * seed,
                           unit[seed % 2]);
  for (i = 0; i < work_samples; i++) {
    double time = (i + (i > 1000 + seed ? 7 : 0)) * (seed % 2 ? 0.01 : 10.0) * (1.0 + (i % 3) * 1e-6);
    if (i % 500 == 17 * seed) {
      used += (size_t)snprintf(text + used, text_size - used, "%.9g,nan\n", time);
    } else {
      used += (size_t)snprintf(text + used, text_size - used, "%.9g,%.17g\n", time, x[i] - 0.5);
    }
  }
  free(x);
  return text;
}

/* The texts of a recording, and of errors that name what is wrong. */
static void read_texts(results *r, const gyroakf_record *record) {
  static const char *const bad[3] = {"1 2\n3 x\n", "a b\n1 2\n3\n", "time,a,b\n0,1,2\n1,2,none of it\n"};
  gyroakf_reader_options opt;
  gyroakf_record *none = NULL;
  gyroakf_error error;
  char column[40];
  int i;
  add_text(r, gyroakf_record_name(record, 0));
  add_text(r, gyroakf_record_unit(record, 0));
  add_text(r, gyroakf_record_rate_source(record));
  add_text(r, gyroakf_record_format(record));
  for (i = 0; i < gyroakf_record_warnings(record); i++) add_text(r, gyroakf_record_warning(record, i));
  for (i = 0; i < 3; i++) {
    r->status += gyroakf_record_parse(bad[i], (int64_t)strlen(bad[i]), NULL, &none, &error) == GYROAKF_OK;
    add_text(r, error.message);
  }
  snprintf(column, sizeof column, "%.*s", 3 + 20 * (r->seed % 2), "a column that is not there");
  gyroakf_reader_options_init(&opt);
  opt.columns = column;
  r->status += gyroakf_record_parse(bad[2], 17, &opt, &none, &error) == GYROAKF_OK;
  add_text(r, error.message);
  gyroakf_reader_options_init(&opt);
  opt.unit = r->seed % 2 ? "furlong" : "fathoms per fortnight";
  r->status += gyroakf_record_parse("1\n2\n", 4, &opt, &none, &error) == GYROAKF_OK;
  add_text(r, error.message);
}

static void analyze(results *r, const double *x, int64_t n) {
  gyroakf_allan *curve = NULL;
  gyroakf_filter *filter = NULL;
  gyroakf_filter_options opt;
  gyroakf_simulate_options simulation;
  gyroakf_record *made = NULL;
  gyroakf_adf adf;
  gyroakf_kpss kpss;
  gyroakf_error error;
  int32_t order = 0;
  int64_t i, m = n;
  if (m > work_samples) m = work_samples;
  r->status += gyroakf_allan_new(x, n, 0.01, NULL, &curve, &error);
  if (gyroakf_allan_size(curve) > 0 && gyroakf_allan_size(curve) <= work_points) {
    memcpy(r->deviation, gyroakf_allan_deviation(curve), (size_t)gyroakf_allan_size(curve) * sizeof(double));
    memcpy(r->upper, gyroakf_allan_upper(curve), (size_t)gyroakf_allan_size(curve) * sizeof(double));
    r->status += gyroakf_noise_fit(curve, NULL, &r->noise, &error);
  }
  gyroakf_allan_free(curve);
  r->status += gyroakf_adf_test(x, n, NULL, &adf, &error);
  r->adf[0] = adf.statistic;
  r->adf[1] = adf.p_value;
  r->status += gyroakf_kpss_test(x, n, NULL, &kpss, &error);
  r->kpss[0] = kpss.statistic;
  r->kpss[1] = kpss.p_value;
  r->status += gyroakf_ar_fit(x, n, NULL, 5, &order, r->phi, &r->variance, &r->mean, &error);
  gyroakf_simulate_options_init(&simulation);
  simulation.samples = 500;
  simulation.seed = r->seed;
  simulation.n = simulation.b = simulation.k = 0.1;
  simulation.unit = r->seed % 2 ? "degrees per second" : "rad/s";
  r->status += gyroakf_simulate(&simulation, &made, &error);
  if (made != NULL) memcpy(r->simulated, gyroakf_record_values(made, 0), sizeof r->simulated);
  gyroakf_record_free(made);
  gyroakf_filter_options_init(&opt);
  opt.estimate_measurement_variance = 1;
  r->status += gyroakf_filter_new(order, r->phi, r->variance, 0.01, &opt, &filter, &error);
  memcpy(r->read, x, (size_t)m * sizeof(double));
  r->status += gyroakf_filter_run(filter, x, m, r->filtered, &error);
  r->status += gyroakf_filter_get(filter, &r->state);
  for (i = 0; i < m; i++) r->status += gyroakf_filter_step(filter, x[i], &r->stepped[i]);
  gyroakf_filter_free(filter);
}

void work(results *r, const char *text) {
  gyroakf_record *record = NULL;
  gyroakf_error error;
  r->status += gyroakf_record_parse(text, (int64_t)strlen(text), NULL, &record, &error);
  add_text(r, error.message);
  if (record == NULL) return;
  read_texts(r, record);
  analyze(r, gyroakf_record_values(record, 0), gyroakf_record_samples(record));
  gyroakf_record_free(record);
}
