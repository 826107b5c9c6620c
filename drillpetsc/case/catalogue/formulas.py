"""Formulas of API RP 7G for drill pipe, in the units of its tables: inch, lb, lbf, ft-lbf, psi."""

from __future__ import annotations

import math

PLAIN_END = 3.3996  # weight per length of steel [lb/ft] over its section [in2] (API RP 7G, table 13)
TORSION = 0.096167  # 2 x 0.577/12: shear over tensile yield (von Mises), inch pounds to foot pounds (API RP 7G, A.9.1)
SPIRAL = 0.96  # weight of a spiral collar over that of a round one (Smith, Drilling Assembly Handbook)


def section(outer: float, inner: float) -> float:
    """Section of a tube [in2] of diameters [in]."""
    return math.pi / 4 * (outer**2 - inner**2)


def plain_end_weight(outer: float, inner: float) -> float:
    """Weight per length of a plain tube [lb/ft] of diameters [in]."""
    return PLAIN_END * section(outer, inner)


def worn_diameter(outer: float, inner: float, wall: float) -> float:
    """Outer diameter [in] of a tube worn on the outside to the fraction ``wall`` of its wall [-]; the bore is new.

    Diameters in any one unit.
    """
    return inner + wall * (outer - inner)


def tensile_strength(outer: float, inner: float, yield_strength: float) -> float:
    """Pull at which a tube yields [lbf]; diameters [in], yield strength [psi] (API RP 7G, A.1)."""
    return yield_strength * section(outer, inner)


def torsional_strength(outer: float, inner: float, yield_strength: float, pull: float = 0.0) -> float:
    """Torque at which a tube under a pull [lbf] yields [ft-lbf] (API RP 7G, A.9.1 and A.9.2).

    0.096167 J/D sqrt(Y^2 - (P/A)^2), with J = pi/32 (D^4 - d^4) [in4]; 0.096167 = 2 x 0.577/12. The result is 0 where the
    pull alone exceeds the yield.
    Diameters [in], yield strength [psi].
    """
    polar = math.pi / 32 * (outer**4 - inner**4)
    rest = yield_strength**2 - (pull / section(outer, inner)) ** 2
    return TORSION * polar / outer * math.sqrt(max(rest, 0.0))


def adjusted_weight(
    plain_end: float,
    upset_weight: float,
    upset_diameter: float,
    joint_outer: float,
    joint_inner: float,
    joint_length: float,
) -> float:
    """Weight per length [lb/ft] of drill pipe with its tool joints, for a pipe of 29.4 ft between upsets (API RP 7G, 4.4).

    plain_end: of the tube [lb/ft]; upset_weight: of both upsets [lb]; upset_diameter: of the elevator upset [in].
    joint_outer, joint_inner: diameters of the tool joint [in]; joint_length: pin tong and box tong together [in].
    """
    taper = joint_outer - upset_diameter
    joint = (
        0.222 * joint_length * (joint_outer**2 - joint_inner**2)
        + 0.167 * (joint_outer**3 - upset_diameter**3)
        - 0.501 * joint_inner**2 * taper
    )
    length = (joint_length + 2.253 * taper) / 12  # [ft]
    return (29.4 * plain_end + upset_weight + joint) / (29.4 + length)
