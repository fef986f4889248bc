#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The program built in two ways gives the same numbers:   ci/determinism.sh PROGRAM PROGRAM
#
# such as the optimized and the checked one. All of results.json agrees to 1e-10, but for the command line. Of two
# kinds of numbers the difference is not that relative to the number:
#   - residuals of the Allan fit are logarithms of ratios, some near 0: their difference is the relative difference of the ratio;
#   - means of series that have none, such as residuals and innovations of least squares: below 1e-15 they are rounding.
# The last line is "N passed, N failed". The CI step `builds` compares the program as it is built for use with the checked one.
set -u
[ $# -eq 2 ] && [ -x "$1" ] && [ -x "$2" ] || { echo "usage: $0 PROGRAM PROGRAM" >&2; exit 1; }
programs=()
for program in "$@"; do programs+=("$(cd "$(dirname "$program")" && pwd)/$(basename "$program")"); done
cd "$(dirname "$0")/.." || exit 1
printf 'program: %s\n' "${programs[@]}"
cmp -s "${programs[@]}" && { echo "both programs are the same"; echo "0 passed, 1 failed"; exit 1; }

logarithms='/coefficients/.*/residual$'
rounded='/mean$|/intercept$'
# With -O3 -march=native gfortran 12 fuses complex products and sums in spite of -ffp-contract=off, in fft/;
# simulated 1/f noise differs from that of the other builds by up to 5.6e-17.
record_tolerance=1e-15
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
passed=0
failed=0

# results.json without its command line
no_command_line() { sed '/^  "command_line": /d' "$1"; }

# compare NAME FILE OPTION...
compare() {
   local name=$1 i
   shift
   for i in 0 1; do
      if ! MALLOC_PERTURB_='' "${programs[i]}" run "$@" --quiet --json "$work/$i.json" --force 2>"$work/err"; then
         echo "$name: $(cat "$work/err")"
         failed=$((failed + 1))
         return
      fi
   done
   if awk -v tolerance=1e-10 -v logarithms="$logarithms" -v rounded="$rounded" -f ci/compare_json.awk -- \
      <(no_command_line "$work/0.json") <(no_command_line "$work/1.json") >"$work/said"; then passed=$((passed + 1)); else failed=$((failed + 1)); fi
   sed "s/^/$name: /" "$work/said"
}

# one record by both programs: the same bytes, with 1/f noise the same numbers to rounding
terms=(--samples 40000 --rate 50 --unit deg/s --ar 0.97 --ar-variance 2e-5 --outlier-count 20 --outlier-size 9 --missing 0.01
   --trend "0,1e-7" --seed 5)
for i in 0 1; do
   "${programs[i]}" simulate "${terms[@]}" --coefficients Q=0.002,N=0.01,K=0.0008 --output "$work/walk$i.txt"
   "${programs[i]}" simulate "${terms[@]}" --coefficients Q=0.002,N=0.01,B=0.003,K=0.0008 --output "$work/mix$i.txt" \
      --truth "$work/drift$i.txt"
done
if cmp -s "$work/walk0.txt" "$work/walk1.txt"; then passed=$((passed + 1))
else echo "the simulated records differ"; failed=$((failed + 1)); fi
if paste "$work/mix0.txt" "$work/mix1.txt" | grep -v '^#' | awk -v tolerance=$record_tolerance '
   { d = $1 - $2; if (d < 0) d = -d; if (d > worst) worst = d; if (($1 == "nan") != ($2 == "nan")) worst = 1 }
   END { printf "1/f noise of both: %d rates, %.1e apart at most\n", NR, worst; exit !(NR == 40000 && worst <= tolerance) }'
then passed=$((passed + 1)); else echo "the simulated records with 1/f noise differ"; failed=$((failed + 1)); fi
compare "the example" example/data/mems_gyro_x.txt
compare "the example, paper" example/data/mems_gyro_x.txt --preset paper
compare "a mixture" "$work/mix0.txt" --kinds adev,mdev,tdev,hdev,ohdev,totdev --truth "$work/drift0.txt"
compare "a mixture, burg" "$work/mix0.txt" --ar-method burg --akf robust --outliers mad --taus log:8 --max-order 8
compare "a mixture, ols" "$work/mix0.txt" --ar-method ols --outliers hampel --adf-regression ct --kpss-regression ct
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
