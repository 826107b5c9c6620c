"""Creates the component of a reamer of the string, and its hole (manual: sec-reamer)."""

from __future__ import annotations

from dataclasses import replace

from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.blocks.items.reamer import Reamer as ReamerItem
from drillpetsc.case.case import Case
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.well import Well
from drillpetsc.model.hole import top_of_string
from drillpetsc.physics.bit.rock_bit import RockBit
from drillpetsc.physics.interfaces import Bit
from drillpetsc.physics.tools.reamer import Reamer, ReamerLaw, ReamerPlace

WIDTH = 0.5  # of the wall's transition from one radius to the next [m] (manual: eq-borehole-transition)


def reamed_sections(case: Case) -> tuple[tuple[int, ReamerItem, int], ...]:
    """Reamers of a case that drills, from the top: number of the item, item, and number of the hole section that it has reamed."""
    if case.well is None or case.formation is None:
        return ()
    found = []
    for number, item in enumerate(case.string):
        if isinstance(item, ReamerItem):
            assert item.od is not None
            wide = [k for k, q in enumerate(case.well.sections) if q.diameter >= item.od - 1e-6]
            found.append((number, item, wide[-1]))
    return tuple(found)


def well_of_reamer(case: Case, well: Well | None) -> Well | None:
    """The hole whose transition to a pilot begins below the shoulder, so that the reamer's blades fit above it."""
    found = reamed_sections(case)
    if not found or well is None:
        return well
    to = well.section_to.copy()
    to[[section for *_, section in found]] += 0.5 * WIDTH
    return replace(well, section_to=to)


def build_reamers(case: Case, mesh: StringMesh, well: Well | None, bit: Bit | None) -> tuple[Reamer, ...]:
    """Create the components of the reamers of a case, from the top."""
    found = reamed_sections(case)
    if not found or well is None or not isinstance(bit, RockBit):
        return ()
    assert case.well is not None and isinstance(case.bottom, BitBottom)
    bodies = [b for b in mesh.bodies if b.kind == "reamer"]
    pilots = [*(0.5 * (item.od or 0.0) for _, item, _ in found[1:]), bit.shape.radius]
    top = top_of_string(case, mesh.total_length)
    out = []
    for number, ((_, item, section), body, pilot) in enumerate(zip(found, bodies, pilots, strict=True), 1):
        assert item.od is not None
        face = body.contact_above + body.contact_length
        radius = 0.5 * item.od
        law = ReamerLaw(
            radius,
            pilot,
            item.blades,
            item.specific_energy,
            item.inclination_ratio,
            # of bit and reamers on rock alike, so that the static shares are those of steady cutting
            stiffness=case.bottom.stiffness * (radius - pilot) / bit.shape.radius,
            slip=case.contact.slip_velocity if case.contact is not None else 0.01,
        )
        place = ReamerPlace(
            body.node,
            mesh.nodes,
            face,
            start=float(mesh.node_depth[body.node]) + face + top,
            shoulder=float(case.well.sections[section].to),
            section=section,
            driven=mesh.motor_cell is not None and body.node > mesh.motor_cell,
            number=number,
        )
        bit.hole.widen(section)
        out.append(Reamer(place, law, well, bit.hole, case.time is None or case.time.mode == "dynamic"))
    return tuple(out)
