# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# results.json tells options and checksums; --repeat does the run once more.

numbers() { no_origin <"$1"; }

good "a record with its truth" simulate --samples 3000 --rate 50 --coefficients N=0.01,K=0.002 --seed 9 --output rep.txt --truth rep_drift.txt
good "a run" rep.txt --dt 0.02 --taus log:4 --terms QNK --forgetting 0.97 --order 2 --from 1.5 --to 55 --truth rep_drift.txt --out rep1 --quiet
holds "an effective value" '"rate": 50,' rep1/results.json
holds "a default" '"confidence": 0.683,' rep1/results.json
holds "an option that nobody gave" '"lags": null,' rep1/results.json
holds "what was given" '"given": ["rate", "from", "to", "order", "forgetting", "taus", "terms", "out", "truth", "quiet"],' rep1/results.json
if command -v sha256sum >/dev/null; then
   holds "checksum" "\"sha256\": \"$(sha256sum <rep.txt | cut -c -64)\"" rep1/results.json
   holds "checksum of the truth" "\"sha256\": \"$(sha256sum <rep_drift.txt | cut -c -64)\"" rep1/results.json
fi
holds "length" "\"bytes\": $(wc -c <rep.txt)" rep1/results.json
good "the run repeated" run --repeat rep1/results.json --out rep2 --quiet
is "the same numbers" "$(numbers rep2/results.json | cmp - <(numbers rep1/results.json) 2>&1)" ""
for file in series.csv allan.csv coefficients.csv correlation.csv histogram.csv spectrum.csv ar_spectrum.csv report.txt; do
   if cmp -s rep1/$file rep2/$file; then pass; else fail "--repeat: another $file"; fi
done
good "a repetition repeated" --repeat rep2/results.json --json - --quiet
is "the same numbers again" "$(numbers out | cmp - <(numbers rep1/results.json) 2>&1)" ""
good "the line comes on top" --repeat rep1/results.json --json - --taus 0.5,2 --rate 100 --order 1
holds "the line's rate" '"rate": 100,' out
holds "the line's times" '"tau_s": [0.5, 2]' out
"$gyroakf" run - --rate 50 --json rep_in.json --quiet <rep.txt 2>err
holds "no checksum of a pipe" '"sha256": null' rep_in.json
"$gyroakf" --repeat rep_in.json --json rep_in2.json --quiet <rep.txt 2>err
is "standard input repeated" "$(numbers rep_in2.json | cmp - <(numbers rep_in.json) 2>&1)" ""
for command in inspect allan tests ar filter; do
   good "$command with a document" $command rep.txt --json rep_$command.json --quiet
   good "$command repeated" --repeat rep_$command.json --json - --quiet
   is "$command: the same document" "$(numbers out | cmp - <(numbers rep_$command.json) 2>&1)" ""
done
good "many files" allan rep.txt rep_drift.txt --out rep_many
good "one of them repeated" --repeat rep_many/rep_drift/results.json --json - --quiet
is "one of many: the same document" "$(numbers out | cmp - <(numbers rep_many/rep_drift/results.json) 2>&1)" ""

# every option of a command that has a value keeps it when it is given: --write-config, as a file of options, is another way to say it
run allan --help
grep -oE '^  --[a-z-]+' out | sed 's/^  --//' | grep -vxE 'help|version|citation|man|completion|config|repeat|write-config|dt' |
   while read -r name; do grep -qE "^      \"$name\": " rep_allan.json || echo "$name"; done >missing
is "options of allan in its document" "$(cat missing)" ""

bad "another command" 1 "rep1/results.json is of another command: gyroakf run --repeat rep1/results.json" allan --repeat rep1/results.json
bad "--config too" 1 "--config and --repeat both name a file" --repeat rep1/results.json --config c.toml
cp rep.txt rep_kept.txt
printf '0.123\n' >>rep.txt
bad "a longer file" 2 "rep.txt: is not the file of the run that is to be repeated: it has $(wc -c <rep.txt) bytes" --repeat rep1/results.json
sed '$!s/1\([0-9]\)$/2\1/' rep_kept.txt >rep.txt
is "of the same length" "$(wc -c <rep.txt)" "$(wc -c <rep_kept.txt)"
bad "another file" 2 "it has SHA-256 " --repeat rep1/results.json
holds "what to do" "gyroakf run rep.txt --repeat" err
good "another file that is named" rep.txt --repeat rep1/results.json --quiet --json -
holds "the other file" "$(sha256sum <rep.txt | cut -c -64)" out
cp rep_kept.txt rep.txt
mv rep_drift.txt rep_moved.txt
bad "the truth is gone" 2 "rep_drift.txt: no such file" --repeat rep1/results.json
good "the truth that is named" --repeat rep1/results.json --truth rep_moved.txt --quiet --json -
mv rep.txt rep_away.txt
bad "the recording is gone" 2 "go to its folder, or name the file" --repeat rep1/results.json

bad "no results.json" 2 "rep_kept.txt:1:1: " --repeat rep_kept.txt
holds "how to get one" "--out DIR writes a results.json" err
head -c 700 rep1/results.json >rep_cut.json
bad "a document that is cut" 2 "rep_cut.json:" --repeat rep_cut.json
sed 's/"terms": "QNK"/"terms": QNK/' rep1/results.json >rep_bad.json
bad "line and column" 2 "rep_bad.json:$(grep -n 'QNK,' rep_bad.json | cut -d: -f1):16: a value is missing" --repeat rep_bad.json
sed 's/"terms": "QNK"/"terms": "XYZ"/' rep1/results.json >rep_bad.json
bad "a value that is none" 1 "rep_bad.json:$(grep -n XYZ rep_bad.json | cut -d: -f1): option '--terms" rep_kept.txt --repeat rep_bad.json
sed 's/"given": \["rate"/"given": ["pace"/' rep1/results.json >rep_bad.json
bad "an unknown option" 2 "this version has no option '--pace'" --repeat rep_bad.json
sed 's/"sha256": "[0-9a-f]*"/"sha256": "12"/' rep1/results.json >rep_bad.json
bad "a damaged checksum" 2 "'origin' is damaged" --repeat rep_bad.json
printf '{"schema": 1, "program": "gyroakf", "origin": null}' >rep_bad.json
bad "a document of the library" 2 "does not tell the options of its run" --repeat rep_bad.json
printf '{"a": 1}' >rep_bad.json
bad "another program's" 2 "was not written by gyroakf" --repeat rep_bad.json

# an option that was given has a value in the document, whatever it does
good "options of every kind" run rep_away.txt --quiet --force --ascii --color never --chart off --markdown rep_t.md --latex rep_t.tex \
   --json rep_all.json
given=$(sed -n 's/^.*"given": \[\(.*\)\].*$/\1/p' rep_all.json | tr -d '",')
is "what was given" "$given" "json markdown latex chart color ascii force quiet"
for word in $given; do
   if grep -qF "\"$word\": null" rep_all.json; then fail "--$word was given and has no value"; else pass; fi
done
rm rep_t.md
good "a run whose tables are not repeated" run --repeat rep_all.json --json rep_again.json --quiet
if [ -e rep_t.md ]; then fail "the tables were repeated"; else pass; fi
if cmp -s <(numbers rep_all.json) <(numbers rep_again.json); then pass; else fail "repeated without the tables: other numbers"; fi
