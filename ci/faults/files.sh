#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The program with one call of the system after the other that fails, for each command that writes files: it ends well, with the same
# results, or with exit code 2 and a message; and no file is there that is not whole. Then Ctrl-C at 50 moments of a run.
#
#   ci/faults/files.sh PATH-OF-THE-BINARY [CALLS]      the first so many calls of a kind fail (200)
set -u
[ $# -ge 1 ] && [ -x "$1" ] || { echo "usage: $0 PATH-OF-THE-BINARY [CALLS]" >&2; exit 1; }
gyroakf=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
cd "$(dirname "$0")/../.." || exit 1
most=${2:-200}
mkdir -p build/faults
gcc -std=gnu99 -O1 -Wall -Wextra -Werror -shared -fPIC -o build/faults/files.so ci/faults/files.c -ldl || exit 1
library=$PWD/build/faults/files.so
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
export OMP_NUM_THREADS=2 LC_ALL=C
passed=0
failed=0
fail() { failed=$((failed + 1)); printf 'FAILED: %s\n' "$*"; }

"$gyroakf" simulate --samples 3000 --rate 100 --coefficients N=0.01,K=0.001 --seed 4 --output a.txt || exit 1
"$gyroakf" simulate --samples 3000 --rate 100 --coefficients N=0.02 --seed 5 --output b.txt || exit 1
gzip -k a.txt

# What is run, in a folder with the recordings of its own; its results are in out
jobs=(
   "run a.txt --rate 100 --unit deg/s --out out --quiet"
   "filter a.txt --rate 100 --series-format npy --out out --quiet"
   "allan a.txt.gz --rate 100 --json out/a.json --quiet"
   "allan a.txt --rate 100 --unit deg/s --kalibr out/a.yaml --quiet"
   "tests - --rate 100 --json -"
   "simulate --samples 3000 --rate 100 --coefficients N=0.01 --seed 4 --output out/a.txt"
   "inspect a.txt --out out --quiet"
   "allan a.txt b.txt --rate 100 --out out --quiet"
)

# job ARGUMENTS...: in the folder `here`, with out empty or with what stood there before
job() {
   rm -rf out && mkdir out
   # shellcheck disable=SC2086
   "$@" <a.txt >out.txt 2>err.txt
   code=$?
}

# summary FILE: a summary says what failed, so it may differ; but it is a whole document
summary() {
   case $1 in
   out/summary.json) python3 -m json.tool "$1" >/dev/null 2>&1 ;;
   out/summary.csv) [ -z "$(tail -c 1 "$1")" ] && awk -F, 'NR == 1 { n = NF } NF != n { exit 1 } END { if (NR < 2) exit 1 }' "$1" ;;
   *) false ;;
   esac
}

# half: a file of out that is not one of the results as they are without faults
half() {
   local file
   while IFS= read -r file; do
      cmp -s "$file" "whole/${file#out/}" || summary "$file" || { echo "$file"; return; }
   done < <(find out -type f)
}

for one in "${jobs[@]}"; do
   read -ra words <<<"$one"
   job "$gyroakf" "${words[@]}"
   [ $code -eq 0 ] || { fail "$one: exit code $code without a fault: $(head -c 300 err.txt)"; continue; }
   rm -rf whole && mv out whole && cp out.txt whole.txt
   for call in open creat read pread write close rename unlink mkdir mmap; do
      for kind in EINTR short EIO ENOSPC; do
         for ((n = 1; n <= most; n++)); do
            rm -f mark
            job timeout 60 env LD_PRELOAD="$library" FAULT_CALL=$call FAULT_NUMBER=$n FAULT_KIND=$kind FAULT_MARK=mark "$gyroakf" "${words[@]}"
            [ -e mark ] || break
            name="$one: $call $n, $kind"
            half=$(half)
            if [ -n "$half" ] && [ $call != unlink ]; then fail "$name: $half is there, exit code $code"
            elif [ $code -eq 0 ] && ! { diff -rq out whole && cmp out.txt whole.txt; } >/dev/null; then fail "$name: exit code 0 with other results"
            elif [ $code -ne 0 ] && [ $code -ne 2 ]; then fail "$name: exit code $code: $(head -c 300 err.txt)"
            elif [ $code -eq 2 ] && [ "$(head -c 16 err.txt)" != "gyroakf: error: " ]; then fail "$name: message: $(head -c 300 err.txt)"
            elif [ $code -eq 2 ] && [ $kind = short ]; then fail "$name: $(head -c 300 err.txt)"
            else passed=$((passed + 1)); fi
         done
      done
   done
done
[ $passed -gt 100 ] || fail "hardly any call failed: is the library loaded?"

# Ctrl-C
read -ra words <<<"${jobs[0]}"
begin=$(date +%s%N)
job "$gyroakf" "${words[@]}"
milliseconds=$((($(date +%s%N) - begin) / 1000000))
rm -rf whole && mv out whole
set -m
for ((n = 1; n <= 50; n++)); do
   rm -rf out
   "$gyroakf" "${words[@]}" >out.txt 2>err.txt &
   process=$!
   sleep "$(printf '%d.%03d' $((milliseconds * n / 50000)) $((milliseconds * n / 50 % 1000)))"
   { kill -INT $process; wait $process; } 2>/dev/null
   code=$?
   [ -d out ] || mkdir out
   half=$(half)
   if [ $code -ne 130 ] && [ $code -ne 0 ]; then fail "Ctrl-C: exit code $code"
   elif [ -n "$half" ]; then fail "Ctrl-C: $half is there"
   else passed=$((passed + 1)); fi
done

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
