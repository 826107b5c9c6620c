"""Modes about rest of a string on the wall: contacts are springs without friction (manual:
verif-modes-on-the-wall)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.linear.modal import modes, prepare_state
from drillpetsc.model.drilling_model import build_model

LENGTH, CLEARANCE, YOUNG, POISSON, DENSITY, G = 200.0, 0.04445, 206e9, 0.3, 7850.0, 9.81


def lying(friction: float, **keys):
    """Drill pipe on the low side of a horizontal hole, held at the top, free at its lower end."""
    survey = {"md": [0, LENGTH + 10], "inclination": [0.5 * np.pi] * 2, "azimuth": [0, 0]}
    section = {"to": LENGTH + 10, "kind": "open_hole", "diameter": 0.2159, "friction": friction}
    whole = {
        "well": {"survey": survey, "sections": [section]},
        "string": [{"kind": "pipe", "length": LENGTH, "od": 0.127, "id": 0.1086, "element_length": 5.0}],
        "gravity": G,
        "top": {"kind": "top_drive", "rotation": {"ramp": 1.0, "value": 6.0}},
        "bottom": "free",
    }
    case = Case(**(whole | keys))
    model = build_model(case)
    prepare_state(model, "rest")
    return model


@pytest.mark.parametrize("friction", [0.0, 0.25])
def test_a_lying_pipe_swings_without_friction(friction):
    """Torsion and axial motion of a rod with one fixed and one free end, sqrt(G/rho)/4L and sqrt(E/rho)/4L, and
    the swing of a mass on the inside of a circle of the clearance, sqrt(g/r)/2 pi: long waves of the pipe are a
    little faster (E I k^4), the lowest one by less than 0.5 %.  No mode is damped."""
    model = lying(friction)
    shear = YOUNG / (2 * (1 + POISSON))
    expected = {
        "torsional": np.sqrt(shear / DENSITY) / (4 * LENGTH),
        "axial": np.sqrt(YOUNG / DENSITY) / (4 * LENGTH),
        "lateral": np.sqrt(G / CLEARANCE) / (2 * np.pi),
    }
    for kind, frequency in expected.items():
        found = modes(model, count=1, kind=kind)
        lowest = int(np.argmin(np.where(found.frequency > 0, found.frequency, np.inf)))
        assert found.frequency[lowest] == pytest.approx(frequency, rel=5e-3)
        assert abs(found.damping_ratio[lowest]) < 1e-8


@pytest.mark.parametrize(
    "law", [None, {"kind": "velocity_weakening", "static": 9e3, "dynamic": 5e3, "speed": 0.1}]
)
def test_a_bit_on_bottom_turns_freely_at_rest(law):
    """Torsion of a vertical string with its bit on bottom: sqrt(G/rho)/4L as for a free end, whatever the torque
    of the bit."""
    survey = {"md": [0, LENGTH], "inclination": [0, 0], "azimuth": [0, 0]}
    model = lying(
        0.3,
        well={"survey": survey, "sections": [{"to": LENGTH, "kind": "open_hole", "diameter": 0.2159}]},
        bottom="bit",
        initial={"from": "statics", "wob": 1e3},
        **({} if law is None else {"formation": {"bit_law": law}}),
    )
    found = modes(model, count=1, kind="torsional")
    lowest = int(np.argmin(np.where(found.frequency > 0, found.frequency, np.inf)))
    assert found.frequency[lowest] == pytest.approx(np.sqrt(YOUNG / 2.6 / DENSITY) / (4 * LENGTH), rel=5e-3)
    assert abs(found.damping_ratio[lowest]) < 1e-8
