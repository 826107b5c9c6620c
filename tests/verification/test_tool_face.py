"""Tool face of bent items: 0 is the high side, clockwise looking down the hole; magnetic below 5 degrees
(manual: verif-tool-face)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.model.drilling_model import build_model
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well

PIPE = {"kind": "pipe", "od": 0.1, "id": 0.06, "element_length": 2.0}
DEG = np.pi / 180


def end_direction(string, inclination: float, azimuth: float) -> np.ndarray:
    """Tangent (3,) of the lower end of a weightless ``string``, clamped above, in no hole.

    inclination, azimuth: of the clamped end [rad].
    """
    initial = {"inclination": inclination, "azimuth": azimuth}
    case = Case(string=string, top="clamped", gravity=0.0, initial=initial)
    model = build_model(case)
    find_equilibrium(model)
    v = model.system.field("string.tangent")[-1]
    return v / np.linalg.norm(v)


def along(inclination: float, azimuth: float) -> np.ndarray:
    """Unit vector (3,) of the hole with ``inclination`` and ``azimuth`` [rad] (manual: eq-conv-direction)."""
    return np.array(
        [np.sin(inclination) * np.cos(azimuth), np.sin(inclination) * np.sin(azimuth), np.cos(inclination)]
    )


def kinked(inclination: float, azimuth: float, tool_face: float, angle: float) -> np.ndarray:
    """Direction (3,) below a kink of ``angle`` [rad] at a gravity ``tool_face`` [rad].

    Independent of high sides: the high side is the direction d t/d I in which the inclination grows, the
    direction to its right d t/d A over sin I, in which the azimuth grows.
    """
    i, a = inclination, azimuth
    high = np.array([np.cos(i) * np.cos(a), np.cos(i) * np.sin(a), -np.sin(i)])
    right = np.array([-np.sin(a), np.cos(a), 0.0])
    towards = np.cos(tool_face) * high + np.sin(tool_face) * right
    return np.cos(angle) * along(i, a) + np.sin(angle) * towards


@each_row("tool_face", [0.0, 90.0, 180.0, 270.0, 35.0])
@each_row("item", ["pipe", "body"])
def test_a_bent_item_points_to_its_tool_face(item, tool_face):
    """A kink of 2 degrees in a string inclined 60 degrees to azimuth 40: 0 raises the inclination, 90 turns
    the azimuth to the right.  Free of load the kink is exact up to the second order in its angle per
    element."""
    bend = {"angle": 2 * DEG, "tool_face": tool_face * DEG}
    bent = (
        {**PIPE, "length": 6.0, "bend": bend} if item == "pipe" else {"kind": "body", "mass": 0, "bend": bend}
    )
    string = [{**PIPE, "length": 6.0}, bent, {**PIPE, "length": 4.0}]
    expected = kinked(60 * DEG, 40 * DEG, tool_face * DEG, 2 * DEG)
    assert end_direction(string, 60 * DEG, 40 * DEG) == pytest.approx(expected, abs=2e-5)


@pytest.mark.parametrize("tool_face", [0.0, 90.0])
def test_the_tool_face_is_magnetic_in_a_steep_hole(tool_face):
    """At 3 degrees towards the east the kink points north for tool face 0 and (nearly) east for 90; at 6
    degrees towards the east tool face 0 is the high side, the east, and 90 the south."""
    bend = {"angle": 2 * DEG, "tool_face": tool_face * DEG}
    string = [{**PIPE, "length": 6.0, "bend": bend}]
    steep = end_direction(string, 3 * DEG, 90 * DEG)
    away = np.sin(2 * DEG) * np.array([[1.0, 0.0], [0.0, np.cos(3 * DEG)]][tool_face > 0])
    assert steep[:2] == pytest.approx(np.cos(2 * DEG) * np.array([0.0, np.sin(3 * DEG)]) + away, abs=2e-5)
    assert end_direction(string, 6 * DEG, 90 * DEG) == pytest.approx(
        kinked(6 * DEG, 90 * DEG, tool_face * DEG, 2 * DEG), abs=2e-5
    )


@each_row(("angle", "kind"), [(0.0, "ancf"), (90.0, "ancf"), (0.0, "quaternion"), (90.0, "quaternion")])
def test_residual_curvature_has_the_same_tool_face(angle, kind):
    """An item of stress-free curvature 0.01 1/m and 6 m length turns by 0.06 towards `curvature_angle`."""
    item = {**PIPE, "length": 6.0, "element_length": 0.5, "curvature": 0.01, "curvature_angle": angle * DEG}
    case = Case(
        string=[item],
        top="clamped",
        gravity=0.0,
        initial={"inclination": 60 * DEG, "azimuth": 40 * DEG},
        beam={"formulation": kind},
    )
    model = build_model(case)
    find_equilibrium(model)
    r = model.system.field("string.position")
    # the chord of an arc from its tangent point makes half the angle of the arc
    chord = (r[-1] - r[0]) / np.linalg.norm(r[-1] - r[0])
    assert chord == pytest.approx(kinked(60 * DEG, 40 * DEG, angle * DEG, 0.03), abs=1e-5)


def test_the_high_side_is_that_of_the_bend_in_a_well_that_leaves_the_vertical():
    """A well from vertical to 60 degrees at azimuth 90: directors transported from the top point north, which
    is the left of the inclined hole.  The axial vector k of the bend at tool face 0 satisfies k x t = high
    side, d t/d I."""
    well = simple_well([0, 100, 400, 500], 0.2, [0, 0, 60 * DEG, 60 * DEG], 90 * DEG)
    bend = {"angle": 1 * DEG, "tool_face": 0.0}
    string = [{**PIPE, "length": 450, "element_length": 5}, {**PIPE, "length": 50, "bend": bend}]
    model = build_model(Case(well=well, string=string, top="clamped"))
    (cell,) = np.flatnonzero(np.abs(model.mesh.curvature).max(axis=1))
    tangent, second = model.frames.reference[cell], model.frames.second_director[cell]
    k2, k3 = model.mesh.curvature[cell]
    axial = k2 * second + k3 * np.cross(tangent, second)
    high = np.array([0.0, np.cos(60 * DEG), -np.sin(60 * DEG)])
    assert np.cross(axial, tangent) * 0.5 == pytest.approx(1 * DEG * high, abs=1e-6)


def test_a_bent_rigid_item_between_two_pipes_is_counted_once():
    """A bend of 1 degree of a stabilizer between two pipes turns the string below it by 1 degree."""
    bend = {"angle": 1 * DEG}
    stabilizer = {"kind": "stabilizer", "length": 0.5, "od": 0.15, "mass": 0.0, "bend": bend}
    for string in (
        [{**PIPE, "length": 6.0}, stabilizer, {**PIPE, "length": 6.0}],
        [{**PIPE, "length": 6.0}, {**stabilizer, "bend": None}, stabilizer, {**PIPE, "length": 6.0}],
    ):
        expected = kinked(90 * DEG, 0.0, 0.0, 1 * DEG)
        assert end_direction(string, 90 * DEG, 0.0) == pytest.approx(expected, abs=1e-5)


def test_a_pipe_below_a_bent_rigid_item_keeps_its_own_bend():
    """Bends of 1 degree of a body and of the pipe below it, both to the high side: 2 degrees together."""
    bend = {"angle": 1 * DEG}
    string = [
        {**PIPE, "length": 6.0},
        {"kind": "body", "mass": 0, "bend": bend},
        {**PIPE, "length": 6.0, "bend": bend},
    ]
    assert end_direction(string, 90 * DEG, 0.0) == pytest.approx(
        kinked(90 * DEG, 0.0, 0.0, 2 * DEG), abs=2e-5
    )


def drilled(tool_face: float, tmp_path) -> tuple[float, float]:
    """Drill 3 m with a bent motor that slides; returns inclination and azimuth of the new hole's end [deg].

    The hole holds 30 degrees to the north.  The string does not turn, the bit cuts without it
    (rotary_exponent 0) and without friction.  A kink of 1.5 degrees is 1.6 m above the bit.
    """
    sections = [{"to": "80 m", "kind": "open_hole", "diameter": "215.9 mm", "friction": 0.0}]
    survey = {"md": ["0 m", "80 m"], "inclination": ["30 deg", "30 deg"], "azimuth": ["0 deg", "0 deg"]}
    pipe = {"kind": "pipe", "od": "171.5 mm", "id": "71.4 mm", "element_length": "2 m"}
    case = Case(
        well={"survey": survey, "sections": sections},
        string=[
            {**pipe, "length": "78.3 m"},
            {"kind": "body", "mass": "0 kg", "bend": {"angle": "1.5 deg", "tool_face": tool_face * DEG}},
            {**pipe, "length": "1.4 m", "element_length": "0.7 m"},
            {"kind": "bit", "length": "0.3 m", "od": "215.9 mm", "mass": "60 kg"},
        ],
        top={"kind": "top_drive", "lowering": "10 m/h"},
        bottom={"kind": "bit", "friction": 0.0},
        formation={"rotary_exponent": 0.0, "bit_anisotropy": 0.5},
        initial={"from": "statics", "wob": "20 kN"},
        time={"mode": "quasi_static", "end": "1080 s"},
    )
    run(case, tmp_path / f"{tool_face:g}", progress="silent")
    table = np.genfromtxt(tmp_path / f"{tool_face:g}" / "trajectory.csv", delimiter=",", names=True)
    columns = table.dtype.names
    value = {name: float(table[name][-1]) for name in columns}
    return value["inclination_deg"], (value["azimuth_deg"] + 180) % 360 - 180


def test_a_bent_motor_drills_towards_its_tool_face(tmp_path):
    """Tool face 0 builds inclination and keeps the azimuth, 90 turns to the right, 270 to the left, 180 drops
    (the definition of the tool face in directional drilling).  The plane of symmetry of the hole makes right
    and left alike."""
    up, right, down, left = (drilled(a, tmp_path) for a in (0.0, 90.0, 180.0, 270.0))
    assert up[0] > 30.3 and abs(up[1]) < 0.01
    assert down[0] < up[0] - 0.6 and abs(down[1]) < 0.01
    assert right[1] > 0.5 and left[1] == pytest.approx(-right[1], abs=0.02)
    assert right[0] == pytest.approx(left[0], abs=0.02)
    assert down[0] < right[0] < up[0]
