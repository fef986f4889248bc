# SPDX-License-Identifier: MIT
"""The shared library through ctypes.

Functions, structures and status codes are read from gyroakf.h, which lies beside it.
"""

from __future__ import annotations

import contextlib
import ctypes
import math
import os
import re
import signal
import threading
import weakref
from pathlib import Path
from typing import Any, Callable, Dict, Iterator, List, Optional, Tuple, Union

import numpy as np

from . import _errors

Progress = Callable[[str, int, int], Any]
PROGRESS = ctypes.CFUNCTYPE(
    ctypes.c_int32, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int64, ctypes.c_int64
)
FOLDER = Path(__file__).parent

TYPES: Dict[str, Any] = {
    "void": None,
    "int": ctypes.c_int,
    "int8_t": ctypes.c_int8,
    "int32_t": ctypes.c_int32,
    "int64_t": ctypes.c_int64,
    "size_t": ctypes.c_size_t,
    "double": ctypes.c_double,
    "gyroakf_progress_fn": PROGRESS,
}


def c_type(declaration: str) -> Any:
    """The ctypes type of "const char *" and the like; pointers other than texts are addresses."""
    words = declaration.replace("const", "").split()
    name = "".join(words)
    if name == "char*":
        return ctypes.c_char_p
    return ctypes.c_void_p if "*" in name else TYPES[words[0]]


def parameters(text: str) -> Iterator[Tuple[str, Any]]:
    """Name and ctypes type of each declaration in "double from, to; int32_t count;"."""
    for declaration in text.split(";"):
        match = re.match(r"\s*((?:const )?\w+)\s*(.*)", declaration, re.S)
        if not match:
            continue
        for declarator in match[2].split(","):
            parts = re.match(r"\s*([*\s]*(?:const)?[*\s]*)(\w+)(?:\[(\d+)\])?", declarator)
            assert parts
            stars, name, size = parts.groups()
            kind = c_type(match[1] + stars) if match[1] != "char" or stars else ctypes.c_char
            yield name, kind * int(size) if size else kind


def load() -> Tuple[Any, Dict[int, str]]:
    """Library, structures by name, and the names of the status codes by number."""
    header = re.sub(
        r"/\*.*?\*/", " ", (FOLDER / "gyroakf.h").read_text(encoding="utf-8"), flags=re.S
    )
    # Waiting threads sleep instead of spinning; OpenMP reads the variable when it is loaded
    given = os.environ.get("OMP_WAIT_POLICY")
    os.environ["OMP_WAIT_POLICY"] = given or "passive"
    library = ctypes.CDLL(str(FOLDER / "libgyroakf.so"))
    if given is None:
        del os.environ["OMP_WAIT_POLICY"]
    for body, name in re.findall(r"typedef struct \w+ \{(.*?)\}\s*(\w+);", header, re.S):
        TYPES[name] = type(name, (ctypes.Structure,), {"_fields_": list(parameters(body))})
    for returned, name, arguments in re.findall(
        r"GYROAKF_API ([\w ]+?[ *]+)(\w+)\(([^;]*)\);", header
    ):
        function = getattr(library, name)
        function.restype = c_type(returned)
        declarations = arguments.replace("\n", " ").split(",")
        function.argtypes = [kind for d in declarations if d != "void" for _, kind in parameters(d)]
    codes = {int(number): name for name, number in re.findall(r"(GYROAKF_[A-Z_]+) = (\d+)", header)}
    return library, codes


LIBRARY, CODES = load()


def integer(value: Any, kind: Any, name: str) -> Any:
    """An integer for C; ctypes alone would cut off its upper bits."""
    number = kind(value)
    if number.value != value:
        raise _errors.InvalidArgumentError(f"`{name}` is too large: {value}")
    return number


def options(name: str, **given: Any) -> Any:
    """The structure gyroakf_NAME with its defaults and the given members that are not None."""
    struct = TYPES[f"gyroakf_{name}"]()
    getattr(LIBRARY, f"gyroakf_{name}_init")(ctypes.byref(struct))
    kinds = dict(struct._fields_)
    for member, value in given.items():
        if member not in kinds:
            raise TypeError(f"unknown option {member!r}; known are {', '.join(list(kinds)[1:])}")
        if value is None:
            continue
        if isinstance(value, str):
            if "\0" in value:
                raise _errors.InvalidArgumentError(f"`{member}` contains a NUL character")
            value = value.encode("utf-8", "surrogateescape")
        elif kinds[member] in (ctypes.c_int32, ctypes.c_int64):
            value = integer(value, kinds[member], member)
        setattr(struct, member, value)
    return struct


