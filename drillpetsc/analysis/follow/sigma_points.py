"""A filter with sigma points: a normal belief, corrected by readings of a function that is not linear (manual: sec-follow-filter).

The points and weights are those of Norgaard, Poulsen and Ravn (Automatica 36, 2000): differences over sqrt(3) standard deviations,
whose covariances cannot become negative.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray

SPREAD = (
    3.0  # square of the distance of the points in standard deviations: the fourth moment of a normal density
)
SMALLEST = 1e-12  # relative variance that keeps a covariance positive

Function = Callable[[FloatArray], FloatArray]
"""(s, n) points -> (s, m) readings."""


@dataclass(frozen=True)
class Belief:
    """A normal density: mean (n,), covariance (n, n)."""

    mean: FloatArray
    covariance: FloatArray

    @property
    def sd(self) -> FloatArray:
        """(n,) standard deviations."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))


@dataclass(frozen=True)
class Expected:
    """Readings that a belief expects: mean (m,), covariance (m, m), without noise; cross: (n, m) covariance with the states."""

    mean: FloatArray
    covariance: FloatArray
    cross: FloatArray


def expected(belief: Belief, function: Function) -> Expected:
    """Mean and covariances of a function of the states, by one call with 2n + 1 points."""
    n = len(belief.mean)
    scale = np.maximum(belief.sd, 1e-300)
    alike = belief.covariance / np.outer(scale, scale) + SMALLEST * np.eye(n)
    root = scale[:, None] * np.linalg.cholesky(alike)
    step = np.sqrt(SPREAD) * root.T
    found = function(np.vstack([belief.mean, belief.mean + step, belief.mean - step]))
    middle, above, below = found[0], found[1 : n + 1], found[n + 1 :]
    odd, even = above - below, above + below - 2 * middle
    mean = middle + even.sum(axis=0) / (2 * SPREAD)
    covariance = odd.T @ odd / (4 * SPREAD) + (SPREAD - 1) / (4 * SPREAD**2) * even.T @ even
    return Expected(mean, covariance, root @ odd / (2 * np.sqrt(SPREAD)))


def corrected(belief: Belief, seen: Expected, reading: FloatArray, noise: FloatArray, gate: float) -> Belief:
    """The belief after readings (m,) with noise covariance (m, m).

    gate: squared distance of a reading beyond which its noise is widened in proportion; an outlier is not dropped.
    """
    off = reading - seen.mean
    distance = float(off @ np.linalg.solve(seen.covariance + noise, off))
    spread = seen.covariance + noise * max(distance / gate, 1.0)
    gain = np.linalg.solve(spread, seen.cross.T).T
    covariance = belief.covariance - gain @ spread @ gain.T
    return Belief(belief.mean + gain @ off, 0.5 * (covariance + covariance.T))
