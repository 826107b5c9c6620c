"""Friction factors and other numbers from measured hook loads and torques: the fit, its intervals, and what the points do not determine.

Bounded nonlinear least squares of all points at once (manual: sec-soft-string-calibration). A forward model, the soft string or the
beam, says what hangs at the top of the string; what the rig reads of it is computed here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from drillpetsc.analysis.calibration.estimator import SMALLEST_SPREAD, SOFT_SCALE, Estimator, Fit, Readings
from drillpetsc.analysis.loads.torque_drag.readings.along_depth import (
    block_length,
    changes,
    lengths,
    moving_blocks,
    small_sample,
)
from drillpetsc.analysis.loads.torque_drag.readings.forward_soft import SoftForward, Values
from drillpetsc.analysis.loads.torque_drag.readings.parameters import BLOCK_SHARE, Parameter
from drillpetsc.analysis.loads.torque_drag.readings.sensor import DIRECTION, sensor_of
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.unit_systems import shown

RELATIVE_SIGMA, SMALLEST_SIGMA = 0.02, {"hook_load": 10e3, "surface_torque": 500.0}  # [N], [N m]
WEIGHT_ERROR = 0.02  # misfit of rotating off bottom that is reported as an error of the weight
FEWEST_WEIGHTS, SLOPE_BY_CHANCE = 4, 0.01  # rotating weights that show a slope with depth; probability of one
LOCKED = 1e9  # computed reading of a string that locks up or has no state: it fits nothing
SMALLEST_GAIN_SOFT = 1e-9  # of the sum of squares of soft strings, which cost little [-]


@dataclass(frozen=True)
class Data(Readings):
    """Readings as rows, (n,) each.

    point: number of the measured point; hook: whether a hook load, else a torque.
    value: hook load of the string with the block where it was read so, torque [N], [N m]; sigma: standard error.
    """

    point: np.ndarray
    hook: np.ndarray


class Forward(Protocol):
    """A model of the string: what hangs at its top at each of n points."""

    def ends(self, sets: Sequence[Values]) -> tuple[FloatArray, FloatArray]:
        """Tension [N] and torque [N m] at the top of n points, (s, n) each, for s sets of parameters; nan for a string without a state."""

    def near(self, base: Values, sets: Sequence[Values]) -> tuple[FloatArray, FloatArray]:
        """As ``ends``, of sets so near a ``base`` that they follow from its derivatives; each differs in one parameter."""


class Calibration(Estimator):
    """Measured points beside what a model of the string gives for them.

    case: with a well; points: measured; excludes_block: hook loads were read without the block.
    forward: from the soft strings to the model that is fitted, such as ``StiffForward``; None: the soft strings themselves.
    Raises CaseError for points that the string cannot reach.
    """

    data: Data

    def __init__(
        self,
        case: Case,
        points: tuple[MeasuredPoint, ...],
        excludes_block: bool = False,
        forward: Callable[[SoftForward], Forward] | None = None,
    ) -> None:
        super().__init__()
        self.case, self.points = case, points
        self.soft = SoftForward(case, points)
        self.forward: Forward = self.soft if forward is None else forward(self.soft)
        self.units = case.shown_units
        self.factors, self.loads = self.soft.factors, self.soft.loads
        self.pumped, self.still = self.soft.pumped, self.soft.still
        self.excludes_block = excludes_block
        block = None if case.rig is None else case.rig.block_weight
        self.block = 0.0 if excludes_block else (block or 0.0)
        self.hidden = (block or 0.0) if excludes_block else 0.0
        self.direction = np.array([DIRECTION[point.operation] for point in points])
        self.data = self._data()

    @property
    def own(self) -> FloatArray:
        """(m,) friction of the hole's sections where no parameter says otherwise."""
        return self.soft.groups.own

    @own.setter
    def own(self, friction: FloatArray) -> None:
        self.soft.groups = replace(self.soft.groups, own=friction)

    def read(self, points: tuple[MeasuredPoint, ...]) -> None:
        """Take other readings of the same points."""
        self.points = points
        self.data = self._data()

    @property
    def is_soft(self) -> bool:
        """Whether the model is the soft string, of which thousands of sets cost little."""
        return self.forward is self.soft

    def parameter(self, name: str) -> Parameter:
        """A parameter by its name; raises CaseError."""
        return self.soft.parameter(name)

    def _data(self) -> Data:
        rows = []
        for i, point in enumerate(self.points):
            if point.hook_load is not None:
                sigma = point.sigma or max(RELATIVE_SIGMA * abs(point.hook_load), SMALLEST_SIGMA["hook_load"])
                rows.append((i, True, point.hook_load, sigma))
            if point.torque is not None and self.loads[i, 3]:  # without rotation no friction turns the string
                sigma = max(RELATIVE_SIGMA * abs(point.torque), SMALLEST_SIGMA["surface_torque"])
                rows.append((i, False, point.torque, sigma))
        if not rows:
            want = (
                "a hook load, or a torque while the string turns: without rotation friction makes no torque"
            )
            raise CaseError(at="measured", got=f"{len(self.points)} points with neither", want=want)
        point_, hook, value, sigma_ = zip(*rows, strict=True)
        return Data(np.array(value, float), np.array(sigma_, float), np.array(point_), np.array(hook))

    # ------------------------------------------------------------------ readings
    def default(self, name: str) -> float:
        """Value of a parameter that is not fitted: of the case."""
        sensor = None if self.case.rig is None else self.case.rig.hookload_sensor
        efficiency = (
            np.nan if sensor is None or sensor.sheave_efficiency is None else sensor.sheave_efficiency
        )
        held = {
            "block_weight": self.block,
            "weight_factor": 1.0,
            "running_drag": 0.0,
            "sheave_efficiency": efficiency,
        }
        if name in held:
            return held[name]
        key = self.parameter(name).key
        if key is not None:
            return key.value
        return self.soft.groups.last.get(name, np.nan)

    def computed(self, sets: list[dict[str, float]], forward: Forward | None = None) -> FloatArray:
        """(s, n) readings for s sets of parameters; those not in a set are the case's.

        forward: another model of the string than the one that is fitted.
        """
        given = [self.fixed | values for values in sets]
        return self._read(given, *(forward or self.forward).ends(given))

    def slopes(
        self, values: dict[str, float], names: Sequence[str], forward: Forward | None = None
    ) -> FloatArray:
        """(k, n) change of the readings per unit of each parameter, at some values."""
        base = self.fixed | values
        upper, lower = [], []
        for name in names:
            p, here = self.parameter(name), base.get(name, self.default(name))
            upper.append(base | {name: here + p.step})
            lower.append(base | {name: max(here - p.step, p.bounds[0])})
        sets = [*upper, *lower]
        found = self._read(sets, *(forward or self.forward).near(base, sets))
        wide = np.array([u[name] - w[name] for u, w, name in zip(upper, lower, names, strict=True)])
        return np.asarray((found[: len(upper)] - found[len(upper) :]) / wide[:, None])

    def _read(self, sets: list[dict[str, float]], tension: FloatArray, moment: FloatArray) -> FloatArray:
        """(s, n) readings of strings with the tension [N] and torque [N m] (s, points) at their tops."""
        block = np.array([values.get("block_weight", self.block) for values in sets])
        drag = np.array([values.get("running_drag", 0.0) for values in sets])
        hook = tension + block[:, None] + drag[:, None] * self.loads[:, 2]
        hook = self._over_sheaves(sets) * (hook + self.hidden) - self.hidden
        d = self.data
        out = np.where(d.hook, hook[:, d.point], moment[:, d.point])
        return np.where(np.isfinite(out), out, LOCKED)

    def _over_sheaves(self, sets: list[dict[str, float]]) -> FloatArray:
        """(s, n) weight over the reading as it was corrected, over that with the set's efficiency of a sheave."""
        out, given = np.ones((len(sets), len(self.points))), sensor_of(self.case)
        for row, values in zip(out, sets, strict=True):
            efficiency = values.get("sheave_efficiency")
            if efficiency is not None:
                sensor = sensor_of(self.case, efficiency)
                row *= [given.factor(q) / sensor.factor(q) for q in self.direction]
        return out

    def _misfitting(self, kept: tuple[str, ...], best: FloatArray) -> dict[str, str]:
        """Friction factors that no reading determines, since the rotating weight drifts away from the computed one with depth."""
        from scipy.stats import t as student

        off = self.weight_misfit(dict(zip(kept, best, strict=True)))
        depth = np.array([point.bit_depth for point, _ in off])
        if len(off) < FEWEST_WEIGHTS or not np.ptp(depth) > 0:
            return {}
        gap = np.array([computed - (point.hook_load or 0.0) for point, computed in off])
        allowed = WEIGHT_ERROR * float(
            np.mean([abs((point.hook_load or 0.0) - self.block) for point, _ in off])
        )
        slope = float(np.polyfit(depth - depth.mean(), gap, 1)[0])
        scatter = gap - np.polyval(np.polyfit(depth, gap, 1), depth)
        error = np.sqrt(np.sum(scatter**2) / (len(gap) - 2) / np.sum((depth - depth.mean()) ** 2))
        chance = float(student.ppf(1 - SLOPE_BY_CHANCE / 2, len(gap) - 2) * error)
        if np.abs(gap).max() <= allowed or abs(slope) * np.ptp(depth) <= allowed or abs(slope) <= chance:
            return {}
        ends = [gap[int(np.argmin(depth))], gap[int(np.argmax(depth))]]
        from_, to = (shown(-q, "force", self.units) for q in ends)
        top, end = (shown(float(q), "length", self.units, 4) for q in (depth.min(), depth.max()))
        why = (
            f"weight wrong: the rotating weight as read is {from_} above the computed one at {top} and {to} at {end}; an error of "
            "the string's weight that changes with depth"
        )
        return {name: why for name in kept if self.parameter(name).is_factor}

    def _correlated_widths(self, fit: Fit, residual: FloatArray, jacobian: FloatArray) -> FloatArray:
        """(k,) half widths of the 95 % intervals by a bootstrap of blocks along depth; `fit` gets lengths and covariance."""
        d = self.data
        depth = np.array([self.points[i].bit_depth for i in d.point])
        series = np.array(
            [
                f"{self.points[i].operation}, {'hook load' if h else 'torque'}"
                for i, h in zip(d.point, d.hook, strict=True)
            ]
        )
        fit.lengths = lengths(depth, fit.computed - d.value, series)
        fit.block = block_length(depth, fit.lengths)
        times = moving_blocks(depth, fit.block)
        found = changes(residual, jacobian, times, SOFT_SCALE, float(np.sqrt(self.readings_alike)))
        fit.covariance = np.atleast_2d(np.cov(found.T))
        low, high = np.percentile(found, [2.5, 97.5], axis=0)
        few = small_sample(float(np.ptp(depth)), fit.block)
        fit.covariance = fit.covariance * few**2
        return np.asarray(0.5 * (high - low) * few)

    def _solve(self, names: tuple[str, ...]) -> tuple[FloatArray, FloatArray]:
        """(best values (k,), Jacobian of the weighted residuals there (n, k)); the beam starts at what the soft string finds."""
        some = [self.parameter(name) for name in names]
        first = [self.default(q.name) if q.start is None else q.start for q in some]
        best, jacobian = self._solve_with(
            names, np.array(first), self.soft, near_linear=True, gain=SMALLEST_GAIN_SOFT
        )
        return (best, jacobian) if self.is_soft else self._solve_with(names, best, self.forward)

    def _not_identifiable(self, parameters: tuple[str, ...]) -> dict[str, str]:
        """Parameters that no point can determine, with the reason."""
        out: dict[str, str] = {}
        d = self.data
        names = [name for name in parameters if self.parameter(name).is_factor]
        base = dict.fromkeys(names, 0.0)
        sets = [base, *({**base, name: 0.5} for name in names)]
        values = self.computed(sets, self.soft)
        sections = self.case.given_well.sections
        deepest = max(point.bit_depth for point in self.points)
        for k, name in enumerate(names, 1):
            if name not in self.factors:
                out[name] = "the well has no such section"
                continue
            above = 0.0
            reached = False
            for section in sections:
                reached |= section.group == name and deepest > above + 1.0
                above = section.to
            if not reached:
                out[name] = "no point has the bit in such a section"
            elif not (np.abs(values[k] - values[0]) > SMALLEST_SPREAD * d.sigma).any():
                out[name] = "a friction factor of 0.5 changes no reading by more than 3 standard errors"
        out |= self._numbers_without_effect(parameters)
        if "block_weight" in parameters and not d.hook.any():
            out["block_weight"] = "no hook load was read"
        elif "block_weight" in parameters and self.excludes_block:
            out["block_weight"] = "the hook loads are those of the string, without the block"
        if "running_drag" in parameters and not (self.loads[d.point[d.hook], 2] != 0).any():
            out["running_drag"] = "no hook load was read while tripping"
        if "sheave_efficiency" in parameters:
            if np.isnan(self.default("sheave_efficiency")):
                out["sheave_efficiency"] = "rig.hookload_sensor is not in the dead line"
            elif not self.direction[d.point[d.hook]].any():
                out["sheave_efficiency"] = "no hook load was read while the block moved"
        for name in parameters[max(0, len(d.value)) :]:
            out.setdefault(name, "fewer readings than parameters")
        return out

    def _numbers_without_effect(self, parameters: tuple[str, ...]) -> dict[str, str]:
        """Numbers of the case whose largest change is less than the errors of the readings."""
        out: dict[str, str] = {}
        for name in parameters:
            p = self.parameter(name)
            if p.key is None:
                continue
            values = self.computed([{}, *({name: end} for end in p.bounds)], self.soft)
            known = (values < LOCKED).all(axis=0)
            if not (np.ptp(values, axis=0) > SMALLEST_SPREAD * self.data.sigma)[known].any():
                low, high = (p.shown(q, self.units) for q in p.bounds)
                out[name] = f"values from {low} to {high} change no reading by more than 3 standard errors"
        return out

    def allowed(self, name: str) -> float:
        """Half width of an interval beyond which a parameter is not determined [SI]."""
        widest = self.parameter(name).widest
        hook = np.abs(self.data.value[self.data.hook])
        return BLOCK_SHARE * float(hook.max(initial=0.0)) if widest is None else widest

    # ------------------------------------------------------------------ checks
    def weight_misfit(self, best: dict[str, float] | None = None) -> list[tuple[MeasuredPoint, float]]:
        """Points rotating off bottom with their hook load as computed, as it was read [N].  best: factors, the case's without."""
        values, d, out = self.computed([best or {}])[0], self.data, []
        for i, hook, computed in zip(d.point, d.hook, values, strict=True):
            if hook and self.points[i].operation == "rotate_off_bottom":
                out.append((self.points[i], float(computed)))
        return out
