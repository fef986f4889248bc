/* SPDX-License-Identifier: MIT */
/* The same work done by several threads or in several floating-point environments: what comes out must be the same. */
#ifndef GYROAKF_WORK_H
#define GYROAKF_WORK_H

#include "gyroakf.h"

enum { work_samples = 3000, work_points = 64, work_texts = 4096 };

/* All that comes of a recording. Compared as bytes. */
typedef struct results {
  int32_t seed; /* of its recording */
  int status;   /* the sum of all statuses that should be 0 */
  double deviation[work_points], upper[work_points], read[work_samples], filtered[work_samples], stepped[work_samples], simulated[500], phi[5], variance, mean;
  gyroakf_noise noise;
  double adf[2], kpss[2];
  gyroakf_filter_state state;
  char texts[work_texts]; /* names, units, warnings and messages, one after the other */
} results;

/* The content of a file, different for each seed; the caller frees it. */
char *make_recording(int32_t seed);

/* Nearly all that the library does, with the recording of r->seed; the rest of *r is 0 before. */
void work(results *r, const char *recording);

#endif
