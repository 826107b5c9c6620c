"""Small helpers of the dynamic checks."""

from __future__ import annotations

from contextlib import contextmanager

import numpy as np
from petsc4py import PETSc

from drillpetsc.frames import transported_frames
from drillpetsc.model import Model
from drillpetsc.rooms.beam import Beam
from drillpetsc.rooms.contact import Contact
from drillpetsc.solve.dynamics import Dynamics


@contextmanager
def petsc_options(**options):
    """PETSc options for the time of a block."""
    database = PETSc.Options()
    before = dict(database.getAll())
    for name, value in options.items():
        database.setValue(name, value)
    try:
        yield
    finally:
        for name in database.getAll():
            if name not in before:
                database.delValue(name)
        for name, value in before.items():
            database.setValue(name, value)


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


def integrate(model: Model, end: float, watch, breaks=(), **options) -> np.ndarray:
    """Run to ``end``; returns rows (t, *watch(model)) of all accepted steps."""
    rows = []
    with petsc_options(**options):
        dynamics = Dynamics(model)
        dynamics.after_step.append(lambda t, dt: rows.append([t, *np.atleast_1d(watch(model))]))
        dynamics.run(0.0, end, breaks)
    return np.array(rows)


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
