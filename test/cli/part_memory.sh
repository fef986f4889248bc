# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# --memory: allan streams what is larger, the other commands say what they need.
"$gyroakf" simulate --samples 1000000 --rate 100 --unit deg/s --coefficients N=0.01,K=0.0005 --offset 5 --output large.txt
good "exact" allan large.txt --json exact.json
is "mode of the exact curve" "$(grep -c '"mode": "exact"' exact.json)" 2
good "streamed" allan large.txt --memory 30MB --json streamed.json
holds "report says streamed" "streamed, for the recording is larger" out
is "mode of the streamed curve" "$(grep -c '"mode": "streamed"' streamed.json)" 2
holds "samples of a streamed record" '"samples": 1000000' streamed.json
is "report of a streamed record fits 80 columns" "$(LC_ALL=C.UTF-8 awk 'length > 80' out)" ""
if command -v python3 >/dev/null; then
   # alike: the first six deviations and N of the two documents, relatively
   if python3 - >alike 2>&1 <<'PYTHON'
import json
a, b = (json.load(open(f))["channels"][0] for f in ("exact.json", "streamed.json"))
x, y = a["allan"]["input"], b["allan"]["input"]
assert x["tau_s"] == y["tau_s"]
for i, (p, q) in enumerate(zip(x["deviation"], y["deviation"])):
    assert abs(p/q - 1) < (1e-11 if i < 6 else 0.02), (i, p, q)
for i, (p, q) in enumerate(zip(x["edf"], y["edf"])):
    assert abs(p/q - 1) < 0.03, (i, p, q)
p, q = a["coefficients"]["input"]["N"]["value"], b["coefficients"]["input"]["N"]["value"]
assert abs(p/q - 1) < 1e-3, (p, q)
assert abs(a["raw"]["std"]/b["raw"]["std"] - 1) < 1e-12
PYTHON
   then pass; else fail "streamed and exact: $(cat alike)"; fi
fi
# the blocks of a pipe are cut elsewhere: moments agree but for the last digit
"$gyroakf" allan - --memory 30MB --json - <large.txt 2>err | no_origin | grep -vE '"(path|mean|variance|std)"' >piped.json
no_origin <streamed.json | grep -vE '"(path|mean|variance|std)"' >expected.json
if cmp -s piped.json expected.json; then pass; else fail "a pipe that is streamed: $(diff piped.json expected.json | head -n 3)"; fi
good "results of a streamed record" allan large.txt --memory 30MB --out streamed_results --quiet
is "result files" "$(cd streamed_results && ls | tr '\n' ' ')" "allan.csv coefficients.csv report.html report.txt results.json "
good "large enough" allan large.txt --memory 1.5GiB --json - --taus 1,10
is "mode where it fits" "$(grep -c '"mode": "exact"' out)" 2
bad "run needs" 2 "rows need 62" run large.txt --memory 30MB
holds "which commands stream" "gyroakf allan, inspect and filter stream" err
good "inspect streamed" inspect large.txt --memory 30MB
awk '/^  Memory/ { skip = 1; next } skip && /^   / { next } { skip = 0; print }' out >streamed.txt
holds "inspect says streamed" "streamed, for the recording is larger" out
good "inspect in memory" inspect large.txt
if [ "$(diff out streamed.txt | grep -c '^[<>]')" = 0 ]; then pass; else fail "inspect streamed: $(diff out streamed.txt | head -n 5)"; fi
good "inspect as JSON" inspect large.txt --json whole.json --quiet --force
good "inspect streamed as JSON" inspect large.txt --memory 30MB --json streamed_inspect.json --quiet
is "inspect's JSON, in memory and streamed" "$(diff <(no_origin <whole.json) <(no_origin <streamed_inspect.json) | grep '^[<>]' | tr -d ' \n')" \
   '<"streamed":false,>"streamed":true,'
