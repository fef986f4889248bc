# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# Help, version, and what is wrong with a command line.
version=$(sed -n 's/^version = "\(.*\)"/\1/p' "$root/fpm.toml")
good "version" --version
is "version text" "$(cat out)" "gyroakf $version"
good "citation" --citation
for command in "" run inspect allan tests ar filter simulate selftest; do
   # shellcheck disable=SC2086
   good "help of '$command'" $command --help
   is "help of '$command' fits 98 columns" "$(LC_ALL=C.UTF-8 awk 'length > 98' out)" ""
   holds "help of '$command' has an example" "  gyroakf" out
   # shellcheck disable=SC2086
   good "-h of '$command'" $command -h
done

# help and version as commands; the short help and the whole one
run
is "a bare call" "$code $(wc -l <err) $(cat out)" "1 6 "
holds "usage of a bare call" "Usage: gyroakf [COMMAND] FILE... [OPTIONS]" err
holds "where it leads" "gyroakf help" err
# same NAME ARGUMENTS -- ARGUMENTS: both print the same
same() {
   local name=$1 first; shift
   first=()
   while [ "$1" != -- ]; do first+=("$1"); shift; done
   shift
   good "$name" "${first[@]}"
   cp out first
   good "$name, the other way" "$@"
   if cmp -s out first; then pass; else fail "$name: '${first[*]}' and '$*' print different texts"; fi
}
same "help" help -- --help
same "help of help" help help -- --help
for command in run inspect allan tests ar filter simulate selftest; do
   same "help of $command" help $command -- $command --help
   same "all of $command" help $command --help=all -- $command -h
done
same "version" version -- --version
same "short version" -V -- --version
good "help" help
for option in '--rate HZ' '--unit UNIT' '--column N' '--to S' '-o, --out DIR' '--json FILE' '-q, --quiet' '-V, --version'; do
   holds "$option in the short help" "  $option" out
done
is "it shows few of the options" "$(grep -cE '^  (-., )?--' out | awk '{ print $1 < 16 }')" 1
holds "the short help leads to the rest" "gyroakf help COMMAND shows those of a command, gyroakf --help=all shows all" out
good "the whole help" --help=all
for command in run inspect allan tests ar filter simulate selftest; do "$gyroakf" help $command; done | grep -E '^  -' | sort -u >every
is "options of all commands in it" "$(grep -E '^  -' out | sort -u | comm -13 - every)" ""
bad "help of an unknown command" 1 "unknown command 'alan'; the nearest command is 'allan'" help alan
bad "help of no command" 1 "unknown command 'x.txt'; the commands are run, inspect" help x.txt
bad "part of the help" 1 "option '--help' takes no value but all" --help=part
bad "help misspelt" 1 "the nearest command is 'help'" hlep
bad "a file called help" 2 "help" -- help

bad "unknown option" 1 "unknown option '--rat'; the nearest is '--rate'" x.txt --rat 5
bad "last part of an option" 1 "the nearest is '--outlier-threshold'" x.txt --threshold=3
bad "unknown option far from all" 1 "unknown option '--zzzzzzzzz'; gyroakf --help" x.txt --zzzzzzzzz
bad "unknown short option" 1 "unknown option '-v'; gyroakf --help=all" x.txt -v
bad "unknown command" 1 "unknown command 'alan', and no file of that name; the nearest command is 'allan'" alan
bad "unknown command with a file" 1 "unknown command 'dance'; the commands are run, inspect" dance x.txt
bad "flag with a value" 1 "option '--quiet' takes no value" x.txt --quiet=yes
bad "short flag with a value" 1 "option '-q' takes no value" x.txt -q=yes
bad "no value of a short option" 1 "option '--out' needs a value: --out DIR" x.txt -o
bad "no value before a short option" 1 "option '--out' needs a value" x.txt -o -q
bad "no value at the end" 1 "option '--json' needs a value: --json FILE" x.txt --json
bad "no value before an option" 1 "option '--json' needs a value" x.txt --json --quiet

