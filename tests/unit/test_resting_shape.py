"""Shape in which a string rests in its hole, against beams on an elastic bed (manual: eq-statics-resting-shape).

Closed forms: M. Hetenyi, Beams on Elastic Foundation, University of Michigan Press, 1946: decay of a long beam with
beta = (k/4EI)^(1/4).
"""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.statics.start.resting_shape import Beam, resting_shape

BENDING, BED, CLEARANCE = 1.3e6, 4.0e3, 0.044
BETA = (BED / (4 * BENDING)) ** 0.25


def beam(s, tension: float = 0.0, bed: float = BED, joint=()) -> Beam:
    n = len(s)
    ties = np.isin(np.arange(n - 1), joint)
    return Beam(np.diff(s), np.full(n - 1, BENDING), np.full(n - 1, tension), ties, np.full(n, bed))


def graded(elements: int) -> np.ndarray:
    """Depths from -150 to 150 m, shorter about 0."""
    half = np.linspace(0.0, 1.0, elements + 1) ** 1.5 * 150.0
    return np.concatenate([-half[:0:-1], half])


def wall_that_changes_side(s) -> np.ndarray:
    """A wall on one side above 0, on the other below; its mean in the element pair at 0."""
    return np.column_stack([CLEARANCE * np.sign(s), np.zeros(len(s))])


def test_string_crosses_the_hole_where_its_load_changes_side():
    """u = C sign(x) (1 - exp(-beta |x|) cos(beta x)); error of order h^2 by the bed at the nodes."""
    errors = []
    for elements in (50, 100, 200):
        s = graded(elements)
        u, _ = resting_shape(beam(s), wall_that_changes_side(s), np.zeros((len(s) - 1, 2)))
        exact = CLEARANCE * np.sign(s) * (1 - np.exp(-BETA * abs(s)) * np.cos(BETA * s))
        inner = abs(s) < 75
        errors.append(np.max(abs(u[inner, 0] - exact[inner])) / CLEARANCE)
        assert np.all(u[:, 1] == 0.0)
    assert errors[-1] < 1e-3
    assert np.log2(errors[0] / errors[2]) / 2 == pytest.approx(2.0, abs=0.4)


def test_string_eases_a_jump_of_the_holes_curvature():
    """Curvature kappa below 0: u = kappa/(4 beta^2) exp(-beta |x|) sin(beta x), u'' - (-kappa) has no jump."""
    kappa, s = 2.5e-3, graded(200)
    bend = np.column_stack([np.zeros(len(s) - 1), np.where(s[:-1] >= 0, kappa, 0.0)])
    u, slope = resting_shape(beam(s), np.zeros((len(s), 2)), bend)
    amplitude, x = kappa / (4 * BETA**2), BETA * s
    inner = abs(s) < 75
    exact = amplitude * np.exp(-abs(x)) * np.sin(x)
    rate = amplitude * BETA * np.exp(-abs(x)) * (np.cos(x) - np.sin(abs(x)))
    assert np.max(abs(u[inner, 1] - exact[inner])) < 2e-3 * amplitude
    assert np.max(abs(slope[inner, 1] - rate[inner])) < 4e-3 * amplitude * BETA
    assert np.all(u[:, 0] == 0.0)


def test_tension_alone_makes_a_straight_line():
    """500 kN and almost no bed: from the axis at the top the string is straight to where it is held at the lower end."""
    s = np.linspace(0.0, 400.0, 81)
    made = beam(s, 500e3, 1e-9)
    bed = made.bed.copy()
    bed[-1] = 1e8
    wall = np.zeros((81, 2))
    wall[-1] = (0.03, -0.01)
    u, slope = resting_shape(
        Beam(made.length, made.bending, made.tension, made.joint, bed), wall, np.zeros((80, 2))
    )
    layer = np.sqrt(BENDING / 500e3)  # in which the slope of the hole at the top becomes that of the line
    line = np.array([0.03, -0.01]) / (400.0 - layer)
    assert slope[0] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert slope[40] == pytest.approx(line, rel=1e-3)
    assert u[40] == pytest.approx(line * (200.0 - layer), rel=1e-3)


def test_pushes_do_not_make_it_unstable():
    """A push above the buckling load counts as no tension: the same shape as without."""
    s = graded(60)
    shapes = [
        resting_shape(beam(s, f), wall_that_changes_side(s), np.zeros((len(s) - 1, 2)))[0]
        for f in (0.0, -1e7)
    ]
    assert np.array_equal(shapes[0], shapes[1])


def test_joint_ties_its_nodes():
    s = np.concatenate([np.linspace(-100.0, 0.0, 41), np.linspace(0.0, 100.0, 41)])
    wall = wall_that_changes_side(np.concatenate([np.full(41, -1.0), np.full(41, 1.0)]))
    u, slope = resting_shape(beam(s, joint=[40]), wall, np.zeros((81, 2)))
    assert u[40] == pytest.approx(u[41], abs=1e-6)
    assert slope[40] == pytest.approx(slope[41], abs=1e-6)
    assert slope[40, 0] > 1e-3
