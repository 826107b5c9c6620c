"""Readers of logs that are followed. A reader is an object with the attributes and methods of ``Reader``."""

from __future__ import annotations

import os
import select
from collections.abc import Mapping
from datetime import datetime
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.logs.log import Log, read_log
from drillpetsc.logs.stream import LogStream

CHUNK = 1 << 16  # bytes of a file that are read at a time
WHOLE_FILES = (".las", ".xlsx", ".xlsm", ".xml")  # kinds that are not written line by line


class Reader(Protocol):
    """Where rows come from: SI, in order of time or depth, each once.

    titles: channel -> title of its column, once the headings are known; start: clock time of the first row.
    left_out: reason -> rows that could not be used; ended: whether nothing can follow.
    """

    ended: bool

    @property
    def titles(self) -> dict[str, str]: ...

    @property
    def start(self) -> datetime | None: ...

    @property
    def left_out(self) -> Mapping[str, int]: ...

    def read(self) -> Log | None:
        """The next rows; None if there are none at the moment."""

    def position(self) -> dict[str, Any]:
        """Where the next rows begin, in JSON types."""

    def go_on_from(self, position: dict[str, Any]) -> None:
        """Continue where another process stopped."""


class TextReader:
    """Lines of a text table: of a file that may grow, or of standard input (``-``).

    waits: whether rows may follow after the end of the file.
    """

    def __init__(self, name: str, mapping: dict[str, tuple[str, str]], waits: bool) -> None:
        self.name, self.waits, self.ended = name, waits, False
        self.stream = LogStream("standard input" if name == "-" else name, mapping)
        self._rest = b""
        self._encoding = "utf-8-sig"
        if name == "-":
            self._file = 0
            return
        if not Path(name).is_file():
            raise CaseError(at="--log", got=name, want="a log that exists, or - for standard input")
        try:
            self._file = os.open(name, os.O_RDONLY)
        except OSError as error:
            raise CaseError(at="--log", got=name, want="a log that can be read", hint=str(error)) from None

    @property
    def titles(self) -> dict[str, str]:
        """Channel -> title of its column."""
        return self.stream.titles

    @property
    def start(self) -> datetime | None:
        """Clock time of the first row."""
        return self.stream.start

    @property
    def left_out(self) -> Mapping[str, int]:
        """Reason -> rows."""
        return self.stream.left_out

    def read(self) -> Log | None:
        """The rows of the next lines; a line that is half written waits for its end."""
        if self.name == "-" and not select.select([0], [], [], 0.2)[0]:
            return None
        new = os.read(self._file, CHUNK)
        if not new and (self.name == "-" or not self.waits):
            self.ended = True
            lines, self._rest = self._text(self._rest).splitlines(), b""
            return self.stream.rows(lines) if lines else None
        whole, mark, rest = (self._rest + new).rpartition(b"\n")
        self._rest = rest
        return self.stream.rows(self._text(whole).splitlines()) if mark else None

    def _text(self, line: bytes) -> str:
        text = line.decode(self._encoding, errors="replace")
        self._encoding = "utf-8"
        return text

    def position(self) -> dict[str, Any]:
        """Lines read; of standard input, which cannot be read again, the time of the last row."""
        start = None if self.start is None else self.start.isoformat()
        return {"lines": self.stream.lines, "last": self.stream.last, "start": start}

    def go_on_from(self, position: dict[str, Any]) -> None:
        """Skip the lines that were read; from standard input, rows that are not newer than the last one."""
        if self.name == "-":
            if position["last"] is None:
                raise CaseError(
                    at="--restart", got="a log by depth from standard input", want="a log by time, or a file"
                )
            self.stream.go_on(position["last"], position["start"])
            return
        while self.stream.lines < position["lines"] and not self.ended:
            new = os.read(self._file, CHUNK)
            lines = (self._rest + new).split(b"\n")
            missing = position["lines"] - self.stream.lines
            self.stream.rows([self._text(q) for q in lines[:-1][:missing]])
            self._rest = b"\n".join(lines[min(missing, len(lines) - 1) :])
            if not new:
                raise CaseError(
                    at="--log",
                    got=f"{self.name}, {self.stream.lines} lines",
                    want=f"the log that was followed: {position['lines']} lines",
                )


class WholeReader:
    """A log in a file that is written as a whole: LAS, xlsx, WITSML."""

    def __init__(self, name: str, mapping: dict[str, tuple[str, str]]) -> None:
        self._log = read_log([name], mapping)
        self.titles, self.start = self._log.titles, self._log.start
        self.ended, self._row = False, 0

    @property
    def left_out(self) -> Mapping[str, int]:
        """Nothing: what cannot be read is an error of the file."""
        return {}

    def read(self) -> Log | None:
        """Some hundred rows at a time."""
        rows = np.arange(self._row, min(self._row + 500, len(self._log)))
        self._row += len(rows)
        self.ended = self._row >= len(self._log)
        return self._log.rows(rows) if len(rows) else None

    def position(self) -> dict[str, Any]:
        """Rows read."""
        return {"rows": self._row}

    def go_on_from(self, position: dict[str, Any]) -> None:
        """Skip the rows that were read."""
        self._row = position["rows"]


def reader_of(name: str, mapping: dict[str, tuple[str, str]], waits: bool) -> Reader:
    """The reader of a log by its name: ``-``, or a file."""
    if name != "-" and Path(name).suffix.casefold() in WHOLE_FILES:
        return WholeReader(name, mapping)
    return TextReader(name, mapping, waits)
