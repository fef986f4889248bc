#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Writes the seeds of the fuzz harness, odd files of every kind:   ci/fuzz/seeds.sh FOLDER
set -eu
mkdir -p "$1"
cd "$1"

# seed NAME CONTENT [OPTIONS]: the content with escapes, behind the bytes that choose the options (reader.c)
seed() { printf '%b%b' "${3-\\0\\0\\0\\0}" "$2" >"$1"; }
repeat() { local i; for ((i = 0; i < $1; i++)); do printf '%b' "$2"; done; }

# --- separators, line ends, comments
seed one '1.5\n'
seed no-final-newline '1 2\n3 4'
seed commas '1,2\n3,4\n5,6\n'
seed semicolons '1;2;3\n4;5;6\n'
seed tabs '1\t2\t3\n4\t\t6\n'
seed trailing '1,2,\n3,4,\n'
seed decimal-comma '1,5;2,3\n1,6;2,4\n'
seed thousands '"1,234.5";2\n"2,345.5";3\n'
seed quotes '"1.5","2"\n'"'3','4'"'\n'
seed open-quote '"1.5\n2\n'
seed crlf '1 2\r\n3 4\r\n'
seed cr '1 2\r3 4\r5 6'
seed mixed-ends '1 2\r\n3 4\n5 6\r7 8\n'
seed blank-lines '\n\n1\n\n\n2\n\n'
seed comments '# a\n% b\n// c\n; d\n1 2 # e\n3 4\n'
seed only-comments '# a\n# b\n'
seed only-header 'time,gx,gy\n'
seed sep 'sep=;\n1;2\n3;4\n'
seed bom '\xef\xbb\xbf1 2\n3 4\n'
seed spaces '   1    2   \n 3 4\n'
seed columns-change '1 2\n3 4 5\n6\n'
seed missing '1 nan\nNA 2\n- 3\n, 4\n'
seed bad-lines '1 2\nx y\n3\n4 5 6\n7 8\n' '\0\4\0\0'
seed skipped 'garbage\n1 2\n3 4\n' '\0\2\0\0'
seed nul '1 2\n\0003 4\n'
seed control '1 2\n\0333 4\n\x7f\n'
seed latin1 'Zeit,\xb0/s,\xb5\n1,2,3\n4,5,6\n'
seed minus '\xe2\x88\x921.5\n2\n'
seed utf8 'Zeit [µs],ω [°/s],ω̇\n0,1,2\n10,2,3\n'

# --- numbers
seed numbers '1e5 -1E-5 +.5 5. 1d3 1D-3 0x10 1_000\n'
seed extremes '1.7976931348623157e308\n4.9e-324\n2.2250738585072011e-308\n-0\n0e999\n'
seed overflow '1e400\n1e-400\n'
seed long-digits '0.1234567890123456789012345678901234567890e+0000000000000001\n123456789012345678901234567890\n'
seed half-way '9007199254740993\n9007199254740992.5\n1.00000000000000011102230246251565404236316680908203125\n'
seed savetxt '1.000000000000000055e-01 2.000000000000000111e+00\n-3.141592653589793116e+00 4.000000000000000000e+00\n'
seed infinities 'inf -Infinity\nINF nan\n1 2\n'
seed words '1.5abc 2\n--5 1\n1e 2\n1e+ 2\n. 3\n'

# --- headers, units, time
seed header '# rate_hz: 100\n# unit: deg/s\n# columns: gx, gy\n1 2\n3 4\n'
seed header-dt '% dt = 10 ms\n% units: rad/s, m/s^2\n1 2\n3 4\n'
seed header-bad '# rate_hz: -5\n# rate_hz: abc\n# dt: 0\n# unit: furlong\n# units: deg/s\n1 2\n'
seed names-in-comment '# time gx gy\n0 1 2\n0.1 2 3\n0.2 3 4\n'
seed units-below 'time,gx\ns,deg/s\n0,1\n1,2\n'
seed time 'time_s,gx [deg/s],ax (m/s^2)\n0.0,1,2\n0.1,2,3\n0.2,3,4\n0.3,4,5\n'
seed time-gap 't,g\n0,1\n1,2\n2,3\n3,4\n4,5\n5,6\n9,7\n10,8\n11,9\n12,1\n13,2\n14,3\n'
seed time-back 't,g\n0,1\n1,2\n1,3\n0,4\n1,5\n2,6\n3,7\n-100,8\n1e20,9\n1e21,1\n'
seed time-missing 'time,g\nnan,1\n1,2\n,3\n3,4\nnan,5\n'
seed time-ms 'time_ms;x\n0;1\n10;2\n20;3\n30;4\n'
seed time-ns 'timestamp,x\n1500000000000000000,1\n1500000000010000000,2\n1500000000020000000,3\n'
seed time-huge 'time,x\n1e30,1\n-1e30,2\n1e31,3\n1e-300,4\n'
seed rising '1 5\n2 6\n3 7\n4 8\n'
seed burst "t,g\n$(repeat 8 '0.1,1\n0.1,2\n0.1,3\n0.4,1\n0.4,2\n0.4,3\n')"
seed dates 'time,x\n2024-01-01T00:00:00Z,1\n2024-01-01T00:00:00.100Z,2\n2024-01-01T00:00:00.200Z,3\n'
seed dates-zone 'time,x\n2024-02-29 23:59:59.9+02:00,1\n2024-03-01 00:00:00.0+02:00,2\n'
seed date-time 'date,time,x\n2024-01-01,12:00:00,1\n2024-01-01,12:00:01,2\n2024-01-01,12:00:02,3\n'
seed time-of-day 'time,x\n23:59:58,1\n23:59:59,2\n00:00:00,3\n'
seed us-date 'time,x\n12/31/2023 11:59:59 PM,1\n01/01/2024 12:00:00 AM,2\n'

