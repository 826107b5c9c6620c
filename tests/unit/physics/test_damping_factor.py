"""The damping that gives an impact its restitution, from nearly plastic to nearly elastic."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drillpetsc.physics.contact import damping_factor
from tests.helpers.tables import each_row


@pytest.mark.parametrize(
    "restitution", [1e-3, 0.02, 0.0269, 0.0271, 0.1, 0.5, 0.9, 0.99, 0.9998, 0.99995, 1 - 1e-9]
)
def test_an_impact_returns_its_restitution(restitution: float) -> None:
    """Independent integration of m x'' = -k x (1 + c x') from x = 0, x' = 1 m/s until the force is over, with
    m = k = 1.

    The energy lost is 1 - e^2 of what was there; near e = 1 it is the integral of c x x'^2, which keeps its
    digits.
    """
    c = damping_factor(restitution, 1.0)

    def rates(t: float, state: np.ndarray) -> list[float]:
        x, v, _ = state
        return [v, -x * (1 + c * v), c * x * v * v]

    def over(t: float, state: np.ndarray) -> float:
        return float(state[0]) if t > 0 else 1.0

    over.terminal, over.direction = True, -1  # type: ignore[attr-defined]
    method = "Radau" if c > 10 else "DOP853"
    end = solve_ivp(rates, (0, 1e6), [0.0, 1.0, 0.0], method=method, events=over, rtol=1e-11, atol=1e-14)
    lost = 2 * end.y[2, -1]
    assert lost == pytest.approx(1 - restitution**2, rel=1e-6)
    assert -end.y[1, -1] == pytest.approx(restitution, rel=1e-4)


@each_row("restitution", [0.02, 0.6, 0.99999])
def test_a_slower_impact_is_damped_by_as_much_more(restitution: float) -> None:
    assert damping_factor(restitution, 0.1) == pytest.approx(10 * damping_factor(restitution, 1.0), rel=1e-12)


def test_every_restitution_has_a_damping_that_falls_with_it() -> None:
    e = np.unique(
        np.concatenate([np.geomspace(1e-3, 1, 2000, endpoint=False), 1 - np.geomspace(1e-15, 0.5, 2000)])
    )
    found = np.array([damping_factor(x, 1.0) for x in e])
    assert (
        (np.diff(found) < 1e-9 * found[:-1]).all()
        and found[-1] > 0
        and math.isclose(found[0], 1e3, rel_tol=1e-6)
    )
