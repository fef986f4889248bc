/* SPDX-License-Identifier: MIT */
/* The whole job with its document, and simulated recordings. */
#include "check.h"

#include <math.h>
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

void test_run(void) {
  gyroakf_run_options opt;
  gyroakf_result *result = (gyroakf_result *)&opt;
  gyroakf_record *r = NULL;
  test_simulation();
  test_simulation_failures();
  test_job(0.0);
  test_job(0.05);
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
