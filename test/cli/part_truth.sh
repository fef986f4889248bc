# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# The true drift: written by simulate, read by filter and run. Read by run.sh.

terms=(--samples 6000 --rate 5 --coefficients N=0.009 --ar 0.978 --ar-variance 1e-4 --offset 0.2 --seed 3)
good "a record and its drift" simulate "${terms[@]}" --output t.txt --truth t_drift.txt
good "the record alone" simulate "${terms[@]}" --output t_alone.txt
if cmp -s t.txt t_alone.txt; then pass; else fail "--truth changes the record"; fi
holds "what the drift is" "# the true drift of: gyroakf simulate --samples 6000" t_drift.txt
holds "its unit" "# unit: deg/s" t_drift.txt
is "its samples" "$(grep -vc '^#' t_drift.txt)" 6000
bad "a drift that is there" 2 "t_drift.txt: already exists" simulate "${terms[@]}" --output t2.txt --truth t_drift.txt
is "no record without its drift" "$(ls t2.txt 2>/dev/null)" ""

# every filter against it
good "filter" filter t.txt --truth t_drift.txt
is "RMSE of every filter" "$(awk '/innovations$/ { at = index($0, "RMSE") } /^  ((drift )?A?KF|smoother)/ && substr($0, at - 4, 8) ~ /0\.0/' out | wc -l)" 5
holds "its unit" "variance ratio DC gain RMSE innovations" out
is "the unit of the RMSE" "$(grep -c '^ *(deg/s)^2  *deg/s$' out)" 1
holds "its samples" "RMSE: against the true drift, over 6000 samples" out
is "no line beyond the width" "$(awk 'length > 80' out)" ""
good "filter without a truth" filter t.txt
if grep -q RMSE out; then fail "an RMSE without a truth"; else pass; fi
if command -v python3 >/dev/null; then
   good "filter with results" filter t.txt --truth t_drift.txt --json t_filter.json --out t_out --quiet
   good "run with results" run t.txt --truth t_drift.txt --json t_run.json --quiet
   if python3 - t_filter.json t_run.json t_drift.txt t_out/series.csv <<'END'
import csv, json, math, sys
filters = json.load(open(sys.argv[1]))["channels"][0]["filters"]
truth = [float(line) for line in open(sys.argv[3]) if line[0] != "#"]
rows = list(csv.DictReader(open(sys.argv[4])))
for name, column in ("drift_kf", "drift_kf"), ("drift_akf", "drift_akf"), ("drift_smoother", "drift"):
    error = [float(row[column]) - drift for row, drift in zip(rows, truth)]
    assert abs(filters[name]["rmse"] / math.sqrt(sum(e * e for e in error) / len(truth)) - 1) < 1e-9
assert filters["drift_kf"]["rmse"] < filters["kf"]["rmse"]
assert filters["drift_smoother"]["rmse"] < 0.95 * filters["drift_kf"]["rmse"]
# run removes a cubic before the paper's filters: it is part of the drift that they are compared with
cleaned = json.load(open(sys.argv[2]))["channels"][0]["filters"]
assert abs(cleaned["kf"]["rmse"] / filters["kf"]["rmse"] - 1) < 0.1
END
   then pass; else fail "the RMSE is not that of the files"; fi
fi

# another unit is converted, its header says which; a truth without a header is in the unit of the record
awk '/^# unit/ { print "# unit: deg/h"; next } /^#/ { print; next } { printf "%.17g\n", 3600*$1 }' t_drift.txt >t_hours.txt
grep -v "^#" t_drift.txt >t_bare.txt
good "the drift in its unit" filter t.txt --truth t_drift.txt
sed -n '/innovations/,/RMSE:/p' out >t_rmse
good "the drift in deg/h" filter t.txt --truth t_hours.txt
if sed -n '/innovations/,/RMSE:/p' out | cmp -s - t_rmse; then pass; else fail "a truth in deg/h gives another RMSE"; fi
good "the drift without a header" filter t.txt --truth t_bare.txt
if sed -n '/innovations/,/RMSE:/p' out | cmp -s - t_rmse; then pass; else fail "a truth without a header gives another RMSE"; fi
good "a part of the record" filter t.txt --truth t_drift.txt --from 100 --to 900
holds "RMSE of the part" "against the true drift, over" out

# what does not fit
grep -v "^#" t_drift.txt | head -n 5999 >t_short.txt
bad "another length" 2 "t_short.txt: the true drift has 5999 samples, the record 6000" filter t.txt --truth t_short.txt
sed 's|^# unit: .*|# unit: m/s^2|' t_drift.txt >t_wrong.txt
bad "another quantity" 2 "t_wrong.txt: the true drift is in m/s^2, the record in deg/s" filter t.txt --truth t_wrong.txt
bad "a unit, the record has none" 2 "give it" filter t_bare.txt --truth t_drift.txt
sed 's|^# rate_hz: .*|# rate_hz: 10|' t_drift.txt >t_fast.txt
bad "another rate" 2 "samples a second" filter t.txt --truth t_fast.txt
paste -d ' ' t_bare.txt t_bare.txt >t_two.txt
bad "more channels" 2 "the true drift has 2 channels, the record 1" filter t.txt --truth t_two.txt
# a record beyond the memory
good "a long record and its drift" simulate "${terms[@]/6000/100000}" --output t_long.txt --truth t_long_drift.txt
bad "a truth beyond the memory" 2 "rows need" filter t_long.txt --truth t_long_drift.txt --memory 28MB
bad "no such file" 2 "t_none.txt" filter t.txt --truth t_none.txt
