"""Components of the ANCF element on the unknowns of the quaternion element: exact Jacobian, and the same
power as on their own unknowns (manual: sec-quaternion-view)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.statics.quaternion_statics import copy_ancf_state
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.contact import Contact
from drillpetsc.physics.end_conditions import TopDrive
from drillpetsc.physics.quaternion.beam import QuaternionBeam
from tests.component import test_bit, test_hermite_flow
from tests.component.test_quaternion_beam import on_the_manifold
from tests.helpers import component_models, flow_models
from tests.helpers.component_models import GRAVITY, SHIFT, both_jacobians
from tests.helpers.joint_models import random_state
from tests.helpers.tables import each_row

T = 0.4
STRING = ["bodies", "contact_bodies_bit", "bodies_junction"]
MUD = [
    "pipe_annulus_bit", "pipe_bit", "annulus_bit", "pipe_annulus_bit_drilled", "annulus_bit_drilled",
    "pipe_annulus_bit_junction",
]  # fmt: skip
BIT = ["rop", "drag", "weakening_byweight"]
HERMITE = ["pipe_annulus_bit", "pipe_bit_junction", "annulus_bit_junction"]
JOINT = ["revolute", "slider"]
KINDS = [*STRING, *MUD, *BIT, *(f"hermite {k}" for k in HERMITE), *(f"joint {k}" for k in JOINT)]


def reference(kind: str) -> DiscreteSystem:
    """The model of the ANCF element's own tests."""
    if kind in BIT:
        return test_bit.build(kind)[0]
    if kind.startswith("hermite "):
        return test_hermite_flow.build(kind.split(" ")[1])
    if kind.startswith("joint "):
        return random_state(kind.split(" ")[1])
    return (flow_models if kind in MUD else component_models).build(kind)


def pair(kind: str, seed: int = 2) -> tuple[DiscreteSystem, DiscreteSystem]:
    """ANCF and quaternion model in the same state and motion: rates with |q| = 1, accelerations of the slopes
    to match."""
    one, twin = reference(kind), reference(kind)
    components = [r for r in twin.components if not isinstance(r, (AncfBeam, TopDrive, Contact))]
    other = DiscreteSystem(
        twin.mesh, twin.frames, [QuaternionBeam(twin.mesh, twin.frames, GRAVITY), *components]
    )
    copy_ancf_state(one, other)
    asm, rng = other.assembly, np.random.default_rng(seed)
    asm.v0[:], asm.v1[:] = 0.3 * rng.standard_normal((2, len(asm.v0))) - SHIFT * np.array(
        [asm.x[: len(asm.v0)], 0 * asm.v0]
    )
    asm.condense(SHIFT)
    on_the_manifold(other)
    x, y, a, h = asm.x.copy(), asm.y.copy(), asm.a.copy(), 1e-5
    seen = []
    for k in (-1, 1, 0):
        asm.x[:], asm.y[:] = x + k * h * y + 0.5 * (k * h) ** 2 * a, y + k * h * a
        asm.derive(asm)
        seen.append(asm.y.copy())
    view, n, own = other.layout.derived, other.layout.size, one.assembly
    for f in one.layout.fields:
        here, there = one.layout.dofs[f.name], other.layout.dofs_of(f.name)
        keep = here >= 0
        rate = (seen[1][there[keep]] - seen[0][there[keep]]) / (2 * h)
        own.x[here[keep]], own.y[here[keep]] = asm.x[there[keep]], asm.y[there[keep]]
        own.a[here[keep]] = rate if f.name in view else a[there[keep]]
    assert n < len(asm.x)
    return one, other


@each_row("kind", KINDS)
def test_power_is_that_of_the_ancf_element(kind):
    """Sum of row times rate of every element of every component: the adapter expresses the same forces in
    other unknowns."""
    one, other = pair(kind)
    compared = 0
    for b in other.assembly.bound_blocks:
        if not b.block.kernel.startswith("quaternion_") or b.block.name.startswith("beam"):
            continue
        twin = next(q for q in one.assembly.bound_blocks if q.block.name == b.block.name)
        assert b.block.kernel == f"quaternion_{twin.block.kernel}" and b.count == twin.count > 0
        quaternion_rows = other.assembly.block_rows(b, T), other.assembly.y[b.index]
        ancf_rows = one.assembly.block_rows(twin, T), one.assembly.y[twin.index]
        nodes = 2 if b.block.on == "cell" else 1
        total = [
            np.sum(rows[:, : width * nodes] * y[:, : width * nodes], axis=1)
            for (rows, y), width in ((quaternion_rows, 8), (ancf_rows, 7))
        ]
        assert total[0] == pytest.approx(total[1], rel=2e-7, abs=2e-7 * np.abs(ancf_rows[0]).max())
        assert quaternion_rows[0][:, 8 * nodes :] == pytest.approx(
            ancf_rows[0][:, 7 * nodes :], rel=1e-7, abs=1e-7 * np.abs(ancf_rows[0]).max()
        )
        compared += 1
    assert compared >= 1


@each_row("kind", KINDS)
def test_jacobian_matches_central_differences(kind):
    """K + shift C + shift^2 M of all rows against fourth-order differences, also for |q| != 1. Steps of 4e-6,
    because one flow of the annulus is close to reversal."""
    _, system = pair(kind)
    h = 4e-6
    at = system.layout.dofs["string.quaternion"]
    system.assembly.x[at] *= np.linspace(0.97, 1.03, 5)[:, None]
    J, F = both_jacobians(system, T, h)
    names = np.array([f.name for f in system.layout.fields])[system.layout.field_of]
    length = names == "string.multiplier"
    for rows in (length, ~length):
        size = np.abs(J[rows]).max(axis=1, keepdims=True) + 1e-9 * np.abs(J[rows]).max()
        assert (np.abs(J[rows] - F[rows]) / np.maximum(size, 1e-3 * np.abs(J[rows]).max())).max() < 1e-5


def test_results_are_those_of_the_ancf_element():
    """Results, energies and powers of a component are those of the ANCF model in the same state."""
    one, other = pair("pipe_annulus_bit")
    pairs = [(r, q) for r in one.components for q in other.components if type(r) is type(q)]
    assert len(pairs) == 3
    for twin, component in pairs:
        assert list(component.energies(T, other.assembly)) == pytest.approx(
            list(twin.energies(T, one.assembly)), rel=1e-9
        )
        assert list(component.powers(T, other.assembly)) == pytest.approx(
            list(twin.powers(T, one.assembly)), rel=1e-9
        )
