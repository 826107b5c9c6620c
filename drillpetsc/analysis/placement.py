"""Where the string lies and how it moves before anything is solved for."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.steady_flow import place_fluid, release_flow
from drillpetsc.model.drilling_model import DrillingModel


def prescribed_motion(model: DrillingModel) -> tuple[float, float]:
    """Axial velocity [m/s, down positive] and rotation [rad/s] that the top prescribes at time 0."""
    top = model.case.top
    lowering = top.lowering if top.force is None else None
    rotation = top.rotation
    return (lowering.value(0.0) if lowering is not None else 0.0), (
        rotation.value(0.0) if rotation is not None else 0.0
    )


def place_along_hole(model: DrillingModel) -> None:
    """Put the unstrained string on the hole's axis (on a straight line without a hole), at rest."""
    m = model.system
    if model.beam is not None:
        model.beam.place(m, model.position, model.tangent)
    if "string.ratio" in m.layout.dofs:
        m.set_field("string.ratio", np.ones((m.mesh.nodes, 1)))
    for name in ("joint.load", "joint.correction"):
        if name in m.layout.dofs:
            m.set_field(name, np.zeros((m.mesh.nodes, 6)))
    m.assembly.y[:] = 0.0
    m.assembly.a[:] = 0.0
    if model.fluid is not None:
        place_fluid(m, model.fluid)


def move_rigidly(model: DrillingModel) -> None:
    """Give every node the spin and the lowering that the top prescribes at time 0."""
    if model.beam is not None:
        m = model.system
        tangent = model.tangent if model.well is None else np.asarray(model.well.at(model.mesh.node_depth)[1])
        model.beam.set_rigid_motion(m, tangent, *prescribed_motion(model))
        if model.bit is not None:
            model.bit.first_cut(m.assembly)
    release_flow(model)


def release(model: DrillingModel) -> None:
    """From statics to motion: friction follows the motion from now on."""
    for component in model.components:
        component.release_sliding_direction()
