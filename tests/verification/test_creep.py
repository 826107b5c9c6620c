"""Friction that holds a string creeps, and the summary says how fast (manual: eq-contact-creep)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run

SLIP = 0.01  # [m/s]
TILT, FRICTION, G = (
    np.radians(70.0),
    0.6,
    9.81,
)  # a string on a slope slides down with cos, is pressed on with sin


def on_a_slope(folder, slip: float, lowering=None) -> list[str]:
    """A free straight string that lies in a slope below the angle of friction: its weight is held by friction."""
    case = Case(
        well={
            "survey": {"md": [0, 100], "inclination": [TILT, TILT], "azimuth": [0, 0]},
            "sections": [{"to": 100, "kind": "open_hole", "diameter": 0.2159, "friction": FRICTION}],
        },
        string=[{"kind": "pipe", "length": 40, "od": 0.127, "id": 0.1086, "element_length": 5}],
        top="free" if lowering is None else {"kind": "top_drive", "lowering": lowering},
        contact={"slip_velocity": slip},
        initial={"from": "rest"},
        gravity=G,
        time={"end": 1.5},
    )
    return [w for w in run(case, folder, progress="silent").summary["warnings"] if "creep" in w]


@pytest.mark.parametrize("slip", [0.01, 0.002])
def test_the_creep_of_a_held_string_is_told(slip, tmp_path):
    """F/N = cot(inclination) = 0.364 of mu = 0.6: v = slip F/sqrt((mu N)^2 - F^2) = 0.763 slip, within 5 % after 1.5 s."""
    (warning,) = on_a_slope(tmp_path / "run", slip)
    creep = 1e-3 * float(warning.split("creep of ")[1].split(" mm/s")[0])
    ratio = 1 / np.tan(TILT)
    assert creep == pytest.approx(slip * ratio / np.sqrt(FRICTION**2 - ratio**2), rel=0.05)
    assert "contact.slip_velocity" in warning


def test_a_string_that_is_lowered_is_not_held(tmp_path):
    assert on_a_slope(tmp_path / "run", SLIP, lowering=0.1) == []
