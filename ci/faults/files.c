/* SPDX-License-Identifier: MIT */
/*
 * Calls that read and write files, of which number FAULT_NUMBER of the one named FAULT_CALL fails: to be loaded before the C library
 * (LD_PRELOAD), see ci/faults/files.sh. FAULT_KIND says how:
 *
 *   EINTR   this one is interrupted
 *   short   this one moves half of the bytes
 *   EIO, ENOSPC   this one and all later ones
 *
 * The file FAULT_MARK appears when a call failed. Standard error is left alone.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

/* Whether this call fails; a call of half the bytes is none that fails. */
static int fails(const char *call, size_t *bytes) {
  static long calls;
  const char *name = getenv("FAULT_CALL"), *number = getenv("FAULT_NUMBER"), *kind = getenv("FAULT_KIND"), *mark = getenv("FAULT_MARK");
  if (!name || !number || !kind || !mark || strcmp(name, call) != 0) return 0;
  long k = __atomic_add_fetch(&calls, 1, __ATOMIC_RELAXED), failing = atol(number);
  if (k < failing || (k > failing && kind[0] == 'E' && kind[1] == 'I' && kind[2] == 'N') || (k > failing && kind[0] == 's')) return 0;
  syscall(SYS_close, syscall(SYS_openat, AT_FDCWD, mark, O_CREAT | O_WRONLY, 0600));
  if (kind[0] == 's') {
    if (bytes != NULL && *bytes > 1) *bytes /= 2;
    return 0;
  }
  errno = strcmp(kind, "EINTR") == 0 ? EINTR : strcmp(kind, "EIO") == 0 ? EIO : ENOSPC;
  return 1;
}

/* The function of that name behind this one. */
#define NEXT(function) __typeof__(&function) next = (__typeof__(&function))dlsym(RTLD_NEXT, #function)

int open(const char *path, int flags, ...) {
  NEXT(open);
  va_list more;
  va_start(more, flags);
  mode_t mode = flags & O_CREAT ? va_arg(more, mode_t) : 0;
  va_end(more);
  return fails("open", NULL) ? -1 : next(path, flags, mode);
}

int creat(const char *path, mode_t mode) {
  NEXT(creat);
  return fails("creat", NULL) ? -1 : next(path, mode);
}

ssize_t read(int file, void *buffer, size_t bytes) {
  NEXT(read);
  return fails("read", &bytes) ? -1 : next(file, buffer, bytes);
}

ssize_t pread(int file, void *buffer, size_t bytes, off_t place) {
  NEXT(pread);
  return fails("pread", &bytes) ? -1 : next(file, buffer, bytes, place);
}

ssize_t write(int file, const void *buffer, size_t bytes) {
  NEXT(write);
  return file != 2 && fails("write", &bytes) ? -1 : next(file, buffer, bytes);
}

/* Linux closes a file whose close was interrupted. */
int close(int file) {
  NEXT(close);
  int failed = next(file);
  return fails("close", NULL) ? -1 : failed;
}

int rename(const char *old, const char *new) {
  NEXT(rename);
  return fails("rename", NULL) ? -1 : next(old, new);
}

int unlink(const char *path) {
  NEXT(unlink);
  return fails("unlink", NULL) ? -1 : next(path);
}

int mkdir(const char *path, mode_t mode) {
  NEXT(mkdir);
  return fails("mkdir", NULL) ? -1 : next(path, mode);
}

void *mmap(void *address, size_t length, int protection, int flags, int file, off_t offset) {
  NEXT(mmap);
  return fails("mmap", NULL) ? MAP_FAILED : next(address, length, protection, flags, file, offset);
}
