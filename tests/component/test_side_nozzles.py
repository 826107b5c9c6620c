"""Nozzles above the bit: exact Jacobian, mass that leaves the bore for the annulus, momentum with the string (manual:
sec-mud-side-nozzles)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.physics.fluid.annulus_flow import AnnulusFlow
from drillpetsc.physics.fluid.bore_flow import BoreFlow
from drillpetsc.physics.fluid.channel_flow import RESULT_NAMES
from drillpetsc.physics.fluid.side_nozzles import RESULTS, SideLink, SideNozzles
from drillpetsc.time_function import Constant
from tests.helpers import flow_models
from tests.helpers.component_models import both_jacobians, lengths
from tests.helpers.flow_models import set_rates
from tests.helpers.tables import each_row

KINDS = (
    "pipe_annulus_bit", "pipe_bit", "pipe_annulus_bit_held", "pipe_bit_held", "pipe_annulus_bit_junction",
)  # fmt: skip
LINKS = (SideLink(1, 0.02, ((1, 0.02),)), SideLink(3, 0.03, ((2, 0.01), (3, 0.02))))
COEFFICIENT = 0.9
SPEED, DENSITY = RESULT_NAMES.index("speed"), RESULT_NAMES.index("density")


def build(kind: str) -> DiscreteSystem:
    """The string of the fluid's contract tests with nozzles at two of its nodes, in a random moving state."""
    base = flow_models.build(kind)
    channels = {c.name: c for c in base.components}
    bore, annulus = channels["bore"], channels.get("annulus")
    assert isinstance(bore, BoreFlow) and (annulus is None or isinstance(annulus, AnnulusFlow))
    side = SideNozzles(base.mesh, LINKS, COEFFICIENT, bore, annulus, Constant(0.7), (0.03, 0.9))
    system = DiscreteSystem(base.mesh, base.frames, [*base.components, side])
    rng = np.random.default_rng(7)
    for f in system.layout.fields:
        if f.name != "side.flow":
            system.set_field(f.name, base.field(f.name))
    system.set_field("side.flow", np.array([[0.0], [0.02], [0.0], [-0.03], [0.0]]))
    set_rates(system, rng)
    return system


@each_row("kind", KINDS)
def test_condensed_jacobian_matches_central_differences(kind):
    """Every row by every unknown against fourth-order differences, relative to the largest entry of the row."""
    system, t = build(kind), 0.4
    J, F = both_jacobians(system, t, lengths(system, 1e-4))
    assert np.abs((J - F) / np.abs(J).max(axis=1, keepdims=True)).max() < 3e-7


@each_row("kind", KINDS)
def test_rows_of_a_link(kind):
    """q leaves the bore and enters the annulus; rho0 q V acts on the string; the link's row is that of an orifice."""
    system = build(kind)
    asm = system.assembly
    side = system.components[-1]
    ready = next(b for b in asm.bound_blocks if b.block.name == "side_nozzles")
    rows = asm.block_rows(ready, 0.4)
    wet, held = "annulus" in kind, "held" in kind
    first = 0 if held else 7
    for row, index, link, result in zip(rows, ready.index, LINKS, side.element_results(asm), strict=True):
        q, inside = asm.x[index[-1]], asm.x[index[first]]
        outside = asm.x[index[first + 1]] if wet else 0.7
        thin = np.exp(-outside / 60.0)
        loss = (
            3.0 * thin * q * np.sqrt(q * q + (0.025 * link.area) ** 2) / (2 * COEFFICIENT**2 * link.area**2)
        )
        inertance = 3.0 * 0.1 / link.area
        assert row[-1] == pytest.approx(
            1e-2 * (inertance * asm.y[index[-1]] + outside - inside + loss), rel=1e-12
        )
        assert row[first] == pytest.approx(1e6 * q, rel=1e-12)
        if wet:
            assert row[first + 1] == -row[first]
        if not held:
            assert row[:3] == pytest.approx(3.0 * q * asm.y[index[:3]], rel=1e-12)
            assert not row[3:7].any()
        assert result[RESULTS["lost"]] == pytest.approx(
            loss * q * np.exp(-0.5 * (inside + outside) / 60.0), rel=1e-12
        )
        assert result[RESULTS["jet"]] == pytest.approx(q * thin / link.area, rel=1e-12)


@each_row("kind", ["pipe_annulus_bit", "pipe_annulus_bit_held", "pipe_bit"])
def test_power_of_a_link(kind):
    """Lost in the nozzles, and given to mud that leaves with the string's speed V: rho0 q V^2/2; the rest is of the velocity
    heads at the nodes (manual: eq-mud-side-power).  A jet in the open takes its velocity head and its enthalpy along."""
    system = build(kind)
    asm, side = system.assembly, system.components[-1]
    ready = next(b for b in asm.bound_blocks if b.block.name == "side_nozzles")
    heads = sum(c.velocity_power(*side._beside, asm) for c in (side.bore, side.annulus) if c is not None)
    found, q, given = side.element_results(asm), asm.x[ready.index[:, -1]], 0.0
    want = found[:, RESULTS["lost"]].sum()
    if "held" not in kind:
        want += 0.5 * 3.0 * q @ np.sum(asm.y[ready.index[:, :3]] ** 2, axis=1)
    if "annulus" not in kind:
        jet = found[:, RESULTS["jet"]] ** 2 + np.sum(asm.y[ready.index[:, :3]] ** 2, axis=1)
        place = asm.x[ready.index[:, :3]] @ side.fluid.gravity
        want -= 0.5 * 3.0 * q @ jet
        given = -q @ (-60.0 * np.expm1(-0.7 / 60.0) - 3.0 * place + 0.5 * 3.0 * jet)
    powers = side.powers(0.4, asm)
    assert powers.dissipated - heads == pytest.approx(want, rel=1e-12)
    assert powers.supplied == pytest.approx(given, rel=1e-12)


@pytest.mark.parametrize("kind", ["pipe_annulus_bit", "pipe_annulus_bit_held"])
def test_velocity_heads_at_nodes_without_a_step(kind):
    """What the flow brings to nodes 1 and 3 less what it takes away: q rho0 (w + V)^2/2 above less below."""
    system = build(kind)
    asm = system.assembly
    for channel in (c for c in system.components if c.name in ("bore", "annulus")):
        speed, q = channel.element_results(asm)[:, SPEED].copy(), channel.flows(system)
        if channel.name == "annulus" and "held" not in kind:
            velocity = asm.y[system.layout.dofs["string.position"]][1:]
            speed += np.sum(velocity * channel.parameter("tangent2"), axis=1)
        power = 0.5 * 3.0 * q * speed**2
        want = power[0] - power[1] + power[2] - power[3]
        assert channel.velocity_power(np.array([0, 2]), np.array([1, 3]), asm) == pytest.approx(
            want, rel=1e-12
        )


def test_velocity_heads_at_a_step_of_the_section():
    """At node 2 the flow that goes on has the speed of the section above: the element below takes the change of the head."""
    system = build("pipe_annulus_bit_held")
    asm = system.assembly
    areas = {"bore": 0.07, "annulus": 0.28 - 0.126}
    for channel in (c for c in system.components if c.name in areas):
        results, q = channel.element_results(asm), channel.flows(system)
        head = [q[k] * (q[k] * 3.0 / results[k, DENSITY] / areas[channel.name]) ** 2 for k in (1, 2)]
        want = 0.5 * 3.0 * (head[0] - head[1])
        assert channel.velocity_power(np.array([1]), np.array([2]), asm) == pytest.approx(want, rel=1e-12)
