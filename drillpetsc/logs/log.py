"""A log in SI out of its files: which column is which channel, in which unit, and what was not used."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.importers.stations import MISSING, together
from drillpetsc.errors import CaseError
from drillpetsc.logs.channels import CHANNELS, READINGS, Heading, folded, unit_of
from drillpetsc.logs.clock import ClockError, clock_times
from drillpetsc.logs.files import Sheet, sheet_of
from drillpetsc.units import to_si, wanted

_NOTHING = frozenset({"", "nan", "null", "none", "n/a", "na", "-", "#n/a"})
NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(?:,\d{3})+(?:\.\d*)?")
_FLAGS = {"true": "1", "yes": "1", "on": "1", "false": "0", "no": "0", "off": "0"}
STEP_BACK = 1.0  # of a depth against time, that shows that it is the bit's [m]


@dataclass(frozen=True)
class Log:
    """A log of n rows.

    values: channel -> (n,) SI, nan where nothing was read; `time` counts from the first row.
    titles: channel -> title of its column.
    start: time of the first row, None for a log without a clock; begins: seconds of the first row, 0 for one with a clock.
    mapped: channels whose column the user named.
    unused: titles of columns that are not used; remarks: what was assumed; warnings: what is wrong with a column.
    """

    values: dict[str, FloatArray]
    titles: dict[str, str]
    start: datetime | None = None
    mapped: frozenset[str] = frozenset()
    unused: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    begins: float = 0.0

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))

    @property
    def by_time(self) -> bool:
        """Whether the index is time, else depth."""
        return "time" in self.values

    @property
    def index(self) -> FloatArray:
        """(n,) times [s], or depths of the bit [m]."""
        return self.values["time" if self.by_time else "bit_depth"]

    def column(self, channel: str) -> FloatArray:
        """(n,) SI; nan throughout for a channel that the log has not."""
        found = self.values.get(channel)
        return np.full(len(self), np.nan) if found is None else found

    def rows(self, which: np.ndarray) -> Log:
        """Rows of a mask or by their numbers."""
        return replace(self, values={name: column[which] for name, column in self.values.items()})


@dataclass
class _Choice:
    """Columns of a table: channel -> (number, unit); what was said on the way."""

    column: dict[str, tuple[int, str]] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


def read_map(texts: Sequence[str]) -> dict[str, tuple[str, str]]:
    """channel -> (title, unit or "") of options such as `hook_load=HKLD:t`."""
    out = {}
    for text in texts:
        channel, mark, rest = text.partition("=")
        channel = channel.strip()
        if not mark or channel not in CHANNELS or not rest.strip():
            want = f"CHANNEL=TITLE or CHANNEL=TITLE:UNIT with a channel of {', '.join(CHANNELS)}"
            raise CaseError(at="--map", got=text, want=want)
        title, _, unit = rest.rpartition(":") if ":" in rest else (rest, "", "")
        if unit and (not CHANNELS[channel].unit or not unit_of(unit, CHANNELS[channel].unit)):
            raise CaseError(at="--map", got=text, want=wanted(CHANNELS[channel].unit))
        out[channel] = title.strip(), unit.strip()
    return out


def read_log(files: Sequence[str | Path], mapping: dict[str, tuple[str, str]] | None = None) -> Log:
    """The log in one or several files of the same columns, in SI.

    mapping: channel -> (title of its column, unit or ""), which outranks what the headings say.
    Raises CaseError for what cannot be read or understood without a guess.
    """
    sheets = [sheet_of(Path(file)) for file in files]
    for other in sheets[1:]:
        if other.titles != sheets[0].titles:
            want = f"the columns of {sheets[0].file.name}: one log, in several files"
            raise CaseError(got=", ".join(other.titles)[:160], want=want, **other.place)
    choice = chosen_columns(sheets[0], mapping or {})
    values: dict[str, FloatArray] = {}
    start: datetime | None = None
    texts = {
        name: [q for sheet in sheets for q in sheet.columns[j]] for name, (j, _) in choice.column.items()
    }
    begins = 0.0
    if "time" in texts:
        values["time"], start = _times(sheets, texts, choice.column["time"][1])
        if (
            start is None
        ):  # without a clock they are seconds, of which the first ones say where the log begins
            begins = float(values["time"][0])
            values["time"] = values["time"] - begins
    for name, cells in texts.items():
        if name not in ("time", "date"):
            values[name] = column_numbers(sheets, name, cells, choice.column[name][1])
    used = [j for j, _ in choice.column.values()]
    log = Log(
        values,
        {name: sheets[0].titles[j] for name, (j, _) in choice.column.items() if name != "date"},
        start,
        frozenset(mapping or {}),
        tuple(t for j, t in enumerate(sheets[0].titles) if t and j not in used),
        begins=begins,
    )
    log = _in_order(_with_depths(log, sheets[0], choice.remarks), choice)
    if not set(log.values) & set(READINGS):
        got = ", ".join(sheets[0].titles)[:200]
        raise CaseError(got=got, want="a column of a reading", **sheets[0].place)
    return replace(log, remarks=tuple(choice.remarks), warnings=tuple(choice.warnings))


# ---------------------------------------------------------------------- columns
def chosen_columns(sheet: Sheet, mapping: dict[str, tuple[str, str]]) -> _Choice:
    """The column of each channel, by the mapping and by the headings."""
    out, said = _Choice(), list(sheet.headings)
    for channel, (title, unit) in mapping.items():
        same = [j for j, t in enumerate(sheet.titles) if t == title] or [
            j for j, t in enumerate(sheet.titles) if folded(t) == folded(title)
        ]
        if len(same) != 1:
            want = f"one of {', '.join(t for t in sheet.titles if t)}"[:400]
            raise CaseError(at="--map", got=f"{channel}={title}", want=want, **sheet.place)
        own = said[same[0]].unit if said[same[0]].channel == channel else ""
        said = [Heading("") if h.channel == channel else h for h in said]
        known = unit_of(unit, CHANNELS[channel].unit) if unit else own
        said[same[0]] = Heading(channel, known or "")
    found: dict[str, list[int]] = {}
    for j, heading in enumerate(said):
        if heading.channel:
            found.setdefault(heading.channel, []).append(j)
    errors = []
    for channel, columns in found.items():
        try:
            j = _one(sheet, channel, columns, said, out, timed="time" in found)
            said[j] = _checked(sheet, j, said[j])
        except CaseError as error:
            errors.append(error)
            continue
        if said[j].wrong:
            what = f"{sheet.titles[j]}: {said[j].wrong} in the place of {wanted(CHANNELS[channel].unit).split(',')[0]}"
            out.warnings.append(
                f"{what}; the column is not used (--map {channel}={sheet.titles[j]}:UNIT names its unit)"
            )
        else:
            out.column[channel] = j, said[j].unit
    if errors:
        raise together(errors)
    return out


def _one(
    sheet: Sheet, channel: str, columns: list[int], said: list[Heading], out: _Choice, timed: bool
) -> int:
    """The column of a channel that several columns may name: one average beside others is that over the log's own index."""
    if len(columns) > 1 and all(said[j].window for j in columns):
        over_time = [j for j in columns if not said[j].window.endswith(("ft", "m"))]
        best = over_time if timed else [j for j in columns if j not in over_time]
        if len(best) == 1:
            others = ", ".join(sheet.titles[j] for j in columns if j != best[0])
            out.remarks.append(
                f"{channel} is {sheet.titles[best[0]]}, not {others}: the average along {'time' if timed else 'depth'}"
            )
            return best[0]
    if len(columns) > 1:
        names = ", ".join(sheet.titles[j] for j in columns)
        hint = f"choose it: --map {channel}={sheet.titles[columns[0]]}"
        raise CaseError(at=channel, got=names, want="one column", hint=hint, **sheet.place)
    return columns[0]


