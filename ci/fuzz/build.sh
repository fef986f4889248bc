#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Builds the fuzz harness of the readers with address and undefined-behavior sanitizers and run-time checks:
#
#   GYROAKF_FUZZ=1 ./setup.sh ci/fuzz/build.sh        -> build/fuzz/reader
#
# Only the modules that the readers need are built, each after those that it uses. Blocks and pieces of text are made so small that
# short inputs have many of them; GYROAKF_FUZZ_WHOLE=1 leaves them as they are.
set -eu
cd "$(dirname "$0")/../.."
out=build/fuzz
top=gyroakf_c_api_c_record
die() { echo "fuzz: $*" >&2; exit 1; }

clang=$(ci/fuzz/clang.sh) || die "there is no clang with libFuzzer; GYROAKF_FUZZ=1 ./setup.sh installs one"

# a module's file follows from its name as the style gate has it
file_of() {
  local name=${1#gyroakf} path=src/gyroakf rest part
  rest=${name#_}
  [ -n "$rest" ] || { echo src/gyroakf.f90; return; }
  while [ ! -f "$path/$rest.f90" ]; do # folders are the words in front
    for part in "$path"/*/; do
      part=$(basename "$part")
      [[ $rest == "${part}"_* ]] || continue
      path=$path/$part
      rest=${rest#"${part}"_}
      continue 2
    done
    die "no file for the module $1"
  done
  echo "$path/$rest.f90"
}

order=() # of compilation
declare -A seen
visit() {
  local file used
  [ -z "${seen[$1]:-}" ] || return 0
  seen[$1]=1
  file=$(file_of "$1")
  while read -r used; do visit "$used"; done < <(sed -nE 's/^ *use *(, *non_intrinsic *)?(::)? *(gyroakf[a-z0-9_]*).*/\3/p' "$file" | sort -u)
  order+=("$file")
}
visit gyroakf_c_api_c_release
visit $top

flags="-O1 -g -fopenmp -ffp-contract=off -fno-omit-frame-pointer -fno-sanitize-recover=all -fsanitize-coverage=trace-pc"
flags="$flags -fsanitize=address,undefined -fcheck=bounds,do,mem,pointer,recursion"
# small BEFORE AFTER FILE: a constant of the source in the build
small() {
  [ -z "${GYROAKF_FUZZ_WHOLE-}" ] || return 0
  grep -q "$1" "$3" || die "there is no '$1' in $3 any more"
  sed -i "s/$1/$2/" "$3"
}

stamp=${GYROAKF_FUZZ_WHOLE-}$(cat "${order[@]}" "$0" ci/fuzz/reader.c src/gyroakf/c_api/*.c c_api/include/gyroakf.h | cksum)
if [ -x "$out/reader" ] && [ "$(cat "$out/stamp" 2>/dev/null)" = "$stamp" ]; then exit 0; fi
rm -rf "$out/objects"
mkdir -p "$out/objects"
for file in "${order[@]}"; do
  name=$out/objects/${file//\//_}
  cp "$file" "$name"
  case $file in
    */io/lines.f90) small 'block_size = 1048576' 'block_size = 200' "$name" ;;
    */io/source.f90) small 'piece_size = 131072' 'piece_size = 24' "$name" ;;
    */io/text_rows.f90) small 'span_size = 131072' 'span_size = 24' "$name" ;;
  esac
  # shellcheck disable=SC2086
  gfortran $flags -J "$out/objects" -c "$name" -o "$name.o"
done
for object in "$out"/objects/*.o; do
  objcopy --redefine-sym __sanitizer_cov_trace_pc=gyroakf_trace_pc "$object"
done
"$clang" -g -O1 -std=c99 -Wall -Wextra -fsanitize=address,undefined,fuzzer -fno-sanitize-recover=all -Ic_api/include \
  ci/fuzz/reader.c src/gyroakf/c_api/*.c "$out"/objects/*.o -L"$(dirname "$(gfortran -print-file-name=libgfortran.so)")" -lgfortran -lgomp -lz -lm \
  -o "$out/reader"
echo "$stamp" >"$out/stamp"
