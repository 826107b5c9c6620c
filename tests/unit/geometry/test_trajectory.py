"""Figures of a hole's path against closed forms, and the growing hole's nodes on an arc."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.trajectory import angles, dogleg, dogleg_severity, new_hole
from drillpetsc.geometry.well import Well, direction


def vertical(depth: float = 100.0) -> Well:
    return Well.from_survey([0.0, depth], [0.0, 0.0], [0.0, 0.0], [depth], [0.1], [0.3])


def arc(s: np.ndarray, radius: float, azimuth: float, depth: float = 100.0) -> tuple[np.ndarray, np.ndarray]:
    """Place and tangent (n, 3) on a circle that leaves the vertical hole at ``depth``, s metres below it."""
    a = s / radius
    across = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    place = radius * ((1 - np.cos(a))[:, None] * across + np.sin(a)[:, None] * [0, 0, 1.0]) + [0, 0, depth]
    return place, np.sin(a)[:, None] * across + np.cos(a)[:, None] * [0, 0, 1.0]


def test_dogleg_of_the_minimum_curvature_example():
    """(15, 20) to (25, 45) deg is a dogleg of 12.951651 deg, exact (manual: verif-minimum-curvature)."""
    one, two = direction(np.radians([15.0, 25.0]), np.radians([20.0, 45.0]))
    assert np.degrees(dogleg(one, two)) == pytest.approx(12.951651, abs=1e-6)
    severity = dogleg_severity([0.0, 100.0], [one, two])
    assert np.degrees(30 * severity[1]) == pytest.approx(3.8854952, abs=1e-6)


def test_angles_of_a_vertical_hole_and_across_north():
    inclination, azimuth = angles(
        [[0, 0, 1.0], *direction(np.radians([30.0, 30.0]), np.radians([355.0, 5.0]))]
    )
    assert np.degrees(inclination) == pytest.approx([0.0, 30.0, 30.0])
    assert np.degrees(azimuth) == pytest.approx([0.0, 355.0, 5.0])


def test_turn_rate_across_north_at_constant_inclination():
    """A turn of 10 deg at 30 deg inclination in 60 m: (A2 - A1) sin(I)/dS, and no build."""
    inclination, azimuth = np.radians([30.0, 30.0, 30.0]), np.radians([355.0, 355.0, 5.0])
    well = Well.from_survey([0.0, 100.0, 160.0], inclination, azimuth, [160.0], [0.1], [0.3])
    q = new_hole(well, 100.0)
    assert q.length == pytest.approx(60.0)
    assert np.degrees(q.turn_rate * 30) == pytest.approx(10 * np.sin(np.radians(30.0)) / 2, rel=1e-9)
    assert q.build_rate == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("step", [0.004, 0.11])
def test_growing_hole_follows_an_arc(step):
    """A hole drilled on a circle of 300 m: build rate 30/300 rad per 30 m; nodes and directions on the circle
    (closed form).

    The wall may follow only when the end has moved on by a millimetre; directions come from chords and a
    parabola, right to second order in the spacing of the nodes: (0.5 m)^2/(24 R^2) of their curvature.
    """
    radius, azimuth, half = 300.0, 0.7, 0.1
    hole = GrowingHole(vertical(), half, 0.12, 0.25)
    path = np.arange(step, 6.0, step)
    for drilled in path:
        behind = drilled - half
        place = (
            arc(np.array([behind]), radius, azimuth)[0][0] if behind > 0 else np.array([0, 0, 100.0 + behind])
        )
        hole.follow(drilled, place)
    nodes = hole.well.node_md[1:-1]
    new = nodes[nodes > 101.0] - 100.0  # nodes above lie across the jump of curvature
    place, tangent = arc(new, radius, azimuth)
    x, t, _ = hole.well.at(new + 100.0)
    assert len(new) >= 8
    assert np.abs(x - place).max() < 2e-6
    assert np.abs(t - tangent).max() < 1e-5
    q = new_hole(hole.whole_path(path[-1], arc(np.array([path[-1] - half]), radius, azimuth)[0][0]), 100.0)
    assert q.length == pytest.approx(path[-1])
    end = arc(np.array([path[-1] - half]), radius, azimuth)[1][0]
    assert q.inclination[1] == pytest.approx(angles(end)[0], abs=2e-5)
    assert q.azimuth[1] == pytest.approx(azimuth, abs=1e-3)
    assert hole.well.radius(104.0) == pytest.approx(0.12)
    assert hole.well.friction(104.0) == pytest.approx(0.25)


def test_holes_beside_another_grow_with_it():
    """Holes on circles of 300 m and 1e-6 more and less, as much longer: as many nodes, whose places differ as the circles do.

    By themselves they would grow at other steps, of which one has 1 mm.
    """
    azimuth, half, share = 0.7, 0.1, 1e-6

    def place(drilled: float, radius: float) -> np.ndarray:
        behind = drilled - half
        on_arc = arc(np.array([behind]), radius, azimuth)[0][0]
        return on_arc if behind > 0 else np.array([0, 0, 100.0 + behind])

    holes = [GrowingHole(vertical(), half, 0.12, 0.25) for _ in range(3)]
    leader, *beside = holes
    for hole in beside:
        hole.leader = leader
    for drilled in np.arange(1e-3, 3.0, 1e-3):
        grown = [
            hole.follow(drilled * (1 + q), place(drilled * (1 + q), 300.0 * (1 + q)))
            for hole, q in zip(holes, (0.0, -share, share), strict=True)
        ]
        assert len(set(grown)) == 1
    low, high = (hole.well for hole in beside)
    assert len(low.node_md) == len(high.node_md) == len(leader.well.node_md)
    assert len(low.section_to) == len(leader.well.section_to) == 2
    new = leader.well.node_md[:-1] > 101.0
    moved = (high.node_position - low.node_position)[:-1][new] / (2 * share)
    s = leader.well.node_md[:-1][new] - 100.0
    exact = (arc(s, 300.0 * (1 + share), azimuth)[0] - arc(s, 300.0 * (1 - share), azimuth)[0]) / (2 * share)
    assert np.abs(exact).max() > 5e-3
    assert moved == pytest.approx(exact, abs=5e-6)


def test_memory_brings_the_hole_back():
    hole = GrowingHole(vertical(), 0.1, 0.12, 0.25)
    for drilled in np.arange(0.01, 3.0, 0.01):
        hole.follow(drilled, arc(np.array([drilled]), 200.0, 0.3)[0][0] - [0, 0, 0.1])
    other = GrowingHole(vertical(), 0.1, 0.12, 0.25)
    other.set_state(hole.get_state())
    md = np.linspace(99.0, 103.0, 50)
    assert np.array_equal(other.well.at(md)[0], hole.well.at(md)[0])
    assert np.array_equal(other.direction, hole.direction)
    for one in (hole, other):
        one.follow(3.2, arc(np.array([3.2]), 200.0, 0.3)[0][0] - [0, 0, 0.1])
    assert np.array_equal(other.well.packed(), hole.well.packed())


def test_angles_do_not_depend_on_where_arrays_stand_in_memory():
    """The same bits in thousands of calls between other arrays: files of a restarted run are those of the uninterrupted one.  Of one
    call in eighty the last digit differed where numpy's vector unit has twice the usual width."""
    vectors = np.random.default_rng(1).standard_normal((13, 3))
    vectors /= np.linalg.norm(vectors, axis=1)[:, None]
    found, kept = set(), []
    for _ in range(4000):
        tangents = vectors.copy()
        result = angles(tangents)
        found.add(tuple(q.tobytes() for q in result))
        kept.append((tangents, result))
        if len(kept) > 200:
            del kept[::2]
    assert len(found) == 1


def test_rates_of_a_hole_that_builds_and_turns():
    """Build and turn rate between (20, 10) and (50, 40) deg over 100 m: 30 deg, and 30 deg times sin 35 deg (eq-borehole-rates)."""
    well = Well.from_survey(
        [0.0, 100.0, 200.0], *np.radians([[20.0, 20.0, 50.0], [10.0, 10.0, 40.0]]), [200.0], [0.1], [0.3]
    )
    found = new_hole(well, 100.0)
    assert found is not None
    assert np.degrees(found.build_rate) == pytest.approx(0.3)
    assert np.degrees(found.turn_rate) == pytest.approx(0.3 * np.sin(np.radians(35.0)))
