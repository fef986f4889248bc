/* SPDX-License-Identifier: MIT */
/*
 * Drift compensation in real time that keeps true rotation. The drift of a gyroscope is estimated
 * at rest only. In motion the filter gets no measurement and predicts, so that no rotation enters
 * the drift estimate:
 *
 *     compensated rate = rate - bias - drift
 *
 * Do not use the output of a noise filter instead. The filters of the paper (AR(p) Kalman filter
 * with R = variance of the record, Sage-Husa) have a DC gain of about 0.6. Used as the rate, their
 * output attenuates a constant rotation to 60 %; subtracted from the rate, it removes the rotation.
 *
 * Rest is detected from the gyroscope alone: the sensor moves where the mean of the last WINDOW
 * rates differs from bias + drift by more than 4 N / sqrt(WINDOW * DT). The filter gets the rate
 * that leaves the window, and only after WINDOW quiet samples: no rate at the beginning or end of a
 * turn is used.
 *
 * Limits: a rotation slower than the threshold cannot be told from drift by the gyroscope alone, and
 * up to three times the threshold parts of a turn may be missed. A drift above the threshold is
 * taken for motion, and the filter stays frozen. A vehicle has better signals of rest: odometer, wheel speed, parking brake, a zero-velocity detector on the
 * accelerometers. Where there is one, set `moving` from it.
 *
 *     realtime [FILE]        deg/s at 5 Hz, a rate per line, lines that begin with # are skipped;
 *                            the first 2000 samples are at rest
 *
 * Without FILE it takes example/data/mems_gyro_x.txt, a record at rest, and adds two known turns so
 * that the output can be checked. The exit status is 1 if less than 99.5 % of a turn survives.
 */
#include <gyroakf.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define DT 0.2                  /* sample interval, s */
#define TRAINING 2000           /* samples at rest, from which bias and noise are estimated */
#define WINDOW 1000             /* samples of the rest detector */
#define CORRELATION_TIME 3600.0 /* of the drift, s */
#define TURNS 2

/* The known turns: samples first .. last of the record, deg/s; the angle that survives, deg */
static struct {
  long first, last;
  double rate, kept;
} turns[TURNS] = {{3001, 9000, 0.01, 0}, {11001, 11045, 10, 0}};

/* Reads up to n rates; returns how many there were. */
static int read_rates(FILE *file, double *rate, int n) {
  char line[256];
  int i = 0;
  while (i < n && fgets(line, sizeof line, file)) {
    if (line[0] != '#') rate[i++] = strtod(line, NULL);
  }
  return i;
}

/* Reports what went wrong; for main to return. */
static int complain(const char *what, const gyroakf_error *err) {
  fprintf(stderr, "realtime: %s: %s\n", what, err->message);
  return 1;
}

