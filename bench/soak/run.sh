#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Does the memory of a process grow over 1,000 files, does kill -9 ever leave half a result?
#
#   ./run.sh [FILES [KILLS]]       default: 1000 200
set -eu
cd "$(dirname "$0")"
root=$(cd ../.. && pwd)
mkdir -p build
(cd "$root" && ./setup.sh fpm install --prefix "$root/bench/soak/build/prefix" >/dev/null 2>&1)
gcc -O2 -I"$root/c_api/include" -c soak.c -o build/soak.o
gcc -fopenmp build/soak.o -Lbuild/prefix/lib -lgyroakf -llapack -lblas -lz -lgfortran -lm -ldl -o build/soak
echo "one process"
build/soak "${1:-1000}" build
echo
echo "kill -9"
./kill.sh build/prefix/bin/gyroakf "${2:-200}"
