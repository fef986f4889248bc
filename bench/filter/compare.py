# SPDX-License-Identifier: MIT
"""Nanoseconds a step of filterpy's KalmanFilter and of statsmodels' state-space Kalman filter, one state, medians of five."""
import statistics
import time

import numpy
from filterpy.kalman import KalmanFilter
from statsmodels.tsa.statespace.kalman_filter import KalmanFilter as StateSpaceFilter

PHI, Q, R, RUNS = 0.4, 1.0, 1.2, 5


def filterpy_steps(z):
    kf = KalmanFilter(dim_x=1, dim_z=1)
    kf.F[0, 0], kf.H[0, 0], kf.Q[0, 0], kf.R[0, 0] = PHI, 1.0, Q, R
    for value in z:
        kf.predict()
        kf.update(value)
    return kf.x[0, 0]


def statsmodels_series(z):
    kf = StateSpaceFilter(k_endog=1, k_states=1)
    kf.bind(z)
    kf["design", 0, 0], kf["transition", 0, 0], kf["selection", 0, 0] = 1.0, PHI, 1.0
    kf["state_cov", 0, 0], kf["obs_cov", 0, 0] = Q, R
    kf.initialize_stationary()
    return kf.filter().filtered_state[0, -1]


def report(name, call, samples):
    z = numpy.random.default_rng(1).standard_normal(samples)
    times = []
    for _ in range(RUNS):
        start = time.process_time()
        last = call(z)
        times.append((time.process_time() - start) / samples * 1e9)
    print(f"{name:<30}{statistics.median(times):9.1f}{min(times):9.1f}   last {last:.6f}")


report("filterpy, step by step", filterpy_steps, 20_000)
report("statsmodels, a series", statsmodels_series, 1_000_000)
