# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# What time stamps and values mean: dates, decimal commas, gaps, duplicates, bursts, rates that change, angles that wrap.

# plain "NAME" "TEXT": the text is in the last output, whatever the line breaks
plain() { tr -s ' \n' ' ' <out >words; holds "$1" "$2" words; }

# dates with a blank, in a comma file, across midnight
awk 'BEGIN { print "time,gx"
   for (i = 0; i < 400; i++) { s = 86398 + i*0.01; d = 1; if (s >= 86400) { s -= 86400; d = 2 }
      h = int(s/3600); m = int((s - h*3600)/60); s -= h*3600 + m*60
      printf "2026-05-%02d %02d:%02d:%09.6f,%.6f\n", d, h, m, s, sin(i*i) } }' >dates.csv
good "dates" inspect dates.csv --unit deg/s
plain "rate from dates" "Rate 100 Hz (from the time stamps)"
plain "no gap at midnight" "0 gaps"
sed 's/,/;/; s/\./,/g' dates.csv >german.csv
good "dates and numbers with decimal commas" inspect german.csv --unit deg/s
plain "rate from them" "Rate 100 Hz (from the time stamps)"
plain "commas are said" "the commas between digits are read as decimal commas"
tail -n +2 german.csv | cut -d';' -f2 >single.txt
bad "a decimal comma alone" 2 "options that read it: --decimal-comma" inspect single.txt
sed -i '/^0,[1-9]/d' single.txt
good "a decimal comma, forced" inspect single.txt --decimal-comma --json -
holds "one channel" '"channels": ["column1"]' out
sed 's/2026-05-\(..\)/05\/\1\/2026/' dates.csv >american.csv
bad "a date that may be either" 2 "may have the day or the month first" inspect american.csv
tail -n +2 american.csv >unnamed.csv
good "such a column left out" inspect unnamed.csv --column 3 --time-column none

# rates that change, repeated rows, bursts, a coarse clock
awk 'BEGIN { print "t,gx"; for (i = 0; i < 8000; i++) { printf "%.4f,%.6f\n", t, sin(i*i); t += i < 4999 ? 0.01 : 0.005 } }' >change.csv
good "a rate that changes" inspect change.csv --json change.json
plain "both rates and the line" "the rate changes from 100 Hz to 200 Hz in line 500"
plain "no gap at a change" "Missing 0 values, 0 gaps"
is "change in JSON" "$(grep -c '"rate_changes": 1' change.json)" 1
awk 'BEGIN { print "t,gx"; for (i = 0; i < 2000; i++) { r = sprintf("%.3f,%.6f", i*0.01 + 0.001*(i%3), sin(i*i)); print r; if (i%500 == 250) print r } }' >twice.csv
good "repeated rows" inspect twice.csv
plain "they are left out" "4 rows with stamp and values of the row above: left out; the first is in line 253"
plain "and do not raise the rate" "Samples 2000 in"
awk 'BEGIN { print "t,gx"; for (i = 0; i < 5000; i++) printf "%.3f,%.6f\n", int((i + 0.3*sin(i*i))/990*1000 + 5)/1000, sin(i*i) }' >coarse.csv
good "990 Hz in ms" inspect coarse.csv
plain "990 Hz, no gaps" "0 gaps"
is "990 Hz within 1e-3" "$(awk '/Rate/ { print ($2 > 989.5 && $2 < 990.5) }' out | head -n 1)" 1

# every eighth sample lost: from jittered stamps the rate is sure, from ms two rates explain them, and --rate decides
awk 'BEGIN { print "time_us,gx"; for (i = 0; i < 4000; i++) if (i%8 != 7) printf "%d,%.6f\n", i*1000 + (i*i)%7, sin(i*i) }' >eighth.csv
good "every eighth sample lost" inspect eighth.csv --json -
holds "the true rate" '"gaps": 499' out
awk -F, 'NR == 1 { print "time_ms,gx"; next } { printf "%d,%s\n", $1/1000, $2 }' eighth.csv >eighth_ms.csv
good "every eighth sample lost, in ms" inspect eighth_ms.csv
plain "rate with losses" "Rate 1000 Hz (from the time stamps)"
plain "the other rate" "875 Hz and a clock that counts in 0.001 s explain them equally well; --rate 875 takes the other explanation"
good "the other rate is given" inspect eighth_ms.csv --rate 875
plain "no losses at it" "Missing 0 values, 0 gaps"

# times by name and by behavior, counters, clocks that start again
for name in TimeUS time_usec 'Timestamp (us)' timestamp_sample SampleTimeFine 'Elapsed Time' gps_tow_s epoch UTC loggingTime; do
  case $name in
    *Fine) step=100 ;; *TimeUS* | *us* | *_sample) step=10000 ;; *) step=0.01 ;;
  esac
  awk -v name="$name" -v step=$step 'BEGIN { print name ",gx"
     for (i = 0; i < 300; i++) printf "%.10g,%.6f\n", 1000000 + i*step, sin(i*i) }' >named.csv
  good "time named $name" inspect named.csv
  plain "its rate: $name" "Rate 100 Hz (from the time stamps)"
  plain "its channel: $name" "in 1 channel: gx"
