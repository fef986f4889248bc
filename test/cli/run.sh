#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Tests of the program through its binary:   test/cli/run.sh PATH-OF-THE-BINARY [PART]
# Prints a line for every failure and as the last line "N passed, N failed"; exits non-zero on failure.
# Without a PART all of them, two at a time, those that take longest first.
set -u
[ $# -ge 1 ] && [ -x "$1" ] || { echo "usage: $0 PATH-OF-THE-BINARY [PART]" >&2; exit 1; }
parts=(memory terminal progress output determinism zoo many selftest truth figures formats reading odd page writing usage config malformed
   manual time names layouts hostile)
if [ $# -lt 2 ]; then
   said=$(printf '%s\n' "${parts[@]}" | xargs -P 2 -n 1 "$0" "$1")
   grep -vE '^[0-9]+ passed, [0-9]+ failed$' <<<"$said"
   awk '/^[0-9]+ passed, [0-9]+ failed$/ { p += $1; f += $3; n++ }
      END { print p + 0 " passed, " f + 0 " failed"; exit f > 0 || n != '${#parts[@]}' }' <<<"$said"
   exit
fi
[ -e "$(dirname "$0")/part_$2.sh" ] || { echo "$0: there is no part '$2'" >&2; exit 1; }
gyroakf=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
export LC_ALL=C                 # reports in ASCII
unset NO_COLOR
passed=0
failed=0

pass() { passed=$((passed + 1)); }
fail() { failed=$((failed + 1)); printf 'FAILED: %s\n' "$*"; }

# run ARGUMENTS...: sets code, leaves standard output in out, standard error in err
run() { "$gyroakf" "$@" >out 2>err </dev/null; code=$?; }

# good NAME ARGUMENTS...: exit code 0, nothing on standard error
good() {
   local name=$1; shift
   run "$@"
   if [ $code -ne 0 ]; then fail "$name: exit code $code: $(head -c 300 err)"
   elif [ -s err ]; then fail "$name: standard error: $(head -c 300 err)"
   else pass; fi
}

# bad NAME CODE FRAGMENT ARGUMENTS...: that exit code, the message, an empty standard output
bad() {
   local name=$1 expected=$2 fragment=$3; shift 3
   run "$@"
   if [ $code -ne "$expected" ]; then fail "$name: exit code $code instead of $expected: $(head -c 300 err)"
   elif [ -s out ]; then fail "$name: standard output is not empty"
   elif [ "$(head -c 16 err)" != "gyroakf: error: " ]; then fail "$name: standard error: $(head -c 300 err)"
   elif ! grep -qF -- "$fragment" err; then fail "$name: no '$fragment' in: $(head -c 300 err)"
   else pass; fi
}

# holds NAME TEXT FILE: the text is in the file, in a line or wrapped
holds() {
   if grep -qF -- "$2" "$3" || tr -s "[:space:]" " " <"$3" | grep -qF -- "$2"; then pass; else fail "$1: no '$2' in $3"; fi
}

# a document without its command line
no_command_line() { sed '/^  "command_line": /d'; }

# is NAME ACTUAL EXPECTED
is() { if [ "$2" = "$3" ]; then pass; else fail "$1: '$2' instead of '$3'"; fi; }

# shellcheck source=/dev/null
. "$here/part_$2.sh"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
