#!/bin/sh
# SPDX-License-Identifier: MIT
# The filters beside the truth, tables in Markdown: ./run.sh truth|start|rotation [SEEDS], ./run.sh alarms [RECORDS],
# ./run.sh stability [SEEDS [SAMPLES [ONE_IN [PART]]]]; doc/filters.md has the commands of its tables
set -eu
cd "$(dirname "$0")"
program=${1:-truth}
[ $# -eq 0 ] || shift
exec ../../setup.sh fpm run "$program" -- "$@"
