# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# Help, version, and what is wrong with a command line.
version=$(sed -n 's/^version = "\(.*\)"/\1/p' "$root/fpm.toml")
good "version" --version
is "version text" "$(cat out)" "gyroakf $version"
good "citation" --citation
for command in "" run inspect allan tests ar filter simulate; do
   # shellcheck disable=SC2086
   good "help of '$command'" $command --help
   is "help of '$command' fits 100 columns" "$(LC_ALL=C.UTF-8 awk 'length > 100' out)" ""
   holds "help of '$command' has an example" "  gyroakf" out
   # shellcheck disable=SC2086
   good "-h of '$command'" $command -h
done
run --help
if grep -q selftest out; then fail "help promises selftest"; else pass; fi

bad "unknown option" 1 "unknown option '--rat'; the nearest is '--rate'" x.txt --rat 5
bad "last part of an option" 1 "the nearest is '--outlier-threshold'" x.txt --threshold=3
bad "unknown option far from all" 1 "unknown option '--zzzzzzzzz'; gyroakf --help" x.txt --zzzzzzzzz
bad "unknown short option" 1 "unknown option '-q'" x.txt -q
bad "unknown command" 1 "unknown command 'alan', and no file of that name; the nearest command is 'allan'" alan
bad "unknown command with a file" 1 "unknown command 'selftest'; the commands are run, inspect" selftest x.txt
bad "flag with a value" 1 "option '--quiet' takes no value" x.txt --quiet=yes
bad "no value at the end" 1 "option '--json' needs a value: --json FILE" x.txt --json
bad "no value before an option" 1 "option '--json' needs a value" x.txt --json --quiet
good "simulate the paper's record" simulate --preset paper
if cmp -s out "$root/example/data/mems_gyro_x.txt"; then pass; else fail "simulate --preset paper is not the example's record"; fi
