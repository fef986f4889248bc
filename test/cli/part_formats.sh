# shellcheck shell=bash
# shellcheck disable=SC2059  # formats of printf are made of bytes
# SPDX-License-Identifier: MIT
# The same numbers as text, as raw numbers and as NumPy arrays, by name, by pipe, in parts; other files are named.

# counts FORMAT: 400 rows of two whole numbers as escapes for printf: le, be (rows together), columns (column after column, le)
counts() {
   awk -v way="$1" 'function bytes(v) { if (v < 0) v += 65536
         return way == "be" ? sprintf("\\%03o\\%03o", int(v/256), v%256) : sprintf("\\%03o\\%03o", v%256, int(v/256)) }
      { v[1] = $1; v[2] = $2
        if (way == "columns") { a = a bytes(v[1]); b = b bytes(v[2]) } else printf "%s%s", bytes(v[1]), bytes(v[2]) }
      END { printf "%s%s", a, b }' whole.txt
}
seq 1 400 | awk '{ printf "%d %d\n", 3000*sin($1*$1), 2000*cos(3*$1*$1) - $1 }' >whole.txt
printf "$(counts le)" >whole.i16
printf "$(counts be)" >whole.bin
# numpy NAME DESCR ORDER SHAPE: the head of an array file
numpy() {
   local head="{'descr': '$1', 'fortran_order': $2, 'shape': $3, }"
   printf "\\223NUMPY\\001\\000\\$(printf '%03o' $((${#head} + 1)))\\000%s\\n" "$head"
}
{ numpy '<i2' False '(400, 2)'; printf "$(counts le)"; } >rows.npy
{ numpy '>i2' False '(400, 2)'; printf "$(counts be)"; } >big.npy
{ numpy '<i2' True '(400, 2)'; printf "$(counts columns)"; } >columns.npy
{ numpy '<i2' False '(2, 400)'; printf "$(counts columns)"; } >turned.npy

what() { no_command_line | grep -vE '"(path|format|stored_type|warnings)"'; }
# alike_whole NAME ARGUMENTS...: the JSON document is that of whole.txt
alike_whole() {
   local name=$1; shift
   run run "$@" --rate 50 --unit deg/s --json -
   if [ $code -eq 0 ] && cmp -s <(what <out) whole.json; then pass
   else fail "$name: $(diff <(what <out) whole.json | head -n 4) $(head -c 200 err)"; fi
}
good "whole numbers as text" run whole.txt --rate 50 --unit deg/s --json -
what <out >whole.json
alike_whole "raw numbers by name" whole.i16 --channels 2
holds "which is said" "read as i16le, 2 columns, as the name .i16 says" out
holds "as format" '"format": "i16le"' out
alike_whole "raw big endian numbers" whole.bin --format i16be --channels 2
{ printf 'header\0'; cat whole.bin; } >headed.bin
alike_whole "behind a header" headed.bin --format i16be --channels 2 --skip 7
alike_whole "NumPy array" rows.npy
holds "with its type" '"stored_type": "int16"' out
alike_whole "big endian" big.npy
alike_whole "column after column" columns.npy
alike_whole "the longer side is the time" turned.npy
holds "which is said" "the array's shape is (2, 400)" out
cp rows.npy named.txt
alike_whole "an array under another name" named.txt
for file in rows columns turned; do
   { head -c 300 $file.npy; sleep 0.2; tail -c +301 $file.npy; } |
      "$gyroakf" run - --rate 50 --unit deg/s --json - >out 2>err
   if cmp -s <(what <out) whole.json; then pass; else fail "$file.npy through a pipe: $(head -c 200 err)"; fi
