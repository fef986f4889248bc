#!/bin/sh
# SPDX-License-Identifier: MIT
# False alarms and power of the comparison of a record's halves: ./run.sh [RECORDS [SAMPLES]]
set -eu
cd "$(dirname "$0")"
exec ../../setup.sh fpm run allan_halves -- "$@"
