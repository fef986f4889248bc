#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The FORTRAN 77 names: the example compiled as old code is, its output as c_api/README.md shows it,
# the turns that survive its compensation, and the tests of a C caller.
#
#   ci/legacy.sh [LIBRARY]        libgyroakf.a; default: fpm's, installed into build/legacy
#
# The last line is "N passed, N failed".
set -u
cd "$(dirname "$0")/.." || exit 1
out=build/legacy
mkdir -p "$out"
library=${1-}
if [ -z "$library" ]; then
  ./setup.sh fpm install --prefix "$out" >/dev/null || exit 1
  library=$out/lib/libgyroakf.a
fi
passed=0
failed=0
result() { # NAME CODE
  if [ "$2" -eq 0 ]; then passed=$((passed + 1)); else failed=$((failed + 1)); echo "FAILED: $1"; fi
}

survives() { # FILE: both turns in the output of nav
  awk '/survives/ { n++; if ($(NF - 1) < 99.5 || $(NF - 1) > 100.5) lost = 1 }
    END { exit n != 2 || lost }' "$1"
}

gfortran -std=legacy -Wall -Werror -fopenmp c_api/legacy/nav.f "$library" -llapack -lblas -lz -o "$out/nav"
result "nav.f compiles as FORTRAN 77" $?
# the recording with two known turns, made by the command of c_api/README.md
eval "$(sed -n "/^awk '/,/>turns.txt\$/{ s|>turns.txt|>$out/turns.txt|; p }" c_api/README.md)"
"$out/nav" "$out/turns.txt" >"$out/nav.txt"
result "nav runs" $?
missing=$(grep -vxFf c_api/README.md "$out/nav.txt")
[ -s "$out/nav.txt" ] && [ -z "$missing" ]
result "c_api/README.md shows what nav prints: $missing" $?
survives "$out/nav.txt"
result "99.5 % to 100.5 % of both turns survive in nav" $?

# the recording at rest: the heading error is below that of the bias alone
"$out/nav" example/data/mems_gyro_x.txt >"$out/nav-rest.txt"
result "nav runs on a recording at rest" $?
awk 'NR == 1 { for (i = 1; i < NF; i++) if ($i == "bias") bias = $(i + 1) }
  $2 == "rest" || $2 == "moving" { n++; compensated += $4^2; plain += ($3 - bias*0.2*$1)^2 }
  END { exit !(n == 10 && compensated < plain) }' "$out/nav-rest.txt"
result "compensation is better than the bias alone" $?
# independent of what nav counts: both headings differ by the turns, within three standard
# deviations of the noise, N sqrt(t) = 0.0161 sqrt(2000) = 0.7 deg
rows() { grep -E '^ *[0-9]+ +(rest|moving) ' "$1"; }
paste <(rows "$out/nav.txt") <(rows "$out/nav-rest.txt") |
  awk '{ turn = $4 - $10 } END { exit !(NR == 10 && turn > 102 - 2.1 && turn < 102 + 2.1) }'
result "the heading with the turns less that without them" $?
"$out/nav" no-such-file >/dev/null 2>"$out/nav.err"
grep -q 'cannot be opened' "$out/nav.err"
result "nav says that a recording is missing" $?

gcc -std=c99 -O2 -Wall -Wextra -pedantic -Werror -Ic_api/include -c c_api/legacy/caller.c -o "$out/caller.o" &&
  gfortran -fopenmp "$out/caller.o" "$library" -llapack -lblas -lz -o "$out/caller"
result "caller.c compiles" $?
# sums of several threads may differ in the last bit
sums=$(OMP_NUM_THREADS=1 "$out/caller")
result "caller runs" $?
grep -v ' passed, ' <<<"$sums"
read -r more worse < <(sed -nE 's/^([0-9]+) passed, ([0-9]+) failed$/\1 \2/p' <<<"$sums")
echo "$((passed + ${more:-0})) passed, $((failed + ${worse:-1})) failed"
[ $((failed + ${worse:-1})) -eq 0 ]
