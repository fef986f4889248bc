#!/bin/sh
# SPDX-License-Identifier: MIT
# Monte Carlo table of the verdict on drift: ./run.sh [CASE [RECORDS [SEED]]], CASE a name or all (the default)
set -eu
cd "$(dirname "$0")"
exec ../../setup.sh fpm run verdict -- "$@"
