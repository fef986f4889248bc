# SPDX-License-Identifier: MIT
"""Times pandas, polars and this library reading the same file, in turn in one run: medians of five; and this library's memory."""
import os
import subprocess
import sys
import time

import numpy
import pandas
import polars

program, samples = sys.argv[1], int(sys.argv[2])
rate = numpy.random.default_rng(1).normal(size=samples) * 0.01
# How a number is written, how many columns, and how many times as fast as pandas and polars it is to be read
cases = (("%.8f", 1, (">= 2", ">= 1.5")), ("%.18e", 1, (">= 1.2", ">= 1.2")), ("%.8f", 3, ("-", "-")))


def write(path, form, columns):
    with open(path, "w", buffering=1 << 22) as file:
        for first in range(0, samples, 1 << 18):
            part = rate[first:first + (1 << 18)]
            row = ",".join([form] * columns) + "\n"
            file.write((row * len(part)) % tuple(numpy.repeat(part, columns).tolist()))


def ours(path, column):
    run = subprocess.run([program, path, column], check=True, capture_output=True, text=True).stdout.split()
    return float(run[0]), int(run[1]), float(run[2]), float(run[3])


def timed(read):
    start = time.perf_counter()
    values = read()
    return time.perf_counter() - start, values


def median(times):
    return sorted(times)[len(times) // 2]


for form, columns, targets in cases:
    path = f"build/rate{form.replace('%', '_')}_{columns}.txt"
    write(path, form, columns)
    size = os.path.getsize(path)
    last = columns - 1
    peers = {
        f"pandas {pandas.__version__}": lambda: pandas.read_csv(path, header=None, usecols=[last], engine="c").iloc[:, 0].to_numpy(),
        f"polars {polars.__version__}": lambda: polars.read_csv(path, has_header=False, columns=[last]).to_series(0).to_numpy(),
    }
    times = {name: [] for name in peers}
    mine = []
    for _ in range(5):
        seconds, count, total, memory = ours(path, str(columns))
        mine.append(seconds)
        for name, read in peers.items():
            seconds, values = timed(read)
            times[name].append(seconds)
            if count != len(values) or abs(values.sum() - total) > 1e-9 * samples:
                sys.exit(f"{name} reads other numbers: {len(values)} of sum {values.sum()}, not {count} of sum {total}")
    what = "" if columns == 1 else f", one of {columns} columns"
    print(f"{samples} lines of {form}{what}, {size / 1e6:.1f} MB; peak memory {memory / samples:.2f} bytes a sample")
    best = median(mine)
    print(f"  gyroakf          {best:8.4f} s  {size / best / 1e6:6.0f} MB/s")
    print(f"figure: reading {samples:.0e} lines of {form}{what}: memory, bytes a sample | {memory / samples:.1f} | -")
    for name, target in zip(peers, targets):
        theirs = median(times[name])
        print(f"figure: reading {samples:.0e} lines of {form}{what}: times as fast as {name.split()[0]} | {theirs / best:.2f} | {target}")
        print(f"  {name:<16} {theirs:8.4f} s  {size / theirs / 1e6:6.0f} MB/s  {theirs / best:6.2f} times as long as gyroakf")
    os.unlink(path)
