#!/bin/sh
# SPDX-License-Identifier: MIT
# Each function of the C interface, and the analysis of 60 channels, with one large request for memory after the other that fails:
# a status and a message, never the end of the program.
#
#   ci/faults/run.sh
set -eu
cd "$(dirname "$0")/../.."
mkdir -p build/faults
gcc -std=gnu99 -O1 -Wall -Wextra -Werror -shared -fPIC -o build/faults/memory.so ci/faults/memory.c -ldl
./setup.sh fpm test test_c_api --runner "env LD_PRELOAD=$PWD/build/faults/memory.so" -- faults
