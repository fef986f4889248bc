#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Which share of the lines of src/ the tests run:   GYROAKF_CMAKE=1 ci/coverage.sh [OBJECTS]
#
# Builds the library with gcov's counters, runs the Fortran suites and the C tests, and prints the modules with the smallest shares
# and the sum. OBJECTS: a directory with counters of another build; nothing is built or run then. SHOWN=50: so many modules. Not a
# step of CI: it takes as long as all tests without optimization.
set -u
cd "$(dirname "$0")/.." || exit 1
objects=${1:-build/coverage}
if [ $# -eq 0 ]; then
   ./setup.sh true || exit 1
   cmake -S . -B "$objects" -G Ninja -DCMAKE_BUILD_TYPE=None -DGYROAKF_COVERAGE=ON -DBUILD_SHARED_LIBS=OFF >/dev/null || exit 1
   cmake --build "$objects" --target test_main test_c_api >"$objects/build.log" || { tail "$objects/build.log"; exit 1; }
   find "$objects" -name '*.gcda' -delete
   # of threads that share counters each waits for the other, and some counts are lost
   OMP_NUM_THREADS=1 ctest --test-dir "$objects" -L '^(fortran|c)$' --output-on-failure || exit 1
fi
objects=$(cd "$objects" && pwd) || exit 1

# of every object: File 'src/x.f90', then Lines executed:97.50% of 40
counts=$(find "$objects" -path '*/src/*' -name '*.gcno' -exec gcov --no-output {} + 2>/dev/null | awk -v here="$PWD/" '
   /^File / { file = substr($0, 7, length($0) - 7); if (index(file, here) == 1) file = substr(file, length(here) + 1); next }
   /^Lines executed:/ && file ~ /^src\// {
      split($0, part, /[:% ]+/)
      if (!(file in lines)) { lines[file] = part[5]; run[file] = part[3]*part[5]/100 }
   }
   END { for (file in lines) printf "%s %d %.0f\n", file, lines[file], run[file] }')
[ -n "$counts" ] || { echo "no counters in $objects"; exit 1; }
awk '{ printf "%6.1f %% of %4d lines  %s\n", 100*$3/$2, $2, $1 }' <<<"$counts" | sort -n | head -n "${SHOWN:-15}"
awk '{ lines += $2; run += $3 } END { printf "%d of %d lines of %d files of src/ were run: %.1f %%\n", run, lines, NR, 100*run/lines }' \
   <<<"$counts"