def _checked(sheet: Sheet, j: int, heading: Heading) -> Heading:
    """The heading with its unit; CaseError where none is known, or that of a hook load or depth is of another kind."""
    channel = CHANNELS[heading.channel]
    if heading.wrong and (
        heading.channel in ("hook_load", "bit_depth", "hole_depth", "depth") or "unknown" in heading.wrong
    ):
        want = f"{wanted(channel.unit)}; or --map {heading.channel}={sheet.titles[j]}:UNIT"
        raise CaseError(
            at=heading.channel, got=f"{sheet.titles[j]}: {heading.wrong}", want=want, **sheet.place
        )
    if heading.wrong or heading.unit or not channel.unit or heading.channel == "time":
        return heading
    if channel.assumed:
        return replace(heading, unit=channel.assumed)
    want = f"a unit: in brackets, after an underscore, or by --map {heading.channel}={sheet.titles[j]}:UNIT"
    raise CaseError(at=heading.channel, got=f"{sheet.titles[j]} without a unit", want=want, **sheet.place)


# ---------------------------------------------------------------------- cells
def _place(sheets: list[Sheet], row: int) -> dict[str, Any]:
    """File and line of a row of the joined table, for messages."""
    for sheet in sheets:
        count = len(sheet.columns[0])
        if row < count:
            return {"file": sheet.file, "line": sheet.first + row}
        row -= count
    raise IndexError(row)