# Options: text in the message ; the arguments. None of the files exists: the command line is checked first.
while IFS= read -r line; do
   # shellcheck disable=SC2086
   bad "usage: ${line##* ; }" 1 "${line%% ; *}" ${line##* ; }
done <<'LINES'
no file; '-' reads standard input ; allan
standard input ('-') can be read once ; allan - -
simulate reads no file ; simulate x.txt
selftest reads no file ; selftest x.txt
option '--rate' is not one of 'selftest' ; selftest --rate 5
'abc' is not a number ; x.txt --rate abc
'-3' is not larger than 0 ; x.txt --rate=-3
'-3' is not larger than 0 ; x.txt --rate -3
'0' is not larger than 0 ; x.txt --dt 0
'1e999' is too large for a number ; x.txt --rate 1e999
'nan' is not a number ; x.txt --rate nan
the value is empty ; x.txt --rate=
--rate and --dt say the same thing ; x.txt --rate 5 --dt 0.2
unknown unit 'parsec' ; x.txt --unit parsec
'deg' is the unit of an angle ; x.txt --unit deg
with --input increment the unit is that of the angle ; x.txt --unit deg/s --input increment
'rates' is not one of these ; x.txt --input rates
'nyp' is none of auto, text, csv, npy ; x.txt --format nyp
'mdew' is not one of these ; x.txt --kinds oadev,mdew
other letters than Q N B K R ; x.txt --terms QX
'foo' is not one of these ; x.txt --taus foo
log:0 has no averaging times ; x.txt --taus log:0
'x' is not a number ; x.txt --taus 1,2,x
averaging times are larger than 0 ; x.txt --taus 1,-2
'hampl' is not one of these ; x.txt --outliers hampl
--outlier-window goes with --outliers hampel ; x.txt --outlier-window 5
--outlier-rounds without --outliers ; allan x.txt --outlier-rounds 1
'chauvenet' is not one of these ; x.txt --outliers chauvenet
'0' is not a whole number from 1 to 1000 ; x.txt --outlier-rounds 0
'5000' is not a whole number from 1 to 4096 ; tests x.txt --lags 5000
'200000' is not a whole number from 1 to 100000 ; x.txt --outliers hampel --outlier-window 200000
--outlier-threshold without --outliers ; allan x.txt --outlier-threshold 3
'10' is not a whole number from 0 to 9 ; x.txt --detrend 10
q, r, Q, R at most once ; x.txt --estimate q,r,Q,Q
limits that always hold are infinite ; x.txt --confidence 1
'1.5' is not larger than 0 and at most 1 ; x.txt --forgetting 1.5
option '--memory SIZE': 'lots' is not a size such as 500MB or 2GB ; x.txt --memory lots
option '--memory SIZE': '2XB' is not a size such as 500MB or 2GB ; x.txt --memory 2XB
option '--memory SIZE': '1MB' is too small, at least 28MB ; allan x.txt --memory 1MB
'yes' is not one of these ; x.txt --progress=yes
it needs the name of a file ; x.txt --truth -
--output and --truth name the same file ; simulate --output x --truth ./x
--truth is that of one recording ; filter x.txt y.txt --truth f
a result would overwrite the true drift ; filter x.txt --truth f --json ./f
'--truth' is not one of 'allan' ; allan x.txt --truth f
'--forgetting' is not one of 'inspect' ; inspect x.txt --forgetting 0.9
--order is larger than --max-order ; ar x.txt --order 5 --max-order 3
'5000' is not a whole number from 0 to 1000 ; x.txt --adf-lags 5000
--ar and --ar-variance go together ; simulate --ar 0.5
'N=2' is not a term given once ; simulate --coefficients N=1,N=2
'N=-1' is not a term given once ; simulate --coefficients N=-1
'n=1' is not a term given once ; simulate --coefficients n=1
'N' is not a term given once ; simulate --coefficients N
'-1' is not a whole number ; simulate --seed -1
'2' is not from 0 to 0.9 ; simulate --missing 2
unknown option '--rounding' ; simulate --rounding 1
'0' is not larger than 0 ; simulate --lsb 0
't4' is not one of these ; simulate --tails t4
'0' is not larger than 0 ; simulate --lowpass 0
'1,1,1' has the wrong number of parts ; simulate --lowpass 1,1,1
'' is not a number ; simulate --lowpass 1,
order of the low-pass filter must be 1 or 2 ; simulate --lowpass 1,1.5
below half the rate ; simulate --lowpass 2.5
'1' has the wrong number of parts ; simulate --resonance 1
Q of the resonance must be 0.5 .. 100 ; simulate --resonance 1,0.4
'0.1' has the wrong number of parts ; simulate --contamination 0.1
contamination must be a share of 0 .. 1 ; simulate --contamination 1.1,5
'1,2,3' has the wrong number of parts ; simulate --warmup 1,2,3
the time constant of a warm-up must be > 0 s ; simulate --warmup 1,0
'1,2' has the wrong number of parts ; simulate --motion 1,2
motion must be a whole number of bursts ; simulate --motion 1.5,2,3
'1,2,3' has the wrong number of parts ; simulate --markov 1,2,3
'0' is not larger than 0 ; simulate --markov 1,0
'1,2' has the wrong number of parts ; simulate --vibration 1,2
'foo' is not one of these ; simulate --preset foo
'0' is not a whole number from 1 to 4096 ; x.txt --threads 0
--from is not before --to ; x.txt --from 5 --to 3
'-1' is before the first sample ; x.txt --from -1
--fit-tau-min is not below --fit-tau-max ; x.txt --fit-tau-min 5 --fit-tau-max 3
0 leaves nothing ; x.txt --scale 0
LINES
