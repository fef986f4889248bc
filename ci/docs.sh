#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# What README and doc/ show is so: every fenced command of the program ends well, what stands below
# "$ gyroakf ..." is what it prints ("..." for lines left out), snippets are lines of the file linked
# above them, links lead somewhere.
#
#   ci/docs.sh [PROGRAM]      PROGRAM: default is what fpm built
#
# The last line is "N passed, N failed".
set -u
cd "$(dirname "$0")/.." || exit 1
export LC_ALL=C.UTF-8
unset NO_COLOR
root=$PWD
program=${1:-$(./setup.sh fpm run gyroakf --runner echo 2>/dev/null | tail -n 1)}
[ -x "$program" ] || { echo "no program: $program"; exit 1; }
program=$(cd "$(dirname "$program")" && pwd)/$(basename "$program")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
ln -s "$program" "$work/bin/gyroakf"
PATH=$work/bin:$PATH
passed=0
failed=0

pass() { passed=$((passed + 1)); }
fail() { failed=$((failed + 1)); printf 'FAILED: %s\n' "$*"; }

# whole documents of commands and snippets; the others are looked at for links only
documents=(README.md doc/guide.md doc/program.md c_api/README.md)

# commands that need what is not made here: they are not run
needs_own_data() { # LINE
  case $1 in
    *imu.bin*) return 0 ;;                                           # 16-bit integers of a device
    *zstd*) ! command -v zstd >/dev/null ;;
    *) return 1 ;;
  esac
}

# stand-ins for the user's recordings in the folder we are in: three and six channels, a day of files, arrays, compressed ones
recordings() {
  local i
  for i in 1 2 3 4 5 6; do
    gyroakf simulate --samples 6000 --rate 100 --coefficients N=0.005,K=0.0002 --seed $i --output $i.txt >/dev/null || return 1
    grep -v '^#' $i.txt >$i.column
  done
  { echo gx,gy,gz; paste -d, 1.column 2.column 3.column; } >log.csv
  { echo "time [s],gx,gy,gz,ax,ay,az"; paste -d, {1..6}.column | awk '{ printf "%.2f,%s\n", NR/100, $0 }'; } >imu.csv
  { echo gx; cat 1.column; } >huge.csv
  mkdir day
  cp huge.csv day/1.csv
  cp log.csv day/2.csv
  gyroakf simulate --samples 6000 --rate 1000 --coefficients N=0.005 --output gyro.npy >/dev/null || return 1
  gyroakf simulate --samples 6000 --rate 1000 --coefficients N=0.005 --output gyro.f64 >/dev/null || return 1
  gzip -k gyro.npy
  if command -v zstd >/dev/null; then zstd -q log.csv huge.csv; fi
  rm -f [1-6].txt [1-6].column
  ln -s "$root/example" example
}

page_picture() { # PAGE: the top of a page of results as SVG, without the day on which it was made and what its script reads
  printf '<svg xmlns="http://www.w3.org/2000/svg" width="1010" height="1430" viewBox="0 0 1010 1430">\n'
  sed -n '/^<style>/,/^<\/style>/p' "$1"
  printf '<foreignObject width="1010" height="1430"><body xmlns="http://www.w3.org/1999/xhtml">\n'
  sed -n '/^<header>/,/^<\/main>/p' "$1" | sed -E 's/(<h1>.*), [0-9-]{10}</\1</; s/<(br|meta|hr)>/<\1\/>/g
    s/ data-[a-z0-9-]+="[^"]*"//g; s/<svg /<svg xmlns="http:\/\/www.w3.org\/2000\/svg" /'
  printf '</body></foreignObject></svg>\n'
}

