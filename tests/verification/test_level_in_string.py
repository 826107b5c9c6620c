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
