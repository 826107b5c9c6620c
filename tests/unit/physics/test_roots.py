"""The root finder against that of scipy, which it stands for."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from drillpetsc.physics.roots import bracketed_root
from tests.helpers.tables import each_row

EPSILON = np.finfo(float).eps

FUNCTIONS = [
    (lambda x: x**3 - 2 * x - 5, 2.0, 3.0), (lambda x: math.cos(x) - x, 0.0, 1.0),
    (lambda x: math.exp(x) - 1e3, -10.0, 30.0), (lambda x: math.atan(50 * (x - 0.3)), -1.0, 7.0),
    (lambda x: x**3 + x, -1.0, 1.7), (lambda x: x - 0.25, 0.25, 1.0), (lambda x: (x > 0.1) - 0.5, 0.0, 1.0),
]  # fmt: skip


@each_row(("f", "left", "right"), FUNCTIONS)
@each_row("tolerances", [(2e-12, 4 * EPSILON), (1e-14, 1e-14), (1e-3, 1e-3)])
def test_the_root_of_scipy_to_the_last_bit(f, left, right, tolerances):
    absolute, relative = tolerances
    expected = brentq(f, left, right, xtol=absolute, rtol=relative)
    assert bracketed_root(f, left, right, absolute, relative) == expected
    assert bracketed_root(f, right, left, absolute, relative) == brentq(
        f, right, left, xtol=absolute, rtol=relative
    )


@each_row("e", np.linspace(0.03, 0.999, 57))
def test_the_root_of_the_impact_law(e):
    """d (1 + e) = ln((1 + d) / (1 - d e)) as in the damping factor of contact."""

    def miss(d: float) -> float:
        return float(np.log1p(d) - np.log1p(-d * e) - d * (1 + e))

    ends = 0.5 * (1 - e), (1 - 1e-14) / e
    assert bracketed_root(miss, *ends, 1e-14, 1e-14) == brentq(miss, *ends, xtol=1e-14, rtol=1e-14)


def test_ends_of_one_sign_are_refused():
    with pytest.raises(ValueError, match="same sign"):
        bracketed_root(lambda x: x * x + 1, -1.0, 1.0)
