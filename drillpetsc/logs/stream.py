"""A log that is being written: its lines as rows in SI, a few at a time. What cannot be read is left out and counted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.files.named_file import cells_of
from drillpetsc.errors import CaseError
from drillpetsc.logs.channels import READINGS, Heading
from drillpetsc.logs.clock import ClockError, clock_times, order_of
from drillpetsc.logs.files import (
    TITLE_LINES,
    Sheet,
    is_log,
    not_a_log,
    possible_headings,
    units_below,
)
from drillpetsc.logs.log import NUMBER, Log, chosen_columns, column_numbers


class LogStream:
    """Lines of a text table with headings -> rows; times count from the first row.

    name: of the source, for messages; mapping: channel -> (title, unit or ""), as for ``read_log``.
    start: clock time of the first row, None without a clock; left_out: reason -> rows.
    """

    def __init__(self, name: str, mapping: dict[str, tuple[str, str]] | None = None) -> None:
        self.name, self._mapping = Path(name), mapping or {}
        self.start: datetime | None = None
        self.left_out: Counter[str] = Counter()
        self._remarks: tuple[str, ...] = ()
        self.titles: dict[str, str] = {}
        self.lines = 0
        self._head: list[str] = []
        self._sheet: Sheet | None = None
        self._mark = ""
        self._columns: dict[str, tuple[int, str]] = {}  # channel -> number, unit
        self._last = -np.inf
        self._order = ""  # of day and month, which later rows need not show

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was assumed about the columns, and which of them are not used."""
        return self._remarks

    @property
    def by_time(self) -> bool:
        """Whether the index is time, else depth."""
        return "time" in self.titles

    @property
    def last(self) -> float | None:
        """Time of the last row [s]; None for a log by depth."""
        return self._last if np.isfinite(self._last) else None

    def go_on(self, last: float, start: str | None) -> None:
        """Leave out rows up to a time [s], which counts from ``start``, a clock time."""
        self._last = last
        self.start = None if start is None else datetime.fromisoformat(start)

    def begin(self, titles: list[str], headings: list[Heading], null: str) -> None:
        """Take columns of lines with commas from elsewhere than a first line; null: text for no value."""
        self._sheet = Sheet(self.name, self.lines, titles, headings, [], self.lines + 1, null)
        self._mark = ","

    def rows(self, lines: Sequence[str]) -> Log | None:
        """The rows of some lines; None if there are none.

        Raises CaseError if the first lines have no headings of a log, or one that cannot be understood without a guess.
        """
        cells: list[list[str]] = []
        for line in lines:
            self.lines += 1
            if not line.strip() or line.lstrip().startswith(("#", "//", "!")):
                continue
            if self._sheet is None:
                self._look_for_headings(line)
                continue
            try:
                row = cells_of(line, self._mark, self.name, self.lines)
            except CaseError:
                row = []
            if len(row) < len(self._sheet.titles) or any(row[len(self._sheet.titles) :]):
                self.left_out["rows of another length than the headings"] += 1
                continue
            cells.append(row)
        return self._read(cells) if cells else None

    # ------------------------------------------------------------------ headings
    def _look_for_headings(self, line: str) -> None:
        self._head.append(line)
        for mark, titles, headings in possible_headings(line, self.name, self.lines):
            if is_log(headings) or self._mapping and {t for t, _ in self._mapping.values()} <= set(titles):
                self._sheet = Sheet(self.name, self.lines, titles, headings, [], self.lines + 1)
                self._mark = mark
                return
        if len(self._head) >= TITLE_LINES:
            raise not_a_log(self.name, 1)

    def _choose(self) -> None:
        """Find the column of each channel."""
        assert self._sheet is not None
        choice = chosen_columns(self._sheet, self._mapping)
        columns = self._columns = choice.column
        depth = columns.pop("depth", None)
        if depth is not None and not columns.keys() & {"bit_depth", "time"}:
            columns["bit_depth"] = depth
        elif depth is not None and "bit_depth" in columns:
            columns.setdefault("hole_depth", depth)
        if "bit_depth" not in columns and "hole_depth" in columns and "time" not in columns:
            columns["bit_depth"] = columns["hole_depth"]
        if "bit_depth" not in columns or not set(columns) & set(READINGS):
            want = "columns of the bit depth and of a reading; --map bit_depth=TITLE:UNIT names one"
            raise CaseError(got=", ".join(self._sheet.titles)[:200], want=want, **self._sheet.place)
        self.titles = {name: self._sheet.titles[j] for name, (j, _) in columns.items() if name != "date"}
        self._remarks = (*choice.remarks, *choice.warnings)

    # ------------------------------------------------------------------ rows
    def _read(self, cells: list[list[str]]) -> Log | None:
        assert self._sheet is not None
        if not self._columns:
            below = units_below(self._sheet.headings, cells[0])
            if below is not None:
                self._sheet, cells = replace(self._sheet, headings=below), cells[1:]
            self._choose()
        if not cells:
            return None
        values: dict[str, FloatArray] = {}
        for name, (j, _) in self._columns.items():
            if name not in ("time", "date"):
                values[name] = self._numbers(name, [row[j] for row in cells])
        if self.by_time:
            values["time"] = self._times(cells)
        index = values["time" if self.by_time else "bit_depth"]
        good = np.isfinite(index)
        self.left_out["rows without " + ("a time" if self.by_time else "a depth")] += int((~good).sum())
        if self.by_time:
            newest = np.fmax.accumulate(np.append(self._last, np.where(good, index, -np.inf)))
            old = good & (index <= newest[:-1])
            self.left_out["rows older than the row before"] += int(old.sum())
            good &= ~old
            self._last = float(newest[-1])
        self.left_out = +self.left_out
        log = Log(values, self.titles, self.start, frozenset(self._mapping)).rows(good)
        return log if len(log) else None

    def _numbers(self, name: str, cells: list[str]) -> FloatArray:
        assert self._sheet is not None
        unit = self._columns[name][1]
        try:
            return column_numbers([self._sheet], name, cells, unit)
        except (CaseError, IndexError):  # some cells are no numbers: they alone are left out
            out = np.full(len(cells), np.nan)
            for i, cell in enumerate(cells):
                try:
                    out[i] = column_numbers([self._sheet], name, [cell], unit)[0]
                except (CaseError, IndexError):
                    self.left_out[f"cells of {self.titles[name]} that are not numbers"] += 1
            return out

    def _times(self, cells: list[list[str]]) -> FloatArray:
        """(n,) seconds since the first row, nan for what is not a time."""
        (j, unit), (day, _) = self._columns["time"], self._columns.get("date", (-1, ""))
        texts = [row[j] for row in cells]
        if "date" in self._columns:
            texts = [f"{row[day]} {text}" for row, text in zip(cells, texts, strict=True)]
        elif self.start is None and NUMBER.fullmatch(texts[0]):
            if not unit:
                want = "a date and time, or a unit: time [s]"
                raise CaseError(at="time", got=texts[0], want=want, file=self.name)
            return self._numbers("time", texts)
        try:
            return self._since_start(texts)
        except ClockError as error:
            first, out = error, np.full(len(texts), np.nan)
        for i, text in enumerate(texts):
            try:
                out[i] = self._since_start([text])[0]
            except ClockError:
                continue
        if self.start is None:
            raise CaseError(at="time", got=texts[first.row], want=first.want, file=self.name)
        return out

    def _since_start(self, texts: list[str]) -> FloatArray:
        seconds, first = clock_times(texts, self._order)
        self._order = order_of(texts, self._order)
        self.start = self.start or first
        return seconds + (first - self.start).total_seconds()
