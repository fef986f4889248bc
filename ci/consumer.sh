#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# A package outside that has gyroakf as a dependency of fpm: example/consumer is built, run, and its output compared.
# The last line is "N passed, N failed".
set -u
cd "$(dirname "$0")/.." || exit 1
# not optimized: it is about what builds and links
export FPM_FFLAGS="-O0 -ffp-contract=off -fPIC" FPM_CFLAGS="-O0 -fPIC"
./setup.sh true || exit 1
cd example/consumer || exit 1
rm -rf build # fpm would keep the objects of sources that are gone
if ! ../../setup.sh fpm build; then
  echo "0 passed, 2 failed"
  exit 1
fi
program=$(../../setup.sh fpm run --runner echo 2>/dev/null | tail -n 1)
if "$program" | diff output.txt -; then
  echo "2 passed, 0 failed"
else
  echo "1 passed, 1 failed"
  exit 1
fi
