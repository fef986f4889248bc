# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# What cannot be read: the message with its place, the exit code, an empty standard output, no file written.
while IFS= read -r line; do
   case $line in '#'*) continue ;; esac
   IFS=$'\001' read -r name content options expected fragment <<<"${line// ; /$'\001'}"
   # shellcheck disable=SC2059
   printf "$content" >bad.txt
   # shellcheck disable=SC2086
   bad "$name" "$expected" "$fragment" run bad.txt $options --out results --json results.json
   if [ -e results ] || [ -e results.json ]; then
      fail "$name: an output file was written"
      rm -rf results results.json
   fi
done <"$here/cases"

bad "no such file" 2 "nofile.txt" nofile.txt
bad "a directory" 2 "." run .
bad "values too small to be squared" 2 "multiply them by a constant (--scale)" allan <(awk 'BEGIN { for (i = 0; i < 100; i++) print i * i % 7 "e-150" }')
bad "line of the error" 2 "2x" <(printf '1\n2x\n')
printf '1\n2x\n3\n' >bad.txt
run bad.txt
is "a caret under the text" "$(sed -n 3p err)" "^"
