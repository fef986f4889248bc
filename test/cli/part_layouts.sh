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

# remedies NAME COMMAND: each option and each command that the message in err names is typed in a shell, and works; none is named elsewhere
remedies() {
   is "options in the message of $1" "$(grep -v '^options that read it: ' err | grep -cE -- '(^|[^-[:alnum:]])--[a-z]')" 0
   sed -n 's/^options that read it: //p' err | sed 's/; /\n/g' | sed "s|^|gyroakf $2 |" >typed
   grep -oE "(tr|iconv|paste|sed) [-'].* \\| gyroakf .*" err >>typed
   if python3 -c 'import numpy' 2>err.numpy; then grep -oE 'python3 -c "[^"]*"' err >>typed; fi
   while IFS= read -r remedy; do
      if PATH=$work:$PATH bash -c "$remedy" >out 2>err; then pass; else fail "remedy of $1: $remedy: $(head -c 300 err)"; fi
   done <typed
}
ln -s "$gyroakf" gyroakf

while IFS= read -r line; do
   case $line in '#'* | '') continue ;; esac
   IFS='|' read -r file options expected rate unit n <<<"$(sed -E 's/ *; */|/g; s/ *$//' <<<"$line")"
   read -ra options <<<"$options"
   cp "$layouts/$file" .
   case $expected in
   error:*)
      bad "layout $line" 2 "${expected#error: }" inspect "$file" "${options[@]}"
      remedies "$line" "inspect $file ${options[*]@Q}" ;;
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

# bytes that are no text
awk 'BEGIN { print "t,gx"; for (i = 0; i < 120; i++) printf "%.2f,%.3f\n", i/100, sin(i*i) }' >plain.csv
iconv -f UTF-8 -t UTF-16 plain.csv >utf16.csv
iconv -f UTF-8 -t UTF-16BE plain.csv >unmarked.csv
{ head -c 700 plain.csv; head -c 20 /dev/zero; tail -c +701 plain.csv; } >nul.csv
for file in utf16 unmarked nul; do
   bad "bytes: $file" 2 "the content is not text but text" inspect $file.csv
   remedies "$file" "inspect $file.csv"
   is "commands for $file" "$(wc -l <typed)" 1
done
