/* SPDX-License-Identifier: MIT
 * Many recordings one after another in one process, through the C interface: does the memory grow?
 *
 *   soak FILES FOLDER      FILES recordings (1000) in a file each, made in FOLDER, read, worked on, removed
 *
 * Every recording has other noise; the lengths take turns. Every tenth file is broken, every tenth has too few samples: what fails
 * must leave nothing behind either. A table of what the kernel says, and exit code 1 where the process is larger in the end than it
 * was after the first tenth of the files. */
#include <gyroakf.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { lengths = 5 };
static const int64_t length_of[lengths] = {500, 1000, 1500, 2000, 3000};

/* kB of a line of /proc/self/status */
static long status_of(const char *name) {
  char line[256];
  long value = -1;
  FILE *f = fopen("/proc/self/status", "r");
  if (!f) return -1;
  while (fgets(line, sizeof line, f))
    if (strncmp(line, name, strlen(name)) == 0) value = strtol(line + strlen(name) + 1, NULL, 10);
  fclose(f);
  return value;
}

/* the recording number i as a file: "ok", "broken" or "short" */
static const char *make_file(const char *path, int64_t i) {
  const char *kind = i % 10 == 3 ? "broken" : i % 10 == 7 ? "short" : "ok";
  gyroakf_simulate_options opt;
  gyroakf_record *r = NULL;
  gyroakf_error err;
  FILE *f;
  const double *x;
  int64_t k, n;

  gyroakf_simulate_options_init(&opt);
  opt.samples = strcmp(kind, "short") == 0 ? 5 : length_of[i % lengths];
  opt.seed = i;
  opt.rate_hz = 100;
  opt.n = 0.01;
  opt.k = 0.002;
  opt.outliers = opt.samples / 200;
  opt.outlier_size = 10;
  if (gyroakf_simulate(&opt, &r, &err) != GYROAKF_OK) {
    fprintf(stderr, "simulation %" PRId64 ": %s\n", i, err.message);
    exit(2);
  }
  x = gyroakf_record_values(r, 0);
  n = gyroakf_record_samples(r);
  f = fopen(path, "w");
  if (!f) { perror(path); exit(2); }
  fprintf(f, "# rate_hz: 100\n# unit: deg/s\n");
  for (k = 0; k < n; k++) {
    if (strcmp(kind, "broken") == 0 && k == n / 2) fprintf(f, "0.0x1\n");
    else if (k % 97 == 13) fprintf(f, "nan\n");
    else fprintf(f, "%.9g\n", x[k]);
  }
  fclose(f);
  gyroakf_record_free(r);
  return kind;
}

/* reads it, does everything with it */
static int work_on(const char *path) {
  gyroakf_reader_options opt;
  gyroakf_record *r = NULL;
  gyroakf_result *result = NULL;
  gyroakf_allan *curve = NULL;
  gyroakf_noise noise;
  gyroakf_filter *filter = NULL;
  gyroakf_error err;
  const double phi = 0.5;
  double *x;
  int status;

  gyroakf_reader_options_init(&opt);
  status = gyroakf_record_read(path, &opt, &r, &err);
  if (status != GYROAKF_OK) return status;
  status = gyroakf_run(r, NULL, &result, &err);
  if (status == GYROAKF_OK && strlen(gyroakf_result_json(result)) < 1000) status = GYROAKF_INTERNAL;
  gyroakf_result_free(result);
  if (status == GYROAKF_OK) {
    const int64_t n = gyroakf_record_samples(r);
    status = gyroakf_allan_new(gyroakf_record_values(r, 0), n, 0.01, NULL, &curve, &err);
    if (status == GYROAKF_OK) status = gyroakf_noise_fit(curve, NULL, &noise, &err);
    gyroakf_allan_free(curve);
    if (status == GYROAKF_OK) status = gyroakf_filter_new(1, &phi, 1e-4, 1e-2, NULL, &filter, &err);
    x = malloc((size_t)n * sizeof *x);
    if (status == GYROAKF_OK && x) status = gyroakf_filter_run(filter, gyroakf_record_values(r, 0), n, x, &err);
    free(x);
    gyroakf_filter_free(filter);
  }
  gyroakf_record_free(r);
  return status;
}

int main(int argc, char **argv) {
  const int64_t files = argc > 1 ? strtoll(argv[1], NULL, 10) : 1000;
  const char *folder = argc > 2 ? argv[2] : ".";
  const long allowed = 512; /* kB, half a kB a file: the heap settles in the first hundreds of files */
  long first_rss = 0, first_peak = 0, rss = 0, peak = 0;
  int64_t i, done[3] = {0, 0, 0};
  time_t began = time(NULL);
  char path[4096];

  snprintf(path, sizeof path, "%s/soak.txt", folder);
  printf("%8s %8s %8s %8s %12s %12s %8s\n", "files", "ok", "refused", "short", "VmRSS kB", "VmHWM kB", "s");
  for (i = 1; i <= files; i++) {
    const char *kind = make_file(path, i);
    const int status = work_on(path);
    const int wanted = strcmp(kind, "broken") == 0 ? GYROAKF_PARSE : strcmp(kind, "short") == 0 ? GYROAKF_TOO_FEW_SAMPLES : GYROAKF_OK;
    if (status != wanted) {
      printf("file %" PRId64 " (%s): %s instead of %s\n", i, kind, gyroakf_status_string(status), gyroakf_status_string(wanted));
      return 1;
    }
    done[wanted == GYROAKF_OK ? 0 : wanted == GYROAKF_PARSE ? 1 : 2]++;
    remove(path);
    if (i % (files >= 10 ? files / 10 : 1) != 0) continue;
    rss = status_of("VmRSS");
    peak = status_of("VmHWM");
    if (first_rss == 0) { first_rss = rss; first_peak = peak; }
    printf("%8" PRId64 " %8" PRId64 " %8" PRId64 " %8" PRId64 " %12ld %12ld %8ld\n", i, done[0], done[1], done[2], rss, peak,
           (long)(time(NULL) - began));
    fflush(stdout);
  }
  printf("growth after the first tenth: VmRSS %ld kB, VmHWM %ld kB (%ld kB allowed)\n", rss - first_rss, peak - first_peak, allowed);
  return rss - first_rss > allowed || peak - first_peak > allowed;
}
