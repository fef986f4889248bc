#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The page of --out, report.html, in a browser: no message on its console, its script at work, its numbers those of results.json, valid
# HTML. Of a recording, of several with one that holds traps, and of one without rate and unit; of three axes the printed sheets, of
# six the size of the page.
#
#   ci/page.sh [PROGRAM]      PROGRAM: default is what fpm built
#
# GYROAKF_PAGE=1 ./setup.sh installs what it takes (chromium, tidy); where that cannot be had it says "skipped: ...".
set -u
cd "$(dirname "$0")/.." || exit 1
root=$PWD
GYROAKF_PAGE=1 ./setup.sh true >/dev/null 2>&1
browser=
for name in chromium chromium-browser google-chrome; do
   if command -v "$name" >/dev/null; then browser=$name; break; fi
done
for tool in "${browser:-chromium}" tidy python3; do
   command -v "$tool" >/dev/null || { echo "skipped: no $tool"; exit 0; }
done
program=${1:-$(./setup.sh fpm run gyroakf --runner echo 2>/dev/null | tail -n 1)}
program=$(cd "$(dirname "$program")" && pwd)/$(basename "$program")
[ -x "$program" ] || { echo "no program"; exit 1; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
passed=0
failed=0

pass() { passed=$((passed + 1)); }
fail() { failed=$((failed + 1)); printf 'FAILED: %s\n' "$*"; }

# look PAGE FOLDER...: the page in the browser, and what the browser made of it
look() {
   local page=$1 lines
   shift
   HOME=$work timeout 120 "$browser" --headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage --enable-logging=stderr \
      --user-data-dir="$work/profile" --virtual-time-budget=5000 --dump-dom "file://$work/$page" >dom.html 2>browser.log ||
      { fail "$page: the browser ends with $?"; tail -n 3 browser.log; return; }
   if grep -q 'CONSOLE' browser.log; then fail "$page: console: $(grep -m 1 CONSOLE browser.log)"; else pass; fi
   for lines in "$page" dom.html; do
      python3 "$root/ci/page/check.py" "$lines" "$@" >check.log
      grep '^FAILED' check.log
      read -r p f < <(sed -nE 's/^([0-9]+) passed, ([0-9]+) failed$/\1 \2/p' check.log)
      passed=$((passed + ${p:-0}))
      failed=$((failed + ${f:-1}))
   done
   if tidy -q -e -utf8 "$page" >/dev/null 2>tidy.log; then pass; else fail "$page: tidy: $(head -n 2 tidy.log)"; fi
}

example=$root/example/data/mems_gyro_x.txt
"$program" "$example" --out one --quiet || fail "example"
look one/report.html one
if grep -q 'class="reading"' dom.html; then pass; else fail "the curve cannot be read"; fi

{ printf '%s\n' "<b>&\"\\' gy"; "$program" simulate --samples 3000 --coefficients N=0.01 --seed 5 | grep -v '#' |
   awk '{ print $1, 2*$1 }'; } >'a <i>&.txt'
"$program" 'a <i>&.txt' "$example" --rate 5 --unit deg/s --out many --quiet || fail "two recordings"
look 'many/a <i>&/report.html' 'many/a <i>&'
if grep -qE '<(b|i)>' dom.html; then fail "a name became an element"; else pass; fi

grep -v '#' "$example" | head -n 2000 >bare.txt
"$program" allan bare.txt --out bare --quiet || fail "nothing known"
look bare/report.html bare
if [ "$(grep -c '<svg' bare/report.html)" -eq 2 ]; then pass; else fail "figures of a record without rate and unit"; fi

# Of six axes: the page's size, and the seconds that --out takes.
for i in 1 2 3 4 5 6; do
   "$program" simulate --samples 12000 --rate 100 --coefficients N=0.01,B=0.002 --outlier-count 5 --outlier-size 12 --seed $i |
      grep -v '#' >axis$i.txt
done
paste axis?.txt >six.txt
paste axis[123].txt >three.txt
begin=$EPOCHREALTIME
"$program" six.txt --rate 100 --unit deg/s >/dev/null || fail "six axes"
middle=$EPOCHREALTIME
"$program" six.txt --rate 100 --unit deg/s --out six >/dev/null || fail "six axes with --out"
size=$(wc -c <six/report.html)
awk -v a="$begin" -v b="$middle" -v c="$EPOCHREALTIME" -v size="$size" \
   'BEGIN { printf "six axes: report.html has %d bytes, --out adds %.2f s to %.2f s\n", size, (c - b) - (b - a), b - a }'
if [ "$size" -le 1500000 ]; then pass; else fail "the page of six axes has $size bytes"; fi

"$program" three.txt --rate 100 --unit deg/s --out three --quiet || fail "three axes"
HOME=$work timeout 120 "$browser" --headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage --user-data-dir="$work/profile" \
   --no-pdf-header-footer --print-to-pdf=three.pdf "file://$work/three/report.html" 2>/dev/null
sheets=$(grep -aoE '/Type ?/Page([^s]|$)' three.pdf | wc -l)
if [ "$sheets" -ge 1 ] && [ "$sheets" -le 8 ]; then pass; else fail "three axes on $sheets sheets"; fi

# frame PAGE WIDTH SCRIPT: the page in a frame of a width; the script leaves what it finds in the title of frame.dom
frame() {
   printf '<!DOCTYPE html><title>w</title><iframe src="%s" style="width:%spx;height:900px"></iframe><script>onload=function(){%s}</script>' \
      "$1" "$2" "var d=frames[0].document;$3" >frame.html
   HOME=$work timeout 120 "$browser" --headless=new --no-sandbox --disable-gpu --disable-dev-shm-usage --user-data-dir="$work/profile" \
      --allow-file-access-from-files --virtual-time-budget=5000 --dump-dom "file://$work/frame.html" >frame.dom 2>/dev/null
}

for width in 1280 390; do                              # nothing is wider than the window
   frame one/report.html $width 'd=d.documentElement;document.title=d.scrollWidth-d.clientWidth'
   if grep -q '<title>0</title>' frame.dom; then pass; else
      fail "$width: $(grep -o '<title>[^<]*' frame.dom) pixels wider than the window"; fi
done

# values under the pointer of every figure
frame three/report.html 1280 'var n=0;d.querySelectorAll("details").forEach(function(e){e.open=true});
d.querySelectorAll("figure").forEach(function(f){var s=f.querySelector("svg"),b=s.getBoundingClientRect();
s.dispatchEvent(new PointerEvent("pointermove",{clientX:b.left+b.width/2,clientY:b.top+b.height/2}));
if(/[:=] -?[0-9.e-]+/.test(f.querySelector(".reading").textContent))n++});document.title=n+" of "+d.querySelectorAll("figure").length'
if grep -q '<title>10 of 10</title>' frame.dom; then pass; else fail "values of figures: $(grep -o '<title>[^<]*' frame.dom)"; fi

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
