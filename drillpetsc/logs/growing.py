"""Points out of a log that grows: checks, states and spells as in `import log`, with rows up to now alone.

What comes out does not depend on how many rows come at a time: a row waits until the rows that decide about it are there.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.logs.log import Log
from drillpetsc.logs.points import FLOW_BAND, LONGEST, OPERATION_OF, RPM_BAND, Point, point_of
from drillpetsc.logs.pulls import Pull, Pulls
from drillpetsc.logs.quality import JUMP, WINDOW, far_rows, without_jumps
from drillpetsc.logs.states import Limits, States, states_of

BESIDE = WINDOW + 1  # rows on each side that decide whether a depth jumps
FIRST_ROWS = 21  # rows whose median step is the usual one
STAND_WORDS = ("trip_in", "trip_out", "backream")
FEWEST_IN_SLIPS = 3  # rows that show the weight of the block
ROW, GAP = "row", "gap"  # channels of its own: number of the row, 1 after a gap


@dataclass
class Spell:
    """Rows of a state since it began: (values, weight of the string [N], speed [m/s]) each."""

    word: str
    first: int
    rows: list[tuple[list[float], float, float]] = field(default_factory=list)


class GrowingLog:
    """Points of rows as they come.

    weigh: function from bit depths (k,) [m] to the weight of the string in mud (k,) [N]; block: hook load in slips [N].
    every: length of a point while drilling [m]; titles: channel -> title, which give the channels.
    """

    def __init__(
        self, weigh: Callable[[FloatArray], FloatArray], block: float | None, every: float, titles: dict[str, str],
        limits: Limits | None = None,
    ) -> None:  # fmt: skip
        self.weigh, self.block, self.every, self.titles = weigh, block, every, titles
        self.limits = replace(limits or Limits(), block_weight=block)
        self.channels = [*titles, ROW, GAP]
        self.by_time = "time" in titles
        self.count = 0  # rows taken
        self.dropped = 0  # rows whose depth jumps
        self._window = np.empty((0, len(self.channels)))
        self._next = 0  # number of the first row that is not yet divided
        self._usual = np.nan
        self._spells: dict[str, Spell] = {}
        self._deepest = -np.inf  # of a log by depth, of closed bins
        self._in_slips = False
        self._pulls = Pulls()

    def add(self, log: Log) -> list[tuple[Point | Pull, float]]:
        """Points and pulls that are complete with these rows, in their order, and the time of their last row [s]."""
        new = np.column_stack([*(log.values[name] for name in self.titles), np.zeros((len(log), 2))])
        new[:, -2] = self.count + np.arange(len(log))
        self.count += len(log)
        self._window = np.vstack([self._window, new])
        return self._divided(last=False)

    def finish(self) -> list[tuple[Point | Pull, float]]:
        """Points of the rows that wait: the log has ended."""
        out = self._divided(last=True)
        for word in sorted(self._spells, key=lambda q: self._spells[q].first):
            out += self._close(word)
        return out

    # ------------------------------------------------------------------ rows
    def _divided(self, last: bool) -> list[tuple[Point | Pull, float]]:
        if not len(self._window) or (self.count < FIRST_ROWS and not last):
            return []
        index = self._window[:, self.channels.index("time" if self.by_time else "bit_depth")]
        if np.isnan(self._usual):
            step = np.abs(np.diff(index[:FIRST_ROWS]))
            self._usual = float(np.median(step[step > 0])) if (step > 0).any() else 1.0
        log = Log(dict(zip(self.channels, self._window.T, strict=True)), self.titles)
        if self.by_time:
            log, _ = without_jumps(log)
        else:
            log = log.rows(np.isin(log.values[ROW], without_jumps(log)[0].values[ROW]))
        far = far_rows(log, self._usual)
        weight = self.weigh(log.column("bit_depth"))
        states = states_of(log, weight, self.block, self.limits, far)
        row = log.values[ROW]
        ready = row >= self._next
        limit = self.count if last else self.count - BESIDE
        ready &= row < limit
        edge = 0.0
        if self.by_time:
            edge = self.limits.edge_time + self._usual
            if not last:
                ready &= log.values["time"] < float(index[-1]) - edge
        if not ready.any():
            return []
        end = int(row[ready].max()) + 1
        self.dropped += end - self._next - int(ready.sum())
        self._next = end
        values = np.column_stack([log.values[name] for name in self.channels])
        values[:, -1] = far
        speed = np.nan_to_num(states.speed)
        out: list[tuple[Point | Pull, float]] = []
        for i in np.flatnonzero(ready):
            out += self._pulled(values[i], str(states.word[i]))
            out += self._take(values[i], str(states.word[i]), float(weight[i]), float(speed[i]))
        keep = self._window[:, -2] >= self._next - 2 * BESIDE
        if self.by_time:
            keep |= (
                index >= float(index[int(np.searchsorted(self._window[:, -2], self._next)) - 1]) - 2 * edge
            )
        self._window = self._window[keep]
        return out

    def _pulled(self, row: FloatArray, word: str) -> list[tuple[Pull, float]]:
        """The pull that a row ends."""
        if not self.by_time or "hook_load" not in self.titles:
            return []
        at = dict(zip(self.channels, row.tolist(), strict=True))
        height = at.get("block_position", -at["bit_depth"])
        hangs = (
            word not in ("in_slips", "connection")
            and not at[GAP]
            and not at.get("rpm", 0.0) > self.limits.rotating
        )
        return [
            (q, at["time"])
            for q in self._pulls.take(at["time"], height, at["bit_depth"], at["hook_load"], hangs)
        ]

    # ------------------------------------------------------------------ spells
    def _take(self, row: FloatArray, word: str, weight: float, speed: float) -> list[tuple[Point, float]]:
        """Add a row to its spell; returns the points of the spells that it ends."""
        depth, out = float(row[self.channels.index("bit_depth")]), []
        slips = word in ("in_slips", "connection")
        word = "in_slips" if slips else word
        ended = [key for key, q in self._spells.items() if self._ends(q, row, word, depth)]
        for key in sorted(ended, key=lambda q: self._spells[q].first):
            out += self._close(key)
        key = word
        if word in ("drilling", "slide"):
            place = np.floor(depth / self.every)
            if not self.by_time and place * self.every <= self._deepest:
                return out  # a step back into a row that is closed
            key = f"{word} {place:g}"
        if word in OPERATION_OF or slips:
            spell = self._spells.setdefault(key, Spell(word, int(row[-2])))
            spell.rows.append((row.tolist(), weight, speed))
        return out

    def _ends(self, spell: Spell, row: FloatArray, word: str, depth: float) -> bool:
        """Whether a row ends a spell."""
        first = spell.rows[0][0][self.channels.index("bit_depth")]
        if (
            row[-1]
            or (word == "in_slips") != (spell.word == "in_slips")
            and (word == "in_slips" or word in OPERATION_OF)
        ):
            return True
        if spell.word in ("drilling", "slide"):
            if depth >= (np.floor(first / self.every) + 1) * self.every + (0.0 if self.by_time else JUMP):
                return True
            return self.by_time and word != spell.word and word in OPERATION_OF
        if spell.word in STAND_WORDS:
            return abs(depth - first) >= LONGEST
        return word != spell.word

    def _close(self, key: str) -> list[tuple[Point, float]]:
        """The point of a spell, which is removed; none if it has too few rows."""
        spell = self._spells.pop(key)
        values = np.array([row for row, _, _ in spell.rows])
        log = Log(dict(zip(self.channels, values.T, strict=True)), self.titles)
        time = float(log.values["time"][-1]) if self.by_time else np.nan
        if spell.word in ("drilling", "slide"):
            self._deepest = max(
                self._deepest, float(np.floor(log.values["bit_depth"][0] / self.every) * self.every)
            )
        if spell.word == "in_slips":
            return [(q, time) for q in _slips_point(log)]
        which = _even(log)
        weight, speed = (np.array([row[k] for row in spell.rows]) for k in (1, 2))
        states = States(np.full(len(log), spell.word), self.block, speed)
        found = point_of(log, states, weight, which, spell.word)
        return [(point, time) for point in found]

    # ------------------------------------------------------------------ restart
    def saved(self) -> dict[str, Any]:
        """Everything that a restart needs, in JSON types."""
        return {
            "channels": self.channels, "count": self.count, "dropped": self.dropped, "next": self._next,
            "usual": self._usual, "deepest": self._deepest, "window": self._window.tolist(),
            "spells": {key: [q.word, q.first, q.rows] for key, q in self._spells.items()}, "pulls": self._pulls.saved(),
        }  # fmt: skip

    def restore(self, saved: dict[str, Any]) -> None:
        """Continue from what was saved; nan was written as null."""
        self.count, self.dropped, self._next = saved["count"], saved["dropped"], saved["next"]
        self._usual = np.nan if saved["usual"] is None else saved["usual"]
        self._deepest = -np.inf if saved["deepest"] is None else saved["deepest"]
        self._window = np.array(saved["window"], dtype=float).reshape(-1, len(self.channels))
        self._pulls.restore(saved["pulls"])
        self._spells = {
            key: Spell(
                word, first,
                [(np.array(row, dtype=float).tolist(), np.nan if weight is None else weight, speed) for row, weight, speed in rows],
            )
            for key, (word, first, rows) in saved["spells"].items()
        }  # fmt: skip


def _even(log: Log) -> np.ndarray:
    """Numbers of the rows with the median rotation and flow rate: 3 rpm and 3 % about them."""
    which = np.ones(len(log), dtype=bool)
    for name, band in (("rpm", RPM_BAND), ("flow_rate", 0.0)):
        values = log.column(name)
        if not np.isnan(values).all():
            middle = float(np.nanmedian(values))
            which &= ~(np.abs(values - middle) > (band or FLOW_BAND * abs(middle)))
    return np.flatnonzero(which)


def _slips_point(log: Log) -> list[Point]:
    """The weight of the block, read while the string hangs in the slips."""
    hook = log.column("hook_load")
    hook = hook[~np.isnan(hook)]
    if len(hook) < FEWEST_IN_SLIPS:
        return []
    middle = float(np.median(hook))
    scatter = 1.4826 * float(np.median(np.abs(hook - middle)))
    depth = float(np.median(log.values["bit_depth"]))
    return [Point("in_slips", depth, {"hook_load": middle}, {"hook_load": scatter}, np.nan, len(hook))]
