"""Places and weights of integration along an element, 0 at its upper and 1 at its lower end."""

from __future__ import annotations

import numpy as np
from scipy.special import roots_jacobi

from drillpetsc.field import FloatArray
from drillpetsc.tubulars import StringMesh


def rule(points: int, upper: bool = False, lower: bool = False) -> FloatArray:
    """(m, 2) places and weights, exact for polynomials of degree 2 points - 1 at least.

    Gauss's rule (m = points); with a place at the upper or lower end Radau's, at both Lobatto's (m = points + 1); Abramowitz and Stegun,
    Handbook of Mathematical Functions, 25.4.29 to 25.4.32.
    """
    inside = points - int(upper and lower)
    x, w = roots_jacobi(inside, float(lower), float(upper)) if inside else (np.zeros(0), np.zeros(0))  # (1 - x)^lower (1 + x)^upper
    w = w / ((1 - x) ** lower * (1 + x) ** upper)
    if upper:
        x, w = np.append(-1.0, x), np.append(2.0 - w.sum() if not lower else 0.5 * (2.0 - w.sum()), w)
    if lower:
        x, w = np.append(x, 1.0), np.append(w, 2.0 - w.sum())
    return np.ascontiguousarray(np.column_stack([(x + 1) / 2, w / 2]))


def corners(mesh: StringMesh) -> tuple[np.ndarray, np.ndarray]:
    """(n,) elements whose upper end, and whose lower end, stands out: free, or beside a thinner item.  The drive holds the first."""
    radius = 0.5 * mesh.outer_diameter
    beside = np.where(mesh.is_joint, np.inf, radius)
    hanging = np.zeros(mesh.nodes)
    for body in mesh.bodies:
        hanging[body.node] = max(hanging[body.node], body.radius)
    upper, lower = np.zeros(len(radius), dtype=bool), np.zeros(len(radius), dtype=bool)
    upper[1:] = radius[1:] > np.maximum(beside[:-1], hanging[1:-1])
    lower[:] = radius > np.maximum(np.append(beside[1:], 0.0), hanging[1:])
    return upper, lower
