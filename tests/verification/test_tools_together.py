"""Jar, shock sub and downhole motor in one string with mud: they run with the pumps on, off, reversed and shut in
(manual: sec-mud-joints, sec-motor-law)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.output import read_table

PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086, "length": 380.0}
COLLAR = {"kind": "pipe", "od": 0.165, "id": 0.071, "length": 90.0}
JAR = {
    "kind": "jar",
    "od": 0.165,
    "id": 0.06,
    "length": 9.0,
    "jar": {"stroke": 0.18, "metering_stroke": 0.1, "metering_resistance": 2.0e6, "threshold": 200e3},
}
SHOCK = {"kind": "shock_sub", "od": 0.165, "id": 0.06, "length": 4.0, "stiffness": 6e6, "damping": 20e3}
MOTOR = {
    "kind": "pdm",
    "od": 0.171,
    "id": 0.1,
    "length": 8.0,
    "pdm": {
        "rev_per_volume": "0.29 rev/gal",
        "no_load_pressure": "0.6 MPa",
        "stall_torque": 14e3,
        "lobes": [7, 8],
        "rotor_mass": 350,
        "eccentricity": 0.01,
        "rotor_inertia": 3.0,
    },
}
BIT = {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 60.0}


def combined(*tools: dict, end: float = 0.1, **fluid: Any) -> dict:
    """A drilling string with ``tools`` above the bit in a hole that builds to 40 degrees."""
    survey = {"md": [0, 100, 400, 500], "inclination": [0, 0, 0.7, 0.7], "azimuth": [0, 0, 0, 0]}
    string = [dict(PIPE), *(dict(t) for t in tools), BIT]
    string[0]["length"] = 500 - 3 - sum(q["length"] for q in string[1:])
    return {
        "well": {
            "survey": survey,
            "sections": [{"to": 500, "kind": "open_hole", "diameter": 0.2159, "friction": 0.25}],
        },
        "string": string,
        "top": {"kind": "top_drive", "rotation": "30 rpm"},
        "bottom": {"kind": "bit"},
        "initial": {"wob": 40e3},
        "fluid": {
            "density": 1200,
            "rheology": {"model": "bingham", "plastic_viscosity": 0.02, "yield_stress": 5},
            "flow_rate": 0.0,
        }
        | fluid,
        "formation": {
            "bit_law": {
                "kind": "drag_bit",
                "blades": 4,
                "specific_energy": "40 MPa",
                "inclination_ratio": 0.6,
            }
        },
        "time": {"end": end},
        "output": {"history_every": 0.01},
    }


def history(case: dict, out: Any) -> tuple[dict[str, np.ndarray], dict]:
    summary = run(Case(**case), out, progress="silent").summary
    return {k.split(" [")[0]: v for k, v in read_table(out / "history.csv").items()}, summary


def energy_share(summary: dict) -> float:
    """Error of the energy over the energy exchanged."""
    return abs(summary["energy"]["error_share"])


@pytest.mark.parametrize(
    "order",
    [(JAR, COLLAR, SHOCK, MOTOR), (MOTOR, COLLAR, SHOCK, JAR), (SHOCK, COLLAR, MOTOR, JAR)],
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
        ({"flow_rate": "30 l/s"}, 13.0),
        ({"flow_rate": "-5 l/s", "outlet_pressure": "10 MPa"}, -2.41),
        ({"check_valve": True}, 0.0),
        ({"choke": {"area": 1e-6}}, 0.0),
    ],
    ids=["trickle", "drilling", "reverse", "check-valve", "shut-in"],
)
def test_flow_through_all_tools(fluid, speed, tmp_path):
    """2 pi n Q turns the rotor, 13 rad/s at 30 l/s under the torque of the bit; mud that flows up turns it backwards."""
    got, summary = history(combined(JAR, COLLAR, SHOCK, MOTOR, **fluid), tmp_path / "run")
    assert got["motor_speed"][0] == pytest.approx(speed, abs=0.05 * abs(speed) + 0.02)
    assert energy_share(summary) < 1e-3


def test_pumps_started_during_the_run(tmp_path):
    """The flow reaches the motor after the sound's way down the bore, 500 m at about 1.2 km/s, and turns it then."""
    ramp = {"time": [0, 0.05, 0.15, 1], "value": [0, 0, 0.02, 0.02]}
    got, summary = history(combined(JAR, COLLAR, SHOCK, MOTOR, end=0.9, flow_rate=ramp), tmp_path / "run")
    assert np.abs(got["motor_speed"][got["time"] < 0.3]).max() < 1e-2
    assert got["motor_speed"].max() > 2.0
    assert energy_share(summary) < 1e-2
