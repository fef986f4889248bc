#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# C++: gyroakf.hpp alone and with its tests as C++17 and C++20, by every compiler there is, and the example with the output that
# c_api/README.md shows.
#
#   ci/cpp.sh [LIBRARY]           libgyroakf.a or .so; default: fpm's, installed into build/cpp
#
# Where there is no C++ compiler it says so and counts nothing. The last line is "N passed, N failed".
set -u
cd "$(dirname "$0")/.." || exit 1
out=build/cpp
mkdir -p "$out"
compilers=$(for c in g++ clang++; do command -v $c; done)
if [ -z "$compilers" ]; then
  echo "skipped: there is no C++ compiler (g++, clang++)"
  echo "0 passed, 0 failed"
  exit 0
fi
library=${1-}
if [ -z "$library" ]; then
  ./setup.sh fpm install --prefix "$out" >/dev/null || exit 1
  library=$out/lib/libgyroakf.a
fi
case $library in *.so*) LD_LIBRARY_PATH=$(dirname "$library")${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}; export LD_LIBRARY_PATH ;; esac
strict="-O1 -Wall -Wextra -Wshadow -pedantic -Werror -Ic_api/include"
passed=0
failed=0
result() { # NAME CODE
  if [ "$2" -eq 0 ]; then passed=$((passed + 1)); else failed=$((failed + 1)); echo "FAILED: $1"; fi
}

program() { # COMPILER STANDARD SOURCE PROGRAM: gfortran links, as it knows where its libraries are
  # shellcheck disable=SC2086  # flags are split
  "$1" -std="$2" $strict -c "$3" -o "$4.o" && gfortran -fopenmp "$4.o" "$library" -llapack -lblas -lstdc++ -o "$4"
}

for compiler in $compilers; do
  for standard in c++17 c++20; do
    echo '#include <gyroakf.hpp>' >"$out/alone.cpp"
    # shellcheck disable=SC2086
    "$compiler" -std=$standard $strict -fsyntax-only "$out/alone.cpp"
    result "gyroakf.hpp alone, $compiler $standard" $?
    rm -f "$out/test_cpp"
    program "$compiler" $standard c_api/cpp/test_cpp.cpp "$out/test_cpp"
    result "the tests compile, $compiler $standard" $?
    # sums of several threads may differ in the last bit
    sums=$(OMP_NUM_THREADS=1 "$out/test_cpp")
    result "the tests pass, $compiler $standard" $?
    grep -v ' passed, ' <<<"$sums"
    read -r more worse < <(sed -nE 's/^([0-9]+) passed, ([0-9]+) failed$/\1 \2/p' <<<"$sums")
    passed=$((passed + ${more:-0}))
    failed=$((failed + ${worse:-1}))
  done
done

compiler=$(head -n 1 <<<"$compilers")
program "$compiler" c++17 c_api/cpp/batch.cpp "$out/batch"
result "batch.cpp compiles" $?
[ "$(wc -l <c_api/cpp/batch.cpp)" -lt 100 ]
result "batch.cpp has less than 100 lines" $?
{ printf '# rate_hz: 5\n# unit: deg/s\n# columns: first,second\n'
  awk '!/^#/ { if (++n <= 6000) x[n] = $1; else print x[n - 6000] "," $1 }' example/data/mems_gyro_x.txt
} >"$out/halves.txt"
"$out/batch" example/data/mems_gyro_x.txt "$out/halves.txt" | sed "s|$out/halves.txt|halves.txt          |" >"$out/batch.txt"
[ "${PIPESTATUS[0]}" -eq 0 ]
result "batch runs" $?
missing=$(grep -vxFf c_api/README.md "$out/batch.txt")
[ "$(wc -l <"$out/batch.txt")" -eq 4 ] && [ -z "$missing" ]
result "c_api/README.md shows what batch prints: $missing" $?
"$out/batch" no-such-file example/data/mems_gyro_x.txt >"$out/rest.txt" 2>"$out/batch.err"
[ $? -eq 1 ] && grep -q 'no-such-file' "$out/batch.err" && [ "$(wc -l <"$out/rest.txt")" -eq 2 ]
result "batch says which recording is missing, and goes on" $?
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
