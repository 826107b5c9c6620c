"""Strength of a tube, in SI: stresses under tension, bending, torque and pressure, and the loads at which it yields.

Sources: stresses of a thick tube by Lame (Timoshenko and Goodier, Theory of Elasticity, section 28); limits by
API RP 7G, appendix A. Arguments may be numbers or arrays.
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
