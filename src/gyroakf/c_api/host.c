/* SPDX-License-Identifier: MIT */
/*
 * The floating-point environment of the program that calls: rounding, traps, exception flags, flushing of tiny numbers to zero.
 * In C because Fortran 2018 does not reach all of it (the operands that DAZ of x86 flushes) and has no constant for its default.
 *
 * And what a forked child must know: the threads of its parent are not there.
 */
#if defined(__unix__) && !defined(_POSIX_C_SOURCE)
#define _POSIX_C_SOURCE 200809L
#endif
#include <fenv.h>
#include <stdint.h>
#if defined(__x86_64__)
#include <immintrin.h>
#endif

#if defined(__GNUC__) && !defined(_WIN32)
#define LOCAL __attribute__((visibility("hidden")))
#else
#define LOCAL
#endif

LOCAL void gyroakf_host_set_aside(int64_t environment[64]);
LOCAL void gyroakf_host_restore(const int64_t environment[64]);
LOCAL int gyroakf_host_begin_step(int64_t environment[64]);
LOCAL void gyroakf_host_end_step(const int64_t environment[64]);

/* fenv_t fits in the space that Fortran reserves. */
typedef char fenv_fits[sizeof(fenv_t) <= 64 * sizeof(int64_t) ? 1 : -1];

/* Keeps the environment and sets the default one: to nearest, no traps, nothing flushed. */
void gyroakf_host_set_aside(int64_t environment[64]) {
  feholdexcept((fenv_t *)(void *)environment);
  fesetenv(FE_DFL_ENV);
}

/* The kept environment again, with its flags. */
void gyroakf_host_restore(const int64_t environment[64]) { fesetenv((const fenv_t *)(const void *)environment); }

/*
 * The same within a few nanoseconds for what a filter's step computes with: begin_step returns 0 where the environment is that of a
 * program that never touched it (flags do not count), and nothing was done.
 */
#if defined(__x86_64__)
int gyroakf_host_begin_step(int64_t environment[64]) {
  const unsigned usual = 0x1f80U, flags = 0x3fU; /* all traps masked, to nearest, neither FTZ nor DAZ */
  unsigned control = _mm_getcsr();
  if ((control & ~flags) == usual) return 0;
  environment[0] = (int64_t)control;
  _mm_setcsr(usual);
  return 1;
}

void gyroakf_host_end_step(const int64_t environment[64]) { _mm_setcsr((unsigned)environment[0]); }
#else
int gyroakf_host_begin_step(int64_t environment[64]) {
#if defined(__aarch64__) && defined(__GNUC__)
  uint64_t control;
  __asm__ volatile("mrs %0, fpcr" : "=r"(control));
  if (control == 0) return 0;
#endif
  gyroakf_host_set_aside(environment);
  return 1;
}

void gyroakf_host_end_step(const int64_t environment[64]) { gyroakf_host_restore(environment); }
#endif

/*
 * A child that is forked after a parallel region would wait for ever for the threads of its parent: it computes with one thread.
 * The library's one state of the whole process, set when it is loaded.
 */
#if defined(__unix__) && defined(__GNUC__)
#include <pthread.h>
extern void one_thread_of_gyroakf(void);

__attribute__((constructor)) static void watch_forks(void) { pthread_atfork(NULL, NULL, one_thread_of_gyroakf); }
#endif
