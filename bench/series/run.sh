#!/bin/sh
# SPDX-License-Identifier: MIT
# Statistics of a series, here and in statsmodels (in a private environment, made on first use), on the same numbers in one run:
#
#   ./run.sh [PART...]              parts: see compare.py; default: all
#   THREADS='1 2' ./run.sh adf
set -eu
cd "$(dirname "$0")"
: "${THREADS:=1 2}"
python=$(../peers.sh numpy scipy statsmodels)
program=$(../program.sh series)
mkdir -p build
OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 "$python" compare.py "$program" "$THREADS" "$@"
