#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The build by CMake, shared and static, its tests, and programs outside that use what it installs:
#
#   GYROAKF_CMAKE=1 ci/cmake.sh [BUILD-TYPE]     BUILD-TYPE Quick (-O1, if none is given), Release, Debug, ...
#   GYROAKF_CMAKE=1 ci/cmake.sh --only TARGET    builds this, shared, and no more
#
# GYROAKF_CMAKE=1 lets setup.sh install CMake, Ninja and pkg-config where they are missing. Builds stay in build/cmake for the
# next time. The suites that take long, and FORTRAN 77, run in other steps. The last line is "N passed, N failed".
set -u
cd "$(dirname "$0")/.." || exit 1
root=$PWD
type=${1:-Quick}
only=
if [ "$type" = --only ]; then type=Quick only=$2; fi
unset DESTDIR CFLAGS FFLAGS LDFLAGS CMAKE_GENERATOR CMAKE_BUILD_TYPE CMAKE_PREFIX_PATH PKG_CONFIG_PATH PKG_CONFIG_SYSROOT_DIR
unset PKG_CONFIG_LIBDIR
export CC=gcc FC=gfortran
./setup.sh true || exit 1
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

ok() { # NAME COMMAND...: counts it; what it says is shown where it fails
  local name=$1
  shift
  if "$@" >"$work/said" 2>&1; then
    passed=$((passed + 1))
    echo "ok: $name"
  else
    failed=$((failed + 1))
    echo "FAILED: $name"
    tail -n 40 "$work/said"
    false
  fi
}

same() { # EXPECTED-FILE COMMAND...: its standard output is the file
  local file=$1
  shift
  "$@" >"$work/out" && diff "$file" "$work/out"
}

finish() {
  echo "$passed passed, $failed failed"
  [ "$failed" -eq 0 ]
  exit
}

build() { # FOLDER OPTIONS...
  local folder=build/cmake/$1
  shift
  # a build that a tree in another place has left here is of no use
  if [ -f "$folder/CMakeCache.txt" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "$folder/CMakeCache.txt"; then
    rm -rf "$folder"
  fi
  cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE="$type" -DCMAKE_Fortran_FLAGS_QUICK="-O1 -g1" \
    -DCMAKE_C_FLAGS_QUICK="-O1 -g" "$@" || return
  # shellcheck disable=SC2086  # targets are split
  cmake --build "$folder" ${only:+--target $only}
}

suites() { # the quick ones, by ctest, whose counts are added
  ctest --test-dir build/cmake/shared --output-on-failure -LE 'slow|cli|f77' -j 2 >"$work/ctest" 2>&1
  ctest --test-dir build/cmake/shared --output-on-failure -R '^cli.usage$' >>"$work/ctest" 2>&1
  grep -aE '\*\*\*|FAILED|tests passed' "$work/ctest" | head -n 60
  local bad of
  while read -r bad of; do
    passed=$((passed + of - bad))
    failed=$((failed + bad))
  done < <(sed -nE 's/.*tests passed, ([0-9]+) tests? failed out of ([0-9]+).*/\1 \2/p' "$work/ctest")
}

one_thread() {
  ! nm -D build/cmake/alone/libgyroakf.so | grep -E 'omp_|GOMP'
}

alike() { # the same document of both builds, but for what tells of the run
  local kind
  for kind in shared alone; do
    OMP_NUM_THREADS=1 "build/cmake/$kind/gyroakf" allan example/data/mems_gyro_x.txt --json - --quiet >"$work/$kind.json" || return
  done
  cmp "$work/shared.json" "$work/alone.json"
}

version() { sed -n 's/^version *= *"\(.*\)"/\1/p' fpm.toml; }

consumers() { # KIND: programs against the library that is installed in $work/KIND
  local kind=$1 prefix=$work/$1 flags loader_path=${LD_LIBRARY_PATH:-}
  PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name gyroakf.pc)")
  LD_LIBRARY_PATH=${PKG_CONFIG_PATH%/pkgconfig}${loader_path:+:$loader_path}
  export PKG_CONFIG_PATH LD_LIBRARY_PATH
  ok "$kind: pkg-config tells the version of fpm.toml" test "$(pkg-config --modversion gyroakf)" = "$(version)"
  flags=$(pkg-config --cflags --libs gyroakf)
  # shellcheck disable=SC2086  # flags are split
  ok "$kind: a C program by pkg-config" gcc -std=c99 c_api/consumer/main.c $flags -o "$prefix/main" &&
    ok "$kind: it runs" same c_api/consumer/output.txt "$prefix/main"
  if command -v g++ >/dev/null; then
    # shellcheck disable=SC2086
    ok "$kind: a C++ program by pkg-config" g++ -std=c++11 c_api/cpp/owner.cpp $flags -o "$prefix/owner" &&
      ok "$kind: it runs" "$prefix/owner" example/data/mems_gyro_x.txt
  fi
  # shellcheck disable=SC2086
  ok "$kind: a Fortran program by pkg-config" gfortran example/consumer/app/main.f90 -J"$prefix" $flags -o "$prefix/fortran" &&
    ok "$kind: it runs" same example/consumer/output.txt "$prefix/fortran"
  ok "$kind: a C project by CMake" cmake -S c_api/consumer -B "$work/$kind-consumer" -G Ninja -DCMAKE_PREFIX_PATH="$prefix" &&
    ok "$kind: it builds" cmake --build "$work/$kind-consumer" &&
    ok "$kind: it runs" same c_api/consumer/output.txt "$work/$kind-consumer/consumer"
  LD_LIBRARY_PATH=$loader_path # the program finds the library by itself
  ok "$kind: the program runs where it is installed" test "$("$prefix/bin/gyroakf" --version)" = "gyroakf $(version)"
}

if [ -n "$only" ]; then
  build shared >"$work/said" 2>&1 || { tail -n 40 "$work/said"; exit 1; }
  exit 0
fi
ok "shared: build" build shared || finish
suites
ok "shared: install" cmake --install build/cmake/shared --prefix "$work/shared" && consumers shared
only="gyroakf_program test_c_api"
ok "one thread: build" build alone -DGYROAKF_OPENMP=OFF || finish
only=
ok "one thread: nothing of OpenMP is needed" one_thread
ok "one thread: the C tests" build/cmake/alone/test/test_c_api
ok "one thread: the numbers of the build with OpenMP" alike
ok "static: build" build static -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF || finish
ok "static: install" cmake --install build/cmake/static --prefix "$work/static" && consumers static
finish
