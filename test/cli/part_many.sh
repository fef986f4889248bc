# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# Many files: their folders, the summary, files that fail, an end by the user.
mkdir many many/sub
for i in 1 2 3; do
   "$gyroakf" simulate --samples 3000 --rate 100 --unit deg/s --coefficients N=0.01,B=0.001 --seed $i --output many/f$i.txt
done
cp many/f1.txt many/sub/f2.csv
awk 'BEGIN { print "# rate_hz: 10\n# units: rad/s m/s^2\na,b"; for (i = 0; i < 500; i++) print (i*7919)%101/1e4 "," (i*104729)%211/1e4 }' >many/two.csv
printf '1\n2\nx\n' >many/broken.txt

# the files that the summary names
listed() { awk '/^  (-|many)/ { print $1 }' out | sort -u | tr '\n' ' '; }

# the same results as of a run of each file alone, whatever the threads, in the order of the arguments
for command in run allan tests ar filter inspect; do
   good "$command of many files" $command many/f1.txt many/two.csv many/sub/f2.csv many/f2.txt --out many_$command
   is "$command: summary on standard output fits 80 columns" "$(LC_ALL=C.UTF-8 awk 'length > 80' out)" ""
   is "$command: files of the summary" "$(listed)" "many/f1.txt many/f2.txt many/sub/f2.csv many/two.csv "
   is "$command: folders" "$(cd many_$command && echo *)" "f1 f2 f2-2 summary.csv summary.json two"
   good "$command alone" $command many/two.csv --out alone_$command
   for file in $(cd alone_$command && find . -type f ! -name report.html); do   # which holds the command line and the file's number
      if cmp -s <(no_command_line <"alone_$command/$file") <(no_command_line <"many_$command/two/$file"); then pass; else
         fail "$command: many/two/$file differs"; fi
   done
   rm -rf many_1; good "$command on one thread" $command many/f1.txt many/two.csv many/sub/f2.csv many/f2.txt --out many_1 --threads 1
   if sed 's/many_1/many_'$command'/' many_1/summary.json | cmp -s - many_$command/summary.json; then pass
   else fail "$command: the summary depends on the threads"; fi
   is "$command: lines of summary.csv" "$(wc -l <many_$command/summary.csv)" 6
   is "$command: columns of summary.csv" "$(awk -F, '{ print NF }' <(grep -v '"' many_$command/summary.csv) | sort -u)" 50
done
good "rows in order" inspect many/f1.txt many/two.csv many/sub/f2.csv many/f2.txt
is "rows of files and channels" "$(awk '/^  many/ { print $1, $2 }' out | tr '\n' ' ')" \
   "many/f1.txt gx many/two.csv a many/two.csv b many/sub/f2.csv gx many/f2.txt gx "
good "summary as JSON" tests many/f1.txt many/f2.txt --json -
is "standard output is the document" "$(head -c 1 out)" "{"
good "summary as a JSON file" tests many/f1.txt many/f2.txt --json tests.json --quiet
is "--quiet prints no table" "$(cat out)" ""
if [ -s tests.json ]; then pass; else fail "no tests.json"; fi
if command -v python3 >/dev/null; then
   if python3 - many_run tests.json "$root/doc/summary.schema.json" >wrong 2>&1 <<'PYTHON'
