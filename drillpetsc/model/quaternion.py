"""From a case to the string with quaternion elements: beam, ends and loads."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import HeldBottom, HeldTop
from drillpetsc.case.blocks.ends import TopDrive as TopDriveCase
from drillpetsc.case.case import Case
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.physics.contact import Contact
from drillpetsc.physics.end_conditions import NodeLoad
from drillpetsc.physics.quaternion.beam import QuaternionBeam
from drillpetsc.physics.quaternion.ends import ConstrainedEnd, QuaternionLoads


def quaternion_components(
    case: Case,
    mesh: StringMesh,
    frames: Frames,
    position: FloatArray,
    tangent: FloatArray,
    loads: Sequence[NodeLoad],
    breaks: tuple[float, ...],
    contact: Contact | None,
) -> tuple[QuaternionBeam, ConstrainedEnd | None, list]:
    """Beam, what holds the top (None: nothing), and all components of the string."""
    finest = contact.impact_depth if contact is not None else np.inf
    beam = QuaternionBeam(
        mesh, frames, np.array(case.gravity, dtype=float), case.beam.constraint or "index3", finest
    )
    top, bottom = _top(case, beam, position[0], tangent[0]), _bottom(case, beam, position[-1], tangent[-1])
    components = [beam, *(r for r in (top, bottom) if r is not None)]
    if loads:
        components.append(QuaternionLoads(tuple(loads), breaks))
    if contact is not None:
        components.append(contact)
    return beam, top, components


def _constrained_end(
    beam: QuaternionBeam,
    vertex: int,
    places: int,
    turns: int,
    position: FloatArray,
    tangent: FloatArray,
    *inputs,
) -> ConstrainedEnd:
    return ConstrainedEnd(
        vertex,
        beam.mesh.nodes,
        places,
        turns,
        position,
        beam.start[vertex],
        tangent,
        beam.constraint,
        *inputs,
    )


def _top(
    case: Case, beam: QuaternionBeam, position: FloatArray, tangent: FloatArray
) -> ConstrainedEnd | None:
    top = case.top
    if isinstance(top, TopDriveCase):
        lowering = None if top.force is not None else top.lowering
        return _constrained_end(
            beam, 0, 2 if lowering is None else 3, 3, position, tangent, lowering, top.rotation
        )
    assert isinstance(top, HeldTop)  # the case refuses the others
    return (
        None
        if top.kind == "free"
        else _constrained_end(beam, 0, 3, 3 if top.kind == "clamped" else 1, position, tangent)
    )


def _bottom(
    case: Case, beam: QuaternionBeam, position: FloatArray, tangent: FloatArray
) -> ConstrainedEnd | None:
    bottom = case.bottom
    if not isinstance(bottom, HeldBottom) or bottom.kind == "free":
        return None
    return _constrained_end(
        beam, beam.mesh.nodes - 1, 3, 3 if bottom.kind == "clamped" else 0, position, tangent
    )
