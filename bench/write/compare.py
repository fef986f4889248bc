# SPDX-License-Identifier: MIT
"""Times this library, pandas and NumPy writing the same numbers; medians of five (three for the slow ones)."""
import os
import subprocess
import sys
import time

import numpy
import pandas

program, samples = sys.argv[1], int(sys.argv[2])
rate = numpy.random.default_rng(1).normal(size=samples) * 0.01
rate.tofile("build/rate.bin")


def ours(target, digits=0):
    out = subprocess.run([program, "build/rate.bin", target, str(digits)], check=True, capture_output=True, text=True).stdout
    return float(out)


def theirs(write, rounds):
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        write()
        times.append(time.perf_counter() - start)
    return sorted(times)[rounds // 2]


def show(name, path, seconds, reference=None):
    size = os.path.getsize(path)
    ratio = "" if reference is None else f"  {seconds / reference:6.1f} times as long as gyroakf"
    print(f"  {name:<28} {seconds:8.3f} s  {size / seconds / 1e6:6.0f} MB/s{ratio}")


print(f"{samples} samples")
text = ours("build/ours.txt")
show("gyroakf, shortest digits", "build/ours.txt", text)
if not (numpy.loadtxt("build/ours.txt") == rate).all():
    sys.exit("the text does not read back as the same numbers")
show("gyroakf, 9 digits", "build/ours.txt", ours("build/ours.txt", 9))
show(f"pandas {pandas.__version__} to_csv", "build/theirs.txt",
     theirs(lambda: pandas.Series(rate).to_csv("build/theirs.txt", index=False, header=False), 3), text)
binary = ours("build/ours.npy")
show("gyroakf, .npy", "build/ours.npy", binary)
if not (numpy.load("build/ours.npy") == rate).all():
    sys.exit("the .npy file holds other numbers")
show("gyroakf, .f64", "build/ours.f64", ours("build/ours.f64"))
show(f"numpy {numpy.__version__} save", "build/theirs.npy", theirs(lambda: numpy.save("build/theirs.npy", rate), 5), binary)
for name in ("rate.bin", "ours.txt", "ours.npy", "ours.f64", "theirs.txt", "theirs.npy"):
    os.unlink("build/" + name)