import csv, json, math, sys
folder, other, schema = sys.argv[1:]
document = json.load(open(folder + "/summary.json"))
lines = list(csv.DictReader(open(folder + "/summary.csv")))
schema = json.load(open(schema))
def check(value, rule, path):                   # the part of JSON schema that doc/summary.schema.json uses
    kinds = rule.get("type", [])
    kinds = [kinds] if isinstance(kinds, str) else kinds
    names = {dict: "object", list: "array", str: "string", bool: "boolean", int: "integer", float: "number", type(None): "null"}
    kind = names[type(value)]
    assert not kinds or kind in kinds or (kind == "integer" and "number" in kinds), (path, kind, kinds)
    if "const" in rule: assert value == rule["const"], path
    if "$ref" in rule: check(value, schema["$defs"][rule["$ref"].split("/")[-1]], path)
    if isinstance(value, dict):
        for key in rule.get("required", []): assert key in value, (path, key)
        for key in value:
            if "properties" in rule: assert key in rule["properties"], (path, key, "is not in the schema")
            check(value[key], rule.get("properties", {}).get(key, {}), path + "/" + key)
    if isinstance(value, list):
        for i, item in enumerate(value): check(item, rule.get("items", {}), "%s/%d" % (path, i))
for name in folder + "/summary.json", other: check(json.load(open(name)), schema, name)
channels = [(f, c) for f in document["files"] for c in f["channels"]]
assert len(channels) == len(lines) == 5 and document["failed"] == 0
for (file, channel), line in zip(channels, lines):
    alone = json.load(open(file["folder"] + "/results.json"))
    result = [c for c in alone["channels"] if c["name"] == channel["name"]][0]
    assert line["path"] == file["path"] and line["channel"] == channel["name"] and int(line["exit_code"]) == 0
    assert channel["std"] == result["raw"]["std"] and math.isclose(float(line["std"]), channel["std"], rel_tol=1e-14)
    for term in "QNBKR":
        for key in "value", "std_error", "upper_limit", "detected", "unit":
            assert (channel["coefficients"][term] or {}).get(key) == result["coefficients"]["input"][term][key] or \
                channel["coefficients"][term] is None, (term, key)
    assert (channel["drift"] or "") == line["drift"] and channel["drift"] == result["verdict"]["drift"], (channel["drift"], result["verdict"])
    assert channel["kf_variance"] == result["filters"]["kf"]["variance"]
    assert channel["akf_variance"] == result["filters"]["akf"]["variance"]
    assert channel["ar_order"] == result["ar"]["order"] and channel["adf_p_value"] == result["tests"]["adf"]["p_value"]
PYTHON
   then pass; else fail "the summary: $(tail -n 2 wrong)"; fi
fi

# names of folders
cp many/f1.txt many/f2-2.txt
cp many/f1.txt many/summary.csv.txt
cp many/f1.txt many/.hidden
cp many/f1.txt "many/with blank, comma.txt"
good "names that are taken" inspect many/f2.txt many/sub/f2.csv many/f2-2.txt many/f2.txt many/summary.csv.txt many/.hidden \
   "many/with blank, comma.txt" --out names/
is "folders" "$(cd names && ls -A | tr '\n' '|')" \
   ".hidden|f2|f2-2|f2-2-2|f2-3|summary.csv|summary.csv-2|summary.json|with blank, comma|"
is "a comma in a name" "$(grep -c '^"many/with blank, comma.txt","names/with blank, comma",0,' names/summary.csv)" 1

# a bad file does not stop the others
run run many/f1.txt many/broken.txt nowhere.txt many many/f2.txt --out some --json failed.json
is "the highest exit status" $code 2
is "messages of the files that failed, in order" "$(grep -c '^gyroakf: error: ' err) $(grep 'error: ' err | cut -d: -f3 | tr -d '\n')" \
   "3  many/broken.txt nowhere.txt many"
is "folders of the others" "$(cd some && echo *)" "f1 f2 summary.csv summary.json"
holds "failed files" "5 files, 3 failures" out
is "codes in summary.csv" "$(cut -d, -f3 some/summary.csv | tr '\n' ' ')" "exit_code 0 2 2 2 0 "
is "failed files in the document" "$(grep -c '"exit_code": 2' failed.json)" 3
good "what --progress draws is none of the results" inspect many/f1.txt many/f2.txt --progress off

