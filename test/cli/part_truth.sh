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
bad "a drift that is there" 2 "t_drift.txt: is there already" simulate "${terms[@]}" --output t2.txt --truth t_drift.txt
is "no record without its drift" "$(ls t2.txt 2>/dev/null)" ""

# every filter against it
good "filter" filter t.txt --truth t_drift.txt
holds "a heading" "Against the true drift" out
for method in "as it is" "trend, mean alone" "KF (paper)" "AKF (paper)" "drift KF" "drift AKF" "drift smoother" \
   "innovation window" "variational Bayes" "moving average" "centred average"; do
   holds "method $method" "$method" <(sed -n '/Against/,$p' out)
done
is "no line beyond the width" "$(awk 'length > 80' out)" ""
good "filter without a truth" filter t.txt
if grep -q "Against the true drift" out; then fail "scores without a truth"; else pass; fi
good "run" run t.txt --truth t_drift.txt --json t.json --quiet
if command -v python3 >/dev/null; then
   good "filter as JSON" filter t.txt --truth t_drift.txt --json t_filter.json --quiet
   if python3 - t_filter.json t.json t.txt t_drift.txt <<'END'
import json, sys
channel = json.load(open(sys.argv[1]))["channels"][0]
scores = {m["name"]: m for m in channel["truth"]["methods"]}
read = lambda path: [float(line) for line in open(path) if line[0] != "#"]
error = [a - b for a, b in zip(read(sys.argv[3]), read(sys.argv[4]))]
raw = scores["none"]
assert raw["samples"] == 6000 and abs(raw["rmse"] - (sum(e * e for e in error) / 6000) ** 0.5) < 1e-12
assert abs(raw["bias"] - sum(error) / 6000) < 1e-12
turned = [0.2 * sum(error[i:i + 300]) for i in range(0, 6000, 300)]
after = raw["attitude"][1]
assert after["after_s"] == 60 and after["compensated_windows"] == 20
assert abs(after["compensated"] - (sum(t * t for t in turned) / 20) ** 0.5) < 1e-10
for name, filter in channel["filters"].items():
    assert filter is None or filter["rmse"] == scores[name]["rmse"]
assert scores["drift_kf"]["rmse"] < 0.8 * raw["rmse"] and scores["drift_kf"]["rmse"] < scores["kf"]["rmse"]
assert scores["drift_smoother"]["rmse"] < 0.95 * scores["drift_kf"]["rmse"]
assert channel["truth"]["angle_unit"] == "deg"
# run removes a cubic before the filters: it is part of the drift, "as it is" errs as before but for the outliers that it marks
cleaned = {m["name"]: m for m in json.load(open(sys.argv[2]))["channels"][0]["truth"]["methods"]}
assert abs(cleaned["none"]["rmse"] / raw["rmse"] - 1) < 0.02 and cleaned["none"]["samples"] <= 6000
assert cleaned["trend"]["rmse"] < scores["trend"]["rmse"]
END
   then pass; else fail "the scores are not those of the files"; fi
fi

# another unit is converted, its header says which; a truth without a header is in the unit of the record
awk '/^# unit/ { print "# unit: deg/h"; next } /^#/ { print; next } { printf "%.17g\n", 3600*$1 }' t_drift.txt >t_hours.txt
grep -v "^#" t_drift.txt >t_bare.txt
good "the drift in its unit" filter t.txt --truth t_drift.txt
sed -n '/Against/,$p' out >t_scores
good "the drift in deg/h" filter t.txt --truth t_hours.txt
if sed -n '/Against/,$p' out | cmp -s - t_scores; then pass; else fail "a truth in deg/h gives other scores"; fi
good "the drift without a header" filter t.txt --truth t_bare.txt
if sed -n '/Against/,$p' out | cmp -s - t_scores; then pass; else fail "a truth without a header gives other scores"; fi
good "a part of the record" filter t.txt --truth t_drift.txt --from 100 --to 900
holds "scores of the part" "Against the true drift" out

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
# a record beyond the memory: the scores need the whole, the filters do not, and the message says so
good "a long record and its drift" simulate "${terms[@]/6000/100000}" --output t_long.txt --truth t_long_drift.txt
bad "a truth beyond the memory" 2 "rows need" filter t_long.txt --truth t_long_drift.txt --memory 28MB
good "which it does" filter t_long.txt --memory 28MB --quiet
bad "no such file" 2 "t_none.txt" filter t.txt --truth t_none.txt
