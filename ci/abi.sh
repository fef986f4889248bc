#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The binary interface for C: what the compilers see of it against c_api/abi.txt (the rules are in doc/abi.md).
#
#   ci/abi.sh                          header against list; header against Fortran, where there are compiled modules
#   ci/abi.sh --write [--break]        writes the list anew; --break: even where something vanishes from it or changes
#   ci/abi.sh --symbols LIBRARY        what a library (.so, .a) exports against header and FORTRAN 77 sources
#   ci/abi.sh --fortran DIRECTORY      the header against the bind(C) procedures; compiled modules are in the directory
#
# The last line is "N passed, N failed".
set -u
shopt -s lastpipe
export LC_ALL=C
cd "$(dirname "$0")/.." || exit 1
header=c_api/include/gyroakf.h
list=c_api/abi.txt
passed=0
failed=0
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT

# rule NAME: fails if there is anything on standard input, and shows it
rule() {
  local found
  found=$(cat)
  if [ -z "$found" ]; then passed=$((passed + 1)); return; fi
  failed=$((failed + 1))
  printf 'FAILED: %s:\n%s\n' "$1" "$found" | head -n 60
}

finish() {
  echo "$passed passed, $failed failed"
  [ "$failed" -eq 0 ]
  exit
}

prototypes() { # of the header, one a line, as the compiler sees them: "int gyroakf_version (void)"
  gcc -std=c99 -aux-info "$work/aux" -fsyntax-only -x c "$header" || exit 1
  sed -nE 's/^\/\* [^ ]*gyroakf\.h:[^ ]* \*\/ (extern )?(.*);.*/\2/p' "$work/aux"
}

functions() { prototypes | sed -nE 's/.*[ *](gyroakf_[a-z0-9_]+) \(.*/\1/p'; }

fortran77() { # the entry points for FORTRAN 77: external procedures, which gfortran gives a trailing underscore
  cat src/gyroakf/c_api/legacy*.f90 2>/dev/null |
    sed -nE 's/^ *subroutine +([a-z0-9]{1,6}) *\(.*/\1/p; s/.*bind *\(C, *name *= *"([a-z0-9]{1,6}_)".*/\1/p' | sed 's/_*$/_/'
}

