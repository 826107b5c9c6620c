"""Steps with drag in place of inertia: exact Jacobian, and the motion that they follow (manual: sec-statics-path)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.solvers.static.static_newton import Drag, StaticNewton
from tests.helpers.component_models import build, dense
from tests.helpers.tables import each_row

DT = 0.4
DRAG = Drag(30.0 / DT, 0.1, 0.1, 1 / DT)


def motion(kind: str, speed: float, slip: float = 0.5, turning: float = 0.0) -> StaticNewton:
    """Solver of a string of ``kind`` whose friction is that of a hole that moves by ``speed`` [m/s], or against a string
    that also turns with ``turning`` [rad/s]."""
    system = build(kind)
    for component in system.components:
        if turning:
            component.impose_sliding_direction(speed, turning, 0.0)
        else:
            component.follow_overdamped_motion(speed, slip)
    return StaticNewton(system, clearance=0.05)


@each_row(("speed", "turning"), [(0.0, 0.0), (0.7, 0.0), (-2.0, 0.0), (0.0, 2.0), (0.4, -3.0)])
@each_row("kind", ["contact", "contact_hertz_stribeck", "contact_junction_bodies_bit"])
def test_the_jacobian_matches_central_differences(kind: str, speed: float, turning: float) -> None:
    """Of drag, contact, friction past a moving hole or of a turning string, and stiffness, against fourth-order
    differences."""
    moving = motion(kind, speed, turning=turning)
    asm, n = moving.system.assembly, moving.system.layout.size
    x0, c = asm.x[:n].copy(), moving._spin_potential()
    asm.x[:n] = x0 - 0.05 * np.random.default_rng(7).standard_normal(n)
    with moving.drag(DRAG):

        def rows(x: np.ndarray) -> np.ndarray:
            asm.x[:n] = x
            r = moving.rows()
            for (phi, v), q in zip(asm.spin_at[:, :2], c, strict=True):
                r[v : v + 3] += q * r[phi]  # the rows of v are those at constant spin angle
            return r + moving.drag_force()

        h, F = 1e-4, np.zeros((n, n))
        for j in range(n):
            e = np.zeros(n)
            e[j] = h
            r = [rows(x0 + k * e) for k in (-2, -1, 1, 2)]
            F[:, j] = (r[0] - 8 * r[1] + 8 * r[2] - r[3]) / (12 * h)
        rows(x0)
        moving._stiffness()
        J = dense(moving.system)
        scale = np.abs(J).max()
        assert np.abs(J - F).max() < 3e-7 * scale
        if speed or turning:  # and the friction is seen by the check
            for component in moving.system.components:
                component.follow_overdamped_motion(0.0, 0.5)
            rows(x0)
            moving._stiffness()
            assert np.abs(J - dense(moving.system)).max() > 1e-4 * scale


def test_the_work_of_the_drag_is_that_of_the_velocity() -> None:
    """Force of the drag of a step, along the motion: h c (v_across^2 + s v_along^2) / dt."""
    moving = motion("beam", 0.0)
    asm, dofs = moving.system.assembly, moving.system.layout.dofs["string.position"]
    moved = np.random.default_rng(5).standard_normal((5, 3))
    t = moving.system.field("string.tangent")
    t = t / np.linalg.norm(t, axis=1, keepdims=True)
    with moving.drag(DRAG):
        asm.x[dofs] += moved
        work = float(np.sum(moving.drag_force()[dofs] * moved))
    along = np.einsum("ij,ij->i", moved, t)
    across = np.einsum("ij,ij->i", moved, moved) - along**2
    h = np.array([0.5, 1.0, 1.0, 1.0, 0.5])
    assert work == pytest.approx(30.0 / DT * float(h @ (across + 0.1 * along**2)), rel=1e-12)
