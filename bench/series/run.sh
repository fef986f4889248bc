#!/bin/sh
# SPDX-License-Identifier: MIT
# Statistics of a series, here and in statsmodels (in a private environment, made on first use), on the same numbers in one run:
#
#   ./run.sh [PART...]              parts: see compare.py; default: all
#   THREADS='1 2' ./run.sh adf
set -eu
cd "$(dirname "$0")"
: "${THREADS:=1 2}"
venv=${XDG_CACHE_HOME:-$HOME/.cache}/gyroakf/bench-series
if ! "$venv/bin/python" -c "import statsmodels" 2>/dev/null; then
  python3 -m venv "$venv"
  "$venv/bin/pip" install --quiet numpy scipy 'statsmodels==0.15.0'
fi
mkdir -p build
../../setup.sh fpm build >/dev/null
program=$(../../setup.sh fpm run bench_series --runner echo 2>/dev/null | tail -n 1)
OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 "$venv/bin/python" compare.py "$program" "$THREADS" "$@"
