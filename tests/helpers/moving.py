"""A straight string of chosen rooms, without a case, and its matrices; ``motion`` runs it."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.discrete_system import Model
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.physics.beam import Beam
from drillpetsc.physics.contact import Contact


def straight_model(mesh, rooms=(), gravity=(0.0, 0.0, 0.0)) -> Model:
    """A straight vertical string at rest; each of ``rooms`` is called with (frames, position, tangent)."""
    tangent = np.tile([0.0, 0.0, 1.0], (mesh.nodes, 1))
    frames = transported_frames(tangent)
    position = mesh.node_depth[:, None] * tangent
    others = [room(frames, position, tangent) for room in rooms]
    depth = min((room.impact_depth for room in others if isinstance(room, Contact)), default=np.inf)
    model = Model(mesh, frames, [Beam(mesh, frames, np.array(gravity), depth), *others])
    model.set_field("string.position", position)
    model.set_field("string.tangent", tangent)
    if "string.ratio" in model.layout.place:
        model.set_field("string.ratio", np.ones((mesh.nodes, 1)))
    return model


def matrices(model: Model) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """K, C, M of the model at its state, dense, rows and columns of the local unknowns."""
    out = []
    for triple in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
        asm = model.assembly
        asm.jacobian(0.0, triple, condensed=False)
        keep = (asm.rows >= 0) & (asm.columns >= 0)
        A = np.zeros((model.layout.size, model.layout.size))
        np.add.at(A, (asm.rows[keep], asm.columns[keep]), asm.values[keep])
        out.append(A)
    return tuple(out)  # type: ignore[return-value]
