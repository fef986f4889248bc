#!/bin/sh
# SPDX-License-Identifier: MIT
# The audit of time stamps on simulated ones: rates, clocks, jitter, bursts, losses, drift.
#
#   ./run.sh [all]          one line for every kind of loss and clock; all: one for every case with a fault
set -eu
cd "$(dirname "$0")"
../../setup.sh fpm build >/dev/null
exec $(../../setup.sh fpm run stamps_audit --runner echo 2>/dev/null | tail -n 1) "$@"
