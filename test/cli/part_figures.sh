# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# Figures of --out DIR: DIR/figures/*.svg, well-formed, of every channel, bounded in size.

simulate_figure() { "$gyroakf" simulate --samples "$1" --coefficients N=0.01,B=0.002 --seed "$2" --output "$3" "${@:4}"; }
simulate_figure 4000 1 figure.txt --trend 0,1e-6 --outlier-count 3 --outlier-size 12
names() { (cd "$1" && find . -name '*.svg' | sort | tr '\n' ' '); }

good "figures" figure.txt --rate 5 --unit deg/s --out run.d --quiet
is "of a whole run" "$(names run.d/figures)" "./allan.svg ./filters.svg ./series.svg "
is "nothing else is in the folder" "$(find run.d/figures -type f ! -name '*.svg' | wc -l)" 0
is "as many outliers as were removed" "$(grep -c 'class="dot" data-i="[1-9]' run.d/figures/series.svg)" \
   "$(sed -n 's/.*"removed": \([0-9]*\).*/\1/p' run.d/results.json | head -n 1)"
is "a point for every averaging time" "$(grep -cE 'class="(dot|hollow)" data-i="[1-9]' run.d/figures/allan.svg)" \
   "$(grep -c ',input,' run.d/allan.csv)"
holds "N in the legend" ">N = 0." run.d/figures/allan.svg
holds "the second axis" ">deg/h</text>" run.d/figures/allan.svg

simulate_figure 400000 2 long.txt
good "a long series" run long.txt --rate 5 --out long.d --quiet
is "its figure is bounded" "$(($(wc -c <long.d/figures/series.svg) < 60000))" 1
good "an Allan deviation alone" allan figure.txt --out allan.d --quiet
is "its figures" "$(names allan.d/figures)" "./allan.svg ./series.svg "
good "tests alone" tests figure.txt --out tests.d --quiet
is "the record" "$(names tests.d/figures)" "./series.svg "

{ echo 'g"x gX <b>'; paste -d ' ' figure.txt figure.txt figure.txt | grep -v '#'; } >named.txt
good "several channels" allan named.txt --column 1,2,3 --rate 5 --unit deg/s --out "it's.d" --quiet
is "a figure each" "$(names "it's.d/figures" | tr ' ' '\n' | grep -c allan-)" 3
is "all in the overlay" "$(grep -oE '>(g&quot;x|gX|&lt;b&gt;)</text>' "it's.d"/figures/overlay-*.svg | wc -l)" 3
good "several files" allan figure.txt long.txt --out many.d --quiet
is "figures of each file" "$(find many.d -name allan.svg | wc -l)" 2

if command -v python3 >/dev/null; then
   if python3 -c 'import sys, xml.dom.minidom as m; [m.parse(f) for f in sys.argv[1:]]' ./*.d/figures/*.svg 2>xml.err
   then pass; else fail "a figure is no XML: $(tail -n 1 xml.err)"; fi
fi
is "numbers are finite" "$(cat ./*.d/figures/*.svg | grep -cE 'NaN|Inf')" 0
mkdir blocked.d
: >blocked.d/figures
bad "a file in the place of the folder" 2 "blocked.d/figures" figure.txt --out blocked.d --quiet
good "results anew" allan figure.txt --rate 5 --unit deg/s --out run.d --quiet --force
is "no figure of the run before" "$(names run.d/figures)" "./allan.svg ./series.svg "
echo '<svg/>' >run.d/figures/allan.svg
bad "another figure is kept" 2 "run.d/figures/allan.svg: already exists; use --force" figure.txt --out run.d --quiet
is "as it was" "$(cat run.d/figures/allan.svg)" '<svg/>'
good "inspect with --force" inspect figure.txt --out run.d --quiet --force
is "another figure stays, the others go" "$(names run.d/figures)" "./allan.svg "
rm run.d/figures/allan.svg
good "figures" figure.txt --out run.d --quiet
good "inspect" inspect figure.txt --out run.d --quiet
is "removes the figures of the run before" "$(names run.d/figures)" ""
