#!/bin/sh
# SPDX-License-Identifier: MIT
# How long the long calls of the C interface say nothing, by one thread: the longest silence is what a cancel waits.
#
#   ./run.sh [SAMPLES] [WORD]     default: 20000000, all calls; WORD: those in whose name it stands
set -eu
cd "$(dirname "$0")"
mkdir -p build
prefix=$(dirname "$(dirname "$(../program.sh gyroakf)")")
gcc -std=c99 -O2 -Wall -Wextra -pedantic -I"$prefix/include" -I../../c_api/include -c silence.c -o build/silence.o
gfortran -fopenmp build/silence.o "$prefix/lib/libgyroakf.a" -llapack -lblas -lz -lm -o build/silence
OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 build/silence "${1:-20000000}" ${2:+"$2"}
