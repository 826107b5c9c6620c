"""Loads at which a string buckles in a hole, by their names, in SI. Compressions are positive.

q is the side load per length, |w_perp + T kappa|: the buoyed weight across the hole, and the axial force in a curve.

Dawson and Paslay, JPT 36(10), 1984 (SPE 11167); Chen, Lin and Cheatham, ASME JERT 112, 1990; Wu and Juvkam-Wold,
ASME JERT 115, 1993; Lubinski, Drilling and Production Practice, API, 1950. Arguments may be numbers or arrays.
"""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from drillpetsc.arrays import FloatArray

Helical = Literal["chen", "wu"]
#: helical over sinusoidal load in a hole with side load
HELICAL_RATIO: dict[str, float] = {"chen": np.sqrt(2.0), "wu": 2 * np.sqrt(2.0) - 1}
AUTHORS = {"chen": "Chen, Lin and Cheatham", "wu": "Wu and Juvkam-Wold"}
LUBINSKI = (1.94, 3.75)  # first and second order of a vertical string, over (EI w^2)^(1/3)


def dawson_paslay(stiffness: ArrayLike, side_load: ArrayLike, clearance: ArrayLike) -> FloatArray:
    """Sinusoidal buckling load [N], 2 sqrt(EI q/r).

    stiffness: EI [N m2]; side_load: q [N/m]; clearance: radial, r [m].
    """
    return np.asarray(2 * np.sqrt(np.asarray(stiffness) * side_load / np.asarray(clearance)))


def law_words(law: Helical) -> str:
    """A law of the helical limit in words."""
    return f"{law}, {HELICAL_RATIO[law]:.3g} times the sinusoidal load ({AUTHORS[law]})"


def helical(
    stiffness: ArrayLike, side_load: ArrayLike, clearance: ArrayLike, law: Helical = "chen"
) -> FloatArray:
    """Helical buckling load [N]: 2 sqrt(2) sqrt(EI q/r) (chen), or 2 (2 sqrt(2) - 1) sqrt(EI q/r) (wu).

    Arguments as of `dawson_paslay`.
    """
    return HELICAL_RATIO[law] * dawson_paslay(stiffness, side_load, clearance)


def lubinski_length(stiffness: ArrayLike, weight: ArrayLike) -> FloatArray:
    """Unit length (EI/w)^(1/3) [m]; stiffness: EI [N m2]; weight: buoyed, per length [N/m]."""
    return np.asarray(np.cbrt(np.asarray(stiffness) / np.asarray(weight)))


def lubinski(stiffness: ArrayLike, weight: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Loads at the lower end of a vertical string [N] that buckle it in the first and the second order.

    1.94 and 3.75 (EI w^2)^(1/3).  Arguments as of `lubinski_length`.
    """
    unit = np.asarray(weight) * lubinski_length(stiffness, weight)
    return LUBINSKI[0] * unit, LUBINSKI[1] * unit
