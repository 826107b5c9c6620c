"""Elements given by hand that are too long are reported, with a length that does (manual: sec-mesh-coarse)."""

from __future__ import annotations

import re

import numpy as np
import pytest

from drillpetsc import Case, run, statics
from drillpetsc.analysis.commands.check import describe
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.doubts import mesh
from drillpetsc.doubts.moments import Answer
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.measured.bending import end_forces

BENDING = 1.2240289e6
PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086}


def hole(md, inclination, friction: float = 0.2, diameter: float = 0.2159) -> dict:
    survey = {"md": list(md), "inclination": list(np.radians(inclination)), "azimuth": [0.0] * len(md)}
    section = {"to": md[-1], "kind": "open_hole", "diameter": diameter, "friction": friction}
    return {"survey": survey, "sections": [section]}


def drillstring(element: float | str, inclination: float = 40.0, **keys) -> Case:
    return Case(
        **{
            "well": hole([0.0, 300.0], [inclination, inclination]),
            "string": [
                {**PIPE, "length": 280.0, "element_length": element},
                {"kind": "stabilizer", "length": 0.5, "od": 0.212, "mass": 100.0},
                {"kind": "pipe", "length": 18.0, "od": 0.1715, "id": 0.0714, "element_length": element},
                {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 40.0},
            ],
            "top": {"kind": "top_drive", "rotation": "60 rpm"},
            "bottom": {"kind": "bit"},
            "initial": {"wob": 10e3},
            **keys,
        }
    )


def long_elements(model) -> list[str]:
    """Warnings of the present state about elements that are too long."""
    at = Answer(model=model)
    return mesh.long_elements.sentences(at) + mesh.long_elements_at_support.sentences(at)


def beside_stabilizer(case: Case) -> tuple[float, list[str]]:
    """Moment above the stabilizer [N m], and the warnings about it."""
    model = build_model(case)
    find_equilibrium(model, lateral_friction=False)
    node = model.mesh.bodies[0].node
    lines = [line for line in long_elements(model) if "beside stabilizer" in line]
    return float(end_forces(model).moment_size[node - 1, 1]), lines


def length_in(line: str) -> float:
    return float(re.search(r"element_length of ([\d.e+-]+) m or less", line).group(1))


def test_moment_beside_a_stabilizer():
    """14 m elements are reported, and leave more than 10 % against a fine mesh; the length that is named leaves less
    than 2 % and is not reported; nor is the automatic mesh."""
    fine, silent = beside_stabilizer(drillstring(0.25))
    assert silent == []
    coarse, (line,) = beside_stabilizer(drillstring(14.0))
    assert abs(coarse / fine - 1) > 0.1
    enough, silent = beside_stabilizer(drillstring(length_in(line)))
    assert silent == [] and enough == pytest.approx(fine, rel=0.02)
    automatic, silent = beside_stabilizer(drillstring("auto"))
    assert silent == [] and automatic == pytest.approx(fine, rel=0.02)


def test_nothing_is_said_where_nothing_bends():
    """The same string hangs in a vertical hole, off bottom: no moment beside the stabilizer."""
    still = drillstring(
        9.0, inclination=0.0, bottom="free", initial={"from": "statics"}, top={"kind": "top_drive"}
    )
    model = build_model(still)
    find_equilibrium(model)
    assert long_elements(model) == []
    assert "beside" not in describe(still).replace("beside an", "")


@pytest.mark.parametrize(("element", "reported"), [(3.0, True), (2.0, False)])
@pytest.mark.parametrize("top", [{"kind": "top_drive", "lowering": 0.1}, "pinned"], ids=["lowered", "pinned"])
def test_residual_curvature(tmp_path, element, reported, top):
    """Coiled tubing of 0.1 1/m: 0.2 rad in an element, 2 m, are enough; from 3 m on (hook load 3 %, torque 17 % off)
    statics and check name 2 m."""
    case = Case(
        well=hole([0.0, 220.0], [30.0, 30.0], diameter=0.1143),
        string=[
            {"kind": "pipe", "length": 200.0, "od": 0.0603, "id": 0.0507, "curvature": 0.1, "curvature_angle": 0.785,
             "element_length": element}
        ],
        top=top,
    )  # fmt: skip
    result = statics(case, tmp_path / "run")
    for lines in (result.summary["warnings"], describe(case).splitlines()):
        found = [line for line in lines if "too long for a residual curvature of 0.1 1/m" in line]
        assert len(found) == reported
        assert not reported or length_in(found[0]) == pytest.approx(2.0)


