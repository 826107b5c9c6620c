"""Buckled strings that turn: states at the end of a path (manual: sec-statics-path)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, statics
from drillpetsc.analysis.loads.torque_drag.roadmap import run_roadmap
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from tests.helpers.wells import simple_well
from tests.verification.test_roadmap_command import case
from tests.verification.test_statics_report import BENDING, CLEARANCE, PIPE, WEIGHT, pushed, straight

FRICTION, RADIUS = 0.25, 0.0635


def helix(force: float) -> float:
    """Wall force of a helix, r F^2/4EI [N/m] (Lubinski, Althouse and Logan, JPT 14(6), 1962)."""
    return CLEARANCE * force**2 / (4 * BENDING)


def wall_force(table: dict) -> np.ndarray:
    """Wall force on each element [N], from its means at the nodes."""
    force, md = table["contact_force [N/m]"], table["md [m]"]
    return 0.5 * (force[1:] + force[:-1]) * np.diff(md)


def one_handed(table: dict, length: float) -> np.ndarray:
    """Nodes about which the string winds with one hand over +-``length`` [m]."""
    md = table["md [m]"]
    phase = np.unwrap(np.arctan2(table["offset_y [m]"], table["offset_x [m]"]))
    rate = np.sign(np.diff(phase))
    middle = 0.5 * (md[1:] + md[:-1])
    return np.array([len(set(rate[np.abs(middle - s) <= length])) == 1 for s in md])


def test_a_turning_helix_presses_on_the_wall_as_theory_says(tmp_path) -> None:
    """Nothing of the push is lost along the string, the wall force is r F^2/4EI within 3 % where the helix has one hand
    (weight averages out over a turn), and the torque is mu R times the sum of the wall forces.
    """
    force = 450e3
    level = pushed(force, length=200.0, element=2.5, well=straight(90.0, 200.0, FRICTION))
    result = statics(level, tmp_path / "out", motion="rotate", path="sliding")
    summary, table = result.summary, read_table(result.folder / "statics.csv")
    assert [q["start"] for q in summary["path_states"]] == ["straight", "overload"]
    assert any("steady turning" in w for w in summary["warnings"])
    assert summary["wob"] == pytest.approx(force, rel=2e-4)
    total = wall_force(table).sum()
    assert summary["surface_torque"] == pytest.approx(FRICTION * RADIUS * total, rel=1e-2)
    pitch = 2 * np.pi * np.sqrt(2 * BENDING / force)
    middle = one_handed(table, pitch)
    assert middle.sum() > 5
    assert table["contact_force [N/m]"][middle].mean() == pytest.approx(helix(force), rel=0.03)
    # reversals of hand take up to a fifth of it
    for state in summary["path_states"]:
        assert 0.8 < state["surface_torque"] / (FRICTION * RADIUS * helix(force) * 200.0) < 1.03


def test_an_unbuckled_turning_string_has_the_torque_of_its_weight(tmp_path) -> None:
    """mu R w L below the sinusoidal load of 163 kN."""
    level = pushed(100e3, well=straight(90.0, 300.0, FRICTION))
    summary = statics(level, tmp_path / "out", motion="rotate", path="sliding").summary
    assert summary["surface_torque"] == pytest.approx(FRICTION * RADIUS * WEIGHT * 300.0, rel=5e-3)
    assert summary["wob"] == pytest.approx(100e3, rel=1e-4)


def on_bit(wob: float, inclination: float, rotation: float, lowering: float, length: float = 300.0) -> Case:
    return Case(
        well=straight(inclination, length, FRICTION),
        string=[
            {**PIPE, "length": length - 0.5, "element_length": 3.0},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0},
        ],
        top={"kind": "top_drive", "rotation": rotation, "lowering": lowering},
        bottom={"kind": "bit"},
        gravity=9.81,
        initial={"from": "statics", "wob": wob},
    )


def test_friction_of_a_string_that_turns_and_slides_is_shared(tmp_path) -> None:
    """Friction opposes the surface's velocity (V, Omega R): of a helix the push falls by dF/dz = mu r F^2/4EI V/|v|, so that
    1/F falls linearly (reversals of hand take up to a fifth), and R times what is lost is the torque, times Omega R/V.
    A pipe that winds with slope r sqrt(F/2EI) turns the axial part about its own axis, one way for each hand.  The push is a
    force on the lower end.
    """
    force, speed, spin, length = 450e3, 0.1, 1.0, 200.0
    made = Case(
        well=straight(90.0, length, FRICTION),
        string=[{**PIPE, "length": length, "element_length": 2.5}],
        top={"kind": "top_drive", "rotation": spin, "lowering": speed},
        bottom={"kind": "force", "force": [-force * np.cos(0.3), -force * np.sin(0.3), 0.0]},
        gravity=9.81,
    )
    share = speed / np.hypot(speed, spin * RADIUS)
    most = 1 / (1 / force - FRICTION * share * CLEARANCE * length / (4 * BENDING))
    slope = CLEARANCE * np.sqrt(most / (2 * BENDING))
    for state in statics(made, tmp_path / "out", path="sliding").summary["path_states"]:
        lost = -state["hook_load"] - force
        assert 0.8 < lost / (most - force) < 1.03
        own = slope * speed / (spin * RADIUS) + 0.005
        assert state["surface_torque"] == pytest.approx(lost * spin * RADIUS / speed * RADIUS, rel=own)


def test_the_bit_adds_its_torque(tmp_path) -> None:
    """mu W 2/3 of the bit's radius; the rest is mu R times the wall's force, with the bit's own at its own radius."""
    result = statics(on_bit(200e3, 90.0, 10.0, 0.0), tmp_path / "out", path="sliding")
    summary = result.summary
    assert summary["wob"] == pytest.approx(200e3, rel=1e-3)
    assert summary["bit_torque"] == pytest.approx(0.3 * 200e3 * 0.2159 / 3, rel=2e-3)
    table, bit = (
        read_table(result.folder / "statics.csv"),
        summary["rigid_items"][-1]["contact_force_sum [N]"],
    )
    expected = FRICTION * (RADIUS * wall_force(table).sum() + 0.2159 / 2 * bit)
    assert summary["surface_torque"] - summary["bit_torque"] == pytest.approx(expected, rel=0.01)


