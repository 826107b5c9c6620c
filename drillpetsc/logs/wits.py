"""WITS level 0: data frames of four-digit items as lines of a text table.

Items and units are those of record 1 (general, time-based) and record 9 (MWD, mechanical) of the Wellsite Information
Transfer Specification, International Association of Drilling Contractors.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from datetime import UTC, datetime

BEGIN, END = "&&", "!!"
TIME = "time"  # title of the column that date and time of a frame make
DATE, CLOCK = "0105", "0106"  # YYMMDD, HHMMSS

#: channel -> (item, metric unit, unit of the feet and pounds system)
ITEMS: dict[str, tuple[str, str, str]] = {
    "bit_depth": ("0108", "m", "ft"),
    "hole_depth": ("0110", "m", "ft"),
    "block_position": ("0112", "m", "ft"),
    "rop": ("0113", "m/h", "ft/h"),
    "hook_load": ("0114", "kdaN", "klbf"),
    "wob": ("0116", "kdaN", "klbf"),
    "torque": ("0118", "kN m", "kft lbf"),
    "rpm": ("0120", "rpm", "rpm"),
    "pump_pressure": ("0121", "kPa", "psi"),
    "flow_rate": ("0130", "l/min", "gal/min"),
    "mud_density": ("0132", "kg/m^3", "ppg"),
    "wob_downhole": ("0915", "kdaN", "klbf"),
    "torque_downhole": ("0917", "kN m", "kft lbf"),
}
SYSTEMS = ("metric", "fps")
AHEAD = 600.0  # jump of the clock that the next row may take back [s]
_ITEM = re.compile(r"(\d{4})(.*)")


class WitsFrames:
    """Frames -> lines of a table that ``LogStream`` reads with ``mapping``; its first line has the headings.

    system: of the units, ``metric`` or ``fps``, which frames do not state; mapping: channel -> (item, unit) that differ.
    """

    def __init__(self, system: str, mapping: Mapping[str, tuple[str, str]]) -> None:
        unit = 1 + SYSTEMS.index(system)
        self.mapping = {name: (row[0], row[unit]) for name, row in ITEMS.items()} | dict(mapping)
        self._items = sorted({item for item, _ in self.mapping.values()})
        self._frame: dict[str, str] | None = None
        self._waiting: dict[str, str] = {}  # the last row, to which frames without a bit depth may add
        self._begun = False
        self._before = ""  # clock of the row before that
        self.without_clock = 0  # rows that have the time of their arrival
        self.ahead = 0  # rows whose clock jumped ahead and back

    def lines(self, text: list[str]) -> list[str]:
        """Lines of the table for whole lines of a feed; what is outside of frames is not data."""
        out = []
        if not self._begun:
            out, self._begun = [",".join([TIME, *self._items])], True
        for line in map(str.strip, text):
            if line == BEGIN:
                self._frame = {}
            elif line == END and self._frame is not None:
                out += self._take(self._frame)
                self._frame = None
            elif self._frame is not None and (item := _ITEM.fullmatch(line)):
                self._frame[item[1]] = item[2].strip().replace(",", ".")
        return out

    def finish(self) -> list[str]:
        """The row that waits, when the feed has ended."""
        kept, self._waiting, self._frame = self._waiting, {}, None
        self._before = kept.get(TIME, self._before)
        return [",".join([kept[TIME], *(kept.get(item, "") for item in self._items)])] if kept else []

    def _take(self, frame: dict[str, str]) -> list[str]:
        """The row before, if a frame begins another one; records of one moment may come in several frames."""
        if self.mapping["bit_depth"][0] in frame:
            clock, last = self._clock(frame), self._waiting.get(TIME, "")
            if clock < last and self._before and _seconds(self._before, last) > AHEAD:
                self.ahead, self._waiting = (
                    self.ahead + 1,
                    {},
                )  # else all rows up to that time would count as old
            ended = [] if self._waiting.get(TIME) == clock else self.finish()
            self._waiting |= frame | {TIME: clock}
            return ended
        if self._waiting:
            self._waiting |= frame | {TIME: self._waiting[TIME]}
        return []

    def _clock(self, frame: dict[str, str]) -> str:
        """Date and time of a frame; of its arrival, in UTC, if it has none that can be read."""
        date, time = (frame.get(item, "").partition(".")[0].zfill(6) for item in (DATE, CLOCK))
        try:
            moment = datetime.strptime(f"{date} {time}", "%y%m%d %H%M%S")
        except ValueError:
            self.without_clock += 1
            moment = datetime.now(UTC).replace(tzinfo=None)
        return moment.isoformat(sep=" ", timespec="milliseconds")


def _seconds(first: str, second: str) -> float:
    return (datetime.fromisoformat(second) - datetime.fromisoformat(first)).total_seconds()
