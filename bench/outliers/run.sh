#!/bin/sh
# SPDX-License-Identifier: MIT
# Monte Carlo table of the outlier rule `auto`, in Markdown, and the time of the rule at 1e8 samples of white noise:
#
#   ./run.sh [PERCENT [SEED]]       PERCENT of the records of each row (default 100), 0: the time only
set -eu
cd "$(dirname "$0")"
exec "$(../program.sh outliers)" "$@"
