"""Strings that are empty above a mud level: weight, pressures, and commands that refuse (key `fluid.level_in_string`)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drillpetsc as dp
from drillpetsc.analysis.commands.check import describe
from drillpetsc.analysis.loads.torque_drag.string_rows import rows_at
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from tests.helpers.wells import newtonian

G, SEA = 9.80665, 1030.0
BORE, OUTSIDE = np.pi / 4 * 0.15748**2, np.pi / 4 * 0.1778**2  # of 7 in tubing [m2]
METAL = 7850 * (OUTSIDE - BORE)
PLUGGED = {"kind": "free", "plugged": True}


def case(level: Any = "300 m", inclination: float = 0.0, **keys: Any) -> dp.Case:
    fluid = {"density": SEA, "rheology": {"model": "newtonian", "viscosity": 1e-3}}
    if level is not None:
        fluid["level_in_string"] = level
    survey = {"md": [0, 1000], "inclination": [inclination] * 2, "azimuth": [0, 0]}
    sections = [{"kind": "casing", "diameter": 0.2168, "friction": 0.25}]
    tubing = {"kind": "pipe", "length": 1000, "od": 0.1778, "id": 0.15748}
    return dp.Case(
        **{
            "well": {"survey": survey, "sections": sections},
            "string": [tubing],
            "top": "clamped",
            "bottom": PLUGGED,
            "fluid": fluid,
        }
        | keys
    )


def test_weight_of_tubing_without_mud() -> None:
    """7 in tubing of F-4 in sea water: 197 N/m less where it is empty (contract A1)."""
    rows = rows_at(case(), 1000.0)
    assert rows.edges == pytest.approx([0, 300, 1000])
    assert rows.weight[1] - rows.weight[0] == pytest.approx(197, abs=0.5)
    assert rows.weight[0] == pytest.approx(G * (METAL - SEA * OUTSIDE), rel=1e-9)
    assert rows.weight[1] == pytest.approx(G * (METAL - SEA * (OUTSIDE - BORE)), rel=1e-9)
    assert rows_at(case("0 m"), 1000.0).weight == pytest.approx(rows.weight[1:], rel=1e-9)  # full
    assert rows_at(case("1500 m"), 1000.0).weight == pytest.approx(
        rows_at(case(None), 1000.0).weight
    )  # empty
    tubing = {"kind": "pipe", "od": 0.1778, "id": 0.15748}
    parts = case(string=[tubing | {"length": 200}, tubing | {"length": 800}])
    assert rows_at(parts, 1000.0).edges == pytest.approx([0, 200, 300, 1000])
    assert rows_at(parts, 1000.0).weight == pytest.approx(rows.weight[[0, 0, 1]], rel=1e-9)


def test_hook_load_of_a_roadmap(tmp_path: Path) -> None:
    """Inclined hole: sum of w L (cos I +- mu sin I) over both parts."""
    i = np.radians(40)
    plan = {"bit_depth": [1000], "operations": ["trip_in", "trip_out"], "friction_factor": {"cased": 0.25}}
    folder = dp.roadmap(case(inclination=i, roadmap=plan), tmp_path / "out").folder
    table = read_table(folder / "roadmap.csv")
    weight = 300 * G * (METAL - SEA * OUTSIDE) + 700 * G * (METAL - SEA * (OUTSIDE - BORE))
    expected = [weight * (np.cos(i) + s * 0.25 * np.sin(i)) for s in (-1, 1)]
    assert table["hook_load [N]"] == pytest.approx(expected, rel=1e-6)


def test_only_the_soft_string_has_it(tmp_path: Path) -> None:
    for compute in (
        lambda: dp.statics(case(), tmp_path / "s"),
        lambda: dp.hydraulics(case(), tmp_path / "h", flow="10 l/s"),
        lambda: dp.limits(case(), tmp_path / "l"),
        lambda: dp.roadmap(case(), tmp_path / "r", model="stiff"),
    ):
        with pytest.raises(CaseError, match="level_in_string|soft|plugged"):
            compute()
    assert "empty above MD 300 m" in describe(case())


def test_an_open_string_fills() -> None:
    with pytest.raises(CaseError, match="level_in_string[\\s\\S]*plugged"):
        case(bottom="free")
    assert dp.Case(**case_data(case())) == case()


def test_floated_casing_holds_air_below_the_collar(tmp_path: Path) -> None:
    """9 5/8 in casing, 7987.8 kg/m3, in 10.4 ppg: mud to the collar, air in the lowest 1980 m; J-well by own integration of the
    soft string over arc length (trapezoids of 0.5 m), with the helix of the pushed part left out by a string in tension."""
    floated = 1980.0
    outside, bore = np.pi / 4 * 0.244475**2, np.pi / 4 * 0.2204974**2
    metal, mud = 7987.8 * (outside - bore), 10.4 * 119.826427
    survey = {"md": [0, 760, 1540, 4200], "inclination": [0, 0, 1.3, 1.3], "azimuth": [2] * 4}
    plan = {
        "bit_depth": [3000, 4100],
        "operations": ["trip_in", "trip_out"],
        "friction_factor": {"cased": 0.22},
    }
    well = dp.Case(
        well={"survey": survey, "sections": [{"kind": "casing", "diameter": 0.3153, "friction": 0.22}]},
        string=[
            {"kind": "pipe", "length": 4100, "od": 0.244475, "id": 0.2204974, "material": {"density": 7987.8}}
        ],
        top="clamped",
        bottom=PLUGGED,
        fluid=newtonian(mud, 0.02, floated_length=floated),
        roadmap=plan,
    )
    folder = dp.roadmap(well, tmp_path / "out").folder
    table = read_table(folder / "roadmap.csv")
    kappa = 1.3 / 780

    def hook(bit: float, sign: float) -> float:
        s = np.linspace(bit, 0, 2 * int(bit) + 1)
        force = 0.0
        for a, b in zip(s, s[1:], strict=False):
            m = 0.5 * (a + b)
            w = G * (metal + (mud * bore if m < bit - floated else 0.0) - mud * outside)
            i = np.clip((m - 760) * kappa, 0, 1.3)
            bend = kappa if 760 < m < 1540 else 0.0
            normal = abs(w * np.sin(i) - force * bend)
            force += (a - b) * (w * np.cos(i) + sign * 0.22 * normal)
        return force

    expected = sorted(hook(bit, sign) for sign in (-1, 1) for bit in (3000.0, 4100.0))
    assert sorted(table["hook_load [N]"]) == pytest.approx(expected, rel=2e-3)
    full = next(r for r in rows_at(well, 3000.0).weight[:1])
    assert full == pytest.approx(G * (metal + mud * bore - mud * outside), rel=1e-9)
    assert "empty in its lowest 1980 m, with mud above" in describe(well)
    with pytest.raises(CaseError, match="not both"):
        dp.Case(**case_data(well) | {"fluid": case_data(well)["fluid"] | {"level_in_string": 5}})
    with pytest.raises(CaseError, match="floated_length"):
        dp.statics(well, tmp_path / "s")


def test_mud_as_weight_gives_other_commands_a_partly_filled_string(tmp_path: Path) -> None:
    """What the refusal advises: tubing in two items, the lower one with its mud as weight, run in at 0.6 rad.
    The hook carries the weights of metal and mud less that of the displaced mud, each with cos - mu sin."""
    pipe = {"kind": "pipe", "od": 0.1778, "id": 0.15748}
    filled = METAL + SEA * BORE
    advised = case(
        level=None,
        inclination=0.6,
        string=[pipe | {"length": 300}, pipe | {"length": 700, "weight": filled}],
        fluid={"density": SEA, "rheology": {"model": "newtonian", "viscosity": 0}, "bulk_modulus": 1e13},
        top={"kind": "top_drive", "lowering": 0.2},
    )
    with pytest.raises(CaseError, match="weight that contains it"):
        dp.statics(case(inclination=0.6), tmp_path / "refused")
    load = dp.statics(advised, tmp_path / "out").summary["hook_load"]
    weight = G * (300 * METAL + 700 * filled - 1000 * SEA * OUTSIDE)
    assert load == pytest.approx(weight * (np.cos(0.6) - 0.25 * np.sin(0.6)), rel=2e-3)
