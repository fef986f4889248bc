/* SPDX-License-Identifier: MIT */
/* The floating-point environment of a thread as far as it can be read, as bytes. Define _GNU_SOURCE before the first #include. */
#ifndef GYROAKF_MODES_H
#define GYROAKF_MODES_H

#include <fenv.h>
#include <string.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

typedef struct modes {
  unsigned control;
  int rounding, raised, trapped;
} modes;

static modes now(void) {
  modes m;
  memset(&m, 0, sizeof m);
  m.rounding = fegetround();
  m.raised = fetestexcept(FE_ALL_EXCEPT);
#if defined(__GLIBC__) && defined(__x86_64__)
  m.trapped = fegetexcept();
#endif
#if defined(__x86_64__)
  m.control = _mm_getcsr();
#endif
  return m;
}

#endif
