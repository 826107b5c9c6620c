"""From the item `pdm` of a case to its component and its law (manual: sec-motor)."""

from __future__ import annotations

from math import pi

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.items.motor import MotorSection, PositiveDisplacementMotor
from drillpetsc.case.case import Case
from drillpetsc.physics.joints import Joints
from drillpetsc.physics.tools.motor_law import MeasuredCurve, MotorLaw
from drillpetsc.physics.tools.mud_motor import Bend, MotorDesign, MudMotor, Rotor, Supply
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
