"""Which hole and which string a row of a roadmap stands for: `hole_grows`, and bit depths beyond the string of the case."""

from __future__ import annotations

import json

import numpy as np
import pytest

from drillpetsc.analysis.commands.check import command_lines
from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.analysis.loads.torque_drag.roadmap import run_roadmap
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.output.job import Job
from tests.verification.test_roadmap_command import case, rows

MUD = {
    "density": 1200,
    "rheology": {"model": "bingham", "plastic_viscosity": "20 cP", "yield_stress": "5 Pa"},
}
PLAN = {
    "bit_depth": [900],
    "friction_factor": {"cased": [0.2], "open_hole": [0.3]},
    "drilling": {"wob": "40 kN", "flow_rate": "30 L/s"},
    "sliding": {"wob": "20 kN", "flow_rate": "30 L/s"},
}


def build(count: int, **plan) -> Case:
    """A casing to 400 m, then open hole through the first stations: 900 m with 4 of them, to 2000 m with 6."""
    md, inclination = [0, 400, 700, 900, 1400, 2000], [0, 0, 30, 40, 80, 20]
    sections = [
        {"to": "400 m", "kind": "casing", "diameter": "224 mm", "friction": 0.2},
        {"to": "end", "kind": "open_hole", "diameter": "215.9 mm", "friction": 0.3},
    ]
    return case(
        md[:count], inclination[:count], sections=sections, length=900, fluid=MUD, roadmap=PLAN | plan
    )


@pytest.mark.parametrize("model", ["soft", "stiff"])
def test_the_hole_below_the_bit_changes_no_row(model, tmp_path):
    """A hole that ends at the bit and one that goes on for 1100 m with other curvature give the same rows, with flowing mud, too."""
    plan = {} if model == "soft" else {"operations": ["rotate_off_bottom", "sliding"]}
    deep = rows(build(6, hole_grows=True, **plan), tmp_path, model=model)
    short = rows(build(4, **plan), tmp_path, model=model)
    assert deep.keys() == short.keys() and len(deep) == (6 if model == "soft" else 2)
    tolerance = {"rel": 1e-9, "abs": 1e-6} if model == "soft" else {"rel": 2e-4, "abs": 5.0}
    for key, row in deep.items():
        for name, value in row.items():
            expected = short[key][name]
            if isinstance(value, str):
                assert value == expected
            else:
                assert value == pytest.approx(expected, nan_ok=True, **tolerance), (key, name)


def test_hole_grows_is_recorded(tmp_path):
    result = run_roadmap(Job(build(6, hole_grows=True), tmp_path / "run"))
    assert json.loads((result.folder / "roadmap.json").read_text())["hole_grows"] is True
    assert any("the open hole ends at the bit" in note for note in result.summary["notes"])
    assert not any(
        "ends at the bit" in n for n in run_roadmap(Job(build(6), tmp_path / "no")).summary["notes"]
    )


def test_hole_grows_is_true_or_false():
    with pytest.raises(CaseError, match=r"roadmap\.hole_grows"):
        build(6, hole_grows="yes")


@pytest.mark.parametrize(
    "depths, told", [([400, 500], ""), ([700], "bit at 700 m"), ([400, 600, 700], "bit at 600 m to 700 m")]
)
def test_a_lengthened_string_is_told(depths, told, tmp_path):
    """500 m of pipe with the bit at 700 m: the weight is that of 700 m, and a note says so; not where the string is cut."""
    plan = {"bit_depth": depths, "operations": ["rob"]}
    made = case([0, 1000], [0, 0], length=500, roadmap=plan)
    result = run_roadmap(Job(made, tmp_path / "run"))
    notes = [note for note in result.summary["notes"] if "is lengthened" in note]
    assert bool(notes) == bool(told) and len(notes) <= 1
    if told:
        assert notes[0].startswith(told) and "the string of the case is 500 m long" in notes[0]
    found = rows(made, tmp_path)["rotate_off_bottom", 0.3, depths[-1]]
    assert found["hook_load"] == pytest.approx(242 * depths[-1], rel=1e-6)


CASING = {"kind": "pipe", "od": "244.5 mm", "id": "220.5 mm"}
SHOE = [
    {"to": "1000 m", "kind": "casing", "diameter": "315 mm"},
    {"to": "end", "kind": "open_hole", "diameter": "215.9 mm"},
]


@pytest.mark.parametrize("model", ["soft", "stiff"])
def test_casing_fits_down_to_the_shoe_of_the_wider_hole(model, tmp_path):
    """9 5/8 in casing is run in a 315 mm casing, not in the 8 1/2 in hole below: there is no number there, and a warning."""
    plan = {"bit_depth": [500, 1000, 1001, 1500], "operations": ["trip_in", "rob"]}
    made = case([0, 1500], [0, 0], length=900, item=CASING, sections=SHOE, roadmap=plan)
    found = rows(made, tmp_path, model=model)
    for (_, _, depth), row in found.items():
        if depth <= 1000:
            assert row["status"] == "ok" and row["hook_load"] > 0
        else:
            assert row["status"].startswith("failed: ") and "244.5 mm, does not fit" in row["status"]
            assert np.isnan(row["hook_load"]) and "MD 1000 m" in row["status"]
    warnings = run_roadmap(Job(made, tmp_path / "run"), model=model).summary["warnings"]
    assert any("does not fit the open hole of 215.9 mm" in text for text in warnings)


def test_a_string_that_does_not_fit_is_told_by_check_and_refused_by_calibrate():
    plan = {"bit_depth": [500, 1500], "operations": ["trip_in"]}
    made = case([0, 1500], [0, 0], length=900, item=CASING, sections=SHOE, roadmap=plan)
    assert any("does not fit at 1 of the bit depths, first at 1500 m" in line for line in command_lines(made))
    point = {"operation": "trip_in", "bit_depth": 1500, "hook_load": "1 MN"}
    with pytest.raises(CaseError, match=r"measured\[0\]\.bit_depth"):
        Calibration(made, (MeasuredPoint.model_validate(point),))
