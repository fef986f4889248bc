# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# Stand-ins of real recordings: right verdicts, no statements of one report that exclude each other. Read by run.sh.

for name in $("$gyroakf" simulate --help | sed -n 's/^  --preset //p' | tr '|' ' '); do
   good "the preset $name" simulate --preset "$name" --samples 20 --output "z_$name.txt"
   is "samples of $name" "$(grep -vc '^#' "z_$name.txt")" 20
done
holds "an option beside a preset" "# made by: gyroakf simulate --preset mti-g --samples 20 --seed" z_mti-g.txt
holds "the unit of a preset" "# unit: rad/s" z_mti-g.txt

if command -v python3 >/dev/null; then
   cat >z.csv <<'END'
name,options,terms,N,B,K,verdict,what
mti-g,--preset mti-g --samples 30000,N,1.822,,,none,
xsens-dot,--preset xsens-dot,NB,0.365,5.0,,none|flicker,
markov,"--rate 10 --samples 20000 --unit deg/h --coefficients N=18 --markov 20,1",N,0.558,,,none|colored,
mems,"--rate 10 --samples 72000 --unit deg/h --coefficients N=18,B=6",NB,0.3,6,,none|flicker,
ramp,"--rate 10 --samples 72000 --unit deg/h --coefficients N=18,B=6,R=0.02",NB,0.3,6,,trend,
ring-laser,--preset ring-laser,QN,,,,none|colored,
walk,"--rate 10 --samples 20000 --unit deg/h --coefficients N=18,K=1",NK,0.3,,60,random_walk,
END
   if "$root/bench/real/zoo.sh" "$gyroakf" 1 z.csv >z_out 2>&1; then pass; else fail "zoo.sh: $(tail -n 1 z_out)"; fi
   is "rows" "$(grep -cE '^[a-z-]+ +1 ' z_out)" 7
   is "what is wrong" "$(sed -n '/^Verdicts/,$p' z_out | tr '\n' ' ')" \
      "Verdicts that are wrong: 0  Values that are wrong: 0  Contradictions: 0 "
   # a document that denies the drift of its report
   cat >z_denies <<END
#!/bin/sh
"$gyroakf" "\$@" && [ "\$1" = simulate ] ||
   { sed 's/"drift": "random_walk"/"drift": "none"/' "\$4" >z_json && cp z_json "\$4"; }
END
   chmod +x z_denies
   sed '2,7d' z.csv >z_walk.csv
   "$root/bench/real/zoo.sh" "$PWD/z_denies" 1 z_walk.csv >z_out 2>&1
   holds "a wrong verdict" "walk, seed 1: verdict none" z_out
   holds "a contradiction" "walk, seed 1: verdict none; K = " z_out
fi
