"""Whole models with the quaternion element, among them scenes of the reference paper, against the ANCF element
(manual: verif-quaternion-models, verif-quaternion-scenes).

Both are of order 4 in space, but the quaternion element has one strain on both sides of the change of section at 30 m, which is of
order 2 on coarse meshes; the difference of the static weight on bit tells.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.case import case_from_data, read_case_file
from drillpetsc.output import read_table
from tests.helpers.wells import simple_well

CASES = Path(__file__).parents[2] / "cases" / "verification"
MUD = {
    "density": 1200,
    "rheology": {"model": "power_law", "consistency": 0.5, "index": 0.7},
    "bulk_modulus": 2e9,
    "flow_rate": 0.02,
}
ROCK = {"drillability": 1e-7}
JOINT = {"kind": "universal", "at": 40.5}


def keys_of_scene(element: str, length: float = 2.5, **more: Any) -> dict[str, Any]:
    """60 m in a bent hole: pipe, collar with unbalance and bend, stabilizer, collar, stabilizer, bit."""
    well = simple_well([0, 30, 61], 0.2159, [0.2, 0.3, 0.5], [0.1, 0.1, 0.3], friction=0.3)
    collar = {"kind": "pipe", "od": 0.1715, "id": 0.0714, "element_length": length}
    uneven = {"eccentricity": 0.003, "curvature": 1e-4}
    string = [
        {"kind": "pipe", "length": 30, "od": 0.127, "id": 0.1086, "element_length": length},
        collar | uneven | {"length": 9},
        {"kind": "stabilizer", "length": 1.5, "od": 0.21, "id": 0.0714, "mass": 200, "unbalance": 0.1},
        collar | uneven | {"length": 18.5},
        {"kind": "stabilizer", "length": 1.0, "od": 0.21, "id": 0.0714, "mass": 150},
        {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60, "nozzle_area": 4e-4},
    ]
    return {
        "well": well,
        "string": string,
        "top": {"kind": "top_drive", "rotation": 10.0},
        "bottom": {"kind": "bit"},
        "initial": {"from": "statics", "wob": 20e3},
        "time": {"end": 0.2},
        "beam": {"formulation": element},
        "output": {"history_every": 0.01, "probes": [30.0, 55.0]},
    } | more


def scene(element: str, **more: Any) -> Case:
    return Case(**keys_of_scene(element, **more))


def histories(folder: Path, **more: Any) -> list[dict[str, np.ndarray]]:
    """Histories and probes of the scene with both elements."""
    out = []
    for element in ("ancf", "quaternion"):
        result = run(scene(element, **more), folder / element, progress="silent")
        out.append(read_table(result.folder / "history.csv") | read_table(result.folder / "probes.csv"))
    return out


def assert_same(tables: list[dict[str, np.ndarray]], scales: dict[str, float], share: float) -> None:
    """Compare columns of two histories by ``share`` of the size of each."""
    one, other = tables
    for column, scale in scales.items():
        assert np.abs(one[column] - other[column]).max() < share * scale, column


SCALES = {
    "hook_load [N]": 3e4,
    "surface_torque [N m]": 3.5e3,
    "wob [N]": 2e4,
    "bit_speed [rad/s]": 10.0,
    "y_30 [m]": 4e-3,
    "y_55 [m]": 4e-3,
}


def test_rigid_items_above_other_pipe(tmp_path):
    """A string with stabilizers along it: on half the mesh the difference at the start is below 0.3 of that before."""
    start = []
    for length, share in ((2.5, 0.01), (1.0, 0.01)):
        tables = histories(tmp_path / f"{length}", length=length, time={"end": 0.1})
        assert_same(tables, SCALES, share)
        start.append(abs(tables[1]["wob [N]"][0] - tables[0]["wob [N]"][0]))
    assert tables[0]["wob [N]"][0] == pytest.approx(20e3, rel=1e-6)
    assert start[1] < 0.3 * start[0] < 0.3 * 0.0025 * 20e3


def test_universal_joint_below_a_stabilizer(tmp_path):
    """The joint bends by 0.029 rad; its forces and its angle are those of the ANCF element, to 1 %."""
    tables = histories(tmp_path, joints=[JOINT])
    joint = {
        "joint_40.5_force [N]": 1e4,
        "joint_40.5_side_force [N]": 1e4,
        "joint_40.5_torque [N m]": 3.6e3,
        "joint_40.5_angle [rad]": 0.029,
    }
    assert_same(tables, SCALES | joint, 0.01)
    assert tables[1]["joint_40.5_angle [rad]"].min() > 0.02
    assert np.abs(tables[1]["joint_40.5_travel [m]"]).max() < 1e-12


@pytest.mark.parametrize(("formulation", "rock"), [("mixed", {"formation": ROCK}), ("hermite", {})])
def test_mud_past_rigid_items(tmp_path, formulation, rock):
    """All the physics at once for 0.15 s, both forms of the mud: pressures to 3e-4, forces to 1 %."""
    tables = histories(tmp_path, fluid=MUD | {"formulation": formulation}, time={"end": 0.15}, **rock)
    more = {"bit_torque [N m]": 1e3, "x_30 [m]": 4e-3, "x_55 [m]": 4e-3}
    more |= {"hole_depth [m]": 1e-3} if rock else {}
    assert_same(tables, SCALES | more, 0.01)
    assert_same(tables, {"pump_pressure [Pa]": 2e6, "bit_pressure [Pa]": 2e6, "bit_flow [m3/s]": 0.02}, 3e-4)


def test_quasi_static_drilling(tmp_path):
    """10 minutes of drilling, 1.2 m of new hole: depth to 0.1 mm, forces to 1 %; the bend averages out in both."""
    tables = histories(
        tmp_path,
        top={"kind": "top_drive", "rotation": 10.0, "lowering": 0.002},
        formation=ROCK,
        time={"end": 600, "mode": "quasi_static"},
        output={"history_every": 100, "probes": [55.0]},
    )
    assert tables[0]["hole_depth [m]"][-1] > 62.0
    assert_same(tables, {k: v for k, v in SCALES.items() if "_30" not in k and "y_" not in k}, 0.01)
    assert_same(tables, {"hole_depth [m]": 1e-2, "y_55 [m]": 1e-2}, 0.01)


@pytest.mark.parametrize("kind", ["index3", "stabilized"])
def test_a_run_continues_from_another(tmp_path, kind):
    """Depth, angle, hook load and torque go on where the other run ended, in a hole that bends at the top, too."""
    top = {"kind": "top_drive", "rotation": 10.0, "lowering": 0.1}
    more = {"top": top, "bottom": "free", "time": {"end": 0.1}}
    beam = {"formulation": "quaternion", "constraint": kind}
    one = run(
        scene("quaternion", **more | {"initial": {"from": "statics"}, "beam": beam}),
        tmp_path / "one",
        progress="silent",
    )
    two = run(
        scene("quaternion", **more | {"initial": {"from": str(one.folder)}, "beam": beam}),
        tmp_path / "two",
        progress="silent",
    )
    before, after = (read_table(r.folder / "history.csv") for r in (one, two))
    assert after["bit_depth [m]"][0] == pytest.approx(before["bit_depth [m]"][-1], abs=1e-8)
    assert after["top_travel [m]"][[0, -1]] == pytest.approx([0.01, 0.02], abs=1e-9)
    for column in ("hook_load [N]", "surface_torque [N m]"):
        assert after[column][0] == pytest.approx(before[column][-1], rel=2e-3), column
        assert np.ptp(after[column]) < 0.1 * after[column][0]


@pytest.mark.parametrize("element", ["ancf", "quaternion"])
def test_reactions_of_the_first_row(tmp_path, element):
    """A string that starts free of stress hangs by half of its first element: EA eps = 0, so the top carries what the
    element's inertia does not: m g L/2 along the hole."""
    case = scene(
        element, initial={"from": "rest"}, bottom="free", time={"end": 0.002}, output={"history_every": 0.001}
    )
    table = read_table(run(case, tmp_path / element, progress="silent").folder / "history.csv")
    weight = 7850 * np.pi / 4 * (0.127**2 - 0.1086**2) * 9.80665 * 2.5
    assert table["hook_load [N]"][0] == pytest.approx(0.5 * weight * np.cos(0.2), rel=0.01)


