#!/bin/sh
# SPDX-License-Identifier: MIT
# Coefficients of real recordings beside expected figures. Runs `gyroakf allan` with its defaults on every recording of
# recordings.csv found by its file name below DIR, for example in clones of the repositories named there:
#
#   ./run.sh DIR [GYROAKF]          GYROAKF: the program (default: built by ../program.sh)
#   CONVERTED=FOLDER ./run.sh DIR   keep converted recordings in FOLDER and use them again
set -eu
if [ ! -d "${1:-}" ]; then
  echo "usage: $0 DIR [GYROAKF]" >&2
  exit 2
fi
here=$(cd "$(dirname "$0")" && pwd)
program=${2:-$("$here/../program.sh" gyroakf)}
converted=${CONVERTED:-}
if [ -z "$converted" ]; then
  converted=$(mktemp -d)
  trap 'rm -rf "$converted"' EXIT
fi
if find "$1" -name '*.rda' | grep -q .; then
  python=$("$here/../peers.sh" rdata)
  "$python" -B "$here/convert.py" "$here/recordings.csv" "$1" "$converted"
fi
python3 -B "$here/compare.py" "$here/recordings.csv" "$1" "$converted" "$program"
