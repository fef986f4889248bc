#!/bin/sh
# SPDX-License-Identifier: MIT
# What the library states about its own errors, against simulated truth, tables in Markdown:
#   ./run.sh ar|unit_root|nis|drift [RECORDS]      default: the number that doc/validation.md has
set -eu
cd "$(dirname "$0")"
program=${1:?"usage: run.sh ar|unit_root|nis|drift [RECORDS]"}
shift
exec ../../setup.sh fpm run "$program" -- "$@"
