"""Soft string against closed forms (manual: sec-verif-statics-torque-drag, sec-soft-string-closed-forms).

Steel drill pipe 127 x 108.6 mm: EA 7.0137489e8 N, GJ 9.4156072e5 N m2, contact radius 63.5 mm, buoyed weight
242 N/m.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drillpetsc import Case
from drillpetsc.analysis.loads.torque_drag.batch import Columns, Hole, soft_strings
from drillpetsc.analysis.loads.torque_drag.string_rows import need_well, rows_at
from drillpetsc.analysis.statics.start.soft_string import slip_direction, torque_drag
from drillpetsc.geometry.well import Well
from tests.helpers.tables import each_row

EA, GJ, RADIUS, WEIGHT = 7.0137489e8, 9.4156072e5, 0.0635, 242.0
PULL, SLACK, TURN = {"axial_velocity": 0.3}, {"axial_velocity": -0.3}, {"rotation": 2 * np.pi}


def hole(md, inclination, friction, azimuth=None):
    """Well of 215.9 mm from inclinations [deg] and azimuths [deg] at md [m]."""
    azimuth = np.zeros(len(md)) if azimuth is None else np.radians(azimuth)
    return Well.from_survey(md, np.radians(inclination), azimuth, [md[-1]], [0.10795], [friction])


def run(well, length, n=50, **kw):
    return torque_drag(well, np.linspace(0, length, n + 1), kw.pop("weight", WEIGHT), RADIUS, EA, GJ, **kw)


def test_capstan():
    """T = T0 exp(mu pi/2) for a weightless string pulled round 90 degrees: 148.097 kN (manual:
    verif-capstan)."""
    well = hole([0, 300], [0, 90], 0.25)
    result = run(well, 300, n=7, weight=0.0, bottom_force=1e5, **PULL)
    assert result.hook_load == pytest.approx(148.097e3, rel=1e-5)
    assert result.contact_force == pytest.approx(
        result.axial_force * (np.pi / 2) / 300, rel=1e-5
    )  # N = T/R, ends too


def test_twist_of_a_torque_that_grows_evenly():
    """Friction along an inclined string: M falls from the top to 0 at the bit, and twists it by M L/2GJ, in any step."""
    for pieces in (1, 7):
        result = run(hole([0, 100], [60, 60], 0.3), 100, n=pieces, **TURN)
        assert result.twist[-1] == pytest.approx(result.surface_torque * 100 / (2 * GJ), rel=1e-9)


@each_row(("motion", "load"), [(PULL, 183.873e3), (SLACK, 58.127e3), (TURN, 121.0e3), ({}, 121.0e3)])
def test_incline(motion, load):
    """w L (cos I + a mu sin I) at I = 60 deg; rotating torque mu w sin I R L = 3992.5 N m (manual:
    verif-incline)."""
    result = run(hole([0, 1000], [60, 60], 0.3), 1000, **motion)
    assert result.hook_load == pytest.approx(load, rel=1e-5)
    assert result.surface_torque == pytest.approx(3992.5 if motion is TURN else 0.0, rel=2e-5, abs=1e-9)
    assert result.mean_contact_force == pytest.approx(WEIGHT * np.sin(np.pi / 3) * np.ones(50))
    # the string lies on the low side
    assert result.wall_direction == pytest.approx(
        np.tile([-np.cos(np.pi / 3), 0, np.sin(np.pi / 3)], (51, 1))
    )


def test_pull_and_rotate():
    """0.3 m/s and 60 rpm: fractions 0.600978 and 0.799265, hook load 158.786 kN, torque 3191.0 N m (manual:
    verif-incline-pull-rotate)."""
    along, around = slip_direction(0.3, 2 * np.pi, RADIUS)
    assert (along, around) == (pytest.approx(0.600978, abs=1e-6), pytest.approx(0.799265, abs=1e-6))
    result = run(hole([0, 1000], [60, 60], 0.3), 1000, axial_velocity=0.3, rotation=2 * np.pi)
    assert result.hook_load == pytest.approx(158.786e3, rel=1e-5)
    assert result.surface_torque == pytest.approx(3191.0, rel=2e-5)


@each_row(("motion", "load"), [(PULL, 458.659e3), (SLACK, 303.912e3), (TURN, 372.048e3)])
@each_row("n", [1, 36])
def test_build(motion, load, n):
    """Build 0 to 60 deg at 5 deg/30 m, 300 kN below (closed form); torque when rotating 4864.3 N m (manual:
    verif-build-curve)."""
    result = run(hole([0, 360], [0, 60], 0.25), 360, n=n, bottom_force=3e5, **motion)
    assert result.hook_load == pytest.approx(load, rel=1e-5)
    if motion is TURN:
        assert result.surface_torque == pytest.approx(4864.3, rel=5e-5)


def test_turn_and_build_against_reference_integration():
    """Spatial hole: the force integrated by scipy's DOP853 on the analytic arc (not on our Hermite line)."""
    inclination, azimuth = np.radians([20, 70]), np.radians([340, 60])
    length, mu, bottom = 400.0, 0.25, -8e4
    e1, t2 = (
        np.array([np.sin(i) * np.cos(a), np.sin(i) * np.sin(a), np.cos(i)])
        for i, a in zip(inclination, azimuth, strict=True)
    )
    b = np.arccos(e1 @ t2)
    e2 = (t2 - np.cos(b) * e1) / np.sin(b)

    def rate(up, y):
        angle = b * (length - up) / length
        t = np.cos(angle) * e1 + np.sin(angle) * e2
        kappa = (b / length) * (np.cos(angle) * e2 - np.sin(angle) * e1)
        contact = np.linalg.norm(y[0] * kappa + WEIGHT * (np.array([0, 0, 1]) - t[2] * t))
        return [WEIGHT * t[2] - mu * contact]

    exact = solve_ivp(rate, (0, length), [bottom], method="DOP853", rtol=1e-10, atol=1e-3).y[0, -1]
    result = run(
        hole([0, length], np.degrees(inclination), mu, np.degrees(azimuth)),
        length,
        n=11,
        bottom_force=bottom,
        **SLACK,
    )
    assert result.hook_load == pytest.approx(exact, rel=2e-5)


