"""From a reamer of the string to its component, and the hole that it stands in (manual: sec-reamer)."""

from __future__ import annotations

from dataclasses import replace

from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.blocks.reamer import Reamer as ReamerItem
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.well import Well
from drillpetsc.model.hole import hole_depth
from drillpetsc.physics.interfaces import Bit
from drillpetsc.physics.rock_bit import RockBit
from drillpetsc.physics.tools.reamer import Reamer, ReamerLaw

WIDTH = 0.5  # of the wall's transition from one radius to the next [m] (manual: eq-borehole-transition)


def reamed_section(case: Case) -> tuple[ReamerItem, int] | None:
    """The reamer of a case that drills, and the number of the hole section that it has reamed; None without one."""
    item = next((q for q in case.string if isinstance(q, ReamerItem)), None)
    if item is None or case.well is None or case.formation is None:
        return None
    assert item.od is not None
    wide = [k for k, q in enumerate(case.well.sections) if q.diameter >= item.od - 1e-6]
    return item, wide[-1]


def well_of_reamer(case: Case, well: Well | None) -> Well | None:
    """The hole whose transition to the pilot begins below the shoulder, so that the reamer's blades fit above it."""
    found = reamed_section(case)
    if found is None or well is None:
        return well
    to = well.section_to.copy()
    to[found[1]] += 0.5 * WIDTH
    return replace(well, section_to=to)


def build_reamer(case: Case, mesh: StringMesh, well: Well | None, bit: Bit | None) -> Reamer | None:
    """Create the component of the reamer of a case, None without one."""
    found = reamed_section(case)
    if found is None or well is None or not isinstance(bit, RockBit):
        return None
    item, section = found
    body = next(b for b in mesh.bodies if b.kind == "reamer")
    assert case.well is not None and isinstance(case.bottom, BitBottom) and item.od is not None
    face = body.contact_above + body.contact_length
    law = ReamerLaw(
        0.5 * item.od, bit.shape.radius, item.blades, item.specific_energy, item.inclination_ratio
    )
    top = 0.0
    if case.initial.wob is not None:
        top = hole_depth(case) - mesh.total_length
    bit.hole.widen(section)
    return Reamer(
        body.node,
        face,
        law,
        # of bit and reamer on rock alike, so that the static shares are those of steady cutting
        case.bottom.stiffness * (law.radius - law.pilot) / law.pilot,
        float(case.well.sections[section].to),
        well,
        bit.hole,
        float(mesh.node_depth[body.node]) + face + top,
        case.contact.slip_velocity if case.contact is not None else 0.01,
        mesh.nodes,
        case.time is None or case.time.mode == "dynamic",
        mesh.motor_cell is not None and body.node > mesh.motor_cell,
    )


def refuse_run_with_mud(case: Case) -> None:
    """Raise CaseError for a motion in which a reamer would widen a hole with mud in its annulus."""
    if reamed_section(case) is None or not case.has_annulus:
        return
    number = next(i for i, q in enumerate(case.string) if isinstance(q, ReamerItem))
    raise CaseError(
        at=f"string[{number}].kind",
        got="reamer",
        want="no mud in the annulus while a reamer widens the hole: the mud that takes the rock's place is not computed",
        hint="fluid: {annulus: false}, or no fluid; statics and hydraulics take the mud",
    )
