"""Samples of uncertain numbers: a Latin hypercube with given marginal distributions and correlations.

Each number is drawn once from each of n equally likely intervals (McKay, Beckman and Conover 1979).  The samples of a number are
then ordered like correlated normal ones (Iman and Conover 1982), which leaves its distribution as it is.
"""

from __future__ import annotations

from collections.abc import Sequence
from statistics import NormalDist

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.uncertain import Spread

SMALLEST_EIGENVALUE = 1e-9  # of a correlation matrix that can be


def correlation_of(names: Sequence[str], spreads: Sequence[Spread]) -> FloatArray:
    """(k, k) correlation matrix; ValueError if two keys contradict each other, or no distribution has this matrix."""
    matrix = np.eye(len(names))
    for i, spread in enumerate(spreads):
        for other, value in spread.correlated.items():
            j = list(names).index(other)
            back = spreads[j].correlated.get(names[i], value)
            if back != value:
                raise ValueError(f"{names[i]} and {other} give {value:g} and {back:g}")
            matrix[i, j] = matrix[j, i] = value
    if np.linalg.eigvalsh(matrix)[0] < SMALLEST_EIGENVALUE:
        raise ValueError("correlations that can hold together")
    return matrix


def draw(spreads: Sequence[Spread], correlation: FloatArray, samples: int, seed: int) -> FloatArray:
    """(n, k) samples [SI]; the same for the same seed.

    correlation: (k, k) of the normal numbers by whose ranks the samples are ordered; for normal distributions their own.
    """
    rng, count = np.random.default_rng(seed), len(spreads)
    inverse = NormalDist().inv_cdf
    ranks = np.stack([rng.permutation(samples) for _ in spreads], axis=1)
    within = rng.random((samples, count))
    # scores of the ranks without any correlation of their own, then with the wanted one
    scores = np.array([inverse((i + 0.5) / samples) for i in range(samples)])[ranks]
    own = np.linalg.cholesky(np.corrcoef(scores, rowvar=False).reshape(count, count))
    ordered = scores @ np.linalg.inv(own).T @ np.linalg.cholesky(correlation).T
    place = ordered.argsort(axis=0).argsort(axis=0)
    share = np.clip((place + within) / samples, 1e-12, 1 - 1e-12)
    return np.stack([_values(spread, share[:, k]) for k, spread in enumerate(spreads)], axis=1)


def _values(spread: Spread, share: FloatArray) -> FloatArray:
    """Values (n,) below which a share (n,) of the distribution lies."""
    if spread.form.endswith("normal"):
        inverse, (mean, deviation) = NormalDist().inv_cdf, spread.numbers
        score = np.array([inverse(q) for q in share.tolist()])
        if spread.form == "normal":
            return mean + deviation * score
        width = np.sqrt(np.log1p((deviation / mean) ** 2))  # of the logarithm
        return np.asarray(mean * np.exp(width * score - 0.5 * width**2))
    low, high = spread.numbers[0], spread.numbers[-1]
    if spread.form == "uniform":
        return low + (high - low) * share
    rise, fall = spread.numbers[1] - low, high - spread.numbers[1]
    below = low + np.sqrt(share * (high - low) * rise)
    return np.where(share * (high - low) < rise, below, high - np.sqrt((1 - share) * (high - low) * fall))