def test_hanging_stretch_and_twist():
    """Weight of steel in air, rho g L^2/(2 E) = 0.747655 m; twist M L/GJ = 21.24133 rad (manual:
    verif-hanging-string)."""
    result = run(
        hole([0, 2000], [0, 0], 0.3), 2000, n=13, weight=7850 * 9.81 * 3.4047325e-3, bottom_torque=1e4, **TURN
    )
    assert result.stretch == pytest.approx(0.747655, rel=2e-6)
    assert result.twist[-1] == pytest.approx(21.24133, rel=2e-6)
    assert result.elongation[0] == 0.0 and np.all(np.diff(result.elongation) > 0)
    assert result.wall_direction == pytest.approx(np.zeros((14, 3)))


def test_hole_crossing_north_has_the_side_forces_of_the_turned_hole():
    """Azimuth 355 to 5 deg against 85 to 95 deg: equal forces, sides rotated by 90 deg (manual:
    verif-azimuth-north)."""
    a = run(hole([0, 300], [60, 60], 0.25, [355, 5]), 300, bottom_force=1e5, **PULL)
    b = run(hole([0, 300], [60, 60], 0.25, [85, 95]), 300, bottom_force=1e5, **PULL)
    assert a.hook_load == pytest.approx(b.hook_load, rel=1e-12)
    assert a.contact_force == pytest.approx(b.contact_force, rel=1e-9)
    assert a.wall_direction[:, [1, 2]] == pytest.approx(
        np.c_[-b.wall_direction[:, 0], b.wall_direction[:, 2]], abs=1e-9
    )


