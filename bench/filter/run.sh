#!/bin/sh
# SPDX-License-Identifier: MIT
# Processor time of a filter step on one core: of the library, from Fortran and from C, and of filterpy and statsmodels (in a private
# environment, made on first use) in the same run: ./run.sh
set -eu
cd "$(dirname "$0")"
mkdir -p build
python=$(../peers.sh numpy filterpy statsmodels)
program=$(../program.sh filter)
library=$(dirname "$(dirname "$(../program.sh gyroakf)")")/lib
gcc -O2 -I../../c_api/include -I../../ci/realtime -c c/step.c -o build/step.o
gcc -fopenmp build/step.o -L"$library" -lgyroakf -llapack -lblas -lz -lgfortran -lm -ldl -o build/step
{
  echo "ns a step"
  "$program"
  build/step
  OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 "$python" compare.py
} | tee build/lines
awk '
  function figure(what, value, target) { printf "figure: a filter step, ns: %s | %s | %s\n", what, value, target }
  /^Fortran/ { from = "a series" } /^C, step/ { from = "step by step from C" }
  /^Kalman +[0-9]/ { ours[from] = $2; figure("Kalman, " from, $2, from == "a series" ? "<= 8" : "<= 25") }
  /^Sage-Husa Q R +[0-9]/ { figure("Sage-Husa Q R, " from, $4, from == "a series" ? "<= 15" : "<= 25") }
  /^Sage-Husa (Q )?R, Huber/ {
    name = $0; sub(/ +[0-9].*/, "", name); value = substr($0, 31) + 0
    figure(name ", " from, value, from == "a series" ? "<= 20" : "<= 25")
  }
  /^filterpy/ { theirs["step"] = $5 }
  /^statsmodels/ { theirs["run"] = $4 }
  END {
    printf "filterpy over gyroakf, step by step    %9.0f\n", theirs["step"]/ours["step by step from C"]
    printf "statsmodels over gyroakf, a series     %9.0f\n", theirs["run"]/ours["a series"]
    figure("filterpy over this library, step by step", int(theirs["step"]/ours["step by step from C"]), "-")
    figure("statsmodels over this library, a series", int(theirs["run"]/ours["a series"]), "-")
  }' build/lines
