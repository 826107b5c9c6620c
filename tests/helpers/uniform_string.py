"""Mesh of one uniform piece of string, without a case."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.string_mesh import StringMesh, plain_sizes


def uniform_string(length: float, elements: int, **section: float) -> StringMesh:
    """Mesh one uniform piece.

    length [m]; elements: their number.
    section: values as returned by ``tube``; missing values are zero.
    """
    depth = np.linspace(0.0, length, elements + 1)

    def full(key: str, default: float = 0.0) -> FloatArray:
        return np.full(elements, float(section.get(key, default)))

    names = (
        "axial_stiffness",
        "bending_stiffness",
        "torsional_stiffness",
        "mass",
        "polar_inertia",
        "stiffness_damping",
        "mass_damping",
    )
    columns: dict[str, Any] = {k: full(k) for k in names}
    return StringMesh(
        upper=depth[:-1],
        lower=depth[1:],
        node_depth=depth,
        **columns,
        **plain_sizes(full("outer_diameter"), full("inner_diameter")),
        rigid_above=np.zeros(elements),
        eccentricity=np.zeros((elements, 2)),
        curvature=np.zeros((elements, 2)),
        item=np.zeros(elements, dtype=int),
        friction=np.full(elements, np.nan),
        junction=np.zeros(elements + 1, dtype=bool),
    )
