"""Columns of `limits` for burst, collapse and Miner's damage, from the other columns of the table; S-N curves and their files."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import drillpetsc as dp
from drillpetsc.analysis.loads.limits.fatigue import read_sn
from drillpetsc.analysis.loads.limits.strength import burst_pressure
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well

MPA, RPM = 1e6, math.pi / 30


@pytest.fixture(scope="module")
def case() -> dp.Case:
    """Drill pipe that turns in a build of 3 deg/30 m, with mud that flows through a bit."""
    return dp.Case(
        well=simple_well([0, 100, 500], "8.5 in", [0, 0, "40 deg"], friction=0.2),
        string=[
            dp.DrillPipe("5in 19.50 S-135 NC50 premium", length=480.0, element_length=10.0),
            dp.Bit(length=0.3, od="8.5 in", nozzles="3 x 12/32 in"),
        ],
        top={"kind": "top_drive", "rotation": "120 rpm"},
        fluid={
            "density": "10 ppg",
            "flow_rate": "500 gpm",
            "rheology": {"pv": "20 cP", "yp": "8 lbf/100ft2"},
        },
    )


@pytest.fixture(scope="module")
def table(case: dp.Case, tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    out = tmp_path_factory.mktemp("limits") / "out"
    result = dp.limits(case, out, operation="rotate_off_bottom", sn="15.0,4.0", corrosive=True)
    assert "Miner's damage per hour" in "\n".join(result.lines)
    columns = {name: np.asarray(result.limits[name]) for name in result.limits.variables}
    return columns | {"summary": result.summary}


def test_burst_is_the_difference_of_the_pressures_over_what_the_worn_wall_bears(table: dict) -> None:
    """Premium 5 in 19.50 S-135: 2 Y 0.8 t/D = 15,638 psi (API RP 7G)."""
    known = np.isfinite(table["burst_ratio"])
    limit = float(burst_pressure(0.127, 0.8 * 0.362 * 0.0254, table["yield_strength"][known][0], True))
    assert limit / 6894.757 == pytest.approx(15638, abs=2)
    wanted = (table["internal_pressure"] - table["annulus_pressure"])[known] / limit
    assert table["burst_ratio"][known] == pytest.approx(wanted, rel=1e-6) and known.sum() > 20
    assert wanted.min() > 0.01 and (table["collapse_ratio"][known] == 0).all()


def test_damage_is_turns_over_allowed_cycles(table: dict) -> None:
    """log10 N = 15 - 4 log10(S/MPa): 120 rpm are 7200 cycles an hour."""
    stress, damage = table["worst_bending_stress"], table["damage_per_hour"]
    known = np.isfinite(stress) & (stress > 0)
    turning = damage[known] * 10.0 ** (15 - 4 * np.log10(stress[known] / MPA))
    assert known.any() and turning == pytest.approx(7200.0)
    worst = table["summary"]["weakest"]["damage_per_hour"]
    assert worst["value"] == pytest.approx(np.nanmax(damage))


def test_corrosive_mud_takes_four_tenths_of_the_dogleg(case: dp.Case, table: dict, tmp_path: Path) -> None:
    clean = dp.limits(case, tmp_path / "out", operation="rotate_off_bottom").limits
    known = np.isfinite(table["fatigue_dls"])
    assert known.any()
    assert table["fatigue_dls"][known] == pytest.approx(0.6 * np.asarray(clean["fatigue_dls"])[known])
    assert "damage_per_hour" not in clean


def test_a_curve_of_points(tmp_path: Path) -> None:
    """Straight in logarithms: 1e5 cycles at 200 MPa and 1e7 at 20 MPa are 1e6 at sqrt(200 20) MPa."""
    (tmp_path / "sn.csv").write_text(
        "# welds\ncycles [-], stress [ksi]\n1e5, 29.00754754\n1e7, 2.900754754\n"
    )
    curve = read_sn(str(tmp_path / "sn.csv"))
    found = curve.cycles_at(np.array([200.0, math.sqrt(4000.0), 20.0, 2.0, 0.0, 201.0]) * MPA)
    assert found[:4] == pytest.approx([1e5, 1e6, 1e7, 1e9], rel=1e-6)
    assert found[4] == np.inf and np.isnan(found[5])
    line = read_sn("15.0,4.0").cycles_at(np.array([100.0, 2000.0, 0.5]) * MPA)
    assert line == pytest.approx([1e7, 10.0 ** (15 - 4 * math.log10(2000)), 1.6e16], rel=1e-6)


@each_row(
    "text",
    [
        "", "15", "15,-4", "0,4", "nan,4", "15,4,2", "nowhere.csv", "1e9,3", "empty.csv", "rising.csv",
        "one.csv", "bad.csv", "head.csv", "below.csv",
    ],
)  # fmt: skip
def test_wrong_curves_are_refused(text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty.csv").write_text("# nothing\n")
    (tmp_path / "rising.csv").write_text("stress [MPa], cycles\n100, 1e6\n200, 1e7\n")
    (tmp_path / "one.csv").write_text("stress [MPa], cycles\n100, 1e6\n")
    (tmp_path / "bad.csv").write_text("stress [MPa], cycles\n100, many\n")
    (tmp_path / "below.csv").write_text("stress [MPa], cycles\n100, 1e6\n-1, 1e7\n")
    (tmp_path / "head.csv").write_text("stress [MPa], turns\n100, 1e6\n")
    with pytest.raises(CaseError, match="--sn"):
        read_sn(text)
