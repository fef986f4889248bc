# SPDX-License-Identifier: MIT
"""Tests of a series and AR models beside statsmodels, arch and SciPy: series.py PROGRAM FOLDER."""
import csv
import os
import warnings

import numpy
import scipy.signal
import scipy.stats
from arch.unitroot import ADF, KPSS
from arch.utility.exceptions import InfeasibleTestException
from statsmodels.regression.linear_model import burg, yule_walker
from statsmodels.stats.diagnostic import acorr_ljungbox, normal_ad
from statsmodels.tsa.adfvalues import mackinnoncrit, mackinnonp
from statsmodels.tsa.ar_model import AutoReg
from statsmodels.tsa.stattools import acf, adfuller, kpss, pacf
from table import Gyroakf, Table

warnings.simplefilter("ignore")
RATE = ["--rate", "5"]


def records(gyroakf):
    """Name: path and numbers."""
    paper = ["--samples", "2000", "--rate", "5", "--ar", "0.41", "--ar-variance", "5e-4"]
    return {
        "AR(1)": gyroakf.record("ar1", *paper, "--seed", "31"),
        "random walk": gyroakf.record("walk", "--samples", "2000", "--rate", "5", "--seed", "32", "--coefficients", "K=1"),
        "AR(1) on an offset of 1e6": gyroakf.record("offset", *paper, "--seed", "33", "--offset", "1e6"),
    }


def unit_root(gyroakf, series):
    """ADF with every deterministic part and every rule for the lags."""
    for name, (path, x) in series.items():
        table = Table(f"Dickey-Fuller, {name}: the statistic; the difference is the largest of lags, statistic, p, critical value",
                      "statsmodels 0.15.0, arch 8.0.0")
        for regression in ("n", "c", "ct", "ctt"):
            for criterion, word in (("aic", "AIC"), ("bic", "BIC"), ("t", "t-stat")):
                if criterion != "aic" and regression != "c":
                    continue
                adf = gyroakf.results("tests", path, *RATE, "--adf-regression", regression, "--adf-criterion", criterion)
                adf = adf["tests"]["adf"]
                ours = adf["lag"], adf["statistic"], above(adf["p_value"]), adf["critical"]["5%"]
                careful = by_legendre(x, regression, adf["lag"])
                theirs = ask_statsmodels(x, regression, word)
                table.row(f"{regression}, {word}, statsmodels", ours, theirs, ADF_REASON, careful, show=1)
                theirs = ask_arch(x, regression, word)
                table.row(f"{regression}, {word}, arch", ours, theirs, ADF_REASON if theirs[0] == theirs[0] else
                          "arch refuses (InfeasibleTestException); as above", careful, show=1)


ADF_REASON = ("the peer's columns 1, t, t^2 and the level are nearly dependent; by QR with Legendre polynomials, the offset "
              "subtracted")


def above(p):
    """A probability, 0 where it is below 1e-20: there the response surface ends."""
    return p if p >= 1e-20 else 0.0


def by_legendre(x, regression, lags):
    """Lags, statistic, p and critical value of a regression on well-conditioned columns."""
    y = x - (round(x.mean()) if regression != "n" else 0)
    dy = numpy.diff(y)
    rows = numpy.arange(lags, dy.size)
    t = 2 * rows / rows.max() - 1
    degree = {"n": -1, "c": 0, "ct": 1, "ctt": 2}[regression]
    columns = [numpy.polynomial.legendre.legval(t, numpy.eye(degree + 1)[k]) for k in range(degree + 1)]
    columns += [dy[rows - k] for k in range(1, lags + 1)] + [y[rows]]       # the level last: it is the last row of R
    q, r = numpy.linalg.qr(numpy.transpose(columns))
    u = q.T @ dy[rows]
    s2 = (dy[rows] @ dy[rows] - u @ u) / (rows.size - len(columns))
    statistic = u[-1] / numpy.sqrt(s2) * numpy.sign(r[-1, -1])
    return lags, statistic, above(mackinnonp(statistic, regression)), mackinnoncrit(1, regression, rows.size)[1]