done
awk 'BEGIN { print "no,stamped,gx"; for (i = 0; i < 900; i++) printf "%d,%.0f,%.6f\n", i%256, (4294000000 + i*10000)%4294967296, sin(i*i) }' \
  >rollover.csv
good "a time by its behavior" inspect rollover.csv
plain "taken for the time" "column 'stamped' rises evenly from row to row and is taken for the time"
plain "its rollover" "starts again after 4294.967296 s in 1 place and is continued; the first is in line 99"
plain "a counter before it" "columns not analyzed: 1 no (counter)"
plain "its rate" "Rate 100 Hz (from the time stamps)"
awk 'BEGIN { print "T,gx"; for (i = 0; i < 300; i++) printf "%.2f,%.6f\n", 20 + i%7/10, sin(i*i) }' >warmth.csv
good "T is a temperature" inspect warmth.csv
plain "left out" "columns not analyzed: 1 T (temperature)"
awk 'BEGIN { print "when,gx"; for (i = 0; i < 301; i++) printf "%d,%.6f\n", int(i/2)*200, sin(i*i) }' >ticks.csv
good "equal stamps" inspect ticks.csv --time-unit 100us
plain "and a unit" "Rate 100 Hz (from the time stamps)"
bad "a wrong unit of time" 2 "the unit of time 'fortnight' is not known" inspect ticks.csv --time-unit fortnight

# rows without a time, and findings of the span that is read
awk 'BEGIN { print "t,gx"; for (i = 0; i < 300; i++) { printf "%.2f,%.6f\n,\n", i*0.01, sin(i*i); if (i%9 == 0) print ",5" } }' >blank.csv
good "rows without a time" inspect blank.csv
plain "left out" "334 rows without a time: left out; the first is in line 3"
plain "the rate is that of the others" "Rate 100 Hz (from the time stamps)"
awk 'BEGIN { print "t,gx"; for (i = 0; i < 2000; i++) printf "%.2f,%.6f\n", i*0.01 + (i > 1000)*0.5 - (i > 1500)*0.05, sin(i*i) }' >late_gap.csv
good "a gap outside the span" inspect late_gap.csv --to 9
plain "is not reported" "Missing 0 values, 0 gaps"
is "nothing to warn of" "$(grep -c Warning out)" 0
good "a gap inside it" inspect late_gap.csv --from 9 --to 12
plain "and its line" "the first is in line 1003"
bad "a span behind the end" 2 "the record ends at 20.45 s, before --from 50" inspect late_gap.csv --from 50

# angles of a counter, and temperatures
awk 'BEGIN { print "# rate_hz: 100\n# unit: deg"; for (i = 0; i < 2000; i++) print (i*700) % 65536 }' >counter.txt
good "a counter that wraps" inspect counter.txt --input angle --scale 0.01
plain "the option is named" "--wrap 65536 undoes it"
good "wrapping undone" inspect counter.txt --input angle --scale 0.01 --wrap 65536 --json -
holds "one rate" '"samples": 1999' out
good "wrapping undone, as text" inspect counter.txt --input angle --scale 0.01 --wrap 65536
plain "the rate is even" "1 - unknown deg/s 700 700 0 analyzed"
bad "a wrong value of --wrap" 1 "is neither auto, none nor a positive number" inspect counter.txt --input angle --wrap never
awk 'BEGIN { print "t,gx,temp [degC]"; for (i = 0; i < 100; i++) print i*0.1 "," sin(i*i) "," 20 + i*0.01 }' >warm.csv
good "a temperature" inspect warm.csv
plain "left out" "columns not analyzed: 3 temp (temperature); --column reads them"
good "a temperature that is wanted" inspect warm.csv --column temp

# samples placed by their stamps
awk 'BEGIN { print "t,gx"; for (i = 0; i < 3000; i++) if (i < 1000 || i > 1004) printf "%.5f,%d\n", i*0.01 + 0.003*sin(i*i), i }' >jittered.csv
good "resampled to the nearest slot" inspect jittered.csv --resample nearest --json nearest.json
plain "what was done" "Resampled each sample on the slot of its stamp, moved by up to 0.00448 s"
plain "empty slots" "5 empty slots (missing), 0 samples dropped"
holds "nearest in JSON" '"method": "nearest"' nearest.json
holds "samples with the empty slots" '"samples": 3000' nearest.json
good "interpolated" inspect jittered.csv --resample linear --json linear.json
plain "what it does to noise" "which leaves 0.721 of the variance of white noise; 384 slots in long intervals (missing)"
plain "the warning" "Allan variance at m samples is low by about"
holds "linear in JSON" '"method": "linear"' linear.json
bad "resampled without stamps" 2 "needs time stamps" inspect counter.txt --resample nearest
bad "a wrong way to resample" 1 "cubic" inspect jittered.csv --resample cubic
