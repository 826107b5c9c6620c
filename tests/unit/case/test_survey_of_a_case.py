"""Surveys in a case: files with options, units of the case, remarks; and warnings about unlikely values."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from drillpetsc.case import Case, load_case
from drillpetsc.case.plausible.plausibility import notes, plausibility
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

FOOT = 0.3048
HOLE: dict[str, Any] = {"kind": "open_hole", "diameter": "8 1/2 in"}
STRING = [{"kind": "pipe", "length": "9 m", "od": "5 in", "id": "4 in"}]


def case(survey: Any, **keys: Any) -> Case:
    return Case(**{"well": {"survey": survey, "sections": [HOLE]}, "string": STRING, "top": "clamped"} | keys)


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    (tmp_path / "x.csv").write_text("md,inc,azi\n300,30,10\n330,31,10\n")
    monkeypatch.chdir(tmp_path)
    return "x.csv"


def test_options_of_a_survey_file(file: str) -> None:
    survey = {
        "file": file,
        "tie_in": {"md": 0, "inclination": "20 deg", "azimuth": "10 deg"},
        "north": "grid",
        "convergence": "1.5 deg",
    }
    found = case(survey)
    stations = found.well.survey  # type: ignore[union-attr]
    assert stations.md == (0.0, 300.0, 330.0) and stations.north == "grid"
    assert stations.inclination[0] == pytest.approx(math.radians(20))
    assert stations.convergence == pytest.approx(math.radians(1.5))
    assert Case(**case_data(found)) == found
    assert any("metres taken" in note for note in notes(found))


def test_depths_of_a_file_are_not_converted_twice(file: str) -> None:
    """A file has its own units, the case's units stand in for missing ones."""
    Path(file).write_text("md [m],inc,azi\n0,0,0\n330,3,10\n")
    assert case(file, units="field").well.survey.md[-1] == 330.0  # type: ignore[union-attr]
    Path(file).write_text("md,inc,azi\n0,0,0\n330,3,10\n")
    field = case({"file": file, "convergence": 1.5}, units="field")
    assert field.well.survey.md[-1] == pytest.approx(330 * FOOT)  # type: ignore[union-attr]
    assert field.well.survey.inclination[-1] == pytest.approx(math.radians(3))  # type: ignore[union-attr]
    assert field.well.survey.convergence == pytest.approx(math.radians(1.5))  # type: ignore[union-attr]


@each_row(
    ("angle", "want"),
    [
        ("710 deg", "at least 0 deg, at most 180 deg"),
        ("-1 °", "at least 0 °, at most 180 °"),
        ("7 rad", "at least 0 rad, at most 3.14159 rad"),
        (7, "at least 0, at most 3.14159 rad"),
    ],
)
def test_limits_of_an_angle_are_told_in_its_unit(angle: Any, want: str) -> None:
    with pytest.raises(CaseError) as caught:
        case({"md": [0, 100], "inclination": [0, angle], "azimuth": [0, 0]})
    assert caught.value.want == f"an angle, {want}"


@pytest.mark.parametrize(
    ("survey", "at", "text"),
    [
        ({"file": "no.csv"}, "well.survey.file", "a survey file that exists"),
        ({"file": "x.csv", "tie": 1}, "well.survey.tie", "tie_in"),
        ({"file": "x.csv", "tie_in": {"md": "5 kg"}}, "well.survey.tie_in.md", "a length"),
        ({"file": 5}, "well.survey.file", "text"),
        ({"file": "x.csv", "md": [0, 1]}, "well.survey.md", "one of these keys"),
        ({"file": "x.csv"}, "md", "tie_in"),
    ],
)
def test_wrong_options(survey: Any, at: str, text: str, file: str) -> None:
    with pytest.raises(CaseError) as caught:
        case(survey)
    assert caught.value.at == at and text in caught.value.want + caught.value.hint


def test_a_written_case_holds_the_stations(file: str, tmp_path: Path) -> None:
    Path(file).write_text("MD (ft),inc,azi\n98,1,10\n1000,3,10\n")
    found = case(file)
    found.dump(tmp_path / "case.yaml")
    assert load_case(tmp_path / "case.yaml") == found
    assert notes(found) and not notes(load_case(tmp_path / "case.yaml"))


MUD = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.001}}
WHOLE = {
    "initial": {"wob": 1e4},
    "bottom": "bit",
    "string": [{"kind": "pipe", "length": 1000, "od": 0.127, "id": 0.1}],
}
FLAT = {"md": [0, 1000], "inclination": [0, 0], "azimuth": [0, 0]}


@each_row(
    ("keys", "warning"),
    [
        ({}, ""),
        ({"well": {"survey": FLAT, "sections": [{"kind": "open_hole", "diameter": 8.5}]}}, "8.5 in?"),
        ({"fluid": MUD | {"density": 10}}, "10 ppg?"),
        ({"fluid": MUD | {"density": 1.2}}, "1.2 sg?"),
        ({"fluid": MUD}, ""),
        ({"fluid": MUD | {"rheology": {"pv": 20, "yp": 5}}}, "20 cP?"),
        (
            {"units": "field", "string": [{"kind": "pipe", "length": 30, "od": 0.127, "id": 0.1}]},
            "metres without",
        ),
        ({"well": {"survey": FLAT | {"md": [0, 16000]}, "sections": [HOLE]}}, "deeper than any well"),
        ({"well": {"survey": FLAT | {"inclination": [0, 3]}, "sections": [HOLE]}}, "3 deg meant?"),
        (
            {
                "units": "metric",
                "well": {
                    "survey": FLAT | {"inclination": [0, "160 deg"]},
                    "sections": [HOLE | {"diameter": "216 mm"}],
                },
            },
            "is up to 160 deg: the hole climbs there",
        ),
        ({"top": {"kind": "top_drive", "rotation": 120}}, "were 120 rpm meant?"),
        (
            {"units": "metric", "top": {"kind": "top_drive", "rotation": "7200 rpm"}},
            "7200 rpm: faster than drillstrings turn",
        ),
        (WHOLE | {"rig": {"block_weight": 30e6}}, "more than any block with its top drive"),
        ({"fluid": MUD | {"pump_pressure": 3000}}, "bar or psi"),
        (WHOLE | {"initial": {"wob": 6e5}}, "more than bits carry"),
        (WHOLE, ""),
        (WHOLE | {"well": {"survey": FLAT | {"md": [0, 1100]}, "sections": [HOLE]}}, "stands on the bottom"),
        ({"well": {"survey": FLAT | {"md": [0, 1100]}, "sections": [HOLE]}}, ""),
    ],
)
def test_unlikely_values_are_told(keys: dict[str, Any], warning: str) -> None:
    found = plausibility(case(FLAT, **keys))
    assert len(found) == bool(warning)
    assert not warning or warning in found[0]
