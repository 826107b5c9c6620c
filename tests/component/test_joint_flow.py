"""Mud across joints and seals of telescoping ones: exact Jacobian, conservation of mass, and the same stroke in the force
and in both books of mud (manual: sec-mud-joints)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.quantity import OneStep
from drillpetsc.fem.string_mesh import StringJoint
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.fluid.annulus_flow import AnnulusFlow, FlowLine, HoleAround, LateralCoefficients
from drillpetsc.physics.fluid.bore_flow import BoreFlow
from drillpetsc.physics.fluid.channel_flow import RESULT_NAMES, FluidConstants
from drillpetsc.physics.fluid.channels import Annulus, Bore
from drillpetsc.physics.fluid.joint_seals import SEAL_RESULTS, JointSeals
from drillpetsc.physics.joints import Joints
from drillpetsc.time_function import Constant, Ramp
from tests.helpers.component_models import GRAVITY, SECTION, both_jacobians, lengths
from tests.helpers.flow_models import MUD, curved_hole, give_shoulders, set_rates
from tests.helpers.tables import each_row
from tests.helpers.uniform_string import uniform_string

SEAL = 0.045
KINDS = ("bore", "annulus", "bore annulus", "bore annulus arm", "annulus arm", "bore arm")


def build(kind: str, seed: int = 4, more: Callable[..., list] | None = None) -> DiscreteSystem:
    """Two elements, a slider with seals, an element; mud of density 3 and bulk modulus 60; a random moving state.
    arm: a rigid arm of 0.3 m above the joint; more: further components by mesh, frames and joints."""
    rng = np.random.default_rng(seed)
    arm = 0.3 if "arm" in kind else 0.0
    mesh = uniform_string(4.0, 4, **SECTION, inner_diameter=0.3)
    depth = np.array([0, 1, 2 - arm, 2, 3])
    mesh = replace(
        mesh,
        upper=np.array([0, 1, 2, 2.0]),
        lower=np.array([1, 2 - arm, 2, 3]),
        node_depth=depth,
        rigid_above=np.array([0, 0, arm, 0]),
        joints=(StringJoint(2.0, "slider", 2, spring=50.0, damping=3.0, seal_area=SEAL),),
    )
    well = curved_hole()
    position, tangents, _ = map(np.asarray, well.at(depth))
    frames = transported_frames(tangents)
    poisson, n = np.full(4, 0.3), np.ones(4)
    bore = Bore(0.07 * n, 1e-3 * n, 0.06 * n, tool=np.array([0.0, 0.0, 40.0, 0.0]))
    sizes = Annulus(0.126 * n, 0.28 * n, 2e-3 * n, 0.15 * n)
    components: list = [AncfBeam(mesh, frames, GRAVITY), Joints(mesh, frames)]
    if "bore" in kind:
        components.append(BoreFlow(mesh, bore, MUD, poisson, Ramp(0.03, 1.0), None, None))
    if "annulus" in kind:
        side = LateralCoefficients(2.0 * n, 0.3 * n, 0.2 * n, 0.0 * n)
        components.append(
            AnnulusFlow(mesh, HoleAround(sizes, well), MUD, poisson, side, FlowLine(Constant(0.4), 0.1), None)
        )
    components.append(JointSeals(mesh, MUD, "bore" in kind, "annulus" in kind, Constant(0.7)))
    if more is not None:
        components += more(mesh, frames, components[1])
    system = DiscreteSystem(mesh, frames, components)
    system.set_field("string.position", position + 0.05 * rng.standard_normal((5, 3)))
    system.set_field("string.tangent", tangents + 0.1 * rng.standard_normal((5, 3)))
    system.set_field("string.spin", rng.standard_normal((5, 1)))
    for f in system.layout.fields:
        if not f.second_order:
            scale = 0.02 if f.name.endswith("flow") else 1e-6 if f.name == "joint.load" else 2.0
            system.set_field(f.name, scale * rng.standard_normal((5, f.size)))
    set_rates(system, rng)
    return system


@each_row("kind", KINDS)
def test_condensed_jacobian_matches_central_differences(kind):
    """Every row by every unknown against fourth-order differences, relative to the largest entry of the row; rows and
    columns of the joint's multipliers are in newtons."""
    system, t = build(kind), 0.4
    give_shoulders(system)
    names = np.array([f.name for f in system.layout.fields])[system.layout.field_of]
    unit = np.where(np.char.startswith(names, "joint."), 1e-6, 1.0)
    J, F = both_jacobians(system, t, lengths(system, 1e-4))
    J, F = (unit[:, None] * A * unit for A in (J, F))
    assert np.abs((J - F) / np.abs(J).max(axis=1, keepdims=True)).max() < 3e-7


def components_of(system) -> tuple[list, JointSeals]:
    """Channels and seals."""
    flows = [c for c in system.components if c.name in ("bore", "annulus")]
    return flows, system.components[-1]


