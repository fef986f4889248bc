# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# What is written where, and what happens where it cannot be.
example=$root/example/data/mems_gyro_x.txt

# number KEY FILE: the first number of that key in a JSON document
number() { sed -nE "s/^.*\"$1\": *(-?[0-9.eE+-]+).*/\1/p" "$2" | head -n 1; }
# near NAME ACTUAL EXPECTED TOLERANCE
near() {
   if awk -v a="$2" -v e="$3" -v t="$4" 'BEGIN { d = a - e; if (d < 0) d = -d; exit !(a != "" && d <= t) }'; then pass
   else fail "$1: $2 is not $3 within $4"; fi
}

good "simulate the paper's record" simulate --preset paper
if cmp -s out "$example"; then pass; else fail "simulate --preset paper is not example/data/mems_gyro_x.txt"; fi
good "simulate into a file" simulate --preset paper --output paper.txt
if cmp -s paper.txt "$example"; then pass; else fail "simulate --output differs"; fi
is "simulate --output prints nothing" "$(cat out)" ""
good "simulate with terms" simulate --samples 2000 --rate 100 --coefficients N=0.005,B=0.001,R=-1e-6 --seed 7 \
   --missing 0.01 --output terms.txt
holds "simulate states the seed" "7" terms.txt
good "simulated record is read" inspect terms.txt --json -
is "simulated samples" "$(number samples out)" 2000
is "simulated rate" "$(number rate_hz out)" 100
holds "command line" '"command_line": "gyroakf inspect terms.txt --json -"' out

