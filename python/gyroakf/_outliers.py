# SPDX-License-Identifier: MIT
"""Outliers and trend of a series."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Optional

import numpy as np

from . import _library as lib
from ._recording import Column, sampled
from ._results import Result


@dataclass(frozen=True, eq=False)
class Outliers(Result):
    """The outliers of a series.

    Attributes
    ----------
    inlier : numpy.ndarray of bool
        False: outlier or missing.
    removed : int
        Number of outliers.
    expected : float
        Expected false alarms in white normal noise of this length.
    threshold : float
        In standard deviations.
    mean, variance, corrected_variance : float
        Of the inliers less their trend; the last one of normal noise before its tails were cut off.
    rounds : int
        Iterations.
    converged : bool
        Whether the last iteration changed nothing.
    """

    inlier: np.ndarray
    removed: int
    expected: float
    threshold: float
    mean: float
    variance: float
    corrected_variance: float
    rounds: int
    converged: bool


def clean(
    data: Any,
    *,
    column: Optional[Column] = None,
    progress: Optional[lib.Progress] = None,
    **options: Any,
) -> np.ndarray:
    """The series without its outliers, which become NaN, and without its trend.

    Parameters
    ----------
    data, column, progress
        As of `allan`.
    **options
        Those of `mark_outliers`: ``method="none"`` removes the trend alone, ``degree=-1`` the
        outliers alone.

    Examples
    --------
    >>> import gyroakf
    >>> log = gyroakf.simulate(5000, n=0.005, offset=3, outliers=10, outlier_size=20)
    >>> cleaned = gyroakf.clean(log)
    >>> int(np.isnan(cleaned).sum()), bool(abs(np.nanmean(cleaned)) < 1e-6)
    (10, True)
    """
    x = sampled(data, None, column)[0]
    cleaned = np.empty_like(x)
    lib.process("clean", x, "outlier_options", progress, cleaned, None, **options)
    return cleaned


def mark_outliers(
    data: Any,
    *,
    column: Optional[Column] = None,
    method: Optional[str] = None,
    threshold: Optional[float] = None,
    rounds: Optional[int] = None,
    half_width: Optional[int] = None,
    degree: Optional[int] = None,
    progress: Optional[lib.Progress] = None,
) -> Outliers:
    """Mark the outliers of a series.

    Parameters
    ----------
    data, column, progress
        As of `allan`.
    method : {"auto", "pauta", "mad", "hampel", "none"}, optional
        The rule; "auto".
    threshold : float, optional
        In standard deviations; the method's own without it.
    rounds : int, optional
        Maximum number of iterations; 20.
    half_width : int, optional
        Samples on either side of Hampel's window; 25.
    degree : int, optional
        Degree of the trend that the outliers are about, -1 (mean or median) .. 9; 3.

    Examples
    --------
    >>> import gyroakf
    >>> found = gyroakf.mark_outliers(gyroakf.simulate(5000, n=0.005, outliers=10, outlier_size=20))
    >>> found.removed, int((~found.inlier).sum())
    (10, 10)
    """
    x = sampled(data, None, column)[0]
    inlier = np.zeros(x.size, np.int8)
    result = lib.TYPES["gyroakf_outliers"]()
    lib.process(
        "mark_outliers",
        x,
        "outlier_options",
        progress,
        inlier,
        result,
        method=method,
        threshold=threshold,
        rounds=rounds,
        half_width=half_width,
        degree=degree,
    )
    return Outliers(
        inlier.view(bool), **{**lib.members(result), "converged": bool(result.converged)}
    )
