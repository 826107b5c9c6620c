"""Directions of a hole from the angles of trajectory.csv.

The formulas are the same as in drillpetsc.geometry (manual: eq-conv-direction, eq-conv-high-side). They are repeated
here because plotting reads run folders only and imports no solver code; a test compares the two.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]

COURSE = 30.0  # length to which build rates and dogleg severities refer [m]


def direction(inclination: npt.ArrayLike, azimuth: npt.ArrayLike) -> FloatArray:
    """Unit tangent (..., 3), north-east-down, from inclination and azimuth (...) [rad]."""
    i, a = np.broadcast_arrays(np.asarray(inclination, dtype=float), np.asarray(azimuth, dtype=float))
    return np.stack([np.sin(i) * np.cos(a), np.sin(i) * np.sin(a), np.cos(i)], axis=-1)


def high_side(tangent: FloatArray) -> FloatArray:
    """Unit vector (3,) normal to ``tangent`` (3,) towards the high side of the hole; north in a vertical
    hole."""
    up = np.array([0.0, 0.0, -1.0])
    side = up - tangent * (up @ tangent)
    if np.linalg.norm(side) < 1e-6:
        north = np.array([1.0, 0.0, 0.0])
        side = north - tangent * (north @ tangent)
    return side / np.linalg.norm(side)


def dogleg(one: FloatArray, two: FloatArray) -> FloatArray:
    """Angle (...) [rad] between unit vectors (..., 3)."""
    return 2 * np.arctan2(np.linalg.norm(two - one, axis=-1), np.linalg.norm(one + two, axis=-1))
