"""The estimate of a rig row by row: forecast made one stand earlier, alarms, correction, forecast of one stand ahead."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drillpetsc.analysis.follow.alarms import Alarm, Error, PressureTrack, Watch
from drillpetsc.analysis.follow.beam import Beam, Compared, Model
from drillpetsc.analysis.follow.sigma_points import Belief, Expected, corrected, expected
from drillpetsc.analysis.follow.state import STAND, first_belief, states_of, walked, with_priors
from drillpetsc.analysis.follow.strings import SLIPS, Load, Strings
from drillpetsc.analysis.loads.torque_drag.operations import groups_of, load_of, plan_of
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.units import to_si

#: smallest standard errors of a median reading, relative and of a trip, whose speed is not even
HOOK_NOISE, TORQUE_NOISE, TRIP_NOISE = 0.001, 0.01, 0.012
SURFACE_WEIGHT = to_si("1.5 t", "N")  # standard error of a weight on bit that is read at the surface
GATE = {1: 6.635, 2: 9.210}  # squared distances that 99 % of one or two normal readings do not exceed
LEARNT_AGAIN = 2 * STAND  # after which suspect rows teach the filter anyway [m]
TRIPS = ("trip_in", "trip_out", "backreaming")


@dataclass(frozen=True)
class Reading:
    """Readings of a row, SI, nan where nothing was read.

    time: since the first row of the log, nan for a log by depth; scatter: standard deviation of a single reading of each.
    measured_below: whether the weight on bit was read downhole.
    """

    load: Load
    time: float
    hook_load: float
    torque: float
    pump_pressure: float = float("nan")
    hook_scatter: float = 0.0
    torque_scatter: float = 0.0
    measured_below: bool = False

    @property
    def noise(self) -> FloatArray:
        """(2,) standard deviations of hook load [N] and torque [N m]."""
        hook = max(self.hook_scatter, HOOK_NOISE * abs(self.hook_load))
        if self.load.operation in TRIPS:
            hook = max(hook, TRIP_NOISE * abs(self.hook_load))
        if self.load.on_bottom and not self.measured_below:
            hook = float(np.hypot(hook, SURFACE_WEIGHT))
        return np.array([hook, max(self.torque_scatter, TORQUE_NOISE * abs(self.torque))])


@dataclass(frozen=True)
class Ahead:
    """Readings one stand ahead: bit depth [m]; mean and sd (2,) of hook load [N] and torque [N m]."""

    bit_depth: float
    mean: FloatArray
    sd: FloatArray


@dataclass(frozen=True)
class Update:
    """What a row gave.

    number; reading; forecast: reading -> its error by the forecast made one stand earlier; last: reading -> value one stand earlier.
    belief: after the row; taught: whether the row corrected it; ahead: None where the hole ends or nothing turns or moves.
    compared: beam and soft string before the row, None in rows without one.
    """

    number: int
    reading: Reading
    forecast: dict[str, Error]
    last: dict[str, float]
    belief: Belief
    taught: bool
    ahead: Ahead | None
    alarms: list[Alarm]
    compared: Compared | None


@dataclass
class _Past:
    """A row that forecasts are made from: distance moved so far [m], belief, and readings."""

    moved: float
    mean: FloatArray
    covariance: FloatArray
    operation: str
    values: dict[str, float] = field(default_factory=dict)


class Follower:
    """The estimate for a case; ``see`` takes one row after another.

    block: weight [N]; priors: as for ``with_priors``; model: of the string, soft or stiff.
    Raises CaseError for a case that the model does not cover.
    """

    def __init__(
        self, case: Case, block: float, priors: Mapping[str, tuple[float, float]] | None = None, model: Model = "soft"
    ) -> None:  # fmt: skip
        self.case = case
        drilling = load_of(case, plan_of(case), "drilling")
        self.states = states_of(groups_of(case).last, block, drilling.torque / max(drilling.wob, 1.0))
        self.states = with_priors(self.states, priors or {})
        self.strings = Strings(case, self.states)
        self.beam = Beam(self.strings, model)
        self.belief = first_belief(self.states)
        self.watch, self.pressure = Watch(), PressureTrack()
        self.number, self.moved, self.depth = 0, 0.0, np.nan
        self._past: deque[_Past] = deque()
        self._suspect_from = np.nan
        self.end = float(case.given_well.survey.md[-1])

    def see(self, row: Reading) -> Update:
        """Take a row.  Raises CaseError for a depth at which the case has no string."""
        load = row.load
        distance = 0.0 if np.isnan(self.depth) else abs(load.bit_depth - self.depth)
        self.moved += distance
        self.depth = load.bit_depth
        self.belief = walked(self.states, self.belief, distance)
        self.pressure.walk(distance)
        compared = self.beam.look(load, self.belief.mean)
        past = self._one_stand_before(load)
        forecast = {} if past is None else self._forecast(past, row)
        last = {} if past is None or past.operation != load.operation else past.values
        alarms = self.watch.see(load.operation, load.bit_depth, forecast)
        taught = self._teaches()
        if taught:
            self._correct(row)
        self.pressure.see(row.pump_pressure, load.flow, taught)
        self._remember(row)
        self.number += 1
        return Update(
            self.number, row, forecast, last, self.belief, taught, self._ahead(row), alarms, compared
        )

    # ------------------------------------------------------------------ forecast
    def _one_stand_before(self, load: Load) -> _Past | None:
        """The latest row at least a stand earlier; of trips, whose stands differ in length, at least two thirds of one."""
        if load.operation == SLIPS:
            return None
        least = (2 / 3 if load.operation in TRIPS else 1.0) * STAND - 1e-6
        while len(self._past) > 1 and self.moved - self._past[1].moved >= least:
            self._past.popleft()
        first = self._past[0] if self._past else None
        return first if first is not None and self.moved - first.moved >= least else None

    def _forecast(self, past: _Past, row: Reading) -> dict[str, Error]:
        distance = self.moved - past.moved
        before = walked(self.states, Belief(past.mean, past.covariance), distance)
        seen = self.expected(before, row.load)
        values = np.array([row.hook_load, row.torque])
        sd = np.sqrt(np.diag(seen.covariance) + row.noise**2)
        out = {
            name: Error(float(values[k]), float(seen.mean[k]), float(sd[k]))
            for k, name in enumerate(("hook_load", "torque"))
            if self._readable(row)[k]
            and np.isfinite(seen.mean[k])  # nan: a string that cannot carry its weight on bit
        }
        level, depth = past.values.get("pressure_level"), row.load.bit_depth
        pressure = self.pressure.error(row.pump_pressure, row.load.flow, level, distance, depth)
        return out if pressure is None else {**out, "pump_pressure": pressure}

    def expected(self, belief: Belief, load: Load) -> Expected:
        """Hook load [N] and torque [N m] that a belief expects under a load."""
        return expected(belief, lambda points: self.strings.readings(points, load))

    def _ahead(self, row: Reading) -> Ahead | None:
        """Forecast for the same operation one stand on; the bit keeps its weight and torque."""
        load = row.load
        depth = load.bit_depth + (-STAND if load.operation in ("trip_out", "backreaming") else STAND)
        if load.operation == SLIPS or not 0 < depth <= self.end + 1e-6:
            return None
        wob, tob = load.wob, load.torque_on_bit
        if load.on_bottom:
            some = [q.values for q in self._past if q.operation == load.operation]
            wob = float(np.mean([q["wob"] for q in some]))
            tob = float(np.mean([q["torque_on_bit"] for q in some]))
        on = Load(load.operation, depth, wob, tob, load.velocity, load.rotation, load.flow)
        seen = self.expected(walked(self.states, self.belief, STAND), on)
        return Ahead(depth, seen.mean, np.sqrt(np.diag(seen.covariance) + row.noise**2))

    # ------------------------------------------------------------------ correction
    def _readable(self, row: Reading) -> tuple[bool, bool]:
        turns = bool(row.load.rotation) and row.load.operation != SLIPS
        return bool(np.isfinite(row.hook_load)), turns and bool(np.isfinite(row.torque))

    def _teaches(self) -> bool:
        """Whether the row may correct the estimate: not while an alarm builds up, for two stands at most."""
        if not self.watch.suspect:
            self._suspect_from = np.nan
            return True
        if np.isnan(self._suspect_from):
            self._suspect_from = self.moved
        return self.moved - self._suspect_from > LEARNT_AGAIN

    def _correct(self, row: Reading) -> None:
        which = np.flatnonzero(self._readable(row))
        if not len(which):
            return
        seen = self.expected(self.belief, row.load)
        part = Expected(seen.mean[which], seen.covariance[np.ix_(which, which)], seen.cross[:, which])
        values = np.array([row.hook_load, row.torque])[which]
        if not np.isfinite(part.mean).all():  # a string that cannot carry its weight on bit teaches nothing
            return
        self.belief = corrected(self.belief, part, values, np.diag(row.noise[which] ** 2), GATE[len(which)])

    def _remember(self, row: Reading) -> None:
        load = row.load
        values = {
            "hook_load": row.hook_load,
            "torque": row.torque,
            "pump_pressure": row.pump_pressure,
            "wob": load.wob,
            "torque_on_bit": load.torque_on_bit,
            "pressure_level": self.pressure.level,
        }
        self._past.append(_Past(self.moved, self.belief.mean, self.belief.covariance, load.operation, values))

    # ------------------------------------------------------------------ restart
    def saved(self) -> dict[str, Any]:
        """Everything that a restart needs, in JSON types."""
        past = [[q.moved, q.mean.tolist(), q.covariance.tolist(), q.operation, q.values] for q in self._past]
        return {
            "states": [q.name for q in self.states],
            "mean": self.belief.mean.tolist(),
            "covariance": self.belief.covariance.tolist(),
            "number": self.number, "moved": self.moved, "depth": self.depth, "suspect_from": self._suspect_from,
            "past": past, "watch": self.watch.saved(), "pressure": self.pressure.saved(), "beam": self.beam.saved(),
        }  # fmt: skip

    def restore(self, saved: dict[str, Any]) -> None:
        """Continue from what was saved."""
        self.belief = Belief(np.array(saved["mean"]), np.array(saved["covariance"]))
        self.number, self.moved = saved["number"], saved["moved"]
        self.depth, self._suspect_from = (_number(saved[key]) for key in ("depth", "suspect_from"))
        self._past = deque(
            _Past(m, np.array(x), np.array(p), word, {k: _number(v) for k, v in values.items()})
            for m, x, p, word, values in saved["past"]
        )
        self.watch.restore(saved["watch"])
        self.pressure.restore(saved["pressure"])
        self.beam.restore(saved["beam"])


def _number(value: float | None) -> float:
    """A number that JSON has as null if it is nan."""
    return float("nan") if value is None else float(value)
