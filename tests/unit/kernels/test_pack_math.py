"""Sine and cosine of four numbers side by side, against numpy in extended precision."""

import numpy as np
import pytest

from drillpetsc.kernels import function, pointer

ROUNDING = 2 * np.finfo(float).eps  # relative: two units in the last place


@pytest.mark.parametrize("size", [1e-8, 1.0, 1e3, 5e8])
def test_sines_and_cosines_are_exact_to_rounding(size):
    """Angles up to ``size`` [rad]: a string that turns at 300 rpm for half a year has 5e8."""
    angles = np.random.default_rng(3).uniform(-size, size, 40_000)
    sine, cosine = np.empty_like(angles), np.empty_like(angles)
    function("sines_of_packs", "ippp")(len(angles), *map(pointer, (angles, sine, cosine)))
    exact = angles.astype(np.longdouble)
    assert np.abs(sine / np.sin(exact) - 1).max() < ROUNDING
    assert np.abs(cosine / np.cos(exact) - 1).max() < ROUNDING


def test_special_angles():
    angles = np.array([0.0, np.pi / 2, np.pi, -np.pi / 2, np.inf, -np.inf, np.nan, 2 * np.pi])
    sine, cosine = np.empty_like(angles), np.empty_like(angles)
    function("sines_of_packs", "ippp")(len(angles), *map(pointer, (angles, sine, cosine)))
    assert sine[:4] == pytest.approx([0.0, 1.0, 0.0, -1.0], abs=1e-15)
    assert cosine[:4] == pytest.approx([1.0, 0.0, -1.0, 0.0], abs=1e-15)
    assert np.isnan(sine[4:7]).all() and np.isnan(cosine[4:7]).all() and cosine[7] == 1.0
