"""From a case to a string with quaternion elements: beam, ends and loads (manual: sec-quaternion)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from drillpetsc.case.blocks.ends import HeldBottom, HeldTop
from drillpetsc.case.blocks.ends import TopDrive as TopDriveCase
from drillpetsc.case.case import Case
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.physics.contact import Contact
from drillpetsc.physics.end_conditions import EndPlace, NodeLoad
from drillpetsc.physics.interfaces import FreeTop, Top
from drillpetsc.physics.quaternion.beam import QuaternionBeam
from drillpetsc.physics.quaternion.ends import ConstrainedEnd, QuaternionLoads


def quaternion_components(
    case: Case,
    mesh: StringMesh,
    frames: Frames,
    *,
    ends: tuple[EndPlace, EndPlace],
    loads: Sequence[NodeLoad],
    breaks: tuple[float, ...],
    contact: Contact | None,
) -> tuple[QuaternionBeam, Top, list]:
    """Create the components of a string with quaternion elements.

    ends: top and bottom of the unstrained string.
    loads: nodal loads; breaks: times at which they jump or bend [s].
    contact: wall contact, None without one.
    Returns the beam, the top end, and all components.
    """
    finest = contact.impact_depth if contact is not None else np.inf
    beam = QuaternionBeam(
        mesh, frames, np.array(case.gravity, dtype=float), case.beam.constraint or "index3", finest
    )
    top, bottom = _top(case, beam, ends[0]), _bottom(case, beam, ends[1])
    components = [beam, *((top,) if top.prescribes else ()), *((bottom,) if bottom is not None else ())]
    if loads:
        components.append(QuaternionLoads(tuple(loads), frames, breaks))
    if contact is not None:
        components.append(contact)
    return beam, top, components


def _top(case: Case, beam: QuaternionBeam, place: EndPlace) -> Top:
    top = case.top
    if isinstance(top, TopDriveCase):
        lowering = None if top.force is not None else top.lowering
        # without inertia rotation acts through the direction of friction only
        rotation = None if case.time is not None and case.time.mode == "quasi_static" else top.rotation
        return ConstrainedEnd(beam, place, 2 if lowering is None else 3, 3, lowering, rotation)
    assert isinstance(top, HeldTop)  # the check of the case refuses other kinds
    return (
        FreeTop() if top.kind == "free" else ConstrainedEnd(beam, place, 3, 3 if top.kind == "clamped" else 1)
    )


def _bottom(case: Case, beam: QuaternionBeam, place: EndPlace) -> ConstrainedEnd | None:
    bottom = case.bottom
    if not isinstance(bottom, HeldBottom) or bottom.kind == "free":
        return None
    return ConstrainedEnd(beam, place, 3, 3 if bottom.kind == "clamped" else 0)
