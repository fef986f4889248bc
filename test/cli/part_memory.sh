# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# --memory: a recording that does not fit is refused with the memory needed and with options that fit.
"$gyroakf" simulate --samples 1000000 --rate 100 --unit deg/s --coefficients N=0.01,K=0.0005 --offset 5 --output large.txt
awk 'BEGIN { print "# rate_hz: 100"; print "gx,gy,gz"; for (i = 0; i < 300000; i++) print (i * 7919) % 1009 "," (i * 104729) % 997 "," (i * 1299709) % 991 }' >three.csv

# fits BOUND "ARGUMENTS" WAY...: gyroakf ARGUMENTS is refused within BOUND, and each way out that the message names works when it
# is typed; WAY says which they are
fits() {
   local bound=$1 arguments=$2 way ways
   shift 2
   ways=("$@")
   eval "set -- $arguments"
   bad "$arguments within $bound" 2 "rows need " "$@" --memory "$bound"
   for way in "${ways[@]}"; do
      if tail -n 1 err | grep -qE -- "(: |; )$way(;|\$)"; then pass; else fail "no way out '$way' in: $(cat err)"; fi
   done
   tail -n 1 err | sed 's/^what fits: //; s/; /\n/g' >ways
   is "ways out of $arguments" "$(wc -l <ways)" ${#ways[@]}
   while IFS= read -r way; do
      case $way in
         gyroakf*) eval "set -- ${way#gyroakf }" --memory "$bound" ;;
         --memory*) eval "set -- $arguments $way" ;;
         "without --out") eval "set -- ${arguments/ --out results/} --memory $bound" ;;
         *) eval "set -- $arguments --memory $bound $way" ;;
      esac
      good "the way out $way" "$@" --quiet
      rm -rf results
   done <ways
}

fits 30MB "run large.txt" "--to [0-9]+" "--memory [0-9]+MB"
bad "run needs" 2 "about 9999" run large.txt --memory 30MB
holds "what is allowed" "30 MB of memory are allowed" err
fits 50MB "run large.txt" "gyroakf allan large.txt" "--to [0-9]+" "--memory [0-9]+MB"
fits 50MB "run large.txt --from 9000" "gyroakf allan large.txt --from 9000" "--memory [0-9]+MB"
fits 32MB "allan three.csv" "--column 1" "--to [0-9]+" "--memory [0-9]+MB"
fits 32MB "allan three.csv --unit deg/s,deg/s,deg/s" "--to [0-9]+" "--memory [0-9]+MB"
fits 70MB "run large.txt --out results" "without --out" "--to [0-9]+" "gyroakf allan large.txt" "--memory [0-9]+MB"
is "no result of a refused record" "$([ -e results ] && echo there)" ""
# the options that say how a recording is read are part of the way out
good "raw numbers" simulate --samples 1000000 --coefficients N=0.01 --output "raw numbers.f64"
cp "raw numbers.f64" "raw numbers.bin"
fits 50MB "run 'raw numbers.bin' --format f64 --rate 100" "gyroakf allan 'raw numbers.bin' --format f64 --rate 100" "--to [0-9]+" \
   "--memory [0-9]+MB"
rm -f raw*
good "run without series" run large.txt --memory 70MB --quiet
for command in inspect tests ar filter; do bad "$command needs" 2 "rows need " "$command" large.txt --memory 28MB; done
# a pipe: its size is not known, the limit counts
for command in allan run; do
   "$gyroakf" "$command" - --memory 30MB <large.txt >out 2>err; is "$command of a pipe that does not fit" $? 2
   holds "rows of the pipe" "rows need more than" err
   holds "ways of the pipe" "what needs less:" err
done
"$gyroakf" allan - --memory 46MB --json piped.json --quiet <large.txt; is "a pipe that fits" $? 0
good "the same as a file" allan large.txt --json whole.json --quiet
is "a pipe and a file" "$(diff <(no_command_line <piped.json | grep -v '"path"') <(no_command_line <whole.json | grep -v '"path"'))" ""
# --to ends the reading, with the numbers of a recording that ends there
head -n 5003 large.txt >short.txt
good "a part" inspect large.txt --to 20 --json part.json --quiet
holds "samples of the part" '"samples": 2000' part.json
good "the part alone" allan short.txt --to 20 --json short.json --quiet
good "the part of the whole" allan large.txt --to 20 --json part.json --quiet --force
is "a part and the whole" "$(diff <(no_command_line <short.json | grep -v '"path"') <(no_command_line <part.json | grep -v '"path"'))" ""
good "a part of increments" inspect large.txt --to 20 --input increment --unit deg --json part.json --quiet --force
holds "samples of the increments" '"samples": 2000' part.json
good "a part of angles" inspect large.txt --to 20 --input angle --unit deg --json part.json --quiet --force
holds "samples of the angles" '"samples": 2000' part.json
# without --memory the machine's is the bound: a file of a terabyte (a hole behind its first rows) is refused before it is read
head -n 100000 large.txt >hole.txt
if [ -r /proc/meminfo ] && truncate -s 1T hole.txt 2>/dev/null; then
   bad "more than the machine has" 2 "of memory are free" run hole.txt
   bad "tests beyond the machine" 2 "of memory are free" tests hole.txt
fi
rm -f hole.txt
# the address space of the shell is a bound, too
if [ -z "${ASAN_OPTIONS:-}" ] && [ "$(uname)" = Linux ]; then
   (ulimit -v 60000; OMP_NUM_THREADS=1 "$gyroakf" run large.txt --threads 1) >out 2>err </dev/null; is "ulimit -v" $? 2
   holds "what the shell allows" "of memory are free" err
fi
# the process stays below the bound
peak() { # ARGUMENTS...: kilobytes
   python3 -c 'import os, sys
pid = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ, file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)])
_, status, usage = os.wait4(pid, 0)
print(usage.ru_maxrss if status == 0 else "failed")' "$gyroakf" "$@"
}
if [ "$(uname)" = Linux ] && command -v python3 >/dev/null && [ -z "${ASAN_OPTIONS:-}" ]; then
   for pair in "inspect 34" "allan 46" "filter 58" "run 63"; do
      used=$(peak "${pair% *}" large.txt --memory "${pair#* }MB")
      if [ "$used" != failed ] && [ "$used" -lt $((${pair#* }*1000000/1024)) ]; then pass; else fail "peak of $pair: $used kB"; fi
   done
fi
