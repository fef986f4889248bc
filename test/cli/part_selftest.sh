# shellcheck shell=bash
# SPDX-License-Identifier: MIT
# The self-test: it passes, and it fails where the machine computes wrongly. Read by run.sh.
good "selftest" selftest
cp out selftest.txt
if tail -n 1 out | grep -qE '^[0-9]{2} checks, all agree$'; then pass; else fail "selftest: the sum is '$(tail -n 1 out)'"; fi
is "selftest: a line for every check" "$(grep -cE ' ok$' out)" "$(tail -n 1 out | cut -d ' ' -f 1)"
is "selftest: nothing failed" "$(grep -c FAILED out)" 0
is "selftest fits 80 columns" "$(awk 'length > 80' out)" ""
good "selftest on one thread" selftest --threads 1
is "selftest on one thread gives the same" "$(diff out selftest.txt | grep '^[<>]' )" ""
good "a quiet selftest" selftest --quiet
is "a quiet selftest prints nothing" "$(cat out)" ""

# a mathematical library whose logarithm is wrong in the ninth digit
printf '%s\n' '#define _GNU_SOURCE' '#include <dlfcn.h>' 'double log(double x) {' \
   '  double (*right)(double) = (double (*)(double))dlsym(RTLD_NEXT, "log");' \
   '  return right(x)*(1.0 + 1e-9);' '}' >wrong_log.c
if ldd "$gyroakf" 2>/dev/null | grep -q 'libm\.so' && ! ldd "$gyroakf" | grep -q 'libasan' &&
   gcc -shared -fPIC -o wrong_log.so wrong_log.c -ldl 2>/dev/null; then
   LD_PRELOAD=$PWD/wrong_log.so "$gyroakf" selftest >out 2>err </dev/null
   is "selftest notices a wrong logarithm: exit code" $? 3
   holds "selftest notices a wrong logarithm: its check" "Fisher's g" out
   if grep "Fisher's g" out | grep -q 'FAILED'; then pass; else fail "a wrong logarithm is not noticed"; fi
   if tail -n 1 out | grep -qE ' checks, [0-9]+ FAILED$'; then pass; else fail "the sum is '$(tail -n 1 out)'"; fi
   holds "selftest notices a wrong logarithm: message" "gyroakf: error: selftest: " err
fi
