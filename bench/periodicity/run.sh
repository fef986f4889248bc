#!/bin/sh
# SPDX-License-Identifier: MIT
# False alarms of spectral lines, errors of their frequency and amplitude, seconds at 1e7 samples: ./run.sh [RECORDS [SAMPLES]]
set -eu
cd "$(dirname "$0")"
exec ../../setup.sh fpm run periodicity -- "$@"
