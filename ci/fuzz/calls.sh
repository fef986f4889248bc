#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Calls every function of gyroakf.h with random arguments (c_api/fuzz/calls.c), the same on every machine.
#
#   ci/fuzz/calls.sh [RUNS [SEED [LIBRARY]]]     200000 runs from seed 1; libgyroakf.a: fpm's, installed into build/calls
#
# With GYROAKF_SANITIZED_CALLS=1, as ci/full has it, a tenth of the runs is repeated with the objects of the newest sanitized build (ci/full
# sanitize). The last line is "N passed, N failed": runs, and one more for the table of functions, which has to name all that the
# header declares.
set -u
cd "$(dirname "$0")/../.." || exit 1
runs=${1-200000}
seed=${2-1}
library=${3-}
out=build/calls
mkdir -p "$out"
if [ -z "$library" ]; then
  ./setup.sh fpm install --prefix "$out" >/dev/null || exit 1
  library=$out/lib/libgyroakf.a
fi
passed=0
failed=0
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1

missing=$(diff <(sed -nE 's/^function .*[ *](gyroakf_[a-z0-9_]+) \(.*/\1/p' c_api/abi.txt | sort) \
  <(sed -n '/^#define FUNCTIONS/,/[^\\]$/p' c_api/fuzz/calls.c | grep -oE 'F\([a-z][a-z0-9_]+, [0-9]+\)' |
    sed -E 's/F\((.*),.*/gyroakf_\1/' | sort))
if [ -z "$missing" ]; then
  passed=1
else
  failed=1
  printf 'FAILED: the table FUNCTIONS of c_api/fuzz/calls.c is not that of c_api/abi.txt:\n%s\n' "$missing"
fi

# call NAME RUNS: runs the program, adds its counts; one that ends badly without a count is one failure
call() {
  local code said more worse
  said=$(nice "$out/$1" "$2" "$seed" 2>&1)
  code=$?
  read -r more worse < <(sed -nE 's/^([0-9]+) passed, ([0-9]+) failed$/\1 \2/p' <<<"$said")
  grep -v ' passed, ' <<<"$said" | tail -n 60
  passed=$((passed + ${more:-0}))
  failed=$((failed + ${worse:-0}))
  if [ -z "${worse-}" ] || { [ $code -ne 0 ] && [ "$worse" -eq 0 ]; }; then failed=$((failed + 1)); fi
}

gcc -std=c99 -g -O1 -Wall -Wextra -pedantic -Werror -Ic_api/include -Ic_api/test -c c_api/fuzz/calls.c -o "$out/calls.o" &&
  gfortran -fopenmp "$out/calls.o" "$library" -llapack -lblas -lz -o "$out/calls" || exit 1
call calls "$runs"

[ -n "${GYROAKF_SANITIZED_CALLS-}" ] || { echo "$passed passed, $failed failed"; [ $failed -eq 0 ]; exit; }

# newest_sanitized NAME: the newest object of that name that was built with the address sanitizer
newest_sanitized() {
  find build/gfortran_* -name "$1" -printf '%T@ %p\n' 2>/dev/null | sort -rn | cut -d ' ' -f 2- |
    while read -r object; do
      if nm "$object" | grep -q __asan_; then echo "$object"; break; fi
    done
}
sanitized=$(newest_sanitized src_gyroakf_c_api_c_support.f90.o)
sanitized=${sanitized%/*}
host=$(newest_sanitized src_gyroakf_c_api_host.c.o)       # fpm keeps the objects of C apart
if [ -n "$sanitized" ] && [ -n "$host" ]; then
  echo "sanitized objects of $sanitized"
  checks=(-fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer)
  gcc -std=c99 -g -O1 "${checks[@]}" -Ic_api/include -Ic_api/test -c c_api/fuzz/calls.c -o "$out/sanitized.o" &&
    gfortran -fopenmp "${checks[@]}" "$out/sanitized.o" "$sanitized"/src_*.f90.o "${host%/*}"/src_*.c.o -llapack -lblas -lz -o "$out/sanitized" || exit 1
  export ASAN_OPTIONS=allocator_may_return_null=1:quarantine_size_mb=16:detect_stack_use_after_return=0
  export LSAN_OPTIONS=suppressions=$PWD/ci/lsan.supp:print_suppressions=0 UBSAN_OPTIONS=print_stacktrace=1
  call sanitized $((runs / 10))
fi

echo "$passed passed, $failed failed"
[ $failed -eq 0 ]
