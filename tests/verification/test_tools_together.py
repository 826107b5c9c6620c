"""Jar, shock sub and downhole motor in one string with mud: they run with the pumps on, off, reversed and shut in
(manual: sec-mud-joints, sec-motor-law)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.output import read_table
from tests.helpers.whole_string import COLLAR, JAR, MOTOR, SHOCK, combined


def history(case: dict, out: Any) -> tuple[dict[str, np.ndarray], dict]:
    summary = run(Case(**case), out, progress="silent").summary
    return {k.split(" [")[0]: v for k, v in read_table(out / "history.csv").items()}, summary


def energy_share(summary: dict) -> float:
    """Error of the energy over the energy exchanged."""
    return abs(summary["energy"]["error_share"])


@pytest.mark.parametrize(
    "order",
    [(MOTOR, COLLAR, SHOCK, JAR), (SHOCK, COLLAR, MOTOR, JAR)],
    ids=lambda tools: "-".join(t["kind"] for t in tools),
)
def test_pumps_off(order, tmp_path):
    """Nothing turns the rotor: its slip is below 1e-4 rad/s, and standing mud holds no pressure across the motor."""
    got, summary = history(combined(*order), tmp_path / "run")
    assert np.abs(got["motor_speed"]).max() < 1e-4
    assert got["motor_differential_pressure"][0] == pytest.approx(0.0, abs=1.0)
    assert any("does not turn" in w for w in summary["statics"]["warnings"])
    assert energy_share(summary) < 1e-3


@pytest.mark.parametrize(
    ("fluid", "speed"),
    [
        ({"flow_rate": 1e-6}, 0.0),
        ({"flow_rate": "30 l/s"}, 14.44),
        ({"flow_rate": "-5 l/s", "outlet_pressure": "10 MPa"}, -2.41),
        ({"check_valve": True}, 0.0),
        ({"choke": {"area": 1e-6}}, 0.0),
    ],
    ids=["trickle", "drilling", "reverse", "check-valve", "shut-in"],
)
def test_flow_through_all_tools(fluid, speed, tmp_path):
    """2 pi n Q turns the rotor, 14.44 rad/s at 30 l/s, less 0.3 % by the torque of the bit; mud that flows up turns it backwards."""
    shut_in = "choke" in fluid
    case = combined(JAR, COLLAR, SHOCK, MOTOR, end=0.03 if shut_in else 0.1, **fluid)
    got, summary = history(case, tmp_path / "run")
    assert got["motor_speed"][0] == pytest.approx(speed, abs=0.05 * abs(speed) + 0.02)
    # sound in the closed annulus is damped by the integrator: 3.5 J are lost, 1.3 J at a tenth of the tolerance
    assert energy_share(summary) < (4e-3 if shut_in else 1e-3)
    assert not shut_in or summary["energy"]["error"] < 0


def test_pumps_started_during_the_run(tmp_path):
    """The flow reaches the motor after the sound's way down the bore, 500 m at about 1.2 km/s, and turns it then."""
    ramp = {"time": [0, 0.05, 0.15, 1], "value": [0, 0, 0.02, 0.02]}
    got, summary = history(combined(JAR, COLLAR, SHOCK, MOTOR, end=0.7, flow_rate=ramp), tmp_path / "run")
    assert np.abs(got["motor_speed"][got["time"] < 0.3]).max() < 1e-2
    assert got["motor_speed"].max() > 2.0
    assert energy_share(summary) < 1e-2
