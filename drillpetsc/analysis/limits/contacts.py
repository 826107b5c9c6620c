"""What the wall does to each item of the string: side force, its direction, gap, drag, torque, tilt."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.analysis.placement import top_depth
from drillpetsc.arrays import FloatArray
from drillpetsc.fem.quantity import Sample
from drillpetsc.geometry.frames import tool_face_zero
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.rigid_items import RigidItems
from drillpetsc.physics.contact import RESULT_NAMES

_NORMAL, _AXIAL, _TORQUE = (RESULT_NAMES.index(name) for name in ("normal", "axial", "torque"))
NOISE = 1e-9  # share of the largest side force below which a force is rounding


def contact_rows(
    model: DrillingModel, nodes: FloatArray, tangent: FloatArray, forces: tuple[FloatArray, FloatArray]
) -> list[dict[str, Any]]:
    """One row for each item of the string, from the top down; none without contact.

    nodes: (nodes, 3) positions [m]; tangent: (nodes, 3) unit tangents; forces: of ``item_forces``.
    A pipe has the sums over its length. A rigid item has a direction and a tilt, too: clock directions are those of a
    tool face, 0 at the high side (north below 5 deg), clockwise looking down [rad].
    """
    if model.contact is None or model.well is None:
        return []
    mesh, well = model.mesh, model.well
    on_cells, on_bodies = forces
    noise = NOISE * max(float(on_cells[:, 0].max(initial=0.0)), float(on_bodies[:, 0].max(initial=0.0)))
    names, shift = [item.name for item in model.case.string], top_depth(model)
    rows = []
    for number in np.unique(mesh.item[~mesh.is_joint]):
        cells = (mesh.item == number) & ~mesh.is_joint
        normal, axial, torque = on_cells[cells].sum(axis=0)
        upper, lower = float(mesh.upper[cells].min()), float(mesh.lower[cells].max())
        rows.append(
            _row(names[number], model.case.string[number].kind, 0.5 * (upper + lower) + shift)
            | {"side_force": normal, "axial_drag": axial, "contact_torque": torque}
        )
    for k, body in enumerate(mesh.bodies):
        middle = body.contact_above + 0.5 * body.contact_length
        row = _row(body.name, body.kind, float(mesh.node_depth[body.node]) + middle + shift)
        axis = tangent[body.node]
        foot = well.project((nodes[body.node] + middle * axis)[None])
        along = foot.tangent[0]
        row["tilt"] = float(np.arcsin(np.clip(np.linalg.norm(np.cross(axis, along)), 0.0, 1.0)))
        row["tilt_direction"] = _clock(axis - along * (axis @ along), along, 1e-9)
        if body.radius > 0:
            normal, axial, torque = on_bodies[k]
            row |= {"side_force": normal, "axial_drag": axial, "contact_torque": torque}
            places = body.contact_above + np.linspace(0.0, body.contact_length, 3)
            ends = well.project(nodes[body.node] + places[:, None] * axis)
            gaps = ends.radius - body.radius - np.linalg.norm(ends.offset, axis=1)
            nearest = int(np.argmin(gaps))
            row["gap"] = float(gaps[nearest])
            if normal > noise:
                row["direction"] = _clock(-ends.offset[nearest], ends.tangent[nearest], 0.0)
        rows.append(row)
    return sorted(rows, key=lambda row: row["md"])


def item_forces(model: DrillingModel) -> tuple[FloatArray, FloatArray] | None:
    """(cells, 3) and (bodies, 3) side force [N], drag along the hole, down positive [N], and torque [N m] of the wall.

    On rank 0, None elsewhere and without contact.  Collective.
    """
    if model.contact is None:
        return None
    system, sample = model.system, Sample(model.system, 0.0)
    columns = [_NORMAL, _AXIAL, _TORQUE]
    cells, _ = sample.once(model.contact.element_results)
    bodies = model.contact.item_results(sample.assembly)[:, columns]
    listed = RigidItems(model)
    bodies[listed.items, 0] = listed.forces(sample)  # that of a bit that cuts is its own
    if system.comm.size > 1:
        bodies = system.comm.tompi4py().allreduce(bodies)
    whole = system.gather(np.ascontiguousarray(cells[:, columns]), "cell")
    return None if whole is None else (whole, bodies)


def _row(name: str, kind: str, md: float) -> dict[str, Any]:
    absent = ("side_force", "direction", "gap", "axial_drag", "contact_torque", "tilt", "tilt_direction")
    return {"item": name, "item_kind": kind, "md": md} | dict.fromkeys(absent, np.nan)


def _clock(vector: FloatArray, along: FloatArray, least: float) -> float:
    """Clock direction [rad] of a vector (3,) across the hole with the tangent `along` (3,); nan up to a length."""
    zero = tool_face_zero(along)
    right = np.cross(along, zero)
    x, y = float(vector @ zero), float(vector @ right)
    return np.nan if np.hypot(x, y) <= least else float(np.arctan2(y, x) % (2 * np.pi))
