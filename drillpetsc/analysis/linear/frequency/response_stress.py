"""Stresses of a forced response in the material of the pipe, which turns (manual: sec-response-stress)."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.linear.frequency.harmonic import SectionForces
from drillpetsc.arrays import FloatArray
from drillpetsc.fem.string_mesh import StringMesh

SAME = 1e-6  # relative difference of frequencies that are equal


def neighbours(mesh: StringMesh, node: int) -> list[tuple[int, int]]:
    """Elements that end at a node, as (element, 0 for its upper or 1 for its lower end); joints are passed over."""
    found = []
    above, below = node - 1, node
    while above >= 0 and mesh.is_joint[above]:
        above -= 1
    while below < len(mesh.length) and mesh.is_joint[below]:
        below += 1
    if above >= 0:
        found.append((above, 1))
    if below < len(mesh.length):
        found.append((below, 0))
    return found


def stresses(
    mesh: StringMesh,
    node: int,
    axes: FloatArray,
    moving: SectionForces,
    steady: SectionForces,
    frequency: float,
    rotation: float,
) -> tuple[float, float, float]:
    """Stresses at a node [Pa]: amplitude of the normal stress and of the shear stress, mean normal stress.

    axes: (3, 3) rows, two directions across the string and its tangent, right-handed.
    moving: amplitudes of the response at the angular frequency ``frequency``; steady: forces of the steady state.
    rotation: of the string, both positive [rad/s].
    Of the elements that meet at the node, each has its largest values. nan without a tube whose diameters are known.
    """
    found = [(np.nan, np.nan, np.nan)]
    for cell, end in neighbours(mesh, node):
        outer, inner = mesh.outer_diameter[cell], mesh.inner_diameter[cell]
        if not outer > inner:
            continue
        area, inertia = np.pi / 4 * (outer**2 - inner**2), np.pi / 64 * (outer**4 - inner**4)
        by_moment = 0.5 * outer / inertia
        one, other = axes[:2] @ moving.moment[cell, end]
        forward, backward = 0.5 * abs(one + 1j * other), 0.5 * abs(one - 1j * other)
        if abs(frequency - rotation) < SAME * rotation:
            forward = 0.0  # turns with the pipe: its stress stays what it is at each point of the section
        turning = float(np.linalg.norm(axes[:2] @ steady.moment[cell, end].real)) if rotation else 0.0
        normal = abs(moving.tension[cell, end]) / area + by_moment * (forward + backward + turning)
        shear = abs(moving.torque[cell]) * 0.5 * by_moment
        found.append((normal, shear, float(steady.tension[cell, end].real) / area))
    normal, shear, mean = np.array(found).T
    if len(found) == 1:
        return np.nan, np.nan, np.nan
    return float(np.nanmax(normal)), float(np.nanmax(shear)), float(np.nanmax(mean))
