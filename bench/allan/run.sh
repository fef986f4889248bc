#!/bin/sh
# SPDX-License-Identifier: MIT
# Overlapping Allan deviation, octave averaging times, against allantools 2024.6 on the same numbers.
#
#   ./run.sh [SAMPLES...]         default: 1000000 10000000
#
# allantools is installed into a virtual environment in build/ here.
set -eu
cd "$(dirname "$0")"
[ $# -gt 0 ] || set -- 1000000 10000000
mkdir -p build
if [ ! -x build/venv/bin/python3 ]; then
  python3 -m venv build/venv
  build/venv/bin/pip install -q 'allantools==2024.6'
fi
../../setup.sh fpm build >/dev/null
program=$(../../setup.sh fpm run allan_speed --runner echo 2>/dev/null | tail -n 1)
for samples; do
  build/venv/bin/python3 compare.py "$program" "$samples"
done
