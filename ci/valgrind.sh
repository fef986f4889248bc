#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The C tests under valgrind: reads and writes outside of arrays, values that nobody set, memory that nobody freed.
#
#   GYROAKF_CMAKE=1 ci/valgrind.sh
#
# Takes the build of ci/cmake.sh, of which nothing is for this processor only. Where valgrind cannot be installed or cannot run a
# trivial program (as in some containers) it says so and counts nothing: "0 passed, 0 failed".
set -u
cd "$(dirname "$0")/.." || exit 1
./setup.sh true || exit 1
if ! GYROAKF_VALGRIND=1 ./setup.sh true; then
  echo "skipped: valgrind is not installed, and could not be"
  echo "0 passed, 0 failed"
  exit 0
fi
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

printf 'int main(void) { return 0; }\n' >"$work/trivial.c"
gcc "$work/trivial.c" -o "$work/trivial" || exit 1
if ! valgrind -q --error-exitcode=9 "$work/trivial" >"$work/said" 2>&1; then
  echo "skipped: valgrind cannot run a trivial program here:"
  head -n 5 "$work/said"
  echo "0 passed, 0 failed"
  exit 0
fi

# it tells a program with an error from one without
printf '#include <stdlib.h>\nint main(void) { volatile char *c = malloc(1); c[1] = 1; return 0; }\n' >"$work/bad.c"
gcc "$work/bad.c" -o "$work/bad" || exit 1
valgrind -q --error-exitcode=9 "$work/bad" >"$work/said" 2>&1
[ $? -eq 9 ] || { echo "valgrind does not see a write beyond an array"; exit 1; }

ci/cmake.sh --only test_c_api || exit 1
OMP_NUM_THREADS=1 OMP_WAIT_POLICY=passive OPENBLAS_NUM_THREADS=1 valgrind -q --error-exitcode=9 --leak-check=full \
  --errors-for-leak-kinds=definite,indirect,possible --suppressions=ci/valgrind.supp build/cmake/shared/test/test_c_api
code=$?
[ $code -ne 9 ] || echo "valgrind found errors"
exit $code
