"""Law of the positive displacement motor against its formulae and published numbers (manual: sec-motor-law)."""

from __future__ import annotations

from math import pi

import numpy as np
import pytest

from drillpetsc.physics.tools.motor_law import MeasuredCurve, MotorLaw, monotone_slopes
from tests.helpers.tables import each_row

GALLON, PSI, FOOT_POUND = 3.785411784e-3, 6894.757293168361, 1.3558179483314004
RPM = pi / 30
MOTOR = MotorLaw(0.29 / GALLON, 0.85, 0.6e6, 14e3, 4.0)


@each_row(
    "torque, rpm, megapascal",
    [(0.0, 137.898, 0.6), (4e3, 136.979, 2.8652), (8e3, 123.195, 5.1304), (12e3, 63.464, 7.3956)],
)
def test_speed_and_pressure_at_30_litres_a_second(torque, rpm, megapascal):
    """C12: w = 2 pi n Q (1 - (T/T_s)^4), dp = p0 + 2 pi n T/efficiency."""
    point = MOTOR.point(torque, 0.03)
    assert point.speed == pytest.approx(rpm * RPM, rel=1e-4)
    assert point.differential_pressure == pytest.approx(megapascal * 1e6, rel=1e-4)
    runs = 0.03 / np.hypot(0.03, 1e-4)  # eq-motor-least-flow
    assert point.leak == pytest.approx(0.03 * (1 - runs * (1 - (torque / 14e3) ** 4)), rel=1e-9)


def test_efficiency_stall_and_ideal_torque():
    """C12: hydraulic efficiency, pressure of the stall, torque per pressure of an ideal motor, speed at 600 gpm."""
    assert MOTOR.efficiency(8e3, 0.03) == pytest.approx(0.67056, rel=1e-4)
    past = MotorLaw(
        0.29 / GALLON, 0.85, 0.6e6, 14e3, 4.0, bypass=0.005
    )  # what its nozzle lets past drives nothing
    assert past.efficiency(8e3, 0.035) == pytest.approx(MOTOR.efficiency(8e3, 0.03), rel=1e-4)
    assert MOTOR.point(1.01 * 14e3, 0.03).differential_pressure == pytest.approx(8.5282e6, rel=1e-4)
    ideal = MotorLaw(0.29 / GALLON, 1.0, 0.0, 14e3)
    pressure = ideal.point(7161.8, 0.03).differential_pressure
    assert pressure == pytest.approx(500 * PSI, rel=1e-4)
    assert 7161.8 / pressure == pytest.approx(2.077472e-3, rel=1e-4)
    assert 7161.8 / FOOT_POUND == pytest.approx(5282, rel=1e-4)
    assert ideal.free_speed(600 * GALLON / 60) == pytest.approx(174 * RPM, rel=1e-4)


def test_below_the_lowest_measured_flow_speed_and_pressure_fall_to_zero():
    """One curve of two points at 20 l/s, and a motor at rest without flow: half of speed and no-load pressure at 10 l/s."""
    curve = MeasuredCurve(0.02, np.array([0.0, 8e3]), np.array([0.9e6, 4e6]), np.array([12.0, 0.0]))
    point = MotorLaw(curves=[curve]).point(0.0, 0.01)
    assert point.speed == pytest.approx(6.0, rel=2e-4)
    assert point.differential_pressure == pytest.approx(0.45e6, rel=2e-4)


def test_the_other_form_of_the_law():
    """C13: T = T_max (1 - w/w0)^(1/4.538): 10158.3 N m at 6 rad/s, 9.5138 rad/s at 8 kN m.

    T_max 12 kN m and w0 11.31 rad/s are those of the same rotor.
    """
    stall, free = 12e3, 11.31
    motor = MotorLaw(free / (2 * pi * 0.03), 0.85, 0.0, stall, 4.538)
    assert stall * (1 - 6 / free) ** (1 / 4.538) == pytest.approx(
        10158.3, rel=1e-4
    )  # the numbers of the source
    assert motor.torque(6.0, 0.03) == pytest.approx(10158.3, rel=1e-4)
    assert motor.speed(8e3, 0.03) == pytest.approx(9.5138, rel=1e-4)


