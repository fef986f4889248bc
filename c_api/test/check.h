/* SPDX-License-Identifier: MIT */
/* What the files of the tests share; test_c_api.c has main and calls them. */
#ifndef GYROAKF_CHECK_H
#define GYROAKF_CHECK_H

#include "gyroakf.h"

/* One test: prints only what fails. By one thread at a time. */
void check(int good, const char *what);

/* The error struct of the calls that are checked. */
extern gyroakf_error err;

/* The call failed with this status, err agrees, and the message says something. */
void check_failure(int status, int expected, const char *what);

/* The call failed in one of several sensible ways. */
void check_any_failure(int status, const char *what);

/* The call succeeded and cleared err. */
void check_success(int status, const char *what);

/* Pseudo-random values between 0 and 1 that are the same everywhere: n_1 = seed, n = 16807 n mod 2147483647. */
void uniform(double *x, int n, int64_t seed);

/* One file each */
void test_bad(void);
void test_children(void);
void test_drift(void);
void test_faults(void);
void test_host(void);
void test_memory(void);
void test_progress(void);
void test_promises(void);
void test_run(void);
void test_threads(void);
void test_threads_briefly(void);

#endif