good "run on the example" run "$example" --details --out results --json all.json
holds "report on standard output" "AKF" out
is "report fits 80 columns" "$(LC_ALL=C.UTF-8 awk 'length > 80' out)" ""
is "the result files" "$(cd results && echo *)" "allan.csv ar_spectrum.csv coefficients.csv correlation.csv figures report.html report.txt results.json series.csv spectrum.csv"
if cmp -s results/results.json all.json; then pass; else fail "results.json and --json differ"; fi
if cmp -s results/report.txt out; then pass; else fail "report.txt and standard output differ"; fi
is "series.csv is complete" "$(grep -c '^[-0-9]' results/series.csv)" 12000
sum=$(cat results/*.*[!l] | no_command_line | cksum)                # all but report.html, which has the command line in it
good "run into the same directory again" run "$example" --out results --quiet
is "--quiet prints nothing" "$(cat out)" ""
is "the same results again" "$(cat results/*.*[!l] | no_command_line | cksum)" "$sum"
is "nothing is left aside" "$(cd results && echo * .[!.]*)" "allan.csv ar_spectrum.csv coefficients.csv correlation.csv figures report.html report.txt results.json series.csv spectrum.csv .[!.]*"

if command -v python3 >/dev/null; then
   # the numbers that issue and README promise: ratio of KF and cleaned variance, phi, order, stationarity, AKF below KF
   if python3 - all.json <<'PYTHON'
import json, math, sys
channel = json.load(open(sys.argv[1]))["channels"][0]
kf, akf, clean = (channel["filters"]["kf"]["variance"], channel["filters"]["akf"]["variance"], channel["preprocess"]["variance"])
ar = channel["ar"]
def check(name, holds):
    if not holds: sys.exit("run on the example: " + name)
check("KF variance ratio %g" % (kf/clean), abs(kf/clean/0.2845 - 1) < 0.06)
check("AKF variance", 0 < akf < kf)
check("phi %r" % ar["coefficients"], abs(ar["coefficients"][0] - 0.41) < 3*ar["std_errors"][0])
table = ar["table"]
check("order by BIC", min(table, key=lambda row: row["bic"])["order"] == 1)
check("ADF", channel["tests"]["adf"]["stationary"] is True)
check("outliers removed", channel["preprocess"]["outliers"]["removed"] >= 12)
for stage in "input", "cleaned", "kf", "akf":
    for term in "QNBKR":
        value = channel["coefficients"][stage][term]["value"]
        check(stage + " " + term, value is None or (math.isfinite(value) and (value >= 0 or term == "R")))
noise = channel["coefficients"]["input"]
for term, degrees in zip("QNBKR", (3600, 60, 3600, 216000, 12960000)):   # arcsec, deg/sqrt(h), deg/h, ... of one in deg and s
    if noise[term]["value"] is None: continue        # Q where the first points are left out
    check(term + " in SI", math.isclose(noise[term]["value"], math.degrees(noise[term]["value_si"])*degrees, rel_tol=1e-14))
for stage in "input", "cleaned":                     # the AR(1) is white of N = 0.9495 deg/sqrt(h) to long times, and nothing else
    n, b = channel["coefficients"][stage]["N"], channel["coefficients"][stage]["B"]
    check(stage + " N %g" % n["value"], abs(n["value"] - 0.9495) < 2*n["std_error"])
    check(stage + " B", not b["detected"] and b["upper_limit"] > 0)
    check(stage + " left out", channel["coefficients"][stage]["fit"]["left_out"] > 0)
check("two-sided density", math.isclose(noise["density"]["two_sided"]["value"]*60, noise["N"]["value"], rel_tol=1e-14))
check("one-sided density", math.isclose(noise["density"]["one_sided"]["value_si"], noise["N"]["value_si"]*2**0.5, rel_tol=1e-14))
PYTHON
   then pass; else fail "numbers of the example"; fi
fi

"$gyroakf" run "$example" --json one.json --threads 1 --quiet && "$gyroakf" run "$example" --json two.json --threads 2 --quiet
if command -v python3 >/dev/null; then
   if python3 - one.json two.json <<'PYTHON'
import json, sys
def compare(a, b, path):
    if type(a) is not type(b): sys.exit("%s: %r %r" % (path, a, b))
    if isinstance(a, dict):
        if a.keys() != b.keys(): sys.exit(path + ": keys")
        for key in a: compare(a[key], b[key], path + "/" + key)
    elif isinstance(a, list):
        if len(a) != len(b): sys.exit(path + ": length")
        for i, pair in enumerate(zip(a, b)): compare(*pair, "%s/%d" % (path, i))
    elif isinstance(a, float):
        if abs(a - b) > 1e-12*max(abs(a), abs(b)): sys.exit("%s: %.17g %.17g" % (path, a, b))
    elif a != b: sys.exit("%s: %r %r" % (path, a, b))
documents = [json.load(open(name)) for name in sys.argv[1:3]]
for document in documents: del document["command_line"]
compare(*documents, "")
PYTHON
   then pass; else fail "--threads 1 and 2 differ"; fi
fi

for command in allan tests ar filter; do
   good "$command" $command "$example"
   is "$command fits 80 columns" "$(LC_ALL=C.UTF-8 awk 'length > 80' out)" ""
   good "$command with JSON" $command "$example" --json -
   is "$command --json - prints only JSON" "$(head -c 1 out)" "{"
   good "$command into a directory" $command "$example" --out "dir_$command" --quiet
   for file in report.txt results.json; do
      if [ -s "dir_$command/$file" ]; then pass; else fail "$command --out: no $file"; fi
   done
done
good "allan with options" allan "$example" --taus log:5 --confidence 0.95 --terms NBK --fit-tau-min 0.5 --fit-tau-max 500
good "further kinds of deviation" allan "$example" --kinds mdev,oadev,tdev,mdev,ohdev --taus decade --out kinds --json kinds.json
for kind in mdev tdev ohdev; do
   is "JSON has $kind raw and cleaned" "$(grep -o "\"kind\": *\"$kind\"" kinds.json | wc -l)" 2
   is "the report has a table of $kind" "$(grep -c "^Raw: $kind in deg/s" kinds/report.txt)" 1
   if grep -q ",input,$kind,1," kinds/allan.csv; then pass; else fail "allan.csv has no $kind"; fi
done
is "tdev has the unit of an angle" "$(grep -c "tdev in deg/s times tau" kinds/report.txt)" 1
good "coefficients read off the curve" allan "$example" --json read.json
near "N read off the curve" "$(sed -n '/"read_off"/,/}/p' read.json | number N /dev/stdin)" 0.9495 0.05
is "no segment is null" "$(sed -n '/"read_off"/,/}/p' read.json | grep -c '"K": null')" 2
holds "the report states the minimum" "minimum 6.446, at tau = 102.4 s" <("$gyroakf" allan "$example" --details)
good "further kinds of a record with gaps" allan "$example" --kinds mdev,tdev,totdev --outliers pauta --outlier-threshold 2.5 --out gapped
for kind in mdev tdev totdev; do
   is "the report has a table of $kind with gaps" "$(grep -c "^Raw: $kind in deg/s" gapped/report.txt)" 1
done
is "no warning of a kind" "$(grep -c "is not computed" out)" 0
good "a low-pass filter" simulate --samples 200000 --rate 100 --coefficients N=0.005 --lowpass 20,2 --seed 5 --output lowpass.txt
good "its octaves are excluded" allan lowpass.txt --details --json lowpass.json
holds "the report states it" "Q               state withheld" out
is "Q is withheld" "$(sed -n '/"input": {$/,/"N": {/p' lowpass.json | grep -c '"state": "withheld"')" 1
good "a step of one standard deviation" simulate --samples 100000 --rate 100 --coefficients N=0.001 --lsb 0.01 --output lsb.txt
good "N without quantization" allan lsb.txt --details --json lsb.json
near "is that before rounding" "$(sed -n '/"N_without_quantization"/,/}/p' lsb.json | number value /dev/stdin)" 0.06 0.0007
holds "the report has it" "N unquantized   = 0.0" out
good "a step of four" simulate --samples 100000 --rate 100 --coefficients N=0.001 --lsb 0.04 --output lsb.txt --force
good "a coarse record" allan lsb.txt --details
holds "withheld" "N unquantized   state withheld" out
holds "with a warning" "is not small beside the noise" out
good "a slow Markov process alone" simulate --samples 200000 --rate 10 --ar 0.98 --ar-variance 1e-4 --seed 5 --output markov.txt
good "no coefficient of it" allan markov.txt --details --json markov.json
holds "and why" "no run of octaves follows a sum of Q, N, B, K and R" out
is "all is withheld" "$(sed -n '/"input": {$/,/"read_off"/p' markov.json | grep -c '"state": "withheld"')" 5
good "a record that grows louder" simulate --samples 20000 --rate 10 --coefficients N=0.01 --seed 3 --output quiet.txt
awk '/^#/ { print; next } { print (++n > 10000 ? 1.2*$1 : $1) }' quiet.txt >loud.txt
good "halves that differ" allan loud.txt --details --json loud.json
holds "a warning states that the halves differ" "the noise changed during the record" out
near "the ratio of the halves" "$(sed -n '/"halves"/,/}/p' loud.json | sed -nE 's/.*"ratio": *\[([0-9.]+),.*/\1/p')" 1.2 0.03
good "halves that do not" allan quiet.txt --details
is "no warning where they do not" "$(grep -c "the noise changed" out)" 0
good "a list of averaging times" allan "$example" --taus 1,2,10,100
# raw is raw: input is the same whatever is removed; what is left without outliers is a series of its own
good "a record for outliers" simulate --samples 4000 --rate 50 --coefficients N=0.01 --seed 3 --output clean.txt
awk '/^#/ { print; next } { u = (16807*u + 5) % 2147483647; print $1 + (u % 50 == 0 ? 3 : 0) }' clean.txt >spiky.txt
good "raw record" allan spiky.txt --out raw
good "without outliers" allan spiky.txt --outliers auto --details --out freed
holds "a warning has the share" "Warning         2.05 % of the samples" out
is "title of the second curve" "$(grep -c '^Without outliers: oadev' out)" 1
is "input with and without the search" "$(grep ',input,' freed/allan.csv | cksum)" "$(grep ',input,' raw/allan.csv | cksum)"
is "series of curves" "$(awk -F, 'NR > 1 { print $2 }' freed/allan.csv | sort -u | xargs)" "cleaned input outliers_removed"
good "ar with options" ar "$example" --outliers mad --outlier-threshold 4 --detrend 2 --order 2 --ar-criterion bic
for method in yw burg ols; do
   good "ar by $method" ar "$example" --detrend 3 --order 1 --ar-method $method --out "ar_$method"
   is "the spectrum of $method" "$(head -n 1 "ar_$method/ar_spectrum.csv") $(wc -l <"ar_$method/ar_spectrum.csv")" \
      "channel,frequency,density 1026"
   near "phi by $method" "$(sed -nE 's/.*"coefficients": \[([0-9.]+)\].*/\1/p' "ar_$method/results.json")" 0.388 0.005
   is "JSON says that $method is stationary" "$(grep -c '"stationary": true' "ar_$method/results.json")" 1
done
good "filter by burg" filter "$example" --detrend 3 --ar-method burg
awk 'BEGIN { srand(1); x = 1; for (i = 0; i < 400; i++) { x = 1.03*x + rand() - 0.5; print x } }' >growing.txt
good "a series that grows" filter growing.txt --details --ar-method ols --order 1 --json growing.json
is "the report says that the model is not stationary" "$(grep -c "^  not stationary" out)" 1
holds "the filters take another model" "take the Yule-Walker model of the same order" out
is "JSON says that it is not stationary" "$(grep -c '"stationary": false' growing.json)" 1
bad "a method that does not exist" 1 "burg" ar "$example" --ar-method least
good "tests with options" tests "$example" --adf-regression ct --adf-lags 3 --detrend none
good "coefficients of the ADF test" tests "$example" --adf-regression ct --adf-lags 3 --adf-table --details --json adf.json
is "the regression of the report, a coefficient a line" "$(grep -cE "^(  Regression     |                 ) coefficient .*, t " out) $(grep -c "^ *)" out)" "6 0"
holds "a coefficient of the document" '"name": "level"' adf.json
good "most lags of the ADF test" tests "$example" --adf-max-lags 5 --json adf5.json
holds "most lags in the document" '"max_lags": 5,' adf5.json
good "tests of stationarity and whiteness" tests "$example" --detrend 3 --kpss-regression ct --kpss-lags 30 --lags 700 --details --out tested
is "the verdict" "$(grep -A 1 "^Verdict" out | tail -n 1)" "  stationary"
holds "KPSS" "lags 30, regression ct" out
holds "whiteness by the size of the effect" "largest |rho| 0.388" out
is "correlation.csv has a line for each lag" "$(grep -c '^gx,' tested/correlation.csv) $(tail -n 1 tested/correlation.csv | cut -d, -f2,9)" \
   "700 700,11300"
