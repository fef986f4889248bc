/* SPDX-License-Identifier: MIT */
/*
 * libFuzzer harness of the readers: four bytes choose the options, the rest is the content of a file.
 * What comes back has to keep the promises of gyroakf.h, whatever the bytes are. Built and run by run.sh.
 */
#include "gyroakf.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --- coverage: GCC calls this for every branch; libFuzzer looks at the counters after every run */
#define COUNTERS 65536
__attribute__((section("__libfuzzer_extra_counters"))) static uint8_t counters[COUNTERS];

void gyroakf_trace_pc(void);
__attribute__((no_sanitize("all"))) void gyroakf_trace_pc(void) {
  uint64_t pc = (uint64_t)__builtin_return_address(0);
  counters[(pc * UINT64_C(0x9e3779b97f4a7c15)) >> 48]++;
}

void omp_set_num_threads(int n);

/* A promise is broken: libFuzzer keeps the input. */
static void promise(int kept, const char *what) {
  if (kept) return;
  fprintf(stderr, "broken promise: %s\n", what);
  abort();
}

/* True for a text of UTF-8 without control characters other than line feeds. */
static int is_clean(const char *text) {
  const unsigned char *p = (const unsigned char *)text;
  while (*p) {
    int more = *p < 0x80 ? 0 : *p >= 0xf0 ? 3 : *p >= 0xe0 ? 2 : *p >= 0xc0 ? 1 : -1;
    if (more < 0 || (*p < 0x20 && *p != '\n') || *p == 0x7f) return 0;
    for (p++; more > 0; more--, p++) {
      if ((*p & 0xc0) != 0x80) return 0;
    }
  }
  return 1;
}

static void promise_clean(const char *text) {
  if (!is_clean(text)) fprintf(stderr, "text: %s\n", text);
  promise(is_clean(text), "a text can be shown");
}

static void check_error(int status, const gyroakf_error *err) {
  promise(err->code == status, "err has the status");
  promise(status != GYROAKF_INTERNAL && strcmp(gyroakf_status_string(status), "unknown status") != 0, "a sensible status");
  promise(memchr(err->message, 0, sizeof err->message) != NULL, "the message is terminated");
  promise(strlen(err->message) > 5, "the message says something");
  promise_clean(err->message);
}

static void check_channel(const gyroakf_record *r, int32_t channel) {
  const double *x = gyroakf_record_values(r, channel);
  const int8_t *mark = gyroakf_record_present(r, channel);
  int64_t i, n = gyroakf_record_samples(r);
  promise(x && gyroakf_record_name(r, channel) && gyroakf_record_unit(r, channel), "a channel is whole");
  promise(isfinite(gyroakf_record_to_si(r, channel)), "the factor of the unit is finite");
  for (i = 0; i < n; i++) {
    promise(mark ? mark[i] == 0 || mark[i] == 1 : 1, "a mark is 0 or 1");
    promise(mark && !mark[i] ? isnan(x[i]) : isfinite(x[i]), "values are finite, or missing and marked");
  }
}

static void check_record(const gyroakf_record *r) {
  gyroakf_audit audit;
  int64_t n = gyroakf_record_samples(r);
  int32_t i, channels = gyroakf_record_channels(r);
  double dt = gyroakf_record_sample_interval(r);
  promise(n > 0 && channels > 0, "a recording holds samples");
  promise(isfinite(dt) && dt > 0, "the interval is positive");
  promise(gyroakf_record_rate_source(r) && gyroakf_record_format(r), "source and format are known");
  for (i = 0; i < channels; i++) check_channel(r, i);
  for (i = 0; i < gyroakf_record_warnings(r); i++) promise_clean(gyroakf_record_warning(r, i));
  audit.struct_size = sizeof audit;
  promise(gyroakf_record_audit(r, &audit) == GYROAKF_OK && audit.samples == n, "the audit counts the samples");
  promise(audit.missing >= 0 && audit.missing <= n * channels, "the audit counts what is missing");
  promise(isfinite(audit.stamp_rate) && isfinite(audit.jitter_max), "the audit is finite");
}

static void choose(const uint8_t *choice, gyroakf_reader_options *opt) {
  static const char *const columns[8] = {NULL, NULL, NULL, NULL, "1", "2", "2,1", "gx"};
  static const char *const times[8] = {NULL, NULL, NULL, NULL, "none", "1", "2", "time"};
  static const char *const inputs[4] = {NULL, NULL, "increment", "angle"};
  static const char *const units[4] = {NULL, NULL, "deg/s", "rad/s,deg/h"};
  static const char *const formats[16] = {NULL, "f64", "f32be", "i16", "i64be", "u8", "text", "npy", "f32", "i32be", "u64", "csv"};
  static const char *const resamples[4] = {NULL, NULL, "nearest", "linear"};
  static const char *const wraps[4] = {NULL, "none", "65536", "360"};
  static const int64_t channels[4] = {0, 0, 2, 5};
  static const double rates[4] = {0, 0, 100, 1e-3};
  static const int64_t skips[4] = {0, 0, 1, 7};
  gyroakf_reader_options_init(opt);
  opt->columns = columns[choice[0] & 7];
  opt->time_column = times[choice[0] >> 3 & 7];
  opt->input = inputs[choice[0] >> 6];
  opt->skip = skips[choice[1] & 3];
  opt->bad_lines_missing = choice[1] >> 2 & 1;
  opt->rate_hz = rates[choice[1] >> 3 & 3];
  opt->unit = units[choice[1] >> 5 & 3];
  opt->scale = choice[1] >> 7 ? -1e-9 : 1.0;
  opt->from = choice[2] >> 2 & 1 ? 0.05 : 0.0;
  if (choice[2] >> 3 & 1) opt->to = 0.25;
  opt->format = formats[choice[2] >> 4];
  opt->resample = resamples[choice[3] & 3];
  opt->wrap = wraps[choice[3] >> 2 & 3];
  opt->decimal_comma = choice[3] >> 4 & 1;
  opt->channels = channels[choice[3] >> 5 & 3];
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  gyroakf_reader_options opt;
  gyroakf_record *r;
  gyroakf_error err;
  int status;
  if (size < 5) return 0;
  choose(data, &opt);
  omp_set_num_threads(data[3] >> 7 && (data[2] & 3) == 3 ? 2 : 1);
  status = gyroakf_record_parse(data + 4, (int64_t)size - 4, &opt, &r, &err);
  if (status) {
    promise(r == NULL, "no recording after a failure");
    check_error(status, &err);
  } else {
    promise(r && err.code == GYROAKF_OK && err.message[0] == 0, "no error after a success");
    check_record(r);
  }
  gyroakf_record_free(r);
  return 0;
}
