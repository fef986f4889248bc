#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Feeds the readers with broken files; needs a clang with libFuzzer, which setup.sh installs:
#
#   GYROAKF_FUZZ=1 ./setup.sh ci/fuzz/run.sh 60s           for so many seconds
#   GYROAKF_FUZZ=1 ./setup.sh ci/fuzz/run.sh 20000000      so many runs
#   GYROAKF_FUZZ=1 ./setup.sh ci/fuzz/run.sh FILE...       these inputs once (build/fuzz/crash-*)
#
# Ends with an error where a run crashes, hangs, leaks, needs too much memory, is reported by a sanitizer, or breaks a
# promise of gyroakf.h; the input is then in build/fuzz/. What is found interesting is kept in build/fuzz/corpus.
set -eu
cd "$(dirname "$0")/../.."
ci/fuzz/build.sh
out=build/fuzz
ci/fuzz/seeds.sh $out/seeds
mkdir -p $out/corpus
export ASAN_OPTIONS=allocator_may_return_null=1:quarantine_size_mb=16:detect_stack_use_after_return=0
export UBSAN_OPTIONS=print_stacktrace=1
options=(-timeout=60 -rss_limit_mb=4096 -malloc_limit_mb=2048 -print_final_stats=1 "-artifact_prefix=$out/")
case ${1-60s} in
  *[!0-9s]*) exec $out/reader "${options[@]}" "$@" ;;
  *s) options+=(-max_total_time="${1%s}") ;;
  *) options+=(-runs="$1") ;;
esac
$out/reader -merge=1 "${options[@]:0:3}" $out/corpus $out/seeds >/dev/null 2>&1 || true
exec $out/reader "${options[@]}" -dict=ci/fuzz/reader.dict -max_len="${GYROAKF_FUZZ_LENGTH-1024}" -reload=0 -entropic=0 \
  $out/corpus $out/seeds
