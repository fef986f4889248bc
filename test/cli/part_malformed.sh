# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# What cannot be read: the message with its place, the exit code, an empty standard output, no file written.
while IFS= read -r line; do
   case $line in '#'*) continue ;; esac
   IFS=$'\001' read -r name content options expected fragment <<<"${line// ; /$'\001'}"
   # shellcheck disable=SC2059
   printf "$content" >bad.txt
   # shellcheck disable=SC2086
   bad "$name" "$expected" "$fragment" inspect bad.txt $options
done <"$here/cases"

bad "no such file" 2 "nofile.txt" inspect nofile.txt
bad "a directory" 2 "." inspect .
bad "line of the error" 2 "2x" inspect <(printf '1\n2x\n')
printf '1\n2x\n3\n' >bad.txt
run inspect bad.txt
is "a caret under the text" "$(sed -n 3p err)" "^"