def both(name: str, folder: Path, change) -> list[dict[str, np.ndarray]]:
    """History and probes of a case of the report, with changes, with the ANCF and with the quaternion
    element."""
    out = []
    for element in ("ancf", "quaternion"):
        data, _ = read_case_file(CASES / name)
        change(data)
        data["beam"] = {"formulation": element}
        result = run(case_from_data(data, CASES / name, {}), folder / element, progress="silent")
        tables = [
            read_table(result.folder / file)
            for file in ("history.csv", "probes.csv")
            if (result.folder / file).exists()
        ]
        out.append({k: v for table in tables for k, v in table.items()} | {"summary": result.summary})  # type: ignore[dict-item]
    return out


def rms(one: dict[str, Any], other: dict[str, Any], column: str) -> float:
    return float(np.sqrt(np.mean((one[column] - other[column]) ** 2)) / np.ptp(one[column]))


def test_flutter(tmp_path):
    """A pipe that conveys fluid above the critical speed: 4 s of its growing flutter, on elements of 1.25 m,
    within 1 % of its range."""
    reference, other = both("study-flutter.yaml", tmp_path, lambda data: data["time"].update(end="4 s"))
    assert np.ptp(reference["x_10 [m]"]) > 0.02
    assert rms(reference, other, "x_10 [m]") < 0.01
    assert abs(other["summary"]["mass"]["error"]) < 1e-5 * other["summary"]["mass"]["pumped"]


