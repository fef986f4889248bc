# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Results: their forms, what is there already, what cannot be written. Read by run.sh.

good "a record as text" simulate --samples 3000 --rate 100 --coefficients N=0.01 --seed 4 --output w.txt
good "a record for NumPy" simulate --samples 3000 --rate 100 --coefficients N=0.01 --seed 4 --output w.npy
good "a record as numbers" simulate --samples 3000 --rate 100 --coefficients N=0.01 --seed 4 --output w.f64
is "bytes of the numbers" "$(wc -c <w.f64)" 24000
if cmp -s <(tail -c 24000 w.npy) w.f64; then pass; else fail "w.npy does not end with the numbers of w.f64"; fi
good "digits" simulate --samples 30 --rate 100 --coefficients N=0.01 --seed 4 --digits 3 --output w3.txt
is "three digits" "$(grep -v '^#' w3.txt | tr -d '0.\n-' | awk '{ print (length($0) <= 90) }')" 1
bad "too many digits" 1 "17 digits" simulate --digits 18
good "a sensor" simulate --samples 300 --rate 100 --coefficients N=0.01 --tails laplace --offset 1 --lowpass 20,2 --resonance 10,5 \
   --lsb 0.25 --output w_sensor.txt
is "its values are multiples of the LSB" "$(grep -v '^#' w_sensor.txt | awk '$1 * 4 != int($1 * 4) || !/[0-9]/' | wc -l)" 0
holds "its command" "--tails laplace --offset 1 --lowpass 20,2 --resonance 10,5 --lsb 0.25" w_sensor.txt

# what was written reads back as the same numbers
good "the series" filter w.txt --out w_csv --quiet
good "the series for NumPy" filter w.txt --out w_npy --series-format npy --quiet
good "the series as numbers" filter w.txt --out w_f64 --series-format f64 --quiet
is "files of the series" "$(ls w_csv w_npy w_f64 | grep series | tr '\n' ' ')" "series.csv series.f64 series.npy "
is "bytes of the series" "$(wc -c <w_f64/series.f64)" $((9 * 8 * 3000))
if command -v python3 >/dev/null; then
   if python3 - w_csv/series.csv w_f64/series.f64 w.txt <<'END'
import array, math, sys
rows = [list(map(float, line.split(","))) for line in open(sys.argv[1]).readlines()[1:]]
flat = array.array("d", open(sys.argv[2], "rb").read())
as_read = [float(line) for line in open(sys.argv[3]) if line[0] != "#"]
same = lambda a, b: a == b or (math.isnan(a) and math.isnan(b))
assert len(rows) == 3000 and [r[1] for r in rows] == as_read
assert all(same(a, b) for r, i in zip(rows, range(0, len(flat), 9)) for a, b in zip(r[1:], flat[i + 1:i + 9]))
assert all(abs(r[0] - flat[9 * i]) < 1e-13 for i, r in enumerate(rows))
END
   then pass; else fail "series.csv and series.f64 hold other numbers"; fi
fi

# what gyroakf wrote is replaced; other files, records and files of options are kept
good "results again" run w.txt --out w_csv --json w_again.json --kalibr w.yaml --rate 100 --unit deg/s --quiet
good "and again" allan w.txt --out w_csv --json w_again.json --kalibr w.yaml --rate 100 --unit deg/s --quiet
is "results of the earlier run are gone" "$(cd w_csv && echo *)" "allan.csv coefficients.csv figures report.html report.txt results.json"
holds "those of the new one are there" "gyroakf allan w.txt" w_again.json
holds "and in the page" "gyroakf allan w.txt" w_csv/report.html
good "an inspection over them" inspect w.txt -o w_csv -q
is "no page of the earlier run" "$(cd w_csv && echo *)" "figures report.txt results.json"
good "binary series again" filter w.txt --out w_npy --series-format f64 --quiet
is "one form of the series" "$(cd w_npy && echo series.*)" "series.f64"

