"""Drilling strings with downhole tools in a deviated hole with mud."""

from __future__ import annotations

from typing import Any

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
REAMER = {
    "kind": "reamer",
    "length": 1.5,
    "od": 0.2667,
    "id": 0.07,
    "mass": 250.0,
    "body_od": 0.19,
    "blade_length": 0.5,
    "blade_position": 0.4,
    "specific_energy": "40 MPa",
    "inclination_ratio": 0.6,
}
AGITATOR = {
    "kind": "agitator",
    "length": 3.0,
    "od": 0.165,
    "id": 0.06,
    "pressure_loss": {"value": "600 psi", "at": "30 l/s", "density": 1200},
    "agitator": {
        "rev_per_volume": "0.5 rev/l",
        "pressure_amplitude": "250 psi",
        "piston_area": "25 cm2",
        "spring": "2 MN/m",
    },
}
STEER = {"kind": "push", "force": 3e3, "pad_offset": 1.0, "steer": {"tool_face": 1.0}}
STEERED = {"kind": "rss", "length": 4.0, "od": 0.1715, "id": 0.0714, "mass": 560, "rss": STEER}
DEPTH = 500.0


def _drilling(
    string: list[dict], sections: list[dict], wob: float, flow: float | str, end: float, fluid: dict
) -> dict:
    """A case with ``string`` in a hole that builds to 40 degrees, drilling with ``wob`` [N]; ``fluid``: keys over those of the mud."""
    survey = {"md": [0, 100, 400, DEPTH], "inclination": [0, 0, 0.7, 0.7], "azimuth": [0, 0, 0, 0]}
    mud = {
        "density": 1200,
        "rheology": {"model": "bingham", "plastic_viscosity": 0.02, "yield_stress": 5},
        "flow_rate": flow,
    }
    law = {"kind": "drag_bit", "blades": 4, "specific_energy": "40 MPa", "inclination_ratio": 0.6}
    return {
        "well": {"survey": survey, "sections": sections},
        "string": string,
        "top": {"kind": "top_drive", "rotation": "30 rpm"},
        "bottom": {"kind": "bit"},
        "initial": {"wob": wob},
        "fluid": mud | fluid,
        "formation": {"bit_law": law},
        "time": {"end": end},
        "output": {"history_every": 0.01},
    }


def combined(*tools: dict, end: float = 0.1, **fluid: Any) -> dict:
    """A drilling string with ``tools`` above the bit, without flow unless ``fluid`` has one."""
    string = [dict(PIPE), *(dict(t) for t in tools), dict(BIT)]
    string[0]["length"] = DEPTH - 3 - sum(q["length"] for q in string[1:])
    sections = [{"to": DEPTH, "kind": "open_hole", "diameter": BIT["od"], "friction": 0.25}]
    return _drilling(string, sections, 40e3, 0.0, end, fluid)


def whole_string(two: bool = False, end: float = 0.02, **fluid: Any) -> dict:
    """From the top: pipe, agitator, pipe, jar, collars, reamer, shock sub, motor, steerable tool, bit.

    two: two agitators, two jars and two reamers.
    """
    upper = {**AGITATOR, "agitator": {**AGITATOR["agitator"], "rev_per_volume": "0.4 rev/l"}}
    short = {**COLLAR, "length": 10.0}
    second = [upper, {**PIPE, "length": 60.0}] if two else []
    jars = [dict(JAR), short, {**JAR, "jar": {**JAR["jar"], "threshold": 150e3}}] if two else [dict(JAR)]
    reamers = [{**REAMER, "od": 0.3112}, short, dict(REAMER)] if two else [dict(REAMER)]
    tools = [
        *second, dict(AGITATOR), {**PIPE, "length": 100.0}, *jars, dict(COLLAR), *reamers, dict(SHOCK),
        dict(MOTOR), dict(STEERED),
    ]  # fmt: skip
    string = [dict(PIPE), *tools, dict(BIT)]
    string[0]["length"] = DEPTH - sum(q["length"] for q in string[1:])
    depth, sections = 0.0, []
    for item in string:
        if item["kind"] == "reamer":
            cutters = depth + item["length"] - item["blade_position"] + 0.5 * item["blade_length"]
            sections.append({"to": cutters, "kind": "open_hole", "diameter": item["od"], "friction": 0.25})
        depth += item["length"]
    sections.append({"to": DEPTH, "kind": "open_hole", "diameter": BIT["od"], "friction": 0.25})
    return _drilling(string, sections, 15e3 if two else 40e3, "30 l/s", end, fluid) | {
        "top": {"kind": "top_drive", "rotation": "60 rpm", "lowering": "10 m/h"}
    }