def ask_statsmodels(x, regression, word):
    """Lags, statistic, p, critical value at 5 %."""
    found = adfuller(x, regression=regression, autolag=word, result_object=False)
    return found[2], found[0], above(found[1]), found[4]["5%"]


def ask_arch(x, regression, word):
    """The same of arch."""
    found = ADF(x, trend=regression, method=word.lower(), low_memory=False)
    try:
        return found.lags, found.stat, above(found.pvalue), found.critical_values["5%"]
    except InfeasibleTestException:
        return (numpy.nan,) * 4


OFFSET = "the peer loses digits to the offset: of x - 1e6, which is exact, it gives"


def without_offset(x):
    """The same numbers less a whole number that the subtraction rounds nothing of."""
    return x - (round(x.mean()) if abs(x.mean()) > 1e3 * x.std() else 0)


def stationarity(gyroakf, series):
    """KPSS."""
    simulated = "arch takes p from a table of 100,000 simulated series, which ends at 1e-4; ours is the exact limit distribution"
    for name, (path, x) in series.items():
        table = Table(f"KPSS, {name}", "statsmodels 0.15.0, arch 8.0.0")
        y = without_offset(x)
        for regression in ("c", "ct"):
            ours = gyroakf.results("tests", path, *RATE, "--kpss-regression", regression)["tests"]["kpss"]
            lags = ours["lags"]
            theirs, again = (kpss(z, regression, nlags="auto", result_object=False) for z in (x, y))
            table.row(f"KPSS {regression}, statsmodels: lags", lags, theirs[2])
            table.row("statistic", ours["statistic"], theirs[0], OFFSET, again[0])
            table.row("p of the table", ours["p_value"], theirs[1])
            theirs, again = (KPSS(z, trend=regression, lags=lags) for z in (x, y))
            table.row(f"KPSS {regression}, arch: statistic", ours["statistic"], theirs.stat, OFFSET, again.stat)
            table.row("p", ours["p_asymptotic"], theirs.pvalue, simulated)


def distribution(gyroakf, series):
    """Normality, whiteness, correlation, spectra."""
    for name, (path, x) in series.items():
        folder = os.path.join(gyroakf.folder, "tests")
        gyroakf.run("tests", path, *RATE, "--quiet", "--out", folder, "--force")
        ours = gyroakf.results("tests", path, *RATE)["tests"]
        table = Table(f"Distribution, correlation, spectrum, {name}", "statsmodels 0.15.0, SciPy 1.17")
        y = without_offset(x)
        normal_rows(table, ours, x, y)
        boxes, again = (acorr_ljungbox(z, [20]).iloc[0] for z in (x, y))
        table.row("Ljung-Box, 20 lags, statsmodels", ours["ljung_box"]["statistic"], boxes["lb_stat"], OFFSET, again["lb_stat"])
        table.row("its p", ours["ljung_box"]["p_value"], boxes["lb_pvalue"], OFFSET, again["lb_pvalue"])
        lags = columns(os.path.join(folder, "correlation.csv"))
        table.row("autocorrelations 1 .. 20, statsmodels", lags["acf"], *two(lambda z: acf(z, nlags=20, fft=False)[1:], x, y))
        table.row("partial ones, statsmodels `ldb`", lags["pacf"], *two(lambda z: pacf(z, nlags=20, method="ldb")[1:], x, y))
        spectrum_rows(table, ours, columns(os.path.join(folder, "spectrum.csv")), y)


def two(call, x, y):
    """Theirs, the reason, theirs without the offset."""
    return call(x), OFFSET, call(y)


