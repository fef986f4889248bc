# SPDX-License-Identifier: MIT
"""Recordings: read from files or simulated."""

from __future__ import annotations

import ctypes
import os
from dataclasses import dataclass, field
from typing import Any, Dict, Optional, Tuple, Union

import numpy as np

from . import _library as lib
from ._errors import InvalidArgumentError
from ._formats import as_csv, reader_of
from ._results import Result

Column = Union[int, str]
# Options of the program whose names differ from the members of gyroakf.h
RENAMED = {"rate": "rate_hz", "column": "columns", "from_": "from"}


@dataclass(frozen=True, eq=False)
class Recording(Result):
    """Channels of evenly spaced samples, and what is known about them.

    ``recording["gx"]`` or ``recording[0]`` is the array of a channel.

    Attributes
    ----------
    values : tuple of numpy.ndarray
        The samples of each channel, NaN where missing; read-only.
    names, units : tuple of str
        Of the channels; a unit is "" where it is unknown.
    dt : float
        Sample interval in s; 1 where the rate is unknown.
    rate_source : str
        "option", "header", "timestamps", or "none" where the rate is unknown.
    format : str
        The format of the file, as "text", "npy", "f64le".
    warnings : tuple of str
        Findings of the reader, one sentence each.
    audit : dict
        Missing samples, gaps, jitter and duplicates of the time stamps.
    """

    values: Tuple[np.ndarray, ...] = field(repr=False)
    names: Tuple[str, ...]
    units: Tuple[str, ...]
    dt: float
    rate_source: str
    format: str
    warnings: Tuple[str, ...]
    audit: Dict[str, Any]

    @property
    def rate(self) -> float:
        """Sample rate in Hz."""
        return 1 / self.dt

    def __len__(self) -> int:
        return len(self.values[0])

    def _index(self, column: Optional[Column]) -> int:
        if column is None:
            if len(self.names) > 1:
                raise InvalidArgumentError(
                    f"`column` must name one of the channels {', '.join(self.names)}"
                )
            return 0
        if isinstance(column, str):
            if column not in self.names:
                raise KeyError(f"no channel {column!r}; there are {', '.join(self.names)}")
            return self.names.index(column)
        return range(len(self.names))[column]

    def __getitem__(self, column: Column) -> np.ndarray:
        return self.values[self._index(column)]

    def _columns(self) -> Dict[str, Any]:
        return {"time_s": np.arange(len(self)) * self.dt, **dict(zip(self.names, self.values))}

    def plot(self, ax: Any = None) -> Any:
        """Draws the channels over time; returns the axes."""
        ax = self._axes(ax, "time / s", ", ".join(sorted(set(self.units))))
        for name, values in zip(self.names, self.values):
            ax.plot(np.arange(len(self)) * self.dt, values, linewidth=0.5, label=name)
        ax.legend()
        return ax


def recording(handle: lib.Handle) -> Recording:
    """The recording of a handle; its arrays are those of the handle."""
    get, p = lib.LIBRARY, handle.pointer
    channels, n = range(get.gyroakf_record_channels(p)), get.gyroakf_record_samples(p)
    audit = lib.TYPES["gyroakf_audit"]()
    audit.struct_size = ctypes.sizeof(audit)
    get.gyroakf_record_audit(p, ctypes.byref(audit))
    found = lib.members(audit)
    del found["struct_size"]
    return Recording(
        values=tuple(handle.array(get.gyroakf_record_values(p, i), n) for i in channels),
        names=tuple(lib.text(get.gyroakf_record_name(p, i)) for i in channels),
        units=tuple(lib.text(get.gyroakf_record_unit(p, i)) for i in channels),
        dt=get.gyroakf_record_sample_interval(p),
        rate_source=lib.text(get.gyroakf_record_rate_source(p)),
        format=lib.text(get.gyroakf_record_format(p)),
        warnings=tuple(
            lib.text(get.gyroakf_record_warning(p, i))
            for i in range(get.gyroakf_record_warnings(p))
        ),
        audit=found,
    )


