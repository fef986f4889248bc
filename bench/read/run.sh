#!/bin/sh
# SPDX-License-Identifier: MIT
# Reading text of one column, and one of three, against pandas and polars on the same file; and the memory it takes.
#
#   ./run.sh [LINES...]           default: 10000000
#   OMP_NUM_THREADS=1 ./run.sh    this library on one thread (polars: POLARS_MAX_THREADS)
#
# pandas and polars are installed into a virtual environment in build/ here.
set -eu
cd "$(dirname "$0")"
[ $# -gt 0 ] || set -- 10000000
: "${OMP_WAIT_POLICY=passive}" # as setup.sh: waiting threads sleep
export OMP_WAIT_POLICY
mkdir -p build
if [ ! -x build/venv/bin/python3 ] || ! build/venv/bin/python3 -c 'import pandas, polars' 2>/dev/null; then
  python3 -m venv build/venv
  build/venv/bin/pip install -q pandas polars
fi
../../setup.sh fpm build >/dev/null
program=$(../../setup.sh fpm run read_speed --runner echo 2>/dev/null | tail -n 1)
for lines; do
  build/venv/bin/python3 compare.py "$program" "$lines"
done
