#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The rules of CONTRIBUTING.md that a text search can check:   ci/style.sh
# Prints a line for every violation and as the last line "N passed, N failed" (rules, not lines).
set -u
shopt -s lastpipe # the last command of a pipe runs here and can count
cd "$(dirname "$0")/.." || exit 1
passed=0
failed=0

# rule NAME: fails if there is anything on standard input, and shows it
rule() {
  local found
  found=$(cat)
  if [ -z "$found" ]; then passed=$((passed + 1)); return; fi
  failed=$((failed + 1))
  printf '%s:\n%s\n' "$1" "$found" | head -n 20
}

files() { # of the repository, also the new ones that are not ignored
  git ls-files --cached --others --exclude-standard -- "$@" | while read -r f; do [ -f "$f" ] && echo "$f"; done
}

each() { # COMMAND...: with the files on standard input as further arguments
  tr '\n' '\0' | xargs -0 -r "$@"
}

code() { # FILE:LINE:code, without texts and comments, in lower case
  files "$@" | each awk '{
    gsub(/"[^"]*"/, "\"\""); gsub(/\047[^\047]*\047/, "\"\""); sub(/!.*/, ""); print FILENAME ":" FNR ":" tolower($0) }'
}

src=$(code 'src/*.f90')
app=$(code 'app/*.f90')

grep -E 'fatal_error *\(.*status%(internal|usage)' <<<"$src" | rule "src/ gives an error that is the program's (test/test_status.f90)"
grep -E ':[0-9]+:(.*[^a-z0-9_%])?(error +)?stop( *$| *[0-9",a-z(]| *;)' <<<"$src" |
  grep -vE '(end +(subroutine|function)|%) *stop|stop *=' | rule "the library does not stop"
grep -E ':[0-9]+:(.*[^a-z0-9_%])?(print *([*(]|"")|write *\( *((unit *= *)?(\*|output_unit|error_unit)))' <<<"$src" |
  rule "the library does not print"
grep -E ':[0-9]+:(.*[^a-z0-9_%])?(error +)?stop( *$| *[0-9",a-z(]| *;)' <<<"$app" | grep -v '^app/main.f90:' |
  grep -vE 'stop *=' | rule "only app/main.f90 ends the program"
printf '%s\n%s\n' "$src" "$app" | grep -E ':[0-9]+: *use[ ,:]' | grep -vE 'only *:' | grep -v '^src/gyroakf.f90:' |
  rule "every use has only:"
grep -E '(^|[^a-z_])random_(number|seed) *\(|random_init' <<<"$src" | rule "the library draws from its own generator"
grep -E ':[0-9]+: *(integer|real|logical|character|type|class|complex)[^:]*, *save|:[0-9]+: *save( |$)|threadprivate' <<<"$src" |
  rule "the library keeps no state"

