#!/bin/sh
# SPDX-License-Identifier: MIT
# Monte Carlo table of the degrees of freedom of every kind of deviation, without and with missing samples:
#   ./run.sh [RECORDS [SAMPLES [Q N B K R [LOST [GAP]]]]]
set -eu
cd "$(dirname "$0")"
exec ../../setup.sh fpm run allan_edf -- "$@"
