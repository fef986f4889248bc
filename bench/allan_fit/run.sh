#!/bin/sh
# SPDX-License-Identifier: MIT
# Monte Carlo tables of the noise fit: ./run.sh [MIX [RECORDS [TAUS [METHOD [TERMS]]]]], MIX a name or all (the default)
set -eu
cd "$(dirname "$0")"
exec ../../setup.sh fpm run allan_fit -- "$@"
