"""Rigid items on the wall: a stabilizer as the middle support of a beam (manual: verif-stabilizer)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.equilibrium import StaticState
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.doubts.moments import Answer
from drillpetsc.doubts.place import deep_in_wall
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output import read_table
from drillpetsc.output.static_table import static_table

SPAN, STABILIZER, HOLE, WEIGHT, MASS, G = 30.0, 0.212, 0.2159, 242.0, 50.0, 9.81
AREA, BENDING = 3.4047325e-3, 1.2240289e6  # of a pipe of 127 x 108.6 mm [m2], [N m2]
STAND_OFF = 0.5 * (HOLE - STABILIZER)
STIFFNESS = 1e8  # of the wall [N/m2]


def support_load(length: float = 0.0) -> float:
    """Load [N] on the stiff middle piece of ``length`` [m] of a beam that is clamped at both ends.

    Each half of length l has no rotation in the middle: it would sink there by w l^4/24 EI, and a force moves it
    by F l^3/12 EI (Gere and Goodno, Mechanics of Materials, tables H-1 and H-2).  The support is lower by the
    stand-off and the depth in the wall, F over k times the length (or the diameter, at one point).
    """
    half = 0.5 * (SPAN - length)
    return (WEIGHT * half + MASS * G - 24 * BENDING / half**3 * STAND_OFF) / (
        1 + 24 * BENDING / half**3 / (STIFFNESS * (length or STABILIZER))
    )


def supported(length: float, **keys) -> tuple[DrillingModel, StaticState]:
    """A horizontal pipe in a hole, clamped at both ends on its axis, with a stabilizer of ``length`` [m] in the
    middle; the pipe itself does not touch."""
    pipe = {"kind": "pipe", "length": 0.5 * (SPAN - length), "od": 0.127, "id": 0.1086, "element_length": 1.0}
    pipe["material"] = {"density": WEIGHT / G / AREA}
    survey = {"md": [0.0, SPAN], "inclination": [0.5 * np.pi] * 2, "azimuth": [0.0, 0.0]}
    case = Case(
        well={
            "survey": survey,
            "sections": [{"to": SPAN, "kind": "casing", "diameter": HOLE, "friction": 0.0}],
        },
        string=[pipe, {"kind": "stabilizer", "length": length, "od": STABILIZER, "mass": MASS}, pipe],
        top="clamped",
        bottom="clamped",
        gravity=G,
        **{"contact": {"stiffness": STIFFNESS}, **keys},
    )
    model = build_model(case)
    return model, find_equilibrium(model)


def test_a_stabilizer_without_length_touches_at_one_point():
    """It stands off the wall by its clearance and sinks into it as an item as long as its diameter would, F/(k
    od) (manual: sec-contact-quadrature).  Without contact the middle would hang 0.36 m deeper and lie on the wall."""
    model, _ = supported(0.0)
    node = next(b.node for b in model.mesh.bodies)
    sinking = support_load() / (STIFFNESS * STABILIZER)
    assert model.system.field("string.position")[node, 2] == pytest.approx(
        STAND_OFF + sinking, abs=0.02 * sinking
    )


@pytest.mark.parametrize("length", [0.0, 0.2])
def test_a_stabilizer_in_the_middle_carries_the_support_load(length):
    """Table and summary of statics have the closed-form support load, within 0.5 %; in 0.1.0 all were
    zero."""
    model, state = supported(length)
    summary = static_summary(model, state)
    (item,) = summary["rigid_items"]
    load = support_load(length)
    assert item["name"] == "stabilizer" and item["md [m]"] == pytest.approx(SPAN / 2)
    assert item["side_force [N]"] == pytest.approx(load, rel=5e-3)
    columns, table = static_table(model)
    column = table[:, [name for name, _ in columns].index("item_side_force")]
    node = model.mesh.bodies[0].node
    assert column[node] == pytest.approx(item["side_force [N]"], rel=1e-12)
    assert np.count_nonzero(column) == 1


def test_the_history_has_the_side_force_on_request(tmp_path):
    """A run from statics at rest: the support load in every row of `side_force_15` and at the end in the summary;
    without `output.item_forces` no such column."""
    keys = {"time": {"end": 0.02}, "output": {"history_every": 0.01, "item_forces": True}}
    result = run(supported(0.2, **keys)[0].case, tmp_path / "run", progress="silent")
    force = read_table(tmp_path / "run" / "history.csv")["side_force_15 [N]"]
    assert force == pytest.approx(np.full(3, support_load(0.2)), rel=5e-3)
    (item,) = result.summary["rigid_items"]
    assert item["side_force [N]"] == pytest.approx(force[-1], rel=1e-6)
    plain = run(supported(0.2, time={"end": 0.01})[0].case, tmp_path / "plain", progress="silent")
    assert not any(name.startswith("side_force") for name in plain.summary["final"])


def test_a_note_names_the_item_whose_penetration_is_large():
    """A stabilizer without length sinks into the wall by F/(k od), 0.19 mm or 10 % of its stand-off: its results depend on k.  Below
    3 %, on a wall of 1e10 Pa, nothing is said."""
    model, _ = supported(0.0)
    (note,) = deep_in_wall.sentences(Answer(model=model))
    assert note.startswith("stabilizer at MD 15 m depends on the wall stiffness")
    depth = support_load() / (STIFFNESS * STABILIZER)
    assert f"by {1e3 * depth:.2g} mm of its radial clearance of {1e3 * STAND_OFF:.2g} mm" in note
    assert depth > 0.03 * STAND_OFF
    hard, _ = supported(0.0, contact={"stiffness": 1e10})
    assert deep_in_wall.sentences(Answer(model=hard)) == []


def test_depth_of_an_item_is_that_in_the_hole(tmp_path):
    """A string of 60 m that stands in a hole of 200 m: its bit of 0.4 m ends at the bottom, in statics and a run.

    The depth had been that along the string.
    """
    case = Case(
        well={
            "survey": {"md": [0.0, 200.0], "inclination": [0.5] * 2, "azimuth": [0.0] * 2},
            "sections": [{"to": 200.0, "kind": "open_hole", "diameter": HOLE, "friction": 0.1}],
        },
        string=[
            {"kind": "pipe", "length": 59.6, "od": 0.127, "id": 0.1086, "element_length": 4.0},
            {"kind": "bit", "length": 0.4, "od": HOLE, "mass": MASS},
        ],
        top={"kind": "top_drive"},
        bottom="bit",
        initial={"from": "statics", "wob": 5e3},
        time={"end": 0.01},
    )
    model = build_model(case)
    (item,) = static_summary(model, find_equilibrium(model))["rigid_items"]
    assert item["md [m]"] == pytest.approx(200.0 - 0.2, abs=1e-9)
    (item,) = run(case, tmp_path / "run", progress="silent").summary["rigid_items"]
    assert item["md [m]"] == pytest.approx(200.0 - 0.2, abs=1e-9)


@pytest.mark.parametrize("stiffness", [1e8, 1e9])
def test_a_stabilizer_of_full_gauge_does_not_whirl(stiffness, tmp_path):
    """It turns below 9 m of collar whose mass is off its axis, and carries no more than the centrifugal force of the collar,
    m e Omega^2 L; the stiffness of the wall does not matter (manual: sec-contact-resultant).

    Friction round the hole had driven it on the spring of the wall until it rolled, with the side force Omega a sqrt(k l M) of the
    mass M that it carries, hundreds of kilonewtons."""
    length, eccentricity, spin, mass = 9.0, 2e-3, 4 * np.pi, 7850 * np.pi / 4 * (0.1778**2 - 0.0714**2)
    case = Case(
        well={
            "survey": {"md": [0.0, 20.0], "inclination": [0.0] * 2, "azimuth": [0.0] * 2},
            "sections": [{"to": 20.0, "kind": "open_hole", "diameter": HOLE, "friction": 0.3}],
        },
        string=[
            {
                "kind": "pipe",
                "length": length,
                "od": 0.1778,
                "id": 0.0714,
                "element_length": 3.0,
                "eccentricity": eccentricity,
            },
            {"kind": "stabilizer", "length": 0.5, "od": HOLE, "mass": MASS},
        ],
        top={"kind": "top_drive", "rotation": spin},
        bottom="free",
        contact={"stiffness": stiffness},
        time={"end": 1.5},
        output={"history_every": 0.01, "item_forces": True},
    )
    h = read_table(run(case, tmp_path / "run", progress="silent").folder / "history.csv")
    assert 0.0 < h["side_force_9.25 [N]"][1:].max() < mass * eccentricity * spin**2 * length
