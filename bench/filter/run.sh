#!/bin/sh
# SPDX-License-Identifier: MIT
# Time of a filter step, here and in filterpy (in a private environment, made on first use): ./run.sh
set -eu
cd "$(dirname "$0")"
venv=${XDG_CACHE_HOME:-$HOME/.cache}/gyroakf/bench-filter
if [ ! -x "$venv/bin/python" ] || ! "$venv/bin/python" -c "import filterpy" 2>/dev/null; then
  python3 -m venv "$venv"
  "$venv/bin/pip" install --quiet numpy scipy matplotlib setuptools wheel
  "$venv/bin/pip" install --quiet --no-build-isolation filterpy==1.4.5
fi
mkdir -p build
echo "                      ns a step   median  fastest"
../../setup.sh fpm run bench_filter 2>/dev/null | grep -E '[0-9]\.[0-9]' | tee build/lines
theirs=$("$venv/bin/python" filterpy_step.py)
ours=$(sed -nE 's/^ *Kalman, scalar +([0-9.]+).*/\1/p' build/lines)
printf '%28s%9s\n' "filterpy, scalar" "$theirs"
awk -v a="$theirs" -v b="$ours" 'BEGIN { printf "%28s%9.0f\n", "filterpy over gyroakf", a/b }'
