# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# report.html: whole, nothing of the input unescaped, its numbers those of results.json. What a browser makes of it: ci/page.sh.

"$gyroakf" simulate --samples 3000 --coefficients N=0.01,B=0.002 --seed 9 --output page.txt
{ printf '%s\n' "<b>&\"\\' gy"; grep -v '#' page.txt | awk '{ print $1, 2*$1 }'; } >'p <i>&.txt'

# numbers KEY PAGE: those that a page has under a key that ends in .0, .1, ...
numbers() { grep -oE "data-key=\"$1\.[0-9]+\" data-value=\"[^\"]*\"" "$2" | sed 's/.*data-value="\([^"]*\)"/\1/' | tr '\n' ' '; }

good "a page" 'p <i>&.txt' --column 1,2 --rate 5 --unit deg/s --out page.d --plot none --quiet
is "it begins" "$(head -n 1 page.d/report.html)" "<!DOCTYPE html>"
is "it ends" "$(tail -n 1 page.d/report.html)" "</html>"
is "names are escaped" "$(grep -cE '<(b|i)>' page.d/report.html)" 0
holds "a name as it is" '<h3>Channel &lt;b&gt;&amp;&quot;\&#39;</h3>' page.d/report.html
holds "a path as it is" '<h2>p &lt;i&gt;&amp;.txt</h2>' page.d/report.html
holds "the command line" "gyroakf &#39;p &lt;i&gt;&amp;.txt&#39; --column 1,2 --rate 5 --unit deg/s --out page.d --plot none --quiet" page.d/report.html
is "no figures" "$(grep -c '<svg' page.d/report.html)" 0
holds "why" "as --plot none asks for" page.d/report.html
is "nothing from outside" "$(grep -cE 'https?://|@import' page.d/report.html)" 0
is "every name once" "$(grep -oE ' id="[^"]*"' page.d/report.html | sort | uniq -d | wc -l)" 0

good "one channel" page.txt --out page_one.d --plot none --quiet
for key in tau_s deviation lower upper; do
   is "$key of the curve" "$(numbers "allan.input.$key" page_one.d/report.html)" \
      "$(sed -n '/"allan": {/,/"cleaned"/s/.*"'$key'": \[\(.*\)\].*/\1/p' page_one.d/results.json | tr -d ',' | head -n 1) "
done
variance=$(sed -n '/"kf": {/,/}/s/.*"variance": \(.*\),/\1/p' page_one.d/results.json | head -n 1)
holds "variance of the Kalman filter" "data-key=\"filters.kf.variance\" data-value=\"$variance\"" page_one.d/report.html

mkdir -p page_none
for tool in sh head grep; do ln -sf "$(command -v $tool)" page_none/$tool; done
PATH=$work/page_none good "a page without gnuplot" page.txt --out page_none.d --quiet
holds "how to have figures" "apt install gnuplot-nox" page_none.d/report.html
mkdir -p page_gnuplot
# shellcheck disable=SC2016
printf '#!/bin/sh\neval "${2}"\n%s\n' 'echo "<svg viewBox=\"0 0 1 1\"><g id=\"a\"><use xlink:href='"'#a'"'/></g></svg>" >"$figure"' \
   >page_gnuplot/gnuplot
chmod +x page_gnuplot/gnuplot
PATH=$work/page_gnuplot:$PATH good "figures for the page alone" page.txt --out page_figures.d --quiet
is "they are in it" "$(grep -c '<svg role="img" aria-label="[^"]' page_figures.d/report.html)" 9
is "every name of the figures once" "$(grep -oE ' id="[^"]*"' page_figures.d/report.html | sort | uniq -d | wc -l)" 0
holds "references follow" "<g id=\"r1c1allan-a\"><use xlink:href='#r1c1allan-a'/>" page_figures.d/report.html
is "nothing else is left" "$(find page_figures.d -name '*.part*' -o -type d ! -name page_figures.d | wc -l)" 0
printf '#!/bin/sh\nexit 1\n' >page_gnuplot/gnuplot
PATH=$work/page_gnuplot:$PATH good "gnuplot fails" page.txt --out page_fail.d --quiet
holds "it tells how to see why" "plot svg tells" page_fail.d/report.html
is "nothing is left of it" "$(find page_fail.d -name '*.part*' | wc -l)" 0
good "a page is replaced" page.txt --out page_one.d --plot none --quiet
echo other >page_one.d/report.html
bad "another page is kept" 2 "page_one.d/report.html: already exists" page.txt --out page_one.d
