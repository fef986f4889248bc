# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# Manual page and completion: the same texts as --help.

good "manual page" --man
if cmp -s out "$root/man/gyroakf.1"; then pass; else fail "man/gyroakf.1 is not what --man prints: gyroakf --man > man/gyroakf.1"; fi
sed 's/\\-/-/g; s/\\e/\\/g; s/\\f[BRI]//g; s/^\\&//' out >page
for command in run inspect allan tests ar filter simulate selftest; do
   run $command --help
   # every option with its value and every line of its text, in the page
   sed -nE 's/^  ((-., )?--[^ ]+( [^ ]+)?)( .*|$)/\1/p' out | sed 's/ *$//' | while read -r option; do
      grep -qF -- "$option" page || echo "$option"
   done >missing
   is "options of '$command' in the manual page" "$(cat missing)" ""
   sed -nE 's/^ {30}([^ ].*)$/\1/p; s/^  -.{27} +([^ ].*)$/\1/p' out | while IFS= read -r line; do
      tr '\n' ' ' <page | grep -qF -- "$line" || echo "$line"
   done >missing
   is "texts of '$command' in the manual page" "$(cat missing)" ""
done
run --help
grep -o 'Exit codes: .*' out >line
if grep -qF -- "$(cat line)" page; then pass; else fail "no exit codes in the manual page"; fi

bad "completion of an unknown shell" 1 "'tcsh' is not one of these" --completion tcsh
good "completion for bash" --completion bash
cp out completion.bash

# completed WORD...: what bash offers for the last word
completed() {
   bash -c 'source ./completion.bash; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _gyroakf; echo ${COMPREPLY[*]}' _ "$@"
}
is "bash completes commands" "$(completed gyroakf al)" "allan"
is "bash completes options" "$(completed gyroakf allan x.csv --tau)" "--taus"
is "bash completes options of a command only" "$(completed gyroakf inspect x.csv --tau)" ""
is "bash completes words" "$(completed gyroakf filter x.csv --akf '')" "paper robust"
is "bash completes short options" "$(completed gyroakf allan x.csv -q)" "-q"
is "bash completes help" "$(completed gyroakf hel) $(completed gyroakf help al)" "help allan"
is "bash completes options without a command" "$(completed gyroakf x.csv --presen --pres)" "--preset"
for shell in zsh fish; do
   good "completion for $shell" --completion $shell
   holds "$shell knows --taus" "taus" out
   if grep -q -- "'-o\[write\| -s o" out; then pass; else fail "$shell does not know -o"; fi
   if command -v $shell >/dev/null; then
      if $shell -n out; then pass; else fail "$shell does not take its completion script"; fi
   fi
done
if command -v fish >/dev/null; then
   is "fish completes words" "$(fish -c 'source out; complete -C "gyroakf filter --akf "' | cut -f 1 | tr '\n' ' ')" "paper robust "
fi
