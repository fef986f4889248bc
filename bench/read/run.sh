#!/bin/sh
# SPDX-License-Identifier: MIT
# Reading text of one column, and one of three, against pandas and polars on the same file; and the memory it takes.
#
#   ./run.sh [LINES...]           default: 10000000
#   OMP_NUM_THREADS=1 ./run.sh    this library on one thread (polars: POLARS_MAX_THREADS)
set -eu
cd "$(dirname "$0")"
[ $# -gt 0 ] || set -- 10000000
: "${OMP_WAIT_POLICY=passive}" # as setup.sh: waiting threads sleep
export OMP_WAIT_POLICY
mkdir -p build
python=$(../peers.sh numpy pandas polars)
program=$(../program.sh read)
for lines; do
  "$python" compare.py "$program" "$lines"
done
