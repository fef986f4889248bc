/* SPDX-License-Identifier: MIT */
/*
 * Two threads on two handles each: reader, messages, Allan deviation, fit, tests, models and filter give the numbers and the
 * texts that they give one after the other.
 */
#include "check.h"

#include <omp.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { samples = 3000, points = 64, rounds = 5, text_rounds = 40000, text_size = 200000, texts_size = 4096 };

/* All that one thread gets. Numbers are compared as bytes. */
typedef struct results {
  int32_t seed; /* of its recording */
  int status;   /* the sum of all statuses that should be 0 */
  double deviation[points], upper[points], read[samples], filtered[samples], phi[5], variance, mean;
  gyroakf_noise noise;
  double adf[2], kpss[2];
  gyroakf_arma arma;
  gyroakf_filter_state state;
  char texts[texts_size]; /* names, units, warnings and messages, one after the other */
} results;

static void add_text(results *r, const char *text) {
  size_t used = strlen(r->texts);
  if (text != NULL) snprintf(r->texts + used, texts_size - used, "%s|", text);
}

/* A recording with a head, stamps that jitter, a gap and lost values, different for each seed. */
static char *make_recording(int32_t seed) {
  static const char *const unit[2] = {"deg/s", "millidegrees per second"};
  double *x = (double *)malloc(samples * sizeof *x);
  char *text = (char *)malloc(text_size);
  size_t used = 0;
  int i;
  if (x == NULL || text == NULL) abort();
  uniform(x, samples, 1234567 + seed);
  used += (size_t)snprintf(text, text_size, "time_%s,rate of sensor number %d [%s]\n", seed % 2 ? "s" : "ms", 10 * seed,
                           unit[seed % 2]);
  for (i = 0; i < samples; i++) {
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

static void analyse(results *r, const double *x, int64_t n) {
  gyroakf_allan *curve = NULL;
  gyroakf_filter *filter = NULL;
  gyroakf_filter_options opt;
  gyroakf_adf adf;
  gyroakf_kpss kpss;
  gyroakf_error error;
  int32_t order = 0;
  int64_t m = n < samples ? n : samples;
  r->status += gyroakf_allan_new(x, n, 0.01, NULL, &curve, &error);
  if (gyroakf_allan_size(curve) > 0 && gyroakf_allan_size(curve) <= points) {
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
  r->status += gyroakf_arma_fit(x, n, NULL, &r->arma, &error);
  gyroakf_filter_options_init(&opt);
  opt.estimate_measurement_variance = 1;
  r->status += gyroakf_filter_new(order, r->phi, r->variance, 0.01, &opt, &filter, &error);
  memcpy(r->read, x, (size_t)m * sizeof(double));
  r->status += gyroakf_filter_run(filter, x, m, r->filtered, &error);
  r->status += gyroakf_filter_get(filter, &r->state);
  gyroakf_filter_free(filter);
}

static void work(results *r) {
  char *text = make_recording(r->seed);
  gyroakf_record *record = NULL;
  gyroakf_error error;
  r->status += gyroakf_record_parse(text, (int64_t)strlen(text), NULL, &record, &error);
  add_text(r, error.message);
  free(text);
  if (record == NULL) return;
  read_texts(r, record);
  analyse(r, gyroakf_record_values(record, 0), gyroakf_record_samples(record));
  gyroakf_record_free(record);
}

/* Short texts of other lengths than those of the other thread, very often: a length kept in static memory is found out. */
static void read_often(results *r) {
  const char *const text = r->seed % 2 ? "1 2\n3 x\n" : "1 2 3 4\n2 3 4 a-word-that-is-not-a-number-and-rather-long\n";
  char expected[256] = "";
  gyroakf_record *none = NULL;
  gyroakf_error error;
  int i;
  for (i = 0; i < text_rounds; i++) {
    r->status += gyroakf_record_parse(text, (int64_t)strlen(text), NULL, &none, &error) != GYROAKF_PARSE;
    if (i == 0) memcpy(expected, error.message, sizeof expected);
    r->status += strcmp(error.message, expected) != 0 || strstr(expected, "is not a number") == NULL;
  }
}

/* One thread: the same work again and again; inside the library one thread each, so that sums are the same to the last bit. */
static void *work_often(void *argument) {
  results *first = (results *)argument, *again = (results *)calloc(1, sizeof *again);
  int i;
  omp_set_num_threads(1);
  if (again == NULL) abort();
  for (i = 0; i < rounds; i++) {
    memset(again, 0, sizeof *again);
    again->seed = first->seed;
    work(again);
    if (i == 0) memcpy(first, again, sizeof *first);
    if (memcmp(first, again, sizeof *first) != 0) first->status = 1000 + i;
  }
  read_often(first);
  free(again);
  return NULL;
}

void test_threads(void) {
  results *alone = (results *)calloc(2, sizeof *alone), *together = (results *)calloc(2, sizeof *together);
  int usual = omp_get_max_threads(), i;
  pthread_t thread[2];
  if (alone == NULL || together == NULL) abort();
  omp_set_num_threads(1);
  for (i = 0; i < 2; i++) {
    alone[i].seed = together[i].seed = i + 1;
    work(&alone[i]);
    check(alone[i].status == 0, "all calls of one thread alone");
    check(strstr(alone[i].texts, "rate of sensor number") != NULL && strlen(alone[i].texts) > 500, "its texts are there");
  }
  check(memcmp(&alone[0].noise, &alone[1].noise, sizeof alone[0].noise) != 0, "the two threads have different data");
  omp_set_num_threads(usual);
  for (i = 0; i < 2; i++) check(pthread_create(&thread[i], NULL, work_often, &together[i]) == 0, "a thread begins");
  for (i = 0; i < 2; i++) check(pthread_join(thread[i], NULL) == 0, "a thread ends");
  for (i = 0; i < 2; i++) {
    check(together[i].status == 0, "both threads get the same in every round");
    check(memcmp(&alone[i], &together[i], sizeof alone[i]) == 0, "and the same as alone, to the last bit");
    check(strcmp(alone[i].texts, together[i].texts) == 0, "and the same texts");
    if (strcmp(alone[i].texts, together[i].texts) != 0) printf("  %s\n  %s\n", alone[i].texts, together[i].texts);
  }
  free(alone);
  free(together);
}
