"""Component contract of the downhole motor: exact Jacobian, energy balance, what it leaves alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.string_mesh import StringJoint
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.joints import Joints
from drillpetsc.physics.tools.motor_law import MeasuredCurve, MotorLaw
from drillpetsc.physics.tools.mud_motor import Bend, MotorDesign, MudMotor, Rotor, Supply
from drillpetsc.time_function import Constant
from tests.helpers.component_models import GRAVITY, SECTION, SHIFT, both_jacobians, curved_tangents
from tests.helpers.tables import each_row
from tests.helpers.uniform_string import uniform_string

#: torque [N m] by the part of the law that it meets; the stall torque is 2
PLACES = {"driven": -0.7, "corner": 0.011, "running": 1.1, "stalling": 1.993, "stalled": 2.6}


def law(measured: bool = False) -> MotorLaw:
    """A motor of order one: 0.5 m3/s turns it with about 3.1 rad/s."""
    exact = MotorLaw(1.0, 0.8, 0.3, 2.0, 2.5, bypass=0.1)
    if not measured:
        return exact
    torque = np.linspace(0.0, 2.0, 7)
    curves = []
    for flow in (0.2, 0.35, 0.6):
        speed, pressure = exact.points(torque, np.array([flow + 0.1])).T[:2]
        curves.append(MeasuredCurve(flow, torque, pressure, speed))
    return MotorLaw(bypass=0.1, curves=curves)


def build(place: str, measured: bool = False, balanced: bool = False, seed: int = 4) -> DiscreteSystem:
    """Beams above and below a motor in a random moving state that keeps the tangents of the joint parallel."""
    rng = np.random.default_rng(seed)
    mesh = replace(
        uniform_string(4.0, 4, **SECTION),
        upper=np.array([0, 1, 2, 2.0]),
        lower=np.array([1, 2, 2, 3.0]),
        node_depth=np.array([0, 1, 2, 2, 3.0]),
        joints=(StringJoint(2.0, "revolute", 2, driven=True),),
    )
    tangents = curved_tangents(5)
    tangents[3] = tangents[2]
    frames = transported_frames(tangents)
    joints = Joints(mesh, frames)
    rotor = Rotor(5, 0.6, 0.15, 0.2, 0.1)
    design = MotorDesign(law(measured), rotor, Bend(2, 0.3))
    motor = MudMotor(joints, GRAVITY, 2, design, Supply(Constant(0.52)), balanced)
    system = DiscreteSystem(mesh, frames, [AncfBeam(mesh, frames, GRAVITY), joints, motor])
    position = np.cumsum(np.vstack([[0, 0, 0], tangents[:-1]]), axis=0)
    noise = 0.1 * rng.standard_normal((5, 3))
    noise[3] = noise[2]
    position[3] = position[2]
    system.set_field("string.position", position + noise)
    lean = 0.1 * rng.standard_normal((5, 3))
    lean[3] = lean[2]
    system.set_field("string.tangent", tangents + lean)
    system.set_field("string.spin", 2 * rng.standard_normal((5, 1)))
    system.set_field("motor.torque", np.full((5, 1), PLACES[place]))
    asm = system.assembly
    asm.v0[:], asm.v1[:] = rng.standard_normal(len(asm.v0)), rng.standard_normal(len(asm.v1))
    return system


def the_motor(system: DiscreteSystem) -> MudMotor:
    return next(c for c in system.components if isinstance(c, MudMotor))


@each_row("measured", [False, True])
@each_row("place", PLACES)
@each_row("held", [False, True])
def test_jacobian_matches_differences(place, measured, held):
    """All parts of the law, its corners included, in motion and held by statics (fourth-order differences)."""
    system, t = build(place, measured), 0.4
    if held:
        the_motor(system).params["held"] = 3.0
    J, F = both_jacobians(system, t, 1e-5)
    # each row against its own largest entry: the rows of joint and law have another scale than forces
    scale = np.abs(J).max(axis=1, keepdims=True) + 1.0
    assert np.abs((J - F) / scale).max() < 3e-7


@each_row("balanced", [False, True])
@each_row("place", ["driven", "running"])
def test_work_of_the_motor_and_of_its_rotor_is_their_energy(place, balanced):
    """y.R = d(energy)/dt - supplied, in the motor's own rows, along a motion whose rotor orbits in space.

    Both nodes of the joint move as one but for the spin, as the joint makes them.
    """
    system, t = build(place, balanced=balanced), 0.4
    asm, motor = system.assembly, the_motor(system)
    asm.condense(SHIFT)
    d = system.layout.dofs
    for name in ("string.position", "string.tangent"):
        for values in (asm.x, asm.y, asm.a):
            values[d[name][3]] = values[d[name][2]]
    bound = next(b for b in asm.bound_blocks if b.block.name == "mud_motor")
    rows = asm.block_rows(bound, t)[0][:14]
    y, a = asm.y[bound.index[0]], asm.a[bound.index[0]]
    powers = motor.powers(t, asm)
    law_speed = motor.law.speed(PLACES[place], 0.52)
    turned = PLACES[place] * (y[13] - y[6])  # away from the law the power is that of the present speed
    assert powers.supplied == pytest.approx(turned, rel=1e-12)
    assert law_speed > 0
    x0, y0 = asm.x.copy(), asm.y.copy()
    flow = y0.copy()
    flow[asm.spin_at[:, 0]] -= asm.transport()

    def stored(h):
        asm.x[:], asm.y[:] = x0 + h * flow, y0 + h * asm.a
        return sum(motor.energies(t, asm))

    h = 1e-4
    rate = (stored(-2 * h) - 8 * stored(-h) + 8 * stored(h) - stored(2 * h)) / (12 * h)
    assert abs(rate) > 1e-2 and len(a)
    assert rows @ y[:14] == pytest.approx(rate - turned, rel=1e-8)


def test_a_motor_without_rotor_data_adds_its_torque_alone():
    """Reaction: the torque on the stator is the opposite of that on the rotor, and nothing else changes."""
    system = build("running")
    motor = the_motor(system)
    asm = system.assembly
    asm.condense(SHIFT)
    motor.params.update({"rotor_mass": 0.0, "rotor_inertia": 0.0})
    bound = next(b for b in asm.bound_blocks if b.block.name == "mud_motor")
    rows = asm.block_rows(bound, 0.0)[0]
    assert rows[6] == PLACES["running"] and rows[13] == -PLACES["running"]
    assert not np.delete(rows[:14], [6, 13]).any()


def test_equivalent_inertia_and_orbit_force_act_on_a_rotor_in_a_stator_at_rest():
    """C13: rotor of Simulator4nDOF, in the motor's own rows.  I + M e^2 N^2 = 3.875 kg m2, M e (N w)^2 = 11.193 kN."""
    system = build("running")
    motor, asm = the_motor(system), system.assembly
    asm.x[:-1], asm.y[:], asm.a[:] = asm.x[:-1], 0.0, 0.0
    motor.params.update(
        {"lobes": 5.0, "rotor_mass": 350.0, "eccentricity": 0.01, "rotor_inertia": 3.0, "gravity": 0.0}
    )
    d = system.layout.dofs
    asm.x[d["motor.torque"][3]] = 0.0
    bound = next(b for b in asm.bound_blocks if b.block.name == "mud_motor")
    asm.a[d["string.spin"][3]] = 1.0
    assert asm.block_rows(bound, 0.0)[0][13] == pytest.approx(3.875, rel=1e-12)
    asm.a[:] = 0.0
    asm.y[d["string.spin"][3]] = 11.31
    rows = asm.block_rows(bound, 0.0)[0]
    assert np.linalg.norm(rows[:3]) == pytest.approx(11.193e3, rel=1e-4)
    assert motor.figures(0.0, asm)[4] == pytest.approx(-5 * 11.31)  # it orbits backwards
