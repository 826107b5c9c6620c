"""Centreline, sections and closest points (manual: sec-verif-borehole)."""

import numpy as np
import pytest

from drillpetsc.geometry.well import Well
from drillpetsc.kernels import function, pointer
from tests.helpers.tables import each_row

DEG = np.pi / 180
FIELD = {
    "s": 0,
    "c": slice(1, 4),
    "t": slice(4, 7),
    "e": slice(7, 10),
    "n": slice(10, 13),
    "rho": 13,
    "radius": 14,
    "friction": 15,
}


def hole(md, inclination, azimuth=None, **kw):
    azimuth = [0.0] * len(md) if azimuth is None else azimuth
    sections = {"section_to": [md[-1]], "section_radius": [0.10795], "section_friction": [0.3]} | kw
    return Well.from_survey(md, np.multiply(inclination, DEG), np.multiply(azimuth, DEG), **sections)


def derivatives(well, x):
    """Values (n, 16) and derivatives (n, 16, 3) of the kernel's closest point by x, from forward-mode
    duals."""
    x = np.ascontiguousarray(x, dtype=float)
    n = len(x)
    segment, value, slope = np.full(n, -1, np.int32), np.empty((n, 16)), np.empty((n, 16, 3))
    packed = well.packed()
    p = [pointer(a) for a in (packed, x, segment, value, slope)]
    function("well_project_derivatives", "pipppp")(p[0], n, *p[1:])
    return value, slope


def gap(well, x, contact_radius=0.0635):
    """Gap function rho + R_o - R and its gradient (manual: eq-contact-depth)."""
    value, slope = derivatives(well, x)
    return value[:, FIELD["rho"]] + contact_radius - value[:, FIELD["radius"]], slope[
        :, FIELD["rho"]
    ] - slope[:, FIELD["radius"]]


def around(well, md, radius, angle):
    """Points at a distance (n,) [m] and angle from the axis, in the normal plane at md (n,)."""
    c, t, _ = well.at(md)
    a = np.cross(t, [0.3, -0.5, 0.8])
    a /= np.linalg.norm(a, axis=1, keepdims=True)
    b = np.cross(t, a)
    return c + radius[:, None] * (np.cos(angle)[:, None] * a + np.sin(angle)[:, None] * b)


def fourth_order(f, x, step):
    """Central difference of order 4: second order is too coarse for n, whose third derivative is 1/rho^3 (rho
    ~ 1 cm here).
    """
    return (8 * (f(x + step) - f(x - step)) - (f(x + 2 * step) - f(x - 2 * step))) / (12 * np.abs(step).max())


# ---------------------------------------------------------------- centreline
def test_minimum_curvature():
    """100 m from (15, 20) to (25, 45) deg: dN 27.218329, dE 19.450774, dTVD 94.012343 m, dogleg 12.951651
    deg, exact (manual: verif-minimum-curvature)."""
    well = hole([0, 100], [15, 25], [20, 45])
    x, t, kappa = well.at(np.array([0.0, 50.0, 100.0]))
    assert x[2] - x[0] == pytest.approx([27.218329, 19.450774, 94.012343], abs=1e-6)
    assert np.degrees(np.arccos(t[0] @ t[2])) == pytest.approx(12.951651, abs=1e-6)
    assert np.degrees(np.linalg.norm(kappa, axis=1)) * 30 == pytest.approx(3.8854952 * np.ones(3), abs=1e-6)
    assert well.inclination([0, 100]) / DEG == pytest.approx([15, 25]) and well.azimuth(
        [0, 100]
    ) / DEG == pytest.approx([20, 45])


def test_hermite_on_an_arc():
    """One 5 deg segment of radius 57.3 m: points of the circle lie within 1e-5 m of it, and measured depth is
    arc length (manual: verif-hermite-arc)."""
    radius, beta = 57.3, 5 * DEG
    well = hole([0, radius * beta], [0, 5], max_angle=1.0)
    assert len(well.node_md) == 2
    angle = np.linspace(0, beta, 41)
    circle = radius * np.stack([1 - np.cos(angle), 0 * angle, np.sin(angle)], axis=1)
    found = well.project(circle)
    assert np.abs(found.offset).max() < 1e-5
    assert found.md == pytest.approx(radius * angle, abs=1e-5)
    x, t, kappa = well.at(radius * angle)
    assert x == pytest.approx(circle, abs=1e-5)
    assert t == pytest.approx(np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1), abs=1e-5)
    assert np.linalg.norm(kappa, axis=1) * radius == pytest.approx(np.ones(41), abs=1e-3)


