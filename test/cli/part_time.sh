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
bad "a decimal comma alone" 2 "or say --decimal-comma" inspect single.txt
sed -i '/^0,[1-9]/d' single.txt
good "a decimal comma, forced" inspect single.txt --decimal-comma --json -
holds "one channel" '"channels": ["column1"]' out
sed 's/2026-05-\(..\)/05\/\1\/2026/' dates.csv >american.csv
bad "a date that may be either" 2 "may have the day or the month first" inspect american.csv
tail -n +2 american.csv >unnamed.csv
good "such a column left out" inspect unnamed.csv --column 3 --time-column none
