# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# Options in a file: written, read, repeated, wrong.

good "a simulation with its options written" simulate --samples 500 --seed 4 --coefficients N=0.01 --output config.txt --write-config c.toml
cp config.txt config_first.txt
good "repeated from the file" --config c.toml --force
if cmp -s config.txt config_first.txt; then pass; else fail "--config does not repeat the simulation"; fi
good "an analysis with its options written" allan config.txt --taus 'log:5' --terms QN --json config_a.json --quiet --write-config a.toml
cp config_a.json config_first.json
good "the analysis repeated" --config a.toml --force
if cmp -s <(no_command_line <config_a.json) <(no_command_line <config_first.json); then pass; else fail "--config does not repeat the analysis"; fi
good "the command line comes on top" --config a.toml --force --json - --taus 1,2,4
holds "averaging times of the command line" '"tau_s": [1, 2, 4]' out
good "a file of the line instead" config_first.txt --config a.toml --force --json -
holds "the line's file" '"path": "config_first.txt"' out
bad "a command of the line that has not all options" 1 ": option '--taus' is not one of 'inspect'" inspect --config a.toml --force

good "options without a recording" run --write-config empty.toml
is "nothing else is done" "$(cat out)" ""
for command in run inspect allan tests ar filter simulate selftest; do
   output=--quiet
   [ $command != simulate ] || output=--output=o.txt
   good "every option of $command written" $command --write-config config_all.toml --force $output
   run $command --help
   grep -oE '^  (-., )?--[a-z-]+' out | sed 's/^.*--//' | grep -vxE 'help|version|citation|man|completion|config|write-config' |
      while read -r name; do grep -qE "^(# )?$name = " config_all.toml || echo "$name"; done >missing
   is "options of $command in its file" "$(cat missing)" ""
done
bad "the file of options is kept" 2 "already exists; use --force" run --write-config empty.toml

# wrong NAME LINES FRAGMENT: a file of options with these lines is refused at its last one
wrong() {
   printf '%b' "$2" >wrong.toml
   bad "options: $1" "${4:-2}" "$3" config.txt --config wrong.toml
}
wrong "unknown" '# a comment\nratee = 5\n' "wrong.toml:2: no option of a file: 'ratee'; the nearest is 'rate'"
wrong "no equals sign" '\n\ntaus "octave"\n' "wrong.toml:3: no 'name = value'"
wrong "a value that is none" 'rate = fast\n' "wrong.toml:1: option '--rate HZ': 'fast' is not a number" 1
wrong "no value" 'rate =\n' "wrong.toml:1: there is no value"
wrong "open quotes" 'unit = "deg/s\n' "wrong.toml:1: the quotes are not closed"
wrong "something behind" 'rate = 5 6\n' "wrong.toml:1: something follows the value"
wrong "a list" 'taus = [1, 2]\n' "wrong.toml:1: only 'files' has a list"
wrong "an open list" 'files = ["a"\n' "wrong.toml:1: the list does not end with ]"
wrong "a flag that is a number" 'quiet = 1\n' "wrong.toml:1: 'quiet' is true or false"
wrong "help" 'help = true\n' "wrong.toml:1: no option of a file: 'help'"
wrong "an unknown command" 'command = "alan"\n' "wrong.toml:1: unknown command 'alan'"
wrong "an option of another command" 'seed = 5\n' "option '--seed' is not one of 'run'" 1
wrong "a binary file" '\0001\000' "wrong.toml: is no file of options"
bad "options: no such file" 2 "nosuch.toml: no such file" config.txt --config nosuch.toml
printf '\xef\xbb\xbfquiet = true # nothing\r\nforce = false\r\nfiles = [ "config.txt" , ]\r\n' >dos.toml
good "options with a byte-order mark and carriage returns" inspect --config dos.toml
is "quiet" "$(cat out)" ""
printf 'files = ["config.txt"]\nunit = "de\\"g/s"\n' >quote.toml
bad "an escaped quote" 1 'de"g/s' inspect --config quote.toml
