/* SPDX-License-Identifier: MIT */
/*
 * What processes left behind that were killed while they wrote a file, and what kind of file a path
 * leads to. In C because directories and the answers of stat have layouts of the system's own.
 */
#define _POSIX_C_SOURCE 200809L
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <unistd.h>

#if defined(__GNUC__)
#define LOCAL __attribute__((visibility("hidden")))
#else
#define LOCAL
#endif

LOCAL void gyroakf_host_remove_leftovers(const char *path);
LOCAL int gyroakf_host_same_file(const char *a, const char *b);
LOCAL int gyroakf_host_is_special(const char *path);

/* Whether a name is NAME.partN, where N is the number of a process that is no more. */
static int is_leftover(const char *entry, const char *name, size_t length) {
  const char *digits = entry + length + 5;
  long process;
  size_t count;
  if (strncmp(entry, name, length) != 0 || strncmp(entry + length, ".part", 5) != 0) return 0;
  count = strspn(digits, "0123456789");
  if (count < 1 || count > 10 || digits[count] != '\0') return 0;
  process = strtol(digits, NULL, 10);
  if (process < 1 || (long)(pid_t)process != process) return 0;
  return kill((pid_t)process, 0) != 0 && errno == ESRCH;
}

/* Removes PATH.partN of all processes N that are no more. */
void gyroakf_host_remove_leftovers(const char *path) {
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;
  size_t length = strlen(name), before = (size_t)(name - path);
  char *folder = malloc(before + 2);
  const struct dirent *entry;
  DIR *directory;
  if (!folder) return;
  memcpy(folder, path, before);
  memcpy(folder + before, ".", 2);
  directory = opendir(folder);
  free(folder);
  if (!directory) return;
  while ((entry = readdir(directory)) != NULL) {
    if (is_leftover(entry->d_name, name, length)) unlinkat(dirfd(directory), entry->d_name, 0);
  }
  closedir(directory);
}

/* Whether two paths lead to one regular file, by any names or links; "-" is standard input. */
int gyroakf_host_same_file(const char *a, const char *b) {
  struct stat first, second;
  const int found = strcmp(a, "-") == 0 ? fstat(0, &first) : stat(a, &first);
  return found == 0 && S_ISREG(first.st_mode) && stat(b, &second) == 0 &&
         first.st_dev == second.st_dev && first.st_ino == second.st_ino;
}

/* Whether a path leads to a device, a FIFO or a socket, which must not be replaced by a file. */
int gyroakf_host_is_special(const char *path) {
  struct stat found;
  return stat(path, &found) == 0 && !S_ISREG(found.st_mode) && !S_ISDIR(found.st_mode);
}