@each_row("kind", KINDS)
def test_mass_rows_add_up_to_the_change_of_content(kind):
    """Rows of mass of the cell of the joint and of its seals = d(content)/dt by differences along the motion."""
    system = build(kind)
    asm, h = system.assembly, 1e-5
    flows, seals = components_of(system)
    x0, y = asm.x.copy(), asm.y.copy()
    y[-1] = 0.0
    content = []
    for k in (-2, -1, 1, 2):
        asm.x[:] = x0 + k * h * y
        each = sum(c.element_results(asm)[2, RESULT_NAMES.index("content")] for c in flows)
        content.append(each + seals.content_of(OneStep(asm, 0.0))[0])
    asm.x[:] = x0
    rate = (content[0] - 8 * content[1] + 8 * content[2] - content[3]) / (12 * h)
    total = sum(
        c.element_results(asm)[2, [RESULT_NAMES.index(f"storage_{end}") for end in ("upper", "lower")]].sum()
        for c in flows
    )
    ready = next(b for b in asm.bound_blocks if b.block.name == "seals")
    total += 1e-6 * asm.block_rows(ready, 0.4)[0, 14:].sum()
    assert total == pytest.approx(rate, rel=1e-6)
    assert abs(rate) > 1e-3


@each_row("kind", KINDS)
def test_seals_have_one_stroke_in_force_and_mud(kind):
    """Without weight and compression: force times speeds = -(p_i - p_o) A_s dx/dt; rows of mass +-A_s dx/dt; no resultant."""
    system = build(kind)
    asm = system.assembly
    ready = next(b for b in asm.bound_blocks if b.block.name == "seals")
    seals = system.components[-1]
    still = FluidConstants(3.0, 1e12, np.zeros(3), seals.fluid.rheology)
    block = ready.block
    index = ready.index[0]
    if block.update is not None:
        block.update(0.4)
    x0, h = asm.x.copy(), 1e-5
    y = asm.y.copy()
    y[-1] = 0.0
    travel = []
    for k in (-2, -1, 1, 2):
        asm.x[:] = x0 + k * h * y
        travel.append(seals.element_results(asm)[0, SEAL_RESULTS.index("travel")])
    asm.x[:] = x0
    speed = (travel[0] - 8 * travel[1] + 8 * travel[2] - travel[3]) / (12 * h)
    asm.y[index[14:]] = 0.0
    rows = np.zeros_like(asm.r)
    ready.residual(
        1,
        *(a.ctypes.data for a in (index, block.params)),
        still.address,
        *(a.ctypes.data for a in (asm.x, asm.y, asm.a, rows)),
    )
    pressures = list(x0[index[14:]])
    apart = {2: lambda p: p[0] - p[1], 1: lambda p: p[0] - 0.7 if "bore" in kind else -p[0]}[len(pressures)](
        pressures
    )
    assert rows[index[:14]] @ asm.y[index[:14]] == pytest.approx(-apart * SEAL * speed, rel=1e-6)
    signs = [1.0] * ("bore" in kind) + [-1.0] * ("annulus" in kind)
    assert 1e-6 * rows[index[14:]] == pytest.approx(np.array(signs) * SEAL * speed, rel=1e-6)
    assert np.abs(rows[index[0:3]] + rows[index[7:10]]).max() < 1e-14
    assert abs(speed * apart) > 1e-3


def test_a_cell_without_length_loses_pressure_by_the_tools_loss_alone():
    """At rest in space: p2 - p1 = rho g.d - K rho0^2/rho q|q|, by the row of momentum of the bore."""
    system = build("bore")
    asm = system.assembly
    ready = next(b for b in asm.bound_blocks if b.block.name == "bore_flow_joint")
    index = ready.index[0]
    asm.y[:], asm.a[:] = 0.0, 0.0
    x = asm.x[index]
    density = 3.0 * np.exp(0.5 * (x[14] + x[15]) / 60.0)
    drop = x[15] - x[14] - density * (x[7:10] - x[:3]) @ GRAVITY + 40.0 * 9.0 / density * x[16] * abs(x[16])
    assert asm.block_rows(ready, 0.4)[0, 16] == pytest.approx(1e-2 * drop, rel=1e-12)


@pytest.mark.parametrize("arm", [False, True])
def test_a_joint_without_an_arm_shares_the_inertia_of_the_flow_above(arm):
    """A quarter of rho0 L/A of the element above stands in the row of the joint; flow and inertia together are the same,
    and the power of both rows is the rate of their energy."""
    system = build("bore arm" if arm else "bore")
    bore, asm = components_of(system)[0][0], system.assembly
    ready = next(b for b in asm.bound_blocks if b.block.name == "bore_flow_inertia")
    if arm:
        assert len(ready.index) == 0  # the mud in the arm has inertia of its own
        return
    index, rate = ready.index[0], asm.y[ready.index[0]]
    inertia = 0.25 * 3.0 * 1.0 / 0.07
    rows = asm.block_rows(ready, 0.4)[0]
    assert rows == pytest.approx(1e-2 * inertia * np.array([-rate[0], rate[1]]), rel=1e-12)

    def kinetic(h: float) -> float:
        asm.x[index] = flow + h * rate
        with_joint = bore.energies(0.4, asm).kinetic
        saved, bore._inertia = bore._inertia, None
        without = bore.energies(0.4, asm).kinetic
        bore._inertia = saved
        return with_joint - without

    flow = asm.x[index].copy()
    power = (kinetic(1e-3) - kinetic(-1e-3)) / 2e-3
    assert power == pytest.approx(1e2 * rows @ flow, rel=1e-8)
