"""CSV tables: header `name [unit]`, SI values, each number written so that reading it gives the same double.

`Table` grows row by row during the run (history.csv, probes.csv); `write_table` writes one whole
(statics.csv, trajectory.csv). A column that belongs to absent physics is simply not in the caller's list.
"""

from __future__ import annotations

import csv
import ctypes
import errno
import hashlib
import io
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache
from itertools import chain
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.files.atomic import replace_text

DIGEST = 16  # bytes of the digest of a table's rows
Column = tuple[str, str]  # name, unit; unit "-" for a pure number
Row = Mapping[str, Any] | Sequence[Any]  # cells by name, or in order


def header(columns: Sequence[Column]) -> list[str]:
    """[("wob", "N")] -> ["wob [N]"]; two equal names are an error."""
    names = [f"{name} [{unit}]" for name, unit in columns]
    if len(set(names)) != len(names):
        raise ValueError(f"two columns with one name: {names}")
    for name in names:
        if any(mark in name for mark in ',"\n\r'):
            raise ValueError(f"a column name that a CSV header cannot hold: {name!r}")
    return names


def split_name(title: str) -> Column:
    """Take "wob [N]" apart into ("wob", "N"); a title without a unit gives unit ""."""
    name, _, unit = title.partition(" [")
    return name.strip(), unit.rstrip("] ")


def _number(value: float) -> str:
    text = repr(float(value))  # shortest text that reads back as the same double
    return text[:-2] if text.endswith(".0") else text


def _line(values: Sequence[float]) -> str:
    """A row of a table with its end; its numbers as ``_number`` writes them, all in one go."""
    return (",".join(map(repr, map(float, values))) + "\n").replace(".0,", ",").replace(".0\n", "\n")


@cache
def _compiled() -> tuple[Callable[..., int], int]:
    """The function that writes rows, and the most characters of a number."""
    from drillpetsc.kernels import function  # here: tables are also read by programs without kernels
    from drillpetsc.kernels.parameters import constant

    return function("write_rows", "iipp", ctypes.c_int), int(constant("text_width"))


def rows_as_text(rows: np.ndarray) -> bytes:
    """Rows (k, m) of a table, numbers as written by ``_number``; by compiled code if its library formats such digits."""
    write, width = _compiled()
    values = np.ascontiguousarray(rows, dtype=float)
    text = np.empty(values.size * width, dtype=np.uint8)
    length = write(*values.shape, values.ctypes.data, text.ctypes.data)
    if length < 0:
        return "".join(map(_line, values.tolist())).encode()
    return text[:length].tobytes()


class Table:
    """An append-only CSV whose first column is the time in seconds.

    Rows go to the operating system in one unbuffered write as they are added (about 15 us for 17 columns), so
    a killed run has lost nothing that was added. With `restart_time` an existing table is continued: rows later than that
    time, and a last row that a full disk or a power cut left incomplete, are dropped first; the columns must
    be as before.
    """

    def __init__(
        self, path: str | os.PathLike, columns: Sequence[Column], *, restart_time: float | None = None
    ) -> None:
        self.path = Path(path)
        self.columns = tuple(columns)
        self._width = len(self.columns)
        self.path.parent.mkdir(parents=True, exist_ok=True)
        first = ",".join(header(self.columns)) + "\n"
        kept: list[str] = []
        if restart_time is not None and self.path.exists() and self.path.stat().st_size > 0:
            kept = self._kept_rows(first, restart_time)
        replace_text(self.path, first + "".join(kept))
        self._digest = hashlib.blake2b("".join(kept).encode(), digest_size=DIGEST)
        self._rows = len(kept)
        self._file = os.open(self.path, os.O_WRONLY | os.O_APPEND)

    def _kept_rows(self, first: str, restart_time: float) -> list[str]:
        lines = self.path.read_text(encoding="utf-8").splitlines(keepends=True)
        if lines[0].strip() != first.strip():
            raise ValueError(
                f"{self.path}: cannot continue a table with other columns: it has {lines[0].strip()}, "
                f"the run has {first.strip()}"
            )
        return whole_rows(lines[1:], self._width, restart_time)

    @property
    def written(self) -> tuple[int, str]:
        """Number of the rows, and a digest of them: a restart compares both with what it finds in the file."""
        return self._rows, self._digest.hexdigest()

    def add(self, row: Sequence[float] | np.ndarray) -> None:
        """row: one number per column, SI; NaN if a value is not known at this time."""
        values = row.tolist() if isinstance(row, np.ndarray) else row
        if len(values) != self._width:
            raise ValueError(f"{self.path.name}: a row of {len(values)} values for {self._width} columns")
        self._write(_line(values).encode())

    def add_rows(self, rows: np.ndarray) -> None:
        """rows: (k, columns), SI; all of them in one write."""
        if len(rows):
            self._write(rows_as_text(rows))

    def _write(self, data: bytes) -> None:
        try:
            written = os.write(self._file, data)
        except OSError as error:
            raise OSError(error.errno, error.strerror, str(self.path)) from None
        if written != len(data):  # on a disk that is full: half a row is of no use
            whole = data.rfind(b"\n", 0, written) + 1
            os.ftruncate(self._file, os.fstat(self._file).st_size - written + whole)
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(self.path))
        self._digest.update(data)
        self._rows += data.count(b"\n")

    def flush(self) -> None:
        """Flush every row to disk (for a checkpoint; a kill of the process needs no flush)."""
        os.fsync(self._file)

    def close(self) -> None:
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def __enter__(self) -> Table:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def whole_rows(lines: Sequence[str], width: int, until: float) -> list[str]:
    """The first rows of ``width`` values that are complete and not later than ``until`` [s]."""
    latest = until * (1 + 1e-12) + 1e-15  # as rows are due (``run_writer.passed``)
    for k, line in enumerate(lines):
        values = line.rstrip("\n").split(",")
        try:
            known = line.endswith("\n") and len(values) == width and float(values[0]) <= latest
        except ValueError:
            known = False
        if not known:
            return list(lines[:k])
    return list(lines)


