"""Doglegs that drill pipe bears without fatigue, and forces on its tool joints there, in SI.

API RP 7G; Lubinski, Maximum permissible dog-legs in rotary boreholes, JPT 13(2), 1961. Curvatures are in 1/m: a
dogleg of 1 deg/100 ft is 5.726e-4 1/m. Arguments may be numbers or arrays.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from drillpetsc.arrays import FloatArray

PSI = 6894.757293168361  # [Pa]
CORROSIVE = 0.6  # share of the permissible dogleg in corrosive mud (API RP 7G)
#: rule of the bending stress by grade: E (E-75) or S (S-135); for X and G the standard has no rule of its own
RULES = {"E-75": "E", "E75": "E", "S-135": "S", "S135": "S"}
AS_S = {"X-95": "S", "X95": "S", "G-105": "S", "G105": "S"}
_RANGE = {"E": 67000.0, "S": 133400.0}  # largest axial stress of each rule [psi]


def rule_of(grade: str | None) -> str | None:
    """Rule for a grade: E, S, or None where there is none."""
    if grade is None:
        return None
    name = grade.upper().replace(" ", "")
    return RULES.get(name) or AS_S.get(name)


def fatigue_bending_stress(axial_stress: ArrayLike, rule: str) -> FloatArray:
    """Bending stress that drill pipe under tension bears without fatigue [Pa] (API RP 7G).

    E: 19,500 - (10/67) s_t - (0.6/670^2) (s_t - 33,500)^2 psi up to s_t = 67,000 psi.
    S: 20,000 (1 - s_t/145,000) psi up to 133,400 psi.
    nan beyond, and in compression, of which the standard does not speak.

    axial_stress: tension over section [Pa]; rule: E or S.
    """
    tension = np.asarray(axial_stress, dtype=float) / PSI
    if rule == "E":
        stress = 19500 - 10 / 67 * tension - 0.6 / 670**2 * (tension - 33500) ** 2
    else:
        stress = 20000 * (1 - tension / 145000)
    return np.asarray(np.where((tension >= 0) & (tension <= _RANGE[rule]), stress * PSI, np.nan))


def tension_factor(pull: ArrayLike, stiffness: ArrayLike, half_joint: ArrayLike) -> FloatArray:
    """Curvature of the hole over the largest of the pipe in it, tanh(K l)/(K l) with K = sqrt(T/EI) (Lubinski 1961).

    Tension holds the pipe straight between tool joints and bends it beside them. 1 without tension.

    pull: T [N], not negative; stiffness: EI [N m2]; half_joint: l, half the length of a joint [m].
    """
    product = np.sqrt(np.maximum(pull, 0.0) / np.asarray(stiffness)) * np.asarray(half_joint)
    small = product < 1e-4
    return np.asarray(np.where(small, 1.0, np.tanh(product) / np.where(small, 1.0, product)))


def permissible_dogleg(
    pull: ArrayLike,
    outer: ArrayLike,
    section: ArrayLike,
    stiffness: ArrayLike,
    half_joint: ArrayLike,
    rule: str,
    young: ArrayLike,
) -> FloatArray:
    """Curvature of a hole in which drill pipe may rotate without fatigue [1/m] (API RP 7G).

    2 s_b/(E D) tanh(K l)/(K l); in field units (432,000/pi) s_b/(E D) tanh(K l)/(K l) deg/100 ft.

    pull: effective tension, the buoyed weight below [N]; nan in compression.
    outer: diameter of the tube [m]; section [m2]; stiffness: EI of the tube [N m2]; half_joint: l [m].
    rule: E or S; young: Young's modulus [Pa].
    """
    bending = fatigue_bending_stress(np.asarray(pull) / np.asarray(section), rule)
    return np.asarray(
        2 * bending / (np.asarray(young) * np.asarray(outer)) * tension_factor(pull, stiffness, half_joint)
    )
