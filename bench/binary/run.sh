#!/bin/sh
# SPDX-License-Identifier: MIT
# Reading binary numbers, against numpy on the same files in the same run.
#
#   ./run.sh [SAMPLES]           default: 10000000
#
# Columns: seconds until the rows are in memory, until the record is made and looked at (range, step, missing samples), and
# what numpy takes to have doubles in memory; memory per sample held.  numpy is installed into a virtual environment here.
set -eu
cd "$(dirname "$0")"
mkdir -p build
if [ ! -x build/venv/bin/python3 ] || ! build/venv/bin/python3 -c 'import numpy' 2>/dev/null; then
  python3 -m venv build/venv
  build/venv/bin/pip install -q numpy
fi
../../setup.sh fpm build >/dev/null
program=$(../../setup.sh fpm run binary_speed --runner echo 2>/dev/null | tail -n 1)
build/venv/bin/python3 compare.py "$program" "${1:-10000000}"