# --- options
seed angle '0\n1\n3\n6\n' '\xc0\x10\0\0'
seed increment '0.1\n0.2\nnan\n0.3\n' '\x80\x30\0\0'
seed part '1\n2\n3\n4\n5\n6\n7\n8\n9\n' '\0\x10\x0c\0'
seed by-number 'a,b\n1,2\n3,4\n' '\x06\0\0\0'
seed by-name 'time,gx,gy\n0,1,2\n1,3,4\n' '\x3f\0\0\0'
seed wrap '32766\n32767\n-32768\n-32767\n' '\xc0\x10\0\0'
seed wrap-360 '358\n359\n0.5\n1\n' '\xc0\x10\0\x0c'

# --- what is no text
seed gzip '\x1f\x8b\x08\0\0\0\0\0\x02\x033T0\xe22V0\xe1\x02\0W\0\xd6a\x08\0\0\0'
seed utf16le '\xff\xfe1\0 \0002\0\n\0'
seed utf16be '\xfe\xff\0001\0\n'
seed utf16-bare '1\0 \0002\0\n\0003\0 \0004\0\n\0'
seed utf32 '\xff\xfe\0\0001\0\0\0\n\0\0\0'
seed zip 'PK\x03\x04\x14\0\0\0'
seed hdf5 '\x89HDF\r\n\x1a\n\0\0\0'
seed zstd '\x28\xb5\x2f\xfd\x04\0'
seed matlab 'MATLAB 5.0 MAT-file, Platform: GLNXA64\0\1IM'
seed binary "$(repeat 8 '\\0\\0\\0\\0\\0\\0\\xf0?')"

# npy DESCRIPTION SHAPE ORDER DATA [VERSION]: a NumPy file whose header is as long as it has to be
npy() {
  local head="{'descr': '$1', 'fortran_order': $3, 'shape': ($2), }" version=${5-1} length pad
  pad=$((64 - (${#head} + (version > 1 ? 13 : 11)) % 64))
  head+=$(printf '%*s' "$pad" '')
  length=$((${#head} + 1))
  printf -v length '\\x%02x\\x%02x' $((length % 256)) $((length / 256))
  printf '%s' "\\x93NUMPY\\x0$version\\0$length"
  if [ "$version" -gt 1 ]; then printf '%s' '\0\0'; fi
  printf '%s\\n%s' "$head" "$4"
}
doubles=$(repeat 6 '\\0\\0\\0\\0\\0\\0\\xf0?')
seed npy-f8 "$(npy '<f8' '6,' False "$doubles")"
seed npy-f8-rows "$(npy '<f8' '3, 2' False "$doubles")"
seed npy-f8-columns "$(npy '<f8' '3, 2' True "$doubles" 2)"
seed npy-f4 "$(npy '>f4' '4,' False "$(repeat 4 '?\\x80\\0\\0')")"
seed npy-f2 "$(npy '<f2' '3,' False '\0<\0@\0B' 3)"
seed npy-i2 "$(npy '<i2' '2, 2' False '\1\0\2\0\3\0\4\0')"
seed npy-u8 "$(npy '>u8' '2,' False '\0\0\0\0\0\0\0\1\xff\xff\xff\xff\xff\xff\xff\xff')"
seed npy-bool "$(npy '|b1' '3,' False '\0\1\1')"
seed npy-object "$(npy '|O' '1,' False '\0')"
seed npy-short "$(npy '<f8' '1000000000,' False "$doubles")"
seed npy-overflow "$(npy '<f8' '9223372036854775807, 9223372036854775807' False "$doubles")"
seed npy-empty "$(npy '<f8' '0,' False '')"
seed npy-scalar "$(npy '<f8' '' False '\0\0\0\0\0\0\xf0?')"
seed npy-three "$(npy '<f8' '1, 2, 3' False "$doubles")"
seed npy-record "$(npy "[('t', '<f8'), ('x', '<f4')]" '1,' False '\0\0\0\0\0\0\xf0?\0\0\x80?')"
seed npy-cut '\x93NUMPY\1\0\x76'
seed npy-header '\x93NUMPY\1\0\xff\xff{'
seed raw-f8 "$doubles" '\0\0\x10\0'
seed raw-f8-rows "$doubles" '\0\0\x10\x40'
seed raw-i2 '\1\0\2\0\3\0\4\0\5' '\0\0\x30\0'
seed raw-skip '#1\0\2\0\3\0\4\0' '\0\2\x30\0'
seed nearest 'time,x\n0,1\n1,2\n2.1,3\n4,4\n5,5\n' '\0\0\0\2'
seed linear 'time,x\n0,1\n1,2\n2.1,3\n4,4\n5,5\n' '\0\0\0\3'
seed names-none "'|\\n1\\n2\\n" '\0\0\0\0'
seed commas-decimal '1,5 2,5\n3,25 4\n' '\0\0\0\x10'
