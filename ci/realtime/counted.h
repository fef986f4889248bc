/* SPDX-License-Identifier: MIT */
/*
 * Counts what a program asks of the system: every allocation, every release and every mutex passes through the functions below. For
 * one file of a program, which defines _GNU_SOURCE and links with -ldl. Without glibc nothing is counted.
 */
#ifndef GYROAKF_COUNTED_H
#define GYROAKF_COUNTED_H

#include <dlfcn.h>
#include <pthread.h>
#include <stddef.h>

static long allocations, locks;

#ifdef __GLIBC__ /* its allocator by its other names */
extern void *__libc_malloc(size_t size);
extern void *__libc_calloc(size_t count, size_t size);
extern void *__libc_realloc(void *old, size_t size);
extern void __libc_free(void *old);
void *malloc(size_t size) {
  allocations++;
  return __libc_malloc(size);
}
void *calloc(size_t count, size_t size) {
  allocations++;
  return __libc_calloc(count, size);
}
void *realloc(void *old, size_t size) {
  allocations++;
  return __libc_realloc(old, size);
}
void free(void *old) {
  if (old) allocations++;
  __libc_free(old);
}
int pthread_mutex_lock(pthread_mutex_t *mutex) {
  static int (*real)(pthread_mutex_t *);
  if (!real) *(void **)&real = dlsym(RTLD_NEXT, "pthread_mutex_lock");
  locks++;
  return real(mutex);
}
#endif

#endif
