# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# Figures: scripts, data, gnuplot found, missing, failing. Where gnuplot is not installed a stand-in makes the files.

simulate_plot() { "$gyroakf" simulate --samples "$1" --coefficients N=0.01,B=0.002 --seed "$2" --output "$3" "${@:4}"; }
simulate_plot 4000 1 plot.txt --trend 0,1e-6 --outlier-count 3 --outlier-size 12
figures='series allan before_after filters innovations histogram correlation residuals spectrum'

usual=$PATH
if ! command -v gnuplot >/dev/null; then
   mkdir -p bin
   # shellcheck disable=SC2016
   printf '#!/bin/sh\n[ "$1" != --version ] || exit 0\ngrep -q "^plot " "$3" || { echo "no plot"; exit 1; }\neval "${2}"\n%s\n' \
      'echo "<svg><use/></svg>" >"$figure"' >bin/gnuplot
   chmod +x bin/gnuplot
   PATH=$work/bin:$PATH
fi

good "figures" plot.txt --rate 5 --unit deg/s --out plots.d --plot svg --quiet
for name in $figures; do
   if [ -s plots.d/plots/$name.gp ] && [ -s plots.d/plots/$name.svg ]; then pass; else fail "no figure '$name'"; fi
done
if command -v xmllint >/dev/null; then
   if xmllint --noout plots.d/plots/*.svg; then pass; else fail "a figure is no XML"; fi
fi
is "nothing else is in the folder" "$(find plots.d/plots -type f ! -name '*.gp' ! -name '*.svg' ! -name '*.dat' | sort | tr '\n' ' ')" \
   ""
holds "outliers are in the data" "# outliers" plots.d/plots/series.dat
is "as many outliers as were removed" "$(sed -n '/^# outliers/,/^$/p' plots.d/plots/series.dat | grep -c ,)" \
   "$(sed -n 's/.*"removed": \([0-9]*\).*/\1/p' plots.d/results.json | head -n 1)"
is "a script draws again" "$(cd plots.d/plots && rm allan.svg && gnuplot -e "figure='allan.svg'" allan.gp && [ -s allan.svg ] && echo yes)" yes

simulate_plot 40000 2 plot_long.txt
good "a long series" run plot_long.txt --rate 5 --out long.d --plot svg --quiet
is "points of a long series are bounded" "$(($(wc -l <long.d/plots/series.dat) < 25000))" 1
is "points of long innovations are bounded" "$(($(wc -l <long.d/plots/innovations.dat) < 12100))" 1
is "a residual for every lag" "$(sed -n '/^# autocorrelation/,/^$/p' plots.d/plots/residuals.dat | grep -c ,)" 20

good "an Allan analysis alone" allan plot.txt --out allan.d --plot pdf --quiet
is "its figures" "$(cd allan.d/plots && ls *.pdf | tr '\n' ' ')" "allan.pdf before_after.pdf "
paste -d ' ' plot.txt plot.txt | grep -v '#' >plot_two.txt
{ echo 'g"x gX'; cat plot_two.txt; } >plot_named.txt
good "several channels" run plot_named.txt --column 1,2 --rate 5 --unit deg/s --out "it's.d" --plot png --quiet
is "a figure each" "$(ls "it's.d/plots" | grep -c '^allan-g.*png$')" 2
good "several files" allan plot.txt plot_long.txt --out many.d --plot svg --quiet
is "a figure of each file" "$(find many.d -name allan.svg | wc -l)" 2

bad "figures without a folder" 1 "--plot needs --out DIR" plot.txt --plot svg
bad "an unknown format" 1 "'gif' is not one of these" plot.txt --out g.d --plot gif
mkdir -p none
for tool in sh head grep; do ln -sf "$(command -v $tool)" none/$tool; done
PATH=$work/none bad "no gnuplot" 2 "install it: apt install gnuplot-nox" plot.txt --out none.d --plot svg
if [ -e none.d ]; then fail "a folder without gnuplot"; else pass; fi
mkdir -p broken
printf '#!/bin/sh\necho "line 3: out of paper" >&2\nexit 1\n' >broken/gnuplot
chmod +x broken/gnuplot
PATH=$work/broken:$PATH bad "gnuplot fails" 2 "line 3: out of paper" plot.txt --out fail.d --plot svg
is "no figure is left" "$(find fail.d -name '*.svg*' | wc -l)" 0
PATH=$usual