def test_gap_gradient_is_continuous_across_nodes():
    """Straight, then 30 deg/30 m: the gap's gradient does not jump at the nodes (< 1e-6 over 2e-9 m)."""
    well = hole([0, 50, 80, 120], [0, 0, 30, 30])
    inner = well.node_md[1:-1]
    n = len(inner)
    for angle in (0.0, 1.0, 2.5, 4.0):
        points = around(well, inner, np.full(n, 0.044), np.full(n, angle))
        _, t, _ = well.at(inner)
        above, below = (gap(well, points + side * 1e-9 * t)[1] for side in (-1, 1))
        assert np.abs(above - below).max() < 1e-6


def test_position_and_measured_depth_are_one_curve():
    """dc/ds from `at` is the unit tangent and dt/ds the curvature (central differences), at nodes too."""
    well = hole([0, 200, 260, 400, 500], [0, 0, 25, 60, 50], [0, 0, 40, 70, 10])
    s = np.r_[np.linspace(-5, 520, 400), well.node_md]
    h = 1e-4
    x1, x0 = well.at(s + h)[0], well.at(s - h)[0]
    _, t, kappa = well.at(s)
    assert (x1 - x0) / (2 * h) == pytest.approx(t, abs=1e-6)
    inside = np.min(np.abs(s[:, None] - well.node_md), axis=1) > 2 * h
    t1, t0 = well.at(s + h)[1], well.at(s - h)[1]
    assert ((t1 - t0) / (2 * h))[inside] == pytest.approx(kappa[inside], abs=1e-7)


def test_densification_and_straight_holes():
    """Arcs get nodes every <= 10 m and <= 2 deg; a vertical hole surveyed every 30 m keeps two."""
    arc = hole([0, 100, 200, 230], [0, 0, 8, 38])
    steps = np.diff(arc.node_md)
    turn = np.degrees(np.arccos(np.clip(np.sum(arc.node_tangent[1:] * arc.node_tangent[:-1], axis=1), -1, 1)))
    assert steps[0] == 100 and steps[1:].max() <= 10 + 1e-9 and turn.max() <= 2 + 1e-6
    assert len(arc.node_md) == 1 + 1 + 10 + 15
    stations = np.arange(0, 2001, 30.0)
    assert (
        len(hole(stations, 0 * stations, stations).node_md) == 2
    )  # azimuth of a vertical hole means nothing


def test_survey_starting_below_the_surface_and_hole_below_the_last_station():
    well = hole([500, 600], [30, 30], [90, 90], section_to=[900.0])
    x, t, _ = well.at([0.0, 500.0, 900.0])
    expected = np.array([0, 500, 900])[:, None] * np.array([0, 0.5, np.sqrt(0.75)])
    assert x == pytest.approx(expected, abs=1e-9) and well.depth == 900
    assert len(well.node_md) == 2
    assert t == pytest.approx(np.tile([0, 0.5, np.sqrt(0.75)], (3, 1)))
    assert hole([0], [0], section_to=[100.0]).at(70.0)[0] == pytest.approx([0, 0, 70])


def test_azimuth_crossing_north_is_the_turned_well():
    """355 -> 5 deg equals 85 -> 95 deg turned by 90 deg about the vertical, and never goes the long way
    round."""
    a, b = hole([0, 100, 300], [30, 60, 60], [355, 355, 5]), hole([0, 100, 300], [30, 60, 60], [85, 85, 95])
    s = np.linspace(-10, 320, 67)
    for va, vb in zip(a.at(s), b.at(s), strict=True):
        assert np.stack([-va[:, 1], va[:, 0], va[:, 2]], axis=1) == pytest.approx(vb, abs=1e-10)
    assert np.linalg.norm(a.at(200.0)[2]) == pytest.approx(
        2 * np.arcsin(np.sin(60 * DEG) * np.sin(5 * DEG)) / 200, rel=1e-4
    )


