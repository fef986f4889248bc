#!/bin/sh
# SPDX-License-Identifier: MIT
# Reading one-column text, against pandas and polars on the same file.
#
#   ./run.sh [LINES...]           default: 1000000
#
# pandas and polars are installed into a virtual environment in build/ here.
set -eu
cd "$(dirname "$0")"
[ $# -gt 0 ] || set -- 1000000
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
