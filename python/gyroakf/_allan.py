# SPDX-License-Identifier: MIT
"""Allan deviation and the noise coefficients."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass, field
from math import floor, log10
from typing import Any, Dict, Optional, Sequence, Union

import numpy as np

from . import _library as lib
from ._errors import InvalidArgumentError
from ._recording import Column, sampled
from ._results import Result

UNITS = {"q": "{} s", "n": "{} sqrt(s)", "b": "{}", "k": "{}/sqrt(s)", "r": "{}/s"}


@dataclass(frozen=True)
class Coefficient(Result):
    """A noise coefficient, a limit of it, or neither.

    Attributes
    ----------
    value, std_error : float
        Value and standard error; 0 where the term is not in the fit.
    upper_limit : float
        One-sided 95 % limit.
    detected : bool
        Whether to state the value; otherwise the limit.
    fitted : bool
        Whether there is a value or a limit; otherwise the coefficient is withheld.
    unit : str
        Its unit, of the unit u of the samples.
    """

    value: float
    std_error: float
    upper_limit: float
    detected: bool
    fitted: bool
    unit: str = ""

    def __str__(self) -> str:
        if not self.fitted:
            return "-"
        if not self.detected:
            return f"< {self.upper_limit:.4g} {self.unit}"
        digits = 4  # of the value, as many as its error has
        if 0 < self.std_error < self.value:
            digits = 2 + floor(log10(self.value)) - floor(log10(self.std_error))
        return f"{self.value:#.{digits}g} ± {self.std_error:.2g} {self.unit}"


@dataclass(frozen=True)
class NoiseFit(Result):
    """Noise coefficients of an Allan deviation.

    sigma^2 = 3 Q^2/tau^2 + N^2/tau + (2 ln 2/pi) B^2 + K^2 tau/3 + R^2 tau^2/2.

    Attributes
    ----------
    q, n, b, k, r : Coefficient
        Quantization noise, angle random walk, bias instability, rate random walk, rate ramp.
    chi2_reduced, chi2_probability : float
        Chi-square per degree of freedom, and the probability of one as large.
    points, left_out, cut_off : int
        Octaves in the fit, and excluded before and after them.
    described : bool
        False: no run of octaves follows the terms, and all coefficients are withheld.
    tau_first, tau_last : float
        Averaging times of the fit, s.
    floor, kurtosis : float
        Significant lack of fit relative to the variances; excess kurtosis of the white noise; 0
        where not significant.
    n_unquantized : Coefficient
        N without the rounding of the samples to `lsb`.
    lsb_ratio : float
        `lsb` over the standard deviation of the noise; the largest float where rounding alone
        explains the differences.
    """

    q: Coefficient
    n: Coefficient
    b: Coefficient
    k: Coefficient
    r: Coefficient
    chi2_reduced: float
    points: int
    left_out: int
    cut_off: int
    described: bool
    tau_first: float
    tau_last: float
    chi2_probability: float
    floor: float
    kurtosis: float
    n_unquantized: Coefficient
    lsb_ratio: float

    def _columns(self) -> Dict[str, Any]:
        rows = {name.upper(): getattr(self, name).to_dict() for name in UNITS}
        return {
            "term": list(rows),
            **{key: [row[key] for row in rows.values()] for key in rows["N"]},
        }

    def __str__(self) -> str:
        return "\n".join(f"{name.upper()} {getattr(self, name)}" for name in UNITS)


@dataclass(frozen=True, eq=False)
class AllanCurve(Result):
    """A deviation with its confidence limits over the averaging time.

    Attributes
    ----------
    kind : str
        The statistic, as "oadev".
    unit : str
        Unit u of the samples; "" where it is unknown.
    tau : numpy.ndarray
        Averaging times in s, ascending.
    deviation, lower, upper : numpy.ndarray
        Deviation and its confidence limits (u; tdev: u s).
    edf : numpy.ndarray
        Equivalent degrees of freedom.
    """

    kind: str
    unit: str
    tau: np.ndarray
    deviation: np.ndarray
    lower: np.ndarray
    upper: np.ndarray
    edf: np.ndarray
    _handle: Optional[lib.Handle] = field(default=None, repr=False)

    def __getstate__(self) -> Dict[str, Any]:
        return {**self.__dict__, "_handle": None}

    def plot(self, ax: Any = None) -> Any:
        """Draws the deviation and its limits in double-logarithmic axes; returns the axes."""
        ax = self._axes(ax, "averaging time / s", f"{self.kind} / ({self.unit or 'u'})")
        ax.loglog(self.tau, self.deviation, "o-")
        ax.fill_between(self.tau, self.lower, self.upper, alpha=0.3)
        ax.grid(True, which="both", alpha=0.3)
        return ax


def allan(
    data: Any,
    rate: Optional[float] = None,
    *,
    column: Optional[Column] = None,
    unit: Optional[str] = None,
    kind: Optional[str] = None,
    taus: Union[str, Sequence[float], None] = None,
    confidence: Optional[float] = None,
    min_coverage: Optional[float] = None,
    fit: bool = False,
    progress: Optional[lib.Progress] = None,
) -> AllanCurve:
    """Compute the Allan deviation, or a relative of it, of a series of rates.

    Parameters
    ----------
    data : array_like, Recording or path
        Rates (means over the sample intervals), evenly spaced; NaN: missing.
    rate : float, optional
        Sample rate in Hz; that of the recording, or 1.
    column : int or str, optional
        Channel of a recording of several.
    unit : str, optional
        Unit of the samples of an array.
    kind : {"oadev", "adev", "mdev", "tdev", "hdev", "ohdev", "totdev"}, optional
        The statistic; the overlapping Allan deviation without it.
    taus : str or sequence of float, optional
        Averaging times: "octave", "decade", "log:N", "all", or times in s.
    confidence : float, optional
        Probability between the confidence limits; 0.683.
    min_coverage : float, optional
        Share of a window that must be present where samples are missing; 0.9.
    fit : bool, optional
        True: limits and degrees of freedom are those of the noise that is fitted to the curve, as
        the program states them (kind "oadev"); otherwise of the noise type identified at each
        averaging time.
    progress : callable, optional
        Called as ``progress(stage, done, total)``; an exception that it raises cancels the call.

    Examples
    --------
    >>> import gyroakf
    >>> log = gyroakf.simulate(36000, rate=10, n=0.005, seed=1)
    >>> curve = gyroakf.allan(log)
    >>> curve.tau[:3].tolist()
    [0.1, 0.2, 0.4]
    >>> print(gyroakf.noise_fit(curve).n)
    0.005009 ± 1.9e-05 deg/s sqrt(s)
    """
    x, dt, known = sampled(data, rate, column)
    if unit and known not in ("", unit):
        raise InvalidArgumentError(f"`unit` is {unit!r}, that of the recording {known!r}")
    times = (
        taus
        if taus is None or isinstance(taus, str)
        else ",".join(repr(float(tau)) for tau in taus)
    )
    with lib.watch(progress) as callback:
        opt = lib.options(
            "allan_options",
            kind=kind,
            taus=times,
            confidence=confidence,
            min_coverage=min_coverage,
            progress=callback,
        )
        handle = lib.new("allan", "allan_new", lib.address(x), x.size, dt, ctypes.byref(opt))
    if fit:
        noise = lib.TYPES["gyroakf_noise"]()
        lib.call("allan_fit", handle.pointer, None, ctypes.byref(noise))
    n = lib.LIBRARY.gyroakf_allan_size(handle.pointer)
    arrays = {
        name: handle.array(getattr(lib.LIBRARY, f"gyroakf_allan_{name}")(handle.pointer), n)
        for name in ("tau", "deviation", "lower", "upper", "edf")
    }
    return AllanCurve(kind=kind or "oadev", unit=unit or known, _handle=handle, **arrays)


def noise_fit(
    data: Any,
    rate: Optional[float] = None,
    *,
    column: Optional[Column] = None,
    terms: Optional[str] = None,
    tau_min: Optional[float] = None,
    tau_max: Optional[float] = None,
    lsb: Optional[float] = None,
) -> NoiseFit:
    """Fit the noise coefficients Q, N, B, K, R.

    Parameters
    ----------
    data : AllanCurve of kind "oadev", array_like, Recording or path
        The curve, or the samples of one.
    rate, column
        As of `allan`; not with a curve.
    terms : str, optional
        "auto", or letters of "QNBKR": then all points in the range are fitted.
    tau_min, tau_max : float, optional
        Averaging times in s between which points are fitted.
    lsb : float, optional
        Step that the samples are rounded to.

    Examples
    --------
    >>> import gyroakf
    >>> fit = gyroakf.noise_fit(gyroakf.simulate(360000, rate=10, n=0.005, k=2e-4, seed=1))
    >>> print(fit)
    Q < 9.023e-05 deg/s s
    N 0.0049983 ± 5.9e-06 deg/s sqrt(s)
    B < 0.0003011 deg/s
    K 0.0001880 ± 7.2e-06 deg/s/sqrt(s)
    R < 5.318e-06 deg/s/s
    """
    curve = data if isinstance(data, AllanCurve) else allan(data, rate, column=column)
    if curve._handle is None:
        raise ValueError("a curve from another process cannot be fitted; fit the samples")
    opt = lib.options("fit_options", terms=terms, tau_min=tau_min, tau_max=tau_max, lsb=lsb)
    noise = lib.TYPES["gyroakf_noise"]()
    lib.call("noise_fit", curve._handle.pointer, ctypes.byref(opt), ctypes.byref(noise))
    found = lib.members(noise)
    for name, value in found.items():
        if isinstance(value, ctypes.Structure):
            unit = UNITS[name[0]].format(curve.unit or "u")
            parts = lib.members(value)
            found[name] = Coefficient(
                **{
                    **parts,
                    "detected": bool(parts["detected"]),
                    "fitted": bool(parts["fitted"]),
                    "unit": unit,
                }
            )
    return NoiseFit(**{**found, "described": bool(found["described"])})
