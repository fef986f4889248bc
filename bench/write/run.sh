#!/bin/sh
# SPDX-License-Identifier: MIT
# Writing a record of one channel as text with the shortest digits, for NumPy and as bare numbers, against pandas and NumPy.
#
#   ./run.sh [SAMPLES...]         default: 5000000
#
# pandas is installed into a virtual environment in build/ here.
set -eu
cd "$(dirname "$0")"
[ $# -gt 0 ] || set -- 5000000
mkdir -p build
if [ ! -x build/venv/bin/python3 ] || ! build/venv/bin/python3 -c 'import pandas' 2>/dev/null; then
  python3 -m venv build/venv
  build/venv/bin/pip install -q pandas
fi
../../setup.sh fpm build >/dev/null
program=$(../../setup.sh fpm run write_speed --runner echo 2>/dev/null | tail -n 1)
for samples; do
  build/venv/bin/python3 compare.py "$program" "$samples"
done
