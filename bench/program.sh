#!/bin/sh
# SPDX-License-Identifier: MIT
# The path of a program of bench/, built against the library as fpm builds and installs it, into bench/build:
#
#   bench/program.sh NAME           bench/NAME/app/main.f90; gyroakf: the program itself
#   GYROAKF_PREFIX=DIR ...          against another installation of it (DIR/bin, DIR/lib, DIR/include)
set -eu
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$here/build/modules"
prefix=${GYROAKF_PREFIX:-}
if [ -z "$prefix" ]; then
  prefix=$here/build/prefix
  (cd "$here/.." && ./setup.sh fpm install --prefix "$prefix") >"$here/build/log" 2>&1 || { cat "$here/build/log" >&2; exit 1; }
fi
if [ "$1" = gyroakf ]; then
  echo "$prefix/bin/gyroakf"
  exit
fi
program=$here/build/$1
if [ ! "$program" -nt "$prefix/lib/libgyroakf.a" ] || [ ! "$program" -nt "$here/$1/app/main.f90" ]; then
  gfortran -O3 -march=native -ffp-contract=off -fopenmp -I"$prefix/include" -J"$here/build/modules" "$here/$1/app/main.f90" \
    -o "$program" -L"$prefix/lib" -lgyroakf -llapack -lblas -lz
fi
echo "$program"