bad "no such regression" 1 "--kpss-regression" tests "$example" --kpss-regression ctt
bad "no bandwidth" 1 "--kpss-lags" tests "$example" --kpss-lags many
bad "no lags" 1 "--lags" tests "$example" --lags 0
good "filter with options" filter "$example" --akf robust --forgetting 0.99 --r-factor 2 --outliers auto --detrend 3
good "filter adapts all four" filter "$example" --outliers auto --detrend 3 --estimate q,r,Q,R
good "filter of a slower drift" filter "$example" --outliers auto --detrend 3 --drift-tau 10
good "robust, then what adapts" filter "$example" --akf robust --estimate q,R --json estimate_first.json --quiet
good "what adapts, then robust" filter "$example" --estimate q,R --akf robust --json estimate_second.json --quiet
is "their order does not matter" "$(diff <(no_command_line <estimate_first.json) <(no_command_line <estimate_second.json))" ""
is "both are heard" "$(sed -n '/"akf": {/,/"warnings"/p' estimate_first.json | grep '"estimate"' | tr -d ' ')" '"estimate":["q","R"],'
good "robust alone" filter "$example" --akf robust --json robust.json --quiet
is "adapts R" "$(sed -n '/"akf": {/,/"warnings"/p' robust.json | grep '"estimate"' | tr -d ' ')" '"estimate":["R"],'
"$gyroakf" simulate --samples 3000 --rate 10 --coefficients N=0.01 --output white.txt
good "white noise" filter white.txt --json white.json --quiet
is "no drift: null" "$(grep -cE '"(drift_kf|drift_akf|drift_smoother)": null' white.json)" 3
# averaging times without a term: scattered losses, one long gap
curve_lacks="missing samples leave no windows that are complete enough for the Allan deviation at"
for lost in 0.12 0.5 0.8; do
   "$gyroakf" simulate --samples 40000 --rate 100 --coefficients N=0.01,K=0.0001 --seed 3 --missing $lost --output lost.txt --force
   good "$lost of the samples lost" allan lost.txt --json lost.json --force
   cp out "lost_$lost"
   is "$lost of the samples lost: averaging times" "$(grep -c "$curve_lacks" lost.json)" "$(case $lost in 0.8) echo 1 ;; *) echo 0 ;; esac)"