@each_row(
    ("md", "inclination", "sections", "message"),
    [
        ([0, 100, 100], [0, 0, 0], {}, "must increase"),
        ([-5, 100], [0, 0], {}, "starts at"),
        ([0, 100], [0, 190], {}, "inclination"),
        ([0, 100], [0, 180], {}, "170 deg"),
        ([0, 100], [0, np.nan], {}, "not a number"),
        (
            [0, 100],
            [0, 0],
            {"section_to": [50, 40], "section_radius": [0.1, 0.1], "section_friction": [0, 0]},
            "section 2",
        ),
        ([0, 100], [0, 0], {"section_radius": [0.0]}, "radii"),
        ([0, 100], [0, 0], {"section_friction": [-0.1]}, "friction"),
        ([0, 100], [0, 0], {"section_radius": [0.1, 0.2]}, "same length"),
    ],
)
def test_impossible_wells_are_refused(md, inclination, sections, message):
    with pytest.raises(ValueError, match=message):
        hole(md, inclination, **sections)


# ---------------------------------------------------------------- sections
STEPPED = {
    "section_to": [300, 301, 2000],
    "section_radius": [0.16, 0.12, 0.108],
    "section_friction": [0.2, 0.25, 0.3],
}


def radius_slope(well: Well, md: np.ndarray) -> np.ndarray:
    """dR/ds [-] by central differences: 1e-9 inside a transition, 1e-5 at its ends, where R'' jumps."""
    h = 1e-5
    return (well.radius(md + h) - well.radius(md - h)) / (2 * h)


def test_radius_transition():
    """Width max(0.5 m, 10 |dR|), half the change at the boundary, steepest slope 1.5 dR/width; transitions
    never overlap.
    """
    well = hole(
        [0, 2000], [0, 0], section_to=[800, 2000], section_radius=[0.2, 0.1], section_friction=[0.2, 0.3]
    )
    assert well.transitions[0, :2] == pytest.approx([799.5, 1.0])
    assert well.radius([0, 799.5, 800, 800.5, 3000]) == pytest.approx([0.2, 0.2, 0.15, 0.1, 0.1])
    assert well.friction([799.4, 800, 900]) == pytest.approx([0.2, 0.25, 0.3])
    assert radius_slope(well, np.array([799.5, 800, 800.5, 900])) == pytest.approx([0, -0.15, 0, 0], abs=1e-5)
    close = hole(
        [0, 2000],
        [0, 0],
        section_to=[300, 300.3, 2000],
        section_radius=[0.2, 0.15, 0.1],
        section_friction=[0.2, 0.2, 0.3],
    )
    start, width = close.transitions[:, 0], close.transitions[:, 1]
    assert width == pytest.approx([0.3, 0.3]) and start[1] >= start[0] + width[0] - 1e-12
    assert close.radius([300, 300.15, 300.3]) == pytest.approx([0.175, 0.15, 0.125])
    assert close.kind(300.2) == "open_hole"
    same = hole(
        [0, 2000], [0, 0], section_to=[300, 2000], section_radius=[0.1, 0.1], section_friction=[0.3, 0.3]
    )
    assert len(same.transitions) == 0


def test_kernel_and_python_agree_on_radius_and_friction():
    well = hole([0, 2000], [0, 0], **STEPPED)
    s = np.r_[np.linspace(299, 302, 301), -10.0, 2500.0]
    found = well.project(np.stack([0 * s, 0 * s + 0.01, s], axis=1))
    assert found.md == pytest.approx(s, abs=1e-9)
    assert found.radius == pytest.approx(well.radius(s), abs=1e-12)
    assert found.friction == pytest.approx(well.friction(s), abs=1e-12)


# ---------------------------------------------------------------- closest point
def bent():
    """Vertical, 30 deg/30 m dogleg, three-dimensional turn, straight tail; two radius changes inside the
    curves."""
    to, radius, mu = [95, 180, 400], [0.16, 0.12, 0.108], [0.2, 0.25, 0.3]
    return hole(
        [0, 60, 90, 120, 260, 400],
        [0, 0, 30, 35, 80, 80],
        [0, 0, 350, 20, 60, 60],
        section_to=to,
        section_radius=radius,
        section_friction=mu,
    )


