# SPDX-License-Identifier: MIT
"""Wall time (median of 7) and largest memory of `gyroakf run`, `allan` and `inspect` on a file, for 1 and 2 threads."""
import os
import statistics
import sys
import time

program, path = sys.argv[1:]
with open(path, "rb") as file:
    samples = sum(1 for line in file if not line.startswith(b"#"))
size = os.path.getsize(path)
print(f"{os.path.basename(path)}: {samples} samples, {size / 1e6:.1f} MB")
for command in ("run", "allan", "inspect"):
    for threads in ("1", "2"):
        times, peak = [], 0
        for _ in range(7):
            start = time.perf_counter()
            child = os.posix_spawn(program, [program, command, path, "--threads", threads, "--quiet"], os.environ)
            _, status, usage = os.wait4(child, 0)
            times.append(time.perf_counter() - start)
            if status:
                sys.exit(f"{command} failed")
            peak = max(peak, usage.ru_maxrss * 1024)
        wall = statistics.median(times)
        print(f"  {command:8} {threads} thread(s) {wall:7.3f} s  {size / wall / 1e6:7.0f} MB/s  "
              f"{peak / 1e6:7.1f} MB  {peak / samples:6.1f} bytes a sample")
        if command == "run" and samples == 12000 and threads == "2":
            print(f"figure: gyroakf run, the example of 12000 samples, s | {wall:.3f} | <= 0.5")