done
holds "averaging times left out" "$curve_lacks 3 averaging times, tau = 0.08 to 0.32 s; --min-coverage" lost_0.8
awk 'BEGIN { srand(2); for (i = 0; i < 4000; i++) print (i > 400 && i % 2000 < 1500 ? "nan" : rand() - 0.5) }' >cut.txt
good "curve that ends early" allan cut.txt --rate 10 --json cut.json
holds "where the curve ends" "$curve_lacks 2 averaging times, tau = 51.2 to 102.4 s: the curve ends at tau = 25.6 s" out
holds "where the curve ends, in the document" "tau = 51.2 to 102.4 s: the curve ends at tau = 25.6 s" cut.json
"$gyroakf" simulate --samples 20000 --rate 10 --coefficients N=0.01,K=0.002 --offset 3 --missing 0.01 --output walk.txt
good "a record that drifts" run walk.txt --details --out walk --json walk.json
for text in "Processes       kind walk, drift" "In-sample: the drift was taken" "drift AKF " \
   "compensated: in-sample, from the first"; do holds "report: $text" "$text" out; done
is "report of the drift fits 80 columns" "$(LC_ALL=C.UTF-8 awk 'length > 80' out)" ""
is "columns of the series" "$(head -n 1 walk/series.csv)" "time,raw,cleaned,kf,akf,drift,compensated,drift_kf,drift_akf"
is "raw is drift and compensated" "$(awk -F, 'NR > 1 && $2 != "nan" { d = $2 - $6 - $7; if (d > 1e-12 || d < -1e-12) n++ }
   END { print n + 0 }' walk/series.csv)" 0