# kept NAME FILE ARGUMENTS...: the file is refused and stays as it is
kept() {
   local name=$1 file=$2 sum; shift 2
   sum=$(cksum <"$file")
   bad "$name" 2 "$file: already exists; use --force to overwrite it" "$@"
   is "$name is kept" "$(cksum <"$file")" "$sum"
}
good "the series of a run" run w.txt --out w_csv --quiet
echo old >w.json
mkdir w_mixed
for name in $(cd w_csv && echo *.*) series.npy series.f64; do
   mkdir w_mixed/$name && cp w_csv/*.* w_mixed/$name && cp w.txt w_mixed/$name/$name
done
for name in $(cd w_csv && echo *.*) series.npy series.f64; do
   case $name in report.txt) continue ;; esac                     # beside results.json it is taken for that of the run
   file=$name
   [ $name != results.json ] || file=report.txt                   # refused first: nothing says that it is of gyroakf
   kept "another $name" w_mixed/$name/$file run w.txt --out w_mixed/$name
done
kept "a JSON file" w.json run w.txt --json w.json
printf '{\n  "result": {\n    "program": "gyroakf"\n  }\n}\n' >w_nested.json
kept "a document around one" w_nested.json run w.txt --json w_nested.json
kept "a record" w.txt simulate --output w.txt
kept "a record as a result" w3.txt run w.txt --json w3.txt
kept "a record as Kalibr's file" w3.txt run w.txt --rate 100 --unit deg/s --kalibr w3.txt
sed -i 's/imu0 .*/imu7/' w.yaml
kept "a file of Kalibr that was completed" w.yaml allan w.txt --rate 100 --unit deg/s --kalibr w.yaml
good "by force" run w.txt --json w.json --out w_csv --series-format f64 --force --quiet
cp w.txt w_csv/series.csv
good "an inspection by force" inspect w.txt --out w_csv --force --quiet
is "it removes results only" "$(cd w_csv && echo *)" "figures report.txt results.json series.csv"
good "by force again" run w.txt --out w_csv --series-format f64 --force --quiet
rm w_csv/series.csv
is "an earlier run's series are gone" "$(ls w_csv | tr '\n' ' ')" "allan.csv ar_spectrum.csv coefficients.csv correlation.csv figures report.html report.txt results.json series.f64 spectrum.csv "
good "a device is no result" run w.txt --json /dev/null

# nothing half written: a full disk, a folder that is read-only, a request to end
if [ -e /dev/full ]; then
   bad "a full disk" 2 "cannot be written" simulate --output /dev/full
fi
if [ "$(id -u)" -ne 0 ]; then
   mkdir w_locked && chmod 555 w_locked
   bad "a folder that is read-only" 2 "w_locked" simulate --output w_locked/x.txt
fi
(ulimit -f 40; "$gyroakf" simulate --samples 100000 --output w_large.txt) >out 2>err
is "a file that grows too large" "$? $(ls w_large* 2>/dev/null)" "2 "
holds "it is said" "w_large.txt: cannot be written" err
"$gyroakf" simulate --samples 10000000 --output w_endless.txt >out 2>err &
process=$!
while kill -0 $process 2>/dev/null && ! ls w_endless.txt.part* >/dev/null 2>&1; do sleep 0.02; done
kill -TERM $process
wait $process
is "a request to end leaves nothing" "$? $(ls w_endless* 2>/dev/null)" "143 "
good "many files" allan w.txt w.f64 --rate 100 --out w_many --quiet
good "many files again" allan w.txt w.f64 --rate 100 --unit deg/s --out w_many --kalibr imu.yaml --write-config w_many.toml --quiet
good "and again" allan w.txt w.f64 --rate 100 --unit deg/s --out w_many --kalibr imu.yaml --quiet
for file in w_many/summary.csv w_many/summary.json w_many/w-2/allan.csv w_many/w/imu.yaml; do
   cp $file w_kept && echo old >$file
   kept "another $file" $file allan w.txt w.f64 --rate 100 --unit deg/s --out w_many --kalibr imu.yaml
   cp w_kept $file
done
good "many files beside the results of one" allan w.txt w.f64 --rate 100 --out w_csv --quiet
is "their folders" "$(ls -d w_csv/*/ | tr '\n' ' ')" "w_csv/figures/ w_csv/w-2/ w_csv/w/ "
is "the mode of a new folder" "$(umask 027; "$gyroakf" inspect w.txt --out w_mode/below --quiet; ls -ld w_mode w_mode/below | cut -c 1-10 | uniq)" drwxr-x---
