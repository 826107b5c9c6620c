"""Motor and agitator that mud passes: exact Jacobian, flow down, up and next to none, and the power that the mud loses."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.physics.tools.agitator import Agitator, Valve
from drillpetsc.physics.tools.motor_law import MotorLaw
from drillpetsc.physics.tools.mud_motor import Bend, MotorDesign, MudMotor, Rotor, Supply
from tests.component.test_joint_flow import build
from tests.helpers.component_models import GRAVITY, SHIFT, dense, residual
from tests.helpers.tables import each_row

FLOWS = {"down": 0.3, "up": -0.3, "next to none": 4e-5, "next to none, up": -4e-5}


def motor(mesh, frames, joints) -> list:
    law, rotor = MotorLaw(1.0, 0.8, 0.3, 2.0, 2.5), Rotor(5, 0.6, 0.15, 0.2, 0.1)
    return [MudMotor(joints, GRAVITY, 2, MotorDesign(law, rotor, Bend(2, 0.3)), Supply(None, 1 / 60.0))]


def agitator(mesh, frames, joints) -> list:
    return [Agitator(mesh, 2, Valve(0.7, 3.0, 0.4), None, 1 / 60.0)]


def tool_in_mud(tool, flow: float):
    """A tool at the joint, with the flow rate ``flow`` [m3/s] there and a torque of 1.1 of 2 N m at stall."""
    system = build("bore annulus", more=tool)
    asm, dofs = system.assembly, system.layout.dofs
    asm.x[dofs["bore.flow"][3]] = flow
    if "motor.torque" in dofs:
        asm.x[dofs["motor.torque"][3]] = 1.1 if flow >= 0 else -1.1
    return system


@each_row("flow", FLOWS)
@each_row("tool", [motor, agitator])
def test_jacobian_matches_differences(tool, flow):
    """Rows of the tool's block by all of its unknowns; fourth-order differences of a step well below that of the law."""
    system, t = tool_in_mud(tool, FLOWS[flow]), 0.4
    asm = system.assembly
    x0 = asm.x[:-1].copy()
    residual(system, x0, t)
    asm.jacobian(t, (1.0, SHIFT, SHIFT**2), condensed=True)
    J = dense(system)
    bound = next(b for b in asm.bound_blocks if b.block.name in ("mud_motor", "agitator"))
    place, flow_at = bound.index[0], system.layout.dofs["bore.flow"][3, 0]
    for j in place:
        h = 2e-7 if j == flow_at else 1e-4
        e = np.zeros(len(x0))
        e[j] = h
        r = [residual(system, x0 + k * e, t) for k in (-2, -1, 1, 2)]
        by_j = (r[0] - 8 * r[1] + 8 * r[2] - r[3]) / (12 * h)
        scale = np.abs(J[place]).max(axis=1) + 1.0
        tolerance = 1e-5 if j == flow_at else 1e-6  # differences over 1e-7 m3/s lose digits
        assert np.abs((J[place, j] - by_j[place]) / scale).max() < tolerance


@each_row("flow", ["down", "up"])
@each_row("tool", [motor, agitator])
def test_what_the_mud_loses_drives_the_string_or_is_heat(tool, flow):
    """Row of momentum times flow = dissipated + power on the string."""
    system = tool_in_mud(tool, FLOWS[flow])
    asm = system.assembly
    asm.condense(SHIFT)
    part = next(c for c in system.components if isinstance(c, MudMotor | Agitator))
    if isinstance(part, MudMotor):  # without the rotor's inertia its rows are the torque
        part.params.update({"rotor_mass": 0.0, "rotor_inertia": 0.0})
    bound = next(b for b in asm.bound_blocks if b.block.name in ("mud_motor", "agitator"))
    rows, index = asm.block_rows(bound, 0.4)[0], bound.index[0]
    passing = asm.x[index[17]] * np.exp(-(asm.x[index[15]] + asm.x[index[16]]) / 120.0)
    lost = 100 * rows[17] * passing
    on_string = -rows[:14] @ asm.y[index[:14]]
    powers = part.powers(0.4, asm)
    assert abs(lost) > 1e-4
    assert powers.dissipated == pytest.approx(lost - on_string, rel=1e-9)
    assert powers.supplied == 0