files 'src/*.f90' | each awk '
  function judge() { if (file != "" && got != want) print file ": " got " instead of " want }
  FNR == 1 { judge(); file = want = FILENAME; got = ""; sub(/^src\//, "", want); sub(/\.f90$/, "", want); gsub(/\//, "_", want) }
  got == "" && /^ *(module|submodule *\([^)]*\)) +[A-Za-z0-9_]+ *(!.*)?$/ { sub(/ *(!.*)?$/, ""); sub(/.* /, ""); got = $0 }
  END { judge() }' | rule "a module is named after its path"

# the keys "quantisation" and "quantised" of the JSON are as they are
files 'src/*.f90' 'app/*.f90' 'test/*.f90' 'c_api/*.[ch]' 'python/*.py' 'doc/*.md' '*.md' |
  each grep -niE '(normal|minim|optim|character|initial|recogn|summar|quant)is(e|es|ed|ing|ation)\b|\b(colour|centre)' |
  grep -vE '"(quantisation|quantised)"' | rule "American spelling"

files 'src/*.f90' 'app/*.f90' | each awk '
  /^ *!>/ { if (empty && FNR > 2) print FILENAME ":" FNR; empty = 0; doc = 1; next }
  /^ *$/ { empty = doc; next }
  { empty = doc = 0 }' | rule "no empty line within a doc comment: FORD loses what stands before it"

# to the compiler a module and a C function are of one name space: gfortran calls the wrong one
comm -12 <(files 'src/*.f90' | sed 's/^src\///; s/\.f90$//; s/\//_/g' | sort -u) \
  <(files 'src/*.f90' | each sed -nE 's/.*bind *\(C, *name *= *"([^"]*)".*/\1/p; s/.*(function|subroutine) +(gyroakf_[a-z0-9_]+) *\(.*/\2/p' | sort -u) |
  rule "no C function has the name of a module"

files 'src/*.f90' 'app/*.f90' 'test/*.f90' 'example/*.f90' | each awk '
  function judge() { if (file != "" && !typed) print file ": no implicit none (type, external)" }
  FNR == 1 { judge(); file = FILENAME; typed = 0; if ($0 != "! SPDX-License-Identifier: MIT") print file }
  index($0, "implicit none (type, external)") { typed = 1 }
  END { judge() }' | rule "every Fortran file has its licence and implicit none (type, external)"

files '*.c' '*.h' '*.cpp' '*.sh' | each awk '
  function judge() { if (file != "" && !licensed) print file }
  FNR == 1 { judge(); file = FILENAME; licensed = 0 }
  FNR <= 3 && /SPDX-License-Identifier: MIT/ { licensed = 1 }
  END { judge() }' | rule "every C and C++ file and script has its licence"

# foundations < stats < io, simulate < preprocess < series < ar < allan < filter < pipeline < selftest < report < c_api
level() { # MODULE: sets level
  case $1 in
    gyroakf_c_api_*) level=11 ;;
    gyroakf_report_*) level=10 ;;
    gyroakf_selftest) level=9 ;;
    gyroakf_pipeline*) level=8 ;;
    gyroakf_filter_*) level=7 ;;
    gyroakf_allan_*) level=6 ;;
    gyroakf_ar_*) level=5 ;;
    gyroakf_series_*) level=4 ;;
    gyroakf_preprocess_*) level=3 ;;
    gyroakf_io_* | gyroakf_simulate_*) level=2 ;;
    gyroakf_stats_*) level=1 ;;
    *) level=0 ;;
  esac
}
sed -nE 's/^src\/([^:]*)\.f90:[0-9]+: *use *(, *non_intrinsic *)?(::)? *(gyroakf_[a-z0-9_]+).*/\1 \4/p' <<<"$src" |
  sort -u | while read -r path used; do
    own=${path//\//_}
    [ "$own" = gyroakf ] && continue
    level "$own"; mine=$level
    level "$used"
    [ "$mine" -ge "$level" ] || echo "src/$path.f90 uses $used"
  done | rule "a module uses only its own folder and those to its left"
files 'src/*.f90' | sed 's|.*/||' | sort | uniq -d | rule "no two files of src/ have one name"

files '*.f90' '*.c' '*.h' '*.cpp' '*.sh' '*.toml' '*.md' 'setup.sh' | grep -v '^test/data/' |
  each grep -HnE "[[:space:]]+\$|$(printf '\t')" | rule "no tabs, no blanks at the end of a line"

files '*' | grep -vE '^(test|example)/data/|\.(png|svg|npy|gz)$' | each grep -LI . | while read -r f; do
  [ ! -s "$f" ] || echo "$f"
done | rule "no binary files"

# one version everywhere
version=$(sed -n 's/^version *= *"\(.*\)"/\1/p' fpm.toml)
{
  same() { # FILE TEXT...: the text is in the file, if there is such a file
    [ ! -f "$1" ] || grep -qF -- "$2" "$1" || echo "$1: no '$2'"
  }
  IFS=. read -r major minor patch <<<"$version"
  same src/gyroakf/release.f90 "release_string = \"$version\""
  if [ -f c_api/include/gyroakf.h ]; then
    for part in MAJOR:"$major" MINOR:"$minor" PATCH:"$patch"; do
      grep -qE "GYROAKF_VERSION_${part%:*} +${part#*:}\$" c_api/include/gyroakf.h ||
        echo "c_api/include/gyroakf.h: GYROAKF_VERSION_${part%:*} is not ${part#*:}"
    done
  fi
  same man/gyroakf.1 "gyroakf $version"
  same CITATION.cff "version: $version"
} | rule "one version everywhere"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
