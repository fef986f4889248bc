#!/bin/sh
# SPDX-License-Identifier: MIT
# The build that reads HDF5: a package of its own in build/hdf5, with hdf5/hdf5.f90 in the place of the module that refuses.
#
#   GYROAKF_HDF5=1 ci/hdf5.sh          builds it and runs its tests; the program's path is the last line
#   GYROAKF_HDF5=1 ci/hdf5.sh install  puts the program into ~/.local/bin
#
# GYROAKF_HDF5=1 lets setup.sh install the library where it is missing.
set -eu
cd "$(dirname "$0")/.."
package=build/hdf5
mkdir -p $package
rm -rf $package/src $package/app $package/test
cp -R src app $package/
cp hdf5/hdf5.f90 $package/src/gyroakf/io/hdf5.f90
mkdir $package/test
cp hdf5/test/*.f90 test/scratch_file.f90 $package/test/
# the manifest without what belongs to the other tests and examples
awk 'BEGIN { keep = 1 } /^\[/ { keep = !/^\[\[/ && !/^\[dev-dependencies\]/ && !/^\[extra/ } /include-dir/ { next } keep
   /^\[dependencies\]/ { print "hdf5 = \"*\"" }
   END { print "[dev-dependencies]\ntest-drive.path = \"../../ci/test-drive\"" }' fpm.toml >$package/fpm.toml
./setup.sh true
cd $package
if [ "${1:-}" = install ]; then
  exec ../../setup.sh fpm install
fi
../../setup.sh fpm test
../../setup.sh fpm build
echo "$package/$(../../setup.sh fpm run gyroakf --runner echo 2>/dev/null | tail -n 1)"
