# SPDX-License-Identifier: MIT
"""Exceptions, one for each status of gyroakf.h, each of them a built-in exception, too."""

from __future__ import annotations


class GyroakfError(Exception):
    """Base class of the library's exceptions."""


class InvalidArgumentError(GyroakfError, ValueError):
    """An argument is out of its range."""


class TooFewSamplesError(GyroakfError, ValueError):
    """The series is too short for what was asked."""


class FileError(GyroakfError, OSError):
    """A file cannot be opened or read."""


class ParseError(GyroakfError, ValueError):
    """The content of a file cannot be understood; the message begins with FILE:LINE:COLUMN."""


class ConstantInputError(GyroakfError, ValueError):
    """The series has no variance."""


class SingularError(GyroakfError, ArithmeticError):
    """A matrix is singular or a fit is perfect."""


class NotConvergedError(GyroakfError, ArithmeticError):
    """An iteration did not converge."""


class UnstableError(GyroakfError, ArithmeticError):
    """A model is not stationary."""


class NonFiniteError(GyroakfError, ArithmeticError):
    """A value is infinite, or a result overflows."""


class NoMemoryError(GyroakfError, MemoryError):
    """Memory could not be allocated."""


class NotSupportedError(GyroakfError, ValueError):
    """A method or feature that the library does not have."""


class CancelledError(GyroakfError):
    """The call was cancelled."""


class InternalError(GyroakfError, RuntimeError):
    """A defect of the library."""


class UsageError(GyroakfError, ValueError):
    """The program refused an option."""


BY_STATUS = {
    "GYROAKF_INVALID_ARGUMENT": InvalidArgumentError,
    "GYROAKF_TOO_FEW_SAMPLES": TooFewSamplesError,
    "GYROAKF_IO": FileError,
    "GYROAKF_PARSE": ParseError,
    "GYROAKF_CONSTANT_INPUT": ConstantInputError,
    "GYROAKF_SINGULAR": SingularError,
    "GYROAKF_NOT_CONVERGED": NotConvergedError,
    "GYROAKF_UNSTABLE": UnstableError,
    "GYROAKF_NON_FINITE": NonFiniteError,
    "GYROAKF_NO_MEMORY": NoMemoryError,
    "GYROAKF_NOT_SUPPORTED": NotSupportedError,
    "GYROAKF_CANCELLED": CancelledError,
    "GYROAKF_INTERNAL": InternalError,
    "GYROAKF_USAGE": UsageError,
}
