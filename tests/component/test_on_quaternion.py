"""Rooms of the gauge element on the quaternion's unknowns: exact Jacobian, and the same power as on their own unknowns."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.quaternion_statics import take_over
from drillpetsc.fem.discrete_system import Model
from drillpetsc.physics.beam import Beam
from drillpetsc.physics.contact import Contact
from drillpetsc.physics.end_conditions import TopDrive
from drillpetsc.physics.quaternion.beam import QuaternionBeam
from tests.component import test_bit
from tests.component.test_quaternion_beam import on_the_manifold
from tests.helpers import flow_scenes, scenes
from tests.helpers.scenes import GRAVITY, SHIFT, dense, differences, residual

T = 0.4
STRING = ["bodies", "contact_bodies_bit"]
MUD = ["pipe_annulus_bit", "pipe_bit", "annulus_bit", "pipe_annulus_bit_drilled", "annulus_bit_drilled"]
BIT = ["rop", "drag", "weakening_byweight"]
KINDS = [*STRING, *MUD, *BIT]


def gauge(kind: str) -> Model:
    """The model of the gauge element's own tests."""
    if kind in BIT:
        return test_bit.build(kind)[0]
    return (flow_scenes if kind in MUD else scenes).build(kind)


def pair(kind: str, seed: int = 2) -> tuple[Model, Model]:
    """Gauge and quaternion model in the same state, moving alike: rates with |q| = 1, accelerations of the slopes to match."""
    one, twin = gauge(kind), gauge(kind)
    rooms = [r for r in twin.rooms if not isinstance(r, (Beam, TopDrive, Contact))]
    other = Model(twin.mesh, twin.frames, [QuaternionBeam(twin.mesh, twin.frames, GRAVITY), *rooms])
    take_over(one, other)
    asm, rng = other.assembly, np.random.default_rng(seed)
    asm.v0[:], asm.v1[:] = 0.3 * rng.standard_normal((2, len(asm.v0))) - SHIFT * np.array([asm.x[: len(asm.v0)], 0 * asm.v0])
    asm.condense(SHIFT)
    on_the_manifold(other)
    x, y, a, h = asm.x.copy(), asm.y.copy(), asm.a.copy(), 1e-5
    seen = []
    for k in (-1, 1, 0):
        asm.x[:], asm.y[:] = x + k * h * y + 0.5 * (k * h) ** 2 * a, y + k * h * a
        asm.look(asm)
        seen.append(asm.y.copy())
    view, n, own = other.layout.view, other.layout.size, one.assembly
    for f in one.layout.fields:
        here, there = one.layout.place[f.name], other.layout.where(f.name)
        keep = here >= 0
        rate = (seen[1][there[keep]] - seen[0][there[keep]]) / (2 * h)
        own.x[here[keep]], own.y[here[keep]] = asm.x[there[keep]], asm.y[there[keep]]
        own.a[here[keep]] = rate if f.name in view else a[there[keep]]
    assert n < len(asm.x)
    return one, other


@pytest.mark.parametrize("kind", KINDS)
def test_power_is_that_of_the_gauge_element(kind):
    """Sum of row times rate of every element of every room: the adapter only expresses the same forces in other unknowns."""
    one, other = pair(kind)
    compared = 0
    for b in other.assembly.ready:
        if not b.block.kernel.startswith("quaternion_") or b.block.name.startswith("beam"):
            continue
        mine = next(q for q in one.assembly.ready if q.block.name == b.block.name)
        assert b.block.kernel == f"quaternion_{mine.block.kernel}" and b.count == mine.count > 0
        theirs = other.assembly.block_rows(b, T), other.assembly.y[b.index]
        ours = one.assembly.block_rows(mine, T), one.assembly.y[mine.index]
        nodes = 2 if b.block.on == "cell" else 1
        total = [np.sum(rows[:, : width * nodes] * y[:, : width * nodes], axis=1) for (rows, y), width in ((theirs, 8), (ours, 7))]
        assert total[0] == pytest.approx(total[1], rel=2e-7, abs=2e-7 * np.abs(ours[0]).max())
        assert theirs[0][:, 8 * nodes :] == pytest.approx(ours[0][:, 7 * nodes :], rel=1e-7, abs=1e-7 * np.abs(ours[0]).max())
        compared += 1
    assert compared >= 1


@pytest.mark.parametrize("kind", KINDS)
def test_jacobian_matches_central_differences(kind):
    """K + shift C + shift^2 M of all rows against fourth-order differences; off the unit length, too.  Steps of 1e-5, as one flow of the
    annulus is close to where it turns."""
    _, model = pair(kind)
    n, h = model.layout.size, 1e-5
    at = model.layout.place["string.quaternion"]
    model.assembly.x[at] *= np.linspace(0.97, 1.03, 5)[:, None]
    x0 = model.assembly.x[:n].copy()
    residual(model, x0, T)
    model.assembly.jacobian(T, (1.0, SHIFT, SHIFT**2), condensed=True)
    J, F = dense(model), differences(model, x0, T, h)
    names = np.array([f.name for f in model.layout.fields])[model.layout.field_of]
    length = names == "string.multiplier"
    for rows in (length, ~length):
        size = np.abs(J[rows]).max(axis=1, keepdims=True) + 1e-9 * np.abs(J[rows]).max()
        assert (np.abs(J[rows] - F[rows]) / np.maximum(size, 1e-3 * np.abs(J[rows]).max())).max() < 1e-5


def test_rooms_are_asked_in_what_they_know():
    """Figures, energies and powers of a room are those of the gauge model in the same state."""
    one, other = pair("pipe_annulus_bit")
    pairs = [(r, q) for r in one.rooms for q in other.rooms if type(r) is type(q)]
    assert len(pairs) == 3
    for mine, theirs in pairs:
        assert list(theirs.energies(T, other.assembly)) == pytest.approx(list(mine.energies(T, one.assembly)), rel=1e-9)
        assert list(theirs.powers(T, other.assembly)) == pytest.approx(list(mine.powers(T, one.assembly)), rel=1e-9)