done
tail -c +8 headed.bin | "$gyroakf" run - --format i16be --channels 2 --rate 50 --unit deg/s --json - >out 2>err
if cmp -s <(what <out) whole.json; then pass; else fail "raw numbers through a pipe: $(head -c 200 err)"; fi
cat headed.bin | "$gyroakf" run - --format i16be --channels 2 --skip 7 --rate 50 --unit deg/s --json - >out 2>err
if cmp -s <(what <out) whole.json; then pass; else fail "raw numbers behind a header through a pipe: $(head -c 200 err)"; fi
good "inspect" inspect rows.npy
holds "tells format and type" "rows.npy (npy, int16)" out
good "a column of text" run whole.txt --column 2 --rate 50 --json -
what <out >second.json
for file in rows.npy columns.npy "whole.bin --format i16be --channels 2"; do
   # shellcheck disable=SC2086
   good "a column of $file" run $file --column 2 --rate 50 --json -
   if cmp -s <(what <out) second.json; then pass; else fail "a column of $file differs"; fi
done
good "a bounded memory" allan rows.npy --memory 40MB --json -

# text under a binary name
cp whole.txt text.npy
good "text named .npy" inspect text.npy
holds "is said" "the name ends in .npy, but the content is text" out
cp whole.txt text.f64
good "text named .f64" inspect text.f64
bad "text is no array" 2 "the content is not npy but text" inspect whole.txt --format npy
bad "an array is no text" 2 "the content is not text but a NumPy file" inspect rows.npy --format text
bad "numbers are no text" 2 "the content is not text but binary" inspect whole.bin --format text

# lengths that do not fit
head -c -1 whole.i16 >odd.i16
bad "half a number" 2 "odd.i16: byte 1596: 3 bytes are left after 399 rows of 4 bytes (2 x int16)" inspect odd.i16 --channels 2
cat odd.i16 | "$gyroakf" inspect - --format i16 --channels 2 >out 2>err
holds "half a number through a pipe" "byte 1596: 3 bytes are left after 399 rows of 4 bytes" err
head -c -3 rows.npy >short.npy
bad "an array cut off" 2 "the file ends here" inspect short.npy
cat short.npy | "$gyroakf" inspect - >out 2>err
is "an array cut off in a pipe" $? 2
{ cat rows.npy; echo; } >long.npy
bad "bytes behind an array" 2 "1 bytes follow" inspect long.npy
cat long.npy | "$gyroakf" inspect - >out 2>err
holds "bytes behind an array in a pipe" "bytes follow the array of 400 rows" err
: >empty.f64
bad "no numbers at all" 2 "empty" inspect empty.f64 --format f64
bad "nothing behind the header" 2 "--skip leaves nothing" inspect whole.i16 --skip 1600

# options that do not apply
bad "channels of text" 2 "--channels is for raw numbers, and this is text" inspect whole.txt --channels 2
bad "channels of an array" 2 "--channels is for raw numbers, and this is npy" inspect rows.npy --channels 2
bad "lines of an array" 2 "--skip is for text (lines) and raw numbers (bytes)" inspect rows.npy --skip 1
bad "columns of an array have no names" 2 "give numbers" inspect rows.npy --column gx

# files of other programs are named, with what to do
while read -r bytes fragment; do
   printf "$bytes" >other
   bad "$fragment" 2 "$fragment" inspect other