good "filter in memory" filter large.txt --json whole.json --quiet --force
good "filter streamed with drift" filter large.txt --memory 56MB --json drift.json
holds "filter with drift says streamed" "streamed, for the recording is larger" out
is "a streamed record is smoothed" "$(grep -cE '^  (smoother|compensated) +-?[0-9]' out)" 2
if grep -q "scratch" out; then fail "a scratch file that can be made: $(grep scratch out)"; else pass; fi
bad "the drift of the curve, streamed" 2 "without --drift-source allan" filter large.txt --memory 30MB --drift-source allan
bad "a polynomial under the drift, streamed" 2 "without --drift-degree" filter large.txt --memory 30MB --drift-degree 1
good "filter without drift" filter large.txt --memory 30MB --json streamed.json --force
holds "what a streamed filter lacks" "drift and its filters: to identify it from a part of the record" out
if command -v python3 >/dev/null; then
   # every number of raw, ar, kf and akf alike to rounding
   if python3 - >alike 2>&1 <<'PYTHON'
import json
a, b = (json.load(open(f))["channels"][0] for f in ("whole.json", "streamed.json"))
def compare(x, y, path):
    if isinstance(x, dict):
        assert x.keys() == y.keys(), path
        for k in x: compare(x[k], y[k], path + "." + k)
    elif isinstance(x, list):
        assert len(x) == len(y), path
        for i, (p, q) in enumerate(zip(x, y)): compare(p, q, f"{path}[{i}]")
    elif isinstance(x, float) or isinstance(y, float):
        assert abs(x - y) <= 1e-11*max(abs(x), abs(y), 1e-3), (path, x, y)
    else: assert x == y, (path, x, y)
for key in ("raw", "ar"): compare(a[key], b[key], key)
for key in ("kf", "akf"): compare(a["filters"][key], b["filters"][key], key)
assert b["filters"]["drift_kf"] is None and a["filters"]["drift_kf"] is not None
c = json.load(open("drift.json"))["channels"][0]
for key in ("kf", "akf", "drift_kf", "drift_akf", "drift_smoother"): compare(a["filters"][key], c["filters"][key], key)
compare(a["drift"]["processes"], c["drift"]["processes"], "drift")
assert a["filters"]["drift_smoother"] is not None and b["filters"]["drift_smoother"] is None
assert c["drift"]["samples"] == 131072 and c["drift"]["of_samples"] == 1000000
PYTHON
   then pass; else fail "filter streamed and in memory: $(tail -n 1 alike)"; fi
fi
# the series are written while they go by, the same as in memory but for rounding
good "series of a streamed filter" filter large.txt --memory 56MB --out filtered_streamed --digits 9 --quiet
good "series in memory" filter large.txt --out filtered_whole --digits 9 --quiet
is "result files of a streamed filter" "$(ls filtered_streamed | tr '\n' ' ')" "ar_spectrum.csv report.html report.txt results.json series.csv "
is "lines of the series" "$(wc -l <filtered_streamed/series.csv)" 1000001
is "lines that differ beyond rounding" "$(paste -d, filtered_whole/series.csv filtered_streamed/series.csv |
   awk -F, -v head=time,raw,cleaned,kf,akf,drift,compensated,drift_kf,drift_akf 'NR == 1 { if ($0 != head "," head) n++; next }
   { for (i = 1; i <= 9; i++) { d = $i - $(i + 9); if (d > 1e-7 || d < -1e-7) n++ }
     if ($6 == "nan" || $15 == "nan" || $16 == "nan") n++ } END { print n + 0 }')" 0
# the smoother goes over a scratch file: without room for it the filters go on, and say so; nothing is left of it
is "no scratch file is left" "$(find filtered_streamed . -maxdepth 1 -name '.gyroakf-*')" ""
mkdir scratch
TMPDIR=$PWD/scratch good "a scratch file in TMPDIR" filter large.txt --memory 56MB --json scratched.json --quiet
is "what it gives" "$(no_origin <scratched.json | diff - <(no_origin <drift.json))" ""
is "nothing is left in TMPDIR" "$(ls -A scratch)" ""
TMPDIR=$PWD/nowhere good "no place for a scratch file" filter large.txt --memory 56MB
holds "why there is no smoother" "drift smoother: $PWD/nowhere: a scratch file cannot be made there" out
holds "the other filters" "drift KF" out
if [ -z "${ASAN_OPTIONS:-}" ]; then
   (ulimit -f 4000; "$gyroakf" filter large.txt --memory 56MB) >out 2>err </dev/null   # 4 MB or less of the 16 that it takes
   is "a scratch file that cannot grow" $? 0
   holds "what is full" "a scratch file cannot be written there: is the disk full?" out
