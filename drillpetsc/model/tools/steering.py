"""From the steerable tool of a case to its component (manual: sec-steering)."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.items.steering import PushSteering, RotarySteerable
from drillpetsc.case.case import Case
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.geometry.well import Well
from drillpetsc.model.hole import top_of_string
from drillpetsc.model.mesh import steering_zone
from drillpetsc.physics.tools.steering import PointTool, PushTool, Steer, Steering


def build_steering(
    case: Case, mesh: StringMesh, well: Well | None, frames: Frames, tangent: FloatArray
) -> Steering | None:
    """Create the component of the steerable tool, None without one.

    tangent: (n_nodes, 3) directions of the unstrained string.
    """
    found = [(i, item) for i, item in enumerate(case.string) if isinstance(item, RotarySteerable)]
    if not found:
        return None
    number, item = found[0]
    steer = Steer(item.rss.steer.ratio, item.rss.steer.tool_face)
    zone = steering_zone(item, *case.item_depths[number])
    if isinstance(item.rss, PushSteering):
        node = mesh.nearest_node(zone[0])
        axis = _axis(case, mesh, well, tangent, node)
        return PushTool(steer, node, axis, well, item.rss.force, item.rss.pads == "rotating", frames)
    upper, lower = zone
    own = np.flatnonzero((mesh.item == number) & ~mesh.is_joint)
    overlap = np.minimum(mesh.lower[own], lower) - np.maximum(mesh.upper[own], upper)
    cells = own[overlap > 1e-9]
    weights = overlap[overlap > 1e-9] / float(overlap[overlap > 1e-9].sum())
    axis = _axis(case, mesh, well, tangent, int(cells[0]))
    return PointTool(steer, axis, well, item.rss.tilt, cells, weights, mesh)


def _axis(case: Case, mesh: StringMesh, well: Well | None, tangent: FloatArray, node: int) -> FloatArray:
    """Direction (3,) of the hole at a node of the string, which a weight on bit puts on the bottom."""
    if well is None:
        return tangent[node]
    return np.asarray(well.at(mesh.node_depth[node] + top_of_string(case, mesh.total_length))[1])
