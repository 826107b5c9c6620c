"""Strings whose top is held while their own stretch lets the bit stand on the bottom (manual: sec-statics-march)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, statics
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.analysis.statics.start.march import Marcher, axial_compliance, march
from drillpetsc.analysis.statics.steady_flow import freeze_flow
from drillpetsc.model.drilling_model import build_model

G = 9.81


def standing(
    depth: float,
    length: float,
    inclination: float = 0.0,
    friction: float = 0.25,
    element: float = 10.0,
    od: float = 0.127,
    bore: float = 0.1086,
    **keys,
) -> Case:
    """Pipe above a full-gauge bit in a straight hole [m, rad], its top pinned at the surface."""
    return Case(
        well={
            "survey": {"md": [0.0, depth], "inclination": [np.radians(inclination)] * 2, "azimuth": [0.0, 0.0]},
            "sections": [{"to": depth, "kind": "open_hole", "diameter": 0.2159, "friction": friction}],
        },
        string=[
            {"kind": "pipe", "length": length - 0.5, "od": od, "id": bore, "element_length": element},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0},
        ],
        **{"top": "pinned", "bottom": {"kind": "bit", "stiffness": 1e9}, "gravity": G, **keys},
    )  # fmt: skip


@pytest.mark.parametrize("room", [0.0, 2e-4, -1.0])
def test_a_bar_between_top_and_bottom(room, tmp_path):
    """A short collar of weight W leaves W/2 and the bit's own weight P on a stiff bottom; with room below the bit less.

    By superposition the push R obeys (W/2 + P) L/EA - R (L/EA + 1/k) = room.  Below zero: the bit hangs free.  Before, the
    start of statics hung below the bottom by its stretch.
    """
    length = 60.0
    hole = length + (room if room >= 0 else 1.0)
    case = standing(hole, length, friction=0.0, element=5.0, od=0.2032, bore=0.0714)
    model = build_model(case)
    weight = G * float(model.mesh.mass @ model.mesh.length)
    compliance = axial_compliance(model.mesh)
    stretch = (0.5 * weight + G * 60.0) * compliance
    expected = max(0.0, (stretch - (hole - length)) / (compliance + 1e-9))
    assert expected == 0.0 if room < 0 else expected > 0.0
    place_along_hole(model)
    freeze_flow(model)
    found = march(model, (1.0, 0.0))
    assert found is not None
    assert -found.axial_force[-1] == pytest.approx(expected, rel=5e-3, abs=1.0)
    summary = statics(case, tmp_path / "out", motion="lower").summary
    assert summary["wob"] == pytest.approx(expected, rel=5e-3, abs=1.0)
    assert summary["hook_load"] == pytest.approx(weight + G * 60.0 - summary["wob"], rel=1e-6)


@pytest.mark.parametrize(
    ("case", "motion", "most"),
    [
        (standing(1000.0, 1000.0), "lower", 70),  # refused: "friction did not converge in 12 rounds"
        (standing(1000.0, 1000.0, friction=0.4), "lower", 90),  # the same
        (standing(2000.0, 2000.0, friction=0.3), "lower", 150),  # the same
        (standing(2000.0, 2000.0, friction=0.3), "rotate", 240),  # "statics did not converge in 600 iterations"
        (standing(1500.0, 1500.0, inclination=3.0, friction=0.4), "rotate", 135),  # the same
        (standing(1500.0, 1500.0, inclination=20.0, friction=0.4), "rotate", 135),  # 251 iterations
        (standing(1000.0, 1000.0, top={"kind": "top_drive", "hinged": True}), "rotate", 105),  # 251
        (standing(1000.0, 1000.0, top={"kind": "top_drive"}), "lower", 70),
    ],
)  # fmt: skip
def test_a_string_that_stands_by_its_stretch_has_a_state(case, motion, most, tmp_path):
    """A stable state, or one that says that friction holds it or that it creeps on, in few iterations; hook load, weight on
    bit and the friction of the table's contact forces make up the weight."""
    result = statics(case, tmp_path / "out", motion=motion)
    summary = result.summary
    assert summary["iterations"] <= most
    said = (
        "unstable direction" if motion == "rotate" else "held by friction only"
    )  # no friction along a string that turns
    assert summary["stable"] or any(said in w for w in summary["warnings"])
    model = build_model(case)
    mesh, angle = model.mesh, float(case.well.survey.inclination[0])
    weight = G * (float(mesh.mass @ mesh.length) + sum(b.mass for b in mesh.bodies)) * np.cos(angle)
    contact = np.asarray(result.statics["contact_force"])
    side = float(0.5 * (contact[1:] + contact[:-1]) @ mesh.length)
    side += sum(item["contact_force_sum [N]"] for item in summary["rigid_items"])
    drag = case.well.sections[0].friction * side if motion == "lower" else 0.0
    assert summary["hook_load"] + summary["wob"] + drag == pytest.approx(weight, rel=0.02)


def test_the_band_of_theory_of_an_inclined_string(tmp_path):
    """Hook load of a pipe lowered at 45 deg (case D1b of issue 13) by integrating the push from the bit up.

    Friction of r F^2/4EI where the push exceeds 1.41 or 1.83 times 2 sqrt(EI w/r) (Chen, Lin and Cheatham 1990; Wu and
    Juvkam-Wold 1993), of the weight elsewhere; 1 % of the push on a mesh of 2.5 m.  In a vertical hole there is no band.
    """
    wob, initial = 250e3, {"from": "statics", "wob": 250e3}
    case = standing(2000.0, 2000.0, 45.0, element=2.5, initial=initial)
    model = build_model(case)
    place_along_hole(model)
    freeze_flow(model)
    band = Marcher(model, (1.0, 0.0)).band()
    assert band is not None and band.name == "hook_load"
    EI, gap = float(model.mesh.bending_stiffness[0]), 0.5 * (0.2159 - 0.127)
    w, step = G * float(model.mesh.mass[0]), 0.1
    for factor, value in ((np.sqrt(2), band.low), (1.83, band.high)):
        force = wob - 60.0 * G * np.cos(np.pi / 4)
        for _ in range(round(1999.5 / step)):
            side = w * np.sin(np.pi / 4)
            coils = force > factor * 2 * np.sqrt(EI * side / gap)
            force += step * (0.25 * (gap * force**2 / (4 * EI) if coils else side) - w * np.cos(np.pi / 4))
        assert value == pytest.approx(-force, abs=0.01 * wob)
    upright = build_model(standing(2000.0, 2000.0, element=2.5, initial=initial))
    place_along_hole(upright)
    freeze_flow(upright)
    assert Marcher(upright, (1.0, 0.0)).band() is None


def test_a_buckled_string_that_slides_says_that_its_force_is_one_of_a_band(tmp_path):
    """150 kN on the bit at 10 deg: the summary has the band by theory, and the note says how to find its states."""
    case = standing(1000.0, 1000.0, 10.0, element=5.0, initial={"from": "statics", "wob": 150e3})
    summary = statics(case, tmp_path / "out", motion="lower").summary
    if len(summary.get("path_states", ())) < 2:
        assert any("is not unique" in w and "--path sliding" in w for w in summary["warnings"])
    band = summary["helix_band"]
    assert band["name"] == "hook_load" and band["low"] < band["high"]
    assert band["low"] - 0.02 * 150e3 < summary["hook_load"] < band["high"] + 0.02 * 150e3
