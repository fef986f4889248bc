# SPDX-License-Identifier: MIT
"""Times pandas, polars and this library reading the same one-column file; medians of five."""
import os
import subprocess
import sys
import time

import numpy
import pandas
import polars

program, samples = sys.argv[1], int(sys.argv[2])
rate = numpy.random.default_rng(1).normal(size=samples) * 0.01


def median(read):
    times = []
    for _ in range(5):
        start = time.perf_counter()
        column = read()
        times.append(time.perf_counter() - start)
    return sorted(times)[2], column


for form in ("%.8f", "%.18e"):
    path = f"build/rate{form.replace('%', '_')}.txt"
    numpy.savetxt(path, rate, fmt=form)
    size = os.path.getsize(path)
    seconds, count, total = subprocess.run([program, path], check=True, capture_output=True, text=True).stdout.split()
    ours, total = float(seconds), float(total)
    print(f"{samples} lines of {form}, {size / 1e6:.1f} MB")
    print(f"  gyroakf          {ours:8.4f} s  {size / ours / 1e6:6.0f} MB/s")
    for name, read in (
        (f"pandas {pandas.__version__}", lambda: pandas.read_csv(path, header=None)[0].to_numpy()),
        (f"polars {polars.__version__}", lambda: polars.read_csv(path, has_header=False).to_series(0).to_numpy()),
    ):
        theirs, column = median(read)
        if int(count) != len(column) or abs(column.sum() - total) > 1e-9:
            sys.exit(f"{name} reads other numbers: {len(column)} of sum {column.sum()}, not {count} of sum {total}")
        print(f"  {name:<16} {theirs:8.4f} s  {size / theirs / 1e6:6.0f} MB/s  {theirs / ours:6.2f} times as long as gyroakf")
    os.unlink(path)
