"""What the wall does to each item of the string: side force, its direction, gap, drag, torque, tilt."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.arrays import FloatArray
from drillpetsc.fem.quantity import Sample
from drillpetsc.geometry.frames import tool_face_zero
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.measured.rigid_items import RigidItems, across_hole, loads_in, resultants
from drillpetsc.parallel import total
from drillpetsc.physics.contact import RESULTS

_SIDE = ("side_high", "side_right", "side_couple", "contact_force_sum")
NOISE = 1e-9  # share of the largest side force below which a force is rounding


def contact_rows(
    model: DrillingModel, nodes: FloatArray, tangent: FloatArray, forces: tuple[FloatArray, FloatArray]
) -> list[dict[str, Any]]:
    """One row for each item of the string, from the top down; none without contact.

    nodes: (nodes, 3) positions [m]; tangent: (nodes, 3) unit tangents; forces: of ``item_forces``.
    A pipe has the sums over its length: those of components to the high side and to the right for its side force. A rigid item
    has a couple, a direction and a tilt, too: clock directions are those of a tool face, 0 at the high side (north below 5 deg),
    clockwise looking down [rad].
    """
    if model.contact is None:
        return []
    mesh, well = model.mesh, model.contact.well
    on_cells, on_bodies = forces
    normal = RESULTS["normal"]
    noise = NOISE * max(float(part[:, normal].max(initial=0.0)) for part in forces)
    names, shift = [item.name for item in model.case.string], top_depth(model)
    rows = []
    for number in np.unique(mesh.item[~mesh.is_joint]):
        cells = (mesh.item == number) & ~mesh.is_joint
        upper, lower = float(mesh.upper[cells].min()), float(mesh.lower[cells].max())
        rows.append(
            _row(names[number], model.case.string[number].kind, 0.5 * (upper + lower) + shift)
            | _sums(on_cells[cells])
            | {"side_couple": np.nan}  # of forces over hundreds of metres: not of use
        )
    for k, body in enumerate(mesh.bodies):
        middle = body.middle
        row = _row(body.name, body.kind, float(mesh.node_depth[body.node]) + middle + shift)
        axis = tangent[body.node]
        foot = well.project((nodes[body.node] + middle * axis)[None])
        along = foot.tangent[0]
        row["tilt"] = float(np.arcsin(np.clip(np.linalg.norm(np.cross(axis, along)), 0.0, 1.0)))
        row["tilt_direction"] = _clock(axis - along * (axis @ along), along, 1e-9)
        if body.radius > 0:
            row |= _sums(on_bodies[k : k + 1])
            places = body.contact_above + np.linspace(0.0, body.contact_length, 3)
            ends = well.project(nodes[body.node] + places[:, None] * axis)
            gaps = ends.radius - body.radius - np.linalg.norm(ends.offset, axis=1)
            nearest = int(np.argmin(gaps))
            row["gap"] = float(gaps[nearest])
            if row["side_force"] > noise:
                row["direction"] = _clock(on_bodies[k, RESULTS["push"]], along, 0.0)
        rows.append(row)
    return sorted(rows, key=lambda row: row["md"])


def item_forces(model: DrillingModel) -> tuple[FloatArray, FloatArray] | None:
    """(cells, columns) and (bodies, columns) results of the wall contact, columns of ``physics.contact.RESULTS``.

    On rank 0, None elsewhere and without contact.  Collective.
    """
    if model.contact is None:
        return None
    system, sample = model.system, Sample(model.system, 0.0)
    cells, _ = sample.once(model.contact.element_results)
    bodies = total(system.comm, RigidItems(model).wall_results(sample)[0])
    whole = system.gather(cells, "cell")
    return None if whole is None else (whole, bodies)


def _row(name: str, kind: str, md: float) -> dict[str, Any]:
    absent = (
        "side_force",
        *_SIDE,
        "direction",
        "gap",
        "axial_drag",
        "contact_torque",
        "tilt",
        "tilt_direction",
    )
    return {"item": name, "item_kind": kind, "md": md} | dict.fromkeys(absent, np.nan)


def _sums(results: FloatArray) -> dict[str, float]:
    """What the wall does to an item, from the results (k, columns) of its contact on its k parts."""
    parts = across_hole(loads_in(results)).sum(axis=0, keepdims=True)
    total = results.sum(axis=0)
    found = resultants(total[[RESULTS["normal"]]], parts)[0].tolist()
    row = dict(zip(("side_force", *_SIDE), found, strict=False))
    return row | {"axial_drag": total[RESULTS["axial"]], "contact_torque": total[RESULTS["torque"]]}


def _clock(vector: FloatArray, along: FloatArray, least: float) -> float:
    """Clock direction [rad] of a vector (3,) across the hole with the tangent `along` (3,); nan up to a length."""
    zero = tool_face_zero(along)
    right = np.cross(along, zero)
    x, y = float(vector @ zero), float(vector @ right)
    return np.nan if np.hypot(x, y) <= least else float(np.arctan2(y, x) % (2 * np.pi))