def test_friction_of_the_well_sections():
    """Half the incline cased with mu 0.1, half open with 0.3: the drag is the mean of the two (smoothstep is
    symmetric).
    """
    well = Well.from_survey([0, 1000], np.radians([60, 60]), [0, 0], [500, 1000], [0.11, 0.108], [0.1, 0.3])
    base = 1000 * WEIGHT * np.cos(np.pi / 3)
    drag = 1000 * WEIGHT * np.sin(np.pi / 3)
    assert run(well, 1000, n=9, **PULL).hook_load == pytest.approx(base + 0.2 * drag, rel=1e-9)


def test_sections_of_the_string_and_reversed_rotation():
    """Two pipes on an incline, closed form by parts; torque changes sign with the rotation."""
    md = [0.0, 600.0, 1000.0]
    weight, radius = np.array([242.0, 1000.0]), np.array([0.0635, 0.085])
    well = hole([0, 1000], [60, 60], 0.3)
    result = torque_drag(well, md, weight, radius, EA, GJ, rotation=-5.0, bottom_force=-5e4)
    length, s, c = np.array([600.0, 400.0]), np.sin(np.pi / 3), np.cos(np.pi / 3)
    assert result.axial_force == pytest.approx(
        [-5e4 + c * (weight @ length), -5e4 + c * 4e5, -5e4], rel=1e-12
    )
    assert result.torque == pytest.approx(
        [-0.3 * s * (weight * radius) @ length, -0.3 * s * 1000 * 0.085 * 400, 0.0], rel=1e-12
    )
    assert result.contact_force == pytest.approx(s * np.array([242.0, 621.0, 1000.0]), rel=1e-9)


def test_boundaries_must_increase():
    with pytest.raises(ValueError, match="increasing"):
        torque_drag(hole([0, 10], [0, 0], 0.3), [0, 5, 5], WEIGHT, RADIUS, EA, GJ)


def test_a_string_breaks_where_its_force_grows_without_bound():
    """Pushed into a long level hole: `locked` is the end of the forces that the string bears, and none is shown above it."""
    md = [0.0, 500.0, 900.0, 6000.0]
    survey = {"md": md, "inclination": np.radians([0.0, 0.0, 90.0, 90.0]).tolist(), "azimuth": [0.0] * 4}
    section = {"to": 6000.0, "kind": "open_hole", "diameter": 0.2159, "friction": 0.4}
    made = Case(
        well={"survey": survey, "sections": [section]},
        string=[{"kind": "pipe", "length": 6000.0, "od": 0.127, "id": 0.1086}],
        top="clamped",
    )
    frictions = np.array([[0.0], [0.4], [0.6]])  # without friction any weight arrives
    loads = Columns(np.zeros(3, dtype=int), frictions, 3e5, 0.0, -0.3, 0.0)
    found = soft_strings(Hole(need_well(made, "roadmap"), [rows_at(made, 6000.0)], 25.0), loads)
    assert found.broken.tolist() == [False, True, True]
    for c in (1, 2):
        shown = np.isfinite(found.tension[:, c])
        assert found.md[shown].min() == found.locked[c] and np.abs(found.tension[shown, c]).max() < 5e7
        assert shown[np.argmax(shown) :].all() and found.locked[c] > 900.0
    assert found.locked[2] > found.locked[1]  # more friction: sooner


def test_thrust_of_the_jets_is_weight_on_bit():
    """Both push the lower end up: the same string."""
    case = Case(
        well={
            "survey": {"md": [0, 500], "inclination": [0.0, 1.0], "azimuth": [0, 0]},
            "sections": [{"to": 500, "kind": "open_hole", "diameter": 0.2159, "friction": 0.3}],
        },
        string=[{"kind": "pipe", "length": 400, "od": 0.127, "id": 0.1086}],
        top="clamped",
        bottom="free",
    )
    push = np.array([3e4, 0.0])
    loads = Columns(np.zeros(2, dtype=int), 0.3 * np.ones((2, 1)), push, 0.0, 0.3, 0.0, thrust=push[::-1])
    found = soft_strings(Hole(need_well(case, "roadmap"), [rows_at(case, 400.0)], 25.0), loads)
    assert found.tension[:, 0] == pytest.approx(found.tension[:, 1], rel=1e-12, nan_ok=True)
