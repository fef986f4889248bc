/* SPDX-License-Identifier: MIT */
/*
 * Filters a recording sample by sample, as a navigation program would: the model is fitted once to the first part of the
 * record, then every new sample takes one call that allocates nothing.
 *
 *     realtime [FILE]        default example/data/mems_gyro_x.txt: a rate per line, lines that begin with # are skipped
 */
#include <gyroakf.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Samples that the model is fitted to */
#define TRAINING 2000

/* Reads up to n rates; returns how many there were. */
static int read_rates(FILE *file, double *rate, int n) {
  char line[256];
  int i = 0;
  while (i < n && fgets(line, sizeof line, file)) {
    if (line[0] != '#') rate[i++] = strtod(line, NULL);
  }
  return i;
}

/* Says what went wrong; for main to return. */
static int complain(const char *what, const gyroakf_error *err) {
  fprintf(stderr, "realtime: %s: %s\n", what, err->message);
  return 1;
}

int main(int argc, char **argv) {
  const char *path = argc > 1 ? argv[1] : "example/data/mems_gyro_x.txt";
  static double training[TRAINING];
  double phi[3], noise_variance, mean, variance = 0, sum_z = 0, sum_x = 0, square_z = 0, square_x = 0, rate;
  int32_t order;
  long n = 0;
  int i, present = 0;
  gyroakf_ar_options ar_options;
  gyroakf_filter_options options;
  gyroakf_filter *filter = NULL;
  gyroakf_filter_state state;
  gyroakf_error err;

  FILE *file = fopen(path, "r");
  if (!file || read_rates(file, training, TRAINING) < TRAINING) {
    fprintf(stderr, "realtime: %s: cannot be read, or has fewer than %d rates\n", path, TRAINING);
    return 1;
  }

  /* Gross outliers are marked missing, not deleted: that would break the time base */
  for (i = 0; i < TRAINING; i++) variance += training[i] * training[i] / TRAINING;
  for (i = 0; i < TRAINING; i++) {
    if (training[i] * training[i] > 25 * variance) training[i] = NAN;
  }

  /* The model of the noise: order by BIC, at most 3 */
  gyroakf_ar_options_init(&ar_options);
  ar_options.criterion = "bic";
  if (gyroakf_ar_fit(training, TRAINING, &ar_options, 3, &order, phi, &noise_variance, &mean, &err)) return complain("model", &err);
  variance = 0;
  for (i = 0; i < TRAINING; i++) {
    if (isnan(training[i])) continue;
    variance += (training[i] - mean) * (training[i] - mean);
    present++;
  }
  variance /= present;

  /* The paper's Kalman filter: Q is the model's noise variance, R the variance of the series; gross outliers count less */
  gyroakf_filter_options_init(&options);
  options.huber = 3.0;
  if (gyroakf_filter_new(order, phi, noise_variance, variance, &options, &filter, &err)) return complain("filter", &err);

  printf("%s, gyroakf %s\n", path, gyroakf_version_string());
  printf("AR(%d): phi %.4f, noise variance %.4g, mean %.3g\n", (int)order, phi[0], noise_variance, mean);
  printf("%8s %12s %12s\n", "sample", "rate", "filtered");
  while (read_rates(file, &rate, 1) == 1) { /* here a program would read the sensor; NaN where it gave nothing */
    double z = rate - mean, x;
    gyroakf_filter_step(filter, z, &x);
    if (n % 2000 == 0) printf("%8ld %12.6f %12.6f\n", TRAINING + n, rate, x + mean);
    n++;
    if (isnan(z)) continue;
    sum_z += z;
    sum_x += x;
    square_z += z * z;
    square_x += x * x;
  }
  fclose(file);
  gyroakf_filter_get(filter, &state);
  gyroakf_filter_free(filter);
  if (n == 0) return 0;
  printf("variance %.4g, filtered %.4g; gain %.4f, innovation variance %.4g\n", (square_z - sum_z * sum_z / n) / n,
         (square_x - sum_x * sum_x / n) / n, state.gain, state.innovation_variance);
  return 0;
}
