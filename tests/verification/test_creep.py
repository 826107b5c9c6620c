"""Friction that holds a string creeps, and the summary says how fast (manual: eq-contact-creep)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run
from tests.helpers.wells import simple_well

SLIP = 0.01  # [m/s]
TILT, FRICTION, G = (
    np.radians(70.0),
    0.6,
    9.81,
)  # a string on a slope slides down with cos, is pressed on with sin


def on_a_slope(folder, slip: float, lowering=None) -> list[str]:
    """A free straight string that lies in a slope below the angle of friction: its weight is held by friction."""
    case = Case(
        well=simple_well(100, 0.2159, TILT, friction=FRICTION),
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


def slides(folder, lowering, **contact):
    """Hook load over weight, and warnings, of a string that its top lowers along a slope without turning."""
    case = Case(
        well={
            "survey": {"md": [0, 400], "inclination": [np.radians(62)] * 2, "azimuth": [0, 0]},
            "sections": [{"to": 400, "kind": "open_hole", "diameter": 0.2159, "friction": 0.24}],
        },
        string=[{"kind": "pipe", "length": 250, "od": 0.127, "id": 0.1086, "element_length": 10}],
        top={"kind": "top_drive", "lowering": lowering},
        contact=contact,
        gravity=G,
        time={"end": 4.0},
    )
    done = run(case, folder, progress="silent")
    weight = 7850 * np.pi / 4 * (0.127**2 - 0.1086**2) * 250 * G
    return done.history["hook_load"][-1] / weight, done.summary["warnings"]


def test_a_string_that_slides_at_the_rate_of_drilling_has_its_full_drag(tmp_path):
    """Hook load W (cos 62 - 0.24 sin 62) at 9 m/h; with a slip velocity of 10 mm/s a quarter of the drag is left, and a word says so."""
    drag = 0.24 * np.sin(np.radians(62))
    load, warnings = slides(tmp_path / "default", "9 m/h")
    assert load == pytest.approx(np.cos(np.radians(62)) - drag, abs=0.004 * drag)
    assert not any("creep" in w for w in warnings)
    load, warnings = slides(tmp_path / "rounded", "9 m/h", slip_velocity=0.01)
    rounded = drag * 0.0025 / np.hypot(0.0025, 0.01)
    assert load > np.cos(np.radians(62)) - 0.9 * drag  # on its way to the load with the rounded drag
    assert load < np.cos(np.radians(62)) - 0.9 * rounded
    assert any("contact.slip_velocity" in w for w in warnings)


def test_slip_velocity_follows_the_slowest_sliding():
    def slip(**top):
        return Case(
            well=simple_well(400, 0.2159, 1),
            string=[{"kind": "pipe", "length": 400, "od": 0.127, "id": 0.1086}],
            top={"kind": "top_drive", **top},
            bottom="bit",
        ).contact.slip_velocity

    pieces = {"time": [0, 5, 6, 60], "value": ["0 m/h", "18 m/h", "36 m/h", "36 m/h"]}
    assert slip(lowering=pieces) == pytest.approx(0.005 / 20)
    assert slip(lowering={"ramp": 2, "value": -0.1}) == pytest.approx(0.005)
    drill = {"hoist": {"block_mass": 3e4, "line": {"diameter": 0.035}}, "autodriller": {"wob": 5e4}}
    assert slip(**drill) == pytest.approx(5 / 3600 / 20)
    assert slip(lowering=0.5) == slip(lowering=0.001, rotation=8) == slip() == 0.01
