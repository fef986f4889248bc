# SPDX-License-Identifier: MIT
# Compares two JSON documents of gyroakf number by number:
#
#   awk -v tolerance=1e-10 -f ci/compare_json.awk -- results1.json results2.json
#
# Both must have the same lines but for their numbers. Prints every pair that is farther apart than the tolerance, relative to
# the larger one, with its path, and as the last line how many numbers there are and the largest difference. Exit code 1 where
# anything differs by more. `-v loose='REGEX TOLERANCE REGEX TOLERANCE'` gives paths other tolerances, the first that matches
# counts; numbers of the paths that match `-v rounded=REGEX` that are below 1e-15 count as 0; of those that match `-v logarithms=REGEX`
# the difference itself counts where they are below 1: it is the relative difference of what they are logarithms of.

function fail(text) { print text; failed = 1; exit 1 }

# the path of the member in a line, by its indentation
function note_path(line,    depth, key) {
   depth = match(line, /[^ ]/)
   if (depth <= 1) return
   if (match(line, /"[^"]*":/)) key = substr(line, RSTART + 1, RLENGTH - 3)
   else key = (line ~ /^ *[\]}]/) ? "" : ++element[depth]
   for (d in name) if (d + 0 >= depth) delete name[d]
   for (d in element) if (d + 0 > depth) delete element[d]
   name[depth] = key
   path = ""
   for (d = 1; d <= depth; d++) if (d in name) path = path "/" name[d]
}

# a line without texts, its numbers replaced by #; the numbers into list
function parse(line, list,    n, rest, token) {
   n = 0
   shape = ""
   rest = line
   while (match(rest, /"([^"\\]|\\.)*"|-?[0-9][0-9.eE+-]*/)) {
      token = substr(rest, RSTART, RLENGTH)
      shape = shape substr(rest, 1, RSTART - 1)
      if (token ~ /^"/) shape = shape token
      else { shape = shape "#"; list[++n] = token }
      rest = substr(rest, RSTART + RLENGTH)
   }
   shape = shape rest
   return n
}

function size(x) { x += 0; return x < 0 ? -x : x }

BEGIN {
   if (tolerance == "") tolerance = 0
   tolerance += 0
   groups = split(loose, group, " ")
   for (k = 2; k <= groups; k += 2) group[k] += 0
   while ((more = (getline one < ARGV[1])) > 0) {
      if ((getline two < ARGV[2]) <= 0) fail(ARGV[2] ": ends before " ARGV[1])
      note_path(one)
      n = parse(one, a); first = shape
      m = parse(two, b)
      if (first != shape || n != m) { print path ": " one " | " two; failed = 1; continue }
      for (i = 1; i <= n; i++) {
         count++
         if (a[i] == b[i]) continue
         if (rounded != "" && path ~ rounded && size(a[i]) < 1e-15 && size(b[i]) < 1e-15) continue
         larger = size(a[i]) > size(b[i]) ? size(a[i]) : size(b[i])
         if (logarithms != "" && larger < 1 && path ~ logarithms) larger = 1
         difference = larger > 0 ? size(a[i] - b[i])/larger : 0
         for (k = 1; k < groups; k += 2) if (path ~ group[k]) break
         if (k < groups) {
            if (difference > loosest) loosest = difference
            allowed = group[k + 1]
         } else {
            if (difference > worst) { worst = difference; worst_path = path }
            allowed = tolerance
         }
         if (difference > allowed) { printf "%s: %s and %s, %.1e apart\n", path, a[i], b[i], difference; failed = 1 }
      }
   }
   if (more < 0) fail(ARGV[1] ": cannot be read")
   if ((getline two < ARGV[2]) > 0) fail(ARGV[1] ": ends before " ARGV[2])
   printf "%d numbers, the largest difference is %.1e%s%s\n", count, worst, (worst_path == "" ? "" : " (" worst_path ")"), \
      (loose == "" ? "" : sprintf(", of the loose ones %.1e", loosest))
   exit failed + 0
}
