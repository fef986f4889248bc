# SPDX-License-Identifier: MIT
"""Times allantools' statistics and this library's on the same white noise, in turn, and compares the numbers.

compare.py PROGRAM SAMPLES ROUNDS KIND...      ROUNDS 0: this library alone
"""
import os
import statistics
import subprocess
import sys
import tempfile
import time

import allantools
import numpy

program, samples, rounds, kinds = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4:]
rate = numpy.random.default_rng(1).normal(size=samples)
with tempfile.NamedTemporaryFile(suffix=".f64", dir="build", delete=False) as file:
    rate.tofile(file)


def ours(kind):
    """Of each number of threads: seconds, those of one read pass of one and of two threads, deviations; bytes at the peak."""
    out = subprocess.run([program, file.name, kind], check=True, capture_output=True, text=True).stdout
    *runs, memory = out.splitlines()
    return {int(line.split()[1]): [float(word) for word in line.split()[2:]] for line in runs}, int(memory)


def theirs(kind):
    start = time.perf_counter()
    _, deviation, _, _ = getattr(allantools, kind)(rate, rate=1.0, data_type="freq", taus="octave")
    return time.perf_counter() - start, deviation


def figure(kind, what, value, target):
    if kind == "oadev":
        print(f"figure: Allan deviation, octaves, {samples:.0e} samples: {what} | {value:.1f} | {target}")


def compare(kind):
    runs, waited, peaks = [], [], []
    for round_number in range(max(rounds, 1)):
        run, peak = ours(kind)
        runs.append(run)
        peaks.append(peak)
        if rounds and (round_number == 0 or sum(waited) < 90):
            seconds, deviation = theirs(kind)
            waited.append(seconds)
    peer = statistics.median(waited) if waited else None
    if peer:
        print(f"{kind}, {samples} samples, allantools {allantools.__version__}: {peer:.3f} s, median of {len(waited)}")
    else:
        print(f"{kind}, {samples} samples")
    for threads in (1, 2):
        seconds, pass_of_one, pass_of_two = (statistics.median(run[threads][i] for run in runs) for i in range(3))
        print(f"  gyroakf, {threads} thread(s): {seconds:.4f} s = {seconds / pass_of_one:.1f} read passes of one thread "
              f"({1e3 * pass_of_one:.2f} ms), {seconds / pass_of_two:.1f} of two ({1e3 * pass_of_two:.2f} ms)")
        if peer:
            difference = max(abs(a / b - 1) for a, b in zip(runs[0][threads][3:], deviation))
            print(f"    {peer / seconds:.1f} times faster, largest difference {difference:.1e}")
            figure(kind, f"times as fast as allantools, {('one thread', 'two threads')[threads - 1]}", peer / seconds,
                   (">= 15", ">= 25")[threads - 1])
    if samples <= 10**7:
        figure(kind, "two threads, read passes of one thread", seconds / pass_of_one, "<= 8" if samples == 10**7 else "-")
    else:
        figure(kind, "two threads, read passes of two threads", seconds / pass_of_two, "<= 30")
    print(f"  peak memory of the whole program: {max(peaks) / samples:.1f} bytes a sample")
    figure(kind, "memory, bytes a sample", max(peaks) / samples, "<= 20")


for kind in kinds:
    compare(kind)
os.unlink(file.name)
