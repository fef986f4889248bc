#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# kill -9 at random moments of `gyroakf run --out DIR`: is there ever a half-written result?
#
#   kill.sh PROGRAM [TIMES [SEED]]       default: 200 times
#
# A run gives the same bytes every time, so a file in DIR is whole where it is one of a complete run. Odd times DIR is new, even
# times it holds the results of another recording, which --force replaces. Half of the times the moment is anywhere in a run, half
# of the times just after the first file was begun. The table says what was found; exit code 1 where a file was not whole, or where
# what was left behind kept the next run from its work.
set -u
program=$(cd "$(dirname "$1")" && pwd)/$(basename "$1")
times=${2:-200}
RANDOM=${3:-1}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
"$program" simulate --samples 12000 --rate 100 --coefficients N=0.01,K=0.002 --seed 1 --output old.txt
"$program" simulate --samples 12000 --rate 100 --coefficients N=0.01,B=0.003 --seed 2 --output new.txt
# the same command every time: results.json tells it
"$program" run old.txt --out dir --force --quiet
mv dir old
began=$(date +%s%N)
"$program" run new.txt --out dir --force --quiet
duration=$((($(date +%s%N) - began)/1000))
mv dir new
files=$(ls new | wc -l)

# results.json without its command line
no_command_line() { sed '/^  "command_line": /d' "$1"; }

sleep_us() { local s; printf -v s '%d.%06d' $(($1/1000000)) $(($1%1000000)); sleep "$s"; }

# a random number below $1
below() { echo $(((RANDOM*32768 + RANDOM)%($1 > 0 ? $1 : 1))); }

halves=0; none=0; some=0; all=0; asides=0; mixed=0; ended=0; stuck=0
for ((i = 1; i <= times; i++)); do
   rm -rf dir
   mkdir dir
   [ $((i%2)) -eq 1 ] || cp old/* dir/
   "$program" run new.txt --out dir --force --quiet &
   process=$!
   if [ $((i%4)) -lt 2 ]; then
      sleep_us "$(below "$duration")"
   else
      until compgen -G 'dir/*.part*' >/dev/null || ! kill -0 $process 2>/dev/null; do :; done
      sleep_us "$(below 20000)"
   fi
   kill -9 $process 2>/dev/null || ended=$((ended + 1))
   wait $process 2>/dev/null
   count_new=0; count_old=0
   for file in dir/*; do
      [ -e "$file" ] || continue
      name=${file#dir/}
      case $name in
         *.part[0-9]*) asides=$((asides + 1)) ;;
         *) if cmp -s "$file" "new/$name"; then count_new=$((count_new + 1))
            elif cmp -s "$file" "old/$name"; then count_old=$((count_old + 1))
            else halves=$((halves + 1)); echo "time $i: $name is not whole: $(wc -c <"$file") bytes"; fi ;;
      esac
   done
   if [ $count_new -eq 0 ]; then none=$((none + 1))
   elif [ $count_new -eq "$files" ]; then all=$((all + 1))
   else some=$((some + 1)); [ $count_old -eq 0 ] || mixed=$((mixed + 1)); fi
   # the next run does its work where only leftovers are, without --force, and takes them away
   if [ $((i%10)) -eq 1 ] && [ $((count_new + count_old)) -eq 0 ]; then
      "$program" run new.txt --out dir --quiet && cmp -s <(no_command_line dir/results.json) <(no_command_line new/results.json) ||
         stuck=$((stuck + 1))
      ! compgen -G 'dir/*.part*' >/dev/null || { stuck=$((stuck + 1)); echo "time $i: the next run left parts of the killed one"; }
   fi
done
printf '%-58s %6d\n' "runs killed or ended" "$times" "ended before the signal came" "$ended" \
   "no new file in DIR" "$none" "some of the $files files new" "$some" "  of these beside older ones" "$mixed" "all files new" "$all" \
   "files left aside (NAME.partPROCESS)" "$asides" "next run did not do its work" "$stuck" "files that were not whole" "$halves"
[ $((halves + stuck)) -eq 0 ]
