# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# The layouts of test/layouts/table.txt: channels, rate, unit and N of each file, or the message that refuses it.
layouts=$root/test/layouts

# value KEY: of the document in joined, without quotes
value() { sed -nE 's/.*"'"$1"'": ("([^"]*)"|([^,}]*)).*/\2\3/p' joined; }
# channels: of the document in joined, between bars
channels() { sed -nE 's/.*"channels": \["([^]]*(\[[^]]*\][^]]*)*)"\], "missing".*/\1/p' joined | sed 's/", "/|/g'; }
# white: N of the document in joined, in units of the input
white() { sed -nE 's/.*"input": \{ "Q": \{[^}]*\}, "N": \{ "value": ([0-9.e+-]+).*/\1/p' joined; }

while IFS= read -r line; do
   case $line in '#'* | '') continue ;; esac
   IFS='|' read -r file options expected rate unit n <<<"$(sed -E 's/ *; */|/g; s/ *$//' <<<"$line")"
   read -ra options <<<"$options"
   cp "$layouts/$file" .
   case $expected in
   error:*) bad "layout $line" 2 "${expected#error: }" inspect "$file" "${options[@]}" ;;
   *)
      good "layout $line" inspect "$file" "${options[@]}" --json -
      tr -s '\n ' ' ' <out >joined
      is "layout $line" "$(channels) $(printf '%.6g' "$(value rate_hz)") $(value unit)" "${expected//, /|} $rate $unit"
      if [ -n "$n" ]; then
         good "layout $line" allan "$file" "${options[@]}" --json -
         tr -s '\n ' ' ' <out >joined
         is "N of $line" "$(white | awk -v n="$n" '{ print ($1 > 0.9*n && $1 < 1.1*n) }')" 1
      fi ;;
   esac
done <"$layouts/table.txt"
