"""A straight string of given components, without a case, and its matrices; motion.py runs it."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.contact import Contact


def straight_model(mesh, components=(), gravity=(0.0, 0.0, 0.0)) -> DiscreteSystem:
    """A straight vertical string at rest; each of ``components`` is called with (frames, position,
    tangent)."""
    tangent = np.tile([0.0, 0.0, 1.0], (mesh.nodes, 1))
    frames = transported_frames(tangent)
    position = mesh.node_depth[:, None] * tangent
    others = [component(frames, position, tangent) for component in components]
    depth = min(
        (component.impact_depth for component in others if isinstance(component, Contact)), default=np.inf
    )
    system = DiscreteSystem(mesh, frames, [AncfBeam(mesh, frames, np.array(gravity), depth), *others])
    system.set_field("string.position", position)
    system.set_field("string.tangent", tangent)
    if "string.ratio" in system.layout.dofs:
        system.set_field("string.ratio", np.ones((mesh.nodes, 1)))
    return system


def matrices(system: DiscreteSystem) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """K, C, M of the model at its state, dense, rows and columns of the local unknowns."""
    out = []
    for triple in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)):
        asm = system.assembly
        asm.jacobian(0.0, triple, condensed=False)
        rows, columns = asm.places()
        keep = (rows >= 0) & (columns >= 0)
        A = np.zeros((system.layout.size, system.layout.size))
        np.add.at(A, (rows[keep], columns[keep]), asm.values[keep])
        out.append(A)
    return tuple(out)  # type: ignore[return-value]
