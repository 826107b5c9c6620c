"""What a model of the string leaves out of readings: errors that are alike along depth (manual: sec-calibrate-prediction).

Friction and weight change from one stretch of hole to the next. Neighbouring readings share an error, and each has its own. All of
these are normal; their sizes have wide priors and follow from the fitted readings. The prediction is the mean of the readings below,
given those above (universal kriging; Cressie, Statistics for Spatial Data, 1993, section 3.4).
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.arrays import FloatArray

SECTION = 1000.0  # distance over which friction and weight change: a section of a well [m]
# Medians of the priors. Friction factors are between 0.1 and 0.5; the weight of pipe and mud is known to 1 %; readings of one stand
# share an error.
FRICTION, WEIGHT, STAND = 0.1, 0.01, 30.0
KNOWN_TO, UNKNOWN = 2.0, 5.0  # factors to which these are known, and the sizes of errors of readings
TINY, FARTHEST = 1e-6, 4.0  # smallest scatter [-]; bound of the logarithms of sizes about their medians
DRAWS, HESSIAN_STEP = 256, 0.15  # draws of the sizes; step of the second derivatives of their probability
MOST = 100  # readings of one series, beyond which neighbours are averaged
FAR_OFF = 3.0  # scatters from which a reading is as uncertain as it is far off


@dataclass(frozen=True)
class Relative:
    """Readings over their computed values, (n,) or (n, k).

    depth: bit depth [m]; operation, hook: of which series; error: (measured - computed) / size; size: [N], [N m].
    slope: change by each fitted parameter; source: (n, 2) change by the deepest friction factor and by the weight factor.
    noise: variance over that of a single good reading.
    """

    depth: FloatArray
    operation: np.ndarray
    hook: np.ndarray
    error: FloatArray
    size: FloatArray
    slope: FloatArray
    source: FloatArray
    noise: FloatArray

    def condensed(self) -> Relative:
        """Means of neighbours, if a series has more readings than are needed."""
        groups: list[np.ndarray] = []
        for operation in np.unique(self.operation):
            for hook in (True, False):
                rows = np.flatnonzero((self.operation == operation) & (self.hook == hook))
                rows = rows[np.argsort(self.depth[rows], kind="stable")]
                groups += [some for some in np.array_split(rows, MOST) if len(some)]

        def mean(values: FloatArray) -> FloatArray:
            return np.array([values[rows].mean(axis=0) for rows in groups])

        first = [rows[0] for rows in groups]
        count = np.array([len(rows) for rows in groups])
        return Relative(
            mean(self.depth), self.operation[first], self.hook[first], mean(self.error), mean(self.size),
            mean(self.slope), mean(self.source), mean(self.noise) / count,
        )  # fmt: skip


def relative(work: Calibration, values: dict[str, float], names: tuple[str, ...], deepest: str) -> Relative:
    """Readings beside those computed with some values of parameters.

    names: fitted parameters; deepest: friction factor that changes with depth.
    """
    d, wanted = work.data, (*names, deepest, "weight_factor")
    computed = work.computed([values])[0]
    size = np.maximum(np.abs(computed), TINY * np.abs(computed).max())
    change = (work.slopes(values, wanted) / size).T
    error, noise = (d.value - computed) / size, np.ones(len(size))
    for rows in (d.hook, ~d.hook):
        noise[rows] = np.maximum((error[rows] / (FAR_OFF * _scatter(error[rows]))) ** 2, 1.0)
    depth = np.array([work.points[i].bit_depth for i in d.point])
    operation = np.array([work.points[i].operation for i in d.point])
    return Relative(depth, operation, d.hook, error, size, change[:, :-2], change[:, -2:], noise)


def _scatter(error: FloatArray) -> float:
    """Standard deviation of relative errors (n,) [-], by the median."""
    return max(1.4826 * float(np.median(np.abs(error))), TINY) if len(error) else TINY


def _smooth(apart: FloatArray) -> FloatArray:
    """Correlation of a process with a derivative, Matern's of order 3/2: loads add up friction and weight of the whole string."""
    x = np.sqrt(3.0) * apart
    return np.asarray((1 + x) * np.exp(-x))


