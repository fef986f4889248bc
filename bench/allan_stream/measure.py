# SPDX-License-Identifier: MIT
"""Wall time and peak memory of `gyroakf allan FILE --memory SIZE` as a process, from the file and through a pipe."""
import os
import subprocess
import sys
import time

program, path, memory = sys.argv[1:]


def measure(source, stdin):
    command = [program, "allan", source, "--quiet"]
    if memory != "none":
        command += ["--memory", memory]
    start = time.perf_counter()
    process = subprocess.Popen(command, stdin=stdin)
    _, status, usage = os.wait4(process.pid, 0)
    if status:
        sys.exit("failed")
    return time.perf_counter() - start, usage.ru_maxrss / 1000.0


seconds, megabytes = measure(path, None)
print(f"--memory {memory:6s} file {seconds:6.2f} s {megabytes:7.1f} MB", end="")
with open(path, "rb") as file:
    cat = subprocess.Popen(["cat"], stdin=file, stdout=subprocess.PIPE)
    seconds, megabytes = measure("-", cat.stdout)
print(f"   pipe {seconds:6.2f} s {megabytes:7.1f} MB")
