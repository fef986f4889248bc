# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# The same numbers, whatever way they come in: text, CSV, CRLF, byte-order mark, pipes, locales.
seq 1 400 | awk 'BEGIN { printf "# rate_hz: 50\n# unit: deg/s\n# columns: gx gy\n" }
   { printf "%.6f %.6f\n", sin($1*$1), cos(3*$1*$1) + 0.01*$1 }' >plain.txt

results() { no_command_line | grep -vE '"(path|format|rate_source|unit_source)"'; }
# alike NAME ARGUMENTS...: the JSON document, but for where things come from, is that of plain.txt
alike() {
   local name=$1; shift
   good "$name" run "$@" --json -
   same "$name" out
}
# same NAME FILE: the JSON document in the file is that of plain.txt
same() {
   if cmp -s <(results <"$2") plain.json; then pass
   else fail "$1: differs: $(diff <(results <"$2") plain.json | head -n 4) $(head -c 200 err)"; fi
}

good "plain text" run plain.txt --json -
results <out >plain.json
is "numbers of plain text" "$(grep -cE '^ {4}"samples": 400,?$' plain.json)" 1
if command -v python3 >/dev/null; then
   if python3 -m json.tool out >/dev/null; then pass; else fail "run --json is no JSON"; fi
   good "inspect as JSON" inspect plain.txt --json -
   if python3 -m json.tool out >/dev/null; then pass; else fail "inspect --json is no JSON"; fi
fi

sed 's/$/\r/' plain.txt >crlf.txt
alike "CRLF" crlf.txt
{ printf '\357\273\277'; cat plain.txt; } >mark.txt
alike "byte-order mark" mark.txt
sed 's/^\([^#]*\) /   \1\t/' plain.txt >tabs.txt
alike "tabs and leading blanks" tabs.txt
printf '%s' "$(cat plain.txt)" >unended.txt
alike "no line feed at the end" unended.txt
grep -v '^#' plain.txt | awk 'BEGIN { print "\"gx\";\"gy\"" } { print $1 ";" $2 ";" }' >semicolon.csv
alike "CSV with options" semicolon.csv --rate 50 --unit deg/s --column gx,gy

"$gyroakf" run - --json - <plain.txt >out 2>err
same "standard input from a file" out
{ head -c 3000 plain.txt; sleep 0.3; tail -c +3001 plain.txt; } | "$gyroakf" run - --json - >out 2>err
same "a pipe in two halves" out
mkfifo pipe
{ head -c 2999 plain.txt; sleep 0.3; tail -c +3000 plain.txt; } >pipe &
run run pipe --json -
kill $! 2>/dev/null
wait $! 2>/dev/null
same "a FIFO in two halves" out
for locale in de_DE.UTF-8 de_DE.utf8 de_DE; do
   locale -a 2>/dev/null | grep -qix "$locale" || continue
   LC_ALL=$locale "$gyroakf" run plain.txt --json - >out 2>err
   same "locale $locale" out
   break
done

# time stamps in a column of their own, a gap, a duplicate
awk 'BEGIN { print "time_ms,gx,gy,gz"; for (i = 0; i < 600; i++) { if (i == 300) continue
   print i*10 "," sin(i*i) "," cos(i*i) "," sin(7*i) } }' >stamped.csv
good "inspect of time stamps" inspect stamped.csv --unit deg/s
holds "rate from the stamps" "100" out
holds "channels by name" "gz" out
is "inspect fits 80 columns" "$(LC_ALL=C.UTF-8 awk 'length > 80' out)" ""
good "run of time stamps" run stamped.csv --unit deg/s
is "run fits 80 columns" "$(LC_ALL=C.UTF-8 awk 'length > 80' out)" ""
good "one column by name" inspect stamped.csv --column gy --json -
is "one channel" "$(no_command_line <out | grep -c '"g[xyz]"')" 1
awk 'BEGIN { print "# rate_hz: 100\n# units: deg/s m/s^2\n# columns: gx ax"
   for (i = 0; i < 600; i++) print sin(i*i), cos(i*i) }' >mixed.txt
