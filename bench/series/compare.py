# SPDX-License-Identifier: MIT
"""Times statsmodels and this library on the same AR(1) series and prints ratios: compare.py PROGRAM THREADS [PART...]."""
import os
import resource
import subprocess
import sys
import time
import warnings

import numpy
from scipy.signal import lfilter
from statsmodels.regression.linear_model import burg
from statsmodels.stats.diagnostic import acorr_ljungbox
from statsmodels.tsa.ar_model import ar_select_order
from statsmodels.tsa.stattools import adfuller, kpss

warnings.simplefilter("ignore")


def adf(x):
    found = adfuller(x)
    return found[0], found[2]


def orders(x):
    return (len(ar_select_order(x, 12, ic="aic").ar_lags or []),)


def burg_recursion(x):
    phi, _ = burg(x, 10)
    return phi[0], phi[1], phi[9]


def stationarity(x):
    found = kpss(x, nlags="auto")
    return found[0], found[2], found[1]


def ljung_box(x):
    return tuple(acorr_ljungbox(x, [20]).iloc[0])


# Part: the peer's call, how many samples it is given, how many this library alone is given, which figures agree to what, the
# power of the samples with which the peer's time grows: with it that time is scaled to the larger number, and said so.
# The peer's autocorrelation in ljung_box takes all lags directly.
PARTS = {
    "adf": (adf, 100000, [10000000], 1e-7, 1),
    "ar": (orders, 1000000, [10000000], None, 1),
    "burg": (burg_recursion, 10000000, [], 1e-7, 1),
    "kpss": (stationarity, 10000000, [], 1e-7, 1),
    "ljung_box": (ljung_box, 100000, [1000000], 1e-7, 2),
}


def series(samples):
    path = f"build/ar1_{samples}.f64"
    if not os.path.exists(path):
        noise = numpy.random.default_rng(1).normal(size=samples)
        lfilter([1.0], [1.0, -0.7], noise).tofile(path)
    return path


def ours(program, path, part, threads):
    out = subprocess.run([program, path, part, threads], check=True, capture_output=True, text=True).stdout.split()
    return float(out[0]), float(out[1]), int(out[2]), [float(v) for v in out[3:]]


def in_child(call, x):
    """Wall time, processor time, memory in MB and figures of a call, in a process of its own."""
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        before = resource.getrusage(resource.RUSAGE_SELF)
        start = time.perf_counter()
        figures = call(x)
        wall = time.perf_counter() - start
        after = resource.getrusage(resource.RUSAGE_SELF)
        memory = (after.ru_maxrss - before.ru_maxrss) / 1024
        os.write(write, " ".join(map(repr, [wall, after.ru_utime - before.ru_utime, memory, *map(float, figures)])).encode())
        os._exit(0)
    os.close(write)
    text = os.read(read, 4096).decode()
    os.waitpid(child, 0)
    return [float(v) for v in text.split()]


program, threads, *wanted = sys.argv[1:]
print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
agree = True
for part in wanted or PARTS:
    call, small, large, tolerance, power = PARTS[part]
    path = series(small)
    found = in_child(call, numpy.fromfile(path))
    wall, user, memory, figures = found[0], found[1], found[2], found[3:]
    print(f"{part}, {small} samples: statsmodels {wall:.3f} s (processor {user:.3f} s), {memory:.1f} MB beyond the record")
    for number in threads.split():
        seconds, used, kilobytes, mine = ours(program, path, part, number)
        line = f"  gyroakf, {number} thread(s): {1e3 * seconds:.2f} ms (processor {1e3 * used:.2f} ms), {kilobytes} kB beyond"
        line += f"; {wall / seconds:.0f} times faster, {user / used:.0f} times less processor time"
        if tolerance:
            off = max(abs(a - b) / max(1.0, abs(b)) for a, b in zip(mine, figures))
            line += f"; largest difference {off:.1e}"
            agree = agree and off <= tolerance
        print(line)
    for samples in large:
        path = series(samples)
        for number in threads.split():
            seconds, used, kilobytes, mine = ours(program, path, part, number)
            print(f"  gyroakf, {number} thread(s), {samples} samples: {1e3 * seconds:.1f} ms "
                  f"(processor {1e3 * used:.1f} ms), {kilobytes} kB beyond the record; "
                  f"statsmodels, its {wall:.2f} s times ({samples // small})^{power}, "
                  f"{wall * (samples / small)**power / seconds:.0f} times as long")
if not agree:
    sys.exit("figures differ by more than they may")
