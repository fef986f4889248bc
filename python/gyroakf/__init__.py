# SPDX-License-Identifier: MIT
"""Gyroscope noise characterization: Allan deviation, AR models, adaptive Kalman filters.

Series are one-dimensional and evenly spaced; NaN marks a missing sample. Wherever a function takes
a series, it takes an array, a `Recording`, or the path of one. Results are dataclasses with
``to_dict()``, ``to_frame()`` and, where there is something to draw, ``plot()``.
"""

from ._allan import AllanCurve, Coefficient, NoiseFit, allan, noise_fit

# fmt: off
from ._errors import (
    CancelledError, ConstantInputError, FileError, GyroakfError, InternalError,
    InvalidArgumentError, NoMemoryError, NonFiniteError, NotConvergedError, NotSupportedError,
    ParseError, SingularError, TooFewSamplesError, UnstableError, UsageError,
)
# fmt: on
from ._drift import DriftModel, Smoothed, identify_drift
from ._filters import Filter, FilterState, identify_filter
from ._library import LIBRARY as _LIBRARY, program
from ._outliers import Outliers, clean, mark_outliers
from ._recording import Recording, read, simulate
from ._run import Report, run
from ._series import ADFTest, ARModel, KPSSTest, adf, ar, kpss

__version__: str = _LIBRARY.gyroakf_version_string().decode()

# fmt: off
__all__ = [
    "ADFTest", "ARModel", "AllanCurve", "CancelledError", "Coefficient", "ConstantInputError",
    "DriftModel", "FileError", "Filter", "FilterState", "GyroakfError", "InternalError",
    "InvalidArgumentError", "KPSSTest", "NoMemoryError", "NoiseFit", "NonFiniteError",
    "NotConvergedError", "NotSupportedError", "Outliers", "ParseError", "Recording", "Report",
    "SingularError", "Smoothed", "TooFewSamplesError", "UnstableError", "UsageError", "adf",
    "allan", "ar", "clean", "identify_drift", "identify_filter", "kpss", "mark_outliers",
    "noise_fit", "program", "read", "run", "simulate",
]
