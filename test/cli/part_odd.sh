# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# Odd files of every kind: what is wrong, where, and what to do; exit code 2, nothing on standard output.

# name ; text of the message ; content
while IFS= read -r line; do
   # shellcheck disable=SC2059
   printf "${line##* ; }" >odd.txt
   name=${line%% ; *}
   message=${line#* ; }
   bad "odd: $name" 2 "${message% ; *}" inspect odd.txt
done <<'LINES'
empty ; odd.txt:1:1: the file is empty ; %s
only a header ; odd.txt:1:1: the file holds no line of numbers ; time,gx,gy\n
only comments ; odd.txt:2:1: the file holds no line of numbers ; # a\n# b\n
only blank lines ; odd.txt:3:1: the file holds no line of numbers ; \n  \n\n
UTF-16 ; odd.txt:1:1: the content is not text but text in UTF-16 ; \377\3761\0 \0002\0\n\0
UTF-16, big endian ; odd.txt:1:1: the content is not text but text in UTF-16 ; \376\377\0001\0\n
UTF-16, no mark ; text in UTF-16 without a byte-order mark ; 1\0.\0005\0\n\0002\0.\0005\0\n\0003\0.\0005\0\n\0
NUL bytes ; odd.txt:2:1: the content is not text but text with 1 NUL byte ; 1 2 3 4 5 6 7 8\n5\0 6 7 8 9 10 11 12\n1 2 3 4 5 6 7 8\n
another number of columns ; odd.txt:3:5: 3 columns where the rows above have 2 ; 1 2\n3 4\n5 6 7\n
a column less ; odd.txt:2:2: 1 column where the rows above have 2 ; 1 2\n3\n
lone carriage return ; a carriage return stands within the line ; 1 2\r\n3 4\r5 6\n
open quote ; odd.txt:1:1: a quote that is not closed ; "1.5\n2\n
grouped digits ; commas that group digits are not read ; "1,234.5"\n"2,345.5"\n
minus sign ; odd.txt:1:1: '−1.5' is not a number ; \342\210\2221.5\n2\n
too large ; odd.txt:2:1: the number '1e400' is too large ; 1\n1e400\n
a word among numbers ; odd.txt:3:3: 'x' is not a number ; 1 2\n3 4\n5 x\n
a page of the web ; odd.txt:1:1: the file holds no line of numbers ; <html><body>404 Not Found</body></html>\n
JSON ; odd.txt:1:1: an array of 5 values in one row ; {"gx": [1, 2, 3, 4, 5]}\n
LINES

# as many samples as expected, whatever the lines look like: name ; samples ; content
while IFS= read -r line; do
   # shellcheck disable=SC2059
   printf "${line##* ; }" >odd.txt
   name=${line%% ; *}
   samples=${line#* ; }
   good "odd: $name" inspect odd.txt --json -
   holds "odd: $name" "\"samples\": ${samples% ; *}," out
done <<'LINES'
byte-order mark ; 3 ; \357\273\2771 2\n3 4\n5 6\n
carriage returns only ; 3 ; 1 2\r3 4\r5 6
no final newline ; 3 ; 1 2\n3 4\n5 6
one row ; 1 ; 1 2\n
separators at the ends ; 3 ; 1,2,\n3,4,\n5,6,\n
quoted numbers ; 3 ; "1.5","2"\n"3","4"\n"5","6"\n
units in the header ; 2 ; gx (deg/s),gy (deg/s)\n1,2\n3,4\n
Latin-1 ; 3 ; # 25\260C\ngx [\260/s]\n1\n2\n3\n
infinite values are missing ; 3 ; 1\ninf\n3\n
denormal values ; 4 ; 1e-310\n4.9e-324\n1e-400\n2\n
LINES

# files that are none
mkdir odd_dir
bad "odd: a directory" 2 "odd_dir: is a directory" inspect odd_dir
ln -s nowhere odd_link
bad "odd: a link to nothing" 2 "odd_link: no such file" inspect odd_link
bad "odd: nothing at all" 2 "/dev/null:1:1: the file is empty" inspect /dev/null
bad "odd: endless zeros" 2 "/dev/zero:1:1: the content is not text but binary" inspect /dev/zero
mkfifo odd_fifo
{ sleep 0.2; printf '1\n2'; sleep 0.2; printf '3\n4\n'; } >odd_fifo &
good "odd: a pipe in pieces" inspect odd_fifo --json -
holds "odd: a pipe in pieces" '"samples": 3,' out
wait
if [ "$(id -u)" -ne 0 ]; then # root may read everything
   echo 1 >odd_locked
   chmod 0 odd_locked
   bad "odd: no permission" 2 "odd_locked: cannot be opened" inspect odd_locked
   chmod 600 odd_locked
fi

# long lines, many lines, many columns
{ printf '1 2\n3'; head -c 15000000 /dev/zero | tr '\0' ' '; printf '4\n5 6\n'; } >odd.txt
good "odd: a line of 15 MB" inspect odd.txt --json -
holds "odd: a line of 15 MB" '"samples": 3,' out
{ printf '1\n2\n'; head -c 1000000 /dev/zero | tr '\0' '\n'; printf '3\nx\n'; } >odd.txt
bad "odd: a million blank lines" 2 "odd.txt:1000004:1: 'x' is not a number" inspect odd.txt
awk 'BEGIN { for (i = 0; i < 3; i++) { for (j = 1; j < 10000; j++) printf "%d,", j; print i } }' >odd.txt
good "odd: 10,000 columns" inspect odd.txt --column 10000 --json -
holds "odd: 10,000 columns" '"samples": 3,' out
head -c 2000000 /dev/zero | sed 's/\x00/1 /g' >odd.txt
bad "odd: no line ends" 2 "odd.txt:1:131073: 2000000 columns, there may be 65536" inspect odd.txt
rm -f odd.txt

# a line without end is refused before it fills the memory
head -c 20000000 /dev/zero | tr '\0' 5 >endless.txt
gzip -c endless.txt >endless.txt.gz
for file in endless.txt endless.txt.gz; do
   bad "$file" 2 "$file:1:1: a line of more than 16 MB" inspect $file
done
{ seq 1 1000; cat endless.txt; } >late.txt
bad "a line without end behind others" 2 "late.txt:1001:1: a line of more than 16 MB" inspect late.txt
tr '\0' 5 </dev/zero 2>/dev/null | timeout 60 "$gyroakf" inspect - >out 2>err
is "a source without line ends" $? 2
holds "is named" "<stdin>:1:1: a line of more than 16 MB" err
