#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The library's numbers beside those of other programs, on the same simulated records; and its statements about its own errors
# against simulated truth. Prints Markdown; fails where a difference has no reason.
#
#   ./run.sh [allan] [series] [filters]               default: these three, a minute
#   ./run.sh monte_carlo                              the five tables below, a quarter of an hour on one core
#   ./run.sh [ar] [unit_root] [nis] [drift] [coefficients]          some of them
#   ./run.sh all                                      everything
#   ./run.sh --write PART...                          into doc/validation.md, between the marks of each part
#
# PROGRAM and STATE_SPACE may name programs that are built already. The other programs (allantools, statsmodels, arch, SciPy,
# filterpy) are installed into a private environment on first use.
set -eu
cd "$(dirname "$0")"
write=
if [ "${1:-}" = --write ]; then
  write=yes
  shift
fi
comparisons=(allan series filters)
tables=(ar unit_root nis drift coefficients)
case "${1:-}" in
  '') set -- "${comparisons[@]}" ;;
  monte_carlo) set -- "${tables[@]}" ;;
  all) set -- "${comparisons[@]}" "${tables[@]}" ;;
esac
setup=$(cd .. && pwd)/setup.sh
environment=${XDG_CACHE_HOME:-$HOME/.cache}/gyroakf/validation

prepare() { # the environment, the program, a place for the records
  if ! "$environment/bin/python" -c 'import allantools, arch, filterpy, statsmodels' 2>/dev/null; then
    python3 -m venv "$environment"
    "$environment/bin/pip" install --quiet numpy scipy matplotlib setuptools wheel statsmodels==0.15.0 arch==8.0.0 \
      allantools==2024.6
    "$environment/bin/pip" install --quiet --no-build-isolation filterpy==1.4.5
  fi
  [ -n "${PROGRAM:-}" ] || PROGRAM=$(built .. gyroakf)
  mkdir -p build
}

built() { # PACKAGE PROGRAM: the path of a program, built
  (
    cd "$1"
    "$setup" fpm build >/dev/null
    realpath "$("$setup" fpm run "$2" --runner echo 2>/dev/null | tail -n 1)"
  )
}

compare() { # PART
  local arguments
  prepare
  arguments=("$PROGRAM" build)
  if [ "$1" = filters ]; then arguments+=("${STATE_SPACE:-$(built monte_carlo state_space)}"); fi
  PYTHONDONTWRITEBYTECODE=1 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 \
    "$environment/bin/python" "compare/$1.py" "${arguments[@]}"
}

put() { # PART FILE: the file takes the place of what stands between the marks
  awk -v part="$1" -v file="$2" '
    $0 == "<!-- end " part " -->" { inside = 0 }
    !inside { print }
    $0 == "<!-- begin " part " -->" { inside = 1; while ((getline line < file) > 0) print line }
  ' ../doc/validation.md >build/validation.md
  cp build/validation.md ../doc/validation.md
}

failed=
for part; do
  case " ${comparisons[*]} ${tables[*]} " in
    *" $part "*) ;;
    *)
      echo "run.sh: no part '$part'; there are ${comparisons[*]} ${tables[*]}, monte_carlo, all" >&2
      exit 1
      ;;
  esac
  mkdir -p build
  case " ${tables[*]} " in
    *" $part "*) if [ "$part" = coefficients ]; then ../bench/allan_fit/run.sh; else monte_carlo/run.sh "$part"; fi ;;
    *) compare "$part" ;;
  esac >"build/$part.md" || failed=yes
  if [ -n "$write" ]; then put "$part" "build/$part.md"; else cat "build/$part.md"; fi
done
[ -z "$failed" ]
