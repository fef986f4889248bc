/* SPDX-License-Identifier: MIT */
/* The whole job with its document, and simulated recordings. */
#include "check.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void test_simulation(void) {
  gyroakf_simulate_options opt;
  gyroakf_record *r = NULL, *again = NULL;
  gyroakf_audit audit;
  double sum = 0;
  int i;
  gyroakf_simulate_options_init(&opt);
  opt.samples = 5000;
  opt.rate_hz = 100;
  opt.n = 0.1;
  opt.seed = 7;
  opt.unit = "rad/s";
  check_success(gyroakf_simulate(&opt, &r, &err), "a simulated recording");
  check_success(gyroakf_simulate(&opt, &again, &err), "the same again");
  check(gyroakf_record_samples(r) == 5000 && gyroakf_record_channels(r) == 1, "its size");
  if (gyroakf_record_samples(r) == 5000) {
    check(memcmp(gyroakf_record_values(r, 0), gyroakf_record_values(again, 0), 5000 * sizeof(double)) == 0, "one seed, one recording");
    for (i = 0; i < 5000; i++) sum += gyroakf_record_values(r, 0)[i] * gyroakf_record_values(r, 0)[i] / 5000;
    check(fabs(sqrt(sum) - 1.0) < 0.05, "N = 0.1 at 100 Hz has the standard deviation 1"); /* 5 standard errors */
  }
  check(strcmp(gyroakf_record_unit(r, 0), "rad/s") == 0 && strcmp(gyroakf_record_name(r, 0), "gx") == 0, "unit and name");
  check(gyroakf_record_sample_interval(r) == 0.01, "its interval");
  gyroakf_record_free(r);
  gyroakf_record_free(again);
  opt.missing = 0.1;
  check_success(gyroakf_simulate(&opt, &r, &err), "with losses");
  audit.struct_size = sizeof audit;
  check(gyroakf_record_audit(r, &audit) == GYROAKF_OK && audit.missing > 300 && audit.missing < 700, "missing samples");
  gyroakf_record_free(r);
  gyroakf_simulate_options_init(&opt);
  opt.preset = "paper";
  check_success(gyroakf_simulate(&opt, &r, &err), "the paper's recording");
  check(gyroakf_record_samples(r) == 12000, "the paper's recording");
  gyroakf_record_free(r);
}

