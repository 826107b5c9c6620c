"""A downhole motor in linear models: closed forms of its transfer functions and roots (manual: verif-linear-motor)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import fsolve

import drillpetsc
from drillpetsc import Case
from drillpetsc.output import read_table
from tests.helpers.wells import newtonian, simple_well

GJ, POLAR = 9.4156072e5, 1.1883776e-5 * 7850  # of 127 x 108.6 mm [N m2, kg m]
SPEED = np.sqrt(GJ / POLAR)
PIPE = {"od": 0.127, "id": 0.1086}
TURN, FLOW, STALL = 0.29 * 2 * np.pi / 3.785411784e-3, 0.03, 14e3  # rad/m3, m3/s, N m
ROTOR = 30.0  # kg m2


def braked(length: float, torque: float, rotation: float = 0.0) -> Case:
    """A motor at the end of pipe that is turned at its top; ``torque`` [N m] brakes the rotor."""
    section = {
        "rev_per_volume": TURN,
        "stall_torque": STALL,
        "no_load_pressure": 6e5,
        "flow_rate": FLOW,
        "rotor_inertia": ROTOR,
    }
    return Case(
        string=[
            {"kind": "pipe", "length": length - 9, **PIPE, "element_length": length / 60},
            {"kind": "pdm", "length": 9.0, **PIPE, "element_length": 4.5, "pdm": section},
        ],
        top={"kind": "top_drive", "rotation": rotation},
        bottom={"kind": "force", "moment": [0, 0, -torque]},
        gravity=0,
        time={"end": 1.0},
    )


def slope(torque: float) -> float:
    """-d(speed)/d(torque) of the motor [rad/s per N m]; none where what is below drives it."""
    return 4 * TURN * FLOW * max(torque, 0.0) ** 3 / STALL**4


def figures(length: float, torque: float, s):
    """Speed of stator and rotor over that of the top: a wave in pipe that ends in the motor and what it turns."""
    below = ROTOR + POLAR * 4.5
    rotor = 1 / (1 + slope(torque) * below * s)
    kL = s * (length - 4.5) / SPEED
    stator = 1 / (np.cosh(kL) + below * s * rotor * np.sinh(kL) / (POLAR * SPEED))
    return stator, stator * rotor


@pytest.mark.parametrize(
    ("length", "torque", "rotation"),
    [
        (900.0, 8e3, 0.0), (1500.0, 5.2e3, 10.0), (600.0, 12.5e3, -4.0), (900.0, 0.0, 0.0),
        (1200.0, -700.0, 6.0),
    ],
)  # fmt: skip
def test_speed_of_the_bit_by_that_of_the_top(length, torque, rotation, tmp_path):
    """Within 0.3 % at 0.02 to 1 Hz; without load the motor holds its speed, a constraint of rates."""
    frequency = np.array([0.02, 0.1, 0.33, 0.7, 1.0])
    system = drillpetsc.linearise(
        braked(length, torque, rotation), ["top.rotation"], ["bit_speed", "motor_speed"], tmp_path / "l"
    ).system
    stator, rotor = figures(length, torque, 2j * np.pi * frequency)
    found = system.response(frequency)[:, :, 0]
    assert np.abs(found[:, 0] / rotor - 1).max() < 3e-3
    # the corner of the law at zero torque is rounded
    assert np.abs(found[:, 1] - (rotor - stator)).max() < 3e-3 * np.abs(rotor - stator).max() + 1e-4


def test_roots_of_linearise_modes_and_campbell(tmp_path):
    """The lowest root of top held, pipe, motor and rotor: within 0.1 % by the three commands."""
    length, torque = 900.0, 8e3
    case = braked(length, torque, 5.0)
    held = drillpetsc.modes(case, tmp_path / "m", count=3, kind="torsional").summary
    roots = np.array(held["growth"]) + 2j * np.pi * np.array(held["frequency"])
    first = roots[roots.imag > 0][0]

    def equation(z):
        value = 1 / figures(length, torque, complex(*z))[0]
        return [value.real, value.imag]

    exact = complex(*fsolve(equation, [first.real, first.imag], xtol=1e-12))
    assert abs(first - exact) < 1e-3 * abs(exact) and exact.real < -1e-3
    s = np.linalg.eigvals(
        drillpetsc.linearise(case, ["top.rotation"], ["bit_speed"], tmp_path / "l").system.A
    )
    assert np.abs(s - first).min() < 1e-5 * abs(first)
    drillpetsc.campbell(case, tmp_path / "c", speeds="0,40,90 rpm", count=2, kind="torsional")
    rows = read_table(tmp_path / "c" / "campbell.csv")
    lowest = rows["branch [-]"] == 1
    assert rows["frequency [Hz]"][lowest] == pytest.approx(first.imag / (2 * np.pi), rel=1e-4)
    assert rows["growth [1/s]"][lowest] == pytest.approx(first.real, rel=1e-3)
    assert lowest.sum() == 3


@pytest.mark.parametrize(("length", "flow", "viscosity"), [(300.0, 0.03, 0.02), (500.0, 0.02, 0.01)])
def test_slow_answer_of_a_motor_without_load_in_mud(length, flow, viscosity, tmp_path):
    """A vertical string off bottom: the model's speed per flow at low frequency is the difference of two steady states, 3e-4.

    It is below 2 pi n, since mud is denser under pressure, and the pressure grows with the flow.
    """
    depth = length + 40.0
    section = {"rev_per_volume": TURN, "stall_torque": STALL, "no_load_pressure": 6e5, "rotor_inertia": 3.0}

    def case(rate: float) -> Case:
        return Case(
            well=simple_well(depth, 0.2159, friction=0.0),
            string=[
                {"kind": "pipe", "length": length - 9, **PIPE, "element_length": 20.0},
                {
                    "kind": "pdm",
                    "length": 9.0,
                    "od": 0.1715,
                    "id": 0.1,
                    "element_length": 4.5,
                    "pdm": section,
                },
                {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 60.0, "nozzle_area": 4e-4},
            ],
            top={"kind": "top_drive", "rotation": 0.0},
            bottom={"kind": "free"},
            fluid=newtonian(1200.0, viscosity, flow_rate=rate),
            initial={"from": "statics"},
            time={"end": 1.0},
        )

    speeds = []
    for rate in (flow - 1e-4, flow + 1e-4):
        with drillpetsc.Session(case(rate)) as s:
            speeds.append(s.get("motor_speed"))
    expected = (speeds[1] - speeds[0]) / 2e-4
    assert 0.97 * TURN < expected < 0.999 * TURN
    model = drillpetsc.linearise(
        case(flow), inputs=["fluid.flow_rate"], outputs=["motor_speed"], out=tmp_path / "linear"
    ).system
    real = []
    for w in (0.01, 0.02):
        x = np.linalg.solve(1j * w * np.eye(len(model.A)) - model.A, model.B)
        real.append((model.C @ x + model.D + 1j * w * model.F)[0, 0].real)
    assert real[0] + (real[0] - real[1]) / 3 == pytest.approx(expected, rel=3e-4)  # even in the frequency
