#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Pages of the doc comments, by FORD, in build/site (doc/ford.md):   ci/site.sh
#
# FORD must find nothing wrong (a reference that leads nowhere, a declaration it cannot read) and describe every module.
# GYROAKF_SITE=1 ./setup.sh installs FORD; where it cannot be had this says "skipped: ...".
set -u
cd "$(dirname "$0")/.." || exit 1
export COLUMNS=500 # FORD breaks its lines there
site=build/site
mkdir -p build
log=build/site.log
if ! GYROAKF_SITE=1 ./setup.sh ford --version >"$log" 2>&1; then
  echo "skipped: FORD cannot be installed here"
  exit 0
fi
cat "$log"
passed=0
failed=0

# rule NAME: fails if there is anything on standard input, and shows it
rule() {
  local found
  found=$(cat)
  if [ -z "$found" ]; then passed=$((passed + 1)); return; fi
  failed=$((failed + 1))
  printf 'FAILED: %s:\n%s\n' "$1" "$found" | head -n 40
}

rm -rf "$site"
version=$(sed -n 's/^version *= *"\(.*\)"/\1/p' fpm.toml)
GYROAKF_SITE=1 ./setup.sh ford --config "version = \"$version\"" doc/ford.md >"$log" 2>&1
code=$?
shopt -s lastpipe # the last command of a pipe runs here and can count
{ if [ "$code" -ne 0 ]; then echo "exit code $code"; tail -n 20 "$log"; fi } | rule "FORD ends well"
# the lines of progress end with the name of what was worked on, which may be "error"
grep -vE '^  (Parsing|Processing|Writing) ' "$log" | grep -iE -A 1 '(^|[^a-z])(warning|error|traceback)' | rule "FORD has nothing to say"

find src -name '*.f90' | sed 's|^src/||; s|\.f90$||; s|/|_|g' | while read -r module; do
  [ -f "$site/module/$module.html" ] || echo "$module"
done | rule "every module has a page"

# the text above a procedure's argument, on the procedure's page
page=$site/proc/fit_noise.html
for text in 'Fits the terms' 'kind oadev; edf, lower and upper are replaced' 'Coefficients with errors, goodness of the fit'; do
  grep -qF "$text" "$page" 2>/dev/null || echo "$page: no '$text'"
done | rule "arguments are described"

grep -roE --include='*.html' '\[\[[a-z][^] ]*\]\]' "$site" | rule "no reference is left as it was written"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