def members(struct: ctypes.Structure) -> Dict[str, Any]:
    """The members of a structure as Python's numbers and tuples."""
    found = {}
    for name in (field[0] for field in struct._fields_):
        value = getattr(struct, name)
        found[name] = tuple(value) if isinstance(value, ctypes.Array) else value
    return found


def call(name: str, *arguments: Any) -> None:
    """Call gyroakf_NAME with these arguments and an error structure; raise what it reports."""
    error = TYPES["gyroakf_error"]()
    try:
        status = getattr(LIBRARY, f"gyroakf_{name}")(*arguments, ctypes.byref(error))
    except ctypes.ArgumentError as refused:
        raise TypeError(f"gyroakf_{name}: {refused}") from None
    if status:
        raise exception(status, error.message.decode("utf-8", "replace"))


def exception(status: int, message: str) -> Exception:
    return _errors.BY_STATUS.get(CODES.get(status, ""), _errors.InternalError)(message)


@contextlib.contextmanager
def watch(progress: Optional[Progress] = None) -> Iterator[Any]:
    """A callback for C; Ctrl-C and exceptions of `progress` cancel the call and are raised after
    it.

    Python handles signals when the callback begins, where an exception would be lost in C; the
    handler of Ctrl-C therefore only sets a flag.
    """
    raised: List[BaseException] = []

    def note(*_: Any) -> None:
        raised.append(KeyboardInterrupt())

    def report(_: Any, stage: bytes, done: int, total: int) -> int:
        try:
            if progress is not None and not raised:
                progress(stage.decode(), done, total)
        except BaseException as error:  # noqa: B902 - whatever it is, it goes on after the call
            raised.append(error)
        return len(raised)

    ours = (
        threading.current_thread() is threading.main_thread()
        and signal.getsignal(signal.SIGINT) is signal.default_int_handler
    )
    if ours:
        signal.signal(signal.SIGINT, note)
    try:
        yield PROGRESS(report)
    except _errors.CancelledError:
        if not raised:
            raise
    finally:
        if ours:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        if raised:
            raise raised[0]


def process(
    function: str,
    data: np.ndarray,
    kind: str,
    progress: Optional[Progress],
    *results: Union[np.ndarray, ctypes.Structure, None],
    **given: Any,
) -> None:
    """Calls gyroakf_FUNCTION(data, n, options of a kind, results); `progress` can cancel it."""
    places = [
        address(place) if isinstance(place, np.ndarray) else place and ctypes.byref(place)
        for place in results
    ]
    with watch(progress) as callback:
        opt = options(kind, progress=callback, **given)
        call(function, address(data), data.size, ctypes.byref(opt), *places)


class Handle:
    """A handle of the library, freed with the last reference to it."""

    def __init__(self, name: str, pointer: ctypes.c_void_p):
        self.pointer = pointer
        weakref.finalize(self, getattr(LIBRARY, f"gyroakf_{name}_free"), pointer).atexit = False

    def array(self, address: Optional[int], n: int, kind: Any = ctypes.c_double) -> np.ndarray:
        """A read-only array of what the handle owns; it keeps the handle alive."""
        buffer = (kind * n).from_address(address)
        buffer.handle = self
        array = np.frombuffer(buffer, dtype=np.dtype(kind))
        array.flags.writeable = False
        return array


def new(name: str, function: str, *arguments: Any) -> Handle:
    """The handle that gyroakf_FUNCTION makes; its last argument is its place."""
    pointer = ctypes.c_void_p()
    call(function, *arguments, ctypes.byref(pointer))
    return Handle(name, pointer)


def series(data: Any, name: str = "data") -> np.ndarray:
    """A contiguous array of float64; `data` itself where it is one already."""
    if isinstance(data, np.ma.MaskedArray):
        data = np.ma.filled(np.ma.asarray(data, np.float64), math.nan)
    elif type(data).__module__.startswith("pandas"):
        data = data.to_numpy(dtype=np.float64, na_value=math.nan)
    array = np.asarray(data)
    if array.dtype.kind not in "buifO":
        raise TypeError(f"`{name}` must hold real numbers, not {array.dtype}")
    if array.ndim != 1:
        raise ValueError(f"`{name}` must have one dimension, not {array.ndim}")
    if array.size == 0:
        raise _errors.TooFewSamplesError(f"`{name}` is empty")
    return np.require(array, np.float64, ["C", "A"])


def address(array: np.ndarray) -> int:
    return array.ctypes.data


def text(value: Optional[bytes]) -> str:
    return (value or b"").decode("utf-8", "replace")


def program() -> str:
    """The path of the program gyroakf that belongs to this library."""
    return os.fspath(FOLDER / "gyroakf")
