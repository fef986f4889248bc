#!/bin/sh
# SPDX-License-Identifier: MIT
# Monte Carlo table of the noise fit: ./run.sh [CASE [RECORDS [SEED]]], CASE a name or all (the default)
set -eu
cd "$(dirname "$0")"
exec ../../setup.sh fpm run allan_fit -- "$@"
