"""Component contract of the agitator: exact Jacobian, and its power against the work of its rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.string_mesh import StringJoint
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.physics.beam import AncfBeam
from drillpetsc.physics.joints import Joints
from drillpetsc.physics.tools.agitator import Agitator, Valve
from drillpetsc.time_function import Constant
from tests.helpers.component_models import GRAVITY, SHIFT, both_jacobians, curved_tangents, mesh_for


def build(square: bool, seed: int = 5) -> DiscreteSystem:
    rng = np.random.default_rng(seed)
    mesh = replace(
        mesh_for("beam"),
        upper=np.array([0, 1, 2, 2.0]),
        lower=np.array([1, 2, 2, 3.0]),
        node_depth=np.array([0, 1, 2, 2, 3.0]),
        joints=(StringJoint(2.0, "slider", 2, spring=3.0),),
    )
    tangents = curved_tangents(5)
    frames = transported_frames(tangents)
    agitator = Agitator(mesh, 2, Valve(0.7, 3.0, 0.4, square), Constant(0.9))
    system = DiscreteSystem(mesh, frames, [AncfBeam(mesh, frames, GRAVITY), Joints(mesh, frames), agitator])
    position = np.cumsum(np.vstack([[0, 0, 0], tangents[:-1]]), axis=0)
    system.set_field("string.position", position + 0.1 * rng.standard_normal((5, 3)))
    system.set_field("string.tangent", tangents + 0.1 * rng.standard_normal((5, 3)))
    system.set_field("agitator.angle", np.full((5, 1), 0.4))
    asm = system.assembly
    asm.v0[:], asm.v1[:] = rng.standard_normal(len(asm.v0)), rng.standard_normal(len(asm.v1))
    return system


@pytest.mark.parametrize("square", [False, True])
def test_jacobian_matches_differences(square):
    system, t = build(square), 0.4
    J, F = both_jacobians(system, t, 1e-4)
    assert np.abs((J - F) / (np.abs(J).max(axis=1, keepdims=True) + 1.0)).max() < 1e-6


@pytest.mark.parametrize("square", [False, True])
def test_rows_do_the_work_that_is_reported(square):
    """y.R of the tool's rows is the power that it supplies, with the opposite sign."""
    system = build(square)
    asm = system.assembly
    asm.condense(SHIFT)
    agitator = next(c for c in system.components if isinstance(c, Agitator))
    bound = next(b for b in asm.bound_blocks if b.block.name == "agitator")
    rows = asm.block_rows(bound, 0.0)[0][:14]
    power = agitator.powers(0.0, asm).supplied
    assert abs(power) > 1e-3
    assert rows @ asm.y[bound.index[0]][:14] == pytest.approx(-power, rel=1e-12)
