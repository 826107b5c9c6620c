"""Upkeep of the gauges: a node whose tangent has turned far from its gauge direction gets a new one; nothing physical
changes.

The spin angle is counted from a gauge direction a and is singular where the tangent t is opposite to it.  When a.t <
-0.5 the gauge becomes a' = t, the second director is carried along by the smallest rotation, the spin angle changes
by minus the solid angle of (a, a', v), and each neighbouring element's twist offset takes up what its twist would
have changed (model, section 7).
"""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.discrete_system import Model
from drillpetsc.geometry.frames import Frames, gauge_change, smallest_rotation
from drillpetsc.physics.beam import REPORT, Beam

FAR = -0.5  # cosine between gauge and tangent below which a gauge is renewed


def renew(model: Model, frames: Frames) -> bool:
    """Renew gauges where needed, in ``frames`` (the same on all ranks), the assembly and all rooms; True where any
    changed.

    Call it between load steps or time steps only: an integrator that keeps earlier spin angles must be restarted
    after a change.
    """
    if "string.tangent" not in model.layout.place:
        return False
    changes = _far_nodes(model, frames)
    if not changes:
        return False
    beam = next(room for room in model.rooms if isinstance(room, Beam))
    before = _twists(model, beam)
    local = {int(v): i for i, v in enumerate(model.line.vertices)}
    asm, spin = model.assembly, model.layout.place["string.spin"][:, 0]
    for node, v in changes:
        a, t = frames.gauge[node].copy(), v / np.linalg.norm(v)
        frames.second[node] = smallest_rotation(a, t, frames.second[node])
        frames.gauge[node] = t
        if node in local:
            asm.x[spin[local[node]]] += gauge_change(a, t, v)
    _tell(model, frames)
    changed = before - _twists(model, beam)
    cells = model.line.cells
    touched = np.isin(cells, [n for n, _ in changes]) | np.isin(cells + 1, [n for n, _ in changes])
    for cell, offset in _everywhere(model, list(zip(cells[touched].tolist(), changed[touched].tolist(), strict=True))):
        frames.twist0[cell] += offset
    _tell(model, frames)
    return True


def _far_nodes(model: Model, frames: Frames) -> list[tuple[int, np.ndarray]]:
    """(node, slope (3,)) of all nodes of the string whose tangent is far from the gauge, the same on all ranks."""
    line, v = model.line, model.field("string.tangent")
    cosine = np.sum(frames.gauge[line.vertices] * v, axis=1) / np.linalg.norm(v, axis=1)
    far = np.flatnonzero((cosine < FAR) & line.owned)
    return _everywhere(model, [(int(line.vertices[i]), v[i].copy()) for i in far])


def _everywhere(model: Model, mine: list) -> list:
    """The ranks' lists joined, on every rank."""
    if model.comm.size == 1:
        return mine
    return [entry for part in model.comm.tompi4py().allgather(mine) for entry in part]


def _twists(model: Model, beam: Beam) -> np.ndarray:
    """(nc,) twist of each local element [rad]."""
    asm, mesh, cells = model.assembly, model.mesh, model.line.cells
    torque = beam.report(model.layout, asm.x, asm.y)[:, REPORT.index("torque")]
    return torque * mesh.length[cells] / mesh.torsional_stiffness[cells]


def _tell(model: Model, frames: Frames) -> None:
    model.assembly.gauge[:] = frames.gauge[model.line.vertices]
    for room in model.rooms:
        room.refresh_gauges()
