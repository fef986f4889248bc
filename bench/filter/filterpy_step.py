# SPDX-License-Identifier: MIT
"""Time of predict + update of filterpy's KalmanFilter, one state, in nanoseconds a step (median of five)."""
import statistics
import time

import numpy as np
from filterpy.kalman import KalmanFilter

N = 20000
z = np.random.default_rng(1).standard_normal(N)
times = []
for _ in range(5):
    kf = KalmanFilter(dim_x=1, dim_z=1)
    kf.F[0, 0], kf.H[0, 0], kf.Q[0, 0], kf.R[0, 0] = 0.4, 1.0, 1.0, 1.2
    start = time.perf_counter()
    for value in z:
        kf.predict()
        kf.update(value)
    times.append((time.perf_counter() - start) / N * 1e9)
print(f"{statistics.median(times):.0f}")
