"""From the tools of a case to their components: downhole motor, agitators, steerable tool, reamers.

Manual: sec-motor, sec-agitator, sec-steering, sec-reamer.
"""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.ends import BitBottom
from drillpetsc.case.blocks.items.agitator import AgitatorTool
from drillpetsc.case.blocks.items.motor import MotorSection, PositiveDisplacementMotor
from drillpetsc.case.blocks.items.reamer import Reamer as ReamerItem
from drillpetsc.case.blocks.items.steering import PushSteering, RotarySteerable
from drillpetsc.case.case import Case
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.geometry.well import Well
from drillpetsc.model.hole import hole_depth
from drillpetsc.model.mesh import steering_zone
from drillpetsc.physics.bit.rock_bit import RockBit
from drillpetsc.physics.interfaces import Bit
from drillpetsc.physics.joints import Joints
from drillpetsc.physics.tools.agitator import Agitator, Valve
from drillpetsc.physics.tools.motor_law import MeasuredCurve, MotorLaw
from drillpetsc.physics.tools.mud_motor import Bend, MotorDesign, MudMotor, Rotor, Supply
from drillpetsc.physics.tools.reamer import Reamer, ReamerLaw, ReamerPlace
from drillpetsc.physics.tools.steering import PointTool, PushTool, Steer, Steering
from drillpetsc.time_function import Constant


def motor_item(case: Case) -> tuple[int, PositiveDisplacementMotor] | None:
    """Number and item of the downhole motor of a string; None without one."""
    return next(
        ((i, item) for i, item in enumerate(case.string) if isinstance(item, PositiveDisplacementMotor)), None
    )


def motor_law(section: MotorSection) -> MotorLaw:
    """The law of a power section."""
    if section.curve is None:
        assert section.rev_per_volume is not None and section.stall_torque is not None
        return MotorLaw(
            section.rev_per_volume / (2 * pi),
            section.efficiency,
            section.no_load_pressure,
            section.stall_torque,
            section.droop,
            section.bypass,
        )
    return MotorLaw(bypass=section.bypass, curves=_curves(section))


def _curves(section: MotorSection) -> list[MeasuredCurve]:
    """Measured curves down to standstill: the speed of the last point is zero, or the stall torque follows it."""
    assert section.curve is not None
    out = []
    for flow in section.curve.flows:
        rows = section.curve.rows_at(flow)
        torque, pressure, speed = (
            np.array([getattr(section.curve, key)[i] for i in rows])
            for key in ("torque", "differential_pressure", "speed")
        )
        if section.stall_torque is not None and section.stall_torque > torque[-1]:
            slope = (pressure[-1] - pressure[-2]) / (torque[-1] - torque[-2])
            pressure = np.append(pressure, pressure[-1] + slope * (section.stall_torque - torque[-1]))
            torque, speed = np.append(torque, section.stall_torque), np.append(speed, 0.0)
        speed[-1] = 0.0
        out.append(MeasuredCurve(flow, torque, pressure, speed))
    return out


def build_mud_motor(case: Case, joints: Joints, gravity: FloatArray, balanced: bool) -> MudMotor | None:
    """Create the motor of the string; None without one, and in a plugged string without the mud that would turn it.

    balanced: leave out the turning force of the rotor's orbit.
    """
    mesh = joints.mesh
    found, cell = motor_item(case), mesh.motor_cell
    if found is None or cell is None:  # a piece of the item may end above its joint
        return None
    if case.fluid is not None and not case.has_bore:
        return None
    number, item = found
    section = item.pdm
    rotor = Rotor(
        section.lobes[0] if section.lobes is not None else 1,
        section.rotor_mass,
        section.eccentricity,
        section.rotor_inertia,
        item.seal_area,
    )
    bent = next((q for q in mesh.bent if mesh.item[q.cell] == number and q.cell < cell), None)
    bend = Bend(cell, 0.0) if bent is None or item.bend is None else Bend(bent.node, item.bend.tool_face)
    supply = Supply(flow=section.flow_rate or Constant(0.0))
    if case.fluid is not None:
        supply = Supply(None, 1.0 / case.fluid.bulk_modulus, case.fluid.outlet_pressure)
    design = MotorDesign(motor_law(section), rotor, bend, f"string[{number}] pdm")
    return MudMotor(joints, gravity, cell, design, supply, balanced)


def build_agitators(case: Case, mesh: StringMesh) -> tuple[Agitator, ...]:
    """Create the agitators of the string, from the top; none in a plugged string without the mud that would turn them."""
    found: list[Agitator] = []
    if case.fluid is not None and not case.has_bore:
        return ()
    for _, item, joint in case.tools:
        if isinstance(item, AgitatorTool):
            cell = next(j.cell for j in mesh.joints if abs(j.depth - joint.at) < 1e-6)
            a = item.agitator
            valve = Valve(a.rev_per_volume, a.pressure_amplitude, a.piston_area, a.pulse == "square")
            wet = case.fluid is not None
            found.append(
                Agitator(
                    mesh,
                    cell,
                    valve,
                    None if wet else a.flow_rate or Constant(0.0),
                    1.0 / case.fluid.bulk_modulus if case.fluid is not None else None,
                    len(found) + 1,
                )
            )
    return tuple(found)


def build_steering(
    case: Case, mesh: StringMesh, well: Well | None, frames: Frames, tangent: FloatArray
) -> Steering | None:
    """Create the component of the steerable tool, None without one.

    tangent: (n_nodes, 3) directions of the unstrained string.
    """
    found = [(i, item) for i, item in enumerate(case.string) if isinstance(item, RotarySteerable)]
    if not found:
        return None
    number, item = found[0]
    steer = Steer(item.rss.steer.ratio, item.rss.steer.tool_face)
    zone = steering_zone(item, *case.item_depths[number])
    if isinstance(item.rss, PushSteering):
        node = mesh.nearest_node(zone[0])
        axis = _axis(case, mesh, well, tangent, node)
        return PushTool(steer, node, axis, well, item.rss.force, item.rss.pads == "rotating", frames)
    upper, lower = zone
    own = np.flatnonzero((mesh.item == number) & ~mesh.is_joint)
    overlap = np.minimum(mesh.lower[own], lower) - np.maximum(mesh.upper[own], upper)
    cells = own[overlap > 1e-9]
    weights = overlap[overlap > 1e-9] / float(overlap[overlap > 1e-9].sum())
    axis = _axis(case, mesh, well, tangent, int(cells[0]))
    return PointTool(steer, axis, well, item.rss.tilt, cells, weights, mesh)


def _axis(case: Case, mesh: StringMesh, well: Well | None, tangent: FloatArray, node: int) -> FloatArray:
    """Direction (3,) of the hole at a node of the string, which a weight on bit puts on the bottom."""
    if well is None:
        return tangent[node]
    top = 0.0
    if case.initial.wob is not None:
        top = hole_depth(case) - mesh.total_length
    return np.asarray(well.at(np.array([mesh.node_depth[node] + top]))[1])[0]


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
    top = 0.0
    if case.initial.wob is not None:
        top = hole_depth(case) - mesh.total_length
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
