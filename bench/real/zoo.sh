#!/bin/sh
# SPDX-License-Identifier: MIT
# Records of known truth, among them stand-ins of real recordings, through `gyroakf run` with its defaults: terms and verdicts that
# are wrong, errors and coverage of N and B, statements of one report that exclude each other. The rows of zoo.csv, or of TABLE:
#
#   ./zoo.sh [GYROAKF [RECORDS [TABLE]]]    GYROAKF: the program (default: built by ../program.sh); RECORDS of each row (default 5)
set -eu
here=$(cd "$(dirname "$0")" && pwd)
python3 -B "$here/zoo.py" "${3:-$here/zoo.csv}" "${1:-$("$here/../program.sh" gyroakf)}" "${2:-5}"
