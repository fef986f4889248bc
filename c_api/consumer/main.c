/* SPDX-License-Identifier: MIT */
/*
 * A program outside the library, the smallest that uses all kinds of its functions: options, a handle, a result, an error.
 * ci/cmake.sh builds it with pkg-config and with CMake against an installed library.
 */
#include <gyroakf.h>
#include <stdio.h>

enum { N = 4000 };

static int fail(const char *what, const gyroakf_error *err) {
  fprintf(stderr, "%s: %s (%s)\n", what, err->message, gyroakf_status_string(err->code));
  return 1;
}

int main(void) {
  static double rate[N];
  gyroakf_error err;
  gyroakf_allan *curve;
  gyroakf_filter *filter;
  gyroakf_filter_state state;
  gyroakf_ar_options opt;
  double phi[2], noise_variance, mean;
  int32_t order;
  uint32_t seed = 1;
  int64_t i;

  if (gyroakf_version() != GYROAKF_VERSION) {
    fprintf(stderr, "header %s, library %s\n", GYROAKF_VERSION_STRING, gyroakf_version_string());
    return 1;
  }
  /* an AR(1) series of uniform numbers by a linear congruential generator: the same everywhere */
  for (i = 0; i < N; i++) {
    seed = (uint32_t)(seed * UINT64_C(1664525) + UINT64_C(1013904223));
    rate[i] = (seed >> 8) / 16777216.0 - 0.5 + (i > 0 ? 0.5 * rate[i - 1] : 0.0);
  }

  if (gyroakf_allan_new(rate, N, 0.01, NULL, &curve, &err) != GYROAKF_OK) return fail("Allan deviation", &err);
  printf("%d averaging times, %.6f at %.2f s\n", (int)gyroakf_allan_size(curve), gyroakf_allan_deviation(curve)[0],
         gyroakf_allan_tau(curve)[0]);
  gyroakf_allan_free(curve);

  gyroakf_ar_options_init(&opt);
  opt.order = 1;
  if (gyroakf_ar_fit(rate, N, &opt, 2, &order, phi, &noise_variance, &mean, &err) != GYROAKF_OK) return fail("AR model", &err);
  printf("AR(%d): %.6f, noise variance %.6f\n", (int)order, phi[0], noise_variance);

  if (gyroakf_filter_new(order, phi, noise_variance, 0.1, NULL, &filter, &err) != GYROAKF_OK) return fail("filter", &err);
  if (gyroakf_filter_run(filter, rate, N, rate, &err) != GYROAKF_OK) return fail("filter", &err);
  gyroakf_filter_get(filter, &state);
  gyroakf_filter_free(filter);
  printf("filter: gain %.6f after %d samples\n", state.gain, (int)state.steps);
  return 0;
}
