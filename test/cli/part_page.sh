# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# report.html: whole, nothing of the input unescaped, its numbers those of results.json, rounded. What a browser makes of it: ci/page.sh.

"$gyroakf" simulate --samples 3000 --coefficients N=0.01,B=0.002 --seed 9 --output page.txt
{ printf '%s\n' "<b>&\"\\' gy"; grep -v '#' page.txt | awk '{ print $1, 2*$1 }'; } >'p <i>&.txt'

good "a page" 'p <i>&.txt' --column 1,2 --rate 5 --unit deg/s --out page.d --quiet
is "it begins" "$(head -n 1 page.d/report.html)" "<!DOCTYPE html>"
is "it ends" "$(tail -n 1 page.d/report.html)" "</html>"
is "names are escaped" "$(grep -cE '<(b|i)>' page.d/report.html)" 0
holds "a name as it is" '<h3>Channel &lt;b&gt;&amp;&quot;\&#39;</h3>' page.d/report.html
holds "file and date" "<h1>p &lt;i&gt;&amp;.txt, $(date +%Y)-" page.d/report.html
is "details are folded" "$(grep -c '^<details>' page.d/report.html)" 2
holds "which minimum is meant" "<p>minimum: lowest reliable Allan deviation, among points with at least 20 degrees of freedom" page.d/report.html
holds "the command line" "gyroakf &#39;p &lt;i&gt;&amp;.txt&#39; --column 1,2 --rate 5 --unit deg/s --out page.d --quiet" page.d/report.html
is "figures: an overlay, three of each channel" "$(grep -c '<svg class="fig" role="img" aria-label="[^"]' page.d/report.html)" 7
is "the overlay is above the channels" "$(grep -oE '<figure|<section id="c1"' page.d/report.html | head -n 2 | tr '\n' ' ')" \
   '<figure <section id="c1" '
is "the figures are those of the folder" "$(grep -c '<path' page.d/report.html)" "$(cat page.d/figures/*.svg | grep -c '<path')"
is "nothing from outside" "$(grep -cE 'https?://|@import' page.d/report.html)" 0
is "every name once" "$(grep -oE ' id="[^"]*"' page.d/report.html | sort | uniq -d | wc -l)" 0

good "one channel" page.txt --out page_one.d --quiet
holds "the cleaned curve" "Cleaned: oadev" page_one.d/report.html
good "nothing is cleaned" page.txt --outliers none --detrend none --out page_raw.d --quiet
is "no cleaned curve" "$(grep -c 'Cleaned: oadev' page_raw.d/report.html)" 0
for k in $(sed -n '/"allan": {/,/"cleaned"/s/.*"tau_s": \[\(.*\)\].*/\1/p' page_one.d/results.json | head -n 1 | tr -d ',' | xargs printf '%.6g '); do
   holds "the curve has tau = $k" ">$k</th>" page_one.d/report.html
done
variance=$(sed -n '/"kf": {/,/}/s/.*"variance": \(.*\),/\1/p' page_one.d/results.json | head -n 1)
holds "variance of the Kalman filter" "<td>$(awk -v x="$variance" 'BEGIN { printf "%.4e", x }')</td>" page_one.d/report.html

good "a page is replaced" page.txt --out page_one.d --quiet
echo other >page_one.d/report.html
bad "another page is kept" 2 "page_one.d/report.html: already exists" page.txt --out page_one.d
