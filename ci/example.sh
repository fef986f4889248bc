#!/bin/sh
# SPDX-License-Identifier: MIT
# Runs an example; what it prints is compared with example/output/NAME.txt where there is such a file:
#
#   fpm run --example --all --runner ci/example.sh
#   ci/example.sh --write PROGRAM      writes the file anew
set -u
output=$(CDPATH='' cd -- "$(dirname -- "$0")/.." && pwd)/example/output
if [ "$1" = --write ]; then "$2" >"$output/$(basename "$2").txt"; exit; fi
expected=$output/$(basename "$1").txt
said=$("$@") || exit
printf '%s\n' "$said"
[ ! -f "$expected" ] || printf '%s\n' "$said" | diff "$expected" - || { echo "$(basename "$1"): not as in $expected"; exit 1; }
