# SPDX-License-Identifier: MIT
"""Filters, likelihood and smoother beside statsmodels and filterpy: filters.py PROGRAM FOLDER STATE_SPACE."""
import os
import subprocess
import sys
import warnings

import numpy
import scipy.linalg
from filterpy.kalman import KalmanFilter
from statsmodels.tsa.statespace.initialization import Initialization
from statsmodels.tsa.statespace.kalman_smoother import KalmanSmoother
from table import Gyroakf, Table

warnings.simplefilter("ignore")


def paper_filter(gyroakf):
    """The fixed filter of an AR(p) state: from the program's series, against filterpy step by step and statsmodels."""
    path, x = gyroakf.record("ar2", "--samples", "5000", "--rate", "5", "--ar", "0.9,-0.3", "--ar-variance", "5e-4", "--seed", "41")
    table = Table("Kalman filter of an AR(p) state, 5,000 samples (seed 41); of series the sample that differs most, relative "
                  "to their deviation", "filterpy 1.4.5, statsmodels 0.15.0")
    z = x - x.mean()
    for order in (1, 2, 4):
        folder = os.path.join(gyroakf.folder, "filter")
        gyroakf.run("filter", path, "--rate", "5", "--order", str(order), "--quiet", "--series-format", "npy", "--out", folder,
                    "--force")
        found = gyroakf.results("filter", path, "--rate", "5", "--order", str(order))
        ours = numpy.load(os.path.join(folder, "series.npy"))[:, 3]
        kf = found["filters"]["kf"]
        phi = numpy.zeros((order, order))
        phi[0], phi[range(1, order), range(order - 1)] = found["ar"]["coefficients"], 1
        q = numpy.zeros((order, order))
        q[0, 0] = kf["q"]
        prior = scipy.linalg.solve_discrete_lyapunov(phi, q)
        theirs, nis, likelihood = by_filterpy(z, phi, q, kf["r"], prior)
        scale = numpy.std(theirs)
        table.row(f"AR({order}), filterpy: the filtered series", ours, theirs, scale=scale)
        table.row("mean squared innovation", kf["nis_mean"], nis)
        smoother = KalmanSmoother(k_endog=1, k_states=order)
        smoother.bind(z)
        smoother["design", 0, 0], smoother["transition"], smoother["selection"] = 1, phi, numpy.eye(order)
        smoother["state_cov"], smoother["obs_cov", 0, 0] = q, kf["r"]
        smoother.initialize_stationary()
        smoother.tolerance = 0
        theirs = smoother.filter()
        table.row("statsmodels: the filtered series", ours, theirs.filtered_state[0], scale=scale)
        table.row("filterpy's log-likelihood beside statsmodels'", likelihood, theirs.llf)


def by_filterpy(z, phi, q, r, prior):
    """The estimates, the mean squared innovation, the log-likelihood, step by step."""
    kf = KalmanFilter(dim_x=phi.shape[0], dim_z=1)
    kf.F, kf.Q, kf.P = phi, q, prior                       # its first step predicts: phi P phi' + Q is P again
    kf.H[0, 0], kf.R[0, 0] = 1, r
    x, nis, likelihood = numpy.empty_like(z), 0.0, 0.0
    for k, value in enumerate(z):
        kf.predict()
        kf.update(value)
        x[k] = kf.x[0, 0]
        s = kf.S[0, 0]
        nis += kf.y[0, 0]**2 / s
        likelihood -= (numpy.log(2 * numpy.pi * s) + kf.y[0, 0]**2 / s) / 2
    return x, nis / z.size, likelihood


MODELS = [
    ("AR(1)", [(0.98, 4e-6)], 4.2e-4),
    ("random walk", [(1.0, 1e-6)], 4.2e-4),
    ("AR(1), random walk", [(0.9, 2e-5), (1.0, 1e-6)], 1e-4),
    ("two AR(1)", [(0.7, 2e-5), (0.99, 2e-6)], 1e-4),
]