done <<'CASES'
\050\265\057\375xx zstd -dc other | gyroakf run -
\375\067\172\130\132\000 xz -dc other | gyroakf run -
BZh91AY bzip2 -dc other | gyroakf run -
PK\003\004\024\000 unzip -p other NAME-IN-IT | gyroakf run -
PK\003\004\024\000 pandas.read_excel('other').to_csv('x.csv', index=False)
\211PNG\r\n\032\n a picture (PNG)
\377\330\377\340 a picture (JPEG)
\377\376\061\000\012\000 iconv -f UTF-16 -t UTF-8 other | gyroakf run -
1\0002\0003\000\012\0004\000 iconv -f UTF-16LE -t UTF-8 other | gyroakf run -
\0001\0002\0003\000\012\0004 iconv -f UTF-16BE -t UTF-8 other | gyroakf run -
1.5\0122.5\0123.5\012\000\000\000\000 text with 4 NUL bytes
MATLAB\0405.0\040MAT-file numpy.save('x.npy', s.loadmat('other')['NAME'])
\211HDF\015\012\032\012 an HDF5 file
PAR1\025\004 python3 -m gyroakf run other (the Python package of gyroakf, with its extra parquet)
ARROW1\000\000 pandas.read_feather('other').to_csv('x.csv', index=False)
#ROSBAG\040V2.0\012 python3 -m gyroakf run other (the Python package of gyroakf, with its extra ros)
SQLite\040format\0403\000 python3 -m gyroakf run other
\211MCAP0\015\012 python3 -m gyroakf run other
\265b\001\007\134\000 a log of a u-blox receiver
ULog\001\0225\001 python3 -m gyroakf run other (the Python package of gyroakf, with its extra ulog)
\243\225\200\200Y python3 -m gyroakf run other (the Python package of gyroakf, with its extra dataflash)
\000\001\002\003\004\005 --format f64, f32, i16
CASES

# compressed by gzip: every format, by name, through standard input and a FIFO
for file in whole.txt rows.npy columns.npy "whole.i16 --channels 2" "whole.bin --format i16be --channels 2" \
   "headed.bin --format i16be --channels 2 --skip 7"; do
   name=${file%% *}
   gzip -c "$name" >"$name.gz"
   # shellcheck disable=SC2086
   alike_whole "$name.gz" ${file/$name/$name.gz}
done
holds "its own name" '"path": "headed.bin.gz"' out
{ head -c 1000 whole.txt | gzip; tail -c +1001 whole.txt | gzip; } >members.gz
alike_whole "two members" members.gz
for file in whole.txt.gz rows.npy.gz; do
   "$gyroakf" run - --rate 50 --unit deg/s --json - <$file >out 2>err
   if cmp -s <(what <out) whole.json; then pass; else fail "$file as standard input: $(head -c 200 err)"; fi
done
mkfifo whole.fifo
{ head -c 2 whole.txt.gz; sleep 0.2; tail -c +3 whole.txt.gz; } >whole.fifo &
alike_whole "gzip through a FIFO" whole.fifo
good "a long text" simulate --samples 300000 --rate 50 --coefficients N=0.005 --output long.txt
gzip -c long.txt >long.txt.gz
good "uncompressed" allan long.txt --json -
what <out >long.json
good "compressed" allan long.txt.gz --json -
if cmp -s <(what <out) long.json; then pass; else fail "a long text compressed differs: $(diff <(what <out) long.json | head -n 4)"; fi
bad "too large for the memory" 2 "long.txt.gz: more than" allan long.txt.gz --memory 28MB
for file in long.txt rows.npy; do
   head -c -9 $file.gz >cut.gz
   bad "$file.gz cut off" 2 "cut.gz: the compressed data end early after" inspect cut.gz
done
head -c -4 whole.bin.gz >cut.gz
bad "raw numbers cut off" 2 "cut.gz: the compressed data end early after 1600 decompressed bytes" \
   inspect cut.gz --format i16be --channels 2
{ cat whole.txt.gz; echo 1 2; } >behind.gz
bad "bytes behind compressed data" 2 "behind.gz: the compressed data are damaged after" inspect behind.gz
{ printf 'MATLAB 7.3 MAT-file%493s' ''; printf '\211HDF\015\012\032\012\000\000\000\000'; } >x.mat
bad "a MATLAB file of level 7.3" 2 "numpy.save('x.npy', h5py.File('x.mat')['NAME'][()])" inspect x.mat
holds "names of its datasets" "h5py.File('x.mat').visit(print)" err
"$gyroakf" inspect - <x.mat >out 2>err
holds "HDF5 through a pipe" "h5py.File('FILE')" err
gzip x.mat
bad "a MATLAB file in gzip" 2 "decompress it first (gzip -dk), then: python3 -c" inspect x.mat.gz
holds "by the name that it gets" "h5py.File('x.mat')" err
