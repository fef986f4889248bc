# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# The same numbers from run to run, and on one thread and two. Read by run.sh.
# agree FILE FILE: their numbers are the same to 1e-12, but for what tells the runs; what is compared is told in said
agree() { awk -v tolerance=1e-12 -f "$root/ci/compare_json.awk" -- <(no_command_line <"$1") <(no_command_line <"$2") >said; }

"$gyroakf" simulate --samples 30000 --rate 50 --unit deg/s --coefficients Q=0.002,N=0.01,B=0.003,K=0.0008 --ar 0.97 \
   --ar-variance 2e-5 --outlier-count 20 --outlier-size 9 --missing 0.01 --trend 0,1e-7 --seed 5 --output same.txt --truth same_drift.txt
same_options=(--kinds "adev,mdev,tdev,hdev,ohdev,totdev" --truth same_drift.txt --lags 30 --quiet)
for i in 1 2; do good "run $i" run same.txt "${same_options[@]}" --threads 2 --json same_$i.json; done
if cmp -s <(no_command_line <same_1.json) <(no_command_line <same_2.json); then pass; else fail "two runs do not give the same bytes"; fi
good "run on one thread" run same.txt "${same_options[@]}" --threads 1 --json same_one.json
if agree same_one.json same_1.json; then pass
else fail "one thread and two: $(head -n 5 said)"; fi
if [ "$(sed -n 's/^\([0-9]*\) numbers.*/\1/p' said)" -gt 2400 ]; then pass; else fail "too few numbers were compared: $(cat said)"; fi
good "allan on one thread" allan same.txt --taus log:10 --threads 1 --quiet --json same_one.json --force
good "allan on two threads" allan same.txt --taus log:10 --threads 2 --quiet --json same_2.json --force
if agree same_one.json same_2.json; then pass
else fail "allan, one thread and two: $(head -n 5 said)"; fi
for method in burg ols; do
   good "$method on one thread" run same.txt --ar-method $method --akf robust --outliers hampel --threads 1 --quiet --json same_one.json --force
   good "$method on two threads" run same.txt --ar-method $method --akf robust --outliers hampel --threads 2 --quiet --json same_2.json --force
   if agree same_one.json same_2.json; then pass
   else fail "$method, one thread and two: $(head -n 5 said)"; fi
done

# the comparison itself notices what differs
printf '{\n  "a": 1.5,\n  "list": [1, 2.5e-3, null]\n}\n' >j1
compares() { awk -v tolerance=1e-6 -v loose='/b$ 1e-2 /[bd]$ 1e-4' -v rounded=/mean$ -f "$root/ci/compare_json.awk" -- "$@" >said; }
cp j1 j2; if compares j1 j2; then pass; else fail "equal documents differ: $(cat said)"; fi
is "how many numbers" "$(tail -n 1 said)" "3 numbers, the largest difference is 0.0e+00, of the loose ones 0.0e+00"
sed 's/2.5e-3/2.500001e-3/' j1 >j2; if compares j1 j2; then pass; else fail "4e-7 is more than 1e-6: $(cat said)"; fi
sed 's/2.5e-3/2.50001e-3/' j1 >j2; if compares j1 j2; then fail "4e-6 is not noticed"; else pass; fi
holds "where it is" "/list: 2.5e-3 and 2.50001e-3, 4.0e-06 apart" said
sed 's/null/0/' j1 >j2; if compares j1 j2; then fail "a null that is a number is not noticed"; else pass; fi
sed 's/"a"/"c"/' j1 >j2; if compares j1 j2; then fail "another key is not noticed"; else pass; fi
sed 's/1.5/-1.5/' j1 >j2; if compares j1 j2; then fail "another sign is not noticed"; else pass; fi
head -n 2 j1 >j2; if compares j1 j2; then fail "a missing end is not noticed"; else pass; fi
if compares j2 j1; then fail "a longer one is not noticed"; else pass; fi
if compares j1 no_such_file; then fail "a missing file is not noticed"; else pass; fi
printf '{\n  "b": 1.5,\n  "mean": 0\n}\n' >j1
printf '{\n  "b": 1.501,\n  "mean": -7e-18\n}\n' >j2
if compares j1 j2; then pass; else fail "what is loose, or rounding: $(cat said)"; fi
printf '{\n  "b": 1.6,\n  "mean": 0\n}\n' >j2
if compares j1 j2; then fail "a loose number that is far off is not noticed"; else pass; fi
printf '{\n  "d": 1.5\n}\n' >j3
sed 's/1.5/1.5001/' j3 >j4; if compares j3 j4; then pass; else fail "the second tolerance: $(cat said)"; fi
sed 's/1.5/1.501/' j3 >j4; if compares j3 j4; then fail "more than the second tolerance is not noticed"; else pass; fi
printf '{\n  "ratio": 1e-3\n}\n' >j3
sed 's/1e-3/1.0005e-3/' j3 >j4; if compares j3 j4; then fail "5e-4 is more than 1e-6"; else pass; fi
of_logarithms() { awk -v tolerance=1e-6 -v logarithms=ratio -f "$root/ci/compare_json.awk" -- "$@" >said; }
if of_logarithms j3 j4; then pass; else fail "ratios that are 5e-7 apart: $(cat said)"; fi
sed 's/1e-3/1.005e-3/' j3 >j4; if of_logarithms j3 j4; then fail "ratios that are 5e-6 apart are not noticed"; else pass; fi
printf '{\n  "b": 1.5,\n  "mean": 1e-14\n}\n' >j2
if compares j1 j2; then fail "a mean that is not rounding is not noticed"; else pass; fi
