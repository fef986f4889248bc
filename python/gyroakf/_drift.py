# SPDX-License-Identifier: MIT
"""The drift of a recording: model, filter, smoother."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any, Optional, Tuple

import numpy as np

from . import _library as lib
from ._filters import Filter
from ._recording import Column, sampled
from ._results import Result


@dataclass(frozen=True)
class DriftModel(Result):
    """Drift and noise: x_{i,k} = phi_i x_{i,k-1} + w_{i,k}, z_k = sum x_{i,k} + v_k.

    Attributes
    ----------
    phi, q : tuple of float
        Coefficient of each process (1: a random walk) and variance of its w.
    r : float
        Variance of the white noise v.
    slow : tuple of bool
        Whether a process is part of the drift.
    """

    phi: Tuple[float, ...]
    q: Tuple[float, ...]
    r: float
    slow: Tuple[bool, ...]

    def _struct(self) -> Any:
        model = lib.options("drift_model", r=self.r)
        if not len(self.phi) == len(self.q) == len(self.slow) <= 3:
            raise ValueError("`phi`, `q` and `slow` must have the same length, at most 3")
        model.count = len(self.phi)
        for i, (phi, q, slow) in enumerate(zip(self.phi, self.q, self.slow)):
            model.phi[i], model.q[i], model.slow[i] = phi, q, int(slow)
        return model

    def filter(self, **options: Any) -> Filter:
        """A filter whose estimate is the drift; options of `Filter`, only R can be adapted."""
        model = ctypes.byref(self._struct())
        return Filter.__new__(Filter)._own(
            lib.new(
                "filter",
                "drift_filter_new",
                model,
                ctypes.byref(lib.options("filter_options", **options)),
            )
        )

    def smooth(
        self,
        z: Any,
        *,
        column: Optional[Column] = None,
        progress: Optional[lib.Progress] = None,
        **options: Any,
    ) -> "Smoothed":
        """The drift of a recording (fixed-interval smoother); `Filter` options adapt R."""
        x = sampled(z, None, column)[0]
        drift, variance = np.empty_like(x), np.empty_like(x)
        with lib.watch(progress) as callback:
            lib.call(
                "drift_smooth_watched",
                ctypes.byref(self._struct()),
                lib.address(x),
                x.size,
                lib.address(drift),
                lib.address(variance),
                ctypes.byref(lib.options("filter_options", **options)),
                callback,
                None,
            )
        return Smoothed(drift, variance)


@dataclass(frozen=True, eq=False)
class Smoothed(Result):
    """The drift of a recording.

    Attributes
    ----------
    drift, variance : numpy.ndarray
        The drift, and the variance of its error under the model.
    """

    drift: np.ndarray
    variance: np.ndarray

    def plot(self, ax: Any = None) -> Any:
        """Draws the drift and its standard deviation over the samples; returns the axes."""
        ax = self._axes(ax, "sample", "drift")
        deviation = np.sqrt(self.variance)
        ax.plot(self.drift)
        ax.fill_between(
            np.arange(self.drift.size), self.drift - deviation, self.drift + deviation, alpha=0.3
        )
        return ax


def identify_drift(
    data: Any,
    *,
    column: Optional[Column] = None,
    drift_samples: Optional[float] = None,
    most_samples: Optional[int] = None,
    progress: Optional[lib.Progress] = None,
) -> DriftModel:
    """Identify drift and white noise of a recording at rest by maximum likelihood.

    Parameters
    ----------
    data, column, progress
        As of `allan`; at least 50 samples.
    drift_samples : float, optional
        Correlation time in samples from which a process is part of the drift; 5.
    most_samples : int, optional
        Maximum number of samples in the likelihood; 131072.

    Examples
    --------
    >>> import gyroakf
    >>> log = gyroakf.simulate(20000, rate=10, n=0.005, k=5e-4, seed=3)
    >>> model = gyroakf.identify_drift(log)
    >>> model.phi, model.slow
    ((1.0,), (True,))
    >>> compensated = log["gx"] - model.smooth(log).drift
    """
    x = sampled(data, None, column)[0]
    model = lib.options("drift_model")
    given = {"drift_samples": drift_samples, "most_samples": most_samples}
    lib.process("drift_identify", x, "drift_options", progress, model, **given)
    n = model.count
    return DriftModel(
        tuple(model.phi[:n]), tuple(model.q[:n]), model.r, tuple(map(bool, model.slow[:n]))
    )