good "a unit for each column" allan mixed.txt --details --json mixed.json
holds "units by channel" "deg/s for gx; m/s^2 for ax" out
holds "angle random walk of the gyroscope" "N angle random walk" out
holds "velocity random walk of the accelerometer" "N velocity random walk" out
holds "limits in the accelerometer's unit" "m/s/sqrt(h)" out
is "units in JSON" "$(grep -c '"unit": "\(deg/s\|m/s^2\)"' mixed.json)" 2
good "a list of units" inspect mixed.txt --unit rad/s,g
holds "the option's list" "rad/s for gx; g for ax (as the option says)" out
bad "a list of the wrong length" 2 "--unit names 3 units, but the number of channels is 2 (gx ax)" inspect mixed.txt --unit g,g,deg/s
bad "an unknown unit in a list" 1 "unknown unit 'gees'" inspect mixed.txt --unit deg/s,gees
good "negative value of an option" inspect plain.txt --scale -2
good "option with =" inspect plain.txt --scale=-2 --column=2
cp plain.txt ./-odd
good "-- ends the options" inspect -- -odd
good "first word is a file" plain.txt
cp plain.txt allan
good "-- before a file named like a command" -- allan

printf '1\nx\n3\n%s\n' "$(seq 1 50)" >lines.txt
bad "bad line" 2 "lines.txt:2:1:" inspect lines.txt
good "bad line as missing" inspect lines.txt --bad-lines missing
holds "bad line counted" "1" out

# odd headers and stamps are no errors, but the user is told: text of the warning ; content
while IFS= read -r line; do
   # shellcheck disable=SC2059
   printf "${line##* ; }" >odd.txt
   good "odd: ${line##* ; }" inspect odd.txt
   tr -s ' \n' ' ' <out >words
   holds "odd: ${line##* ; }" "${line%% ; *}" words
done <<'LINES'
rate_hz 'fast' is not a positive number ; # rate_hz: fast\n1\n2\n
rate_hz '0' is not a positive number ; # rate_hz: 0\n1\n2\n
rate_hz '-5' is not a positive number ; # rate_hz: -5\n1\n2\n
unit 'parsec' is not known ; # unit: parsec\n1\n2\n
unit deg does not fit --input rate ; # unit: deg\n1\n2\n
columns are 3, the first row has 2 ; # columns: t gx gy\n1 2\n3 4\n
3 equal stamps; the first is in line 3 ; t gx\n1 1\n1 2\n1 3\n1 4\n
a second rate, 100 Hz after 50 Hz; the last counts ; # rate_hz: 50\n# dt: 0.01\n1\n2\n
1 backward step; the first is in line 4 ; t gx\n0.1 1\n0.2 2\n0.1 3\n0.4 4\n
LINES

# a clock that is set forward in the middle of a record; every 97th row left out
awk 'BEGIN { print "t,gx"; for (i = 0; i < 2000; i++) printf "%.2f,%.6f\n", i*0.01 + (i > 1000)*1e7, sin(i*i) }' >forward.csv
good "clock set forward" inspect forward.csv
tr -s ' \n' ' ' <out >words
holds "line of a jump" "1 gap; the first is in line 1003" words
holds "jump not filled" "too long to be filled with missing samples" words
awk 'BEGIN { print "t,gx"; for (i = 1; i < 2000; i++) if (i % 97) printf "%.2f,%.6f\n", i*0.01, sin(i*i) }' >beat.csv
good "double steps at even distances" inspect beat.csv
tr -s ' \n' ' ' <out >words
holds "double steps told" "double step in 20 places" words

# what a newcomer brings: the export of a ROS bag, labels between numbers, files put behind one another
awk 'BEGIN { print "seq,stamp.secs,stamp.nsecs,frame_id,x"
   for (i = 0; i < 300; i++) { n = i*5; printf "%d,%d,%d,imu,%.4f\n", i, 1700000000 + int(n/1000), n%1000*1000000, sin(i*i) } }' >ros.csv
good "seconds and nanoseconds" inspect ros.csv --json ros.json
holds "their rate" "Rate            200 Hz (from the time stamps); 1.5 s" out
holds "text and counters are left out" "1 seq (counter); 4 frame_id (text)" out
awk '{ print "12:00:0" NR%10 ".5 -> X: " $1 " Y: " $2 }' <(sed 1,3d plain.txt | head -n 9) >labels.txt
good "labels between numbers" inspect labels.txt --json -
holds "the channels" '"channels": ["X", "Y"]' out
printf 'gx:1,gy:2\ngx:3,gy:4\n' >labeled.txt
good "labels before numbers" inspect labeled.txt --json -
holds "their names" '"channels": ["gx", "gy"]' out
printf '1 2 x\n3 4 5\n' >words.txt
bad "columns of numbers are named" 2 "options that read it: --column 1,2" inspect words.txt
# a condition on the last field, a long number: nothing behind the line is read with it
awk 'BEGIN { print "gx,id"; for (i = 0; i < 40; i++) print i % 5 "," (i % 2 ? "1.234567890123" : "2.345678901234") }' >last.csv
good "a condition on the last column" inspect last.csv --where id=1.234567890123 --rate 10
holds "its rows" "20 in" out
