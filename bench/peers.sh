#!/bin/sh
# SPDX-License-Identifier: MIT
# The path of a Python that has the programs to compare with, in a private environment that is made on first use:
#
#   bench/peers.sh MODULE...        fails, and says so, where one of the modules cannot be had
set -eu
venv=${XDG_CACHE_HOME:-$HOME/.cache}/gyroakf/bench
has() { "$venv/bin/python" -c "import $(echo "$*" | tr ' ' ',')" 2>/dev/null; }
if ! has "$@"; then
  {
    [ -x "$venv/bin/python" ] || python3 -m venv "$venv"
    for module; do
      has "$module" || case $module in
        allantools) "$venv/bin/pip" install -q 'allantools==2024.6' ;;
        statsmodels) "$venv/bin/pip" install -q 'statsmodels==0.15.0' ;;
        filterpy) "$venv/bin/pip" install -q numpy scipy matplotlib setuptools wheel &&
          "$venv/bin/pip" install -q --no-build-isolation 'filterpy==1.4.5' ;;
        *) "$venv/bin/pip" install -q "$module" ;;
      esac
    done
  } >&2
  has "$@" || { echo "these peers cannot be installed: $*" >&2; exit 1; }
fi
echo "$venv/bin/python"
