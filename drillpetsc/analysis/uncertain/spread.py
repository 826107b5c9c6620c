"""Statistics of outputs over samples: mean, deviation, quantiles, and the share of each number in the variance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np

from drillpetsc.arrays import FloatArray

LEAST = 2  # samples of which there is a deviation
CONSTANT = 1e-12  # deviation, relative to the largest value, that is rounding


@dataclass(frozen=True)
class Spreads:
    """Statistics of m outputs by one method.

    mean, deviation: (m,) [SI]; failed: (m,) samples without a value; quantiles: (m, q) [SI]; shares: (m, k) of the variance [-],
    nan for an output that does not vary.
    """

    method: str
    mean: FloatArray
    deviation: FloatArray
    failed: np.ndarray
    quantiles: FloatArray
    shares: FloatArray

    def of(self, chosen: Sequence[int]) -> Spreads:
        """The statistics of some outputs."""
        rows = {f.name: getattr(self, f.name)[chosen] for f in fields(self) if f.name != "method"}
        return Spreads(self.method, **rows)


def spreads_of(
    method: str,
    draws: FloatArray,
    values: FloatArray,
    levels: Sequence[float],
    slopes: FloatArray | None = None,
) -> Spreads:
    """Statistics of outputs (n, m) at samples (n, k) of the numbers.

    slopes: (m, k) by which the shares are taken, None: those of the least squares over the samples.
    The share of a number is slope times the covariance of output and number over the variance; shares of correlated numbers
    may be negative, and what is missing to 1 is not linear.
    """
    count, m, k = len(values), values.shape[1], draws.shape[1]
    mean, deviation = np.full(m, np.nan), np.full(m, np.nan)
    quantiles, shares = np.full((m, len(levels)), np.nan), np.full((m, k), np.nan)
    known = np.isfinite(values)
    for i in range(m):
        mine = known[:, i]
        if mine.sum() < LEAST:
            continue
        y, x = values[mine, i], draws[mine]
        mean[i], deviation[i] = y.mean(), y.std(ddof=1)
        quantiles[i] = np.quantile(y, levels)
        if deviation[i] <= CONSTANT * np.abs(y).max():
            continue
        centred, size = x - x.mean(axis=0), x.std(axis=0)
        if slopes is not None:
            slope = slopes[i]
        elif mine.sum() > k + 1:
            slope = np.linalg.lstsq(centred / size, y - y.mean(), rcond=None)[0] / size
        else:
            continue
        covariance = centred.T @ (y - y.mean()) / (len(y) - 1)
        shares[i] = slope * covariance / deviation[i] ** 2
    return Spreads(method, mean, deviation, count - known.sum(axis=0), quantiles, shares)
