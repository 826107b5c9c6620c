"""A stuck string under a pull: where it is stuck, from the stretch that the block shows (manual: sec-follow-stuck)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.follow.alarms import INSIDE
from drillpetsc.analysis.follow.follower import TRIP_NOISE, Follower
from drillpetsc.analysis.follow.strings import Load
from drillpetsc.analysis.loads.limits.free_point import FreePoint, StuckString
from drillpetsc.analysis.loads.torque_drag.operations import Load as Pulled
from drillpetsc.analysis.loads.torque_drag.operations import Pair, groups_of
from drillpetsc.analysis.loads.torque_drag.stiff import Job, stiff_case
from drillpetsc.analysis.loads.torque_drag.string_rows import rows_at
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.logs.pulls import LEAST, Pull
from drillpetsc.unit_systems import shown
from drillpetsc.unit_tables import FOOT

FEWEST = 5  # rows of a pull beyond the pick-up weight
SURE = 0.05  # standard error of the stretch, relative, beyond which nothing is said
NEAR = 0.05  # share of the stretch of the whole string within which it is stuck at the bit; beyond, it moves
AGAIN = 0.03  # change of the free length that is worth another word


@dataclass(frozen=True)
class Stuck:
    """A stuck point.

    length: of the free string below the rig [m], its sd with the error of the friction; at_bit: whether all of it is free.
    found: of `freepoint`; hook_load: highest [N]; overloaded: the item that it takes beyond its limit, None: none.
    """

    length: float
    sd: float
    at_bit: bool
    found: FreePoint
    hook_load: float
    overloaded: str | None


class StuckPoints:
    """Stuck points of the pulls on a string that is followed."""

    def __init__(self, follower: Follower) -> None:
        self.follower, self.last = follower, 0.0
        self._built: dict[tuple[float, ...], StuckString] = {}  # the latest one

    def see(self, pull: Pull) -> Stuck | None:
        """The stuck point that a pull shows; None if the string moves, or is stuck as before.

        Raises CaseError for a depth at which the case has no string.
        """
        follower = self.follower
        if pull.bit_depth > follower.end:
            return None
        load = Load("trip_out", pull.bit_depth, velocity=1e-6)
        seen = follower.expected(follower.belief, load)
        weight = float(seen.mean[0])
        above = weight + INSIDE * float(np.hypot(np.sqrt(seen.covariance[0, 0]), TRIP_NOISE * weight))
        first = int(np.max(np.flatnonzero(pull.hook_load <= above), initial=-1)) + 1
        height, hook = pull.height[first:], pull.hook_load[first:]
        if len(hook) < FEWEST or np.ptp(hook) < LEAST:
            return None
        low, high = float(hook.min()), float(hook.max())
        slope, error = _line(hook, height)
        error = float(np.hypot(error, _rounding(height) / np.ptp(hook)))
        if not 0 < error < SURE * slope:
            return None
        factor = follower.strings.hoisting_factor
        pulls = factor * (low - weight), factor * (high - weight)
        stretch = slope * (high - low)
        names, means, spread = self._friction()
        string = self._string(pull.bit_depth, names, means)
        found = string.find(stretch, *pulls)
        if stretch > (1 + NEAR) * found.whole:
            return None
        length = pull.bit_depth if found.length is None else found.length
        if abs(length - self.last) <= AGAIN * length:
            return None
        self.last = length
        change = [
            self._length(pull, stretch, pulls, names, means - step) - length
            for step in np.diag(np.sqrt(np.diag(spread)))
        ]
        alike = spread / np.outer(np.sqrt(np.diag(spread)), np.sqrt(np.diag(spread)))
        fit = self._length(pull, stretch * (1 - error / slope), pulls, names, means) - length
        sd = float(np.sqrt(fit**2 + np.array(change) @ alike @ np.array(change)))
        return Stuck(length, sd, found.length is None, found, high, string.overloaded(pulls[1]))

    def _friction(self) -> tuple[list[str], FloatArray, FloatArray]:
        """Groups of the hole, their friction factors as estimated, and the covariance of them."""
        follower, own = self.follower, [q.name for q in self.follower.states]
        names = follower.strings.groups
        which = [own.index(name) for name in names]
        return names, follower.belief.mean[which], follower.belief.covariance[np.ix_(which, which)]

    def _length(
        self, pull: Pull, stretch: float, pulls: tuple[float, float], names: list[str], friction: FloatArray
    ) -> float:
        found = self._string(pull.bit_depth, names, friction).find(stretch, *pulls).length
        return pull.bit_depth if found is None else found

    def _string(self, bit_depth: float, names: list[str], friction: FloatArray) -> StuckString:
        case, key = self.follower.case, (bit_depth, *np.clip(friction, 0.0, 1.0).tolist())
        if key not in self._built:
            own = dict(zip(names, key[1:], strict=True))
            pair = Pair(np.nan, np.nan, groups_of(case).friction(own))
            job = Job(rows_at(case, bit_depth, "bit depth"), pair, Pulled(0.0, 0.0, 1.0, 0.0))
            self._built = {key: StuckString(stiff_case(case, self.follower.strings.well, job))}
        return self._built[key]


def _line(x: FloatArray, y: FloatArray) -> tuple[float, float]:
    """Slope of the line through n points, and its standard error."""
    x, y = x - x.mean(), y - y.mean()
    slope = float(x @ y / (x @ x))
    return slope, float(np.sqrt(np.sum((y - slope * x) ** 2) / (len(x) - 2) / (x @ x)))


def _rounding(y: FloatArray) -> float:
    """Standard error of a difference of two heights that are rounded to decimals, which no mean of equal ones removes."""
    steps = [unit * 10.0**-k for k in range(4) for unit in (1.0, FOOT)]
    found = [q for q in steps if (np.abs(y / q - np.round(y / q)) < 1e-6).all()]
    return found[0] / np.sqrt(6.0) if found else 0.0


def stuck_told(case: Case, pull: Pull, stuck: Stuck) -> str:
    """The text of an alarm in the units of the case."""
    units = case.shown_units
    where, length, half, upper = (
        shown(q, "length", units, 2)
        for q in (pull.bit_depth, stuck.length, INSIDE * stuck.sd, stuck.length - INSIDE * stuck.sd)
    )
    stretch, force = shown(stuck.found.stretch, "diameter", units), shown(stuck.found.pull, "force", units, 3)
    place = f"at MD {length} +- {half} ({stuck.found.item})"
    if stuck.at_bit:
        place = f"at the bit, or above it as far as MD {upper}"
    text = f"MD {where}: stuck {place}: {stretch} of stretch for {force} of pull"
    largest = None if case.rig is None else case.rig.max_hookload
    if largest is not None:
        text += f"; {shown(largest - stuck.hook_load, 'force', units, 3)} left to rig.max_hookload"
    if stuck.overloaded is not None:
        text += f"; do not pull on: {stuck.overloaded} is beyond 0.9 of its tension at yield"
    return text
