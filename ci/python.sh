#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tests of the Python package on what fpm built: the shared library is linked from fpm's archive,
# the program is fpm's. The wheel is built and tested by ci/wheel.sh.
#
#   ci/python.sh
#
# The last line is "N passed, N failed".
set -u
cd "$(dirname "$0")/.." || exit 1
# shellcheck source=ci/python_venv.sh
. ci/python_venv.sh
out=$PWD/build/python-quick
rm -rf "$out/gyroakf"
mkdir -p "$out"
./setup.sh fpm install --prefix "$out" >"$out/log" 2>&1 || { tail -n 20 "$out/log"; exit 1; }
cp -R python/gyroakf "$out/gyroakf"
cp c_api/include/gyroakf.h "$out/bin/gyroakf" "$out/gyroakf/"
gcc -shared -fopenmp -Wl,--whole-archive "$out/lib/libgyroakf.a" -Wl,--no-whole-archive \
  -llapack -lblas -lz -lgfortran -lm \
  -o "$out/gyroakf/libgyroakf.so" || exit 1
venv "$out/venv" numpy pytest hypothesis
PYTHONPATH=$out tests "$out/venv"