def test_derivatives_against_central_differences():
    """200 random states, a third of them where R'(s) != 0: every output of the projection and the gap
    gradient to 1e-6 (manual: verif-projection-derivatives)."""
    well, rng = bent(), np.random.default_rng(3)
    md = np.r_[rng.uniform(-20, 430, 134), rng.uniform(94.8, 95.2, 33), rng.uniform(179.8, 180.2, 33)]
    x = around(well, md, rng.uniform(0.01, 0.1, 200), rng.uniform(0, 2 * np.pi, 200))
    value, slope = derivatives(well, x)
    _, gradient = gap(well, x)
    ends = np.r_[well.node_md, well.transitions[:, 0], well.transitions[:, :2].sum(axis=1)]
    h = 1e-5
    clear = np.min(np.abs(value[:, :1] - ends), axis=1) > 3 * h  # second derivatives jump at these
    assert clear.sum() >= 195 and (np.abs(radius_slope(well, md)) > 1e-3).sum() >= 55
    scale = np.maximum(1.0, np.abs(slope).max(axis=2))  # n turns at 1/rho
    for k in range(3):
        step = h * np.eye(3)[k]
        difference = fourth_order(lambda y: derivatives(well, y)[0], x, step)
        assert (np.abs(difference - slope[:, :, k]) / scale)[clear].max() < 1e-6
        gap_difference = fourth_order(lambda y: gap(well, y)[0], x, step)
        assert np.abs(gap_difference - gradient[:, k])[clear].max() < 1e-6


def test_derivatives_against_the_formulas():
    """ds/dx = t/(1 - e.k), grad gap = n - R' t/(1 - e.k), k the curvature at the closest point (manual:
    eq-contact-gradient)."""
    well, rng = bent(), np.random.default_rng(5)
    md = np.r_[rng.uniform(0, 400, 40), rng.uniform(94.8, 95.2, 20)]
    value, slope = derivatives(well, x := around(well, md, rng.uniform(0.01, 0.1, 60), rng.uniform(0, 6, 60)))
    _, t, k = well.at(value[:, 0])
    stretch = 1 / (1 - np.sum(value[:, FIELD["e"]] * k, axis=1))
    assert slope[:, 0] == pytest.approx(stretch[:, None] * t, abs=1e-5)  # s is arc length to beta^4
    expected = value[:, FIELD["n"]] - (radius_slope(well, value[:, 0]) * stretch)[:, None] * t
    assert gap(well, x)[1] == pytest.approx(expected, abs=2e-6)


@each_row("distance", [0.0, 1e-9, 0.04, 3.0, 20.0])
def test_points_at_a_known_distance(distance):
    """A point set off normally at md comes back with that md, centre and offset; near the axis and far from
    it."""
    well, rng = bent(), np.random.default_rng(7)
    md = rng.uniform(-50, 450, 300)
    x = around(well, md, np.full(300, distance), rng.uniform(0, 6, 300))
    found = well.project(x)
    assert found.md == pytest.approx(md, abs=1e-8)
    assert np.linalg.norm(found.offset, axis=1) == pytest.approx(distance * np.ones(300), abs=1e-9)
    assert found.centre + found.offset == pytest.approx(x, abs=1e-11)
    assert np.linalg.norm(found.tangent, axis=1) == pytest.approx(np.ones(300), abs=1e-12)
    assert np.abs(np.sum(found.offset * found.tangent, axis=1)).max() < 1e-10 * max(1, distance)
    assert np.isfinite(derivatives(well, x)[1]).all()


def test_any_warm_start_finds_the_same_point():
    well, rng = bent(), np.random.default_rng(11)
    x = around(well, rng.uniform(-20, 430, 300), rng.uniform(0, 0.1, 300), rng.uniform(0, 6, 300))
    cold = well.project(x)
    for hint in (
        rng.integers(0, len(well.node_md) - 1, 300),
        cold.segment,
        np.full(300, 10**6),
        np.full(300, -7),
    ):
        warm = well.project(x, hint)
        assert warm.md == pytest.approx(cold.md, abs=1e-9) and (warm.segment == cold.segment).all()


