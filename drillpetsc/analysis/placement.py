"""Position and motion of the string before the first solve."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.steady_flow import release_flow, set_fluid_at_rest
from drillpetsc.model.drilling_model import DrillingModel


def prescribed_motion(model: DrillingModel) -> tuple[float, float]:
    """Return the axial velocity [m/s, down positive] and the rotation [rad/s] that the top prescribes at time 0."""
    top = model.case.top
    lowering = top.lowering if top.force is None else None
    rotation = top.rotation
    return (lowering.value(0.0) if lowering is not None else 0.0), (
        rotation.value(0.0) if rotation is not None else 0.0
    )


def place_along_hole(model: DrillingModel) -> None:
    """Put the unstrained string on the axis of the hole, on a straight line without a hole; at rest."""
    system = model.system
    if model.beam is not None:
        model.beam.place(system, model.position, model.tangent)
    if "string.ratio" in system.layout.dofs:
        system.set_field("string.ratio", np.ones((system.mesh.nodes, 1)))
    for name in ("joint.load", "joint.correction"):
        if name in system.layout.dofs:
            system.set_field(name, np.zeros((system.mesh.nodes, 6)))
    system.assembly.y[:] = 0.0
    system.assembly.a[:] = 0.0
    if model.fluid is not None:
        set_fluid_at_rest(system, model.fluid)


def move_rigidly(model: DrillingModel) -> None:
    """Set the rates of every node to the rotation and the lowering that the top prescribes at time 0."""
    if model.beam is not None:
        system = model.system
        tangent = model.tangent if model.well is None else np.asarray(model.well.at(model.mesh.node_depth)[1])
        model.beam.set_rigid_motion(system, tangent, *prescribed_motion(model))
        if model.bit is not None:
            model.bit.first_cut(system.assembly)
    release_flow(model)


def release(model: DrillingModel) -> None:
    """Change from statics to motion: friction follows the actual motion from now on."""
    for component in model.components:
        component.release_sliding_direction()
