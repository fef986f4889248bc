#!/bin/sh
# SPDX-License-Identifier: MIT
# Memory of the commands: peak of the process and bytes a sample, for simulated one-column records.
#
#   ./run.sh [SAMPLES...]         default: 1000000 10000000
set -eu
cd "$(dirname "$0")"
[ $# -gt 0 ] || set -- 1000000 10000000
program=$(../program.sh gyroakf)
mkdir -p build
[ -f build/small.txt ] || "$program" simulate --samples 1000 --rate 100 --coefficients N=0.01,K=1e-4 --output build/small.txt
for samples; do
  file=build/white_$samples.txt
  [ -f "$file" ] || "$program" simulate --samples "$samples" --rate 100 --coefficients N=0.01,K=1e-4 --output "$file"
  python3 measure.py "$program" "$file" "$samples" build/small.txt
done
