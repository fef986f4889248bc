# SPDX-License-Identifier: MIT
"""What all results have in common: dictionaries, tables, and their look in a notebook."""

from __future__ import annotations

import dataclasses
import html
from typing import Any, Dict, cast

import numpy as np


def plain(value: Any) -> Any:
    """A value in the types that JSON has."""
    if isinstance(value, Result):
        return value.to_dict()
    if isinstance(value, dict):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return [plain(item) for item in value]
    return value.tolist() if isinstance(value, (np.ndarray, np.generic)) else value


class Result:
    """Base class of the results, which are dataclasses."""

    def to_dict(self) -> Dict[str, Any]:
        """All fields in plain Python types, as for ``json.dumps``."""
        return {name: plain(value) for name, value in self._fields().items()}

    def _fields(self) -> Dict[str, Any]:
        return {
            f.name: getattr(self, f.name)
            for f in dataclasses.fields(cast(Any, self))
            if not f.name.startswith("_")
        }

    def _columns(self) -> Dict[str, Any]:
        """The columns of the table: arrays of the result, otherwise its fields as one row."""
        fields = self._fields()
        arrays = {name: value for name, value in fields.items() if isinstance(value, np.ndarray)}
        return arrays or {name: [plain(value)] for name, value in fields.items()}

    def to_frame(self) -> Any:
        """The table of the result as a ``pandas.DataFrame`` (needs pandas)."""
        import pandas  # type: ignore[import-untyped]

        return pandas.DataFrame(self._columns())

    def _repr_html_(self) -> str:
        columns = self._columns()
        rows = list(zip(*(list(column[:50]) for column in columns.values())))

        def row(tag: str, cells: Any) -> str:
            return (
                "<tr>"
                + "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in cells)
                + "</tr>"
            )

        def shown(cell: Any) -> Any:
            return f"{cell:.6g}" if isinstance(cell, float) else cell

        body = "".join(row("td", map(shown, cells)) for cells in rows)
        return f"<table><caption>{type(self).__name__}</caption>{row('th', columns)}{body}</table>"

    def _axes(self, ax: Any, xlabel: str, ylabel: str) -> Any:
        """The axes for a plot: those given, or new ones of matplotlib."""
        if ax is None:
            import matplotlib.pyplot

            ax = matplotlib.pyplot.figure().gca()
        ax.set_xlabel(xlabel)
        ax.set_ylabel(ylabel)
        return ax
