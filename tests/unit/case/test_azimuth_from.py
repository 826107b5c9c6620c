"""`azimuth_from: true` of a survey: true azimuth = magnetic + declination, grid azimuth = true - convergence, east positive
(the convention of survey reports, such as ISCWSA's)."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pytest

from drillpetsc.case import Case, load_case
from drillpetsc.case.plausible.plausibility import notes
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError
from drillpetsc.model.hole import build_well
from tests.helpers.tables import each_row
from tests.unit.case.test_survey_of_a_case import case

LISTS = {
    "md": [0, 1000, 2000],
    "inclination": ["30 deg", "30 deg", "30 deg"],
    "azimuth": ["358 deg", "-10 deg", "10 deg"],
}
BOTH = {"declination": "4.5 deg", "convergence": "1.5 deg"}


def degrees(made: Case) -> list[float]:
    return [math.degrees(a) for a in made.well.survey.azimuth]  # type: ignore[union-attr]


@each_row(
    ("keys", "expected", "north"),
    [
        ({"north": "magnetic", **BOTH}, [1, 353, 13], "grid"),
        ({"north": "magnetic", "declination": "4.5 deg"}, [2.5, 354.5, 14.5], "true"),
        ({"north": "magnetic", "declination": "-8 deg"}, [350, 342, 2], "true"),
        ({"north": "magnetic", "declination": "0 deg", "convergence": "0 deg"}, [358, 350, 10], "grid"),
        ({"north": "true", "convergence": "1.5 deg"}, [356.5, 348.5, 8.5], "grid"),
        ({"north": "true", **BOTH}, [356.5, 348.5, 8.5], "grid"),
    ],
)
def test_azimuths_are_turned_once(
    keys: dict[str, Any], expected: list[float], north: str, tmp_path: Path
) -> None:
    """Not again where the case is written and read, or a key of it is replaced; the remark says what was done."""
    made = case({**LISTS, **keys, "azimuth_from": True})
    assert degrees(made) == pytest.approx(expected) and made.well.survey.north == north  # type: ignore[union-attr]
    made.dump(tmp_path / "case.yaml")
    again = load_case(tmp_path / "case.yaml")
    for other in (again, Case(**case_data(made)), made.replace({"title": "x"})):
        assert degrees(other) == pytest.approx(expected)
    assert any(f"to {north} north" in note for note in notes(made))
    plain = case({**LISTS, **keys})
    assert degrees(plain) == pytest.approx([358, -10, 10]) and not any("turned" in n for n in notes(plain))


def test_only_the_compass_changes() -> None:
    """The path of a hole is turned about the vertical, so that its forces are the same."""
    paths = []
    for azimuth_from in (False, True):
        well = build_well(case({**LISTS, "north": "magnetic", **BOTH, "azimuth_from": azimuth_from}))
        assert well is not None
        paths.append(well.at([500.0, 1500.0, 2000.0])[0])
    turn = math.radians(3.0)
    for old, new in zip(*paths, strict=True):
        assert new[0] == pytest.approx(math.cos(turn) * old[0] - math.sin(turn) * old[1])
        assert new[1] == pytest.approx(math.sin(turn) * old[0] + math.cos(turn) * old[1])
        assert new[2] == pytest.approx(old[2])


def test_a_file_and_its_tie_in(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both have azimuths from the same north; angles without a unit are degrees in field units."""
    (tmp_path / "x.csv").write_text("md,inc,azi\n300,30,10\n330,31,10\n")
    monkeypatch.chdir(tmp_path)
    survey = {
        "file": "x.csv",
        "tie_in": {"md": 0, "inclination": 20, "azimuth": 8},
        "north": "magnetic",
        "declination": 4.5,
        "convergence": 1.5,
        "azimuth_from": True,
    }
    made = case(survey, units="field")
    assert degrees(made) == pytest.approx([11, 13, 13])
    assert any("turned by 3 deg" in note for note in notes(made))


@each_row(
    ("keys", "at", "text"),
    [
        ({}, "well.survey.north", "true or magnetic"),
        ({"north": "grid", **BOTH}, "well.survey.north", "true or magnetic"),
        ({"north": "true"}, "well.survey.convergence", "the convergence as an angle"),
        ({"north": "true", "declination": "4 deg"}, "well.survey.convergence", "the convergence as an angle"),
        (
            {"north": "magnetic", "convergence": "1 deg"},
            "well.survey.declination",
            "the declination as an angle",
        ),
        ({"north": "magnetic", **BOTH, "azimuth_from": "true"}, "well.survey.azimuth_from", "true or false"),
        (
            {"north": "magnetic", **BOTH, "azimuth_from": "magnetic"},
            "well.survey.azimuth_from",
            "true or false",
        ),
    ],
)
def test_what_cannot_be_applied(keys: dict[str, Any], at: str, text: str) -> None:
    with pytest.raises(CaseError) as caught:
        case({**LISTS, "azimuth_from": True, **keys})
    assert caught.value.at == at and text in str(caught.value)
