#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Nothing that the C functions can reach keeps a text's length in static memory:   ci/statics.sh [DIRECTORY]
#
# gfortran (12 at least) keeps the length of a function result of deferred length (`character(:), allocatable`) in a static
# variable slen.N at every call of the function: two threads there at once write beyond their texts. From the objects of src/gyroakf/c_api of
# the newest build below DIRECTORY (build) the symbols that an object needs are followed to the objects that have them. Where a
# static shows up, a function of deferred length is called: make it a subroutine with an intent(out) text, or give its result an
# explicit length. Nor is lgamma called (by the intrinsic log_gamma), which writes a variable of the whole program.
set -u
cd "$(dirname "$0")/.." || exit 1
newest=$(find "${1:-build}" -name 'src_gyroakf_c_api_c_support.f90.o' -printf '%T@ %h\n' 2>/dev/null | sort -n | tail -n 1)
[ -n "$newest" ] || { echo "no objects of the library: build it first"; exit 1; }
directory=${newest#* }
echo "objects of $directory"
nm -A "$directory"/src_gyroakf*.o 2>/dev/null | awk '
  { split($0, part, ":"); file = part[1]; symbol = $NF; type = $(NF - 1)
    if (type == "U") needs[file] = needs[file] " " symbol
    else if (type ~ /[A-Z]/) home[symbol] = file
    if (symbol ~ /^slen/) texts[file]++
    if (file ~ /src_gyroakf_c_api_/ && !(file in seen)) { seen[file] = "C"; queue[++last] = file } }
  END {
    for (next_one = 1; next_one <= last; next_one++) {
      file = queue[next_one]
      count = split(needs[file], name, " ")
      for (i = 1; i <= count; i++) {
        other = home[name[i]]
        if (other != "" && !(other in seen)) { seen[other] = file; queue[++last] = other }
      }
    }
    if (last < 50) { print "only " last " objects are reached: the search is broken"; exit 1 }
    for (i = 1; i <= last; i++) {
      if ((needs[queue[i]] " ") ~ / lgamma /) { bad++; print queue[i] ": calls lgamma, which writes signgam of the program" }
      if (!(queue[i] in texts)) continue
      bad++
      printf "%s: %d lengths of texts in static memory; needed by %s\n", queue[i], texts[queue[i]], seen[queue[i]]
    }
    printf "%d passed, %d failed\n", last - bad, bad
    exit bad > 0
  }'