fi
good "binary series of a streamed filter" filter large.txt --memory 30MB --out filtered_streamed --series-format npy --force --quiet
is "the other series is gone" "$(ls filtered_streamed | tr '\n' ' ')" "ar_spectrum.csv report.html report.txt results.json series.npy "
good "which can be read" inspect filtered_streamed/series.npy --quiet --json npy.json
holds "samples of the series" '"samples": 1000000' npy.json
bad "a streamed filter keeps results" 2 "is there already and is kept" filter large.txt --memory 30MB --out filtered_streamed \
   --series-format npy
bad "a refused filter leaves no directory" 2 "without --outliers" filter large.txt --memory 30MB --out never --outliers auto
is "no directory" "$([ -e never ] && echo there)" ""
"$gyroakf" filter - --memory 30MB <large.txt >out 2>err; is "filter of a pipe that does not fit" $? 2
holds "why" "standard input or a pipe comes only once" err
bad "filter cleaning" 2 "without --detrend" filter large.txt --memory 30MB --detrend 1
bad "ar needs" 2 "rows need 33" ar large.txt --memory 30MB
holds "what to do" "gyroakf allan, inspect and filter stream" err
bad "tests need" 2 "rows need 36" tests large.txt --memory 30MB
bad "all averaging times" 2 "without --taus all" allan large.txt --memory 30MB --taus all
bad "cleaning" 2 "without --outliers" allan large.txt --memory 30MB --outliers auto
bad "segments" 2 "without --dynamic" allan large.txt --memory 30MB --dynamic 4
bad "further kinds" 2 "without --kinds" allan large.txt --memory 30MB --kinds mdev
{ head -n 900000 large.txt; echo x; } >broken.txt
bad "bad line in a late block" 2 "broken.txt:900001:1:" allan broken.txt --memory 30MB
awk 'BEGIN { print "a,b"; for (i = 0; i < 900000; i++) print "1.000," i % 7 }' >constant.csv
good "a constant channel in the stream" allan constant.csv --memory 33MB --rate 1
# without --memory the machine's is the bound: a file of a terabyte (a hole behind its first rows) is refused before it is read
head -n 100000 large.txt >hole.txt
if [ -r /proc/meminfo ] && truncate -s 1T hole.txt 2>/dev/null; then
   bad "more than the machine has" 2 "of memory can be had" run hole.txt
   holds "what to do then" "insist with --memory SIZE" err
   bad "tests beyond the machine" 2 "of memory can be had" tests hole.txt
fi
rm -f hole.txt
# the process stays below the bound
peak() { # ARGUMENTS...: kilobytes
   python3 -c 'import os, sys
pid = os.posix_spawn(sys.argv[1], sys.argv[1:], os.environ, file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)])
_, status, usage = os.wait4(pid, 0)
print(usage.ru_maxrss if status == 0 else "failed")' "$gyroakf" "$@"
}
if [ "$(uname)" = Linux ] && command -v python3 >/dev/null && [ -z "${ASAN_OPTIONS:-}" ]; then
   for command in inspect allan filter; do
      used=$(peak $command large.txt --memory 30MB)
      if [ "$used" != failed ] && [ "$used" -lt $((30000000/1024)) ]; then pass; else fail "peak of $command: $used kB"; fi
   done
   used=$(TMPDIR=$PWD peak filter large.txt --memory 31.5MB --out smoothed)
   if [ "$used" != failed ] && [ "$used" -lt $((31500000/1024)) ]; then pass; else fail "peak of filter with its smoother: $used kB"; fi
   is "the smoother is there" "$(grep -c '"drift_smoother": {' smoothed/results.json)" 1
   awk 'BEGIN { print "time_s,gx,gy,gz"; for (i = 0; i < 400000; i++) printf "%.2f,%d,%d,%d\n", i/100, i%7, i%11, i%13 }' >three.csv
   for command in inspect allan filter; do
      used=$(peak $command three.csv --memory 36MB)
      if [ "$used" != failed ] && [ "$used" -lt $((36000000/1024)) ]; then pass; else fail "peak of $command, three channels: $used kB"; fi
   done
fi
