"""cases/field/eagle.yaml: what the case file says, and its hook load against the tally."""

from __future__ import annotations

import csv
import json
from pathlib import Path

import numpy as np
import pytest

from drillpetsc import statics
from drillpetsc.case import load_case

FILE = Path(__file__).parents[2] / "cases" / "field" / "eagle.yaml"
FT, LBF = 0.3048, 4.4482216152605
KLBF = 1e3 * LBF


def survey() -> tuple[np.ndarray, np.ndarray]:
    """Measured depth and TVD [ft] of the survey file, with the csv module alone."""
    text = (FILE.parent / "eagle-survey.csv").read_text(encoding="utf-8-sig")
    rows = [
        row for row in csv.reader(text.splitlines(), delimiter=";") if len(row) == 9 and row[0][:1].isdigit()
    ]
    kept = [row for row in rows if float(row[1]) > -900]
    table = np.array([[float(row[0].replace(",", "")), float(row[3].replace(",", ""))] for row in kept])
    return np.concatenate(([0.0], table[:, 0])), np.concatenate(([0.0], table[:, 1]))


def test_the_messy_survey_is_read() -> None:
    """Feet, a first station at 98 ft, thousands commas, a bad shot and a repeated station."""
    case = load_case(FILE)
    md, _ = survey()
    assert case.well is not None
    assert case.well.survey.md[1] == pytest.approx(98 * FT, rel=1e-12)
    assert np.array(case.well.survey.md) == pytest.approx(np.unique(md) * FT, rel=1e-12)
    remarks = " ".join(case.well.survey.remarks)
    assert (
        "missing values" in remarks
        and "repeated stations" in remarks
        and "vertical station at 0 ft" in remarks
    )
    assert "WARNING" not in remarks  # TVD, N/S, E/W and doglegs of the file agree with its angles


def test_the_words_of_the_tally_are_read() -> None:
    """Lengths, diameters and limits of the case, by hand from its words."""
    case = load_case(FILE)
    assert [item.length / FT for item in case.string] == pytest.approx([9200, 900, 180, 6, 30, 1], rel=1e-12)
    assert case.string[0].od == pytest.approx(0.127, rel=1e-12)
    assert case.string[2].od == pytest.approx(6.75 * 0.0254, rel=1e-12)
    assert case.rig is not None and case.rig.block_weight == pytest.approx(60 * KLBF, rel=1e-9)
    assert case.string[-1].nozzle_area == pytest.approx(5 * np.pi / 4 * (14 / 32 * 0.0254) ** 2, rel=1e-12)


def test_hook_load_is_the_buoyed_tally(tmp_path: Path) -> None:
    """Rotating off bottom, pumps off: the hook carries the buoyed weight times cos(inclination), that is the weight per
    length times the vertical extent of each item; friction of a turning string has no axial part. Within 0.3 %.

    Weights: API RP 7G 22.60 lb/ft (drill pipe), makers' 49.3 lb/ft (heavy-weight pipe); 3.3996 lb/ft per square inch
    of steel (collars; 0.96 for the spiral), scaled to 7850 and 7860 kg/m3.
    """
    case = load_case(FILE, ["initial.wob=0 N", "fluid.flow_rate=0 gpm"])
    result = statics(case, tmp_path / "statics", motion="rotate")
    summary = json.loads((tmp_path / "statics" / "summary.json").read_text())
    md, tvd = survey()
    collar = np.pi / 4 * (6.75**2 - 2.8125**2) * 0.0254**2 / (0.45359237 / FT)  # lb/ft per kg/m3
    stabilizer = next(f.value for f in case.figures.of_item[3] if f.key == "mass") / 0.45359237 / 6  # lb/ft
    bit = case.string[-1].mass / 0.45359237
    weights = [22.60, 49.3, 0.96 * 7850 * collar, stabilizer, 7860 * collar, bit]
    bottoms = np.cumsum([0, 9200, 900, 180, 6, 30, 1])
    heights = np.diff(np.interp(bottoms, md, tvd))
    buoyancy = 1 - 10.5 * 119.8264 / 7850
    expected = buoyancy * float(np.dot(weights, heights)) * LBF
    assert result.summary["hook_load"] == summary["hook_load"] == pytest.approx(expected, rel=3e-3)