def rows_written(lines: Sequence[str], width: int, until: float) -> tuple[int, str]:
    """``Table.written`` of the rows of a file up to ``until`` [s]; lines: of the file, without its header."""
    rows = whole_rows(lines, width, until)
    return len(rows), hashlib.blake2b("".join(rows).encode(), digest_size=DIGEST).hexdigest()


def csv_text(heads: Iterable[str], rows: Iterable[Iterable[Any]]) -> str:
    """Headings and rows of cells as the text of a CSV file."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([heads, *rows])
    return text.getvalue()


def write_table(
    path: str | os.PathLike,
    columns: Sequence[Column | Quantity],
    values: Mapping[str, Iterable] | Sequence[Iterable],
) -> Path:
    """Write a whole table, atomically.

    columns: quantities, or their names and units
    values: one array (n,) [unit of its column] per column, in order or by column name; numbers or words.
    """
    titles = [q.column if isinstance(q, Quantity) else q for q in columns]
    names = [name for name, _ in titles]
    if isinstance(values, Mapping):
        if set(values) != set(names):
            raise ValueError(f"{path}: columns {names} but values for {list(values)}")
        values = [values[name] for name in names]
    arrays = [np.asarray(list(value) if not isinstance(value, np.ndarray) else value) for value in values]
    if len(arrays) != len(names) or len({len(array) for array in arrays}) > 1:
        raise ValueError(
            f"{path}: {len(names)} columns need as many arrays of one length, got lengths {[len(a) for a in arrays]}"
        )
    rows = zip(*[[_cell(value) for value in array.tolist()] for array in arrays], strict=True)
    return replace_text(path, csv_text(header(titles), rows))


def write_rows(path: str | os.PathLike, columns: Sequence[Column | Quantity], rows: Iterable[Row]) -> Path:
    """Write a whole table of rows, with cells in order or by the names of quantities; None is nan.  columns: as of ``write_table``."""
    names = [q.name if isinstance(q, Quantity) else q[0] for q in columns]
    cells = [[row[name] for name in names] if isinstance(row, Mapping) else row for row in rows]
    values = [[np.nan if q is None else q for q in column] for column in zip(*cells, strict=True)]
    return write_table(path, columns, values or [[]] * len(columns))


def _cell(value: object) -> str:
    return _number(value) if isinstance(value, int | float) else str(value)


def read_table(path: str | os.PathLike) -> dict[str, np.ndarray]:
    """A table as {"wob [N]": (n,)}; a column of words becomes an array of str.  Raises ValueError if the table is damaged.

    An incomplete last row, left by a run that was cut off or is just writing it, is left out.
    """
    with open(path, encoding="utf-8", newline="") as file:
        titles = _titles(file, path)
        try:
            return _numbers(file, titles)
        except ValueError:  # words, or rows that are wrong
            pass
    text = Path(path).read_text(encoding="utf-8")
    body = list(csv.reader(io.StringIO(text)))[1:]
    if body and (len(body[-1]) != len(titles) or not text.endswith("\n")):
        body.pop()
    if any(len(row) != len(titles) for row in body):
        raise ValueError(f"{path}: a row has not {len(titles)} values as the header has")
    columns = list(zip(*body, strict=True)) if body else [()] * len(titles)
    return {title: _column(title, column, path) for title, column in zip(titles, columns, strict=True)}


def read_numbers(path: str | os.PathLike) -> dict[str, np.ndarray]:
    """A table that has numbers only, such as the histories of a run; ValueError if it has a word."""
    table = read_table(path)
    for title, values in table.items():
        if values.dtype.kind == "U":
            raise ValueError(f"{path}: {title}: wanted numbers in all rows")
    return table


def read_titles(path: str | os.PathLike) -> list[str]:
    """Titles of the columns of a table, without its rows."""
    with open(path, encoding="utf-8", newline="") as file:
        return _titles(file, path)


def _titles(file: Iterable[str], path: str | os.PathLike) -> list[str]:
    titles = next(csv.reader(file), None)
    if titles is None:
        raise ValueError(f"{path} is empty")
    return titles


def _numbers(file: Iterable[str], titles: list[str]) -> dict[str, np.ndarray]:
    """The columns of a table whose cells are all numbers; ValueError for any other. file: its rows.

    A run of a million rows is read in seconds, and takes the memory of its numbers.
    """
    rows = _whole_rows(file, len(titles))
    first = next(rows, None)
    if first is None:
        return {title: np.zeros(0) for title in titles}
    table = np.loadtxt(chain([first], rows), delimiter=",", comments=None, ndmin=2)
    if table.shape[1] != len(titles):
        raise ValueError(f"{table.shape[1]} values in a row, {len(titles)} in the header")
    return dict(zip(titles, table.T, strict=True))


def _whole_rows(file: Iterable[str], count: int) -> Iterator[str]:
    """The rows of a ``file``, without an incomplete last one; count: values in a row."""
    last = None
    for row in file:
        if last is not None:
            yield last
        last = row
    if last is not None and last.endswith("\n") and last.count(",") == count - 1:
        yield last


def _column(title: str, words: Sequence[str], path: str | os.PathLike) -> np.ndarray:
    """Numbers if all cells are; else words, which have no unit."""
    try:
        return np.array([float(word) for word in words])
    except ValueError as error:
        if split_name(title)[1] not in ("", "-"):
            raise ValueError(f"{path}: {title}: {error}") from None
        return np.array(words)