# members PREFIX: of every structure on standard input (preprocessed C) a line "STRUCTURE MEMBER", for names with the prefix;
# of one without members none
members() {
  tr '\n' ' ' | sed 's/typedef struct/\n&/g; s/} *[a-z0-9_]* *;/&\n/g' |
    sed -nE "s/^typedef struct [a-z0-9_]* *\{(.*)\} *($1[a-z0-9_]*) *;.*/\2 \1/p" |
    awk '{
      name = $1; sub(/^[^ ]+ /, "")
      n = split($0, declaration, ";")
      for (i = 1; i <= n; i++) {
        d = declaration[i]; gsub(/\/\*[^*]*\*\//, "", d)
        if (d !~ /[^ ]/) continue
        if (d ~ /\( *\*/) { sub(/^[^(]*\( *\* */, "", d); sub(/[^a-zA-Z0-9_].*/, "", d); print name, d; continue }
        m = split(d, declarator, ",")
        for (j = 1; j <= m; j++) {
          e = declarator[j]; sub(/\[.*/, "", e); sub(/ +$/, "", e); sub(/.*[ *]/, "", e); print name, e
        }
      }
    }'
}

# layout PREAMBLE MEMBERS: compiles and runs what prints offset, size and kind (i: integer, r: real, p: all else) of the members
layout() {
  { echo '#include <stdio.h>'
    echo '#include <stddef.h>'
    cat "$1"
    echo '#define KIND(x) _Generic((x), double: "r", float: "r", signed char: "i", int: "i", long: "i", unsigned long: "i", default: "p")'
    echo '#define MEMBER(s, m) printf("member %s.%s at %zu, size %zu, %s\n", #s, #m, offsetof(s, m), sizeof(((s *)0)->m), KIND(((s *)0)->m))'
    echo '#define SIZE(s) printf("struct %s size %zu\n", #s, sizeof(s))'
    echo '#define CONSTANT(c) printf("constant %s %ld\n", #c, (long)(c))'
    echo 'int main(void) {'
    awk '$1 != last { print "SIZE(" $1 ");"; last = $1 } { print "MEMBER(" $1 ", " $2 ");" }' "$2"
    cat
    echo 'return 0; }'
  } >"$work/layout.c"
  gcc -std=c11 -Ic_api/include "$work/layout.c" -o "$work/layout" && "$work/layout"
}

describe() { # the list
  local major
  prototypes | sed 's/^/function /' | sort >"$work/functions"
  gcc -std=c99 -E -P "$header" >"$work/header.i" || exit 1
  members gyroakf_ <"$work/header.i" >"$work/members"
  echo '#include "gyroakf.h"' >"$work/preamble"
  major=$(sed -nE 's/^#define GYROAKF_VERSION_MAJOR +//p' "$header")
  tr '\n' ' ' <"$work/header.i" | sed -nE 's/.*enum gyroakf_status *\{([^}]*)\}.*/\1/p' | tr ',' '\n' |
    sed -nE 's/^ *(GYROAKF_[A-Z0-9_]+).*/CONSTANT(\1);/p' >"$work/constants"
  echo "# What programs rely on, x86-64 and every other machine with 64-bit long; ci/abi.sh --write writes it, doc/abi.md has the rules."
  echo "major $major"
  sort "$work/functions"
  fortran77 | sort -u | sed 's/^/fortran77 /'
  tr '\n' ' ' <"$work/header.i" | sed 's/;/;\n/g' | sed -nE 's/^ *(typedef [^{]*[ *](gyroakf_[a-z0-9_]+)[^{]*);$/\1/p' |
    sed -E 's/ +/ /g' | sort -u
  layout "$work/preamble" "$work/members" <"$work/constants" | sort -s -k 2,2
}

vanished() { # what the list has and the header has not, within one major version
  [ -f "$list" ] || return 0
  [ "$(grep '^major' "$list")" = "$(grep '^major' "$work/now")" ] || return 0
  grep -v '^#' "$list" | sort >"$work/then.sorted"
  sort "$work/now" | comm -23 "$work/then.sorted" -
}

check_fortran() { # DIRECTORY
  local modules=$1 file
  mkdir "$work/fortran"
  for file in src/gyroakf/c_api/*.f90; do
    case $file in */legacy*) continue ;; esac
    gfortran -fc-prototypes -fsyntax-only -w -I"$modules" -J"$work/fortran" "$file" >>"$work/prototypes" ||
      { echo "$file" | rule "gfortran tells the C prototypes"; return; }
  done
  # argument by argument: reals, integers of each size, addresses; and the returned value
  sign() {
    sed -E 's/const //g; s/[a-z_0-9]+ *\**\(\*[a-z_]*\) *\([^)]*\)/void */g' |
      awk '{
        line = $0; sub(/ *;? *$/, "", line)
        open = index(line, "("); head = substr(line, 1, open - 1); arguments = substr(line, open + 1)
        sub(/\) *$/, "", arguments); sub(/ +$/, "", head)
        name = head; sub(/.*[ *]/, "", name)
        returned = substr(head, 1, length(head) - length(name))
        out = name " " kind(returned) " ("
        n = split(arguments, a, ",")
        for (i = 1; i <= n; i++) out = out " " kind(a[i])
        print out " )"
      }
      function kind(t) {
        if (t ~ /\*/ || t ~ /gyroakf_/) return "address"
        if (t ~ /double/) return "real64"
        if (t ~ /float/) return "real32"
        if (t ~ /int8_t|char/) return "int8"
        if (t ~ /long|int64_t|size_t/) return "int64"
        if (t ~ /void/) return "void"
        if (t ~ /int/) return "int32"
        return t
      }' | sed 's/( void )/( )/' | sort -u
  }
  grep -E '^[a-z].* \**gyroakf_[a-z0-9_]+ \(.*\);' "$work/prototypes" | grep -v 'gyroakf_host_' >"$work/fortran.functions"
  sign <"$work/fortran.functions" >"$work/fortran.sign"
  prototypes >"$work/header.functions"
  sign <"$work/header.functions" >"$work/header.sign"
  diff "$work/header.sign" "$work/fortran.sign" | grep '^[<>]' | sed 's/^</gyroakf.h:/; s/^>/Fortran:  /' |
    rule "every C function has the arguments of its Fortran procedure"

  # structures: which Fortran type stands for which, by the arguments, or by the name
  { echo 'typedef struct'
    grep -vE '^(#|extern|}$)|^[a-z].*\(.*\);' "$work/prototypes"; } |
    sed -n '/^typedef struct [a-z]/,/^}/p' | awk '/^typedef/ { keep = !seen[$3]++ } keep' >"$work/types.h"
  members '' <"$work/types.h" >"$work/fortran.members"
  gcc -std=c99 -E -P "$header" | members gyroakf_ >"$work/header.members"
  {
    join <(sed -E 's/(.*)[ *](gyroakf_[a-z0-9_]+) \((.*)\);?/\2 \3/; s/const //g; s/, /,/g; s/ /~/2g' "$work/header.functions" | sort) \
      <(sed -E 's/(.*)[ *](gyroakf_[a-z0-9_]+) \((.*)\);?/\2 \3/; s/const //g; s/, /,/g; s/ /~/2g' "$work/fortran.functions" | sort) |
      awk '{ n = split($2, c, ","); split($3, f, ",")
             for (i = 1; i <= n; i++) { t = c[i]; u = f[i]; sub(/~.*/, "", t); sub(/~.*/, "", u)
               if (u ~ /_c$/) print t, u } }'
    awk '{ print $1, substr($1, 9) "_c" }' "$work/header.members"
  } | sort -u >"$work/pairs"
  echo '#include "gyroakf.h"' >"$work/preamble"
  layout "$work/preamble" "$work/header.members" </dev/null | sort >"$work/header.layout"
  # progress_c is two members of the header
  layout "$work/types.h" "$work/fortran.members" </dev/null | awk '
    /^member .*\.progress at [0-9]+, size 16, / {
      print $1, $2, $3, $4 + 0 ", size 8,", $NF
      print $1, $2 "_user", $3, $4 + 8 ", size 8,", $NF
      next
    }
    { print }' | sort >"$work/fortran.layout"
  while read -r c f; do
    grep -q "^struct $f " "$work/fortran.layout" || continue
    sed -E "s/^(struct|member) $f([. ])/\1 $c\2/" "$work/fortran.layout" | grep -E "^(struct|member) $c[. ]"
  done <"$work/pairs" | sort -u >"$work/fortran.same"
  diff "$work/header.layout" "$work/fortran.same" | grep '^[<>]' | sed 's/^</gyroakf.h:/; s/^>/Fortran:  /' |
    rule "every structure has the members of its Fortran type at their places"
}

