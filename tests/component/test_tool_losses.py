"""Measured losses of tools: exact Jacobian, rows of a table by hand, power lost (manual: eq-mud-tool-curve)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.physics.fluid.bore_flow import BoreFlow
from drillpetsc.physics.fluid.rheology import Rheology
from drillpetsc.physics.fluid.tool_losses import LossTable, SurfaceLine, ToolLosses
from tests.helpers import flow_models
from tests.helpers.component_models import both_jacobians, lengths
from tests.helpers.flow_models import set_rates
from tests.helpers.tables import each_row

KINDS = (
    "pipe_annulus_bit", "pipe_bit", "pipe_annulus_bit_held", "pipe_bit_held", "pipe_annulus_bit_junction",
)  # fmt: skip
SQUARE, LOSS, SLOPE = np.array([0.0, 1e-4, 9e-4]), np.array([0.0, 2.0, 5.0]), np.array([1e4, 6e3, 3e3])
CUBIC = np.column_stack([SQUARE, LOSS, SLOPE])
LINE = np.array([[0.0, 0.0, 500.0], [4e-4, 0.2, 500.0]])
RATES = np.array([0.02, -0.008, 0.05, -0.04])  # between the points, back, beyond the last one


def build(kind: str) -> DiscreteSystem:
    """The string of the fluid's contract tests with two tools, one of them over two elements, in a random moving state."""
    base = flow_models.build(kind)
    bore = next(c for c in base.components if c.name == "bore")
    assert isinstance(bore, BoreFlow)
    tools = (
        LossTable(CUBIC, 2.5, np.array([0, 1]), np.array([0.25, 0.75])),
        LossTable(LINE, 4.0, np.array([1]), np.ones(1)),
        LossTable(CUBIC, 3.0, np.array([2]), np.ones(1)),
        LossTable(LINE, 3.0, np.array([3]), np.ones(1)),
    )
    system = DiscreteSystem(base.mesh, base.frames, [*base.components, ToolLosses(tools, bore.fluid)])
    for f in system.layout.fields:
        system.set_field(f.name, base.field(f.name))
    rates = base.field("bore.flow")
    rates[1:, 0] = RATES
    system.set_field("bore.flow", rates)
    set_rates(system, np.random.default_rng(7))
    return system


@each_row("kind", KINDS)
def test_condensed_jacobian_matches_central_differences(kind):
    """Every row by every unknown against fourth-order differences, relative to the largest entry of the row."""
    system, t = build(kind), 0.4
    J, F = both_jacobians(system, t, lengths(system, 1e-4))
    assert np.abs((J - F) / np.abs(J).max(axis=1, keepdims=True)).max() < 3e-7


def by_hand(table: np.ndarray, flow: float) -> float:
    """The cubic through two points with the slopes there, by its four coefficients; a straight line beyond the last point."""
    square, loss, slope = table.T
    u = flow**2
    if u >= square[-1]:
        return float(np.copysign(loss[-1] + slope[-1] * (u - square[-1]), flow))
    k = int(np.flatnonzero(square > u)[0])
    a, b = square[k - 1], square[k]
    rows = [[1, a, a**2, a**3], [0, 1, 2 * a, 3 * a**2], [1, b, b**2, b**3], [0, 1, 2 * b, 3 * b**2]]
    scale = np.array([1, 1e4, 1e8, 1e12])
    c = np.linalg.solve(np.array(rows) * scale, [loss[k - 1], slope[k - 1], loss[k], slope[k]])
    return float(np.copysign(c @ (scale * [1, u, u**2, u**3]), flow))


@each_row("kind", KINDS)
def test_losses_of_elements_and_the_power_that_they_take(kind):
    """(rho/rho_m) f(rho0 q/rho) times the share of each element, added where two tools are in one; power loss times flow rate."""
    system = build(kind)
    asm, tools = system.assembly, system.components[-1]
    fluid = tools.fluid
    pressure = system.field("bore.pressure")[:, 0]
    density = fluid.density * np.exp(0.5 * (pressure[1:] + pressure[:-1]) / fluid.bulk_modulus)
    flow = RATES * fluid.density / density
    want, power = np.zeros(len(RATES)), 0.0
    for tool in tools.tools:
        for c, share in zip(tool.cells, tool.shares, strict=True):
            lost = share * density[c] / tool.density * by_hand(tool.table, flow[c])
            want[c] += lost
            power += lost * flow[c]
    assert tools.losses(asm) == pytest.approx(want, rel=1e-9)
    assert tools.powers(0.0, asm).dissipated == pytest.approx(power, rel=1e-9) and power > 0
    ready = next(b for b in asm.bound_blocks if b.block.name == "tool_losses")
    rows = asm.block_rows(ready, 0.4)
    assert not rows[:, :2].any()
    found = np.zeros(len(RATES))
    np.add.at(found, ready.block.points, rows[:, 2])
    assert found == pytest.approx(1e-2 * want, rel=1e-9)


def test_a_measured_surface_loss_goes_with_the_square_of_the_flow_and_has_its_sign():
    line = SurfaceLine(Rheology("newtonian", consistency=1e-3), 1200.0, measured=4e5, at=0.03)
    assert [line.loss(q) for q in (0.03, 0.015, -0.015)] == pytest.approx([4e5, 1e5, -1e5])