@each_row("seed", range(4))
def test_other_motors_follow_the_formulae(seed):
    """The formulae at random numbers, 1e-4 as C12."""
    rng = np.random.default_rng(seed)
    n, eta, p0 = rng.uniform(20, 300), rng.uniform(0.5, 1.0), rng.uniform(0, 2e6)
    stall, droop, bypass = rng.uniform(2e3, 3e4), rng.uniform(1, 6), rng.uniform(0, 0.005)
    motor = MotorLaw(n, eta, p0, stall, droop, bypass)
    flow = rng.uniform(0.01, 0.08)
    for share in (0.05, 0.3, 0.6, 0.9):
        point, q = motor.point(share * stall, flow), flow - bypass
        assert point.speed == pytest.approx(2 * pi * n * q * (1 - share**droop), rel=1e-4)
        assert point.differential_pressure == pytest.approx(p0 + 2 * pi * n * share * stall / eta, rel=1e-4)
        assert motor.torque(point.speed, flow) == pytest.approx(share * stall, rel=1e-6)


def test_stall_backward_drive_and_no_flow():
    """Beyond the stall torque the rotor stands and all mud leaks; a bit that pulls finds the free speed; no flow, no speed."""
    at, beyond = MOTOR.point(14e3, 0.03), MOTOR.point(25e3, 0.03)
    for point in (at, beyond):
        assert abs(point.speed) < 1e-3 and point.leak == pytest.approx(0.03)
        assert point.differential_pressure == pytest.approx(8.5282e6, rel=1e-4)
        assert point.stalled
    pulled = MOTOR.point(-5e3, 0.03)
    assert pulled.speed == pytest.approx(137.898 * RPM, rel=1e-4)
    assert pulled.differential_pressure == pytest.approx(0.6e6, rel=1e-4)
    still = MOTOR.point(3e3, 0.0)
    assert abs(still.speed) < 1e-3 and still.leak == 0 and still.differential_pressure == 0
    with pytest.raises(ValueError, match="free speed"):
        MOTOR.torque(20.0, 0.03)


def _measured() -> MotorLaw:
    """The motor by points of its curves at three flow rates."""
    torque = np.linspace(0, 14e3, 29)
    return MotorLaw(
        curves=[
            MeasuredCurve(q, torque, *MOTOR.points(torque, np.array([q])).T[[1, 0]])
            for q in (0.02, 0.03, 0.04)
        ]
    )


@each_row("motor", [MOTOR, MotorLaw(60.0, 0.9, 0.2e6, 5e3, 1.0, 0.002), _measured()])
def test_mud_that_flows_up_turns_the_rotor_backwards(motor):
    """All of the law changes its sign with flow rate and torque."""
    torque, flow = np.meshgrid(np.linspace(-6e3, 16e3, 23), [1e-5, 1e-3, 0.01, 0.03])
    down, up = motor.points(torque.ravel(), flow.ravel()), motor.points(-torque.ravel(), -flow.ravel())
    assert up[:, :3] == pytest.approx(-down[:, :3], rel=1e-12)
    assert up[:, 3] == pytest.approx(down[:, 3], rel=1e-12)
    assert motor.point(0.0, -0.03).speed == pytest.approx(-motor.point(0.0, 0.03).speed)


