"""The estimator of every calibration: bounded nonlinear least squares of readings, intervals, and what the readings do not determine.

A subclass has the readings and the model that computes them (manual: sec-soft-string-calibration).
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.torque_drag.readings.along_depth import Lengths
from drillpetsc.analysis.loads.torque_drag.readings.parameters import Parameter
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.unit_systems import System, shown

SOFT_SCALE = 3.0  # of soft_l1, in standard errors
LARGEST_CONDITION = 1e3  # of the scaled Jacobian
SMALLEST_SPREAD = 3.0  # of hook loads with friction against those without, in standard errors
UNIT_STEP = 1e-4  # of differences by a scaled unknown, so that all parameters have steps alike
AT_BOUND = 1e-6
ALIKE, WIDEST_ALIKE = (
    0.98,
    0.1,
)  # correlation of two parameters of which neither is determined; half width from which
PRIOR_KEPT = 0.8  # share of the prior's interval that is left, above which the points have added nothing
MOST_EVALUATIONS = 60
SMALLEST_GAIN = 1e-6  # of the sum of squares [-]


@dataclass(frozen=True)
class Readings:
    """Readings as rows, (n,) each.  value: as read [SI]; sigma: standard error."""

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


class Estimator(ABC):
    """Readings beside what a model gives for them.

    data: the readings; units: in which values are shown; noun: what the readings are called in reasons.
    """

    data: Readings
    units: System
    noun = "points"

    def __init__(self) -> None:
        self.priors: dict[str, tuple[float, float]] = {}
        self.readings_alike = 1.0  # readings that count as one, beside a prior
        self.fixed: dict[str, float] = {}  # parameters that have the mean of their prior

    # ------------------------------------------------------------------ of the subclass
    @abstractmethod
    def parameter(self, name: str) -> Parameter:
        """A parameter by its name; raises CaseError."""

    def asked(
        self, names: Sequence[str], priors: Mapping[str, tuple[float, float]]
    ) -> tuple[tuple[str, ...], dict[str, tuple[float, float]]]:
        """The parameters and their priors by the names that they have here; raises CaseError for a prior of no parameter."""
        named = {name: self.parameter(name).name for name in names}
        parameters = tuple(dict.fromkeys(named.values()))
        known = {named.get(name, name): prior for name, prior in priors.items()}
        for name in known:
            if name not in parameters:
                want = f"a parameter that is fitted: {', '.join(parameters)}"
                raise CaseError(at="--prior", got=name, want=want)
        return parameters, known

    @abstractmethod
    def default(self, name: str) -> float:
        """Value of a parameter that is not fitted: of the case."""

    @abstractmethod
    def computed(self, sets: list[dict[str, float]], forward: Any = None) -> FloatArray:
        """(s, n) readings for s sets of parameters; those not in a set are the case's.

        forward: another model than the one that is fitted.
        """

    @abstractmethod
    def slopes(self, values: dict[str, float], names: Sequence[str], forward: Any = None) -> FloatArray:
        """(k, n) change of the readings per unit of each parameter, at some values."""

    @abstractmethod
    def _solve(self, names: tuple[str, ...]) -> tuple[FloatArray, FloatArray]:
        """(best values (k,), Jacobian of the weighted residuals there (n, k)), by ``_solve_with``."""

    @abstractmethod
    def _not_identifiable(self, parameters: tuple[str, ...]) -> dict[str, str]:
        """Parameters that no reading can determine, with the reason."""

    @abstractmethod
    def _correlated_widths(self, fit: Fit, residual: FloatArray, jacobian: FloatArray) -> FloatArray:
        """(k,) half widths of the 95 % intervals if errors are correlated; ``fit`` gets lengths and covariance.

        residual: (n + p,), jacobian: (n + p, k), weighted; the last p rows are those of priors.
        """

    def _misfitting(self, kept: tuple[str, ...], best: FloatArray) -> dict[str, str]:
        """Parameters that have no number because the model is wrong at these best values, with the reason."""
        return {}

    # ------------------------------------------------------------------ fit
    def fit(
        self,
        parameters: tuple[str, ...],
        correlated: bool = False,
        priors: dict[str, tuple[float, float]] | None = None,
    ) -> Fit:
        """Fit parameters; those that the points do not determine are nan, with the reason.

        correlated: intervals for errors that are alike in neighbouring readings; priors: name -> (mean, standard deviation).
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
            bad = self._misfitting(kept, best)
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
            return {bad: f"the {self.noun} do not distinguish it from the others (condition above 1000)"}
        residual = self._weighted(fit.computed, kept, best)
        width, fit.covariance = self._intervals(residual, jacobian)
        self._widths = width, width
        if correlated:
            self._widths = self._correlated_widths(fit, residual, jacobian), width
            width = self._widths[0]
        alike = np.abs(fit.covariance / np.sqrt(np.outer(np.diag(fit.covariance), np.diag(fit.covariance))))
        np.fill_diagonal(alike, 0.0)
        for i, name in enumerate(kept):
            low, high = self.parameter(name).bounds
            if best[i] in (low, high):
                twins = [i, *np.flatnonzero(alike[i] > ALIKE)]
                why = f"{name} is at its bound {self._words(name, best[i])}: the {self.noun} ask for a value beyond it"
                return {kept[j]: why + self._alike(kept, int(j), fit.covariance) for j in twins}
        for i, j in zip(*np.nonzero(np.triu(alike > ALIKE)), strict=True):
            if any(width[m] > self._widest_alike(kept[m]) for m in (i, j)):
                why = f"the {self.noun} do not tell {kept[i]} from {kept[j]} (correlation {_correlation(fit.covariance, int(i), int(j)):.3f})"
                return {kept[i]: why, kept[j]: why}
        bad = self._widest(kept, width)
        if bad is None:
            return {}
        i = kept.index(bad)
        ends = f"{self._words(bad, best[i] - width[i])} to {self._words(bad, best[i] + width[i])}"
        return {bad: f"its 95 % interval, {ends}, is too wide{self._alike(kept, i, fit.covariance)}"}

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
        return np.inf if widest is None else widest

    def enough(self, name: str) -> float:
        """Half width of an interval with which a parameter is determined, whatever acts like it [SI]."""
        return min(self.allowed(name), self._widest_alike(name))

    def _widest(self, names: tuple[str, ...], width: FloatArray) -> str | None:
        """The parameter whose interval is widest against the largest one that still tells something; None if all do."""
        with np.errstate(divide="ignore"):
            over = width / np.array([self.allowed(name) for name in names])
        return names[int(np.nanargmax(over))] if np.nanmax(over, initial=0.0) > 1 else None

    def _alike(self, names: tuple[str, ...], i: int, covariance: FloatArray) -> str:
        """Words on the parameter that acts most like the i-th one; empty where none does."""
        scale = np.sqrt(np.diag(covariance))
        like = np.abs(covariance[i] / scale[i] / scale)
        like[i] = 0.0
        j = int(np.argmax(like))
        sign = np.sign(covariance[i, j])
        return (
            f": the {self.noun} do not tell it from {names[j]} (correlation {sign * like[j]:.3f})"
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

    def _solve_with(
        self,
        names: tuple[str, ...],
        first: FloatArray,
        forward: Any = None,
        *,
        near_linear: bool = False,
        gain: float = SMALLEST_GAIN,
    ) -> tuple[FloatArray, FloatArray]:
        """As ``_solve``, from ``first`` (k,) on.

        near_linear: the search begins with a linear step; gain: smallest one of the sum of squares, relative.
        """
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
        if near_linear:  # a soft loss would come there in many steps
            start = start - np.linalg.lstsq(jacobian(start), residual(start), rcond=None)[0]
        start = np.clip(start, low + 1e-9 * (high - low), high - 1e-9 * (high - low))
        found = least_squares(
            residual, start, jac=jacobian, bounds=(low, high), method="trf", loss="soft_l1", f_scale=SOFT_SCALE,
            xtol=1e-7, ftol=gain, gtol=1e-9, max_nfev=MOST_EVALUATIONS,
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


def _correlation(covariance: FloatArray, i: int, j: int) -> float:
    """Correlation of two parameters."""
    return float(covariance[i, j] / np.sqrt(covariance[i, i] * covariance[j, j]))