int main(int argc, char **argv) {
  const char *path = argc > 1 ? argv[1] : "example/data/mems_gyro_x.txt";
  const int known = argc > 1 ? 0 : TURNS;
  static double training[TRAINING], window[WINDOW], turn_window[WINDOW];
  double bias = 0, square = 0, threshold, rate, last, sum = 0, drift = 0;
  double heading = 0, compensated = 0;
  int i, present = 0, oldest = 0, quiet = 0, moving = 0, status = 0;
  long n;
  gyroakf_allan *curve = NULL;
  gyroakf_noise noise;
  gyroakf_drift_model model;
  gyroakf_filter *filter = NULL, *turn_filter = NULL;
  gyroakf_error err;

  FILE *file = fopen(path, "r");
  if (!file || read_rates(file, training, TRAINING) < TRAINING) {
    fprintf(stderr, "realtime: %s: cannot be read, or has fewer than %d rates\n", path, TRAINING);
    return 1;
  }

  /* Gross outliers are marked missing, not deleted: that would break the time base */
  for (i = 0; i < TRAINING; i++) square += training[i] * training[i] / TRAINING;
  for (i = 0; i < TRAINING; i++) {
    if (training[i] * training[i] > 25 * square) training[i] = NAN;
    if (isnan(training[i])) continue;
    bias += training[i];
    present++;
  }
  bias /= present;

  /* Angle random walk N; the standard deviation of the window's mean is N / sqrt(WINDOW * DT) */
  if (gyroakf_allan_new(training, TRAINING, DT, NULL, &curve, &err)) return complain("Allan", &err);
  if (gyroakf_noise_fit(curve, NULL, &noise, &err)) return complain("noise", &err);
  gyroakf_allan_free(curve);
  if (!noise.n.detected) {
    fprintf(stderr, "realtime: %s: angle random walk not detected\n", path);
    return 1;
  }
  threshold = 4 * noise.n.value / sqrt(WINDOW * DT);

  /*
   * Drift: a Gauss-Markov process with the variance of the bias, N^2 / (TRAINING * DT); r is the
   * variance of white noise N. In steady state the filter averages over
   * sqrt(TRAINING * DT * CORRELATION_TIME / 2) = 850 s, more than the training: a shorter averaging
   * time would add more noise than the bias has. A sensor that drifts faster needs its own variance
   * and correlation time, from a record of hours.
   */
  gyroakf_drift_model_init(&model);
  model.count = 1;
  model.slow[0] = 1;
  model.phi[0] = exp(-DT / CORRELATION_TIME);
  model.q[0] = noise.n.value * noise.n.value / (TRAINING * DT) * (1 - model.phi[0] * model.phi[0]);
  model.r = noise.n.value * noise.n.value / DT;
  if (gyroakf_drift_filter_new(&model, NULL, &filter, &err)) return complain("filter", &err);
  /* For the check only: the same filter for the known turns alone */
  if (gyroakf_drift_filter_new(&model, NULL, &turn_filter, &err)) return complain("filter", &err);

  printf("%s\n", path);
  printf("N %.4f deg/sqrt(s), bias %.5f deg/s, moving above %.4f deg/s\n", noise.n.value, bias,
         threshold);
  printf("%8s  %-6s %12s %12s\n", "sample", "status", "raw heading", "compensated");
  last = bias;
  /* Here a program would read the sensor; NaN where it gave nothing: the last rate stands for it */
  for (n = TRAINING + 1; read_rates(file, &rate, 1) == 1; n++) {
    double turn = 0, old, old_turn, leak;
    for (i = 0; i < known; i++) {
      if (n >= turns[i].first && n <= turns[i].last) turn = turns[i].rate;
    }
    rate = isnan(rate) ? last : rate + turn;
    last = rate;

    /* Rest or motion: the newest rate takes the place of the oldest in the window */
    old = window[oldest];
    window[oldest] = rate - bias;
    sum += window[oldest] - old;
    quiet = fabs(sum / WINDOW - drift) <= threshold ? quiet + 1 : 0;
    if (moving != (quiet < WINDOW)) {
      moving = !moving;
      gyroakf_filter_freeze(filter, moving); /* no adaptation in motion, if options ask for it */
    }
    /* Drift: NaN is no measurement, the filter predicts */
    gyroakf_filter_step(filter, moving ? NAN : old, &drift);

    heading += rate * DT;
    compensated += (rate - bias - drift) * DT;
    if (n % 1000 == 0) {
      printf("%8ld  %-6s %12.3f %12.3f\n", n, moving ? "moving" : "rest", heading, compensated);
    }

    /* The check: the filter is linear. Given the known turn alone at the same samples, it shows
     * what of the turn is taken for drift; turns[i] is the latest turn that has begun. */
    old_turn = turn_window[oldest];
    turn_window[oldest] = turn;
    gyroakf_filter_step(turn_filter, moving ? NAN : old_turn, &leak);
    for (i = TURNS - 1; i > 0 && n < turns[i].first; i--) continue;
    turns[i].kept += (turn - leak) * DT;
    oldest = (oldest + 1) % WINDOW;
  }
  fclose(file);
  gyroakf_filter_free(filter);
  gyroakf_filter_free(turn_filter);

  for (i = 0; i < known; i++) {
    double angle = (turns[i].last - turns[i].first + 1) * turns[i].rate * DT;
    double percent = 100 * turns[i].kept / angle;
    printf("true turn %5.2f deg at %5.2f deg/s: %5.2f deg survives, %.1f %%\n", angle,
           turns[i].rate, turns[i].kept, percent);
    if (!(percent >= 99.5)) status = 1;
  }
  return status;
}
