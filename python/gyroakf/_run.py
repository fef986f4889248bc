# SPDX-License-Identifier: MIT
"""The whole job of the program."""

from __future__ import annotations

import html
import json
import os
import re
from dataclasses import dataclass, field
from typing import Any, Dict, Iterable, List, Optional, cast

import numpy as np

from . import _errors
from . import _library as lib
from ._formats import as_csv, reader_of
from ._recording import Recording
from ._results import Result


@dataclass(frozen=True, eq=False)
class Report(Result):
    """What the program's ``run`` finds out. ``print(report)`` shows its first screen.

    Attributes
    ----------
    document : dict
        The JSON document (``doc/schema.json``):
        ``report.document["channels"][0]["coefficients"]["input"]["N"]``.
    text : str
        The first screen.
    """

    document: Dict[str, Any]
    text: str = field(repr=False)

    def __str__(self) -> str:
        return self.text

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(self.text)}</pre>"

    @property
    def channels(self) -> List[Dict[str, Any]]:
        """The results of each channel in the document."""
        return cast(List[Dict[str, Any]], self.document["channels"])

    def to_dict(self) -> Dict[str, Any]:
        """The document."""
        return self.document

    def _columns(self) -> Dict[str, Any]:
        rows = []
        for channel in self.channels:
            for stage, terms in (channel["coefficients"] or {}).items():
                for term in "QNBKR" if stage != "reduction_percent" and terms else "":
                    rows.append(
                        {
                            "channel": channel["name"],
                            "stage": stage,
                            "term": term,
                            **(terms[term] or {}),
                        }
                    )
        keys = max(rows, key=len, default={})
        return {key: [row.get(key) for row in rows] for key in keys}

    def plot(self, ax: Any = None) -> Any:
        """Draws the Allan deviation of each channel; returns the axes."""
        ax = self._axes(ax, "averaging time / s", "Allan deviation")
        for channel in self.channels:
            curve = channel["allan"]["input"]
            ax.loglog(curve["tau_s"], curve["deviation"], "o-", label=channel["name"])
        ax.legend()
        return ax


def run(data: Any, *, progress: Optional[lib.Progress] = None, **options: Any) -> Report:
    """Do the whole job of the program: tests, models, filters and Allan deviation of every channel.

    It is the program ``gyroakf run`` that does it.

    Parameters
    ----------
    data : path, Recording or array_like
        A file; or samples, of several channels in columns, which the report numbers, or in the
        fields of a structured array, which it names.
    progress : callable, optional
        Called as ``progress(stage, percent, 100)`` a few times a second; an exception that it
        raises ends the run.
    **options
        Those of the program (``gyroakf run --help``), with ``_`` for ``-``: ``rate=100,
        unit="deg/s", drift_tau=10``; ``True``
        for one without a value, a list for one with several.

    Raises
    ------
    UsageError
        The program refuses an option.
    ParseError
        The data cannot be read.

    Examples
    --------
    >>> import gyroakf
    >>> report = gyroakf.run(gyroakf.simulate(preset="paper"))
    >>> report.channels[0]["ar"]["order"]
    1
    """
    import subprocess
    import tempfile  # both take some milliseconds

    stdin = None
    if isinstance(data, Recording):
        options = {
            "rate": repr(data.rate) if data.rate_source != "none" else None,
            "unit": data.units if all(data.units) else None,
            "column": range(1, len(data.names) + 1),  # whatever their names mean in a file
            "time_column": "none",
            **options,
        }
    if isinstance(data, (str, os.PathLike)):
        path = os.fsdecode(data)
        reader = reader_of(path)
        if reader:
            stdin, path = tempfile.TemporaryFile(), "-"
            chosen = (options.pop("topic", None), options.pop("instance", 0))
            stdin.write(as_csv(data, reader, *chosen))
            stdin.seek(0)
    else:
        stdin, path = tempfile.TemporaryFile(), "-"
        if isinstance(data, Recording):
            columns = np.rec.fromarrays(data.values, names=data.names)
        else:
            columns = np.asarray(data)
        if columns.ndim not in (1, 2) or columns.dtype.kind not in "buifV":
            raise TypeError("`data` must hold real numbers, with a column for each channel")
        np.save(stdin, columns)
        stdin.seek(0)
    arguments = []
    for name, value in options.items():
        if value is None or value is False:
            continue
        arguments.append("--" + name.rstrip("_").replace("_", "-"))
        if value is not True:
            arguments.append(
                ",".join(map(str, value))
                if isinstance(value, (list, tuple, range))
                else str(value)
            )
    with tempfile.TemporaryDirectory() as folder:
        document = os.path.join(folder, "run.json")
        bar = ["--progress", "on" if progress else "off"]
        command = [lib.program(), "run", path, "--json", document, *bar, *arguments]
        screen = os.path.join(folder, "run.txt")
        with open(screen, "wb") as file, subprocess.Popen(
            command,
            stdin=stdin or subprocess.DEVNULL,
            stdout=file,
            stderr=subprocess.PIPE,
            env={**os.environ, "LC_ALL": "C.UTF-8", "COLUMNS": "80"},
            encoding="utf-8",
            errors="replace",
        ) as process:
            try:
                said = _follow(cast(Iterable[str], process.stderr), progress)
            except BaseException:
                process.kill()
                raise
        if process.returncode or not os.path.exists(document):
            raise _failure(process.returncode, said)
        with open(document, encoding="utf-8") as file:
            found = json.load(file)
        with open(screen, encoding="utf-8") as file:
            return Report(found, file.read())


def _follow(lines: Iterable[str], progress: Optional[lib.Progress]) -> str:
    """What the program says on standard error, without its progress, which is passed on."""
    said = []
    for line in lines:
        bar = re.match(r"(.+?)  (?:\[[#.]+\] +(\d+) %|[\d.]+ .?B)", line)
        if not bar:
            said.append(line)
        elif progress and bar[2]:
            progress(bar[1], int(bar[2]), 100)
    return "".join(said)


def _failure(code: int, said: str) -> Exception:
    kinds = {1: _errors.UsageError, 2: _errors.ParseError, 3: _errors.NotConvergedError}
    return kinds.get(code, _errors.InternalError)(said.strip() or f"the program ended with {code}")
