"""Components of joints: exact Jacobian, workless constraints, action and reaction; no data
without joints (manual: verif-joint-component)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.physics.joints import KINDS, SCALE
from tests.helpers.component_models import SHIFT, both_jacobians, meet_conditions
from tests.helpers.joint_models import joint_component, random_state
from tests.helpers.tables import each_row

STATES = {
    **{
        f"{kind}{' stabilised' * s}": (lambda k=kind, s=s: random_state(k, s))
        for kind in KINDS
        for s in (False, True)
    },
    "universal stabilised beside a held node": lambda: random_state("universal", True, held=True),
}
MECHANICAL = ("string.position", "string.tangent", "string.spin")


def scaled(system) -> np.ndarray:
    """(n,) unit of each unknown's row and column; multipliers and their rows have the unit SCALE."""
    names = np.array([f.name for f in system.layout.fields])[system.layout.field_of]
    return np.where(np.char.startswith(names, "string."), 1.0, 1.0 / SCALE)


@each_row("name", STATES)
def test_condensed_jacobian_matches_central_differences(name):
    """Fourth-order differences of all rows by all unknowns. The dependence of the velocity stabilization on
    the position (of order mu) is neglected in the Jacobian, so mu is zero here."""
    system, t = STATES[name](), 0.0
    if "joint.correction" in system.layout.dofs:
        system.set_field("joint.correction", np.zeros((5, 6)))
    unit = scaled(system)
    free = meet_conditions(system, t)  # a fixed node is given by its rows, for any columns
    J, F = both_jacobians(system, t, 1e-4)
    J, F = (unit[:, None] * A * unit for A in (J, F))
    size = np.abs(J[np.abs(J) < 1e5]).max()  # rows that fix a node are larger
    assert np.abs((J - F) @ free).max() < 3e-7 * size


@each_row("name", [n for n in STATES if "stabilised" not in n])
def test_multipliers_do_the_work_of_their_constraints(name):
    """Rows times velocity = sum of multipliers times rates of their constraint rows, because
    forces are the transposed derivative of the constraints; except for springs, stops and dampers."""
    system, t = STATES[name](), 0.0
    asm = system.assembly
    asm.condense(SHIFT)
    ready = next(b for b in asm.bound_blocks if b.block.name == "joints")
    slot = system.layout.dofs["joint.load"]
    free = slot[slot >= 0]

    def rows() -> np.ndarray:
        out = np.zeros_like(asm.r)
        for e in range(ready.count):
            ready.residual(
                1,
                *(a.ctypes.data for a in (ready.index[e], ready.block.params[e])),
                ready.block.context,
                *(a.ctypes.data for a in (asm.x, asm.y, asm.a, out)),
            )
        return out

    here = rows()
    mechanical = np.concatenate([system.layout.dofs[f].ravel() for f in MECHANICAL])
    power = float(here[mechanical] @ asm.y[mechanical])
    flow = np.zeros_like(asm.y)
    flow[mechanical] = asm.y[mechanical]
    flow[asm.spin_at[:, 0]] -= asm.transport()
    x0, lam = asm.x.copy(), asm.x[free].copy()
    constraint, stored = [], []
    h = 1e-4
    for k in (-2, -1, 1, 2):
        asm.x[:] = x0 + k * h * flow
        constraint.append(rows()[free])
        stored.append(joint_component(system).energies(t, asm).strain)
    rate, spring = ((q[0] - 8 * q[1] + 8 * q[2] - q[3]) / (12 * h) for q in (constraint, stored))
    asm.x[:] = x0
    lost = joint_component(system).powers(t, asm).dissipated
    assert ("slider" in name) == (lost > 0.0)
    # the row of a direction that is left free is -SCALE lambda and has no rate
    assert power == pytest.approx(float(lam @ rate) + spring + lost, rel=1e-7, abs=1e-9)
    assert abs(power) > 1e-3


def test_slider_forces_are_in_balance():
    """Forces and moments of a slider sum to zero, with its extension and its arm."""
    system = random_state("slider")
    asm = system.assembly
    asm.condense(SHIFT)
    rows = asm.block_rows(next(b for b in asm.bound_blocks if b.block.name == "joints"), 0.0)[0]
    index = next(b for b in asm.bound_blocks if b.block.name == "joints").index[0]
    moment, force = np.zeros(3), np.zeros(3)
    for at in (0, 7):
        r, v = asm.x[index[at : at + 3]], asm.x[index[at + 3 : at + 6]]
        F, G, m = rows[at : at + 3], rows[at + 3 : at + 6], rows[at + 6]
        force += F
        moment += np.cross(r, F) + np.cross(v, G) + m * v / np.linalg.norm(v)
    assert np.abs(force).max() < 1e-13 * np.abs(rows[:14]).max()
    assert np.abs(moment).max() < 1e-13 * np.abs(rows[:14]).max()
