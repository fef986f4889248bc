#!/bin/sh
# SPDX-License-Identifier: MIT
# Time and memory of `gyroakf allan` and `gyroakf run` on text of one column against the number of samples, with exponents.
#
#   ./run.sh [LARGEST]            default: 100000000 (1.2 GB of text in build/, removed afterwards)
set -eu
cd "$(dirname "$0")"
mkdir -p build
trap 'rm -f build/white_*.txt' EXIT
python3 measure.py "$(../program.sh gyroakf)" "${1:-100000000}"
