"""Steps with drag in place of inertia: exact Jacobian, and the motion that they follow (manual: sec-statics-path)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.solvers.static.overdamped import Drag, OverdampedMotion
from tests.helpers.component_models import build, curved_tangents, dense
from tests.helpers.tables import each_row

DT = 0.4


def motion(kind: str, speed: float, slip: float = 0.5, turning: float = 0.0) -> OverdampedMotion:
    """Motion of a string of ``kind`` whose friction is that of a hole that moves by ``speed`` [m/s], or against a string
    that also turns with ``turning`` [rad/s]."""
    system = build(kind)
    for component in system.components:
        if turning:
            component.impose_sliding_direction(speed, turning, 0.0)
        else:
            component.follow_overdamped_motion(speed, slip)
    drag = Drag(30.0, 0.1, curved_tangents(5))
    return OverdampedMotion(system, drag, np.full(5, 0.05), lambda x, p, factor: x + factor * p)


@each_row(("speed", "turning"), [(0.0, 0.0), (0.7, 0.0), (-2.0, 0.0), (0.0, 2.0), (0.4, -3.0)])
@each_row("kind", ["contact", "contact_hertz_stribeck", "contact_junction_bodies_bit"])
def test_the_jacobian_matches_central_differences(kind: str, speed: float, turning: float) -> None:
    """Of drag, contact, friction past a moving hole or of a turning string, and stiffness, against fourth-order
    differences."""
    moving = motion(kind, speed, turning=turning)
    asm, n = moving.system.assembly, moving.system.layout.size
    x0 = asm.x[:n].copy()
    start = x0 - 0.05 * np.random.default_rng(7).standard_normal(n)

    def rows(x: np.ndarray) -> np.ndarray:
        asm.x[:n] = x
        return moving.rows(start, 1 / DT)

    h, F = 1e-4, np.zeros((n, n))
    for j in range(n):
        e = np.zeros(n)
        e[j] = h
        r = [rows(x0 + k * e) for k in (-2, -1, 1, 2)]
        F[:, j] = (r[0] - 8 * r[1] + 8 * r[2] - r[3]) / (12 * h)
    rows(x0)
    moving._matrix(1 / DT)
    J = dense(moving.system)
    scale = np.abs(J).max()
    assert np.abs(J - F).max() < 3e-7 * scale
    if speed or turning:  # and the friction is seen by the check
        for component in moving.system.components:
            component.follow_overdamped_motion(0.0, 0.5)
        rows(x0)
        moving._matrix(1 / DT)
        assert np.abs(J - dense(moving.system)).max() > 1e-4 * scale


def test_the_work_of_the_drag_is_that_of_the_velocity() -> None:
    """Rows of a step minus those of the state at rest, along the motion: h c (v_across^2 + s v_along^2) / dt."""
    moving = motion("beam", 0.0)
    asm, n = moving.system.assembly, moving.system.layout.size
    end = asm.x[:n].copy()
    moved = np.zeros(n)
    dofs = moving.system.layout.dofs["string.position"]
    moved[dofs] = np.random.default_rng(5).standard_normal((5, 3))
    at_rest = moving.rows(end, 1 / DT)
    with_drag = moving.rows(end - moved, 1 / DT)
    h = np.array([0.5, 1.0, 1.0, 1.0, 0.5])
    t = curved_tangents(5)
    along = np.einsum("ij,ij->i", moved[dofs], t)
    across = np.einsum("ij,ij->i", moved[dofs], moved[dofs]) - along**2
    expected = 30.0 / DT * float(h @ (across + 0.1 * along**2))
    assert float((with_drag - at_rest) @ moved) == pytest.approx(expected, rel=1e-12)