def test_stick_slip(tmp_path):
    """A bit that sticks, breaks loose and drills: the time of breaking loose and the following motion, 6 s.

    Euler parameters are interpolated linearly: the twist of an element (12 rad over 20 elements here) must be
    well below pi.
    """

    def change(data):
        data["time"].update(end="6 s")
        data["petsc"] = {
            "ts_rtol": "1e-5"
        }  # at the default the time of breaking loose scatters with the steps

    reference, other = both("study-stick-slip.yaml", tmp_path, change)
    for column, off in (("bit_speed [rad/s]", 0.02), ("surface_torque [N m]", 0.01), ("wob [N]", 0.01)):
        assert rms(reference, other, column) < off, column
    assert other["summary"]["new_hole"]["drilled [m]"] == pytest.approx(
        reference["summary"]["new_hole"]["drilled [m]"], rel=0.01
    )


def test_lowered_in_mud_it_starts_in_equilibrium(tmp_path):
    """Lowered at 1 m/s through circulating mud: the initial hook load is that of the ANCF element, with the
    drag of the mud."""
    pipe = {"kind": "pipe", "length": 600, "od": 0.127, "id": 0.1086, "element_length": 20}
    well = simple_well(700, 0.2159, kind="casing", friction=0.2)
    mud = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.1}, "flow_rate": 0.02}
    loads = []
    for element in ("ancf", "quaternion"):
        for speed in (0.0, 1.0):
            case = Case(
                well=well,
                string=[pipe],
                top={"kind": "top_drive", "lowering": speed},
                bottom="free",
                fluid=mud,
                beam={"formulation": element},
                time={"end": 0.02},
                output={"history_every": 0.01},
            )
            folder = run(case, tmp_path / f"{element}{speed}", progress="silent").folder
            loads.append(read_table(folder / "history.csv")["hook_load [N]"])
    still, lowered, *other = loads
    assert still[0] - lowered[0] > 1000.0  # the drag has an effect
    assert [q[0] for q in other] == pytest.approx([still[0], lowered[0]], rel=1e-5)
    assert other[1] == pytest.approx(lowered, rel=1e-4)