def drift(gyroakf, program):
    """Filter, likelihood and smoother of drift models, without and with missing samples."""
    path, x = gyroakf.record("drift", "--samples", "5000", "--rate", "1", "--ar", "0.98", "--ar-variance", "1e-4", "--seed", "42",
                             "--coefficients", "N=0.02,K=1e-3")
    table = Table("Filter, likelihood, smoother of a drift, 5,000 samples (seed 42); of series the sample that differs most, "
                  "relative to their deviation", "statsmodels 0.15.0")
    holed = x.copy()
    holed[[0, 1, 700, 4999]], holed[2000:2300] = numpy.nan, numpy.nan
    for name, processes, r in MODELS:
        for missing, series in (("", x), (", 304 samples missing", holed)):
            likelihood, filtered, innovation, smoothed, variance = ours_of(gyroakf, program, series, processes, r)
            theirs, diffuse = theirs_of(series, processes, r)
            here, scale = ~numpy.isnan(series), numpy.std(x)
            burn = numpy.flatnonzero(here)[0] if diffuse else -1
            after = numpy.arange(series.size) > burn
            standard = theirs.forecasts_error[0] / numpy.sqrt(theirs.forecasts_error_cov[0, 0])
            table.row(f"{name}{missing}: log-likelihood", likelihood, theirs.llf, "statsmodels gives the diffuse first sample "
                      "-ln(2 pi)/2, here it is given, not measured", theirs.llf + numpy.log(2 * numpy.pi) / 2)
            table.row("filtered", filtered[after], theirs.filtered_state.sum(axis=0)[after], scale=scale)
            table.row("innovations, normalized", innovation[after & here], standard[after & here], scale=1)
            table.row("smoothed", smoothed, theirs.smoothed_state.sum(axis=0), scale=scale)
            table.row("variance of the smoothed", variance, theirs.smoothed_state_cov.sum(axis=(0, 1)))
    filtered_record(gyroakf, path, x)


def ours_of(gyroakf, program, series, processes, r):
    """Log-likelihood, filtered, innovations, smoothed, variance."""
    source, target = (os.path.join(gyroakf.folder, name) for name in ("state_space.f64", "state_space.out"))
    series.tofile(source)
    subprocess.run([program, source, target, repr(r), *(repr(v) for pair in processes for v in pair)], check=True)
    found = numpy.fromfile(target)
    return found[0], *found[1:].reshape(4, -1)


def theirs_of(series, processes, r):
    """The smoother of statsmodels, its walk exactly diffuse; whether there is one."""
    n = len(processes)
    smoother = KalmanSmoother(k_endog=1, k_states=n)
    smoother.bind(series.copy())
    smoother["design"], smoother["selection"] = numpy.ones((1, n)), numpy.eye(n)
    smoother["transition"] = numpy.diag([phi for phi, _ in processes])
    smoother["state_cov"], smoother["obs_cov", 0, 0] = numpy.diag([q for _, q in processes]), r
    start = Initialization(n)
    for k, (phi, q) in enumerate(processes):
        if phi == 1:
            start.set(k, "diffuse")
        else:
            start.set(k, "known", constant=[0], stationary_cov=[[q / (1 - phi**2)]])
    smoother.initialize(start)
    smoother.tolerance = 0
    return smoother.smooth(), any(phi == 1 for phi, _ in processes)


def filtered_record(gyroakf, path, x):
    """What the program itself makes of the record: the likelihood it found, the filter it made."""
    table = Table("The program's own identification and drift filter on that record", "statsmodels 0.15.0")
    folder = os.path.join(gyroakf.folder, "filter")
    gyroakf.run("filter", path, "--rate", "1", "--quiet", "--series-format", "npy", "--out", folder, "--force")
    found = gyroakf.results("filter", path, "--rate", "1")
    drift = found["drift"]
    z = x - x.mean()
    theirs, diffuse = theirs_of(z, list(zip(drift["phi"], drift["q"])), drift["r"])
    chosen = [c for c in drift["candidates"] if c["chosen"]][0]
    table.row(f"{chosen['name']}: log-likelihood", chosen["log_likelihood"], theirs.llf, "as above",
              theirs.llf + (numpy.log(2 * numpy.pi) / 2 if diffuse else 0))
    slow = [k for k, is_slow in enumerate(drift["slow"]) if is_slow]
    ours = numpy.load(os.path.join(folder, "series.npy"))[1:, 7]
    table.row("drift_kf, filtered", ours, theirs.filtered_state[slow].sum(axis=0)[1:] + x.mean(), scale=x.std())


gyro = Gyroakf()
print("\n## Filters")
paper_filter(gyro)
drift(gyro, sys.argv[3])
Table.finish()