static void test_simulation_failures(void) {
  gyroakf_simulate_options good, opt;
  gyroakf_record *r = (gyroakf_record *)&good;
  check_failure(gyroakf_simulate(NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "options NULL");
  check(r == NULL, "*out is NULL after a failure");
  gyroakf_simulate_options_init(&good);
  check_failure(gyroakf_simulate(&good, NULL, &err), GYROAKF_INVALID_ARGUMENT, "out NULL");
#define REFUSED(member, value) \
  opt = good; \
  opt.member = value; \
  check_any_failure(gyroakf_simulate(&opt, &r, &err), #member " " #value); \
  check(r == NULL, #member " " #value)
  REFUSED(samples, 0);
  REFUSED(samples, INT64_MAX);
  REFUSED(rate_hz, 0.0);
  REFUSED(rate_hz, NAN);
  REFUSED(unit, "furlong");
  REFUSED(n, -1.0);
  REFUSED(b, NAN);
  REFUSED(ar_variance, -1.0);
  REFUSED(outliers, -1);
  REFUSED(missing, 1.0);
  REFUSED(preset, "pepper");
  REFUSED(struct_size, 8);
#undef REFUSED
  gyroakf_simulate_options_init(NULL);
}

static int32_t stop_now(void *user, const char *stage, int64_t done, int64_t total) {
  (void)stage;
  (void)done;
  (void)total;
  *(int *)user += 1;
  return 1;
}

static void test_job(double missing) {
  gyroakf_simulate_options sim;
  gyroakf_run_options opt;
  gyroakf_record *r = NULL;
  gyroakf_result *result = NULL;
  const char *json;
  int calls = 0;
  gyroakf_simulate_options_init(&sim);
  sim.samples = 3000;
  sim.n = 0.01;
  sim.missing = missing;
  check_success(gyroakf_simulate(&sim, &r, &err), "a recording");
  check_success(gyroakf_run(r, NULL, &result, &err), "the whole job");
  json = gyroakf_result_json(result);
  check(json != NULL && json[0] == '{' && strstr(json, "\"schema\": 1") != NULL, "a document");
  if (json != NULL) {
    check(strstr(json, "\"gx\"") != NULL && strstr(json, "\"coefficients\"") != NULL, "with a channel and coefficients");
    check(strcmp(json + strlen(json) - 2, "}\n") == 0 && strstr(json, "NaN") == NULL, "it is whole");
  }
  gyroakf_result_free(result);
  gyroakf_run_options_init(&opt);
  opt.allan = opt.filters = 0;
  check_success(gyroakf_run(r, &opt, &result, &err), "parts of the job");
  check(gyroakf_result_json(result) != NULL && strstr(gyroakf_result_json(result), "\"adf\": {") != NULL, "the tests are there");
  gyroakf_result_free(result);
  gyroakf_run_options_init(&opt);
  opt.progress = stop_now;
  opt.progress_user = &calls;
  check_failure(gyroakf_run(r, &opt, &result, &err), GYROAKF_CANCELLED, "cancelled");
  check(result == NULL && calls == 1, "cancelled at once");
  gyroakf_record_free(r);
}

/* A recording of the program's arrays: the same samples, and the same findings, as of the recording that they come from. */
static void test_arrays(void) {
  gyroakf_simulate_options sim;
  gyroakf_run_options opt;
  gyroakf_record *made = NULL, *r = NULL;
  gyroakf_result *expected = NULL, *found = NULL;
  gyroakf_audit audit;
  const double *values[2];
  const char *names[2] = {"first", NULL}, *from, *as;
  double odd[3] = {1.0, 1e61, 2.0};
  gyroakf_simulate_options_init(&sim);
  sim.samples = 3000;
  sim.n = 0.01;
  sim.missing = 0.02;
  check_success(gyroakf_simulate(&sim, &made, &err), "a recording");
  values[0] = values[1] = gyroakf_record_values(made, 0);
  check_success(gyroakf_record_new(values, 2, 3000, 0.2, names, "deg/s", &r, &err), "a recording of arrays");
  check(gyroakf_record_samples(r) == 3000 && gyroakf_record_channels(r) == 2, "its size");
  check(strcmp(gyroakf_record_name(r, 0), "first") == 0 && strcmp(gyroakf_record_name(r, 1), "column2") == 0, "its names");
  check(strcmp(gyroakf_record_unit(r, 1), "deg/s") == 0 && strcmp(gyroakf_record_format(r), "array") == 0, "its unit and format");
  check(gyroakf_record_sample_interval(r) == 0.2 && strcmp(gyroakf_record_rate_source(r), "option") == 0, "its rate");
  check(gyroakf_record_values(r, 0) != values[0], "it is a copy");
  check(memcmp(gyroakf_record_values(r, 1), values[1], 3000 * sizeof(double)) == 0, "of the same samples");
  check(memcmp(gyroakf_record_present(r, 0), gyroakf_record_present(made, 0), 3000) == 0, "and the same are missing");
  audit.struct_size = sizeof audit;
  check(gyroakf_record_audit(r, &audit) == GYROAKF_OK && audit.samples == 3000 && audit.missing > 60, "missing samples are counted");
  gyroakf_record_free(r);
  names[0] = "gx";
  check_success(gyroakf_record_new(values, 1, 3000, 0.2, names, "deg/s", &r, &err), "one channel");
  gyroakf_run_options_init(&opt);
  opt.filters = 0;
  check_success(gyroakf_run(made, &opt, &expected, &err), "the job on the simulated one");
  check_success(gyroakf_run(r, &opt, &found, &err), "and on its copy");
  from = strstr(gyroakf_result_json(expected), "\"preprocess\"");
  as = strstr(gyroakf_result_json(found), "\"preprocess\"");
  check(from != NULL && as != NULL && strcmp(from, as) == 0, "the findings are the same");
  gyroakf_result_free(expected);
  gyroakf_result_free(found);
  gyroakf_record_free(made);
  gyroakf_record_free(r);

  values[0] = odd;
  check_success(gyroakf_record_new(values, 1, 1, 1.0, NULL, NULL, &r, &err), "one sample, no names, no unit");
  check(strcmp(gyroakf_record_name(r, 0), "column1") == 0 && gyroakf_record_unit(r, 0)[0] == 0, "the usual name, no unit");
  gyroakf_record_free(r);
  check_failure(gyroakf_record_new(values, 1, 3, 1.0, NULL, NULL, &r, &err), GYROAKF_NON_FINITE, "a value too large");
  check(r == NULL, "*out is NULL after a failure");
  values[1] = NULL;
  check_failure(gyroakf_record_new(values, 2, 1, 1.0, NULL, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "an array NULL");
  check_failure(gyroakf_record_new(NULL, 2, 1, 1.0, NULL, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "arrays NULL");
  check(gyroakf_record_new(NULL, 2, 1, 1.0, NULL, NULL, &r, &err) && strstr(err.message, "channels"), "its message");
  check_failure(gyroakf_record_new(values, 1, 1, 1.0, NULL, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "out NULL");
  check_failure(gyroakf_record_new(values, 0, 1, 1.0, NULL, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "no channel");
  check_failure(gyroakf_record_new(values, 1, 0, 1.0, NULL, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "no sample");
  check_failure(gyroakf_record_new(values, 1, 1, 0.0, NULL, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "no interval");
  check_failure(gyroakf_record_new(values, 1, 1, 1e-320, NULL, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "hardly an interval");
  check(gyroakf_record_new(values, 1, 1, 1e-320, NULL, NULL, &r, &err) && strstr(err.message, "(dt)"), "its message");
  check_failure(gyroakf_record_new(values, 1, 1, NAN, NULL, NULL, &r, &err), GYROAKF_INVALID_ARGUMENT, "interval NaN");
  check_failure(gyroakf_record_new(values, 1, 1, 1.0, NULL, "furlong", &r, &err), GYROAKF_INVALID_ARGUMENT, "unit of nothing");
  check_failure(gyroakf_record_new(values, 1, 1, 1.0, NULL, "deg/s,rad/s", &r, &err), GYROAKF_INVALID_ARGUMENT, "too many units");
  check_failure(gyroakf_record_new(values, 1, 1, 1.0, NULL, "deg", &r, &err), GYROAKF_INVALID_ARGUMENT, "unit of an angle");
}

/* The number behind the names, one after the other, in a document. */
static double number_of(const char *json, const char *const *names) {
  for (; *names != NULL && json != NULL; names++) {
    json = strstr(json, *names);
    if (json != NULL) json += strlen(*names);
  }
  return json != NULL ? strtod(json, NULL) : NAN;
}

/* A filter that is made for the series does what that of the document did. */
static void test_designed(const char *json, const double *x, int64_t n, double dt, const char *kind) {
  static const char *const members[] = {"\"variance\": ", "\"q\": ", "\"r\": "};
  char group[20];
  const char *names[4] = {"\"filters\": {", NULL, NULL, NULL};
  const int drift = strncmp(kind, "drift", 5) == 0;
  double *z = (double *)malloc((size_t)n * sizeof *z), mean = 0, sum = 0, squares = 0, found[3], known;
  gyroakf_outlier_options opt;
  gyroakf_filter *f = NULL;
  gyroakf_filter_state state;
  int64_t i, count = 0;
  if (z == NULL) abort();
  gyroakf_outlier_options_init(&opt);
  if (drift) opt.degree = -1;
  check_success(gyroakf_clean(x, n, &opt, z, NULL, &err), "the series that is filtered");
  check_success(gyroakf_filter_identify(kind, x, n, dt, NULL, &f, &mean, &err), kind);
  for (i = 0; i < n; i++) z[i] -= mean;
  check(gyroakf_filter_get(f, &state) == GYROAKF_OK && state.steps == 0, "it has made no step");
  for (i = 0; i < n; i++) {
    const int missing = isnan(z[i]);
    double estimate = 0;
    if (gyroakf_filter_step(f, z[i], &estimate) != GYROAKF_OK) break;
    if (missing) continue;
    count++;
    sum += estimate;
    squares += estimate * estimate;
  }
  check(gyroakf_filter_get(f, &state) == GYROAKF_OK && state.steps == n, kind);
  found[0] = squares / (double)count - sum / (double)count * (sum / (double)count);
  found[1] = state.q;
  found[2] = state.r;
  sprintf(group, "\"%s\": {", kind);
  names[1] = group;
  for (i = 0; i < 3; i++) {
    names[2] = members[i];
    known = number_of(json, names);
    check(fabs(found[i] - known) <= (i == 0 ? 2.0 / (double)count : 1e-13) * known, members[i]);
  }
  gyroakf_filter_free(f);
  free(z);
}

/* Limits of a curve, cleaning and filters of C are those of the whole job. */
static void test_one_truth(double missing) {
  static const char *const kinds[] = {"kf", "akf", "drift_kf", "drift_akf"};
  static const char *const curve[] = {"\"allan\": {", "\"input\": {", "\"edf\": [", NULL},
                    *const limit[] = {"\"allan\": {", "\"input\": {", "\"upper\": [", NULL},
                    *const variance[] = {"\"preprocess\": {", "\"trend\": {", "\"variance\": ", NULL};
  gyroakf_simulate_options sim;
  gyroakf_record *r = NULL;
  gyroakf_result *result = NULL;
  gyroakf_allan *a = NULL;
  gyroakf_noise noise;
  gyroakf_outliers figures;
  gyroakf_filter *f = (gyroakf_filter *)&sim;
  const char *json;
  const double *x;
  double cleaned[100], whole[6000], mean, before;
  int k;
  gyroakf_simulate_options_init(&sim);
  sim.samples = 6000;
  sim.rate_hz = 50;
  sim.n = 0.01;
  sim.k = 0.004;
  sim.outliers = 10;
  sim.outlier_size = 20;
  sim.offset = 3;
  sim.missing = missing;
  check_success(gyroakf_simulate(&sim, &r, &err), "a recording with a drift");
  check_success(gyroakf_run(r, NULL, &result, &err), "the whole job");
  json = gyroakf_result_json(result);
  x = gyroakf_record_values(r, 0);
  if (json == NULL || x == NULL) abort();
  check_success(gyroakf_allan_new(x, 6000, 0.02, NULL, &a, &err), "its curve");
  before = gyroakf_allan_edf(a)[0];
  check(fabs(gyroakf_allan_edf(a)[0] / number_of(json, curve) - 1) > 1e-6, "limits of the noise type");
  check_success(gyroakf_allan_fit(a, NULL, &noise, &err), "its coefficients");
  check(gyroakf_allan_edf(a)[0] == number_of(json, curve), "degrees of freedom of the noise");
  check(gyroakf_allan_upper(a)[0] == number_of(json, limit) && gyroakf_allan_edf(a)[0] != before, "limits of the noise");
  gyroakf_allan_free(a);
  for (k = 0; k < 4; k++) test_designed(json, x, 6000, 0.02, kinds[k]);
  check_success(gyroakf_mark_outliers(x, 100, NULL, (int8_t *)cleaned, &figures, &err), "marks");
  before = figures.variance;
  check_success(gyroakf_clean(x, 100, NULL, cleaned, &figures, &err), "a part of the series");
  check(figures.variance == before, "the same figures");
  check_success(gyroakf_clean(x, 6000, NULL, whole, &figures, &err), "the series");
  check(fabs(figures.variance / number_of(json, variance) - 1) < 1e-12, "the variance of the whole job");
  check_failure(gyroakf_filter_identify("kalman", x, 6000, 0.02, NULL, &f, &mean, &err), GYROAKF_INVALID_ARGUMENT, "no such kind");
  check(f == NULL, "*out is NULL after a failure");
  check_failure(gyroakf_filter_identify(NULL, x, 6000, 0.02, NULL, &f, &mean, &err), GYROAKF_INVALID_ARGUMENT, "kind NULL");
  check_failure(gyroakf_filter_identify("kf", x, 6000, 0.0, NULL, &f, &mean, &err), GYROAKF_INVALID_ARGUMENT, "no interval");
  check_failure(gyroakf_filter_identify("kf", x, 6000, 0.02, NULL, &f, NULL, &err), GYROAKF_INVALID_ARGUMENT, "mean NULL");
  check_failure(gyroakf_filter_identify("kf", x, 6000, 0.02, NULL, NULL, &mean, &err), GYROAKF_INVALID_ARGUMENT, "out NULL");
  check_failure(gyroakf_filter_identify("kf", x, 5, 0.02, NULL, &f, &mean, &err), GYROAKF_TOO_FEW_SAMPLES, "five samples");
  for (k = 0; k < 100; k++) cleaned[k] = 1;
  check_failure(gyroakf_filter_identify("kf", cleaned, 100, 0.02, NULL, &f, &mean, &err), GYROAKF_CONSTANT_INPUT, "a constant");
  check_any_failure(gyroakf_filter_identify("drift_kf", cleaned, 100, 0.02, NULL, &f, &mean, &err), "no drift");
  gyroakf_result_free(result);
  gyroakf_record_free(r);
}

void test_run(void) {
  gyroakf_run_options opt;
  gyroakf_result *result = (gyroakf_result *)&opt;
  gyroakf_record *r = NULL;
  test_simulation();
  test_simulation_failures();
  test_job(0.0);
  test_job(0.05);
  test_arrays();
  test_one_truth(0.0);
  test_one_truth(0.03);
  check_failure(gyroakf_run(NULL, NULL, &result, &err), GYROAKF_INVALID_ARGUMENT, "recording NULL");
  check(result == NULL, "*out is NULL after a failure");
  check_success(gyroakf_record_parse("1\n2\n3\n", 6, NULL, &r, &err), "three samples");
  check_failure(gyroakf_run(r, NULL, NULL, &err), GYROAKF_INVALID_ARGUMENT, "out NULL");
  check_failure(gyroakf_run(r, NULL, &result, &err), GYROAKF_TOO_FEW_SAMPLES, "too few samples");
  gyroakf_run_options_init(&opt);
  opt.preset = "pepper";
  check_failure(gyroakf_run(r, &opt, &result, &err), GYROAKF_INVALID_ARGUMENT, "unknown preset");
  opt.struct_size = 8;
  check_failure(gyroakf_run(r, &opt, &result, &err), GYROAKF_INVALID_ARGUMENT, "struct_size");
  gyroakf_record_free(r);
  gyroakf_result_free(NULL);
  check(gyroakf_result_json(NULL) == NULL, "document of NULL");
  gyroakf_run_options_init(NULL);
}