@pytest.mark.parametrize(("element", "reported"), [(10.0, True), (4.0, False)])
def test_sharp_curvature(element, reported):
    """30 deg/30 m: 10 m elements turn by 10 deg each; 0.1 rad are 5.7 m."""
    case = Case(
        well=hole([0.0, 100.0, 190.0, 300.0], [0.0, 0.0, 90.0, 90.0]),
        string=[{"kind": "pipe", "length": 290.0, "od": 0.073, "id": 0.0548, "element_length": element}],
        top={"kind": "top_drive"},
    )
    lines = [line for line in describe(case).splitlines() if "the curvature of the hole (30 deg/30m)" in line]
    assert len(lines) == reported
    assert not reported or length_in(lines[0]) == pytest.approx(5.7, abs=0.1)


def test_a_jump_of_the_curvature_that_bends_the_pipe_beyond_50_mpa():
    """Straight to 8 deg/30 m: E r/R = 206e9 * 0.0635 / 215 m = 61 MPa; 6 deg/30 m: 46 MPa."""
    reported = {}
    for rate in (6.0, 8.0):
        case = Case(
            well=hole([0.0, 500.0, 600.0], [0.0, 0.0, rate * 100 / 30]),
            string=[{**PIPE, "length": 575.0, "element_length": 25.0}],
            top={"kind": "top_drive"},
        )
        reported[rate] = "beside a jump of the hole's curvature at MD 500 m" in describe(case)
    assert reported == {6.0: False, 8.0: True}


def pushed(element: float | str, **keys) -> Case:
    return Case(
        **{
            "well": hole([0.0, 300.0], [90.0, 90.0], friction=0.1),
            "string": [{**PIPE, "length": 300.0, "element_length": element}],
            "top": {"kind": "top_drive", "force": -450e3},
            "bottom": {"kind": "bit", "friction": 0},
            **keys,
        }
    )


def test_check_tells_of_the_expected_helix():
    """450 kN against a helical load of 2 sqrt2 sqrt(EI w/r) = 244 kN: a quarter of the pitch 2 pi sqrt(2EI/F) does."""
    (line,) = [q for q in describe(pushed(10.0)).splitlines() if "expected helix" in q and "WARNING" in q]
    assert length_in(line) == pytest.approx(0.5 * np.pi * np.sqrt(2 * BENDING / 450e3), rel=0.05)
    assert "WARNING" not in describe(pushed("auto"))


def test_a_run_tells_at_its_first_row(tmp_path):
    """The warnings of statics stand in the summary of a run, and on the screen before the first step."""
    coarse = run(drillstring(9.0, time={"end": 0.02}), tmp_path / "coarse", progress="silent")
    assert any("beside stabilizer" in line for line in coarse.summary["warnings"])
    fine = run(drillstring("auto", time={"end": 0.02}), tmp_path / "fine", progress="silent")
    assert not any("element_length" in line for line in fine.summary["warnings"])


BIT = {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0}
FULL_GAUGE = {"kind": "stabilizer", "length": 1.5, "od": 0.2159, "mass": 300.0}


@pytest.mark.parametrize(("tools", "error"), [([FULL_GAUGE, BIT], 0.05), ([BIT], 0.005)])
def test_false_side_force_beside_a_stabilizer(tools, error):
    """Elements of 30 m above a full-gauge stabilizer in a bent hole have 7 % more torque than the automatic mesh; the warning names
    moment, side forces and friction.  A bit may tilt, so that the pipe above it bends evenly: nothing is wrong, and nothing said."""
    found = []
    for element in (30.0, "auto"):
        well = hole([0.0, 100.0, 700.0, 1500.0], [0.0, 0.0, 48.0, 48.0], friction=0.3)
        length = 1300.0 - sum(tool["length"] for tool in tools)
        string = [{**PIPE, "length": length, "element_length": element}, *tools]
        model = build_model(
            Case(
                well=well,
                string=string,
                top={"kind": "top_drive", "rotation": 6.0},
                bottom={"kind": "bit"},
                initial={"wob": 20e3},
            )
        )
        find_equilibrium(model)
        found.append((model.system.reaction("top.torque_reaction"), long_elements(model)))
    (coarse, said), (fine, silent) = found
    assert silent == []
    if len(tools) > 1:
        assert coarse > (1 + error) * fine
        assert (
            len(said) == 1
            and "beside stabilizer" in said[0]
            and "side forces and their friction too large" in said[0]
        )
    else:
        assert coarse == pytest.approx(fine, rel=error) and said == []


@pytest.mark.parametrize(
    ("lengths", "refinement", "words"),
    [
        (["auto", "auto"], 1.5, "or mesh: {refinement: 3}"),
        (["auto", 6.0], 1.0, "or auto"),
        ([6, 6], 1.0, "or auto"),
    ],
)
def test_what_is_told_instead_of_a_length(lengths, refinement, words):
    """A mesh that is automatic throughout was told to be automatic."""
    from drillpetsc.model.element_length import instead_of_length

    case = Case(
        string=[{"kind": "pipe", "length": 30, "od": 0.127, "id": 0.1, "element_length": e} for e in lengths],
        top="clamped",
        bottom="free",
        mesh={"refinement": refinement},
    )
    assert instead_of_length(case) == words
