"""Stiffness of the wall of a hole from the moduli of rock and steel (manual: sec-contact-physical)."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drillpetsc.arrays import FloatArray

STEEL_YOUNG, STEEL_POISSON = 206e9, 0.3  # [Pa], [-]
ROCK_POISSON = 0.25
THIN_WALL = 0.15  # wall over outer diameter below which a tube ovalises noticeably


def line_stiffness(
    load: ArrayLike, radius: ArrayLike, hole: ArrayLike, steel: ArrayLike, wall: float, poisson: float
) -> FloatArray:
    """Secant stiffness [Pa] of a cylinder pressed into the wall of a hole, line contact (manual: eq-contact-line).

    load: per length [N/m]; radius: of the cylinder [m]; hole: its radius, larger [m].
    steel, wall: Young's moduli [Pa] of cylinder and wall; poisson: of the wall.
    """
    P, a, b = (np.asarray(v, dtype=float) for v in (load, radius, hole))
    inner, outer = (1 - STEEL_POISSON**2) / np.asarray(steel, dtype=float), (1 - poisson**2) / wall
    width = np.sqrt(4 * P * (a * b / (b - a)) * (inner + outer) / np.pi)
    depth = inner * (2 * np.log(4 * a / width) - 1) + outer * (2 * np.log(4 * b / width) - 1)
    return np.asarray(np.pi / depth)


def ring_stiffness(outer: ArrayLike, inner: ArrayLike, young: ArrayLike) -> FloatArray:
    """Stiffness [Pa] of a tube against two opposite loads per length (manual: eq-contact-ring); infinite for thick tubes.

    outer, inner: diameters [m]; young: modulus [Pa].
    """
    D, d, E = (np.asarray(v, dtype=float) for v in (outer, inner, young))
    t = 0.5 * (D - d)
    stiffness = E / (1 - STEEL_POISSON**2) * t**3 / 12 / (0.149 * (0.5 * (D - t)) ** 3)
    return np.where((d > 0) & (t < THIN_WALL * D), stiffness, np.inf)
