#!/bin/sh
# SPDX-License-Identifier: MIT
# Allan statistics, octave averaging times, against allantools on the same numbers, in turn.
#
#   ./run.sh [SAMPLES...]         default: 1000000 10000000
#   KINDS='oadev mdev' ./run.sh   default: oadev mdev ohdev totdev
#   ROUNDS=0 ./run.sh 100000000   without allantools; default: 5 times each
set -eu
cd "$(dirname "$0")"
[ $# -gt 0 ] || set -- 1000000 10000000
: "${KINDS:=oadev mdev ohdev totdev}" "${ROUNDS:=5}"
mkdir -p build
python=$(../peers.sh allantools)
program=$(../program.sh allan)
for samples; do
  # shellcheck disable=SC2086  # a list of words
  "$python" compare.py "$program" "$samples" "$ROUNDS" $KINDS
done