def column_numbers(sheets: list[Sheet], channel: str, cells: list[str], unit: str) -> FloatArray:
    """(n,) SI of texts, nan for those that mean nothing."""
    nulls = {sheet.null for sheet in sheets} - {""}
    gone = np.array([q.casefold() in _NOTHING or q in nulls for q in cells])
    some = [_FLAGS.get(q.casefold(), q) if channel == "in_slips" else q for q in cells]
    if any("," in q for q in some):
        some = _without_commas(sheets, channel, some)
    out = np.full(len(cells), np.nan)
    here = np.flatnonzero(~gone)
    out[here] = [_number(some[i]) for i in here.tolist()]
    wrong = here[~np.isfinite(out[here])]
    if len(wrong):
        i, want = int(wrong[0]), f"a number in {unit}" if unit else "a number"
        raise CaseError(at=channel, got=cells[i], want=want, **_place(sheets, i))
    out[np.isin(out, [*MISSING, *(float(q) for q in nulls if re.fullmatch(r"[+-]?\d+(\.\d*)?", q))])] = np.nan
    if not unit:
        return out
    zero, one = (to_si(f"{q} {unit}", CHANNELS[channel].unit) for q in (0, 1))
    return zero + (one - zero) * out


def _number(text: str) -> float:
    """The number of a text; nan for any other text, and for the digits and marks that Python allows but logs do not have."""
    try:
        return float(text) if text.isascii() and "_" not in text else np.nan
    except ValueError:
        return np.nan


def _without_commas(sheets: list[Sheet], channel: str, cells: list[str]) -> list[str]:
    """Numbers with a point: a comma is that of decimals or of thousands, as the column shows."""
    with_comma = [(i, q) for i, q in enumerate(cells) if "," in q]
    if all(_THOUSANDS.fullmatch(q) for _, q in with_comma):
        if any("." in q for _, q in with_comma):
            return [q.replace(",", "") for q in cells]
        row, got = with_comma[0]
        want, hint = (
            "numbers that show what the comma is",
            f"{got} may be {got.replace(',', '')} or {got.replace(',', '.')}",
        )
        raise CaseError(at=channel, got=got, want=want, hint=hint, **_place(sheets, row))
    return [q.replace(",", ".") if q.count(",") == 1 and "." not in q else q for q in cells]


def _times(sheets: list[Sheet], texts: dict[str, list[str]], unit: str) -> tuple[FloatArray, datetime | None]:
    """(seconds since the first row and its time; without a clock seconds as written, and None)."""
    cells = texts["time"]
    if "date" in texts:
        cells = [f"{day} {clock}" for day, clock in zip(texts["date"], cells, strict=True)]
    elif all(NUMBER.fullmatch(q) for q in cells):
        if not unit:
            want = "a date and time, or a unit: time [s]"
            raise CaseError(at="time", got=cells[0], want=want, **_place(sheets, 0))
        return column_numbers(sheets, "time", cells, unit), None
    try:
        return clock_times(cells)
    except ClockError as error:
        place = _place(sheets, error.row)
        raise CaseError(at="time", got=cells[error.row], want=error.want, **place) from None


