"""The estimate of the local error of BDF against hand-computed values."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.solvers.time.local_error import local_error_weights
from tests.helpers.tables import each_row


@each_row(("order", "share"), [(1, 1 / 2), (2, 2 / 9), (3, 3 / 22)])
def test_equal_steps(order, share):
    """x = t^(k+1): local error share h^(k+1) x^(k+1)(t), share 1/((k + 1) sum of 1/j, j = 1..k) (Hairer,
    Norsett, Wanner I, III.2)."""
    h = 0.1
    times = [1.0 + h * i for i in range(order + 2)]
    derivative = float(np.prod(np.arange(1, order + 2)))
    e = local_error_weights(times, order) @ np.array([[t ** (order + 1), 0.0, t**order] for t in times])
    assert e == pytest.approx([share * h ** (order + 1) * derivative, 0.0, 0.0], abs=1e-12)


def test_unequal_steps_of_bdf2():
    """x = t^3, x' exact at the last of the times 0, .1, .3, .6: BDF2 from exact .1 and .3 gives x_n = (x' -
    w1 x1 - w2 x2)/w0, w the weights of the derivative of the parabola; the estimate is x(.6) - x_n but for
    its sign."""
    t = [0.0, 0.1, 0.3, 0.6]
    w2 = (0.6 - 0.3) / ((0.1 - 0.3) * (0.1 - 0.6))
    w1 = (0.6 - 0.1) / ((0.3 - 0.1) * (0.3 - 0.6))
    w0 = 1 / (0.6 - 0.3) + 1 / (0.6 - 0.1)
    step = (3 * 0.6**2 - w1 * 0.3**3 - w2 * 0.1**3) / w0
    e = local_error_weights(t, 2) @ np.array([[q**3] for q in t])
    assert abs(e[0]) == pytest.approx(abs(0.6**3 - step), rel=1e-12)
