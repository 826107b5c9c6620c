"""Volume and first moment of the hole between two depths."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.geometry.well import Well
from drillpetsc.physics.fluid.channels import HoleVolume


def test_moment_of_a_hole_that_narrows():
    """A step D of the area at x in an interval of the length l takes D x (l - x)/2 to its upper part; a transition by small slices."""
    straight = np.zeros(3)
    well = Well.from_survey(
        np.array([0.0, 100.0, 200.0]), straight, straight, [50.0, 200.0], [0.3, 0.2], [0.2, 0.2]
    )
    hole, upper, lower = (
        HoleVolume(well),
        np.array([20.0, 40.0, 49.8, 60.0]),
        np.array([30.0, 65.0, 50.4, 61.0]),
    )
    found = hole.moment(upper, lower)
    for a, b, moment in zip(upper, lower, found, strict=True):
        z = a + (b - a) * (np.arange(200000) + 0.5) / 200000
        assert moment == pytest.approx(float(np.mean(hole.area(z) * (z - 0.5 * (a + b))) * (b - a)), abs=1e-9)
    step = np.pi * (0.3**2 - 0.2**2)
    assert found[1] == pytest.approx(-step * 10.0 * 15.0 / 2, rel=0.05)  # the transition is half a metre long
    assert found[0] == pytest.approx(0.0, abs=1e-12)
