#!/bin/sh
# SPDX-License-Identifier: MIT
# Where the time of `gyroakf run` goes: wall time of its stages, taken by the progress interface (app/main.f90); where perf works,
# processor time of the program by folders of src/gyroakf, sampled.
#
#   ./run.sh [SAMPLES]            default: 10000000; and the example
set -eu
cd "$(dirname "$0")"
mkdir -p build
samples=${1:-10000000}
program=$(../program.sh gyroakf)
stages=$(../program.sh profile)
example=../../example/data/mems_gyro_x.txt
file=build/white_$samples.txt
trap 'rm -f "$file" build/perf.data' EXIT
"$program" simulate --samples "$samples" --rate 100 --coefficients N=0.01,K=1e-4 --digits 9 --force --output "$file"
"$stages" "$example" >/dev/null
for recording in "$example" "$file"; do
  echo "$(basename "$recording"), two threads"
  echo "   seconds       %  stage"
  "$stages" "$recording" 2 | tee build/stages
done
for i in 1 2 3 4 5; do "$stages" "$example" 2 | grep 'until the drift'; done | sort -n | sed -n 3p |
  awk '{ printf "figure: gyroakf run, the example: all but the drift (the paper'"'"'s family), s | %.3f | <= 0.1\n", $1 }'
if perf record -q -e cpu-clock -o build/perf.data "$program" run "$file" --quiet --threads 2 >/dev/null 2>&1; then
  echo "processor time by folders of src/gyroakf, %"
  perf report -i build/perf.data --stdio --sort dso,symbol 2>/dev/null | awk '
    /^ +[0-9.]+%/ {
      name = $4
      if (match(name, /^__gyroakf_[a-z0-9]+/)) place = substr(name, 11, RLENGTH - 10)
      else if ($2 ~ /libgomp/) place = "waiting for threads"
      else if ($2 ~ /kernel/) place = "the system"
      else place = $2
      share[place] += $1
    }
    END { for (place in share) if (share[place] >= 0.5) printf "%10.1f  %s\n", share[place], place }' | sort -rn
fi
