#!/bin/sh
# SPDX-License-Identifier: MIT
# Prepares a machine for gyroakf, then runs the command it is given with optimizing flags:
#
#   ./setup.sh fpm run gyroakf -- example/data/mems_gyro_x.txt
#   ./setup.sh fpm test
#
# It installs only what is missing and can be run any number of times. Root (or sudo) is needed only
# where a package of the system is missing. After it plain `fpm run` and `fpm test` work too.
#
#   FPM_FFLAGS=...      other compiler flags; empty: fpm's own debug flags
#   GYROAKF_PAGE=1      install a browser without a window and tidy too (ci/page.sh)
#   GYROAKF_LINT=1      install fortitude too (style checks)
#   GYROAKF_SITE=1      install FORD too (ci/site.sh: pages of the doc comments)
#   GYROAKF_FUZZ=1      install clang too (libFuzzer for ci/fuzz)
#   GYROAKF_CMAKE=1     install CMake, Ninja and pkg-config too (ci/cmake.sh)
#   GYROAKF_VALGRIND=1  install valgrind too (ci/valgrind.sh)
# shellcheck disable=SC2016,SC2086  # lists of words are split on purpose
set -eu
root=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
cache=${XDG_CACHE_HOME:-${HOME:-/tmp}/.cache}/gyroakf
venv=$cache/venv
fpm_version=0.12.0
fortitude_version=0.10.0
ford_version=7.0.13
unset GIT_DIR GIT_WORK_TREE GIT_INDEX_FILE

say()  { printf 'setup: %s\n' "$*" >&2; }
die()  { say "$*"; exit 1; }
have() { command -v "$1" >/dev/null 2>&1; }

as_root() {
  if [ "$(id -u)" -eq 0 ]; then "$@"
  elif have sudo; then sudo "$@"
  else say "there is no sudo"; return 1; fi
}

bounded() { # runs a command for at most $1 seconds, where the system can bound one
  seconds=$1; shift
  if have timeout; then timeout "$seconds" "$@"; else "$@"; fi
}

again() { # a command that needs the network: up to three times
  for pause in 3 10 0; do
    if "$@"; then return 0; fi
    sleep $pause
  done
  return 1
}

links() { # whether a program that calls LAPACK from a parallel region builds with these flags, and zlib is there
  dir=$(mktemp -d)
  printf 'external dposv\n!$omp parallel\ncall dposv\n!$omp end parallel\nend\n' > "$dir/t.f90"
  if gfortran -fopenmp "$@" "$dir/t.f90" -o "$dir/t" -llapack -lblas -lz >/dev/null 2>&1; then r=0; else r=1; fi
  rm -rf "$dir"
  return $r
}

is_fpm() { # whether this is the Fortran package manager (there is another fpm), and not an old one
  v=$("$1" --version 2>/dev/null | tr '\n' ' ') || return 1
  case $v in *"Version: "*0.[0-8].*) return 1 ;; *Fortran*) return 0 ;; *) return 1 ;; esac
}

# --- what is missing -------------------------------------------------------------------------
need=
native=-march=native
if have gfortran && have gcc && have ar; then
  links $native || { native=; links || need=libraries; }
else
  need='compiler libraries'
fi
have git || need="$need git"
own_fpm=
if have fpm && is_fpm fpm; then :; else own_fpm=yes; fi
if { [ -n "$own_fpm" ] && ! is_fpm "$venv/bin/fpm"; } ||
   { [ -n "${GYROAKF_LINT:-}" ] && ! have fortitude && [ ! -x "$venv/bin/fortitude" ]; } ||
   { [ -n "${GYROAKF_SITE:-}" ] && ! have ford && [ ! -x "$venv/bin/ford" ]; }; then
  have python3 && python3 -c 'import ensurepip, venv' >/dev/null 2>&1 || need="$need python"
fi
[ -z "${GYROAKF_PAGE:-}" ] || { have tidy && { have chromium || have google-chrome || have chromium-browser; }; } ||
  need="$need page"
[ -z "${GYROAKF_FUZZ:-}" ] || "$root/ci/fuzz/clang.sh" >/dev/null || need="$need clang"
[ -z "${GYROAKF_CMAKE:-}" ] || { have cmake && have ninja && have pkg-config; } || need="$need cmake"
[ -z "${GYROAKF_VALGRIND:-}" ] || have valgrind || need="$need valgrind"

