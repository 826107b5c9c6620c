"""Readers of logs that are followed. A reader is an object with the attributes and methods of ``Reader``."""

from __future__ import annotations

import os
import re
import select
import socket
import time
from collections.abc import Callable, Mapping
from datetime import datetime
from importlib.metadata import entry_points
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from drillpetsc.errors import CaseError
from drillpetsc.logs.files import DataTable
from drillpetsc.logs.log import Log, read_log
from drillpetsc.logs.stream import LogStream
from drillpetsc.logs.wits import SYSTEMS, WitsFrames
from drillpetsc.logs.witsml_store import FORM, StoreError, WitsmlStore, place_of

CHUNK = 1 << 16  # bytes of a file that are read at a time
CONNECTED_WITHIN = 10.0  # seconds until a WITS server must have answered
TRIED_EACH = 2.0  # seconds between attempts to connect again
POLLED_EACH = 5.0  # seconds between calls of a WITSML store
TRIED_TIMES = 3  # calls in turn without an answer that end a log which is not waited for
_WITS = re.compile(
    rf"wits:(?P<host>\[[^]]+\]|[^:\[\]]+):(?P<port>\d{{1,5}})(:(?P<units>{'|'.join(SYSTEMS)}))?"
)
WHOLE_FILES = (".las", ".xlsx", ".xlsm", ".xml")  # kinds that are not written line by line


class Reader(Protocol):
    """Where rows come from: SI, in order of time or depth, each once.

    titles: channel -> title of its column, once the headings are known; start: clock time of the first row.
    left_out: reason -> rows that could not be used; remarks: what was assumed about columns and clock; ended: whether nothing can follow.
    trouble: why no rows come at present, empty if nothing is known.
    """

    ended: bool
    trouble: str

    @property
    def titles(self) -> dict[str, str]: ...

    @property
    def start(self) -> datetime | None: ...

    @property
    def left_out(self) -> Mapping[str, int]: ...

    @property
    def remarks(self) -> tuple[str, ...]: ...

    def read(self) -> Log | None:
        """The next rows; None if there are none at the moment."""

    def position(self) -> dict[str, Any]:
        """Where the next rows begin, in JSON types."""

    def go_on_from(self, position: dict[str, Any]) -> None:
        """Continue where another process stopped."""


class _Lines(LogStream):
    """Bytes of a source as lines, and lines as rows; a line that is half written waits for its end."""

    ended, trouble = False, ""

    def __init__(self, source: str, mapping: dict[str, tuple[str, str]]) -> None:
        super().__init__(source, mapping)
        self._rest = b""
        self._encoding = "utf-8-sig"

    def position(self) -> dict[str, Any]:
        """Lines read, and the time of the last row, which counts from the clock time ``start``."""
        start = None if self.start is None else self.start.isoformat()
        return {"lines": self.lines, "last": self.last, "start": start}

    def _rows(self, new: bytes) -> Log | None:
        whole, mark, self._rest = (self._rest + new).rpartition(b"\n")
        return self.rows(self._text(whole).splitlines()) if mark else None

    def _end(self) -> Log | None:
        """The row of a last line without an end."""
        self.ended = True
        lines, self._rest = self._text(self._rest).splitlines(), b""
        return self.rows(lines) if lines else None

    def _text(self, line: bytes) -> str:
        text = line.decode(self._encoding, errors="replace")
        self._encoding = "utf-8"
        return text


class FileReader(_Lines):
    """Lines of a text table in a file that may grow; waits: whether rows may follow after its end."""

    def __init__(self, name: str, mapping: dict[str, tuple[str, str]], waits: bool) -> None:
        super().__init__(name, mapping)
        self.waits = waits
        if not Path(name).is_file():
            want = f"a log that exists, - for standard input, or one of {', '.join(_kinds())}"
            raise CaseError(at="--log", got=name, want=want)
        try:
            self._file = os.open(name, os.O_RDONLY)
        except OSError as error:
            raise CaseError(at="--log", got=name, want="a log that can be read", hint=str(error)) from None

    def read(self) -> Log | None:
        """The rows of the next lines."""
        new = os.read(self._file, CHUNK)
        return self._rows(new) if new or self.waits else self._end()

    def go_on_from(self, position: dict[str, Any]) -> None:
        """Skip the lines that were read."""
        while self.lines < position["lines"] and not self.ended:
            new = os.read(self._file, CHUNK)
            lines = (self._rest + new).split(b"\n")
            missing = position["lines"] - self.lines
            self.rows([self._text(q) for q in lines[:-1][:missing]])
            self._rest = b"\n".join(lines[min(missing, len(lines) - 1) :])
            if not new:
                raise CaseError(
                    at="--log",
                    got=f"{self.name}, {self.lines} lines",
                    want=f"the log that was followed: {position['lines']} lines",
                )