is "the drift goes on where samples are lost" "$(awk -F, 'NR > 1 && ($6 == "nan" || $8 == "nan" || $9 == "nan")' walk/series.csv)" ""
holds "curve of what is left" ",compensated,oadev," walk/allan.csv
is "JSON has it too" "$(grep -cE '"compensated": \{' walk.json)" 2
good "the paper's chain" run "$example" --preset paper
good "a preset changed" run "$example" --outlier-threshold 4 --preset paper --json -

# Kalibr: N of a simulated gyroscope (2e-4 rad/s/sqrt(Hz)) and accelerometer, the latter without a random walk
for i in 1 2 3; do
   "$gyroakf" simulate --samples 20000 --rate 100 --unit rad/s --coefficients N=2e-4,K=1e-4 --seed $i | grep -v '^#' >"g$i"
   "$gyroakf" simulate --samples 20000 --rate 100 --unit m/s^2 --coefficients N=3e-3 --seed 1$i | grep -v '^#' >"a$i"
done
{ printf '# rate_hz: 100\n# units: rad/s rad/s rad/s m/s^2 m/s^2 m/s^2\n# columns: gx gy gz ax ay az\n'; paste -d ' ' g? a?; } >imu.txt
good "allan --kalibr" allan imu.txt --kalibr imu.yaml --json imu.json
near "gyroscope_noise_density" "$(sed -n 's/^gyroscope_noise_density: \([^ ]*\) .*/\1/p' imu.yaml)" 2e-4 1e-5
near "gyroscope_random_walk" "$(sed -n 's/^gyroscope_random_walk: \([^ ]*\) .*/\1/p' imu.yaml)" 1e-4 5e-5
near "accelerometer_noise_density" "$(sed -n 's/^accelerometer_noise_density: \([^ ]*\) .*/\1/p' imu.yaml)" 3e-3 1e-4
holds "a limit for what is not detectable" "is not detectable: its 95 % upper limit" imu.yaml
is "a number for each key" "$(grep -cE '^[a-z_]+: [1-9]\.[0-9]{4}e[-+][0-9][0-9]  # ' imu.yaml)" 4
if command -v python3 >/dev/null && python3 -c 'import yaml' 2>/dev/null; then
   if python3 -c 'import yaml
