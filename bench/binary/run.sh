#!/bin/sh
# SPDX-License-Identifier: MIT
# Reading binary numbers, against numpy on the same files in the same run.
#
#   ./run.sh [SAMPLES]           default: 10000000
#
# Columns: seconds until the rows are in memory, until the record is made and looked at (range, step, missing samples), and
# what numpy takes to have doubles in memory; memory per sample held.
set -eu
cd "$(dirname "$0")"
mkdir -p build
python=$(../peers.sh numpy)
program=$(../program.sh binary)
"$python" compare.py "$program" "${1:-10000000}"
