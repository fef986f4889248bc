#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Two threads of C on two handles each under helgrind: what one writes and the other reads or writes without an order between them.
#
#   GYROAKF_CMAKE=1 ci/helgrind.sh
#
# Inside the library one thread each: helgrind does not know the barriers of libgomp. Takes the build of ci/cmake.sh. Where valgrind
# cannot be installed or cannot run it says so and counts nothing.
set -u
cd "$(dirname "$0")/.." || exit 1
./setup.sh true || exit 1
skip() {
  echo "skipped: $1"
  echo "0 passed, 0 failed"
  exit 0
}
GYROAKF_VALGRIND=1 ./setup.sh true || skip "valgrind is not installed, and could not be"
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
watch() { # what the program says is in $work/said
  OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 valgrind -q --tool=helgrind --history-level=approx --error-exitcode=9 \
    --suppressions=ci/helgrind.supp "$@" >"$work/said" 2>&1
}

# it tells a program with a race from one without
printf '%s\n' '#include <pthread.h>' 'static int n;' 'static void *f(void *p) { if (p) n++; return p; }' \
  'int main(int c, char **v) { pthread_t a; (void)v; pthread_create(&a, 0, f, c > 1 ? &n : 0); f(&n); return pthread_join(a, 0); }' \
  >"$work/race.c"
gcc "$work/race.c" -o "$work/race" -pthread || exit 1
watch "$work/race" || skip "valgrind cannot run a trivial program here"
watch "$work/race" twice
[ $? -eq 9 ] || { echo "helgrind does not see a race"; exit 1; }

ci/cmake.sh --only test_c_api || exit 1
watch build/cmake/shared/test/test_c_api threads
code=$?
cat "$work/said"
[ $code -ne 9 ] || echo "helgrind found races"
exit $code
