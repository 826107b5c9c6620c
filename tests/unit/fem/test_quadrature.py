"""Places of contact along an element: exactness of the rules, and which ends stand out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import roots_jacobi

from drillpetsc.fem.quadrature import _TABULATED, exposed_ends, rule
from drillpetsc.fem.string_mesh import RigidItem
from tests.helpers.tables import each_row
from tests.helpers.uniform_string import uniform_string


@each_row("points", [1, 2, 3, 8])
@each_row("upper", [False, True])
@each_row("lower", [False, True])
def test_rules_integrate_polynomials(points, upper, lower):
    """Integral of s^k over 0..1 is 1/(k + 1) up to k = 2 points - 1; with an end it is a place."""
    s, w = rule(points, upper, lower).T
    assert len(s) == points + (upper or lower)
    for k in range(2 * points):
        assert w @ s**k == pytest.approx(1 / (k + 1), rel=1e-12)
    assert (s.min() == 0.0, s.max() == 1.0) == (upper, lower)
    assert (np.diff(s) > 0).all() and (w > 0).all()


@each_row("key", list(_TABULATED))
def test_tabulated_rules_are_those_of_scipy(key):
    for own, published in zip(_TABULATED[key], roots_jacobi(*key), strict=True):
        assert np.array(own) == pytest.approx(published, rel=1e-15, abs=1e-16)


def test_known_rules():
    """Abramowitz and Stegun table 25.6 (Lobatto, three points: Simpson's rule); Radau of two points: 1/3 and
    1 with 3/4 and 1/4."""
    assert rule(2, True, True) == pytest.approx(np.array([[0, 1 / 6], [0.5, 4 / 6], [1, 1 / 6]]), abs=1e-14)
    assert rule(1, False, True) == pytest.approx(np.array([[1 / 3, 0.75], [1, 0.25]]), abs=1e-14)
    assert rule(1, True, False) == pytest.approx(np.array([[0, 0.25], [2 / 3, 0.75]]), abs=1e-14)


def test_ends_that_stand_out():
    """Thick pieces beside thin ones, the free end; not the end that the drive holds, nor beside a thicker
    rigid item."""
    mesh = uniform_string(60.0, 6, outer_diameter=0.127)
    thick = mesh.outer_diameter.copy()
    thick[2:4] = 0.17
    mesh = replace(mesh, outer_diameter=thick, contact_diameter=thick)
    upper, lower = exposed_ends(mesh)
    assert np.flatnonzero(upper).tolist() == [2] and np.flatnonzero(lower).tolist() == [3, 5]
    body = RigidItem("stabilizer", "stabilizer", 4, 0.0, 1.0, 100.0, 0.5, (0.0, 0.0), 1.0, 1.0, 0.1)
    bit = replace(body, node=6, radius=0.11)
    upper, lower = exposed_ends(replace(mesh, bodies=(body, bit)))
    assert np.flatnonzero(upper).tolist() == [2] and not lower.any()
    crossover = replace(body, radius=0.05)  # a thin item between the pipe above and the stabilizer
    _, lower = exposed_ends(replace(mesh, bodies=(crossover, body, bit)))
    assert np.flatnonzero(lower).tolist() == [3]
    assert exposed_ends(mesh, free_top=True)[0][0] and not exposed_ends(mesh)[0][0]


@each_row(
    ("touching", "middle"),
    [
        (None, -1.25),  # of the item, from 3 m above the node to 0.5 m below it
        ((-2.5, 1.0), -2.0),  # of its blades
        ((0.5, 0.0), -1.25),  # a bit touches at its end, and its forces stand in its middle
    ],
)
def test_forces_of_a_rigid_item_are_reported_in_its_middle(touching, middle):
    item = RigidItem("item", "bit", 6, -3.0, 3.5, 100.0, 0.0, (0.0, 0.0), 1.0, 1.0, 0.1, touching=touching)
    assert item.middle == pytest.approx(middle, rel=1e-12)
