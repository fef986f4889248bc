/* SPDX-License-Identifier: MIT */
/*
 * The files of a folder. In C because the entries of a directory have a layout of the system's own.
 */
#define _POSIX_C_SOURCE 200809L
#include <dirent.h>
#include <stddef.h>
#include <string.h>

#if defined(__GNUC__)
#define LOCAL __attribute__((visibility("hidden")))
#else
#define LOCAL
#endif

LOCAL size_t gyroakf_host_list_files(const char *folder, const char *ending, char *names,
                                     size_t capacity);

/* Writes the names that have the ending, each with a slash behind it, as far as the buffer holds
   them; returns the length of all. */
size_t gyroakf_host_list_files(const char *folder, const char *ending, char *names,
                               size_t capacity) {
  const size_t last = strlen(ending);
  const struct dirent *entry;
  size_t used = 0, length;
  DIR *directory = opendir(folder);
  if (!directory) return 0;
  while ((entry = readdir(directory)) != NULL) {
    length = strlen(entry->d_name);
    if (length < last || strcmp(entry->d_name + length - last, ending) != 0) continue;
    if (used + length < capacity) {
      memcpy(names + used, entry->d_name, length);
      names[used + length] = '/';
    }
    used += length + 1;
  }
  closedir(directory);
  return used;
}
