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
is "report of a streamed record fits 100 columns" "$(LC_ALL=C.UTF-8 awk 'length > 100' out)" ""
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
"$gyroakf" allan - --memory 30MB --json - <large.txt 2>err | grep -vE '"(path|mean|variance|std)"' >piped.json
grep -vE '"(path|mean|variance|std)"' streamed.json >expected.json
if cmp -s piped.json expected.json; then pass; else fail "a pipe that is streamed: $(diff piped.json expected.json | head -n 3)"; fi
good "results of a streamed record" allan large.txt --memory 30MB --out streamed_results --quiet
is "result files" "$(cd streamed_results && ls | tr '\n' ' ')" "allan.csv coefficients.csv report.txt results.json "
good "large enough" allan large.txt --memory 1.5GiB --json - --taus 1,10
is "mode where it fits" "$(grep -c '"mode": "exact"' out)" 2
bad "run needs" 2 "rows need 62" run large.txt --memory 30MB
holds "which commands stream" "gyroakf allan, inspect and filter stream" err
good "inspect streamed" inspect large.txt --memory 30MB
grep -v '^ *\(Memory\|blocks were\|kept\)' out >streamed.txt
holds "inspect says streamed" "streamed, for the recording is larger" out
good "inspect in memory" inspect large.txt
if [ "$(diff out streamed.txt | grep -c '^[<>]')" = 0 ]; then pass; else fail "inspect streamed: $(diff out streamed.txt | head -n 5)"; fi
good "inspect as JSON" inspect large.txt --json whole.json --quiet
good "inspect streamed as JSON" inspect large.txt --memory 30MB --json streamed_inspect.json --quiet
if cmp -s whole.json streamed_inspect.json; then pass; else fail "inspect's JSON: $(diff whole.json streamed_inspect.json | head -n 3)"; fi
bad "all averaging times" 2 "without --taus all" allan large.txt --memory 30MB --taus all
bad "cleaning" 2 "without --outliers" allan large.txt --memory 30MB --outliers auto
bad "segments" 2 "without --dynamic" allan large.txt --memory 30MB --dynamic 4
bad "further kinds" 2 "without --kinds" allan large.txt --memory 30MB --kinds mdev
{ head -n 900000 large.txt; echo x; } >broken.txt
bad "bad line in a late block" 2 "broken.txt:900001:1:" allan broken.txt --memory 30MB
awk 'BEGIN { print "a,b"; for (i = 0; i < 900000; i++) print "1.000," i % 7 }' >constant.csv
good "a constant channel in the stream" allan constant.csv --memory 33MB --rate 1
