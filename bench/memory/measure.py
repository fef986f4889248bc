# SPDX-License-Identifier: MIT
"""Peak memory of every command: measure.py PROGRAM FILE SAMPLES SMALL-FILE"""
import os
import sys

program, path, samples, small = sys.argv[1], sys.argv[2], int(sys.argv[3]), sys.argv[4]
limits = {"inspect": 10, "allan": 20, "run": 40}  # bytes a sample that are aimed at; inspect is what reading takes


def peak(command, file, *options):
    """Megabytes of the process at its largest, and its wall time in seconds."""
    pid = os.posix_spawn(program, [program, command, file, "--quiet", *options], os.environ)
    start = os.times().elapsed
    _, status, usage = os.wait4(pid, 0)
    if status:
        sys.exit(f"{command} failed")
    return usage.ru_maxrss * 1024e-6, os.times().elapsed - start


print(f"{samples} samples, {os.path.getsize(path) * 1e-6:.0f} MB of text")
print(f"{'':18}{'peak MB':>9}{'bytes a sample':>16}{'seconds':>9}")
for command in ("inspect", "allan", "tests", "ar", "filter", "run"):
    alone, _ = peak(command, small)
    used, seconds = peak(command, path)
    share = (used - alone) * 1e6 / samples
    asked = f"   (at most {limits[command]})" if command in limits else ""
    print(f"{command:18}{used:9.1f}{share:16.1f}{seconds:9.2f}{asked}")
