"""Strength of a tube, in SI: stresses, the loads at which it yields, and the pressures at which it bursts or collapses.

Sources: stresses of a thick tube by Lame (Timoshenko and Goodier, Theory of Elasticity, section 28); limits by API RP 7G,
appendix A; burst by Barlow's formula and collapse by the four formulas of API RP 7G, appendix A, and API Bulletin 5C3, both in psi.
Arguments may be numbers or arrays.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from drillpetsc.arrays import FloatArray
from drillpetsc.case.catalogue.formulas import TORSION

#: torque limit over J/D sqrt(Y^2 - (P/A)^2) in consistent units: 2 x 0.577, shear over tensile yield (von Mises)
SHEAR_YIELD = 12 * TORSION


@dataclass(frozen=True)
class Stresses:
    """Stresses of a tube [Pa], tension positive; arrays of one shape.

    axial: of the pull. bending: largest, at the outer fibre, not negative. shear: of the torque, at the outer fibre.
    hoop: at the bore, the largest of the section.
    outer, inner: von Mises stress at the outer and the inner fibre, on the worse side of the bend.
    """

    axial: FloatArray
    bending: FloatArray
    shear: FloatArray
    hoop: FloatArray
    outer: FloatArray
    inner: FloatArray

    @property
    def von_mises(self) -> FloatArray:
        """The larger of both fibres [Pa]."""
        return np.maximum(self.outer, self.inner)


def area(outer: ArrayLike, inner: ArrayLike) -> FloatArray:
    """Section of a tube [m2] of diameters [m]."""
    return np.pi / 4 * (np.square(outer) - np.square(inner))


def second_moment(outer: ArrayLike, inner: ArrayLike) -> FloatArray:
    """Second moment of area of a tube [m4], half of the polar one; diameters [m]."""
    return np.pi / 64 * (np.power(outer, 4) - np.power(inner, 4))


def lame(
    outer: ArrayLike, inner: ArrayLike, inside: ArrayLike, outside: ArrayLike, at_bore: bool
) -> tuple[FloatArray, FloatArray]:
    """Hoop and radial stress [Pa] of a tube under pressure, at the bore or at the outer fibre.

    outer, inner: diameters [m]; inside, outside: pressures [Pa].
    """
    o, i = np.square(outer), np.square(inner)
    p, q = np.asarray(inside, dtype=float), np.asarray(outside, dtype=float)
    if at_bore:
        return (p * (o + i) - 2 * q * o) / (o - i), -p
    return (2 * p * i - q * (o + i)) / (o - i), -q


def stresses(
    outer: ArrayLike,
    inner: ArrayLike,
    axial_force: ArrayLike,
    bending_moment: ArrayLike,
    torque: ArrayLike,
    inside: ArrayLike = 0.0,
    outside: ArrayLike = 0.0,
) -> Stresses:
    """Stresses of a tube: pull and pressure, bending on both sides, torque. Shear of side forces is left out.

    outer, inner: diameters [m]; axial_force: tension of the pipe's wall [N]; bending_moment, torque [N m].
    inside, outside: pressures in the bore and around the tube [Pa].
    """
    axial = np.asarray(axial_force, dtype=float) / area(outer, inner)
    moment = second_moment(outer, inner)
    out, bore = 0.5 * np.asarray(outer), 0.5 * np.asarray(inner)
    bending = np.abs(bending_moment) * out / moment
    shear = np.abs(torque) * out / (2 * moment)
    share = bore / out
    fibres = []
    for at_bore, factor in ((False, np.ones_like(share)), (True, share)):
        hoop, radial = lame(outer, inner, inside, outside, at_bore)
        fibres.append(
            np.maximum(
                *(
                    _mises(axial + side * factor * bending, hoop, radial, factor * shear)
                    for side in (1.0, -1.0)
                )
            )
        )
    at_the_bore = lame(outer, inner, inside, outside, True)[0]
    return Stresses(axial, bending, shear, at_the_bore + 0 * axial, *fibres)


def _mises(along: FloatArray, hoop: FloatArray, radial: FloatArray, shear: FloatArray) -> FloatArray:
    square = 0.5 * ((along - hoop) ** 2 + (hoop - radial) ** 2 + (radial - along) ** 2) + 3 * shear**2
    return np.asarray(np.sqrt(square))


def tension_at_yield(outer: ArrayLike, inner: ArrayLike, yield_strength: ArrayLike) -> FloatArray:
    """Pull at which a tube yields [N] (API RP 7G, A.1); diameters [m], yield strength [Pa]."""
    return np.asarray(yield_strength) * area(outer, inner)


def torque_at_yield(
    outer: ArrayLike, inner: ArrayLike, yield_strength: ArrayLike, axial_force: ArrayLike = 0.0
) -> FloatArray:
    """Torque at which a tube under a pull yields [N m] (API RP 7G, A.9.1 and A.9.2).

    1.154 J/D sqrt(Y^2 - (P/A)^2), 0 where the pull alone exceeds the yield.

    outer, inner: diameters [m]; yield_strength [Pa]; axial_force: of either sign [N].
    """
    rest = np.square(yield_strength) - np.square(np.asarray(axial_force) / area(outer, inner))
    return SHEAR_YIELD * 2 * second_moment(outer, inner) / np.asarray(outer) * np.sqrt(np.maximum(rest, 0.0))


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
    """Columns `burst_ratio` and `collapse_ratio` of limits.csv (n, 2): the difference of the pressures over what the tube withstands.

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
