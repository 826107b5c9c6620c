"""A table that grows: each reading parses only what was added since the last one."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

from drillpetsc.output.files.tables import read_titles


class Tail:
    """The rows of a CSV table of numbers that a run may be writing.

    titles: of its columns.
    damaged: number of rows that cannot be read and are left out.
    series: a name of the file; it changes if the file is replaced, and rows count from 0 again.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._forget()

    def _forget(self) -> None:
        self.titles: list[str] = []
        self.damaged = 0
        self.series, self._offset, self._rows, self._parts = "", 0, 0, list[np.ndarray]()

    def read(self) -> str:
        """Read what is new; returns the series.  Raises ValueError for a file without a header."""
        try:
            state = os.stat(self.path)
        except FileNotFoundError:
            self._forget()
            return ""
        series = f"{state.st_dev}-{state.st_ino}"
        if series != self.series or state.st_size < self._offset:
            self._forget()
            self.titles = read_titles(self.path)
            self.series = series
        with open(self.path, "rb") as file:
            file.seek(self._offset)
            new = file.read()
        whole = new.rfind(b"\n") + 1  # the last row may be half written
        lines = new[:whole].decode("utf-8", errors="replace").splitlines()
        if self._offset == 0:
            lines = lines[1:]
        self._offset += whole
        rows = [row for row in (_numbers(line, len(self.titles)) for line in lines) if row is not None]
        if rows:
            self._parts.append(np.array(rows))
            self._rows += len(rows)
        self.damaged += len(lines) - len(rows)
        return self.series

    def __len__(self) -> int:
        return self._rows

    def rows(self, first: int, last: int) -> np.ndarray:
        """Rows (last - first, columns)."""
        if len(self._parts) > 1:
            self._parts = [np.concatenate(self._parts)]
        return self._parts[0][first:last] if self._parts else np.zeros((0, len(self.titles)))

    @property
    def last_time(self) -> float | None:
        """The first value of the last row; None without rows."""
        return float(self._parts[-1][-1, 0]) if self._parts else None


def _numbers(line: str, count: int) -> list[float] | None:
    """The numbers of a row, None if they are not ``count`` numbers."""
    words = line.split(",")
    try:
        return [float(word) for word in words] if len(words) == count else None
    except ValueError:
        return None