# ---------------------------------------------------------------------- depths and order
def _with_depths(log: Log, sheet: Sheet, remarks: list[str]) -> Log:
    """The log with `bit_depth`, and `hole_depth` where it is known, from a column that is a `depth` alone."""
    values, titles = dict(log.values), dict(log.titles)
    depth, title = values.pop("depth", None), titles.pop("depth", "")
    falls = depth is not None and bool((np.fmax.accumulate(depth) - depth > STEP_BACK).any())
    if depth is not None and "bit_depth" in values:
        if "hole_depth" in values or falls:
            remarks.append(f"{title} is not used beside {titles['bit_depth']}")
            return replace(log, values=values, titles=titles, unused=(*log.unused, title))
        values["hole_depth"], titles["hole_depth"] = depth, title
        remarks.append(f"{title}, which never falls, is taken as the depth of the hole")
    elif depth is not None and (falls or not log.by_time):
        values["bit_depth"], titles["bit_depth"] = depth, title
        if log.by_time:
            remarks.append(f"{title}, which rises and falls, is taken as the depth of the bit")
    elif depth is not None:
        want = f"--map bit_depth={title} or --map hole_depth={title}"
        raise CaseError(at="depth", got=f"{title}, which never falls", want=want, **sheet.place)
    if not log.by_time:
        known = values.get("bit_depth", values.get("hole_depth"))
        assert known is not None
        values.setdefault("bit_depth", known)
        titles.setdefault("bit_depth", titles.get("hole_depth", ""))
    return replace(log, values=values, titles=titles)


def _in_order(log: Log, choice: _Choice) -> Log:
    """The rows with an index; those of a log by time in its order, each time once."""
    gone, name = np.isnan(log.index), "time" if log.by_time else "depth"
    if gone.any():
        choice.remarks.append(f"{int(gone.sum())} rows without {name} are left out")
        log = log.rows(~gone)
    if not len(log):
        raise CaseError(at=name, got="no row with a value", want="at least one")
    if not log.by_time:
        return log
    time = log.values["time"]
    if len(time) > 1 and (np.diff(time) < 0).all():
        choice.remarks.append("time runs backwards in the file: the rows are reversed")
    elif (np.diff(time) < 0).any():
        choice.warnings.append(f"time steps back {int((np.diff(time) < 0).sum())} times: the rows are sorted")
    order = np.argsort(time, kind="stable")
    first = np.append(True, np.diff(time[order]) > 0)
    if not first.all():
        choice.remarks.append(f"{int((~first).sum())} rows with the time of the row before are left out")
    log = log.rows(order[first])
    shift = float(log.values["time"][0])
    return _shifted(log, shift) if shift else log


def _shifted(log: Log, shift: float) -> Log:
    from datetime import timedelta

    start = None if log.start is None else log.start + timedelta(seconds=shift)
    begins = log.begins + shift if log.start is None else 0.0
    return replace(log, start=start, begins=begins, values={**log.values, "time": log.values["time"] - shift})


def between(log: Log, text: str | None) -> Log:
    """The rows from A to B of a text `A,B`: clock times, or elapsed times or depths with their units; raises CaseError."""
    if text is None:
        return log
    index, unit = log.index, "s" if log.by_time else "m"
    parts = [part.strip() for part in text.split(",")]
    try:
        if log.start is not None and len(parts) == 2 and ":" in text:
            from datetime import UTC, datetime

            times = [datetime.fromisoformat(part) for part in parts]
            times = [t.replace(tzinfo=UTC) if t.tzinfo is None else t for t in times]
            low, high = ((t - log.start).total_seconds() for t in times)
        else:
            low, high = (to_si(part, unit) for part in parts)
    except ValueError:  # UnitError is one
        want = (
            "two clock times, such as 2020-12-31T01:00,2020-12-31T15:00"
            if log.start
            else f"two values, such as 1900 {unit},2400 {unit}"
        )
        raise CaseError(at="--between", got=text, want=want) from None
    which = (index >= low) & (index < high)
    if not which.any():
        raise CaseError(at="--between", got=text, want="a part of the log that has rows")
    log = log.rows(which)
    return _shifted(log, float(log.values["time"][0])) if log.by_time else log
