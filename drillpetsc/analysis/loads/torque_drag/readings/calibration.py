"""Friction factors and other numbers from measured hook loads and torques: the fit, its intervals, and what the points do not determine.

Bounded nonlinear least squares of all points at once (manual: sec-soft-string-calibration). A forward model, the soft string or the
beam, says what hangs at the top of the string; what the rig reads of it is computed here.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from drillpetsc.analysis.loads.torque_drag.readings.along_depth import (
    Lengths,
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
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.unit_systems import shown

RELATIVE_SIGMA, SMALLEST_SIGMA = 0.02, {"hook_load": 10e3, "surface_torque": 500.0}  # [N], [N m]
SOFT_SCALE = 3.0  # of soft_l1, in standard errors
LARGEST_CONDITION = 1e3  # of the scaled Jacobian
SMALLEST_SPREAD = 3.0  # of hook loads with friction against those without, in standard errors
UNIT_STEP = 1e-4  # of differences by a scaled unknown, so that all parameters have steps alike
WEIGHT_ERROR = 0.02  # misfit of rotating off bottom that is reported as an error of the weight
AT_BOUND = 1e-6
ALIKE, WIDEST_ALIKE = (
    0.98,
    0.1,
)  # correlation of two parameters of which neither is determined; half width from which
FEWEST_WEIGHTS, SLOPE_BY_CHANCE = 4, 0.01  # rotating weights that show a slope with depth; probability of one
PRIOR_KEPT = 0.8  # share of the prior's interval that is left, above which the points have added nothing
LOCKED = 1e9  # computed reading of a string that locks up or has no state: it fits nothing
MOST_EVALUATIONS = 60
SMALLEST_GAIN = {
    True: 1e-9,
    False: 1e-6,
}  # of the sum of squares, at which soft strings, or the beam, are fitted [-]


@dataclass(frozen=True)
class Data:
    """Readings as rows, (n,) each.

    point: number of the measured point; hook: whether a hook load, else a torque.
    value: hook load of the string with the block where it was read so, torque [N], [N m]; sigma: standard error.
    """

    point: np.ndarray
    hook: np.ndarray
    value: FloatArray
    sigma: FloatArray


@dataclass
class Fit:
    """Result of a calibration.

    parameters: names that were fitted.
    value: best values; interval: half widths of the 95 % intervals; nan where not determined, (k,) each.
    correlation: (k, k); chi2: reduced; computed: (n,) readings with the best values.
    reasons: name -> why it is not determined.
    independent: (k,) half widths as if no two readings had a common error; equal to `interval` unless errors are correlated.
    lengths, block: correlation along depth and length of the bootstrap's blocks [m]; None where errors are independent.
    covariance: (m, m) of the determined parameters `kept`.
    priors: parameters that the readings leave where their prior has them.
    """

    parameters: tuple[str, ...]
    value: FloatArray
    interval: FloatArray
    correlation: FloatArray
    chi2: float
    computed: FloatArray
    reasons: dict[str, str] = field(default_factory=dict)
    independent: FloatArray = field(default_factory=lambda: np.empty(0))
    lengths: Lengths | None = None
    block: float = 0.0
    kept: tuple[str, ...] = ()
    covariance: FloatArray = field(default_factory=lambda: np.empty((0, 0)))
    priors: tuple[str, ...] = ()

    @property
    def best(self) -> dict[str, float]:
        """The determined parameters."""
        return {name: float(self.value[self.parameters.index(name)]) for name in self.kept}


class Forward(Protocol):
    """A model of the string: what hangs at its top at each of n points."""

    def ends(self, sets: Sequence[Values]) -> tuple[FloatArray, FloatArray]:
        """Tension [N] and torque [N m] at the top of n points, (s, n) each, for s sets of parameters; nan for a string without a state."""

    def near(self, base: Values, sets: Sequence[Values]) -> tuple[FloatArray, FloatArray]:
        """As ``ends``, of sets so near a ``base`` that they follow from its derivatives; each differs in one parameter."""


class Calibration:
    """Measured points beside what a model of the string gives for them.

    case: with a well; points: measured; excludes_block: hook loads were read without the block.
    forward: from the soft strings to the model that is fitted, such as ``StiffForward``; None: the soft strings themselves.
    Raises CaseError for points that the string cannot reach.
    """

    def __init__(
        self,
        case: Case,
        points: tuple[MeasuredPoint, ...],
        excludes_block: bool = False,
        forward: Callable[[SoftForward], Forward] | None = None,
    ) -> None:
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
        self.priors: dict[str, tuple[float, float]] = {}
        self.readings_alike = 1.0  # readings that count as one, beside a prior
        self.fixed: dict[str, float] = {}  # parameters that have the mean of their prior
        self.data = self._data()

    @property
    def own(self) -> FloatArray:
        """(m,) friction of the hole's sections where no parameter says otherwise."""
        return self.soft.own

    @own.setter
    def own(self, friction: FloatArray) -> None:
        self.soft.own = friction

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
        return Data(np.array(point_), np.array(hook), np.array(value, float), np.array(sigma_, float))

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
        some = self.own[self.soft.group == name]
        return float(some[-1]) if len(some) else np.nan

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

    # ------------------------------------------------------------------ fit
    def fit(
        self,
        parameters: tuple[str, ...],
        correlated: bool = False,
        priors: dict[str, tuple[float, float]] | None = None,
    ) -> Fit:
        """Fit parameters; those that the points do not determine are nan, with the reason.

        correlated: intervals by a bootstrap of blocks along depth; priors: name -> (mean, standard deviation).
        """
        priors = priors or {}
        self.priors, self.readings_alike, self.fixed = priors, 1.0, {}
        if priors and correlated:  # readings that say the same must not outvote what is known beforehand
            first = self.fit(parameters, correlated=True)
            if first.lengths is not None:
                self.readings_alike = max(
                    n / first.lengths.effective[q] for q, n in first.lengths.count.items()
                )
            self.priors, self.fixed = priors, {}
        reasons = {
            name: why for name, why in self._not_identifiable(parameters).items() if name not in priors
        }
        kept = tuple(name for name in parameters if name not in reasons)
        size = len(parameters)
        nothing = np.full(size, np.nan)
        fit = Fit(
            parameters, nothing.copy(), nothing.copy(), np.full((size, size), np.nan), np.nan, self.data.value
        )
        fit.reasons, fit.independent = reasons, nothing.copy()
        while kept:
            best, jacobian = self._solve(kept)
            fit.computed = self.computed([dict(zip(kept, best, strict=True))])[0]
            bad = self._wrong_weight(kept, best)
            bad = bad or self._undetermined(fit, kept, best, jacobian, correlated)
            if not bad:
                break
            known = [name for name in bad if name in priors]
            if known:  # what the readings do not say is taken from the prior, and then they may say the rest
                self.fixed.update({name: priors[name][0] for name in known})
                bad = dict.fromkeys(known, "")
            reasons.update({name: why for name, why in bad.items() if name not in self.fixed})
            kept = tuple(name for name in kept if name not in bad)
        for name, mean in self.fixed.items():
            i = parameters.index(name)
            fit.value[i], fit.interval[i], fit.independent[i] = mean, *[1.96 * priors[name][1]] * 2
        fit.priors = tuple(self.fixed)
        if not kept:
            fit.computed = self.computed([{}])[0]
            return fit
        residual = self._weighted(fit.computed, kept, best)
        freedom = len(residual) - len(kept)
        fit.chi2 = float(residual @ residual / freedom) if freedom > 0 else np.nan
        place = [parameters.index(name) for name in kept]
        fit.value[place], fit.kept = best, kept
        fit.interval[place], fit.independent[place] = self._widths
        scale = np.sqrt(np.diag(fit.covariance))
        fit.correlation[np.ix_(place, place)] = fit.covariance / np.outer(scale, scale)
        fit.priors += tuple(
            name
            for name, width in zip(kept, self._widths[0], strict=True)
            if name in priors and not width < PRIOR_KEPT * 1.96 * priors[name][1]
        )
        return fit

    def _undetermined(
        self, fit: Fit, kept: tuple[str, ...], best: FloatArray, jacobian: FloatArray, correlated: bool
    ) -> dict[str, str]:
        """Parameters without a number at these best values, with the reason; the first reason that holds.

        Sets the intervals of `fit` on the way.
        """
        bad = self._unclear(kept, jacobian)
        if bad is not None:
            return {bad: "the points do not distinguish it from the others (condition above 1000)"}
        residual = self._weighted(fit.computed, kept, best)
        width, fit.covariance = self._intervals(residual, jacobian)
        self._widths = width, width
        if correlated:
            self._widths = self._by_blocks(fit, residual, jacobian), width
            width = self._widths[0]
        alike = np.abs(fit.covariance / np.sqrt(np.outer(np.diag(fit.covariance), np.diag(fit.covariance))))
        np.fill_diagonal(alike, 0.0)
        for i, name in enumerate(kept):
            low, high = self.parameter(name).bounds
            if best[i] in (low, high):
                twins = [i, *np.flatnonzero(alike[i] > ALIKE)]
                why = f"{name} is at its bound {self._words(name, best[i])}: the points ask for a value beyond it"
                return {kept[j]: why + self._alike(kept, int(j), fit.covariance) for j in twins}
        for i, j in zip(*np.nonzero(np.triu(alike > ALIKE)), strict=True):
            if any(width[m] > self._widest_alike(kept[m]) for m in (i, j)):
                why = f"the points do not tell {kept[i]} from {kept[j]} (correlation {_correlation(fit.covariance, int(i), int(j)):.3f})"
                return {kept[i]: why, kept[j]: why}
        bad = self._widest(kept, width)
        if bad is None:
            return {}
        i = kept.index(bad)
        ends = f"{self._words(bad, best[i] - width[i])} to {self._words(bad, best[i] + width[i])}"
        return {bad: f"its 95 % interval, {ends}, is too wide{self._alike(kept, i, fit.covariance)}"}

    def _wrong_weight(self, kept: tuple[str, ...], best: FloatArray) -> dict[str, str]:
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

    def _weighted(self, computed: FloatArray, names: tuple[str, ...], best: FloatArray) -> FloatArray:
        """(n + p,) weighted residuals of the readings, then of the priors."""
        d = self.data
        root = np.sqrt(self.readings_alike)
        own = [
            root * (q - self.priors[name][0]) / self.priors[name][1]
            for name, q in zip(names, best, strict=True)
            if name in self.priors
        ]
        return np.append((computed - d.value) / d.sigma, own)

    def _by_blocks(self, fit: Fit, residual: FloatArray, jacobian: FloatArray) -> FloatArray:
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

    def _intervals(self, residual: FloatArray, jacobian: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(half widths of the 95 % intervals (k,), nan without a reading to spare; covariance over s^2 (k, k)).

        residual: (n,) and jacobian: (n, k), weighted.
        """
        from scipy.stats import t as student

        freedom, covariance = len(residual) - jacobian.shape[1], np.linalg.inv(jacobian.T @ jacobian)
        if freedom <= 0:
            return np.full(jacobian.shape[1], np.nan), covariance
        spread = np.sqrt(np.diag(covariance) * self._variance(residual, freedom))
        return np.asarray(student.ppf(0.975, freedom) * spread), covariance

    def _widest_alike(self, name: str) -> float:
        """Half width from which a parameter that acts like another one is not determined; never for a force."""
        p = self.parameter(name)
        if p.key is not None:
            return WIDEST_ALIKE * p.key.size
        return np.inf if name in ("block_weight", "running_drag") else WIDEST_ALIKE

    def allowed(self, name: str) -> float:
        """Half width of an interval beyond which a parameter is not determined [SI]."""
        widest = self.parameter(name).widest
        hook = np.abs(self.data.value[self.data.hook])
        return BLOCK_SHARE * float(hook.max(initial=0.0)) if widest is None else widest

    def enough(self, name: str) -> float:
        """Half width of an interval with which a parameter is determined, whatever acts like it [SI]."""
        return min(self.allowed(name), self._widest_alike(name))

    def _widest(self, names: tuple[str, ...], width: FloatArray) -> str | None:
        """The parameter whose interval is widest against the largest one that still tells something; None where all do."""
        with np.errstate(divide="ignore"):
            over = width / np.array([self.allowed(name) for name in names])
        return names[int(np.nanargmax(over))] if np.nanmax(over, initial=0.0) > 1 else None

    @staticmethod
    def _alike(names: tuple[str, ...], i: int, covariance: FloatArray) -> str:
        """Words on the parameter that acts most like the i-th one; empty where none does."""
        scale = np.sqrt(np.diag(covariance))
        like = np.abs(covariance[i] / scale[i] / scale)
        like[i] = 0.0
        j = int(np.argmax(like))
        sign = np.sign(covariance[i, j])
        return (
            f": the points do not tell it from {names[j]} (correlation {sign * like[j]:.3f})"
            if like[j] > 0.9
            else ""
        )

    def _words(self, name: str, value: float) -> str:
        """A value of a parameter as text."""
        if name == "block_weight":
            return shown(value, "force", self.units)
        p = self.parameter(name)
        return f"{value:.3g}" if p.key is None else p.shown(value, self.units)

    @staticmethod
    def _variance(residual: FloatArray, freedom: int) -> float:
        """s^2 of weighted residuals (n,)."""
        return float(residual @ residual / freedom)

    def _solve(self, names: tuple[str, ...]) -> tuple[FloatArray, FloatArray]:
        """(best values (k,), Jacobian of the weighted residuals there (n, k)); the beam starts at what the soft string finds."""
        some = [self.parameter(name) for name in names]
        first = [self.default(q.name) if q.start is None else q.start for q in some]
        best, jacobian = self._solve_with(self.soft, names, np.array(first))
        return (best, jacobian) if self.is_soft else self._solve_with(self.forward, names, best)

    def _solve_with(
        self, forward: Forward, names: tuple[str, ...], first: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        from scipy.optimize import least_squares

        d = self.data
        units = np.array([self.parameter(name).step / UNIT_STEP for name in names])  # scaled unknowns

        def parameters(x: FloatArray) -> dict[str, float]:
            return dict(zip(names, map(float, x * units), strict=True))

        def residual(x: FloatArray) -> FloatArray:
            return self._weighted(self.computed([parameters(x)], forward)[0], names, x * units)

        known = [i for i, name in enumerate(names) if name in self.priors]
        of_priors = np.zeros((len(known), len(names)))
        for row, i in zip(of_priors, known, strict=True):
            row[i] = np.sqrt(self.readings_alike) * units[i] / self.priors[names[i]][1]

        def jacobian(x: FloatArray) -> FloatArray:
            slopes = self.slopes(parameters(x), names, forward) * units[:, None]
            return np.vstack([(slopes / d.sigma).T, of_priors])

        low, high = np.array([self.parameter(name).bounds for name in names]).T / units
        start = np.clip(first / units, low, high)
        if (
            forward is self.soft
        ):  # readings are nearly linear in most parameters: a soft loss would come there in many steps
            start = start - np.linalg.lstsq(jacobian(start), residual(start), rcond=None)[0]
        start = np.clip(start, low + 1e-9 * (high - low), high - 1e-9 * (high - low))
        found = least_squares(
            residual, start, jac=jacobian, bounds=(low, high), method="trf", loss="soft_l1", f_scale=SOFT_SCALE,
            xtol=1e-7, ftol=SMALLEST_GAIN[forward is self.soft], gtol=1e-9, max_nfev=MOST_EVALUATIONS,
        )  # fmt: skip
        if not found.success:
            raise SolveError(f"the parameters were not found: {found.message}")
        at = AT_BOUND * (high - low)
        best = np.where(found.x - low < at, low, np.where(high - found.x < at, high, found.x))
        return best * units, jacobian(best) / units

    def _unclear(self, names: tuple[str, ...], jacobian: FloatArray) -> str | None:
        """The parameter that takes most part in a combination which the points do not determine; None if all are clear."""
        scaled = jacobian * np.array([self.parameter(name).step / UNIT_STEP for name in names])
        _, s, v = np.linalg.svd(scaled, full_matrices=False)
        if s[0] > LARGEST_CONDITION * s[-1]:
            return names[int(np.argmax(np.abs(v[-1])))]
        return None

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
            for section, group in zip(sections, self.soft.group, strict=True):
                reached |= bool(group == name) and deepest > above + 1.0
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

    # ------------------------------------------------------------------ checks
    def weight_misfit(self, best: dict[str, float] | None = None) -> list[tuple[MeasuredPoint, float]]:
        """Points rotating off bottom with their hook load as computed, as it was read [N].  best: factors, the case's without."""
        values, d, out = self.computed([best or {}])[0], self.data, []
        for i, hook, computed in zip(d.point, d.hook, values, strict=True):
            if hook and self.points[i].operation == "rotate_off_bottom":
                out.append((self.points[i], float(computed)))
        return out


def _correlation(covariance: FloatArray, i: int, j: int) -> float:
    """Correlation of two parameters."""
    return float(covariance[i, j] / np.sqrt(covariance[i, i] * covariance[j, j]))