def normal_rows(table, ours, x, y):
    """Jarque-Bera, Anderson-Darling."""
    bera = ours["jarque_bera"]
    table.row("Jarque-Bera, SciPy", bera["statistic"], *two(lambda z: scipy.stats.jarque_bera(z).statistic, x, y))
    table.row("its p", bera["p_value"], *two(lambda z: scipy.stats.jarque_bera(z).pvalue, x, y))
    table.row("skewness", bera["skewness"], *two(scipy.stats.skew, x, y))
    table.row("kurtosis", bera["kurtosis"], *two(lambda z: scipy.stats.kurtosis(z, fisher=False), x, y))
    darling = ours["anderson_darling"]
    table.row("Anderson-Darling, statsmodels", darling["statistic"], *two(lambda z: normal_ad(z)[0], x, y))
    table.row("SciPy", darling["statistic"], *two(lambda z: scipy.stats.anderson(z, "norm").statistic, x, y))
    p, again = normal_ad(x)[1], normal_ad(y)[1]
    table.row("its p", darling["p_value"], p, OFFSET if p > 0 else "statsmodels ends at 0", again if p > 0 else None,
              tolerance=1e-9 if p > 0 else 0)


def spectrum_rows(table, ours, spectrum, x):
    """Welch's spectrum and the largest line of the periodogram."""
    segment = ours["welch"]["segment_samples"]
    welch = dict(fs=5, window="hann", nperseg=segment, noverlap=segment // 2)
    _, theirs = scipy.signal.welch(x, **welch)
    table.row("Welch's spectrum, SciPy (ten digits are written)", spectrum["density_one_sided"], theirs)
    if ours["fisher_g"]["applied_to"] == "the series":
        _, power = scipy.signal.periodogram(x)
        power = power[1:(x.size - 1) // 2 + 1]
        table.row("Fisher's g, SciPy's periodogram", ours["fisher_g"]["statistic"], power.max() / power.sum())


def columns(path):
    """Column name: numbers of a result file."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {name: numpy.array([float(row[name]) for row in rows]) for name in rows[0] if name != "channel"}


def models(gyroakf, series):
    """AR models of order 3 by every method that has a peer."""
    path, x = series["AR(1)"]
    table = Table("AR(3), AR(1)", "statsmodels 0.15.0")
    ours = gyroakf.results("ar", path, *RATE, "--order", "3", "--max-order", "3")["ar"]
    phi, sigma = yule_walker(x, 3, method="mle")
    table.row("Yule-Walker, method='mle': phi", ours["coefficients"], phi)
    table.row("its noise variance", ours["noise_variance"], sigma**2)
    default, _ = yule_walker(x, 3)
    table.row("Yule-Walker, statsmodels' default: phi", ours["coefficients"], default,
              "statsmodels' default divides the sum at lag k by n - k ('adjusted'), which need not be stationary; method='mle' "
              "by n", phi)
    ours = gyroakf.results("ar", path, *RATE, "--order", "3", "--max-order", "3", "--ar-method", "burg")["ar"]
    phi, sigma2 = burg(x, 3)
    table.row("Burg: phi", ours["coefficients"], phi)
    table.row("its residual variance", ours["residual_variance"], sigma2)
    ours = gyroakf.results("ar", path, *RATE, "--order", "3", "--max-order", "3", "--ar-method", "ols")["ar"]
    fit = AutoReg(x, 3, trend="c").fit()
    table.row("least squares: phi", ours["coefficients"], fit.params[1:])
    table.row("its intercept", ours["intercept"], fit.params[0])
    table.row("its standard errors", ours["std_errors"], fit.bse[1:])
    table.row("its noise variance", ours["noise_variance"], fit.sigma2)
    table.row("its AIC", ours["table"][3]["aic"], fit.aic)
    table.row("its BIC", ours["table"][3]["bic"], fit.bic)
    residual = acorr_ljungbox(fit.resid, [20], model_df=3).iloc[0]
    table.row("Ljung-Box of its residuals, p with 17 degrees of freedom", ours["residual_ljung_box"]["p_value"],
              residual["lb_pvalue"])


program = Gyroakf()
print("\n## Tests and models of a series\n")
data = records(program)
print("2,000 samples at 5 Hz: AR(1) with phi 0.41 (seed 31), a random walk (32), AR(1) with an offset of 1e6, forty million "
      "times its scatter (33).")
unit_root(program, data)
stationarity(program, data)
distribution(program, data)
models(program, data)
Table.finish()
