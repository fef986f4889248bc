# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# What a report looks like: width, signs, colors, the chart; tables for papers.
example=$root/example/data/mems_gyro_x.txt
beyond() { LC_ALL=C grep -c '[^ -~]' "$1"; }              # lines with a byte that is not printable ASCII
widest() { LC_ALL=C tr -d '\200-\277' <"$1" | LC_ALL=C awk 'length > w { w = length } END { print w + 0 }'; }   # characters
narrow() { if [ "$(widest "$2")" -le 80 ]; then pass; else fail "$1: a line of $(widest "$2") characters"; fi; }

# every report in 80 columns and, in the C locale, in ASCII; the same in UTF-8 has its signs
awk 'BEGIN { print "# rate_hz: 100\n# units: deg/s deg/s deg/s m/s^2 m/s^2\n# columns: wx wy wz acceleration_forward acceleration_y";
   for (i = 0; i < 1200; i++) print (i*7919)%101/1e3, (i*104729)%211/1e3, (i*611953)%307/1e4, (i*15485863)%401/1e2, (i*32452843)%503/1e2 }' >five.txt
grep -v '^#' "$example" | awk 'NR <= 100' >hundred.txt
grep -v '^#' "$example" | awk 'NR <= 4000' >bare.txt
"$gyroakf" simulate --samples 6000 --rate 10 --coefficients N=0.005,K=0.0005 --missing 0.01 --output drift.txt --truth drift_truth.txt
for arguments in "run $example" "run $example --preset paper" "run $example --akf robust" "run $example --adf-table" \
   "run five.txt" "allan five.txt --kinds mdev,tdev,hdev,totdev" "run hundred.txt" "run bare.txt" \
   "inspect five.txt" "tests bare.txt" "ar $example" "filter drift.txt --truth drift_truth.txt" "run drift.txt --truth drift_truth.txt" \
   "filter bare.txt --estimate q,r,Q,R" "run bare.txt drift.txt five.txt" "inspect bare.txt five.txt" "filter bare.txt drift.txt"; do
   # shellcheck disable=SC2086
   LC_ALL=C good "$arguments" $arguments
   narrow "$arguments" out
   is "$arguments: ASCII" "$(beyond out)" 0
   mv out ascii.txt
   # shellcheck disable=SC2086
   LC_ALL=C.UTF-8 good "$arguments in UTF-8" $arguments
   narrow "$arguments in UTF-8" out
   # shellcheck disable=SC2086
   LC_ALL=C.UTF-8 good "$arguments --ascii" $arguments --ascii
   if cmp -s out ascii.txt; then pass; else fail "$arguments: --ascii is not the report of the C locale"; fi
done
LC_ALL=C.UTF-8 good "signs" run "$example" --details
for text in "±" "deg/√h" "(deg/s)²" "|ρ|" "σ² = N²/τ" "└" "┤"; do holds "signs of UTF-8" "$text" out; done
mv out utf8.txt
LC_ALL= LC_CTYPE=C.utf8 LANG=C good "LC_CTYPE" run "$example" --details
if cmp -s out utf8.txt; then pass; else fail "LC_CTYPE does not choose UTF-8"; fi
LANG=C.UTF-8 LC_ALL=POSIX good "LC_ALL is first" run "$example"
is "LC_ALL comes before LANG" "$(beyond out)" 0
printf '# columns: tau Δω/√h\n' >names.txt
awk 'BEGIN { for (i = 0; i < 300; i++) print (i*7919)%101, (i*104729)%211 }' >>names.txt
LC_ALL=C good "names stay as the user has them" run names.txt --time-column none --rate 10 --details
holds "a name beyond ASCII" "Channel Δω/√h" out
LC_ALL=C.UTF-8 good "names stay in UTF-8" run names.txt --time-column none --rate 10 --details
holds "a name that is a sign's" "Channel tau" out

# colors
escape=$(printf '\033')
good "no colors into a file" run "$example" --outliers pauta --outlier-threshold 1.5 --details --out colored --color always
holds "colors on request" "$escape[1mTable II. Before" out
holds "warnings are yellow" "$escape[33m  Warning" out
is "report.txt has no colors" "$(grep -c "$escape" colored/report.txt)" 0
is "report.txt is ASCII" "$(LC_ALL=C.UTF-8 "$gyroakf" run "$example" --outliers pauta --outlier-threshold 1.5 --out colored --force >/dev/null; beyond colored/report.txt)" 0
sed "s/$escape\[[0-9]*m//g" out >plain.txt
good "no colors by themselves" run "$example" --outliers pauta --outlier-threshold 1.5 --details
if cmp -s plain.txt out; then pass; else fail "a report without its colors is another one"; fi
good "NO_COLOR" run "$example" --color never
is "--color never" "$(grep -c "$escape" out)" 0
if script --version >/dev/null 2>&1; then
   terminal() { script -qec "$* '$gyroakf' allan '$example'" /dev/null </dev/null | grep -c "$escape"; }
   if [ "$(terminal env -u NO_COLOR TERM=xterm)" -gt 0 ]; then pass; else fail "no colors on a terminal"; fi
   is "NO_COLOR on a terminal" "$(terminal env NO_COLOR=1 TERM=xterm)" 0
   is "an empty NO_COLOR is none" "$([ "$(terminal env NO_COLOR= TERM=xterm)" -gt 0 ] && echo colored)" colored
   is "a dumb terminal" "$(terminal env TERM=dumb)" 0
   is "no TERM" "$(terminal env -u TERM)" 0
fi

# the chart
good "a chart" allan "$example"
holds "what the chart shows" "Allan deviation in deg/s against tau in s: o measured, | limits, . fitted" out
holds "slopes" "-1/2" out
good "no chart" allan "$example" --chart off --out nochart
is "no chart in the report" "$(grep -c 'against tau\|1/2' out)" 0
is "no chart in report.txt" "$(grep -c 'against tau\|1/2' nochart/report.txt)" 0
good "a first screen" run "$example"
holds "a Kalman filter takes N without the outliers" "at 5 Hz in SI, without outliers: N 0.000283 rad/sqrt(s)" out
good "no outliers are looked for" run "$example" --outliers none
holds "a Kalman filter takes N of the record" "at 5 Hz in SI: N 0.000286 rad/sqrt(s)" out
bad "--chart of tests" 1 "not one of 'tests'" tests "$example" --chart on

# files that options name
good "details" run "$example" --details
holds "the tables of the paper" "Table III" out
bad "two in one file" 1 "name the same file './x'" run "$example" --json ./x --kalibr x
bad "over the recording" 1 "--json would overwrite the recording" run bare.txt --json ./bare.txt
bad "over a result" 1 "--kalibr and --out name the same file" run "$example" --kalibr o/report.txt --out o
bad "over the truth" 1 "overwrite the true drift" run drift.txt --truth drift_truth.txt --json drift_truth.txt
bad "Kalibr's file of many files" 1 "--kalibr with many files needs --out" run bare.txt drift.txt --kalibr k.yaml
bad "Kalibr's file of many files" 1 "a name without a folder" run bare.txt drift.txt --kalibr ./k.yaml --out tables
good "Kalibr's file of many files" run bare.txt drift.txt --rate 100 --unit deg/s --kalibr k.yaml --out tables --quiet
is "a folder for each" "$(cd tables && echo */k.yaml)" "bare/k.yaml drift/k.yaml"
bad "--kalibr of tests" 1 "not one of 'tests'" tests "$example" --kalibr x.yaml
