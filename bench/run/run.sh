#!/bin/sh
# SPDX-License-Identifier: MIT
# The whole job: wall time and memory of `gyroakf run` as a process, for the example and for simulated records.
#
#   ./run.sh [SAMPLES...]         default: 1000000
set -eu
cd "$(dirname "$0")"
[ $# -gt 0 ] || set -- 1000000
program=$(../program.sh gyroakf)
mkdir -p build
python3 measure.py "$program" "../../example/data/mems_gyro_x.txt"
for samples; do
  file=build/white_$samples.txt
  [ -f "$file" ] || "$program" simulate --samples "$samples" --rate 100 --coefficients N=0.01,K=1e-4 --output "$file"
  python3 measure.py "$program" "$file"
done
