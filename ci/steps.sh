# SPDX-License-Identifier: MIT
# shellcheck shell=bash
# What .ci/run and ci/full share; sourced by them, with the steps that the caller asked for as arguments.
#
# A step's output is in build/ci/STEP.log. The last line that `finish` prints is the sum of the counts of all steps,
# "N passed, N failed"; above it stands a table of seconds per step. The exit code is not 0 if anything failed.
exec </dev/null
export CI=true LC_ALL=C.UTF-8
unset FPM_FFLAGS FPM_CFLAGS FPM_LDFLAGS FPM_FC FPM_CC
logs=$PWD/build/ci
mkdir -p "$logs"
list=$0
wanted=("$@")

checked_fortran='-O0 -g -Wall -Wextra -pedantic -std=f2018 -fcheck=all -fbacktrace -finit-real=snan -finit-derived'
checked_fortran+=' -ffpe-trap=invalid,zero,overflow -fPIC -Wno-compare-reals -Wno-maybe-uninitialized'
checked_c='-O0 -g -Wall -Wextra -pedantic -std=c99 -fPIC'
sanitized='-O1 -g -fno-var-tracking -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -ffp-contract=off -fPIC'

is_wanted() { # STEP: whether the caller asked for it, or for none
  [ ${#wanted[@]} -eq 0 ] || [[ " ${wanted[*]} " == *" $1 "* ]]
}

# step NAME SECONDS COMMAND...: runs a command that usually takes so many seconds and ends it after five times as many. It
# records the sum of the command's lines "N passed, N failed"; a command without such a line counts as one test, and a
# command that fails without a failure in its counts as one failure. A test that this machine cannot run counts nothing;
# its command gives the reason in a line "skipped: ...".
step() {
  local name=$1 limit=$(($2 * 5)) log=$logs/$1.log start=$SECONDS code passed failed
  shift 2
  is_wanted "$name" || return 0
  timeout -k 10 "$limit" "$@" >"$log" 2>&1
  code=$?
  [ "$code" -ne 124 ] || echo "ended after $limit s" >>"$log"
  read -r passed failed < <(count "$log")
  if [ $((passed + failed)) -eq 0 ] && [ "$code" -eq 0 ] && ! grep -q '^skipped: ' "$log"; then passed=1; fi
  if [ "$failed" -eq 0 ] && [ "$code" -ne 0 ]; then failed=1; fi
  echo "$passed passed, $failed failed" >"$logs/$name.count"
  printf '%-10s %6d passed %3d failed %5d s\n' "$name" "$passed" "$failed" $((SECONDS - start)) >"$logs/$name.row"
  report "$name" "$code" "$failed"
}

count() { # FILES: the sums of their lines "N passed, N failed"
  sed -nE 's/^([0-9]+) passed, ([0-9]+) failed *$/\1 \2/p' "$@" | awk '{ p += $1; f += $2 } END { print p + 0, f + 0 }'
}

report() { # NAME CODE FAILED: the step's row; of a failed step its failing checks and the last 40 lines. One write: lanes share the output
  local log=$logs/$1.log text
  text=$(cat "$logs/$1.row"; grep -m 1 '^skipped: ' "$log")
  if [ "$3" -gt 0 ]; then
    text+=$(printf '\n--- %s failed with exit code %s; its failing checks and last 40 lines:\n' "$1" "$2"
      grep -aE -A 4 '\[(FAILED|UNEXPECTED PASS)\]|^FAILED: ' "$log" | head -n 60
      tail -n 40 "$log"
      echo "--- end of $1")
  fi
  printf '%s\n' "$text"
}

# installs what some steps need beyond setup.sh's own list: TOOL as in setup.sh, GYROAKF_TOOL=1
tools() { # TOOL...
  local tool
  [ ${#wanted[@]} -eq 0 ] || return 0
  for tool in "$@"; do
    env "GYROAKF_$tool=1" ./setup.sh true >"$logs/tool-$tool.log" 2>&1
  done
}

begin() {
  git status --porcelain >"$logs/status"
  rm -f "$logs"/*.count "$logs"/*.row
}

finish() { # the table and the sum; a step of the list that did not end counts as failed
  local name passed failed
  for name in $(sed -nE 's/^ *step +([a-z][a-z0-9-]+) +.*/\1/p' "$list"); do
    if ! is_wanted "$name" || [ -f "$logs/$name.count" ]; then continue; fi
    printf '%-10s did not end\n' "$name" >"$logs/$name.row"
    echo "0 passed, 1 failed" >"$logs/$name.count"
  done
  read -r passed failed < <(count "$logs"/*.count)
  echo "steps by time:"
  sort -rnk 6 "$logs"/*.row
  echo "$SECONDS s in all"
  echo "$passed passed, $failed failed"
  [ "$failed" -eq 0 ]
}

# the path of the program built with the flags in the environment
binary() { ./setup.sh fpm run gyroakf --runner echo 2>/dev/null | tail -n 1; }

command_line() { # the command-line tests, on the program built with the flags in the environment
  local program
  ./setup.sh fpm build || return 1
  program=$(binary)
  echo "program: $program"
  test/cli/run.sh "$program"
}

faults() { # memory that is lacking, then files that cannot be read or written
  ci/faults/run.sh && ci/faults/files.sh "$(binary)"
}

lint() { # fortitude, which ends with a count of its findings
  GYROAKF_LINT=1 ./setup.sh fortitude check --output-format concise
}

mutants() { # the list of mutants fits the sources; ci/mutation/run.py alone tries them
  command -v python3 >/dev/null || { echo "skipped: there is no python3"; return; }
  ci/mutation/run.py --check
}

warnings() { # of the checked build: fpm keeps what the compiler said beside each object; temporaries are told at run time
  local said found
  checked ./setup.sh fpm build >/dev/null || return 1
  said=$(grep -oE 'build/[a-z]+_[0-9A-F]{16}' build/compile_commands.json | sort -u | while read -r dir; do
    ls "$dir"/gyroakf/{src,app,c_api}_*.log 2>/dev/null
  done)
  [ -n "$said" ] || { echo "no compiler logs found"; return 1; }
  # shellcheck disable=SC2086
  found=$(grep -iE -B 5 '(^| )warning: ' $said)
  found+=$(grep -aA 1 -E '^At line [0-9]+ of file [./]*(src|app)/' "$logs/checked.log" | grep -a -B 1 'array temporary' | sort -u)
  [ -z "$found" ] || { echo "$found"; return 1; }
}

builds() { # the program as it is built for use and the checked one give the same numbers
  local release debug
  ./setup.sh fpm build >/dev/null && release=$(binary) && checked ./setup.sh fpm build >/dev/null && debug=$(checked binary) || return 1
  ci/determinism.sh "$release" "$debug"
}

examples() { # every example builds, runs, and prints what example/output/ says, where it says something
  [ -n "$(find example -name "*.f90")" ] || { echo "there is no example"; return 1; }
  ./setup.sh fpm run --example --all --runner ci/example.sh
}

benches() { # the Fortran programs of bench/ and validation/ still build
  local file failed=0
  for file in bench/*/fpm.toml validation/*/fpm.toml; do
    (cd "$(dirname "$file")" && ../../setup.sh fpm build) || failed=1
  done
  for file in bench/*/app/main.f90; do
    file=${file%/app/main.f90}
    [ -e "$file/fpm.toml" ] || bench/program.sh "${file#bench/}" || failed=1
  done
  return $failed
}

header() { # the C sources and the header alone as C99 and, where there is a C++ compiler, as C++; the C++ example as C++11
  local file
  for file in c_api/include/gyroakf.h c_api/*/*.c; do
    gcc -std=c99 -Wall -Wextra -pedantic -Werror -Ic_api/include -Ic_api/test -fsyntax-only -x c "$file" || return 1
    if command -v g++ >/dev/null; then g++ -Wall -Wextra -Werror -Ic_api/include -Ic_api/test -fsyntax-only -x c++ "$file" || return 1; fi
  done
  ! command -v g++ >/dev/null || g++ -std=c++11 -Wall -Wextra -pedantic -Werror -Ic_api/include -fsyntax-only c_api/cpp/owner.cpp
}

clean() { # the steps before it wrote nothing into the work tree
  git status --porcelain | diff "$logs/status" -
}

checked() {
  FPM_FFLAGS=$checked_fortran FPM_CFLAGS=$checked_c MALLOC_PERTURB_=128 "$@"
}

# gfortran 12 forms strides of optional arrays that are absent, from what happens to stand there, and negates them though nothing uses
# them: in Fortran signed overflow is left out
sanitizers() {
  FPM_FFLAGS="$sanitized -fno-sanitize=signed-integer-overflow" FPM_CFLAGS="$sanitized -Wall -Wextra" \
    LSAN_OPTIONS=suppressions=$PWD/ci/lsan.supp:print_suppressions=0 \
    ASAN_OPTIONS=malloc_fill_byte=255:max_malloc_fill_size=1000000000:allocator_may_return_null=1 \
    UBSAN_OPTIONS=print_stacktrace=1 "$@"
}

export -f benches faults builds clean command_line binary header lint mutants warnings examples checked sanitizers
export checked_fortran checked_c sanitized logs
