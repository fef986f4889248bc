#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# All measurements of speed and memory, side by side with the peers, and bench/results.md with what they say:
#
#   bench/all.sh                    every part, some 15 minutes where nothing else runs (the first time the peers are installed and
#                                   the library is built, some minutes more)
#   bench/all.sh allan scaling      these parts; results.md keeps the others from the last run
#   LARGEST=1000000 bench/all.sh    smaller records: to see that it works, not for figures
#
# What a part prints is kept in bench/build/PART.log, its lines "figure: WHAT | VALUE | AT LEAST OR AT MOST" go into the
# table. A part that fails, or lacks its peer, is told there, and the others go on.
set -u
cd "$(dirname "$0")" || exit 1
all=(allan read series filter run scaling profile roofline)
: "${LARGEST:=100000000}"
ten_million=$((LARGEST < 10000000 ? LARGEST : 10000000))

allan() {
  KINDS=oadev allan/run.sh "$ten_million" || return 1
  [ "$LARGEST" -le "$ten_million" ] || KINDS=oadev ROUNDS=0 allan/run.sh "$LARGEST"
}
read_text() { read/run.sh "$ten_million"; }
series() { series/run.sh adf ar; }
filter() { filter/run.sh; }
run() { run/run.sh $((LARGEST < 1000000 ? LARGEST : 1000000)); }
scaling() { scaling/run.sh "$LARGEST"; }
profile() { profile/run.sh "$ten_million"; }
roofline() { roofline/run.sh $((LARGEST / 2)); }

parts=("$@")
[ $# -gt 0 ] || parts=("${all[@]}")
for part in "${parts[@]}"; do
  [[ " ${all[*]} " == *" $part "* ]] || { echo "no such part: $part; there are: ${all[*]}" >&2; exit 1; }
done
mkdir -p build
gyroakf=$(./program.sh gyroakf) || exit 1
GYROAKF_PREFIX=$(dirname "$(dirname "$gyroakf")")
export GYROAKF_PREFIX
failed=0
for part in "${parts[@]}"; do
  command=$part
  [ "$part" != read ] || command=read_text
  echo "== $part"
  start=$SECONDS
  uptime | sed 's/.*load/load/' >"build/$part.log"
  "$command" 2>&1 | tee -a "build/$part.log"
  if [ "${PIPESTATUS[0]}" -ne 0 ]; then
    failed=1
    echo "FAILED: $part" | tee -a "build/$part.log"
  fi
  echo "$((SECONDS - start)) s" | tee -a "build/$part.log"
done
python3 write_results.py "${all[@]}" && echo "bench/results.md is written"
exit $failed