# FILE's fenced blocks: a line "LANGUAGE|NUMBER OF ITS FIRST LINE|LAST FILE LINKED ABOVE" each,
# its lines in $work/block.NUMBER
blocks() { # FILE
  awk -v to="$work/block." '
    /^```/ && !inside { inside = 1; name = to NR; printf "" >name; print substr($0, 4) "|" NR "|" linked; next }
    /^```/ { inside = 0; close(name); next }
    inside { print >name; next }
    { rest = $0
      while (match(rest, /\]\([^)#]+\)/)) {
        linked = substr(rest, RSTART + 2, RLENGTH - 3)
        rest = substr(rest, RSTART + RLENGTH)
      }
    }
  ' "$1"
}

# shows SHOWN WHOLE [end]: whether the stretches of SHOWN, parted by lines "...", stand in WHOLE in this order, each without a gap;
# end: also from its first to its last line where SHOWN does not begin or end with "..."
shows() {
  awk -v strict="${3-}" '
    { sub(/[ \t]+$/, "") }
    NR == FNR { want[++n] = $0; next }
    { have[++m] = $0 }
    function fits(at, first, last,   i) { # the furthest line that differs is kept for the message
      for (i = first; i <= last; i++) if (have[at + i - first] != want[i]) {
        if (i - first >= near) { near = i - first; miss = i }
        return 0
      }
      return at + last - first <= m
    }
    END {
      at = 1
      for (first = 1; first <= n; first = last + 2) {
        for (last = first - 1; last < n && want[last + 1] !~ /^ *\.\.\.$/; last++);
        if (last < first) continue
        near = 0
        miss = first
        if (strict != "" && last == n && first > 1 && m - (last - first) >= at) at = m - (last - first)
        while (at + last - first <= m && !fits(at, first, last)) { if (strict != "" && first == 1) break; at++ }
        if (!fits(at, first, last)) { print "not there: " want[miss]; exit 1 }
        at += last - first + 1
        if (strict != "" && last == n && at != m + 1) { print "more comes after: " want[last]; exit 1 }
      }
    }' "$1" "$2"
}

# run LINE: ends well; what it prints goes to $work/out
run() {
  timeout 60 bash -c "$1" >"$work/out" 2>"$work/err" </dev/null
}

# commands BLOCK PLACE: those of a block, one after the other
commands() {
  local line shown=$work/shown told
  : >"$shown"
  { cat "$1"; echo '$ end'; } >"$work/lines"
  told=
  while IFS= read -r line <&3; do
    if [[ $line == '$ '* ]]; then
      if [ -s "$shown" ] && [ -n "$told" ]; then
        if shows "$shown" "$work/out" end >"$work/why"; then pass; else fail "$2: $told: $(cat "$work/why")"; fi
      fi
      : >"$shown"
      line=${line#\$ }
      told=
      [ "$line" != end ] || continue
      told=$line
    elif [ -n "$told" ]; then
      printf '%s\n' "$line" >>"$shown"
      continue
    fi
    line=${line#./setup.sh }
    line=${line/#fpm run gyroakf --/gyroakf}
    [[ $line == gyroakf\ * || $line == *'| gyroakf '* ]] || continue
    if needs_own_data "$line"; then echo "not run: $line"; told=; continue; fi
    if run "$line"; then pass; else fail "$2: $line: exit code $?: $(head -n 2 "$work/err")"; fi
  done 3<"$work/lines"
}

mkdir "$work/given"
cd "$work/given" && recordings || { echo "the recordings cannot be made"; exit 1; }
for document in "${documents[@]}"; do
  cp -a "$work/given" "$work/here"
  cd "$work/here" || exit 1
  blocks "$root/$document" >"$work/blocks"
  while IFS="|" read -r language number linked <&4; do
    case $language in
      c | cpp | fortran)
        if shows "$work/block.$number" "$root/$(dirname "$document")/$linked" >"$work/why"; then pass
        else fail "$document:$number: not as in $linked: $(cat "$work/why")"; fi ;;
      *) commands "$work/block.$number" "$document:$number" ;;
    esac
  done 4<"$work/blocks"
  if [ "$document" = README.md ]; then
    cp six_hours/figures/allan.svg "$work/allan.svg"
    page_picture six_hours/report.html >"$work/report.svg"
  fi
  cd "$root" || exit 1
  rm -rf "$work/here" "$work"/block.*
done

# the pictures that README shows
for picture in allan.svg report.svg; do
  if cmp "$work/$picture" doc/images/$picture; then pass; else fail "doc/images/$picture is not what six_hours of README gives"; fi
done

# links to files of the repository, and to sections of them
for document in README.md CONTRIBUTING.md c_api/README.md doc/*.md; do
  grep -oE '\]\([^) ]+\)' "$document" | sed 's/^](//; s/)$//' | grep -v '^[a-z]*://' | sort -u | while read -r link; do
    file=${link%%#*}
    section=${link#"$file"}
    file=${file:+$(dirname "$document")/$file}
    file=${file:-$document}
    [ -e "$file" ] || { echo "$document: no $link"; continue; }
    [ -z "$section" ] || grep -E '^#+ ' "$file" | sed -E 's/^#+ //' | tr '[:upper:] ' '[:lower:]-' | tr -cd 'a-z0-9_\n-' |
      grep -qxF -- "${section#\#}" || echo "$document: no section $link"
  done
done >"$work/links"
if [ -s "$work/links" ]; then fail "links: $(cat "$work/links")"; else pass; fi

# files that the documents on the code name: from the root, or below src/gyroakf
for document in CONTRIBUTING.md doc/architecture.md doc/performance.md; do
  grep -oE '`[a-z_]+/[a-z_/]+\.(f90|sh|py|h|c|md|json)`' "$document" | tr -d '`' | sort -u | while read -r file; do
    [ -e "$file" ] || [ -e "src/gyroakf/$file" ] || echo "$document: no $file"
  done
done >"$work/files"
if [ -s "$work/files" ]; then fail "files: $(cat "$work/files")"; else pass; fi
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
