#!/bin/sh
# SPDX-License-Identifier: MIT
# The streamed Allan deviation: how many degrees of freedom it keeps, its time, and the memory of `gyroakf allan --memory`.
#
#   ./run.sh [RECORDS [SAMPLES [LINES]]]     default: 400 records of 100000 samples; a file of 10000000 lines
set -eu
cd "$(dirname "$0")"
../../setup.sh fpm run allan_stream -- "${1:-400}" "${2:-100000}"
lines=${3:-10000000}
root=$(cd ../.. && pwd)
(cd "$root" && ./setup.sh fpm build >/dev/null)
program=$root/$(cd "$root" && ./setup.sh fpm run gyroakf --runner echo 2>/dev/null | tail -n 1)
mkdir -p build
file=build/white_$lines.txt
[ -f "$file" ] || "$program" simulate --samples "$lines" --rate 100 --coefficients N=0.01,K=1e-4 --output "$file"
for memory in 30MB 100MB none; do
  python3 measure.py "$program" "$file" "$memory"
done
