/* SPDX-License-Identifier: MIT */
/* What the tests ask of OpenMP, also where the library is built without it (GYROAKF_ONE_THREAD). */
#ifndef THREADS_H
#define THREADS_H

#ifdef GYROAKF_ONE_THREAD
#define omp_get_max_threads() 1
#define omp_set_num_threads(n) ((void)(n))
#define omp_in_parallel() 0
#else
#include <omp.h>
#endif

#endif
