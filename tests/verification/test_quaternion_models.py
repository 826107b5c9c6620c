"""Whole models with the quaternion element: mud, rigid items, unbalance, a bit that drills; compared with the
ANCF element (manual: verif-quaternion-models).

Both are of order 4 in space, so with short elements the results are equal within the tolerance of each test.
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
    reference, other = both("study-stick-slip.yaml", tmp_path, lambda data: data["time"].update(end="6 s"))
    for column, off in (("bit_speed [rad/s]", 0.02), ("surface_torque [N m]", 0.01), ("wob [N]", 0.01)):
        assert rms(reference, other, column) < off, column
    assert other["summary"]["new_hole"]["drilled [m]"] == pytest.approx(
        reference["summary"]["new_hole"]["drilled [m]"], rel=0.01
    )


def model(element: str, **more: Any) -> Case:
    """60 m in a bent hole with all supported parts: mud inside and outside, a change of section, unbalance,
    stabilizer, bit."""
    well = {
        "survey": {"md": [0, 30, 61], "inclination": [0.2, 0.3, 0.5], "azimuth": [0.1, 0.1, 0.3]},
        "sections": [{"to": 61, "kind": "open_hole", "diameter": 0.2159, "friction": 0.3}],
    }
    string = [
        {"kind": "pipe", "length": 30, "od": 0.127, "id": 0.1086, "element_length": 2.5},
        {
            "kind": "pipe",
            "length": 29,
            "od": 0.1715,
            "id": 0.0714,
            "element_length": 2.5,
            "eccentricity": 0.003,
            "curvature": 1e-4,
        },
        {"kind": "stabilizer", "length": 1.5, "od": 0.21, "id": 0.0714, "mass": 200, "unbalance": 0.1},
        {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60, "nozzle_area": 4e-4},
    ]
    mud = {
        "density": 1200,
        "rheology": {"model": "power_law", "consistency": 0.5, "index": 0.7},
        "bulk_modulus": 2e9,
        "flow_rate": 0.02,
    }
    whole = {
        "well": well,
        "string": string,
        "top": {"kind": "top_drive", "rotation": 10.0},
        "bottom": {"kind": "bit"},
        "fluid": mud,
        "formation": {"drillability": 1e-7},
        "initial": {"from": "statics", "wob": 20e3},
        "time": {"end": 0.3},
        "beam": {"formulation": element},
        "output": {"history_every": 0.01, "probes": [30.0, 55.0]},
    }
    return Case(**(whole | more))


def test_everything_at_once(tmp_path):
    """Weight on bit, torque, pressures and motion of a short string with all the physics, 0.3 s."""
    tables = []
    for element in ("ancf", "quaternion"):
        folder = run(model(element), tmp_path / element, progress="silent").folder
        tables.append(read_table(folder / "history.csv") | read_table(folder / "probes.csv"))
    reference, other = tables
    for column, scale in (
        ("hook_load [N]", 1e5),
        ("wob [N]", 2e4),
        ("surface_torque [N m]", 2e3),
        ("bit_torque [N m]", 1e3),
        ("pump_pressure [Pa]", 1e7),
        ("bit_pressure [Pa]", 1e6),
        ("hole_depth [m]", 1e-3),
        ("bit_speed [rad/s]", 10.0),
    ):
        assert np.abs(reference[column] - other[column]).max() < 0.02 * scale, column
    for column in ("x_30 [m]", "y_30 [m]", "x_55 [m]", "y_55 [m]"):
        assert np.abs(reference[column] - other[column]).max() < 1e-3, column


def test_a_restart_reproduces_the_run(tmp_path):
    """A run ended in the middle and restarted has the history of an uninterrupted run, except for the step
    that ends in the middle."""
    half = run(model("quaternion", time={"end": 0.1}), tmp_path / "half", progress="silent")
    run(model("quaternion", time={"end": 0.2}), tmp_path / "half", restart=True, progress="silent")
    whole = run(model("quaternion", time={"end": 0.2}), tmp_path / "whole", progress="silent")
    one, two = (read_table(r / "history.csv") for r in (half.folder, whole.folder))
    late = one["time [s]"] > 0.1
    for column in ("wob [N]", "hook_load [N]", "pump_pressure [Pa]"):
        assert one[column][late] == pytest.approx(two[column][late], rel=2e-3)


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
