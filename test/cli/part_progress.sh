# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# How far the work is, an end by the user, a reader that goes away.
"$gyroakf" simulate --samples 400000 --rate 100 --unit deg/s --coefficients N=0.01 --output long.txt
good "no bar where standard error is no terminal" run long.txt
cp out unwatched.txt
for mode in auto off; do good "--progress $mode" run long.txt --progress $mode; done
run run long.txt --progress on
is "exit code with a bar" $code 0
if cmp -s out unwatched.txt; then pass; else fail "the bar changes the report"; fi
holds "the bar tells the stage" "reading" err
holds "the bar tells the share" " %" err
is "a bar has no line feed" "$(wc -l <err)" 0
is "a bar fits 79 columns" "$(tr '\r' '\n' <err | awk 'length > 79')" ""
is "a bar is taken away" "$(tr '\r' '\n' <err | tail -n 1 | tr -d ' ')" ""
run inspect - --progress on
is "nothing to read with a bar" $code 2
is "the message begins on a free line" "$(tr '\r' '\n' <err | grep -c '^gyroakf: error: ')" 1
if command -v script >/dev/null && script -qec true /dev/null </dev/null >/dev/null 2>&1; then
   # a terminal: no bar in the first second, none in the report
   script -qec "'$gyroakf' run '$work/long.txt'" /dev/null </dev/null >typed
   tr -d '\r' <typed | grep -v '^ *$' >got
   grep -v '^ *$' unwatched.txt >expected
   if grep -q 'KF (paper)' got; then pass; else fail "no report on a terminal"; fi
   script -qec "'$gyroakf' run '$work/long.txt' --progress off" /dev/null </dev/null >typed
   if grep -q '\[#' typed; then fail "--progress off draws on a terminal"; else pass; fi
   # a pipe that delivers for more than a second
   for _ in 1 2 3 4; do cat long.txt; done >longer.txt
   script -qec "{ cat '$work/longer.txt'; sleep 1.2; cat '$work/longer.txt'; } | '$gyroakf' inspect -" /dev/null </dev/null >typed
   if grep -q 'MB/s' typed; then pass; else fail "no bar on a terminal after a second"; fi
fi

# an end by the user: 130, nothing on standard output, no file
mkfifo never
"$gyroakf" run never --out ended >out 2>err & process=$!
sleep 0.3
kill -TERM $process
wait $process
is "exit code after SIGTERM" $? 143
is "standard output after SIGTERM" "$(cat out)" ""
if [ -e ended ]; then fail "a folder after SIGTERM"; else pass; fi
rm -f never

# a reader that goes away: a message and exit code 2, no traceback
{ "$gyroakf" simulate --samples 100000 2>err; echo $? >gone; } | head -n 1 >/dev/null
is "exit code where the reader goes away" "$(cat gone)" 2
holds "message where the reader goes away" "gyroakf: error: standard output cannot be written" err
