"""Rig states of a log: one word a row, from hook load, depth, rotation and flow."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Annotated, get_type_hints

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import CaseError
from drillpetsc.logs.log import Log
from drillpetsc.logs.quality import WEIGHT_OFF_BOTTOM
from drillpetsc.units import UnitError, to_si

STATES = (
    *("in_slips", "connection", "edge", "trip_in", "trip_out", "ream_down", "backream"),
    *("hanging", "circulate", "rotate_off", "drilling", "slide", "unknown"),
)
LIGHTEST_BLOCK = to_si("300 kN", "N")  # hook load below which no window of the block is looked for
BLOCK_WINDOW = 1.02  # ends of the window that holds most readings in slips
FEWEST_IN_SLIPS = 0.01  # share of rows near the block's weight that shows it


@dataclass(frozen=True)
class Limits:
    """Figures of the states, SI; the option `--states KEY=VALUE` changes them.

    slips_share: of the string's weight that the hook carries in slips at most; edge_time: after or before a change of slips.
    moving, still: speeds of the bit above and below which it moves and stands.
    rotating, pumping: rotation and flow from which the string turns and the pump runs.
    bottom: height above the end of the hole within which the bit is on bottom; weight: on the bit, that drills.
    connection: distance that the bit moves at a connection.
    """

    slips_share: Annotated[float, ""] = 0.25
    edge_time: Annotated[float, "s"] = 20.0
    moving: Annotated[float, "m/s"] = 0.03
    still: Annotated[float, "m/s"] = 0.005
    rotating: Annotated[float, "rad/s"] = to_si("10 rpm", "rad/s")
    pumping: Annotated[float, "m^3/s"] = to_si("100 l/min", "m^3/s")
    bottom: Annotated[float, "m"] = 0.3
    weight: Annotated[float, "N"] = WEIGHT_OFF_BOTTOM
    connection: Annotated[float, "m"] = 2.0
    block_weight: Annotated[float | None, "N"] = None


def read_limits(texts: Sequence[str]) -> Limits:
    """Limits with the changes of options such as `edge_time=14 s`; raises CaseError."""
    units = {name: hint.__metadata__[0] for name, hint in get_type_hints(Limits, include_extras=True).items()}
    changes: dict[str, float] = {}
    for text in texts:
        key, mark, value = (part.strip() for part in text.partition("="))
        if not mark or key not in units:
            raise CaseError(
                at="--states",
                got=text,
                want=f"KEY=VALUE with a key of {', '.join(f.name for f in fields(Limits))}",
            )
        try:
            changes[key] = to_si(value, units[key])
        except UnitError as error:
            raise CaseError(at="--states", got=text, want=error.want, hint=error.hint) from None
        if not changes[key] >= 0:
            raise CaseError(at="--states", got=text, want="at least 0")
    return replace(Limits(), **changes)


def block_weight(log: Log, weight: FloatArray, given: float | None, limits: Limits) -> float | None:
    """Hook load in slips [N]: the densest window of 2 %, None where the log does not show it and none is given.

    weight: (n,) of the string in mud [N]; given: block weight of the case.
    """
    if limits.block_weight is not None:
        return limits.block_weight
    hook = log.column("hook_load")
    light = (hook > LIGHTEST_BLOCK) & ~np.isnan(hook + weight)
    if given is not None:
        light &= hook < given + limits.slips_share * weight
        if light.sum() < FEWEST_IN_SLIPS * len(log):
            return given
    some = np.sort(hook[light])
    if not len(some):
        return given
    count = np.searchsorted(some, some * BLOCK_WINDOW) - np.arange(len(some))
    best = int(np.argmax(count))
    mode = float(np.median(some[best : best + max(int(count[best]), 1)]))
    if given is not None:
        return mode
    carried = np.nanpercentile(hook - 0.5 * weight, 95)  # some rows carry half the string above the block
    return mode if carried > mode else None


@dataclass(frozen=True)
class States:
    """States of n rows.

    word: (n,) of `STATES`; block: hook load in slips [N], None where unknown; speed: (n,) of the bit, down positive [m/s].
    """

    word: np.ndarray
    block: float | None
    speed: FloatArray

    @property
    def in_slips(self) -> np.ndarray:
        """(n,) mask."""
        return (self.word == "in_slips") | (self.word == "connection")

    def count(self) -> dict[str, int]:
        """state -> rows."""
        return {state: int((self.word == state).sum()) for state in STATES if (self.word == state).any()}


def states_of(log: Log, weight: FloatArray, given: float | None, limits: Limits, far: np.ndarray) -> States:
    """The state of each row.

    weight: (n,) of the string in mud at the row's depth [N], nan where unknown: slips are not told there then.
    given: block weight of the case [N]; far: (n,) mask of rows after a gap.
    """
    rpm, flow = log.column("rpm"), log.column("flow_rate")
    turning, pumping = rpm > limits.rotating, flow > limits.pumping
    if not log.by_time:
        on_bottom = (log.column("rop") > 0) | ("rop" not in log.values)
        word = np.select([on_bottom & turning, on_bottom & pumping], ["drilling", "slide"], "unknown")
        return States(word.astype("<U10"), None, np.full(len(log), np.nan))
    time, depth, hook = log.values["time"], log.column("bit_depth"), log.column("hook_load")
    block = block_weight(log, weight, given, limits)
    slips, known = _slips(hook, weight, block, limits)
    edge = ~slips & _near_a_change(slips, time, limits.edge_time)
    back, ahead = _speeds(time, depth, far)
    up_or_down = np.sign(back) == np.sign(ahead)
    moving = up_or_down & (np.abs(back) > limits.moving) & (np.abs(ahead) > limits.moving)
    still = (np.abs(back) < limits.still) & (np.abs(ahead) < limits.still)
    on_bottom = log.column("hole_depth") - depth < limits.bottom
    weighted = (log.column("wob") > limits.weight) | (np.isnan(log.column("wob")) & (log.column("rop") > 0))
    dry = ~pumping & ~np.isnan(flow)
    word = np.select(
        [
            slips,
            edge,
            on_bottom & turning & weighted,
            on_bottom & ~turning & ~np.isnan(rpm) & pumping & ~moving & weighted,
            on_bottom & weighted & np.isnan(rpm),  # it drills or slides
            moving & (back > 0) & turning,
            moving & (back < 0) & turning,
            moving & (back > 0),
            moving & (back < 0),
            still & turning,
            still & pumping,
            still & dry & known,
        ],
        [
            *("in_slips", "edge", "drilling", "slide", "unknown", "ream_down", "backream"),
            *("trip_in", "trip_out", "rotate_off", "circulate", "hanging"),
        ],
        "unknown",
    ).astype("<U10")
    speed = np.where(np.isnan(back), ahead, np.where(np.isnan(ahead), back, 0.5 * (back + ahead)))
    _mark_connections(word, depth, limits)
    return States(word, block, speed)


def _slips(
    hook: FloatArray, weight: FloatArray, block: float | None, limits: Limits
) -> tuple[np.ndarray, np.ndarray]:
    """(mask of rows in slips, mask of rows where that can be told)."""
    if block is None:
        return np.zeros(len(hook), dtype=bool), np.zeros(len(hook), dtype=bool)
    known = ~np.isnan(hook) & (weight > 0.1 * block)  # of a lighter string the hook load does not show it
    return known & (hook < block + limits.slips_share * weight), known


def _near_a_change(slips: np.ndarray, time: FloatArray, within: float) -> np.ndarray:
    """(n,) mask of rows within a time of the first row after a change of slips."""
    changes = time[1:][slips[1:] != slips[:-1]]
    if not len(changes):
        return np.zeros(len(time), dtype=bool)
    place = np.searchsorted(changes, time)
    before = time - changes[np.maximum(place - 1, 0)]
    after = changes[np.minimum(place, len(changes) - 1)] - time
    return (np.abs(before) <= within) | (np.abs(after) <= within)


def _speeds(time: FloatArray, depth: FloatArray, far: np.ndarray) -> tuple[FloatArray, FloatArray]:
    """((n,) backward, (n,) forward difference of the depth [m/s], nan across a gap)."""
    speed = np.diff(depth) / np.diff(time)
    speed[far[1:]] = np.nan
    return np.append(np.nan, speed), np.append(speed, np.nan)


def _mark_connections(word: np.ndarray, depth: FloatArray, limits: Limits) -> None:
    """Name slips between two moves of the same direction, in which the bit moves less than `limits.connection`."""
    starts = np.flatnonzero(np.append(True, word[1:] != word[:-1]))
    ends = np.append(starts[1:], len(word))
    direction = {"trip_in": 1, "ream_down": 1, "drilling": 1, "slide": 1, "trip_out": -1, "backream": -1}
    moves = np.array([direction.get(str(word[s]), 0) for s in starts])
    for i in np.flatnonzero(word[starts] == "in_slips"):
        before, after = moves[:i][moves[:i] != 0][-1:], moves[i + 1 :][moves[i + 1 :] != 0][:1]
        span = depth[starts[i] : ends[i]]
        if len(before) and len(after) and before[0] == after[0] and np.ptp(span) < limits.connection:
            word[starts[i] : ends[i]] = "connection"


def spells(word: np.ndarray, cut: np.ndarray) -> list[tuple[int, int]]:
    """(first row, row after the last) of each run of one state.  cut: (n,) mask of rows where a run ends anyway."""
    new = np.append(True, (word[1:] != word[:-1]) | cut[1:])
    starts = np.flatnonzero(new)
    return list(zip(starts.tolist(), np.append(starts[1:], len(word)).tolist(), strict=True))