class InputReader(_Lines):
    """Lines of a text table from standard input, which cannot be read again."""

    def __init__(self, mapping: dict[str, tuple[str, str]]) -> None:
        super().__init__("standard input", mapping)

    def read(self) -> Log | None:
        """The rows of the next lines, if some come within a fifth of a second."""
        if not select.select([0], [], [], 0.2)[0]:
            return None
        new = os.read(0, CHUNK)
        return self._rows(new) if new else self._end()

    def go_on_from(self, position: dict[str, Any]) -> None:
        """Leave out rows that are not newer than the last one."""
        if position["last"] is None:
            raise CaseError(
                at="--restart", got="a log by depth from standard input", want="a log by time, or a file"
            )
        self.go_on(position["last"], position["start"])


class WitsReader(_Lines):
    """Frames of WITS level 0 from a TCP server; waits: whether to connect again after the server has closed."""

    def __init__(self, name: str, mapping: dict[str, tuple[str, str]], waits: bool) -> None:
        match = _WITS.fullmatch(name)
        if match is None:
            raise CaseError(
                at="--log", got=name, want="wits:HOST:PORT, with :fps where depths are in feet",
                hint=f"systems of units: {', '.join(SYSTEMS)}",
            )  # fmt: skip
        self._place = (match["host"].strip("[]"), int(match["port"]))
        self._frames = WitsFrames(match["units"] or SYSTEMS[0], mapping)
        super().__init__(name, self._frames.mapping)
        self.waits, self._next_try = waits, 0.0
        try:
            self._socket: socket.socket | None = socket.create_connection(
                self._place, timeout=CONNECTED_WITHIN
            )
        except (OSError, OverflowError) as error:
            raise CaseError(
                at="--log", got=name, want="a WITS server that answers", hint=str(error)
            ) from None

    def read(self) -> Log | None:
        """The rows of the next frames, if some come within a fifth of a second."""
        if self._socket is None:
            self._connect()
            return None
        if not select.select([self._socket], [], [], 0.2)[0]:
            return None
        try:
            new = self._socket.recv(CHUNK)
        except OSError:
            new = b""
        if not new:
            self._socket.close()
            self._socket, self._rest, self.ended = None, b"", not self.waits
            self.trouble = "the server has closed the connection" if self.waits else ""
            return self.rows(self._frames.finish())
        whole, mark, self._rest = (self._rest + new).rpartition(b"\n")
        return self.rows(self._frames.lines(self._text(whole).splitlines())) if mark else None

    @property
    def remarks(self) -> tuple[str, ...]:
        """Also how many rows had no clock, or one that jumped."""
        counts = {
            "frames without a date and time have the time of their arrival, in UTC": self._frames.without_clock,
            "frames whose clock jumped ahead and back were left out": self._frames.ahead,
        }
        return (*super().remarks, *(f"{count} {what}" for what, count in counts.items() if count))

    def _connect(self) -> None:
        """Connect again, once every two seconds."""
        if time.monotonic() < self._next_try:
            return
        self._next_try = time.monotonic() + TRIED_EACH
        try:
            self._socket = socket.create_connection(self._place, timeout=CONNECTED_WITHIN)
            self.trouble = ""
        except OSError:
            self._socket = None

    def go_on_from(self, position: dict[str, Any]) -> None:
        """Leave out rows that are not newer than the last one."""
        self.go_on(position["last"], position["start"])


