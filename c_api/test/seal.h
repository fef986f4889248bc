/* SPDX-License-Identifier: MIT */
#ifndef GYROAKF_SEAL_H
#define GYROAKF_SEAL_H

#include <stdint.h>
#include <string.h>

/* The checksum of the words behind the header, as src/gyroakf/filter/saving.f90 writes it, so that damage gets past it. */
static void seal(unsigned char *bytes, int64_t n) {
  uint64_t word, low = 0xffffffffU, a = 2166136261U, b = 2246822519U, next;
  int64_t k;
  if (n < 40) return;
  for (k = 4; k < n / 8; k++) {
    memcpy(&word, bytes + 8 * k, 8);
    a ^= word & low;
    a = (((a & 255) << 24) + 403 * a) & low;
    b ^= word >> 32;
    b = (((b & 255) << 24) + 403 * b) & low;
    next = a ^ (b >> 7);
    b ^= a >> 9;
    a = next;
  }
  word = ((a & 0x7fffffffU) << 32) | b;
  memcpy(bytes + 24, &word, 8);
  word = (uint64_t)(n / 8);
  memcpy(bytes + 16, &word, 8);
}

#endif
