"""Indices against closed forms and published numbers (manual: sec-vibration-indices)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import vibration
from drillpetsc.units import to_si
from tests.helpers.tables import each_row


def test_mechanical_specific_energy():
    """C26: 8.5 in, 20 klbf, 120 rpm, 5000 ft-lbf, 60 ft/h: 460.490 MPa = 66788 psi (Teale 1965)."""
    got = vibration.mechanical_specific_energy(
        to_si("20 klbf", "N"),
        to_si("5000 ft-lbf", "N m"),
        to_si("120 rpm", "rad/s"),
        to_si("60 ft/h", "m/s"),
        to_si("8.5 in", "m"),
    )
    assert got == pytest.approx(460.490e6, rel=1e-5)
    assert got / to_si("1 psi", "Pa") == pytest.approx(66788, rel=1e-5)


def test_without_rotary_drilling_the_energy_is_the_pressure_under_the_bit():
    """A bit that does not turn: W/A."""
    assert vibration.mechanical_specific_energy(1e5, 3e3, 0.0, 1e-3, 0.2) == pytest.approx(
        1e5 / (np.pi / 4 * 0.04)
    )


@each_row("rop", [0.0, -1e-3, np.nan])
def test_no_energy_without_progress(rop):
    """A rate of penetration of 0 would divide by zero."""
    assert np.isnan(vibration.mechanical_specific_energy(1e5, 3e3, 10.0, rop, 0.2))


def test_rolling_ratio():
    """C26: 127 mm in 215.9 mm: -1.428571."""
    assert vibration.rolling_ratio(0.127, 0.2159) == pytest.approx(-1.428571, rel=1e-6)


def test_stick_slip_index():
    """C27: 0.80 of w0 (1 + 0.8 sin t); 1.25 of a bit that sticks fully and goes up to 2.5 w0 at a mean of w0."""
    t = np.linspace(0, 4 * np.pi, 4001)
    assert vibration.stick_slip_index(10 * (1 + 0.8 * np.sin(t))) == pytest.approx(0.80, abs=1e-3)
    # stuck in a part of each turn, a half sine of 2.5 w0 in the rest, whose mean 2.5 x 2/pi x share is 1
    share = np.pi / 5
    phase = np.linspace(0, 1, 100_001)[:-1]
    speed = 7.0 * np.where(phase < share, 2.5 * np.sin(np.pi * phase / share), 0.0)
    assert np.mean(speed) == pytest.approx(7.0, rel=1e-4)
    assert vibration.stick_slip_index(speed) == pytest.approx(1.25, abs=1e-3)
    assert vibration.stuck_share(phase, speed) == pytest.approx(1 - share, abs=5e-3)


@each_row("speed", [np.zeros(9), np.array([1.0, -1.0]), np.zeros(0), np.full(5, 0.05)])
def test_no_stick_slip_index_of_a_string_that_does_not_turn(speed):
    """The mean speed is below 1 rpm."""
    assert np.isnan(vibration.stick_slip_index(speed))


def test_turning_backward_has_the_same_index():
    """The sign of the rotation does not matter."""
    speed = 5 + np.array([0.0, 2.0, 0.0, -2.0, 0.0])
    assert vibration.stick_slip_index(-speed) == vibration.stick_slip_index(speed) == pytest.approx(0.4)


def test_stuck_share_of_straight_lines():
    """From -2 to 2 rpm in a second: half of the time within 1 rpm."""
    rpm = np.pi / 30
    assert vibration.stuck_share(np.array([0.0, 1.0]), rpm * np.array([-2.0, 2.0])) == pytest.approx(0.5)
    assert vibration.stuck_share(np.array([0.0, 1.0, 3.0]), np.zeros(3)) == 1.0


def test_depth_of_cut():
    """36 m/h at 60 rpm: 10 mm/s, a turn a second."""
    assert vibration.depth_of_cut(0.01, 2 * np.pi) == pytest.approx(0.01)
    assert np.isnan(vibration.depth_of_cut(0.01, 0.0))


def test_efficiency_and_impacts():
    """Strength over energy; rises above a level."""
    assert vibration.drilling_efficiency(100e6, 400e6) == 0.25
    assert np.isnan(vibration.drilling_efficiency(100e6, np.nan))
    assert vibration.exceedances(np.array([0, 12, 13, 2, 11, 0.0]), 10.0) == 2
    assert vibration.exceedances(np.array([11.0, 12.0]), 10.0) == 1
    assert vibration.root_mean_square(np.array([[3.0, 4.0], [0.0, 0.0]])) == pytest.approx(5 / np.sqrt(2))


RADIUS, HOLE = 0.0635, 0.10795
CLEARANCE = HOLE - RADIUS


def orbit(ratio: float, size: float, rate: float = 200.0, spin: float = 12.0):
    """Time, place and spin of a string that whirls with a ratio."""
    t = np.arange(0, 5, 1 / rate)
    return t, size * np.cos(ratio * spin * t), size * np.sin(ratio * spin * t), np.full(len(t), spin)


@each_row(
    ("ratio", "size", "name"),
    [
        (1.0, CLEARANCE, "forward synchronous"),
        (1.0, 0.1 * CLEARANCE, "forward synchronous"),  # off the wall, where a rolling string would be fast
        (0.5, CLEARANCE, "forward"),
        (-RADIUS / CLEARANCE, CLEARANCE, "backward rolling"),
        (-RADIUS / (1.2 * CLEARANCE), 1.2 * CLEARANCE, "backward rolling"),  # in a wall that yields
        (-0.7, CLEARANCE, "backward slipping"),
        (1.0, 0.04 * CLEARANCE, "none"),
        (0.0, CLEARANCE, "none"),
    ],
)
@each_row("way", [1, -1])
def test_classes_of_circular_whirl(ratio, size, name, way):
    """Class and ratio of a circle; turned backward, both rotations change their sign and nothing else."""
    t, x, y, spin = orbit(ratio, size, spin=12.0 * way)
    got = vibration.whirl(t, x, y, spin, RADIUS, CLEARANCE, np.array([3.0, 4.0]))
    assert [vibration.CLASSES[k] for k in got.number] == [name, name]
    assert got.ratio == pytest.approx([ratio, ratio], abs=1e-6)
    assert got.radius == pytest.approx([size, size], rel=1e-6)


def test_chaotic_and_unresolved_motion():
    """Turning forth and back is chaotic; too few rows, too little rotation and no rotation are unresolved."""
    t, x, y, spin = orbit(0.0, CLEARANCE)
    angle = 2.5 * np.sin(9 * t)
    at = np.array([4.0])
    chaotic = vibration.whirl(
        t, CLEARANCE * np.cos(angle), CLEARANCE * np.sin(angle), spin, RADIUS, CLEARANCE, at
    )
    assert vibration.CLASSES[chaotic.number[0]] == "chaotic"
    few = vibration.whirl(*orbit(1.0, CLEARANCE, rate=5.0), RADIUS, CLEARANCE, at)
    early = vibration.whirl(*orbit(1.0, CLEARANCE), RADIUS, CLEARANCE, np.array([0.5]))
    still = vibration.whirl(t, x, y, 0 * spin, RADIUS, CLEARANCE, at)
    assert {vibration.CLASSES[q.number[0]] for q in (few, early, still)} == {"unresolved"}
