#!/bin/sh
# SPDX-License-Identifier: MIT
# Writing a record of one channel as text with the shortest digits, for NumPy and as bare numbers, against pandas and NumPy.
#
#   ./run.sh [SAMPLES...]         default: 5000000
set -eu
cd "$(dirname "$0")"
[ $# -gt 0 ] || set -- 5000000
mkdir -p build
python=$(../peers.sh numpy pandas)
program=$(../program.sh write)
for samples; do
  "$python" compare.py "$program" "$samples"
done
