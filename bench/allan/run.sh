#!/bin/sh
# SPDX-License-Identifier: MIT
# Allan statistics, octave averaging times, against allantools 2024.6 on the same numbers.
#
#   ./run.sh [SAMPLES...]         default: 1000000 10000000
#   KINDS='oadev mdev' ./run.sh   default: oadev mdev ohdev totdev
#
# allantools is installed into a virtual environment in build/ here.
set -eu
cd "$(dirname "$0")"
[ $# -gt 0 ] || set -- 1000000 10000000
: "${KINDS:=oadev mdev ohdev totdev}"
mkdir -p build
if [ ! -x build/venv/bin/python3 ]; then
  python3 -m venv build/venv
  build/venv/bin/pip install -q 'allantools==2024.6'
fi
../../setup.sh fpm build >/dev/null
program=$(../../setup.sh fpm run allan_speed --runner echo 2>/dev/null | tail -n 1)
for samples; do
  # shellcheck disable=SC2086  # a list of words
  build/venv/bin/python3 compare.py "$program" "$samples" $KINDS
done
