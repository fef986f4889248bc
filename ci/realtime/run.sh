#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A step of a filter allocates nothing, locks nothing and makes no system call (steps.c); Linux with glibc.
#
#   ci/realtime/run.sh [LIBRARY]        libgyroakf.a; default: fpm's, installed into build/realtime
#
# The last line is "N passed, N failed".
set -u
cd "$(dirname "$0")/../.." || exit 1
out=build/realtime
mkdir -p "$out"
library=${1-}
if [ -z "$library" ]; then
  ./setup.sh fpm install --prefix "$out" >/dev/null || exit 1
  library=$out/lib/libgyroakf.a
fi
gcc -std=c99 -O1 -Wall -Wextra -pedantic -Werror -Ic_api/include -c ci/realtime/steps.c -o "$out/steps.o" &&
  gfortran -fopenmp "$out/steps.o" "$library" -llapack -lblas -lz -ldl -o "$out/steps" || exit 1
OMP_NUM_THREADS=1 "$out/steps"
