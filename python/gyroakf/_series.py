# SPDX-License-Identifier: MIT
"""Tests of stationarity and AR models of a series."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any, Dict, Optional

import numpy as np

from . import _library as lib
from ._recording import Column, sampled
from ._results import Result


@dataclass(frozen=True)
class ADFTest(Result):
    """Augmented Dickey-Fuller test; its null hypothesis is a unit root.

    Attributes
    ----------
    statistic, p_value : float
        Statistic, and the p-value of the unit root (MacKinnon).
    critical : dict
        Critical values by level, as ``critical["5%"]``.
    lag, observations : int
        Lags and observations in the regression.
    """

    statistic: float
    p_value: float
    critical: Dict[str, float]
    lag: int
    observations: int

    @property
    def stationary(self) -> bool:
        """Whether the unit root is rejected at 5 %."""
        return self.statistic < self.critical["5%"]


@dataclass(frozen=True)
class KPSSTest(Result):
    """KPSS test; its null hypothesis is stationarity.

    Attributes
    ----------
    statistic, p_value, p_asymptotic : float
        Statistic; p-value by the published table, 0.01 and 0.10 at its ends; p-value exact for a
        long series.
    critical : dict
        Critical values by level, as ``critical["5%"]``.
    variance, long_run_variance : float
        Of the residuals.
    drift : float
        Height of the line ("ct": parabola) that drifts as much.
    lags, observations : int
        Bandwidth, and samples present.
    p_bound : int
        -1: p is below `p_value`, 1: above it, 0: it is `p_value`.
    """

    statistic: float
    p_value: float
    p_asymptotic: float
    critical: Dict[str, float]
    variance: float
    long_run_variance: float
    drift: float
    lags: int
    observations: int
    p_bound: int

    @property
    def stationary(self) -> bool:
        """Whether stationarity is not rejected at 5 %."""
        return self.statistic <= self.critical["5%"]


@dataclass(frozen=True, eq=False)
class ARModel(Result):
    """Autoregressive model x_k - mean = sum phi_i (x_{k-i} - mean) + a_k.

    Attributes
    ----------
    order : int
        The order chosen.
    coefficients : numpy.ndarray
        phi_1, ..., phi_order.
    noise_variance, mean : float
        Variance of a, and mean of the series.
    """

    order: int
    coefficients: np.ndarray
    noise_variance: float
    mean: float


def _test(
    cls: Any,
    name: str,
    levels: Any,
    data: Any,
    column: Optional[Column],
    progress: Optional[lib.Progress],
    **given: Any,
) -> Any:
    x = sampled(data, None, column)[0]
    result = lib.TYPES[f"gyroakf_{name}"]()
    lib.process(f"{name}_test", x, f"{name}_options", progress, result, **given)
    return cls(**{**lib.members(result), "critical": dict(zip(levels, result.critical))})


def adf(
    data: Any,
    *,
    column: Optional[Column] = None,
    regression: Optional[str] = None,
    lags: Optional[int] = None,
    max_lags: Optional[int] = None,
    criterion: Optional[str] = None,
    progress: Optional[lib.Progress] = None,
) -> ADFTest:
    """Test for a unit root (augmented Dickey-Fuller).

    Parameters
    ----------
    data, column, progress
        As of `allan`.
    regression : {"n", "c", "ct", "ctt"}, optional
        Deterministic terms: none, constant (default), trend, quadratic trend.
    lags, max_lags : int, optional
        Lags of the regression, or the most that `criterion` chooses from.
    criterion : {"aic", "bic", "t"}, optional
        What chooses the lags; "aic".

    Examples
    --------
    >>> import gyroakf
    >>> test = gyroakf.adf(gyroakf.simulate(5000, n=0.005))
    >>> test.stationary, test.lag
    (True, 0)
    """
    result: ADFTest = _test(
        ADFTest,
        "adf",
        ("1%", "5%", "10%"),
        data,
        column,
        progress,
        regression=regression,
        lags=lags,
        max_lags=max_lags,
        criterion=criterion,
    )
    return result


def kpss(
    data: Any,
    *,
    column: Optional[Column] = None,
    regression: Optional[str] = None,
    lags: Optional[int] = None,
    rule: Optional[str] = None,
    progress: Optional[lib.Progress] = None,
) -> KPSSTest:
    """Test for stationarity (Kwiatkowski, Phillips, Schmidt, Shin).

    Parameters
    ----------
    data, column, progress
        As of `allan`.
    regression : {"c", "ct"}, optional
        Stationary about a level (default) or a line.
    lags : int, optional
        Bandwidth; by `rule` without it.
    rule : {"auto", "legacy"}, optional
        Bandwidth by Hobijn, Franses and Ooms (default), or floor(12 (n/100)^(1/4)).

    Examples
    --------
    >>> import gyroakf
    >>> gyroakf.kpss(gyroakf.simulate(5000, n=0.005)).stationary
    True
    """
    result: KPSSTest = _test(
        KPSSTest,
        "kpss",
        ("10%", "5%", "2.5%", "1%"),
        data,
        column,
        progress,
        regression=regression,
        lags=lags,
        rule=rule,
    )
    return result


def ar(
    data: Any,
    *,
    column: Optional[Column] = None,
    max_order: int = 12,
    order: Optional[int] = None,
    method: Optional[str] = None,
    criterion: Optional[str] = None,
    progress: Optional[lib.Progress] = None,
) -> ARModel:
    """Fit an autoregressive model.

    Parameters
    ----------
    data, column, progress
        As of `allan`.
    max_order : int
        Largest order that is compared, 0 .. 1000.
    order : int, optional
        This order; by `criterion` without it.
    method : {"yw", "burg", "ols"}, optional
        Yule-Walker (default), Burg, or least squares with intercept.
    criterion : {"aic", "aicc", "bic", "hqic", "fpe"}, optional
        What chooses the order; "aic".

    Examples
    --------
    >>> import gyroakf
    >>> model = gyroakf.ar(gyroakf.simulate(preset="paper"), max_order=3)
    >>> model.order, model.coefficients.round(3).tolist()
    (2, [0.384, 0.02])
    """
    x = sampled(data, None, column)[0]
    if order is not None:
        max_order = max(max_order, order)
    chosen, variance, mean = ctypes.c_int32(), ctypes.c_double(), ctypes.c_double()
    limit = lib.integer(max_order, ctypes.c_int32, "max_order")
    phi = np.zeros(min(max(max_order, 0), 1000))
    with lib.watch(progress) as callback:
        opt = lib.options(
            "ar_options", method=method, criterion=criterion, order=order, progress=callback
        )
        lib.call(
            "ar_fit",
            lib.address(x),
            x.size,
            ctypes.byref(opt),
            limit,
            ctypes.byref(chosen),
            lib.address(phi),
            ctypes.byref(variance),
            ctypes.byref(mean),
        )
    return ARModel(chosen.value, phi[: chosen.value], variance.value, mean.value)
