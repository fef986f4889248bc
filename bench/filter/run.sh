#!/bin/sh
# SPDX-License-Identifier: MIT
# Processor time of a filter step on one core: of the library, from Fortran and from C, and of filterpy and statsmodels (in a private
# environment, made on first use) in the same run: ./run.sh
set -eu
cd "$(dirname "$0")"
root=$(cd ../.. && pwd)
venv=${XDG_CACHE_HOME:-$HOME/.cache}/gyroakf/bench-filter
if ! "$venv/bin/python" -c "import filterpy, statsmodels" 2>/dev/null; then
  python3 -m venv "$venv"
  "$venv/bin/pip" install --quiet numpy scipy matplotlib setuptools wheel 'statsmodels==0.15.0'
  "$venv/bin/pip" install --quiet --no-build-isolation filterpy==1.4.5
fi
mkdir -p build
(cd "$root" && ./setup.sh fpm install --prefix "$root/bench/filter/build/prefix" >/dev/null 2>&1)
gcc -O2 -I"$root/c_api/include" -c c/step.c -o build/step.o
gcc -fopenmp build/step.o -Lbuild/prefix/lib -lgyroakf -llapack -lblas -lgfortran -lm -ldl -o build/step
{
  echo "ns a step"
  ../../setup.sh fpm run bench_filter 2>/dev/null | grep -E 'median|[0-9]\.[0-9]'
  build/step
  OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 "$venv/bin/python" compare.py
} | tee build/lines
awk '
  /^Fortran/ { from = "run" } /^C, step/ { from = "step" }
  /^Kalman +[0-9]/ { ours[from] = $2 }
  /^filterpy/ { theirs["step"] = $5 }
  /^statsmodels/ { theirs["run"] = $4 }
  END {
    printf "filterpy over gyroakf, step by step    %9.0f\n", theirs["step"]/ours["step"]
    printf "statsmodels over gyroakf, a series     %9.0f\n", theirs["run"]/ours["run"]
  }' build/lines
