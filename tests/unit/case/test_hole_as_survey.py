"""A drilled hole as the survey of the next case: run folders, sections down to the survey's end, stations
close enough together."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc.case import Case, load_case
from drillpetsc.case.blocks.well import Section
from drillpetsc.case.blocks.well import Well as Hole
from drillpetsc.errors import CaseError
from drillpetsc.geometry.trajectory import angles, refine_stations
from drillpetsc.geometry.well import Well, minimum_curvature
from tests.helpers.tables import each_row

SURVEY = {"md": [0, 120.5], "inclination": [0, 0], "azimuth": [0, 0]}
CASED: dict[str, Any] = {"to": 50, "kind": "casing", "diameter": 0.25}
OPEN: dict[str, Any] = {"kind": "open_hole", "diameter": 0.2159}


@each_row("last", [OPEN, {**OPEN, "to": "end"}, {**OPEN, "to": 120.5}])
def test_the_last_section_ends_with_the_survey(last: dict[str, Any]) -> None:
    hole = Hole(survey=SURVEY, sections=[CASED, last])
    assert [section.to for section in hole.sections] == [50, 120.5]
    assert hole.sections[-1].diameter == 0.2159
    assert Hole(**hole.model_dump(exclude_none=True)) == hole


def test_a_section_may_end_two_surveys() -> None:
    """The section itself is left as it is."""
    section = Section(**OPEN)
    longer = {**SURVEY, "md": [0, 200]}
    assert [Hole(survey=survey, sections=[section]).sections[0].to for survey in (SURVEY, longer)] == [
        120.5,
        200,
    ]


def test_sections_still_have_to_meet_the_survey() -> None:
    for sections in ([CASED], [OPEN, CASED], [{**CASED, "to": 130}, OPEN], [{**OPEN, "to": "bottom"}]):
        with pytest.raises(ValueError):
            Hole(survey=SURVEY, sections=sections)


VALID = "well: {survey: NAME, sections: [{kind: open_hole, diameter: 1 ft}]}\nstring: [{kind: pipe, length: 9 m, od: 5 in}]\ntop: clamped\n"


@each_row("name", ["run", "run/trajectory.csv"])
@each_row("place", ["case", "shell"])
def test_a_run_folder_is_a_survey(
    name: str, place: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Beside the case file, or below the working directory as run folders are."""
    (tmp_path / "shell").mkdir()
    (tmp_path / "case").mkdir()
    (tmp_path / place / "run").mkdir()
    rows = "md [m],inclination [deg],azimuth [deg],north [m],dogleg_severity [deg/30m]\n0,0,0,0,0\n30.25,90,180,1,9\n"
    (tmp_path / place / "run" / "trajectory.csv").write_text(rows)
    (tmp_path / "case" / "a.yaml").write_text(VALID.replace("NAME", name))
    monkeypatch.chdir(tmp_path / "shell")
    hole = load_case(tmp_path / "case" / "a.yaml").well
    assert hole is not None and hole.survey.md == (0.0, 30.25) and hole.sections[0].to == 30.25
    assert hole.survey.inclination[1] == pytest.approx(np.pi / 2) and hole.survey.azimuth[1] == pytest.approx(
        np.pi
    )


def test_where_it_looked_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CaseError, match="looked in the working directory"):
        Case(
            **{
                "string": [{"kind": "pipe", "length": 9, "od": 0.1}],
                "top": "clamped",
                "well": {"survey": "r-001", "sections": [OPEN]},
            }
        )


# ---------------------------------------------------------------------- stations
def missed(well: Well, md: np.ndarray) -> np.ndarray:
    """(n,) how far the minimum-curvature survey through stations md misses the hole at them [m]."""
    stations = well.at(md)[1]
    inclination, azimuth = angles(stations)
    again = Well.from_survey(md, inclination, azimuth, [well.depth], [0.1], [0.3])
    return np.linalg.norm(again.at(md)[0] - well.at(md)[0], axis=1)


def ledge(height: float, length: float = 0.5) -> Well:
    """A vertical hole of 100 m that steps aside by ``height`` over ``length``, and goes on straight for 2 m
    (all [m])."""
    well = Well.from_survey([0.0, 100.0], [0.0, 0.0], [0.0, 0.0], [100.0], [0.1], [0.3])
    for s in (length, length + 1, length + 2):
        well = well.extended(
            100 + s, [height, 0, 100 + s], [1e-9, 0, 1.0]
        )  # nodes of one direction would be a straight line
    return well


@each_row(("height", "pieces"), [(4e-3, 7), (0.8e-3, 3), (0.9e-4, 1)])
def test_stations_on_a_ledge(height: float, pieces: int) -> None:
    """x = d (3 u^2 - 2 u^3): both ends upright, so a survey of them misses all of d; k pieces miss d/k^2, for
    the trapezoidal rule gives 1 - 1/k^2 for the integral of 6 u (1 - u).  k follows from 1e-4 m."""
    well, md = ledge(height), np.array([0.0, 100.0, 100.5, 101.5, 102.5])
    close = refine_stations(well, md)
    assert len(close) == len(md) + pieces - 1 and set(md) <= set(close)
    assert missed(well, md)[2:] == pytest.approx(height, rel=1e-3)
    assert missed(well, close)[-3:] == pytest.approx(height / pieces**2, rel=5e-2)
    assert missed(well, close).max() <= 1e-4


def test_arcs_need_no_more_stations() -> None:
    """A circle of 100 m, of which a survey at any distance is exact: stations 10 m apart turn by 0.1 rad."""
    md = np.linspace(0.0, 150.0, 16)
    well = Well.from_survey([0.0, 150.0], [0.0, 1.5], [0.4, 0.4], [150.0], [0.1], [0.3])
    assert np.array_equal(refine_stations(well, md), md)
    assert minimum_curvature(md, well.at(md)[1], 10.0, 0.1)[1][-1] == pytest.approx(
        well.at(150.0)[0], abs=1e-6
    )


def test_change_of_curvature_along_the_hole() -> None:
    """A clothoid, kappa = s/(R L): stations h apart miss by h^2/12 of the change of curvature (trapezoidal
    rule); wherever between the stations one looks, the hole is not further off than at its end."""
    radius, length, h = 50.0, 10.0, 0.5
    s = np.linspace(0.0, length, int(length / h) + 1)
    fine = np.linspace(0.0, length, 20001)
    turn = fine**2 / (2 * radius * length)
    place = np.column_stack([np.sin(turn), np.zeros_like(turn), np.cos(turn)])
    path = np.vstack(
        [np.zeros(3), np.cumsum(0.5 * (place[1:] + place[:-1]) * np.diff(fine)[:, None], axis=0)]
    )
    well = Well.from_survey([0.0, 100.0], [0.0, 0.0], [0.0, 0.0], [100.0], [0.1], [0.3])
    for i in range(1, len(s)):
        k = i * (len(fine) - 1) // (len(s) - 1)
        well = well.extended(100 + s[i], path[k] + [0, 0, 100.0], place[k])
    md = np.r_[0.0, 100 + s]
    bound = h**2 / 12 / radius
    assert missed(well, md)[-1] == pytest.approx(bound, rel=0.05)
    inclination, azimuth = angles(well.at(md)[1])
    again = Well.from_survey(md, inclination, azimuth, [well.depth], [0.1], [0.3])
    everywhere = np.linspace(0.0, well.depth, 3001)
    assert np.linalg.norm(again.at(everywhere)[0] - well.at(everywhere)[0], axis=1).max() < 1.05 * bound
