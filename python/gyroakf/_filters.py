# SPDX-License-Identifier: MIT
"""Kalman filters: fixed, or adaptive (Sage-Husa)."""

from __future__ import annotations

import contextlib
import ctypes
import threading
from dataclasses import dataclass
from typing import Any, Iterator, Optional, Sequence, Tuple

import numpy as np

from . import _library as lib
from ._recording import Column, sampled
from ._results import Result


@dataclass(frozen=True)
class FilterState(Result):
    """What a filter holds after its last step.

    Attributes
    ----------
    x, p : float
        Estimate and its variance.
    gain, innovation, innovation_variance : float
        Of the last measurement.
    q_mean, r_mean, q, r : float
        Means and variances of process and measurement noise that the next step uses.
    steps : int
        Number of steps, missing measurements included.
    """

    x: float
    p: float
    gain: float
    innovation: float
    innovation_variance: float
    q_mean: float
    r_mean: float
    q: float
    r: float
    steps: int


FILTER_STEP = lib.LIBRARY.gyroakf_filter_step


class Filter:
    """A Kalman filter of z_k = x_k + v_k, x_k = sum phi_i x_{k-i} + w_k, fixed or adaptive.

    A filter is used by one thread at a time. It can be pickled and copied with its state.

    Parameters
    ----------
    phi : sequence of float
        Coefficients of a stationary AR model; empty: white noise.
    q, r : float
        Variances of w and v.
    **options
        ``estimate_process_mean``, ``estimate_measurement_mean``, ``estimate_process_variance``,
        ``estimate_measurement_variance``
        (adapt q, r, Q, R), ``forgetting`` (0.98), ``measurement_form`` ("residual", "exact",
        "biased", "paper"), ``burn_in``,
        ``huber``, ``r_scale``, ``initial_variance``, ``q_lower``, ``q_upper``, ``r_lower``,
        ``r_upper``, ``allow_unobservable``.

    Examples
    --------
    >>> import gyroakf
    >>> kalman = gyroakf.Filter([0.9], q=0.19, r=1)
    >>> round(kalman.step(1.0), 6)
    0.5
    >>> kalman.step(float("nan"))  # a missing measurement: the prediction
    0.45
    >>> kalman.run([0.5, 0.25]).round(4).tolist()
    [0.4432, 0.3482]
    >>> kalman.state.steps
    4
    """

    def __init__(self, phi: Sequence[float], q: float, r: float, **options: Any):
        coefficients = lib.series(phi, "phi") if len(phi) else np.zeros(0)
        order = lib.integer(len(coefficients), ctypes.c_int32, "phi")
        self._own(
            lib.new(
                "filter",
                "filter_new",
                order,
                lib.address(coefficients),
                q,
                r,
                ctypes.byref(lib.options("filter_options", **options)),
            )
        )

    def _own(self, handle: lib.Handle) -> "Filter":
        self._handle = handle
        self._pointer = handle.pointer
        self._lock = threading.Lock()
        self._x = ctypes.c_double()
        self._place = ctypes.byref(self._x)
        return self

    @contextlib.contextmanager
    def _alone(self) -> Iterator[None]:
        if not self._lock.acquire(blocking=False):
            raise RuntimeError("the filter is in use by another thread")
        try:
            yield
        finally:
            self._lock.release()

    def step(self, z: float) -> float:
        """The estimate after the measurement z; NaN: no measurement, the prediction."""
        if not self._lock.acquire(blocking=False):
            raise RuntimeError("the filter is in use by another thread")
        try:
            status = FILTER_STEP(self._pointer, z, self._place)
            estimate = self._x.value
        except ctypes.ArgumentError:
            raise TypeError(f"`z` must be a number, not {z!r}") from None
        finally:
            self._lock.release()
        if status:
            raise lib.exception(status, "the estimate overflows; reset the filter")
        return estimate

    def run(
        self, z: Any, *, out: Optional[np.ndarray] = None, progress: Optional[lib.Progress] = None
    ) -> np.ndarray:
        """The estimates after each measurement of an array, the same numbers as step by step.

        `out` gets them, a contiguous array of float64 of the length of `z`, or `z` itself. A call
        that is cancelled leaves the filter
        after the steps that were made (``state.steps``).
        """
        z = lib.series(z, "z")
        if out is None:
            out = np.empty_like(z)
        if not (
            isinstance(out, np.ndarray)
            and out.dtype == np.float64
            and out.shape == z.shape
            and out.flags.carray
        ):
            raise ValueError(
                "`out` must be a writeable, contiguous array of float64 of the length of `z`"
            )
        with self._alone(), lib.watch(progress) as callback:
            lib.call(
                "filter_run_watched",
                self._pointer,
                lib.address(z),
                z.size,
                lib.address(out),
                callback,
                None,
            )
        return out

    def freeze(self, frozen: bool = True) -> None:
        """Stop the adaptation, while the sensor rotates, or start it again."""
        with self._alone():
            lib.LIBRARY.gyroakf_filter_freeze(self._pointer, int(frozen))

    def reset(self) -> None:
        """The filter as it was made."""
        with self._alone():
            lib.call("filter_reset", self._pointer)

    @property
    def state(self) -> FilterState:
        """What the filter holds after its last step."""
        state = lib.TYPES["gyroakf_filter_state"]()
        with self._alone():
            status = lib.LIBRARY.gyroakf_filter_get(self._pointer, ctypes.byref(state))
        if status:
            raise lib.exception(status, "a number of the state overflows; reset the filter")
        return FilterState(**lib.members(state))

    def __reduce__(self) -> Tuple[Any, ...]:
        size = ctypes.c_int64()
        with self._alone():
            lib.call("filter_save", self._pointer, None, 0, ctypes.byref(size))
            saved = ctypes.create_string_buffer(size.value)
            lib.call("filter_save", self._pointer, saved, size, ctypes.byref(size))
        return _restore, (saved.raw,)


def identify_filter(
    data: Any,
    kind: str = "drift_akf",
    rate: Optional[float] = None,
    *,
    column: Optional[Column] = None,
    preset: Optional[str] = None,
    progress: Optional[lib.Progress] = None,
) -> Tuple[Filter, float]:
    """The filter that the program makes for a series, and the mean that is to be subtracted from
    what it takes.

    Parameters
    ----------
    data, rate, column, progress
        As of `allan`.
    kind : {"kf", "akf", "drift_kf", "drift_akf"}
        The paper's Kalman and adaptive Kalman filter, which take the series of `clean`, without
        its trend; or those of the drift, which take the series with its trend.
    preset : {"default", "paper"}, optional
        As the program's ``--preset``.

    Examples
    --------
    >>> import gyroakf
    >>> log = gyroakf.simulate(20000, rate=50, n=0.01, k=0.004, offset=3)
    >>> kalman, mean = gyroakf.identify_filter(log, "drift_kf")
    >>> drift = kalman.run(log.values[0] - mean) + mean
    """
    x, dt, _ = sampled(data, rate, column)
    mean = ctypes.c_double()
    pointer = ctypes.c_void_p()
    with lib.watch(progress) as callback:
        opt = lib.options("run_options", preset=preset, progress=callback)
        lib.call(
            "filter_identify",
            kind.encode(),
            lib.address(x),
            x.size,
            dt,
            ctypes.byref(opt),
            ctypes.byref(pointer),
            ctypes.byref(mean),
        )
    return Filter.__new__(Filter)._own(lib.Handle("filter", pointer)), mean.value


def _restore(saved: bytes) -> Filter:
    return Filter.__new__(Filter)._own(lib.new("filter", "filter_restore", saved, len(saved)))
