# SPDX-License-Identifier: MIT
"""Reads binary files with gyroakf and with numpy in one run: compare.py PROGRAM SAMPLES"""
import os
import statistics
import subprocess
import sys
import time

import numpy as np


def timed(call):
    seconds = []
    for _ in range(5):
        start = time.perf_counter()
        array = call()
        seconds.append(time.perf_counter() - start)
    return statistics.median(seconds), array


def main():
    program, samples = sys.argv[1], int(sys.argv[2])
    folder = os.path.join(os.path.dirname(os.path.abspath(__file__)), "build")
    x = np.random.default_rng(1).normal(size=samples)
    three = x[: samples // 3 * 3].reshape(-1, 3)
    counts = (x * 1000).astype("i2")
    cases = [
        ("f64", "f64", "f64", 0, "", x.tofile, lambda p: np.fromfile(p, "<f8")),
        ("npy, float64", "npy", "npy", 0, "", lambda p: np.save(p, x), np.load),
        ("npy, float32", "npy", "npy", 0, "", lambda p: np.save(p, x.astype("f4")), lambda p: np.load(p).astype("f8")),
        ("i16", "i16", "i16", 0, "", counts.tofile, lambda p: np.fromfile(p, "<i2").astype("f8")),
        ("i16be", "i16be", "i16be", 0, "", counts.astype(">i2").tofile, lambda p: np.fromfile(p, ">i2").astype("f8")),
        ("f64, 3 channels", "f64", "f64", 3, "", three.tofile, lambda p: np.fromfile(p, "<f8").reshape(-1, 3).T.copy()),
        ("f64, 1 of 3 channels", "f64", "f64", 3, "2", three.tofile, lambda p: np.fromfile(p, "<f8").reshape(-1, 3)[:, 1].copy()),
        ("npy, by columns, 1 of 3", "npy", "npy", 0, "2", lambda p: np.save(p, np.asfortranarray(three)),
         lambda p: np.load(p)[:, 1].copy()),
    ]
    print(f"{'':24} {'MB':>6} {'rows':>8} {'GB/s':>6} {'record':>8} {'GB/s':>6} {'numpy':>8} {'GB/s':>6}  B/sample")
    for name, ending, form, channels, column, write, read in cases:
        path = os.path.join(folder, "speed." + ending)
        write(path)
        size = os.path.getsize(path)
        peer, array = timed(lambda: read(path))
        del array
        command = [program, path, form, str(channels)] + ([column] if column else [])
        done = subprocess.run(command, capture_output=True, text=True, check=True)
        rows, whole, count, _ = done.stdout.split()
        memory = subprocess.run(["/usr/bin/time", "-f", "%M"] + command, capture_output=True, text=True).stderr.split()[-1] \
            if os.path.exists("/usr/bin/time") else "0"
        rows, whole = float(rows), float(whole)
        values = int(count) * (3 if channels == 3 and not column else 1)
        print(f"{name:24} {size/1e6:6.0f} {rows:8.3f} {size/rows/1e9:6.2f} {whole:8.3f} {size/whole/1e9:6.2f} {peer:8.3f} "
              f"{size/peer/1e9:6.2f}  {int(memory)*1024/values:6.1f}")
        os.remove(path)


main()
