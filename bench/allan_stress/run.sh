#!/bin/sh
# SPDX-License-Identifier: MIT
# Deviations under a large offset against quadruple precision: ./run.sh [SAMPLES [OFFSET]], default 10000000 1e6 (a minute)
set -eu
cd "$(dirname "$0")"
exec ../../setup.sh fpm run allan_stress -- "$@"