class WitsmlReader(_Lines):
    """A log of a WITSML store, polled; waits: whether rows may follow after those that it has."""

    def __init__(self, name: str, mapping: dict[str, tuple[str, str]], waits: bool) -> None:
        self._store = WitsmlStore(name)
        super().__init__(name, mapping)
        self.waits, self._next_try = waits, 0.0
        self._index, self._unit = "", ""  # of the last row
        self._titles: list[str] = []
        self._answers = self._failures = self._in_turn = self._repeated = 0
        self._last_failure = ""

    def read(self) -> Log | None:
        """The rows since the last one, if it is time to ask."""
        if time.monotonic() < self._next_try:
            return None
        try:
            table = self._store.rows_from(self._index, self._unit)
            rows = [] if table is None else self._new(table)
            if self._store.more and not rows:
                raise StoreError("the store has more rows, and does not return them")
        except StoreError as error:
            self._fail(error)
            return None
        finally:
            self._next_try = time.monotonic() + POLLED_EACH
        self._answers, self._in_turn, self.trouble = self._answers + 1, 0, ""
        if rows and (self._store.more or not self.waits):
            self._next_try = 0.0
        self.ended = not rows and not self.waits
        return self.rows(rows) if rows else None

    def _new(self, table: DataTable) -> list[str]:
        """Lines of the rows beyond the last index, with the columns of the first answer."""
        if not self._titles:
            self._titles = table.titles
            self.begin(table.titles, table.headings, table.null)
        places = [table.titles.index(name) if name in table.titles else -1 for name in self._titles]
        last, lines = place_of(self._index), []
        asked = bool(self._index)  # the row that was asked from comes again
        for _, cells in table.rows:
            place = place_of(cells[0])
            if place <= last:
                self._repeated += not (asked and place == last)
                asked = asked and place != last
                continue
            last, self._index = (last, self._index) if place != place else (place, cells[0])
            lines.append(",".join("" if j < 0 else cells[j] for j in places))
        self._unit = table.unit
        return lines

    def _fail(self, error: StoreError) -> None:
        """Take note of a poll that gave nothing; at first, and if no other will do better, it ends the log."""
        if not self._answers:
            raise CaseError(
                at="--log",
                got=self._store.name,
                want="a WITSML store that answers with this log",
                hint=str(error),
            ) from None
        self._failures, self._in_turn = self._failures + 1, self._in_turn + 1
        self.trouble = self._last_failure = str(error)
        self.ended = error.final or not self.waits and self._in_turn >= TRIED_TIMES

    @property
    def remarks(self) -> tuple[str, ...]:
        """Also what the store did beside answering with new rows."""
        said = [*super().remarks]
        if self._store.unsafe:
            said.append("user and password went to the store unencrypted: https keeps them secret")
        if self._failures:
            said.append(
                f"{self._failures} polls of the store failed, the last one with: {self._last_failure}"
            )
        if self._repeated:
            said.append(f"{self._repeated} rows that the store repeated were left out")
        return tuple(said)

    def position(self) -> dict[str, Any]:
        """Also the index of the last row, from which the store is asked."""
        return {**super().position(), "index": self._index, "unit": self._unit}

    def go_on_from(self, position: dict[str, Any]) -> None:
        """Ask from the last row on."""
        self._index, self._unit = position["index"], position["unit"]
        if position["last"] is not None:
            self.go_on(position["last"], position["start"])


class WholeReader:
    """A log in a file that is written as a whole: LAS, xlsx, WITSML."""

    def __init__(self, name: str, mapping: dict[str, tuple[str, str]]) -> None:
        self._log = read_log([name], mapping)
        self.titles, self.start = self._log.titles, self._log.start
        self.remarks = (*self._log.remarks, *self._log.warnings)
        self.ended, self.trouble, self._row = False, "", 0

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


#: word before the colon -> reader with (name, mapping, waits), and the form of its name
READERS: dict[str, tuple[Callable[[str, dict[str, tuple[str, str]], bool], Reader], str]] = {
    "wits": (WitsReader, "wits:HOST:PORT"),
    "witsml": (WitsmlReader, FORM),
}
INSTALLED = (
    "drillpetsc.readers"  # group of entry points: readers of installed packages, by the word before the colon
)


def _kinds() -> list[str]:
    return [form for _, form in READERS.values()] + [f"{q.name}:.." for q in entry_points(group=INSTALLED)]


def reader_of(name: str, mapping: dict[str, tuple[str, str]], waits: bool) -> Reader:
    """The reader of a log by its name: ``-``, a word of ``READERS`` or of an installed package and a colon, or a file."""
    if name == "-":
        return InputReader(mapping)
    word, mark, _ = name.partition(":")
    if mark and word in READERS:
        return READERS[word][0](name, mapping, waits)
    for found in entry_points(group=INSTALLED, name=word) if mark else ():
        try:
            made: Reader = found.load()(name, mapping, waits)
        except (ImportError, AttributeError) as error:
            want = "a reader that can be loaded"
            raise CaseError(at="--log", got=f"{word}: {found.value}", want=want, hint=str(error)) from None
        return made
    if Path(name).suffix.casefold() in WHOLE_FILES:
        return WholeReader(name, mapping)
    return FileReader(name, mapping, waits)