# other files are kept, unless --force says otherwise
echo old >some/f1/results.json
bad "a file that is no result" 2 "some/f1/report.txt: already exists" inspect many/f3.txt many/f1.txt --out some
if [ -e some/f3 ]; then fail "a folder although the others are kept"; else pass; fi
good "--force" inspect many/f3.txt many/f1.txt --out some --force
good "inspect into a folder" inspect many/f1.txt --out looked --quiet
is "files of inspect" "$(cd looked && echo *)" "report.txt results.json"
good "inspect replaces them" inspect many/f1.txt --out looked --quiet

# a list
printf '# of today\n\n  many/f1.txt \r\nmany/f2.txt\n# many/f3.txt\nmany/sub/f2.csv' >list.txt
good "a list" tests --list list.txt
is "files of the list" "$(listed)" "many/f1.txt many/f2.txt many/sub/f2.csv "
good "a list of one" tests --list <(echo many/f3.txt) --json -
is "a list gives a summary" "$(grep -c '"failed": 0' out)" 1
good "files, then a list" tests many/f3.txt --list list.txt
is "all of them" "$(listed)" "many/f1.txt many/f2.txt many/f3.txt many/sub/f2.csv "
"$gyroakf" tests --list - <list.txt >out 2>err
is "a list on standard input" "$? $(listed)" "0 many/f1.txt many/f2.txt many/sub/f2.csv "
"$gyroakf" tests - many/f2.txt <many/f1.txt >out 2>err
is "a record on standard input beside a file" "$? $(listed)" "0 - many/f2.txt "
printf '# nothing\n' >empty.txt
bad "a list without a file" 2 "empty.txt: names no file" run --list empty.txt
bad "a list that is not there" 2 "nowhere.txt: no such file" run --list nowhere.txt
head -c 1000 /dev/zero >zero.bin
bad "a list that is no text" 2 "is no list of files" run --list zero.bin
bad "standard input twice" 1 "can be read once" run - --list -
bad "standard input twice as a record" 1 "can be read once" run - -
bad "Kalibr's file of many without --out" 1 "needs --out" allan many/f1.txt many/f2.txt --kalibr imu.yaml
bad "Kalibr's file of many with a folder" 1 "without a folder" allan many/f1.txt many/f2.txt --kalibr x/imu.yaml --out k
bad "Kalibr's file named as a result" 1 "same file" allan many/f1.txt many/f2.txt --kalibr report.txt --out k
bad "the document over a recording" 1 "overwrite" allan many/f1.txt ./many/f2.txt --json many/f2.txt
good "Kalibr's file of many" allan many/f1.txt many/f2.txt --kalibr imu.yaml --out k --quiet
is "Kalibr's files" "$(ls k/*/imu.yaml | tr '\n' ' ')" "k/f1/imu.yaml k/f2/imu.yaml "

# a file that does not fit into the memory is a failed one
"$gyroakf" simulate --samples 1200000 --rate 100 --unit deg/s --coefficients N=0.01 --output many/large.txt
run run many/large.txt many/f1.txt --memory 60MB
is "larger than the memory" "$code $(grep -c '2 files, 1 failure' out)" "2 1"

# an end by the user
mkfifo never
"$gyroakf" inspect many/f1.txt never --out ended >out 2>err & process=$!
sleep 1
kill -TERM $process
wait $process
is "an end by the user" "$? $(cat out)" "143 "
if [ -e ended/summary.csv ]; then fail "a summary is left after an end by the user"; else pass; fi
rm -f never

# a thousand files with a few descriptors
mkdir thousand
for ((i = 0; i < 1000; i++)); do echo "thousand/f$((i % 10)).txt"; done >thousand.txt
for i in 0 1 2 3 4 5 6 7 8 9; do seq 1 $((20 + i)) >thousand/f$i.txt; done
(ulimit -n 40; "$gyroakf" inspect --list thousand.txt --json thousand.json --quiet 2>err)
is "a thousand files" "$? $(grep -c '"exit_code": 0' thousand.json) $(cat err)" "0 1000 "
