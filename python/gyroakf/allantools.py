# SPDX-License-Identifier: MIT
"""Functions of the package allantools, by this library: the same names, arguments and returned
values.

``import gyroakf.allantools as allantools`` replaces ``import allantools`` for ``adev``, ``oadev``,
``mdev``, ``tdev``, ``hdev``,
``ohdev`` and ``totdev``. Errors are those of allantools, deviation / sqrt(n); `gyroakf.allan` has
confidence limits.

Examples
--------
>>> import numpy as np
>>> import gyroakf.allantools as allantools
>>> x = np.arange(20.0) ** 2
>>> taus, devs, errors, ns = allantools.oadev(x, rate=1.0, data_type="phase", taus=[1, 2, 4])
>>> devs.round(6).tolist(), ns.tolist()
([1.414214, 2.828427, 5.656854], [18.0, 16.0, 12.0])
"""

from __future__ import annotations

from typing import Any, Callable, Dict, Tuple

import numpy as np

from . import _library as lib
from ._allan import allan
from ._recording import interval

__all__ = ["adev", "oadev", "mdev", "tdev", "hdev", "ohdev", "totdev"]

Curve = Tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]

# Number of terms at the averaging factor m of n phase samples
COUNTS: Dict[str, Callable[[int, Any], Any]] = {
    "adev": lambda n, m: (n - 1) // m - 1,
    "oadev": lambda n, m: n - 2 * m,
    "mdev": lambda n, m: n - 3 * m + 1,
    "tdev": lambda n, m: n - 3 * m + 1,
    "hdev": lambda n, m: (n - 1) // m - 2,
    "ohdev": lambda n, m: n - 3 * m,
    "totdev": lambda n, m: np.where(m < n, n - 2, 0),
}


def _factors(n: int, rate: float, taus: Any) -> Any:
    """Averaging factors of allantools' `taus` for n phase samples."""
    factors: Any
    if taus is None or len(taus) == 0:
        taus = "octave"
    if not isinstance(taus, str):
        factors = np.round(np.asarray(taus, np.float64) * rate)
    elif taus == "all":
        factors = np.arange(1.0, n)
    elif taus == "octave":
        factors = 2.0 ** np.arange(int(np.log2(n)) + 1)
    elif taus == "decade":
        factors = np.outer(10.0 ** np.arange(int(np.log10(n)) + 1), [1, 2, 4]).ravel()
    elif taus == "log10":
        factors = np.round(np.logspace(0, np.log10(n), int(10 * np.log10(n))))
    else:
        raise ValueError(
            f'`taus` must be times in s, "octave", "decade", "log10" or "all", not {taus!r}'
        )
    factors = np.unique(factors)
    return factors[(factors > 0) & (factors < n)].astype(np.int64)


def _deviation(kind: str, data: Any, rate: float, data_type: str, taus: Any) -> Curve:
    if data_type not in ("phase", "freq"):
        raise ValueError(f'`data_type` must be "phase" or "freq", not {data_type!r}')
    dt = interval(rate)
    values = lib.series(data)
    frequency = values if data_type == "freq" else np.diff(values) * rate
    n = frequency.size + 1
    factors = _factors(n, rate, taus)
    counts = COUNTS[kind](n, factors)
    factors, counts = factors[counts > 1], counts[counts > 1]
    if factors.size == 0:
        raise UserWarning("no averaging time of `taus` has two terms")
    curve = allan(frequency, kind=kind, taus=factors.astype(np.float64))
    kept = np.isin(factors, np.round(curve.tau))
    scale = dt if kind == "tdev" else 1
    errors = curve.deviation / np.sqrt(counts[kept])
    return (
        factors[kept] / rate,
        curve.deviation * scale,
        errors * scale,
        counts[kept].astype(np.float64),
    )


def _function(kind: str, title: str) -> Callable[..., Curve]:
    def deviation(
        data: Any, rate: float = 1.0, data_type: str = "phase", taus: Any = None
    ) -> Curve:
        return _deviation(kind, data, rate, data_type, taus)

    deviation.__name__ = deviation.__qualname__ = kind
    deviation.__doc__ = f"""{title}.

    Parameters
    ----------
    data : array_like
        Phase, or frequency (rates).
    rate : float
        Sample rate in Hz.
    data_type : {{"phase", "freq"}}
        What `data` is.
    taus : array_like or {{"octave", "decade", "log10", "all"}}, optional
        Averaging times in s.

    Returns
    -------
    taus, deviations, errors, ns : numpy.ndarray
        Averaging times, deviations, their errors deviation / sqrt(n), numbers n of terms.
    """
    return deviation


adev = _function("adev", "Allan deviation")
oadev = _function("oadev", "Overlapping Allan deviation")
mdev = _function("mdev", "Modified Allan deviation")
tdev = _function("tdev", "Time deviation")
hdev = _function("hdev", "Hadamard deviation")
ohdev = _function("ohdev", "Overlapping Hadamard deviation")
totdev = _function("totdev", "Total deviation")
