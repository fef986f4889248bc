# SPDX-License-Identifier: MIT
"""Times statsmodels and this library on the same AR(1) series and prints ratios: compare.py PROGRAM THREADS [PART...]."""
import os
import resource
import statistics
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

# How many times as fast as the peer two of them are to be, and at how many samples
TARGETS = {"adf": ">= 200", "ar": ">= 20"}
TARGET_SAMPLES = {"adf": 100000, "ar": 10000000}
TITLES = {"adf": "Dickey-Fuller test with automatic lags", "ar": "AR orders 1 to 12 compared"}
LONGEST = 20.0  # seconds after which the peer is not called again


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


def in_turn(program, path, part, threads, call, small):
    """Both five times, one after the other; the peer less often where it is slow. Medians of each column."""
    x, mine, theirs = numpy.fromfile(path), {number: [] for number in threads}, []
    for _ in range(5):
        if sum(run[0] for run in theirs) < LONGEST:
            theirs.append(in_child(call, x))
        for number in threads:
            mine[number].append(ours(program, path, part, number))
    peer = [statistics.median(column) for column in zip(*theirs)]
    print(f"{part}, {small} samples: statsmodels {peer[0]:.3f} s (processor {peer[1]:.3f} s, median of {len(theirs)}), "
          f"{peer[2]:.1f} MB beyond the record")
    return peer, {number: middle(runs) for number, runs in mine.items()}


def middle(runs):
    return statistics.median(r[0] for r in runs), statistics.median(r[1] for r in runs), max(r[2] for r in runs), runs[0][3]


def figure(part, what, value, target):
    if part in TARGETS:
        print(f"figure: {TITLES[part]}: {what} | {value} | {target}")


def compare(program, part, threads):
    """Prints the lines of a part; whether the figures of both agree."""
    call, small, large, tolerance, power = PARTS[part]
    (wall, user, _, *figures), mine = in_turn(program, series(small), part, threads, call, small)
    agree = True
    for number, (seconds, used, kilobytes, found) in mine.items():
        line = f"  gyroakf, {number} thread(s): {1e3 * seconds:.2f} ms (processor {1e3 * used:.2f} ms), {kilobytes} kB beyond"
        line += f"; {wall / seconds:.0f} times faster, {user / used:.0f} times less processor time"
        if tolerance:
            off = max(abs(a - b) / max(1.0, abs(b)) for a, b in zip(found, figures))
            line += f"; largest difference {off:.1e}"
            agree = agree and off <= tolerance
        print(line)
        figure(part, f"times as fast as statsmodels, {small:.0e} samples, {number} thread(s)", f"{wall / seconds:.0f}",
               TARGETS.get(part) if small == TARGET_SAMPLES.get(part) else "-")
    for samples in large:
        path = series(samples)
        for number in threads:
            seconds, used, kilobytes, _ = middle([ours(program, path, part, number)])
            scaled = wall * (samples / small)**power / seconds
            print(f"  gyroakf, {number} thread(s), {samples} samples: {1e3 * seconds:.1f} ms "
                  f"(processor {1e3 * used:.1f} ms), {kilobytes} kB beyond the record; "
                  f"statsmodels, its {wall:.2f} s times ({samples // small})^{power}, {scaled:.0f} times as long")
            if samples == TARGET_SAMPLES.get(part):
                figure(part, f"times as fast as statsmodels (its time at {small:.0e} scaled), {samples:.0e} samples, "
                       f"{number} thread(s)", f"{scaled:.0f}", TARGETS.get(part))
            elif part == "adf":
                figure(part, f"seconds, {samples:.0e} samples, {number} thread(s)", f"{seconds:.2f}", "<= 10")
                figure(part, f"memory beyond the record, kB, {samples:.0e} samples, {number} thread(s)", kilobytes, "<= 10000")
    return agree


def main():
    program, threads, *wanted = sys.argv[1:]
    print(f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors")
    if not all([compare(program, part, threads.split()) for part in wanted or PARTS]):
        sys.exit("figures differ by more than they may")


main()
