#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""The Python package beside allantools, statsmodels and the C call: times and differences; its import.

    python bench/python.py [SAMPLES]      1e7 without it; needs gyroakf, allantools, statsmodels

Medians of five runs; of allantools and statsmodels the single one.
"""

import ctypes
import resource
import statistics
import subprocess
import sys
import time

import numpy as np

import gyroakf
import gyroakf.allantools
from gyroakf import _library as lib


def seconds(function, runs):
    took = []
    for _ in range(runs):
        began = time.perf_counter()
        result = function()
        took.append(time.perf_counter() - began)
    return statistics.median(took), result


def row(name, theirs, ours, compare):
    other, expected = seconds(theirs, 1)
    own, found = seconds(ours, 5)
    difference = np.max(np.abs(np.asarray(compare(found)) / np.asarray(compare(expected)) - 1))
    print(
        f"{name:28} {other:9.3f} s {own:9.4f} s {other / own:8.1f} x {difference:9.1e}", flush=True
    )


def c_call(x):
    handle = ctypes.c_void_p()
    lib.LIBRARY.gyroakf_allan_new(x.ctypes.data, x.size, 1.0, None, ctypes.byref(handle), None)
    lib.LIBRARY.gyroakf_allan_free(handle)


def import_seconds(modules):
    """Processor time of a fresh interpreter, the least of seven."""
    took = []
    for _ in range(7):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([sys.executable, "-c", f"import {modules}"], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        took.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return min(took)


def main():
    beyond = import_seconds("numpy, gyroakf") - import_seconds("numpy")
    print(f"import: {1000 * beyond:.0f} ms beyond NumPy")
    n = int(float(sys.argv[1])) if len(sys.argv) > 1 else 10_000_000
    x = np.random.default_rng(1).standard_normal(n)
    c = seconds(lambda: c_call(x), 9)[0]
    python = seconds(lambda: gyroakf.allan(x), 9)[0]
    print(
        f"oadev of {n} samples: C call {c:.4f} s, gyroakf.allan {python:.4f} s, {python / c:.3f} x"
    )
    print(f"{'':28} {'theirs':>11} {'gyroakf':>11} {'ratio':>10} {'difference':>10}")
    try:
        import allantools
    except ImportError:
        print("no allantools")
    else:
        for kind in gyroakf.allantools.__all__:
            row(
                f"allantools.{kind}",
                lambda kind=kind: getattr(allantools, kind)(x, 1.0, "freq"),
                lambda kind=kind: getattr(gyroakf.allantools, kind)(x, 1.0, "freq"),
                lambda curve: curve[1][:20],
            )
    try:
        from statsmodels.tsa.stattools import adfuller, kpss
    except ImportError:
        print("no statsmodels")
        return
    y = x[:20_000]
    row("adfuller, 2e4 samples", lambda: adfuller(y), lambda: gyroakf.adf(y), first)
    row("kpss, 2e4 samples", lambda: kpss(y, nlags=45), lambda: gyroakf.kpss(y, lags=45), first)


def first(test):
    return test[0] if isinstance(test, tuple) else test.statistic


main()