def test_beyond_both_ends_the_hole_goes_on_straight():
    well = hole([0, 60, 90], [0, 0, 30])
    end, t = well.node_position[-1], well.node_tangent[-1]
    side = np.array([0.0, 1.0, 0.0])
    found = well.project(np.array([[0.03, 0.04, -25.0], end + 40 * t + 0.05 * side]))
    assert found.md == pytest.approx([-25, 130], abs=1e-10)
    assert found.offset == pytest.approx(np.array([[0.03, 0.04, 0], [0, 0.05, 0]]), abs=1e-10)


def test_strong_dogleg_near_the_centre_of_curvature_gives_finite_answers():
    """90 deg in 15 m (R = 9.55 m): inside the evolute the point is exact; at the centre every answer is
    equally near and finite.
    """
    length = 15.0
    radius = length / (np.pi / 2)
    well = hole([0, 20, 20 + length, 60], [0, 0, 90, 90])
    centre = np.array([radius, 0, 20])
    angle = np.linspace(0.05, 1.5, 30)
    x = centre + 0.3 * radius * np.stack([-np.cos(angle), 0 * angle, np.sin(angle)], axis=1)
    found = well.project(x)
    assert found.md == pytest.approx(20 + radius * angle, abs=1e-5)
    assert np.linalg.norm(found.offset, axis=1) == pytest.approx(0.7 * radius * np.ones(30), abs=1e-6)
    value, slope = derivatives(well, np.array([centre, centre + [3.0, 0, -3.0]]))
    assert np.isfinite(value).all() and np.isfinite(slope).all()
    assert value[0, FIELD["rho"]] == pytest.approx(radius, abs=1e-6)


def test_normal_is_harmless_on_the_axis():
    """rho = sqrt(|e|^2 + (1e-6 m)^2), n = e/rho: on the axis n = 0 and its derivative is finite."""
    value, slope = derivatives(hole([0, 100], [0, 0]), [[0.0, 0.0, 50.0], [3e-6, 4e-6, 50.0]])
    assert value[0, FIELD["rho"]] == pytest.approx(1e-6) and (value[0, FIELD["n"]] == 0).all()
    assert value[1, FIELD["n"]] == pytest.approx(np.array([3, 4, 0]) / np.sqrt(26), rel=1e-12)
    assert slope[0, FIELD["n"]] == pytest.approx(1e6 * np.diag([1, 1, 0]))


# ---------------------------------------------------------------- drilling on
def test_extended_well_continues_the_curve():
    """Nodes appended along a circle every 0.5 m, as a drilling bit freezes them, lie on the circle; the old
    well is unchanged.
    """
    well = hole([0, 100], [0, 0])
    radius = 200.0
    longer = well
    for s in np.arange(0.5, 10.1, 0.5):
        a = s / radius
        longer = longer.extended(
            100 + s, [radius * (1 - np.cos(a)), 0, 100 + radius * np.sin(a)], [np.sin(a), 0, np.cos(a)]
        )
    assert longer.depth == 110 and well.depth == 100 and len(well.node_md) == 2
    x, t, k = longer.at(107.3)
    assert x == pytest.approx(
        [radius * (1 - np.cos(7.3 / radius)), 0, 100 + radius * np.sin(7.3 / radius)], abs=1e-9
    )
    assert np.linalg.norm(k) == pytest.approx(1 / radius, rel=1e-4)
    wider = longer.extended(120, longer.at(120)[0], longer.at(120)[1], radius=0.12, friction=0.3)
    assert wider.radius([105, 119]) == pytest.approx([0.10795, 0.12])
    with pytest.raises(ValueError, match="below"):
        longer.extended(109, [0, 0, 0], [0, 0, 1])


def test_cut_well_ends_where_it_is_cut():
    """Above the cut the line is unchanged, below it goes on straight; sections below are gone."""
    whole = bent()
    short = whole.cut(150.0)
    s = np.linspace(-5, 150, 100)
    assert short.at(s)[0] == pytest.approx(whole.at(s)[0], abs=1e-9) and short.depth == 150
    x, t, _ = whole.at(150.0)
    assert short.at(160.0)[0] == pytest.approx(x + 10 * t, abs=1e-9)
    assert short.section_to.tolist() == [95, 150] and short.radius(1000.0) == 0.12
    with pytest.raises(ValueError, match="cannot end"):
        whole.cut(401.0)
