# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# What ci/python.sh and ci/wheel.sh share; sourced by them.

# venv FOLDER PACKAGES...: an environment of Python with these packages; ends the script where this machine has none
venv() {
  local folder=$1
  shift
  if ! "$folder/bin/python" -c '' 2>/dev/null; then
    python3 -c 'import ensurepip, venv' 2>/dev/null || { echo "skipped: there is no python3 with venv"; exit 0; }
    rm -rf "$folder"
    python3 -m venv "$folder" || exit 1
  fi
  "$folder/bin/python" -m pip install -q --disable-pip-version-check "$@" || { echo "FAILED: pip install $*"; exit 1; }
}

# tests VENV: those of python/tests and the examples of the package that this environment imports; the last line is the count
tests() {
  local code said=build/python-tests
  "$1/bin/python" -m pytest -q -p no:cacheprovider --import-mode=importlib -c pyproject.toml --rootdir . --doctest-modules \
    --doctest-glob=README.md --pyargs gyroakf python/tests python/README.md 2>&1 | tee "$said"
  code=${PIPESTATUS[0]}
  awk -v code="$code" '/ (passed|failed|error)/ { line = $0 }
    END {
      n = split(line, word, /[ ,]+/)
      for (i = 2; i <= n; i++) { if (word[i] == "passed") p = word[i-1]; if (word[i] ~ /^(failed|error)/) f += word[i-1] }
      if (code != 0 && f == 0) f = 1
      print p + 0 " passed, " f + 0 " failed"
      exit f > 0
    }' "$said"
}