# --- packages of the system ------------------------------------------------------------------
if [ -n "$need" ]; then
  say "installing:" $need
  list=
  add() { list="$list $*"; }
  if have apt-get; then
    again as_root apt-get update -qq >&2 || say "the package index was not refreshed"
    for n in $need; do case $n in
      compiler) add gfortran gcc libc6-dev binutils ;;
      libraries) add liblapack-dev libblas-dev zlib1g-dev ;;
      git) add git ca-certificates ;;
      python) add python3 python3-venv ca-certificates ;;
      page) add chromium tidy fonts-dejavu-core ;;
      clang)
        add clang
        # where the sanitizers' libraries are a package of their own
        ! apt-cache show libclang-rt-dev >/dev/null 2>&1 || add libclang-rt-dev ;;
      cmake) add cmake ninja-build pkg-config ;;
      valgrind) add valgrind libc6-dbg ;;
    esac; done
    again as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $list >&2 ||
      die "not installed; please run as root: apt-get install$list"
  elif have dnf; then
    for n in $need; do case $n in
      compiler) add gcc-gfortran gcc binutils ;;
      libraries) add lapack-devel blas-devel zlib-devel ;;
      git) add git-core ;;
      python) add python3 python3-pip ;;
      page) add chromium tidy ;;
      clang) add clang compiler-rt ;;
      cmake) add cmake ninja-build pkgconf-pkg-config ;;
    esac; done
    again as_root dnf install -y $list >&2 || die "not installed; please run as root: dnf install$list"
  elif have brew; then
    for n in $need; do case $n in
      compiler) add gcc ;; libraries) add lapack zlib ;; page) add tidy-html5 ;; clang) add llvm ;; cmake) add cmake ninja pkg-config ;; *) add "$n" ;;
    esac; done
    again brew install $list >&2
  elif have mamba || have conda; then
    tool=conda; if have mamba; then tool=mamba; fi
    for n in $need; do case $n in
      compiler) add gfortran gcc binutils ;; libraries) add liblapack libblas zlib ;; clang) add clang compiler-rt ;; cmake) add cmake ninja pkg-config ;;
      *) add "$n" ;;
    esac; done
    again $tool install -y -c conda-forge $list >&2
  else
    die "no known package manager; please install:" $need
  fi
  links $native || { native=; links || die "gfortran cannot link LAPACK and zlib (-llapack -lblas -lz)"; }
fi

# --- fpm, in an environment of its own -------------------------------------------------------
in_venv() { # installs a Python package into the private environment
  if [ ! -x "$venv/bin/python" ] || ! "$venv/bin/python" -c '' >/dev/null 2>&1; then
    rm -rf "$venv"
    python3 -m venv "$venv" >&2
  fi
  say "installing $1 into $venv"
  again "$venv/bin/python" -m pip install -q --disable-pip-version-check "$1" >&2
}

link_fpm() { # leaves fpm on the PATH; never replaces a file that is not ours
  for dir in /usr/local/bin "${HOME:-/nonexistent}/.local/bin"; do
    mkdir -p "$dir" 2>/dev/null || continue
    [ -w "$dir" ] || continue
    link=$dir/fpm
    [ ! -L "$link" ] || [ "$(readlink "$link")" != "$venv/bin/fpm" ] || return 0
    if [ -e "$link" ]; then
      say "$link is another program and stays; use: ./setup.sh fpm ..."
      return 0
    fi
    ln -sf "$venv/bin/fpm" "$link"
    case :$PATH: in
      *":$dir:"*) say "fpm is now at $link" ;;
      *) say "fpm is now at $link; to find it, add this to your profile: PATH=\"$dir:\$PATH\"" ;;
    esac
    return 0
  done
  say "fpm is at $venv/bin/fpm"
}

if [ -n "$own_fpm" ]; then
  is_fpm "$venv/bin/fpm" || in_venv "fpm==$fpm_version"
  link_fpm
fi
if [ -n "${GYROAKF_LINT:-}" ] && ! have fortitude && [ ! -x "$venv/bin/fortitude" ]; then
  in_venv "fortitude-lint==$fortitude_version"
fi
if [ -n "${GYROAKF_SITE:-}" ] && ! have ford && [ ! -x "$venv/bin/ford" ]; then
  in_venv "ford==$ford_version"
fi
if [ -d "$venv/bin" ]; then
  if [ -n "$own_fpm" ]; then PATH=$venv/bin:$PATH; else PATH=$PATH:$venv/bin; fi
  export PATH
fi

