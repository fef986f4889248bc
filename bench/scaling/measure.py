# SPDX-License-Identifier: MIT
"""Wall time and peak memory of two commands for records from 1e5 samples up: measure.py PROGRAM LARGEST

The file of each size is written, read by each command five times (a record of 1e8 samples once), and removed. Time and memory of a
record of 1000 samples, which any call takes, are taken off before exponents are fitted. The kernel's part of the processor time
is told apart. On a virtual machine it may have to ask the host for memory that was free for some seconds, ten times as slow as
clearing it: before each command another process touches as much memory as it needs, and its seconds are told.
"""
import math
import mmap
import os
import statistics
import subprocess
import sys
import time


def touch(megabytes):
    """Writes into each page of so much new memory and prints the seconds."""
    size = megabytes * 2**20
    with mmap.mmap(-1, size, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS) as memory:
        if hasattr(mmap, "MADV_HUGEPAGE"):
            memory.madvise(mmap.MADV_HUGEPAGE)
        start = time.perf_counter()
        memory[::mmap.PAGESIZE] = bytes(size // mmap.PAGESIZE)
        print(time.perf_counter() - start)


if sys.argv[1] == "--touch":
    sys.exit(touch(int(sys.argv[2])))
program, largest = sys.argv[1], int(sys.argv[2])
sizes = [10**k for k in range(5, 12) if 10**k <= largest]
targets = {"allan": (15, 20), "run": (60, 40)}  # seconds and bytes a sample at 1e8 samples


def write(samples):
    path = f"build/white_{samples}.txt"
    subprocess.run([program, "simulate", "--samples", str(samples), "--rate", "100", "--coefficients", "N=0.01,K=1e-4",
                    "--digits", "9", "--force", "--output", path], check=True)
    return path


def measure(command, path, times):
    """Of the process: seconds, those of the processors outside the kernel and inside (medians), and bytes (largest)."""
    seconds, own, kernel, peak = [], [], [], 0
    for _ in range(times):
        start = time.perf_counter()
        child = os.posix_spawn(program, [program, command, path, "--quiet"], os.environ,
                               file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)])
        _, status, usage = os.wait4(child, 0)
        seconds.append(time.perf_counter() - start)
        own.append(usage.ru_utime)
        kernel.append(usage.ru_stime)
        if status:
            sys.exit(f"{command} failed")
        peak = max(peak, usage.ru_maxrss * 1024)
    return statistics.median(seconds), statistics.median(own), statistics.median(kernel), peak


def exponent(points):
    """Slope of a line through logarithms."""
    x, y = [math.log(p[0]) for p in points], [math.log(max(p[1], 1e-9)) for p in points]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x)**2 for a in x)


def figure(command, what, value, target="-"):
    print(f"figure: gyroakf {command}, text: {what} | {value} | {target}")


base, found = {}, {command: [] for command in targets}
for samples in [1000] + sizes:
    path = write(samples)
    megabytes = os.path.getsize(path) / 1e6
    for command in targets:
        touched = float(subprocess.run([sys.executable, __file__, "--touch", str(1 + 40 * samples // 2**20)], check=True,
                                       capture_output=True).stdout)
        seconds, own, kernel, peak = measure(command, path, 1 if samples >= 10**8 else 5)
        if samples == 1000:
            base[command] = seconds, own, peak
            if len(base) == 1:
                print(f"{'samples':>12} {'MB':>8}  {'command':8}{'seconds':>9}{'own':>9}{'kernel':>9}{'touching':>9}{'peak MB':>9}"
                      f"{'bytes a sample':>16}")
            share = 0
        else:
            found[command].append((samples, seconds - base[command][0], own - base[command][1], peak - base[command][2]))
            share = (peak - base[command][2]) / samples
        print(f"{samples:12} {megabytes:8.1f}  {command:8}{seconds:9.3f}{own:9.3f}{kernel:9.3f}{touched:9.3f}"
              f"{peak / 1e6:9.1f}{share:16.1f}", flush=True)
        if samples == 10**8:
            figure(command, f"seconds, {samples:.0e} samples", f"{seconds:.1f}", f"<= {targets[command][0]}")
            figure(command, f"bytes a sample, {samples:.0e} samples", f"{share:.1f}", f"<= {targets[command][1]}")
    os.unlink(path)
for command, points in found.items():
    for what, column, target in (("time", 1, "<= 1.05"), ("processor time outside the kernel", 2, "-"), ("memory", 3, "<= 1.05")):
        steps = [exponent([(a[0], a[column]), (b[0], b[column])]) for a, b in zip(points, points[1:])]
        if not steps:
            continue
        whole = exponent([(point[0], point[column]) for point in points])
        print(f"{command}: {what} grows as n^{whole:.2f} from {sizes[0]:.0e} to {sizes[-1]:.0e}, from decade to decade as n^ "
              + ", ".join(f"{step:.2f}" for step in steps))
        if column != 2:
            figure(command, f"{what} grows as n to the power, {sizes[0]:.0e} to {sizes[-1]:.0e}", f"{whole:.2f}")
        figure(command, f"{what} grows as n to the power, {sizes[-2]:.0e} to {sizes[-1]:.0e}", f"{steps[-1]:.2f}", target)
