"""Pads of a steerable tool push the string towards the commanded tool face (manual: eq-steering-push)."""

from __future__ import annotations

import numpy as np
import pytest

from tests.helpers.component_models import SHIFT, build, curved_tangents

TIME, NODE = 0.4, 2
#: of the tool in `component_models`: its command rises to 0.9 in 1 s and to 2 rad in 2 s, as half a cosine
SHARE, FORCE, FACE = 0.45 * (1 - np.cos(np.pi * TIME)), 5.0, 1 - np.cos(np.pi * TIME / 2)


def expected() -> np.ndarray:
    """(3,) force on the string: the tool face counts from the high side, clockwise seen down the hole."""
    axis = curved_tangents(5)[NODE]
    high = np.array([0.0, 0.0, -1.0]) + axis[2] * axis
    high /= np.linalg.norm(high)
    return SHARE * FORCE * (np.cos(FACE) * high + np.sin(FACE) * np.cross(axis, high))


def pushed(system) -> np.ndarray:
    """(3,) force on the string in the present state."""
    asm = system.assembly
    asm.condense(SHIFT)
    asm.residual(TIME)
    block = next(b for b in asm.bound_blocks if b.block.kernel == "push_pads")
    return -asm.block_rows(block, TIME)[0][:3]


def test_pads_that_stand():
    assert pushed(build("pads")) == pytest.approx(expected(), abs=1e-12)


def test_pads_that_turn():
    """The mean over a turn of a pipe along the hole's axis; the force of one position of the pads differs."""
    system = build("pads_turning")
    spin = system.layout.dofs["string.spin"][NODE, 0]
    system.assembly.x[system.layout.dofs["string.tangent"][NODE]] = curved_tangents(5)[NODE]
    forces = []
    for angle in np.linspace(0, 2 * np.pi, 720, endpoint=False):
        system.assembly.x[spin] = angle
        forces.append(pushed(system))
    assert np.mean(forces, axis=0) == pytest.approx(expected(), abs=1e-4 * SHARE * FORCE)
    assert np.ptp(forces, axis=0).max() > 0.05 * SHARE * FORCE
