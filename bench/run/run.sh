#!/bin/sh
# SPDX-License-Identifier: MIT
# The whole job: wall time and memory of `gyroakf run` as a process, for the example and for simulated records.
#
#   ./run.sh [SAMPLES...]         default: 1000000
set -eu
cd "$(dirname "$0")"
[ $# -gt 0 ] || set -- 1000000
root=$(cd ../.. && pwd)
(cd "$root" && ./setup.sh fpm build >/dev/null)
program=$(cd "$root" && ./setup.sh fpm run gyroakf --runner echo 2>/dev/null | tail -n 1)
mkdir -p build
python3 measure.py "$root/$program" "$root/example/data/mems_gyro_x.txt"
for samples; do
  file=build/white_$samples.txt
  [ -f "$file" ] || "$root/$program" simulate --samples "$samples" --rate 100 --coefficients N=0.01,K=1e-4 --output "$file"
  python3 measure.py "$root/$program" "$file"
done
