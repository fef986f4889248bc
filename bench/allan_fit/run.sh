#!/bin/sh
# SPDX-License-Identifier: MIT
# Monte Carlo table of the noise fit: ./run.sh [RECORDS [SAMPLES [N B K R [TERMS [TAUS [METHOD]]]]]]
set -eu
cd "$(dirname "$0")"
exec ../../setup.sh fpm run allan_fit -- "$@"
