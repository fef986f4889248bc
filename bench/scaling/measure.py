# SPDX-License-Identifier: MIT
"""Wall time and peak memory of two commands for records from 1e5 samples up: measure.py PROGRAM LARGEST

The file of each size is written, read by each command five times (a record of 1e8 samples once), and removed. Time and memory of a
record of 1000 samples, which any call takes, are taken off before exponents are fitted.
"""
import math
import os
import statistics
import subprocess
import sys
import time

program, largest = sys.argv[1], int(sys.argv[2])
sizes = [10**k for k in range(5, 12) if 10**k <= largest]
targets = {"allan": (15, 20), "run": (60, 40)}  # seconds and bytes a sample at 1e8 samples


def write(samples):
    path = f"build/white_{samples}.txt"
    subprocess.run([program, "simulate", "--samples", str(samples), "--rate", "100", "--coefficients", "N=0.01,K=1e-4",
                    "--digits", "9", "--force", "--output", path], check=True)
    return path


def measure(command, path, times):
    """Seconds (median) and bytes (largest) of the process."""
    seconds, peak = [], 0
    for _ in range(times):
        start = time.perf_counter()
        child = os.posix_spawn(program, [program, command, path, "--quiet"], os.environ,
                               file_actions=[(os.POSIX_SPAWN_OPEN, 1, os.devnull, os.O_WRONLY, 0)])
        _, status, usage = os.wait4(child, 0)
        seconds.append(time.perf_counter() - start)
        if status:
            sys.exit(f"{command} failed")
        peak = max(peak, usage.ru_maxrss * 1024)
    return statistics.median(seconds), peak


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
        seconds, peak = measure(command, path, 1 if samples >= 10**8 else 5)
        if samples == 1000:
            base[command] = seconds, peak
            print(f"{'samples':>12} {'MB':>8}  {'command':8}{'seconds':>9}{'peak MB':>9}{'bytes a sample':>16}")
        else:
            found[command].append((samples, seconds - base[command][0], peak - base[command][1]))
        share = (peak - base[command][1]) / samples
        print(f"{samples:12} {megabytes:8.1f}  {command:8}{seconds:9.3f}{peak / 1e6:9.1f}{share:16.1f}", flush=True)
        if samples == 10**8:
            figure(command, f"seconds, {samples:.0e} samples", f"{seconds:.1f}", f"<= {targets[command][0]}")
            figure(command, f"bytes a sample, {samples:.0e} samples", f"{share:.1f}", f"<= {targets[command][1]}")
    os.unlink(path)
for command, points in found.items():
    for what, column in (("time", 1), ("memory", 2)):
        steps = [exponent([(a[0], a[column]), (b[0], b[column])]) for a, b in zip(points, points[1:])]
        if not steps:
            continue
        whole = exponent([(point[0], point[column]) for point in points])
        print(f"{command}: {what} grows as n^{whole:.2f} from {sizes[0]:.0e} to {sizes[-1]:.0e}, from decade to decade as n^ "
              + ", ".join(f"{step:.2f}" for step in steps))
        figure(command, f"{what} grows as n to the power, {sizes[0]:.0e} to {sizes[-1]:.0e}", f"{whole:.2f}")
        figure(command, f"the same, {sizes[-2]:.0e} to {sizes[-1]:.0e}", f"{steps[-1]:.2f}", "<= 1.05")
