"""What messages say: places, quoted commands, no rounding noise, no lines of foreign files."""

from __future__ import annotations

import pytest

from drillpetsc import Case
from drillpetsc.analysis.commands.check import describe
from drillpetsc.analysis.motion.summary import closing_lines
from drillpetsc.analysis.statics.answer import without_noise
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.case import load_case
from drillpetsc.errors import CaseError, Interrupted, SolveError
from drillpetsc.model.drilling_model import build_model
from tests.helpers.wells import newtonian

PIPE = {"kind": "pipe", "length": 30, "od": 0.127, "id": 0.1086, "element_length": 5}
COLLAR = {
    "kind": "pipe",
    "name": "drill collar",
    "length": 20,
    "od": 0.1715,
    "id": 0.0714,
    "element_length": 5,
}


def test_a_place_is_a_measured_depth_with_the_item():
    """The largest residual of a moved node in the second item is named by its depth and item."""
    model = build_model(Case(string=[PIPE, COLLAR], top={"kind": "top_drive"}))
    place_along_hole(model)
    x = model.system.field("string.position").copy()
    x[-1] += [0.0, 0.0, 0.5]  # the last element, from 45 to 50 m, is stretched by a tenth
    model.system.set_field("string.position", x)
    text = str(SolveError("no way", **model.system.locate_largest_residual(0.0)))
    assert "at MD 45 m (drill collar)" in text


@pytest.mark.parametrize(("output", "place"), [({}, "147.638 ft"), ({"units": "metric"}, "45 m")])
def test_a_place_is_in_the_units_of_the_case(output, place):
    """45 m = 147.638 ft, unless the output of the case of field units is asked for in metres."""
    pipe, collar = (
        item | {"length": f"{item['length']} m", "element_length": "5 m"} for item in (PIPE, COLLAR)
    )
    for item in (pipe, collar):
        item |= {key: f"{item[key]} m" for key in ("od", "id")}
    model = build_model(Case(units="field", string=[pipe, collar], top={"kind": "top_drive"}, output=output))
    place_along_hole(model)
    x = model.system.field("string.position").copy()
    x[-1] += [0.0, 0.0, 0.5]
    model.system.set_field("string.position", x)
    text = str(SolveError("no way", **model.system.locate_largest_residual(0.0)))
    assert f"at MD {place} (drill collar)" in text


def test_commands_can_be_pasted():
    assert "--out 'my runs/a' --restart" in str(Interrupted("SIGTERM", 1.0, "my runs/a"))
    summary = {"title": "", "elements": 1, "unknowns": 1, "ranks": 1, "simulated": 1.0, "wall_seconds": 1.0}
    summary |= {
        "real_time_factor": 1.0,
        "steps": 1,
        "rejected_steps": 0,
        "newton_iterations": 1,
        "jacobians": 1,
    }
    assert "plot 'my runs/a'" in closing_lines(summary, "my runs/a")[-1]


def test_rounding_noise_is_no_result():
    assert without_noise(-4.6e-13, 1e5) == 0.0
    assert without_noise(-4.6e-5, 1e5) == -4.6e-5


def test_a_file_that_is_no_survey_is_not_printed(tmp_path):
    (tmp_path / "secret.csv").write_text("root:x:0:0:root\n1,2,3\n")
    (tmp_path / "case.yaml").write_text(
        "well: {survey: secret.csv, sections: [{to: 10 m, kind: casing, diameter: 200 mm, friction: 0}]}\n"
        "string: [{kind: pipe, length: 5 m, od: 127 mm, id: 100 mm}]\ntop: {kind: top_drive}\n"
    )
    with pytest.raises(CaseError) as refusal:
        load_case(tmp_path / "case.yaml")
    assert "secret.csv" in str(refusal.value) and "root:x" not in str(refusal.value)


def test_check_of_a_held_string_keeps_gravity():
    """Gravity acts on the mud of a held string; without gravity it is left out."""
    data = {
        "string": [PIPE],
        "hold_string": True,
        "fluid": newtonian(1000, 1e-3, annulus=False, flow_rate=0.01),
    }
    lines = describe(Case(**data)).splitlines()
    assert "gravity" in next(q for q in lines if "contains:" in q)
    assert "gravity" not in next(q for q in lines if "leaves out" in q)
    lines = describe(Case(**data, gravity=0.0)).splitlines()
    assert "gravity" in next(q for q in lines if "leaves out" in q)
