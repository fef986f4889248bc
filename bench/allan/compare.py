# SPDX-License-Identifier: MIT
"""Times allantools' statistics and this library's on the same white noise, and compares the numbers."""
import os
import subprocess
import sys
import tempfile
import time

import allantools
import numpy

program, samples, kinds = sys.argv[1], int(sys.argv[2]), sys.argv[3:]
rate = numpy.random.default_rng(1).normal(size=samples)
with tempfile.NamedTemporaryFile(suffix=".f64", dir="build", delete=False) as file:
    rate.tofile(file)
out = subprocess.run([program, file.name, *kinds], check=True, capture_output=True, text=True).stdout
os.unlink(file.name)
*runs, memory = out.splitlines()
for kind in kinds:
    times = []
    for _ in range(3):
        start = time.perf_counter()
        taus, deviation, _, _ = getattr(allantools, kind)(rate, rate=1.0, data_type="freq", taus="octave")
        times.append(time.perf_counter() - start)
        if times[0] > 60:
            break
    theirs = sorted(times)[len(times) // 2]
    print(f"{kind}, {samples} samples, allantools {allantools.__version__}: {theirs:.3f} s")
    for line in runs:
        name, threads, *figures = line.split()
        if name != kind:
            continue
        seconds, pass_of_one, pass_of_two, *found = map(float, figures)
        difference = max(abs(a / b - 1) for a, b in zip(found, deviation))
        print(
            f"  gyroakf, {threads} thread(s): {seconds:.4f} s, {theirs / seconds:.1f} times faster, "
            f"largest difference {difference:.1e}"
        )
        print(
            f"    = {seconds / pass_of_one:.1f} read passes of one thread ({1e3 * pass_of_one:.2f} ms), "
            f"{seconds / pass_of_two:.1f} of two ({1e3 * pass_of_two:.2f} ms)"
        )
print(f"peak memory of the whole program: {int(memory) / samples:.1f} bytes a sample")