class ModelError:
    """Errors of fitted readings as a normal process along depth.

    fitted: the readings; known: (k,) precision that priors give each fitted parameter; away: (k,) their means less the fitted values.
    """

    def __init__(self, fitted: Relative, known: FloatArray, away: FloatArray) -> None:
        self.noise = {
            hook: float(fitted.noise[fitted.hook == hook].mean())
            for hook in (True, False)
            if hook in fitted.hook
        }
        self.fitted = fitted.condensed()
        self.scale = np.maximum(np.abs(self.fitted.slope).max(axis=0, initial=0.0), 1e-300)
        self.slope = self.fitted.slope / self.scale
        self.known, self.away = known / self.scale**2, away * self.scale
        medians, factors = [FRICTION, WEIGHT], [KNOWN_TO, KNOWN_TO]
        for hook in self.noise:
            half = _scatter(self.fitted.error[self.fitted.hook == hook]) / np.sqrt(2)
            medians += [half, half, STAND]
            factors += [UNKNOWN, UNKNOWN, KNOWN_TO]
        self.middle, self.spread = np.log(medians), np.log(factors)

    def predict(self, held: Relative) -> tuple[FloatArray, FloatArray]:
        """(mean, standard deviation) of (measured - computed) / size of other readings, (m,) each."""
        sizes = self._draws()
        found = [self._given(x, held) for x in sizes]
        mean, variance = (np.array(q) for q in zip(*found, strict=True))
        return mean.mean(axis=0), np.sqrt(variance.mean(axis=0) + mean.var(axis=0))

    # ------------------------------------------------------------------ sizes of the errors
    @cached_property
    def best(self) -> FloatArray:
        """Most probable logarithms of the sizes."""
        from scipy.optimize import minimize

        bounds = [(q - FARTHEST, q + FARTHEST) for q in self.middle]
        return np.asarray(minimize(self._unlikely, self.middle, method="L-BFGS-B", bounds=bounds).x)

    def _draws(self) -> FloatArray:
        """(DRAWS, h) logarithms of the sizes, normal about the most probable ones (Laplace's approximation)."""
        count, h, f = len(self.best), HESSIAN_STEP, self._unlikely
        curvature = np.empty((count, count))
        step = h * np.eye(count)
        for i in range(count):
            for j in range(i + 1):
                a, b = step[i] + step[j], step[i] - step[j]
                four = f(self.best + a) - f(self.best + b) - f(self.best - b) + f(self.best - a)
                curvature[i, j] = curvature[j, i] = four / (4 * h**2)
        power, axes = np.linalg.eigh(curvature)
        power = np.maximum(power, self.spread.max() ** -2)  # no less is known than by the widest prior
        draw = np.random.default_rng(0).standard_normal((DRAWS, count))
        return np.asarray(self.best + (draw / np.sqrt(power)) @ axes.T)

    def _unlikely(self, x: FloatArray) -> float:
        """Negative logarithm of the probability of the sizes: restricted likelihood and priors."""
        lower = np.linalg.cholesky(self._covariance(x))
        white = np.linalg.solve(lower, np.column_stack([self.fitted.error, self.slope]))
        error, slope = white[:, 0], white[:, 1:]
        power, push = slope.T @ slope + np.diag(self.known), slope.T @ error + self.known * self.away
        left = error @ error + self.away**2 @ self.known - push @ np.linalg.lstsq(power, push, rcond=None)[0]
        likelihood = 2 * np.log(np.diag(lower)).sum() + np.linalg.slogdet(power)[1] + left
        return float(0.5 * (likelihood + np.sum(((x - self.middle) / self.spread) ** 2)))

    # ------------------------------------------------------------------ the process
    def _alike(self, x: FloatArray, other: Relative) -> FloatArray:
        """(m, n) covariance of other readings with the fitted ones."""
        mine, size = self.fitted, np.exp(x)
        apart = np.abs(other.depth[:, None] - mine.depth)
        same = other.operation[:, None] == mine.operation
        friction, weight = (size[k] ** 2 * np.outer(other.source[:, k], mine.source[:, k]) for k in (0, 1))
        # friction of running in does not determine friction of pulling out; the weight is the same
        out = _smooth(apart / SECTION) * (same * friction + weight)
        for i, hook in enumerate(self.noise):
            _, shared, length = size[2 + 3 * i : 5 + 3 * i]
            both = same & np.outer(other.hook == hook, mine.hook == hook)
            out += both * shared**2 * np.exp(-apart / length)
        return np.asarray(out)

    def _covariance(self, x: FloatArray) -> FloatArray:
        """(n, n) of the fitted readings."""
        own = np.empty(len(self.fitted.error))
        for i, hook in enumerate(self.noise):
            rows = self.fitted.hook == hook
            own[rows] = np.exp(2 * x[2 + 3 * i]) * self.fitted.noise[rows]
        return self._alike(x, self.fitted) + np.diag(own)

    def _given(self, x: FloatArray, held: Relative) -> tuple[FloatArray, FloatArray]:
        """(mean, variance) of relative errors of other readings, (m,) each, for sizes of errors."""
        from scipy.linalg import cho_factor, cho_solve

        factor, between = cho_factor(self._covariance(x), lower=True), self._alike(x, held)
        error, slope = cho_solve(factor, self.fitted.error), cho_solve(factor, self.slope)
        spread = np.linalg.pinv(self.slope.T @ slope + np.diag(self.known))
        change = spread @ (self.slope.T @ error + self.known * self.away)
        left = held.slope / self.scale - between @ slope
        mean = between @ error + left @ change
        size = np.exp(x)
        own = held.source**2 @ size[:2] ** 2
        for i, hook in enumerate(self.noise):
            own[held.hook == hook] += size[2 + 3 * i] ** 2 * self.noise[hook] + size[3 + 3 * i] ** 2
        explained = np.einsum("mn,nm->m", between, cho_solve(factor, between.T))
        return mean, own - explained + np.einsum("mi,ij,mj->m", left, spread, left)
