"""What the C++ side says of itself: names of parameters and results, fields of records, constants
(kernels/core/names.hpp).

Python fills the rows of a kernel by name, so a parameter that moves in C++ moves here too.
"""

from __future__ import annotations

import ctypes
import re
from collections.abc import Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from drillpetsc.arrays import FloatArray
from drillpetsc.kernels import function

_TYPES = {"double": (ctypes.c_double, 1), "int": (ctypes.c_int, 1), "Vec<double>": (ctypes.c_double, 3)}


class Columns:
    """Names of the columns of a table, in order: ``columns["length"]`` is a number, or a slice if it is wider.

    names: the names, in lower case; width: columns in all.
    """

    def __init__(self, label: str, widths: dict[str, int]):
        self.label, self.names, self.width = label, tuple(widths), sum(widths.values())
        start, at = 0, {}
        for name, width in widths.items():
            at[name] = start if width == 1 else slice(start, start + width)
            start += width
        self.at: MappingProxyType[str, int | slice] = MappingProxyType(at)

    def __getitem__(self, name: str) -> Any:
        try:
            return self.at[name]
        except KeyError:
            raise KeyError(f"{self.label} has no {name!r}: it has {', '.join(self.names)}") from None

    def span(self, first: str, last: str) -> slice:
        """The columns from ``first`` to ``last``, both included."""
        start, end = (slice(at, at + 1) if isinstance(at, int) else at for at in (self[first], self[last]))
        return slice(start.start, end.stop)


@cache
def columns(symbol: str) -> Columns:
    """Columns that C++ exports under ``symbol``: parameters of a kernel, results, rows of a table."""
    text = _text(f"{symbol}_columns")
    if ";" in text:  # a record of numbers
        return Columns(symbol, {name: count for _, name, count in _declarations(text)})
    start: dict[str, int] = {}
    names = [part.partition("=") for part in text.lower().split(",")]
    at = 0
    for name, _, value in names:  # "a", or "b = a + 3"
        if value:
            base, _, offset = value.partition("+")
            at = start[base.strip()] + int(offset)
        start[name.strip()] = at
        at += 1
    ends = list(start.values())[1:]  # the last name is the number of columns
    return Columns(symbol, {name: end - at for (name, at), end in zip(start.items(), ends, strict=False)})


@cache
def structure(symbol: str) -> type[Any]:
    """ctypes.Structure of the C++ struct that is exported under ``symbol``; unknown fields raise AttributeError."""
    fields = [
        (name, kind if n == 1 else kind * n) for kind, name, n in _declarations(_text(f"{symbol}_fields"))
    ]
    made = type(symbol, (ctypes.Structure,), {"_fields_": fields, "__slots__": ()})
    if ctypes.sizeof(made) != (size := function(f"{symbol}_size", "", ctypes.c_int)()):
        raise TypeError(f"{symbol} has {size} bytes in C++ and {ctypes.sizeof(made)} here")
    return made


@cache
def constant(symbol: str) -> float:
    """A number that C++ exports under ``symbol``."""
    return float(function(f"{symbol}_constant", "", ctypes.c_double)())


class Table:
    """Rows of numbers whose columns have names, filled by name.

    columns: as C++ exports them; rows: how many; values: one for each name, (rows,) or (rows, width) or what
    numpy spreads over them.  ``array`` (rows, columns) is C-contiguous; ``table[name]`` is a view of it.
    Raises TypeError when a name is left out or unknown.
    """

    def __init__(self, columns: Columns, rows: int, **values: ArrayLike):
        missing, unknown = set(columns.names) - set(values), set(values) - set(columns.names)
        if missing or unknown:
            wrong = [f"not filled: {', '.join(sorted(missing))}"] * bool(missing)
            wrong += [f"unknown: {', '.join(sorted(unknown))}"] * bool(unknown)
            raise TypeError(f"{columns.label}: {'; '.join(wrong)}")
        self.columns, self.array = columns, np.empty((rows, columns.width))
        for name, value in values.items():
            self[name] = value

    @classmethod
    def of(cls, columns: Columns, array: FloatArray) -> Table:
        """The same over an ``array`` (rows, columns) that is there."""
        if array.shape[1:] != (columns.width,):
            raise ValueError(f"{columns.label} has {columns.width} columns, the array is {array.shape}")
        table = cls.__new__(cls)
        table.columns, table.array = columns, array
        return table

    def __getitem__(self, name: str) -> FloatArray:
        return self.array[:, self.columns[name]]

    def __setitem__(self, name: str, value: ArrayLike) -> None:
        self.array[:, self.columns[name]] = value

    def update(self, values: Mapping[str, ArrayLike]) -> None:
        """Set several columns."""
        for name, value in values.items():
            self[name] = value


class Parameters(Table):
    """Parameters of the elements of one kernel: ``Parameters("beam", 3, length=9.0, ...)``."""

    def __init__(self, kernel: str, rows: int, **values: ArrayLike):
        super().__init__(columns(f"{kernel}_parameters"), rows, **values)


def parameters_of(kernel: str, array: FloatArray) -> Table:
    """Parameters (n, p) of a kernel's elements by name, as views."""
    return Table.of(columns(f"{kernel}_parameters"), array)


def _text(symbol: str) -> str:
    return function(symbol, "", ctypes.c_char_p)().decode()


def _declarations(text: str) -> list[tuple[Any, str, int]]:
    """(type, name, length) of each field: "double a, b[3]; const int* c;"."""
    found = []
    for line in filter(None, map(str.strip, text.split(";"))):
        kind, names = re.fullmatch(r"((?:const |signed )*[\w<>]+\s*\*?)\s*(.+)", line).groups()  # type: ignore[union-attr]
        number, width = (ctypes.c_void_p, 1) if "*" in kind else _TYPES[kind.strip()]
        for name in names.split(","):
            word, _, count = name.strip().rstrip("]").partition("[")
            found.append((number, word, width * int(count or 1)))
    return found
