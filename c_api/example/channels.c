/* SPDX-License-Identifier: MIT */
/*
 * What a recording holds: its channels, its rate, what was found while reading, and the noise of each channel.
 *
 *     channels [FILE [RATE]]     default example/data/mems_gyro_x.txt; RATE in Hz where the file does not tell it
 */
#include <gyroakf.h>

#include <stdio.h>
#include <stdlib.h>

/* Says what went wrong; for main to return. */
static int complain(const gyroakf_error *err) {
  fprintf(stderr, "channels: %s\n", err->message);
  return 1;
}

/* A value, an upper limit, or that the record does not determine it. */
static void print_coefficient(const gyroakf_coefficient *c, int width) {
  char text[32] = "withheld";
  if (c->fitted) snprintf(text, sizeof text, c->detected ? "%.4g" : "< %.4g", c->detected ? c->value : c->upper_limit);
  printf(" %*s", width, text);
}

int main(int argc, char **argv) {
  const char *path = argc > 1 ? argv[1] : "example/data/mems_gyro_x.txt";
  gyroakf_reader_options options;
  gyroakf_record *record;
  gyroakf_audit audit;
  gyroakf_error err;
  double interval;
  int32_t i;

  gyroakf_reader_options_init(&options);
  if (argc > 2) options.rate_hz = strtod(argv[2], NULL);
  if (gyroakf_record_read(path, &options, &record, &err)) return complain(&err);

  audit.struct_size = sizeof audit;
  gyroakf_record_audit(record, &audit);
  interval = gyroakf_record_sample_interval(record);
  printf("%s: %lld samples, interval %g s (%s), %lld missing\n", path, (long long)audit.samples, interval,
         gyroakf_record_rate_source(record), (long long)audit.missing);
  for (i = 0; i < gyroakf_record_warnings(record); i++) printf("note: %s\n", gyroakf_record_warning(record, i));

  printf("%-12s %-8s %20s %22s\n", "channel", "unit u", "random walk, u rt(s)", "bias instability, u");
  for (i = 0; i < gyroakf_record_channels(record); i++) {
    gyroakf_allan *curve = NULL;
    gyroakf_noise noise;
    if (gyroakf_allan_new(gyroakf_record_values(record, i), audit.samples, interval, NULL, &curve, &err) ||
        gyroakf_noise_fit(curve, NULL, &noise, &err)) {
      gyroakf_allan_free(curve);
      gyroakf_record_free(record);
      return complain(&err);
    }
    printf("%-12s %-8s", gyroakf_record_name(record, i), gyroakf_record_unit(record, i));
    print_coefficient(&noise.n, 20);
    print_coefficient(&noise.b, 22);
    printf("\n");
    gyroakf_allan_free(curve);
  }
  gyroakf_record_free(record);
  return 0;
}
