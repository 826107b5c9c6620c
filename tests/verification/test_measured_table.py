"""Hook load as a rig reads it, and measured points beside a roadmap (manual: sec-roadmap-sensor)."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drillpetsc as dp
from drillpetsc.analysis.hydraulics.flow_model import whole_string
from drillpetsc.analysis.hydraulics.surge import Tripping
from drillpetsc.analysis.loads.torque_drag.circulation import circulation
from drillpetsc.analysis.loads.torque_drag.readings.sensor import weight_over_line
from drillpetsc.analysis.loads.torque_drag.roadmap import run_roadmap
from drillpetsc.case.case import Case
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.output.job import Job

G, LENGTH, MUD = 9.80665, 1000.0, 1200.0
RING = np.pi / 4 * (0.127**2 - 0.1086**2)  # [m2]
WEIGHT = (7850 - MUD) * G * RING * LENGTH  # of the pipe in mud, in a vertical hole [N]
BLOCK = 300e3
SENSOR = {"at": "dead_line", "lines": 16, "sheave_efficiency": 0.99}


def case(rig: dict[str, Any] | None = None, inclination: float = 0.0, **keys: Any) -> Case:
    survey = {"md": [0, 2000], "inclination": [inclination, inclination], "azimuth": [0, 0]}
    roadmap = {"bit_depth": [LENGTH], "friction_factor": {"open_hole": [0.2, 0.3]}, "trip_speed": 0.5}
    return Case(
        well={"survey": survey, "sections": [{"kind": "open_hole", "diameter": 0.2159, "friction": 0.25}]},
        string=keys.pop("string", [{"kind": "pipe", "length": LENGTH, "od": 0.127, "id": 0.1086}]),
        top={"kind": "top_drive", "rotation": 10.0},
        fluid=keys.pop(
            "fluid",
            {"density": MUD, "bulk_modulus": 1e14, "rheology": {"model": "newtonian", "viscosity": 0.05}},
        ),
        rig={"block_weight": BLOCK} | (rig or {}),
        roadmap=roadmap | keys.pop("roadmap", {}),
        **keys,
    )


def table(c: Case, folder: Path, name: str) -> list[dict[str, Any]]:
    result = run_roadmap(Job(c, folder / "out", overwrite=True))
    columns = {title.split(" [")[0]: values for title, values in read_table(result.folder / name).items()}
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


# ---------------------------------------------------------------------- sensor
def test_weight_over_the_dead_line() -> None:
    """16 lines, e = 0.99: 17.2712 and 14.8542 (contract A2); 1 % a sheave is +8 and -7 % of the reading."""
    hoisting, lowering = weight_over_line(16, 0.99, "still")
    assert (hoisting, lowering) == pytest.approx((17.2712, 14.8542), abs=5e-5)
    assert (hoisting / 16 - 1, lowering / 16 - 1) == pytest.approx((0.08, -0.07), abs=0.005)
    assert weight_over_line(16, 0.99, "turning") == pytest.approx((hoisting / 0.99, lowering * 0.99))
    assert weight_over_line(10, 1.0, "still") == (10, 10)


@pytest.mark.parametrize("lines", [4, 10, 14])
def test_lines_one_by_one(lines: int) -> None:
    """The forces of all lines, sheave after sheave from the dead line: each sheave adds or takes its friction."""
    for direction, expected in zip((1, -1), weight_over_line(lines, 0.97, "still"), strict=True):
        force, sum_ = 1.0, 0.0
        for _ in range(lines):
            sum_ += force
            force *= 0.97**-direction
        assert sum_ == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    ("sensor", "words"),
    [
        ({"at": "dead_line"}, "lines"),
        ({"at": "dead_line", "lines": 12}, "sheave_efficiency"),
        ({"lines": 12}, "no such key"),
        ({"at": "dead_line", "lines": 1, "sheave_efficiency": 0.98}, "lines"),
        ({"at": "dead_line", "lines": 12, "sheave_efficiency": 98}, "sheave_efficiency"),
    ],
)
def test_refused(sensor: dict[str, Any], words: str) -> None:
    with pytest.raises(CaseError, match=words):
        case({"hookload_sensor": sensor})


def test_reading_of_a_roadmap(tmp_path: Path) -> None:
    """Vertical hole, no friction: the weight in mud and the block, over W/F and times the lines."""
    hoisting, lowering = weight_over_line(16, 0.99, "still")
    factor = {"trip_out": hoisting / 16, "trip_in": lowering / 16, "rotate_off_bottom": 1.0}
    plan = {"operations": list(factor)}
    found = table(case({"hookload_sensor": SENSOR}, roadmap=plan), tmp_path, "roadmap.csv")
    for row in found:
        expected = (WEIGHT + BLOCK) / factor[row["operation"]]
        assert row["hook_load_reading"] == pytest.approx(expected, rel=1e-9)
    assert "hook_load_reading" not in table(case(roadmap=plan), tmp_path, "roadmap.csv")[0]


def points(factor: dict[str, float], **more: float) -> list[dict[str, Any]]:
    return [
        {"bit_depth": LENGTH, "operation": word, "hook_load": (WEIGHT + BLOCK) / f} | more
        for word, f in factor.items()
    ]


def test_readings_are_corrected_to_the_hook(tmp_path: Path) -> None:
    """Readings of a sensor in the dead line, made by the closed form, leave no residual and no friction."""
    hoisting, lowering = weight_over_line(16, 0.99, "still")
    read = points({"trip_out": hoisting / 16, "trip_in": lowering / 16, "rotate_off_bottom": 1.0})
    c = case({"hookload_sensor": SENSOR}, roadmap={"measured": read})
    rows = table(c, tmp_path, "measured.csv")
    assert [row["measured"] for row in rows] == pytest.approx([p["hook_load"] for p in read])
    assert [row["corrected"] for row in rows] == pytest.approx([WEIGHT + BLOCK] * 3)
    assert np.abs([row["residual"] for row in rows]).max() < 1e-6 * WEIGHT
    at_rest = next(row for row in rows if row["operation"] == "rotate_off_bottom")
    sigma = 0.02 * (WEIGHT + BLOCK)
    assert at_rest["sigma"] == pytest.approx(sigma)
    wide = (WEIGHT + BLOCK) * (hoisting / 16 - 1) + 1.645 * sigma
    assert at_rest["corrected"] - at_rest["band_low"] == pytest.approx(wide)
    with_block = dp.calibrate(c, tmp_path / "fit", fit="block_weight")
    assert with_block.summary["fit"]["block_weight"]["value"] == pytest.approx(BLOCK, rel=1e-6)


# ---------------------------------------------------------------------- measured.csv
def test_statistics_of_readings(tmp_path: Path) -> None:
    """Inclined hole: w L (cos I -+ mu sin I). Two readings planted 10 kN above and 30 kN below."""
    i = np.radians(60)
    w = WEIGHT / LENGTH
    out, inside = (w * LENGTH * (np.cos(i) + s * 0.25 * np.sin(i)) + BLOCK for s in (1, -1))
    read = [
        {"bit_depth": LENGTH, "operation": "trip_out", "hook_load": out + 10e3, "sigma": 8e3},
        {"bit_depth": LENGTH, "operation": "trip_in", "hook_load": inside - 30e3, "sigma": 2e3},
        {"bit_depth": LENGTH, "operation": "trip_in", "torque": 0.0, "hook_load": inside, "sigma": 2e3},
    ]
    c = case(inclination=i, roadmap={"measured": read})
    rows = table(c, tmp_path, "measured.csv")
    residual = np.array([row["residual"] for row in rows])
    assert residual == pytest.approx([-10e3, 30e3, 0.0], abs=1.0)
    drag = 0.05 * w * LENGTH * np.sin(i)  # of a friction factor changed by 0.05, from 0.25 to 0.2 and 0.3
    assert rows[0]["band_high"] - out == pytest.approx(drag + 1.645 * 8e3, abs=1.0)
    assert inside - rows[1]["band_low"] == pytest.approx(drag + 1.645 * 2e3, abs=1.0)
    found = json.loads((tmp_path / "out" / "summary.json").read_text())["measured"]["hook_load"]
    assert found["readings"] == 3 and "surface_torque" not in found
    assert found["bias"] == pytest.approx(residual.mean())
    assert found["rms"] == pytest.approx(np.sqrt((residual**2).mean()))
    assert found["largest"] == pytest.approx(30e3, abs=1.0)
    inside_band = [row["band_low"] <= row["corrected"] <= row["band_high"] for row in rows]
    assert found["in_band"] == pytest.approx(np.mean(inside_band))
    assert drag + 1.645 * 2e3 < 30e3 or inside_band[1]


def test_a_point_below_the_hole_has_no_computed_value(tmp_path: Path) -> None:
    read = [{"bit_depth": 2500.0, "operation": "trip_out", "hook_load": 1e6}, *points({"trip_out": 1.0})]
    rows = table(case(roadmap={"measured": read}), tmp_path, "measured.csv")
    assert len(rows) == 2 and sum(np.isnan(row["computed"]) for row in rows) == 1


# ---------------------------------------------------------------------- running drag
@pytest.mark.parametrize("speed", [0.5, -0.5])
def test_running_drag_is_the_momentum_of_the_annulus(speed: float) -> None:
    """Surge pressure p of a closed pipe: the wall stress is p gap/(4 L), so the mud lifts it by p (A_o + pi D gap/4)."""
    c = case(bottom={"kind": "free", "plugged": True})
    pressure = (
        Tripping(c, whole_string(c), "closed")
        .at("trip_in" if speed > 0 else "trip_out", abs(speed))
        .surge_pressure
    )
    found = circulation(c, LENGTH, 0.0, "", speed)
    gap = 0.2159 - 0.127
    expected = pressure * (np.pi / 4 * 0.127**2 + np.pi * 0.127 * gap / 4)
    assert found.below[0] == pytest.approx(expected, rel=1e-4)
    assert np.sign(found.below[0]) == np.sign(speed)


def test_running_drag_of_roadmap_and_points(tmp_path: Path) -> None:
    """In a vertical hole the drag changes the hook load by itself; it pulls both ways against the motion."""
    plan = {
        "operations": ["trip_in", "trip_out"],
        "measured": points({"trip_in": 1.0, "trip_out": 1.0}, speed=0.5),
    }
    c = case({"running_drag": True}, bottom={"kind": "free", "plugged": True}, roadmap=plan)
    found = table(c, tmp_path, "roadmap.csv")
    drag = {
        row["operation"]: row["hook_load"] - (WEIGHT - MUD * G * np.pi / 4 * 0.1086**2 * LENGTH)
        for row in found
    }
    lift = circulation(c, LENGTH, 0.0, "", 0.5).below[0]
    assert drag["trip_in"] == pytest.approx(-lift, rel=1e-3) and lift > 0
    assert drag["trip_out"] == pytest.approx(lift, rel=1e-2)
    for row in table(c, tmp_path, "measured.csv"):
        other = next(q for q in found if q["operation"] == row["operation"])
        assert row["computed"] == pytest.approx(other["hook_load_total"], rel=1e-9)


def test_torque_of_zero_in_a_trip_is_no_reading(tmp_path: Path) -> None:
    """Rows of pick-up and slack-off with a torque of 0, as logs have them: the same interval as with empty cells (contract A1)."""
    i = np.radians(60)
    loads = [WEIGHT * (np.cos(i) + s * 0.3 * np.sin(i)) + BLOCK + d for s, d in ((1, 4e3), (-1, -3e3))]
    fits = []
    for k, torque in enumerate(({"torque": 0.0}, {})):
        read = [
            {"bit_depth": LENGTH, "operation": word, "hook_load": load} | torque
            for word, load in zip(("trip_out", "trip_in"), loads, strict=True)
        ]
        found = dp.calibrate(case(inclination=i, roadmap={"measured": read}), tmp_path / str(k))
        fits.append(found.summary["fit"]["open_hole"])
    assert fits[0] == fits[1] and fits[0]["value"] == pytest.approx(0.3, abs=0.02)


def test_weight_on_bit_of_an_indicator_zeroed_higher_up(tmp_path: Path) -> None:
    """Vertical hole: zeroed at 600 m, 400 m of pipe later the indicator lacks their weight in mud."""
    wob, more = 150e3, WEIGHT * 0.4
    read = {"bit_depth": LENGTH, "operation": "drilling", "hook_load": WEIGHT + BLOCK - wob, "rpm": 10.0}
    plan = {"operations": ["drilling"], "drilling": {"rop": 0.0, "tob": 0.0}}
    for rig, shown in (
        ({"wob_zero": {"bit_depth": 600.0}}, wob - more),
        ({"wob_zero": "off_bottom"}, wob),
        ({}, wob),
    ):
        c = case(rig, roadmap=plan | {"measured": [read | {"wob": shown}]})
        assert Case(**case_data(c)) == c
        (row,) = table(c, tmp_path, "measured.csv")
        assert row["residual"] == pytest.approx(0.0, abs=1e-6 * wob)


def test_weight_on_bit_without_the_pressure_drop_of_the_bit(tmp_path: Path) -> None:
    """Vertical hole: the weight read lacks rho Q^2/(2 A_n^2) times the area; the hook load is that of the whole weight."""
    nozzle, flow, area, wob = 4e-4, 0.02, 12e-4, 80e3
    drop = MUD * flow**2 / (2 * 0.95**2 * nozzle**2)
    bit = {"kind": "bit", "length": 0.3, "od": 0.2159, "id": 0.0, "mass": 50.0, "nozzle_area": nozzle}
    pipe = {"kind": "pipe", "length": LENGTH - 0.3, "od": 0.127, "id": 0.1086}
    keys = {
        "string": [pipe, bit],
        "roadmap": {"bit_depth": [LENGTH], "operations": ["drilling"], "drilling": {"rop": 0.0}},
    }
    point = {
        "bit_depth": LENGTH,
        "operation": "drilling",
        "hook_load": 5e5,
        "rpm": 10.0,
        "flow_rate": flow,
        "tob": 0.0,
    }
    found = []
    for pump_off, read in ((0.0, wob), (area, wob - drop * area)):
        bottom = {"kind": "bit", "pump_off_area": pump_off}
        plan = keys["roadmap"] | {"measured": [point | {"wob": read}]}
        c = case(**{"bottom": bottom, "string": keys["string"], "roadmap": plan})
        (row,) = table(c, tmp_path, "measured.csv")
        found.append(row["computed"])
    assert drop * area > 1e3
    assert found[1] == pytest.approx(found[0], abs=1e-3 * drop * area)


def test_points_that_cannot_be_computed_leave_the_curves(tmp_path: Path) -> None:
    """A flow rate at a point of a dry string: the roadmap stands, and says why measured.csv is missing."""
    read = points({"trip_out": 1.0}, flow_rate=0.02)
    dry = case(fluid=None, roadmap={"measured": read, "operations": ["trip_out"]})
    found = run_roadmap(Job(dry, tmp_path / "out"))
    assert (found.folder / "roadmap.csv").exists() and not (found.folder / "measured.csv").exists()
    assert any(
        "measured.csv is left out" in text and "flow_rate" in text for text in found.summary["warnings"]
    )
    still = [{"bit_depth": LENGTH, "operation": "drilling", "torque": 5e3, "rpm": 0.0}]
    found = run_roadmap(Job(case(roadmap={"measured": still}), tmp_path / "still"))
    assert (found.folder / "measured.csv").exists() and not found.summary["measured"]
