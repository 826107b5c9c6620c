"""Array types that every folder may use."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int32]


def components(vectors: ArrayLike) -> FloatArray:
    """Components (3, ...) of ``vectors`` (..., 3), each in memory of its own run.

    For functions such as ``np.arctan2``: of an argument with gaps in memory numpy takes the vector unit or not by where the result happens
    to stand, and the last digit with it.
    """
    return np.ascontiguousarray(np.moveaxis(np.asarray(vectors, dtype=float), -1, 0))


def halves_at_nodes(values: FloatArray) -> FloatArray:
    """Share the values (n,) of a row of elements evenly between their ends: sums (n+1,) at the nodes, in the same unit."""
    return 0.5 * (np.append(values, 0.0) + np.append(0.0, values))


def sums_from_below(values: FloatArray) -> FloatArray:
    """Sums (n+1,) of ``values`` (n,) from each place to the end of the row."""
    return np.append(np.cumsum(values[::-1])[::-1], 0.0)
