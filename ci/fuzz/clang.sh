#!/bin/sh
# SPDX-License-Identifier: MIT
# Prints the name of a clang that has libFuzzer and the sanitizers, or fails:   ci/fuzz/clang.sh
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
printf 'int LLVMFuzzerTestOneInput(const char *d, long n) { return !d && n; }\n' >"$dir/try.c"
for clang in "${GYROAKF_CLANG:-clang}" clang-20 clang-19 clang-18 clang-17 clang-16 clang-15 clang-14 \
  /opt/homebrew/opt/llvm/bin/clang /usr/local/opt/llvm/bin/clang; do
  command -v "$clang" >/dev/null 2>&1 || continue
  "$clang" -fsanitize=address,undefined,fuzzer "$dir/try.c" -o "$dir/try" 2>/dev/null || continue
  echo "$clang"
  exit
done
exit 1