check_symbols() { # LIBRARY
  local table=--dyn-syms
  case $1 in *.a) table=--syms ;; esac
  readelf -W $table "$1" >"$work/table" || { echo "$1" | rule "readelf reads the library"; return; }
  awk '$5 ~ /^(GLOBAL|WEAK|UNIQUE)$/ && $6 == "DEFAULT" && $7 != "UND" && $7 != "ABS" { sub(/@.*/, "", $8); print $8 }' \
    "$work/table" | sort -u >"$work/exported"
  [ -s "$work/exported" ] || echo "$1" | rule "the library exports something"
  { functions; fortran77; } | sort -u >"$work/documented"
  comm -23 "$work/documented" "$work/exported" | rule "$1: the functions of the header are exported"
  comm -13 "$work/documented" "$work/exported" | grep -vE '^__gyroakf_[a-z0-9_]*_MOD_|^\.gomp_critical_user_gyroakf_' |
    rule "$1: nothing is exported but these functions and the modules"
}

case ${1:-} in
  --symbols) check_symbols "$2"; finish ;;
  --fortran) check_fortran "$2"; finish ;;
esac
describe >"$work/now" || exit 1
if [ "${1:-}" = --write ]; then
  vanished >"$work/gone"
  if [ -s "$work/gone" ] && [ "${2:-}" != --break ]; then
    echo "programs that are compiled rely on this; it must not vanish or change within a major version (doc/abi.md):"
    cat "$work/gone"
    exit 1
  fi
  cp "$work/now" "$list"
  exit 0
fi
vanished | rule "nothing vanished or changed that programs rely on (doc/abi.md)"
diff <(grep -v '^#' "$list") <(grep -v '^#' "$work/now") | sed -n 's/^> //p' |
  rule "new functions, structures and constants are in $list: ci/abi.sh --write"
awk '$1 == "function"' "$work/now" | wc -l | awk '$1 < 1' | rule "there are functions in the header"
finish