d = yaml.safe_load(open("imu.yaml"))
assert d.pop("rostopic") == "/imu0" and len(d) == 5 and all(type(x) is float and x > 0 for x in d.values()), d'; then pass
   else fail "imu.yaml as YAML"; fi
fi
good "run --kalibr beside other files" run g1 --rate 100 --unit rad/s --kalibr run.yaml --out with_kalibr --json with.json
holds "lines to fill in" "#accelerometer_random_walk:" run.yaml
bad "--kalibr without a rate" 2 "give --rate HZ or --dt S" allan g1 --unit rad/s --kalibr none.yaml --out none --json none.json
bad "--kalibr without a unit" 2 "give --unit rad/s" allan g1 --rate 100 --kalibr none.yaml --out none --json none.json
bad "--kalibr without K" 2 "K of 'column1' was not fitted" allan g1 --rate 100 --unit rad/s --terms N --kalibr none.yaml --json none.json
bad "--kalibr on standard output" 1 "needs the name of a file" allan imu.txt --kalibr -
bad "--kalibr over the recording" 1 "overwrite" allan imu.txt --kalibr ./imu.txt
bad "--kalibr over the JSON" 1 "same file" allan imu.txt --kalibr x.json --json x.json
bad "--kalibr over a result" 1 "same file" allan imu.txt --kalibr out/report.txt --out out
bad "--kalibr of tests" 1 "belongs to" tests imu.txt --kalibr x.yaml
is "nothing is written where it is refused" "$(ls -d none* .none* 2>/dev/null)" ""

bad "JSON into a directory that is not there" 2 "nowhere" run "$example" --json nowhere/x.json
bad "JSON over a directory" 2 "results" run "$example" --json results
cp "$example" recording.txt
bad "directory over a file" 2 "recording.txt" run "$example" --out recording.txt
bad "JSON over the recording" 1 "overwrite" run recording.txt --json ./recording.txt
cp recording.txt results/series.csv
bad "results over the recording" 1 "overwrite" run ./results/series.csv --out results
yes 5 | head -n 60 >constant.txt
for command in tests ar filter; do
   bad "$command of a constant series" 2 "nothing can be computed" $command constant.txt --json x.json
done
if [ "$(id -u)" -ne 0 ]; then
   mkdir locked && chmod 555 locked
   bad "directory that cannot be written" 2 "locked" run "$example" --out locked
   bad "JSON that cannot be written" 2 "locked" run "$example" --json locked/x.json
fi
if [ -e /dev/full ]; then
   "$gyroakf" run "$example" >/dev/full 2>err
   is "full disk on standard output" $? 2
   holds "full disk is an error" "gyroakf: error: " err
fi
# a reader that goes away: no run-time error, no traceback
"$gyroakf" run "$example" 2>err | head -n 1 >/dev/null
if grep -qiE 'backtrace|run-?time error|fortran' err; then fail "closed pipe: $(head -c 300 err)"; else pass; fi
# a vibration: its frequency; the spectrum is among the result files
awk 'BEGIN { srand(1); for (i = 0; i < 20000; i++) { s = 0; for (j = 0; j < 12; j++) s += rand(); print s - 6 + sin(0.5 * i) } }' \
  >vibration.txt
good "a vibration" tests vibration.txt --rate 100 --unit deg/s --out vibration --json -
near "its frequency" "$(sed -n '/"fisher_g"/,/"samples"/s/.*"frequency_hz": \([^,]*\).*/\1/p' out)" 7.957747 5e-3
is "rows of the spectrum" "$(grep -c '^column1' vibration/spectrum.csv)" 1025
good "segments of two seconds" tests vibration.txt --rate 100 --out vibration --force --welch-segment 2
is "rows of its spectrum" "$(grep -c '^column1' vibration/spectrum.csv)" 101
good "no rate" tests vibration.txt --details
holds "frequencies without a rate" "cycles/sample" out
bad "segment 0" 1 "larger than 0" tests vibration.txt --welch-segment 0
bad "segment that takes more memory than the record" 2 "may have 1048576 samples here" tests vibration.txt --welch-segment 1e9
bad "segment longer than the record" 2 "a segment of the spectrum must have" tests vibration.txt --welch-segment 1e6
