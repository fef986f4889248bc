/* SPDX-License-Identifier: MIT */
/*
 * Two threads on two handles each: reader, messages, Allan deviation, fit, tests, models and filter give the numbers and the
 * texts that they give one after the other.
 */
#include "check.h"
#include "threads.h"
#include "work.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int rounds = 5, text_rounds = 40000;

/* Short texts of other lengths than those of the other thread, very often: a length kept in static memory is found out. */
static void read_often(results *r) {
  const char *const text = r->seed % 2 ? "1 2\n3 x\n" : "1 2 3 4\n2 3 4 a-word-that-is-not-a-number-and-rather-long\n";
  char expected[256] = "";
  gyroakf_record *none = NULL;
  gyroakf_error error;
  int i;
  for (i = 0; i < text_rounds; i++) {
    r->status += gyroakf_record_parse(text, (int64_t)strlen(text), NULL, &none, &error) != GYROAKF_PARSE;
    if (i == 0) memcpy(expected, error.message, sizeof expected);
    r->status += strcmp(error.message, expected) != 0 || strstr(expected, "is not a number") == NULL;
  }
}

/* One thread: the same work again and again; inside the library one thread each, so that sums are the same to the last bit. */
static void *work_often(void *argument) {
  results *first = (results *)argument, *again = (results *)calloc(1, sizeof *again);
  char *text = make_recording(first->seed);
  int i;
  omp_set_num_threads(1);
  if (again == NULL) abort();
  for (i = 0; i < rounds; i++) {
    memset(again, 0, sizeof *again);
    again->seed = first->seed;
    work(again, text);
    if (i == 0) memcpy(first, again, sizeof *first);
    if (memcmp(first, again, sizeof *first) != 0) first->status = 1000 + i;
  }
  read_often(first);
  free(again);
  free(text);
  return NULL;
}

/* Where a tool looks at every access to memory: what two threads do once is enough. */
void test_threads_briefly(void) {
  rounds = 2;
  text_rounds = 50;
  test_threads();
}

void test_threads(void) {
  results *alone = (results *)calloc(2, sizeof *alone), *together = (results *)calloc(2, sizeof *together);
  int usual = omp_get_max_threads(), i;
  pthread_t thread[2];
  char *text;
  if (alone == NULL || together == NULL) abort();
  omp_set_num_threads(1);
  for (i = 0; i < 2; i++) {
    alone[i].seed = together[i].seed = i + 1;
    text = make_recording(i + 1);
    work(&alone[i], text);
    free(text);
    check(alone[i].status == 0, "all calls of one thread alone");
    check(strstr(alone[i].texts, "rate of sensor number") != NULL && strlen(alone[i].texts) > 500, "its texts are there");
  }
  check(memcmp(&alone[0].noise, &alone[1].noise, sizeof alone[0].noise) != 0, "the two threads have different data");
  omp_set_num_threads(usual);
  for (i = 0; i < 2; i++) check(pthread_create(&thread[i], NULL, work_often, &together[i]) == 0, "a thread begins");
  for (i = 0; i < 2; i++) check(pthread_join(thread[i], NULL) == 0, "a thread ends");
  for (i = 0; i < 2; i++) {
    check(together[i].status == 0, "both threads get the same in every round");
    check(memcmp(&alone[i], &together[i], sizeof alone[i]) == 0, "and the same as alone, to the last bit");
    check(strcmp(alone[i].texts, together[i].texts) == 0, "and the same texts");
    if (strcmp(alone[i].texts, together[i].texts) != 0) printf("  %s\n  %s\n", alone[i].texts, together[i].texts);
  }
  free(alone);
  free(together);
}
