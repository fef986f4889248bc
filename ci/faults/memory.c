/* SPDX-License-Identifier: MIT */
/*
 * An allocator of which one request of 16 kB or more fails: to be loaded before the C library (LD_PRELOAD), see ci/faults/run.sh.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>

enum { large = 16384 };

static long requests, failing;

/* Counts from 0 on; request number `failing` fails, none where it is 0. */
void faults_begin(long number);
/* Large requests since then. */
long faults_requests(void);

void faults_begin(long number) {
  failing = number;
  requests = 0;
}

long faults_requests(void) { return requests; }

static int fails(size_t size) {
  if (size < large || __atomic_add_fetch(&requests, 1, __ATOMIC_RELAXED) != failing) return 0;
  errno = ENOMEM;
  return 1;
}

/* The function of that name behind this one. */
#define NEXT(function) \
  static __typeof__(&function) next; \
  if (next == NULL) next = (__typeof__(&function))dlsym(RTLD_NEXT, #function)

void *malloc(size_t size) {
  NEXT(malloc);
  return fails(size) ? NULL : next(size);
}

void *realloc(void *old, size_t size) {
  NEXT(realloc);
  return fails(size) ? NULL : next(old, size);
}

void *aligned_alloc(size_t alignment, size_t size) {
  NEXT(aligned_alloc);
  return fails(size) ? NULL : next(alignment, size);
}

int posix_memalign(void **place, size_t alignment, size_t size) {
  NEXT(posix_memalign);
  return fails(size) ? ENOMEM : next(place, alignment, size);
}

/* dlsym itself calls calloc: the first requests are served from here. */
void *calloc(size_t number, size_t size) {
  static char early[4096];
  static size_t used;
  static void *(*next)(size_t, size_t);
  static int asking;
  if (next == NULL && !asking) {
    asking = 1;
    next = (void *(*)(size_t, size_t))dlsym(RTLD_NEXT, "calloc");
    asking = 0;
  }
  if (next == NULL) {
    used += (number * size + 15) / 16 * 16;
    return used > sizeof early ? NULL : early + used - (number * size + 15) / 16 * 16;
  }
  return fails(number * size) ? NULL : next(number, size);
}
