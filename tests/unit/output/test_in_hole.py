"""Offsets of points from the hole's axis, towards the high side and to the right, by hand."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from drillpetsc.geometry.well import StraightAxis, Well
from drillpetsc.output.measured.in_hole import measured_depth, measured_depths, offsets
from tests.helpers.tables import each_row


def straight(inclination: float, azimuth: float) -> Any:
    """A model with a straight hole from the origin."""
    angles = [inclination] * 2, [azimuth] * 2
    well = Well.from_survey([0.0, 100.0], *angles, [100.0], [0.1], [0.0])
    return SimpleNamespace(axis=well)


@each_row("azimuth", [0.0, 0.7, 3.0])
@each_row("inclination", [0.05, 1.0, np.pi / 2])
def test_offsets_in_an_inclined_hole(inclination, azimuth):
    """t = (sin I cos A, sin I sin A, cos I): the high side is (cos I cos A, cos I sin A, -sin I), the right (-sin A,
    cos A, 0) (manual: eq-conv-high-side)."""
    s, c, north, east = np.sin(inclination), np.cos(inclination), np.cos(azimuth), np.sin(azimuth)
    along, high, right = np.array([[s * north, s * east, c], [c * north, c * east, -s], [-east, north, 0.0]])
    given = np.array([[0.01, -0.02], [0.0, 0.03], [-0.04, 0.0], [0.005, 0.005]])
    depth = np.array([5.0, 20.0, 60.0, 95.0])
    points = depth[:, None] * along + given[:, :1] * high + given[:, 1:] * right
    assert offsets(straight(inclination, azimuth), points) == pytest.approx(given, abs=1e-13)
    assert [measured_depth(straight(inclination, azimuth), p) for p in points] == pytest.approx(list(depth))


def test_offsets_in_a_vertical_hole_are_north_and_east():
    points = np.array([[0.01, -0.02, 30.0], [-0.03, 0.0, 40.0]])
    assert np.array_equal(offsets(straight(0.0, 0.4), points), points[:, :2])


def test_no_points():
    assert offsets(straight(0.3, 0.0), np.zeros((0, 3))).shape == (0, 2)


def test_a_string_without_a_hole_lies_along_a_straight_line():
    """The same places as in a straight hole; above its start the line goes on."""
    hole, points = straight(0.6, 0.9), np.array([[3.0, 1.0, 20.0], [10.0, 20.0, 30.0]])
    start, direction, _ = hole.axis.at(np.zeros(1))
    line = SimpleNamespace(axis=StraightAxis(start[0], direction[0]))
    assert offsets(line, points) == pytest.approx(offsets(hole, points), abs=1e-12)
    assert measured_depths(line, points) == pytest.approx(measured_depths(hole, points))
    assert measured_depth(line, start[0] - 5.0 * direction[0]) == pytest.approx(-5.0)
