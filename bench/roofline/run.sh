#!/bin/sh
# SPDX-License-Identifier: MIT
# What the Allan kernel and the text parser move, beside what the memory gives in the same run (app/main.f90 says what is counted).
#
#   ./run.sh [SAMPLES]            default: 50000000, and as text a tenth of them
set -eu
cd "$(dirname "$0")"
mkdir -p build
samples=${1:-50000000}
file=build/white.txt
trap 'rm -f "$file"' EXIT
"$(../program.sh gyroakf)" simulate --samples $((samples / 10)) --rate 100 --coefficients N=0.01 --digits 9 --force --output "$file"
"$(../program.sh roofline)" "$samples" "$file"
