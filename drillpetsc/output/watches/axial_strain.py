"""The largest axial strain of the pipe in a state."""

from __future__ import annotations

import numpy as np

from drillpetsc.model.drilling_model import DrillingModel


def largest_strain(model: DrillingModel) -> tuple[float, int]:
    """The axial strain [-] of largest size in the middle of an element of pipe, and the element; collective, the same on all ranks.

    The cubic between two nodes has in its middle the derivative 1.5 chord/length - (sum of those at its ends)/4.  Bends are no strain
    in it, as they are in the chord.  Items given by their stiffnesses are left out, as are joints.
    """
    system, mesh = model.system, model.mesh
    (upper, lower), cells = system.chain.ends.T, system.chain.cells
    position, tangent = system.field("string.position"), system.field("string.tangent")
    given = np.array([item.kind == "beam" for item in model.case.string])
    left_out = mesh.is_joint[cells] | given[mesh.item[cells]]
    length = np.where(left_out, 1.0, mesh.length[cells])
    below = tangent[upper]  # a junction has the tangent of the pipe above it
    # below a rigid item, the element begins at the item's lower end
    start = position[upper] + mesh.rigid_above[cells, None] * below / np.linalg.norm(
        below, axis=1, keepdims=True
    )
    if "string.ratio" in system.layout.dofs:
        below = below * system.field("string.ratio")[upper]
    middle = 1.5 * (position[lower] - start) / length[:, None] - 0.25 * (tangent[lower] + below)
    strain = np.where(left_out, 0.0, np.linalg.norm(middle, axis=1) - 1)
    worst = int(np.argmax(np.abs(strain), axis=0)) if len(strain) else 0
    found = (float(strain[worst]), int(cells[worst])) if len(strain) else (0.0, 0)
    if system.comm.size > 1:
        found = max(system.comm.tompi4py().allgather(found), key=lambda q: abs(q[0]))
    return found