@each_row("motor", [MOTOR, MotorLaw(60.0, 0.9, 0.2e6, 5e3, 1.0, 0.002), _measured()])
def test_the_rotor_has_no_more_power_than_the_mud_loses(motor):
    """dp Q >= T w at all flow rates, against the flow and next to none, too; nothing jumps where the flow turns."""
    stall = motor.stall_torque(0.03)
    for q in (0.0, 1e-7, 1e-6, 1e-5, 5e-5, 1e-4, 3e-4, 1e-3, 0.01, 0.03, 0.05):
        for flow in (q, -q):
            torque = np.linspace(-1.3, 1.3, 131) * stall
            speed, pressure = motor.points(torque, np.full(131, flow)).T[:2]
            assert (pressure * flow - torque * speed >= -1e-9).all()
    torque = np.linspace(-1.3, 1.3, 53) * stall
    before, after = (motor.points(torque, np.full(53, q)) for q in (-1e-12, 1e-12))
    assert np.abs(after[:, 0] - before[:, 0]).max() < 1e-9 and np.abs(after[:, 1] - before[:, 1]).max() < 0.1


@pytest.mark.parametrize("motor", [MOTOR, MotorLaw(60.0, 0.9, 0.2e6, 5e3, 1.0, 0.002)])
def test_the_law_falls_everywhere_and_has_no_kinks(motor):
    """Speed falls strictly with the torque; its slope has no jumps: at half the step they halve, too."""
    stall = motor.stall_torque(0.03)
    jumps = []
    for count in (4001, 8001):
        torque = np.linspace(-0.2, 1.4, count) * stall
        speed, pressure = motor.points(torque, np.full(count, 0.03)).T[:2]
        assert (np.diff(speed) < 0).all() and (np.diff(pressure) >= 0).all()
        jumps.append(np.abs(np.diff(np.diff(speed) / np.diff(torque))).max())
    assert jumps[1] < 0.6 * jumps[0]


def test_measured_curves_of_the_law_give_the_law():
    """Points of the formula at three flow rates; between them and between their torques 0.1 % of the free speed, 0.2 % between
    the last two torques: the corner of the law at stall, 1 % of the stall torque wide, is narrower than they are apart."""
    torque = np.linspace(0, 14e3, 29)
    curves = [
        MeasuredCurve(q, torque, *MOTOR.points(torque, np.array([q])).T[[1, 0]]) for q in (0.02, 0.03, 0.04)
    ]
    measured = MotorLaw(curves=curves)
    for flow in (0.012, 0.025, 0.03, 0.0371, 0.045):
        for t in (0.0, 1.7e3, 5.2e3, 9.9e3, 12.6e3, 13.8e3, 16e3):
            a, b = measured.point(t, flow), MOTOR.point(t, flow)
            share = 1e-3 if t < 13.5e3 else 2e-3
            assert a.speed == pytest.approx(b.speed, abs=share * MOTOR.free_speed(flow))
            if flow >= 0.02:  # below the least flow rate of the curves the pressure without torque falls to 0
                assert a.differential_pressure == pytest.approx(b.differential_pressure, rel=1e-3)
            assert a.leak == pytest.approx(b.leak, abs=2e-3 * flow)
    assert abs(measured.speed(3e3, 0.0)) < 1e-3


def test_slopes_keep_a_curve_monotone():
    x, f = np.array([0.0, 1.0, 1.5, 4.0]), np.array([0.0, 1.0, 1.0, 3.0])
    assert monotone_slopes(x, f)[1] == 0 and monotone_slopes(x, f)[2] == 0
    line = monotone_slopes(x, 2 * x + 1)
    assert line == pytest.approx(2 * np.ones(4))


def test_slopes_of_uneven_points_are_those_of_fritsch_and_butland():
    """Against scipy's PCHIP, whose inner slopes are the same weighted harmonic means (Fritsch and Butland 1984)."""
    from scipy.interpolate import PchipInterpolator

    x, f = np.array([0.0, 1.0, 4.0, 5.5, 9.0]), np.array([0.0, 1.0, 2.0, 6.0, 7.0])
    expected = PchipInterpolator(x, f).derivative()(x)
    assert monotone_slopes(x, f)[1:-1] == pytest.approx(expected[1:-1], rel=1e-12)
