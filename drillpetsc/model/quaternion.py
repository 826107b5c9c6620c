"""From a case to a string with quaternion elements: beam, ends and loads (manual: sec-quaternion)."""

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
from drillpetsc.physics.hole_path import HolePath
from drillpetsc.physics.quaternion.beam import QuaternionBeam
from drillpetsc.physics.quaternion.ends import ConstrainedEnd, QuaternionLoads


def quaternion_components(
    case: Case,
    mesh: StringMesh,
    frames: Frames,
    *,
    position: FloatArray,
    tangent: FloatArray,
    loads: Sequence[NodeLoad],
    breaks: tuple[float, ...],
    contact: Contact | None,
    path: HolePath | None = None,
) -> tuple[QuaternionBeam, ConstrainedEnd | None, list]:
    """Create the components of a string with quaternion elements.

    position, tangent: (n_nodes, 3) of the unstrained string [m, -].
    loads: nodal loads; breaks: times at which they jump or bend [s].
    contact: wall contact, None without one.
    path: of the top, None: a straight line.
    Returns the beam, the constrained top end (None if it is free), and all components.
    """
    finest = contact.impact_depth if contact is not None else np.inf
    beam = QuaternionBeam(
        mesh, frames, np.array(case.gravity, dtype=float), case.beam.constraint or "index3", finest
    )
    top, bottom = (
        _top(case, beam, position[0], tangent[0], path),
        _bottom(case, beam, position[-1], tangent[-1]),
    )
    components = [beam, *(r for r in (top, bottom) if r is not None)]
    if loads:
        components.append(QuaternionLoads(tuple(loads), breaks))
    if contact is not None:
        components.append(contact)
    return beam, top, components


def _constrained_end(
    beam: QuaternionBeam,
    vertex: int,
    positions: int,
    rotations: int,
    position: FloatArray,
    tangent: FloatArray,
    *inputs,
) -> ConstrainedEnd:
    """Create an end with constrained ``positions`` and ``rotations`` (numbers of each)."""
    return ConstrainedEnd(
        vertex,
        beam.mesh.nodes,
        positions,
        rotations,
        position,
        beam.start[vertex],
        tangent,
        beam.constraint,
        *inputs,
    )


def _top(
    case: Case, beam: QuaternionBeam, position: FloatArray, tangent: FloatArray, path: HolePath | None
) -> ConstrainedEnd | None:
    top = case.top
    if isinstance(top, TopDriveCase):
        lowering = None if top.force is not None else top.lowering
        # without inertia rotation acts through the direction of friction only
        rotation = None if case.time is not None and case.time.mode == "quasi_static" else top.rotation
        return _constrained_end(
            beam, 0, 2 if lowering is None else 3, 3, position, tangent, lowering, rotation, path
        )
    assert isinstance(top, HeldTop)  # the check of the case refuses other kinds
    return (
        None
        if top.kind == "free"
        else _constrained_end(
            beam, 0, 3, 3 if top.kind == "clamped" else 1, position, tangent, None, None, path
        )
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
