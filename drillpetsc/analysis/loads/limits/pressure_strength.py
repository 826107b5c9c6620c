"""Pressures that pipe bears: burst by Barlow's formula, collapse by the four formulas of API, in SI.

API RP 7G, appendix A; API Bulletin 5C3. Both give the formulas in psi. Arguments may be numbers or arrays.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drillpetsc.arrays import FloatArray

PSI = 6894.757293168361  # [Pa]
WALL_TOLERANCE = 0.875  # least wall of new pipe over the nominal one
YOUNG_TERM = 46.95e6  # 2E/(1 - nu^2) of API, times 0.71 [psi]


def burst_pressure(outer: ArrayLike, wall: ArrayLike, strong: ArrayLike, worn: ArrayLike) -> FloatArray:
    """Compute the inside pressure at which the tube yields [Pa], 2 Y t/D (Barlow).

    New pipe counts 87.5 % of the wall, which its tolerance allows; worn pipe the wall that is left (API RP 7G).

    outer: diameter of the new tube [m]; wall: that is left [m]; strong: yield strength [Pa]; worn: whether the tube is worn.
    """
    share = np.where(worn, 1.0, WALL_TOLERANCE)
    return np.asarray(2 * np.asarray(strong) * share * wall / np.asarray(outer))


def yield_under_tension(strong: ArrayLike, axial_stress: ArrayLike) -> FloatArray:
    """Compute the yield strength that is left for collapse under tension [Pa] (API 5C3).

    Y (sqrt(1 - 0.75 (s/Y)^2) - 0.5 s/Y); Y in compression, nan beyond yield.
    """
    share = np.maximum(np.asarray(axial_stress, dtype=float) / np.asarray(strong, dtype=float), 0.0)
    with np.errstate(invalid="ignore"):
        left = np.sqrt(1 - 0.75 * share**2) - 0.5 * share
    return np.asarray(np.where(share < 1, strong * left, np.nan))


def collapse_constants(
    strong: ArrayLike,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Compute A, B, C [psi], F, G of the collapse formulas (API 5C3). strong: yield strength [psi]."""
    y = np.asarray(strong, dtype=float)
    a = 2.8762 + 0.10679e-5 * y + 0.21301e-10 * y**2 - 0.53132e-16 * y**3
    b = 0.026233 + 0.50609e-6 * y
    c = -465.93 + 0.030867 * y - 0.10483e-7 * y**2 + 0.36989e-13 * y**3
    ratio = b / a
    slope = 3 * ratio / (2 + ratio)
    f = YOUNG_TERM * slope**3 / (y * (slope - ratio) * (1 - slope) ** 2)
    return a, b, c, f, f * ratio


def collapse_pressure(slenderness: ArrayLike, strong: ArrayLike) -> FloatArray:
    """Compute the outside pressure at which the tube collapses [Pa] (API 5C3, RP 7G).

    By the slenderness: yield, plastic, transition or elastic collapse. nan where there is no wall.

    slenderness: outer diameter over wall, of the worn tube [-]; strong: yield strength that is left [Pa].
    """
    x, y = np.broadcast_arrays(np.asarray(slenderness, dtype=float), np.asarray(strong, dtype=float) / PSI)
    with np.errstate(all="ignore"):
        a, b, c, f, g = collapse_constants(y)
        rest = b + c / y
        ends = (
            (np.sqrt((a - 2) ** 2 + 8 * rest) + (a - 2)) / (2 * rest),
            y * (a - f) / (c + y * (b - g)),
            (2 + b / a) / (3 * b / a),
        )
        by_yield = 2 * y * (x - 1) / x**2
        plastic = y * (a / x - b) - c
        transition = y * (f / x - g)
        elastic = YOUNG_TERM / (x * (x - 1) ** 2)
        found = np.where(
            x <= ends[0],
            by_yield,
            np.where(x <= ends[1], plastic, np.where(x <= ends[2], transition, elastic)),
        )
    return np.asarray(np.where((x > 2) & (y > 0) & np.isfinite(found), found * PSI, np.nan))


def pressure_ratios(
    outer: FloatArray,
    worn: FloatArray,
    inner: FloatArray,
    strong: FloatArray,
    axial_stress: FloatArray,
    inside: FloatArray,
    outside: FloatArray,
) -> dict[str, FloatArray]:
    """Columns `burst_ratio` and `collapse_ratio` of limits.csv (n, 2): the difference of the pressures over what the tube bears.

    Where the pressure acts the other way the ratio is 0.

    outer, worn, inner: (n, 1) diameters of the new tube, of the worn one, and of the bore [m]; strong: (n, 1) yield strength [Pa].
    axial_stress: (n, 2) [Pa]; inside, outside: (n, 2) pressures [Pa].
    """
    wall = 0.5 * (worn - inner)
    difference = inside - outside
    with np.errstate(divide="ignore", invalid="ignore"):
        burst = burst_pressure(outer, wall, strong, worn < outer)
        collapse = collapse_pressure(worn / wall, yield_under_tension(strong, axial_stress))
        return {
            "burst_ratio": np.maximum(difference, 0.0) / burst,
            "collapse_ratio": np.maximum(-difference, 0.0) / collapse,
        }