def test_a_string_that_turns_and_slides_has_a_stable_state(tmp_path) -> None:
    """A vertical string of 500 m, 150 kN on its bit, that turns and is lowered: its paths ended in a state with a negative pivot."""
    case = on_bit(150e3, 0.0, 10.0, 0.2, length=500.0)
    summary = statics(case, tmp_path / "out").summary
    assert summary["wob"] == pytest.approx(150e3, rel=1e-3)
    hanging = WEIGHT * 499.5 + 60 * 9.81 - 150e3
    assert summary["hook_load"] < hanging and summary["surface_torque"] > summary["bit_torque"]
    assert summary["stable"]


def test_a_roadmap_has_rows_of_buckled_strings(tmp_path) -> None:
    """Sliding with a weight above the helical load: the row is that of a path of steady sliding, between the friction of the
    weight and that of a helix all along."""
    plan = {
        "operations": ["sliding", "drilling"],
        "bit_depth": [300],
        "friction_factor": {"open_hole": [FRICTION]},
        "drilling": {"wob": 300e3, "tob": 1000.0},
        "sliding": {"wob": 300e3, "tob": 0},
    }
    result = run_roadmap(Job(case([0, 300], [90, 90], roadmap=plan), tmp_path / "r"), model="stiff")
    table = read_table(result.folder / "roadmap.csv")
    rows = {name: i for i, name in enumerate(table["operation [-]"])}
    push = -table["hook_load [N]"]
    slid = push[rows["sliding"]]
    most = 1 / (1 / 300e3 - FRICTION * CLEARANCE * 300 / (4 * BENDING))
    assert 300e3 + FRICTION * WEIGHT * 300 < slid < most
    assert "one of several states" in table["status [-]"][rows["sliding"]]
    torque = table["surface_torque [N m]"][rows["drilling"]] - 1000.0
    assert FRICTION * RADIUS * WEIGHT * 300 < torque < 1.03 * FRICTION * RADIUS * helix(300e3) * 300


def test_a_string_that_its_weight_pushes_into_a_level_hole_has_a_path(tmp_path) -> None:
    """Coiled tubing run 1300 m into a level hole: the hook load is below the weight of the vertical part by the friction of the
    level one, w mu L, and of the curve, at least, from both starts: the overload is a push on the lower end that comes and goes.
    """
    tubing = {"kind": "pipe", "od": 0.0603, "id": 0.0507, "element_length": 4.0}
    made = Case(
        well=simple_well(
            [0.0, 600.0, 900.0, 2200.0],
            0.1143,
            [0.0, 0.0, np.pi / 2, np.pi / 2],
            kind="casing",
            friction=FRICTION,
        ),
        string=[{**tubing, "length": 2200.0}],
        top={"kind": "top_drive", "lowering": 0.2},
        bottom="free",
        gravity=9.81,
    )
    summary = statics(made, tmp_path / "out", path="sliding").summary
    weight = 7850 * 9.81 * np.pi / 4 * (0.0603**2 - 0.0507**2)
    hanging = weight * (600.0 + 300.0 * 2 / np.pi)
    assert [state["start"] for state in summary["path_states"]] == ["straight", "overload"]
    for state in summary["path_states"]:
        assert 0 < state["hook_load"] < hanging - FRICTION * weight * 1300.0
    assert summary["path_states"][0]["change"] < 2e-3 and summary["buckling"]["sinusoidal"]


def test_a_turning_string_that_slides_on_is_not_told_as_sliding(tmp_path) -> None:
    """Pipe that a level hole's friction does not resist while it turns coils above the bend. Its axial forces are those without
    friction along the hole: the hook carries the buoyed weight of the vertical depth less the weight on bit."""
    radius = 300.0 / (np.pi / 2)
    survey = {
        "md": [0.0, 1200.0, 1500.0, 2400.0],
        "inclination": [0, 0, "90 deg", "90 deg"],
        "azimuth": [0.0] * 4,
    }
    sections = [{"to": 2400.0, "kind": "open_hole", "diameter": 0.1556, "friction": 0.25}]
    string = [
        {"kind": "pipe", "length": 2399.7, "od": 0.0889, "id": 0.0702},
        {"kind": "bit", "length": 0.3, "od": 0.1556, "mass": 30.0},
    ]
    weight = 7850 * np.pi / 4 * (0.0889**2 - 0.0702**2) * 9.80665
    result = statics(
        Case(
            well={"survey": survey, "sections": sections},
            string=string,
            top={"kind": "top_drive", "rotation": "80 rpm"},
            bottom={"kind": "bit", "friction": 0.0},
            initial={"wob": 60e3},
        ),
        tmp_path / "out",
    )
    assert result.summary["path"] == "sliding" and result.summary["buckling"]["helical"]
    said = [line for line in result.summary["warnings"] if line.startswith("question answered")]
    assert len(said) == 1 and "steady turning" in said[0]
    assert not any("held by friction" in line for line in result.summary["warnings"])
    vertical = (1200.0 + radius) * weight
    assert result.summary["hook_load"] == pytest.approx(vertical - 60e3, rel=2e-3)