def read(
    path: Union[str, os.PathLike[str]], *, progress: Optional[lib.Progress] = None, **options: Any
) -> Recording:
    """Read a recording: text, CSV, ``.npy``, raw numbers, each also as ``.gz``, and more.

    ROS bags and MCAP, PX4 ULog, ArduPilot DataFlash, MAT-files and Parquet are read by Python's
    libraries of these formats (``pip install "gyroakf[all]"``).

    What the file says about rate, unit and columns is used; an option overrides it.

    Parameters
    ----------
    path : str or os.PathLike
        The file; "-" is standard input.
    progress : callable, optional
        Called as ``progress(stage, done, total)``; an exception that it raises cancels the call.
    rate : float
        Sample rate in Hz.
    unit : str or sequence of str
        Unit of the values, as "deg/s", or one for each channel.
    column : int, str or a sequence of these
        Columns to read, by number from 1 or by name; all but the time without it.
    time_column : int or str
        Column of the time stamps; "none": there is none.
    format : str
        "auto", "text", "npy", or raw numbers: "f64", "i16be", ...
    channels, skip : int
        Interleaved columns of raw numbers; lines of text or bytes of raw numbers to leave out.
    bad_lines : {"error", "missing"}
        Whether a line that cannot be read is an error or a missing sample.
    input : {"rate", "increment", "angle"}
        What the values are; rates are made of them.
    scale : float
        Factor of every value.
    from_, to : float
        The part of the recording to keep, in s from its start.
    memory : int
        Bytes of memory that may be used.
    resample : {"index", "nearest", "linear"}
        Resampling by the time stamps.
    wrap : float or str
        Where angles wrap, in units of the file; "auto" or "none".
    topic : str
        Topic of a bag or an ULog, message of a DataFlash log, variable of a MAT-file.
    instance : int
        Instance of the sensor in a flight log, from 0.
    decimal_comma : bool
        Whether every comma in the file is a decimal comma.

    Raises
    ------
    FileError
        The file cannot be read.
    ParseError
        Its content cannot be understood.

    Examples
    --------
    >>> import gyroakf, tempfile, os
    >>> path = os.path.join(tempfile.mkdtemp(), "log.csv")
    >>> with open(path, "w") as file:
    ...     _ = file.write("time [s],gx [deg/s]\\n0.0,0.5\\n0.1,nan\\n0.2,0.25\\n")
    >>> log = gyroakf.read(path)
    >>> log.names, log.units, round(log.rate, 6), log["gx"].tolist()
    (('gx',), ('deg/s',), 10.0, [0.5, nan, 0.25])
    """
    topic, instance = options.pop("topic", None), options.pop("instance", 0)
    bad_lines = options.pop("bad_lines", "error")
    if bad_lines not in ("error", "missing"):
        raise InvalidArgumentError('`bad_lines` must be "error" or "missing"')
    given = {RENAMED.get(name, name): value for name, value in options.items()}
    for name in ("columns", "unit", "time_column", "wrap"):
        value = given.get(name)
        if value is not None:
            several = value if isinstance(value, (list, tuple)) else [value]
            given[name] = ",".join(map(str, several))
    file = os.fsencode(path)
    if b"\0" in file:
        raise InvalidArgumentError("`path` contains a NUL character")
    with lib.watch(progress) as callback:
        opt = lib.options(
            "reader_options", **given, bad_lines_missing=bad_lines == "missing", progress=callback
        )
        reader = reader_of(path)
        if reader:
            text = as_csv(path, reader, topic, instance)
            return recording(lib.new("record", "record_parse", text, len(text), ctypes.byref(opt)))
        return recording(lib.new("record", "record_read", file, ctypes.byref(opt)))


def simulate(
    samples: Optional[int] = None,
    rate: Optional[float] = None,
    *,
    progress: Optional[lib.Progress] = None,
    **options: Any,
) -> Recording:
    """Simulate a recording of one channel, "gx", with known noise; the same seed gives the same
    numbers on every machine.

    Parameters
    ----------
    samples : int, optional
        Number of samples; 12000.
    rate : float, optional
        Sample rate in Hz; 5.
    preset : {"paper"}, optional
        The simulated record of the paper; of the other options only the seed counts.
    seed : int, optional
        Seed of the random numbers; 1140.
    unit : str, optional
        Unit u of the samples; "deg/s".
    q, n, b, k, r : float
        Quantization noise (u s), angle random walk (u sqrt(s)), bias instability (u), rate random
        walk (u/sqrt(s)), rate ramp (u/s).
    ar_phi, ar_variance : float
        Coefficient and variance (u^2) of an AR(1) process.
    offset, lsb : float
        Mean, and the step that values are rounded to (u).
    outliers, outlier_size : int, float
        Number of outliers, and their mean size in standard deviations.
    missing : float
        Share of the samples that are missing.
    progress
        As of `read`.

    Examples
    --------
    >>> import gyroakf
    >>> log = gyroakf.simulate(36000, rate=10, n=0.005, k=1e-5, seed=1)
    >>> len(log), log.rate, log.units
    (36000, 10.0, ('deg/s',))
    """
    with lib.watch(progress) as callback:
        opt = lib.options(
            "simulate_options", samples=samples, rate_hz=rate, progress=callback, **options
        )
        return recording(lib.new("record", "simulate", ctypes.byref(opt)))


def sampled(
    data: Any, rate: Optional[float], column: Optional[Column]
) -> Tuple[np.ndarray, float, str]:
    """Series, sample interval and unit of a recording, the path of one, or an array."""
    if isinstance(data, (str, os.PathLike)):
        data, column = read(data, rate=rate, column=column), None
    if isinstance(data, Recording):
        i = data._index(column)
        return data.values[i], data.dt if rate is None else interval(rate), data.units[i]
    if column is not None:
        raise InvalidArgumentError("`column` chooses a channel of a recording, not of an array")
    return lib.series(data), 1.0 if rate is None else interval(rate), ""


def interval(rate: float) -> float:
    if not rate > 0:
        raise InvalidArgumentError(f"`rate` must be positive, not {rate}")
    return 1 / rate
