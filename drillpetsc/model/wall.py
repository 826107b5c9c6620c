"""Stiffness of the wall at each part of the string, from the moduli of rock and steel (manual: sec-contact-physical)."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.well import Well
from drillpetsc.model.hole import top_of_string
from drillpetsc.physics.contact import (
    ROCK_POISSON,
    STEEL_POISSON,
    STEEL_YOUNG,
    line_stiffness,
    ring_stiffness,
)

ROCK_YOUNG = 20e9  # of open hole without formation.young [Pa]
#: loads per length at which the stiffness is taken: of pipe, of tool joints, of rigid items [N/m]
PIPE_LOAD, JOINT_LOAD, ITEM_LOAD = 1e4, 5e4, 7e4
LEAST_CLEARANCE = 0.01  # of a part in gauge, over its radius [-]


def rock_young(case: Case) -> float:
    """Young's modulus of the rock [Pa]."""
    given = case.formation.young if case.formation is not None else None
    return ROCK_YOUNG if given is None else given


def wall_stiffness(case: Case, mesh: StringMesh, well: Well) -> tuple[FloatArray, FloatArray]:
    """Stiffness [Pa] of the wall at the elements (n,) and at the rigid items (bodies,), at the place of the string at the start."""
    top = top_of_string(case, mesh.total_length)
    cells = np.array([_of_cell(case, mesh, well, k, top) for k in range(len(mesh.upper))])
    bodies = [
        _line(ITEM_LOAD, b.radius, STEEL_YOUNG, case, well, top + mesh.node_depth[b.node])
        for b in mesh.bodies
    ]
    return cells, np.array(bodies, dtype=float)


def mean_and_hardness(
    case: Case, mesh: StringMesh, well: Well
) -> tuple[float, tuple[FloatArray, FloatArray]]:
    """Mean stiffness [Pa] of the wall along the string, and the ratio of elements and rigid items to it, 1 if nothing touches."""
    cells, bodies = wall_stiffness(case, mesh, well)
    every = np.concatenate([cells, bodies])
    mean = float(np.exp(np.nanmean(np.log(every)))) if np.isfinite(every).any() else 1e8
    return mean, (np.nan_to_num(cells / mean, nan=1.0), np.nan_to_num(bodies / mean, nan=1.0))


def _of_cell(case: Case, mesh: StringMesh, well: Well, k: int, top: float) -> float:
    """Stiffness [Pa] per length of string; tool joints that hold the tube off the wall touch it over their length only."""
    if mesh.is_joint[k] or not mesh.contact_diameter[k] > 0:
        return np.nan
    item, depth = case.string[mesh.item[k]], top + 0.5 * (mesh.upper[k] + mesh.lower[k])
    material = getattr(item, "material", None)
    young, radius = STEEL_YOUNG if material is None else material.young, 0.5 * mesh.contact_diameter[k]
    joint = getattr(item, "tool_joint", None)
    if joint is not None and mesh.contact_diameter[k] > mesh.outer_diameter[k]:
        share = min(1.0, joint.length / mesh.joint_length[k])
        return share * _line(JOINT_LOAD, radius, young, case, well, depth)
    ring = float(ring_stiffness(mesh.outer_diameter[k], mesh.inner_diameter[k], young))
    return 1 / (1 / _line(PIPE_LOAD, radius, young, case, well, depth) + 1 / ring)


def _line(load: float, radius: float, steel: float, case: Case, well: Well, depth: float) -> float:
    """Line contact with the wall at a measured depth [m]: steel in casing, rock in open hole; nan for a part without radius."""
    if not radius > 0:
        return np.nan
    hole = max(float(np.asarray(well.radius(depth))), (1 + LEAST_CLEARANCE) * radius)
    cased = well.kind(depth) != "open_hole"
    wall = (STEEL_YOUNG, STEEL_POISSON) if cased else (rock_young(case), ROCK_POISSON)
    return float(line_stiffness(load, radius, hole, steel, *wall))
