"""Formulas of API RP 7G for drill pipe, in the units of its tables: inch, lb, lbf, ft-lbf, psi."""

from __future__ import annotations

import math

PLAIN_END = 3.3996  # weight per length of steel [lb/ft] over its section [in2] (API RP 7G, table 13)
TORSION = 0.096167  # 2 x 0.577/12: shear over tensile yield (von Mises), inch pounds to foot pounds (API RP 7G, A.9.1)
JOINT_YIELD = 120_000.0  # least yield strength of tool joints [psi] (API Spec 5DP)
MAKE_UP = (
    0.6  # recommended make-up torque over the torque at which the tool joint yields (API RP 7G, table 10)
)
THREAD_FRICTION = 0.08  # of threads and shoulders with dope (API RP 7G, A.8.2)


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

    0.096167 J/D sqrt(Y^2 - (P/A)^2), with J = pi/32 (D^4 - d^4) [in4]; 0.096167 = 2 x 0.577/12. The result is 0 if the
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


def tool_joint_torque(
    taper: float,
    threads: float,
    thread_height: float,
    root: float,
    pitch_diameter: float,
    pin_length: float,
    counterbore: float,
    joint_outer: float,
    joint_inner: float,
) -> float:
    """Torque at which pin or box of a tool joint yields [ft-lbf] (API RP 7G, A.8.2); 0 if no metal is left.

    (Y A/12) [p/(2 pi) + R_t f/cos 30 deg + R_s f], A the smaller section of pin and box, 3/4 in and 3/8 in from the shoulder.

    taper: of the thread on the diameter [in/ft]; threads: [1/in]; thread_height: of the sharp thread, root: its truncation [in].
    pitch_diameter: at the gauge point, pin_length, counterbore: of the box [in]; joint_outer, joint_inner: of the tool joint [in].
    """
    slope = taper / 12
    depth = 2 * (0.5 * thread_height - root) + slope / 8
    pin = section(pitch_diameter - depth, joint_inner)
    box = section(joint_outer, counterbore - 0.375 * slope)
    thread = (2 * pitch_diameter - (pin_length - 0.625) * slope) / 4  # mean radius of the thread [in]
    shoulder = (joint_outer + counterbore) / 4
    lever = 1 / (2 * math.pi * threads) + THREAD_FRICTION * (thread / math.cos(math.radians(30.0)) + shoulder)
    return max(JOINT_YIELD * min(pin, box) / 12 * lever, 0.0)


STEEL = 7850.0  # [kg/m3]
#: weights per length relative to a steel tube [-]: refused outside of the first pair, doubted outside of the second
POSSIBLE, USUAL = (0.2, 3.0), (0.6, 1.4)


def steel_tube(od: float, bore: float) -> float:
    """Mass per length of a steel tube [kg/m] of diameters [m]."""
    return STEEL * math.pi / 4 * (od**2 - bore**2)