# --- the test framework ----------------------------------------------------------------------
# It is a git dependency, fetched by fpm on its first build. Where its address does not answer, a
# checkout of ci/test-drive, which has the same interface, is put where fpm would put the original.
dep=$root/build/dependencies/test-drive
stand_in=$root/ci/test-drive

is_stand_in() { grep -q '^# Stand-in' "$dep/README.md" 2>/dev/null; }
is_current() { # whether the stand-in in use is the one in ci/
  (cd "$stand_in" && find . -type f) | while read -r f; do
    cmp -s "$stand_in/$f" "$dep/$f" || exit 1
  done
}
put_stand_in() {
  new=$root/build/dependencies/new.$$
  mkdir -p "$new"
  cp -R "$stand_in/." "$new/"
  git -C "$new" init -q
  git -C "$new" add -A -f
  git -C "$new" -c user.name=setup -c user.email=setup@localhost -c commit.gpgsign=false \
    -c core.hooksPath=/dev/null commit -q -m "$1"
  rm -rf "$dep"
  mv "$new" "$dep"
}

if [ -d "$dep" ] && { [ ! -d "$dep/src" ] ||
     ! git --git-dir="$dep/.git" rev-parse -q --verify HEAD >/dev/null 2>&1; }; then
  rm -rf "$dep" # a fetch that was cut off
fi
if [ ! -d "$dep" ]; then
  # fpm's notes say that the checkout is there; its archives keep the objects of another one
  rm -rf "$root"/build/cache.toml "$root"/build/*_*
  url=$(sed -n 's/^test-drive *=.*git *= *"\([^"]*\)".*/\1/p' "$root/fpm.toml")
  tag=$(sed -n 's/^test-drive *=.*tag *= *"\([^"]*\)".*/\1/p' "$root/fpm.toml")
  if ! GIT_TERMINAL_PROMPT=0 bounded 20 git ls-remote --exit-code "$url" "refs/tags/$tag" >/dev/null 2>&1; then
    say "$url does not answer; the tests use ci/test-drive"
    put_stand_in "$tag"
  fi
elif is_stand_in && ! is_current; then
  put_stand_in updated
fi

# --- what is left of sources that are gone ---------------------------------------------------
# fpm keeps their objects in its archives, and a moved source would be linked in its old version.
known=$(cd "$root" && find src app test c_api example build/dependencies -type f ! -path '*/build/*' 2>/dev/null | sed 's|/|_|g; s|$|.o|')
for object in "$root"/build/*_*/gyroakf/*.o; do
  case "
$known
" in *"
${object##*/}
"*) ;; *) [ ! -e "$object" ] || { say "a source is gone: building anew"; rm -rf "$root"/build/*_*; }; break ;; esac
done

# --- flags -----------------------------------------------------------------------------------
# Without --profile fpm builds for debugging. No fused multiply-add of real
# numbers by the compiler's choice: results depend less on the optimization. Where a variable is kept, line by
# line, takes the compiler much of its time, most with sanitizers, and no backtrace tells it.
: "${FPM_FFLAGS=-O3 $native -ffp-contract=off -fPIC -g -fno-var-tracking -fbacktrace}"
: "${FPM_CFLAGS=-O3 $native -ffp-contract=off -fPIC -g}"
: "${OMP_WAIT_POLICY=passive}" # waiting threads sleep: other work on the machine does not slow us down
export FPM_FFLAGS FPM_CFLAGS OMP_WAIT_POLICY

# Tests and examples need no optimization; fpm splits its command lines at blanks.
case $root in
  *" "*) ;;
  *) : "${FPM_FC=$root/ci/compiler/gfortran}"; export FPM_FC ;;
esac

# --- the command -----------------------------------------------------------------------------
# What fpm prints while it compiles goes into a file; after that `fpm run` and `fpm test` have nothing left to compile.
build_quietly() { # OPTIONS of fpm build
  log=$root/build/build.log
  mkdir -p "$root/build"
  begun=$(date +%s)
  say "compiling; the log is $log"
  if fpm build "$@" >"$log" 2>&1; then
    say "compiled in $(($(date +%s) - begun)) s"
  else
    grep -v '^\[ *[0-9]*%\]' "$log" | tail -n 60 >&2
    die "it does not compile"
  fi
}

if [ $# -eq 0 ]; then say "ready"; exit 0; fi
case " $* " in
  *" --flag"* | *" --profile"* | *" --compiler"* | *" --c-flag"* | *" --help"*) ;;
  " fpm run "*) build_quietly ;;
  " fpm test "*) build_quietly --tests ;;
esac
exec "$@"
