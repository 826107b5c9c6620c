"""A drilling string with every downhole tool, in a deviated hole with mud."""

from __future__ import annotations

from typing import Any

from tests.verification.test_tools_together import BIT, COLLAR, JAR, MOTOR, PIPE, SHOCK

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
        *second,
        dict(AGITATOR),
        {**PIPE, "length": 100.0},
        *jars,
        dict(COLLAR),
        *reamers,
        dict(SHOCK),
        dict(MOTOR),
        dict(STEERED),
    ]
    string = [dict(PIPE), *tools, dict(BIT)]
    string[0]["length"] = DEPTH - sum(q["length"] for q in string[1:])
    depth, sections = 0.0, []
    for item in string:
        if item["kind"] == "reamer":
            cutters = depth + item["length"] - item["blade_position"] + 0.5 * item["blade_length"]
            sections.append({"to": cutters, "kind": "open_hole", "diameter": item["od"], "friction": 0.25})
        depth += item["length"]
    sections.append({"to": DEPTH, "kind": "open_hole", "diameter": BIT["od"], "friction": 0.25})
    survey = {"md": [0, 100, 400, 500], "inclination": [0, 0, 0.7, 0.7], "azimuth": [0, 0, 0, 0]}
    return {
        "well": {"survey": survey, "sections": sections},
        "string": string,
        "top": {"kind": "top_drive", "rotation": "60 rpm", "lowering": "10 m/h"},
        "bottom": {"kind": "bit"},
        "initial": {"wob": 15e3 if two else 40e3},
        "fluid": {
            "density": 1200,
            "rheology": {"model": "bingham", "plastic_viscosity": 0.02, "yield_stress": 5},
            "flow_rate": "30 l/s",
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
