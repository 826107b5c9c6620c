"""`length: fill` and `bit_depth`: the string ends where the bit is, with its top at the rig."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import drillpetsc as dp
from drillpetsc.case.importers.stations import cut_stations
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError

TURN = 500.0  # radius of the bend [m]
SURVEY = {"md": [0, 1000, 1000 + TURN], "inclination": [0, 0, 1.0], "azimuth": [0, 0.5, 0.5]}
WELL = {
    "survey": SURVEY,
    "sections": [
        {"to": 800, "kind": "casing", "diameter": 0.3},
        {"kind": "open_hole", "diameter": 0.25},
    ],
}
COLLAR = {"kind": "drill_collar", "length": 90, "od": 0.17, "id": 0.07}


def case(length: Any = "fill", **keys: Any) -> dp.Case:
    pipe = {"kind": "pipe", "od": 0.127, "id": 0.1086, "length": length}
    return dp.Case(**({"string": [pipe, COLLAR], "well": WELL, "top": "clamped"} | keys))


def test_fill_ends_at_the_end_of_the_survey() -> None:
    found = case()
    assert found.string[0].length == pytest.approx(1000 + TURN - 90, abs=1e-9)
    assert "length" in [figure.key for figure in found.figures.of_item[0]]
    assert dp.Case(**case_data(found)) == found


def test_bit_depth_ends_the_hole_on_its_arc() -> None:
    """On an arc of radius R the inclination is (MD - 1000 m)/R."""
    for length in ("fill", 1200.0):
        found = case(length, bit_depth=1250.0)
        assert found.string_length == pytest.approx(1250, abs=1e-9)
        assert found.well is not None and found.bit_depth is None
        assert found.well.survey.md == (0, 1000, 1250)
        assert found.well.survey.inclination[-1] == pytest.approx(250 / TURN, abs=1e-12)
        assert found.well.survey.azimuth[-1] == pytest.approx(0.5, abs=1e-12)
        assert [section.to for section in found.well.sections] == [800, 1250]
        assert dp.Case(**case_data(found)) == found


def test_a_given_length_is_a_figure_of_its_own_only_if_it_changes() -> None:
    for length, listed in (("fill", True), (1200.0, True), (1160.0, False)):
        figures = case(length, bit_depth=1250.0).figures.of_item.get(0, ())
        assert ("length" in [figure.key for figure in figures]) is listed


def test_sections_below_the_bit_are_left_out() -> None:
    found = case(bit_depth=700.0)
    assert found.well is not None and [section.to for section in found.well.sections] == [700]


def test_cut_stations_of_a_turning_arc() -> None:
    """The direction at the middle of an arc is the mean of the directions at its ends."""
    first, last = (0.6, 0.2), (0.9, 1.4)
    _, inclination, azimuth = cut_stations([0, 10, 40], [0, first[0], last[0]], [0, first[1], last[1]], 25)
    ends = [
        np.array([math.sin(i) * math.cos(a), math.sin(i) * math.sin(a), math.cos(i)])
        for i, a in (first, last)
    ]
    mean = sum(ends) / np.linalg.norm(sum(ends))
    found = [
        math.sin(inclination[-1]) * math.cos(azimuth[-1]),
        math.sin(inclination[-1]) * math.sin(azimuth[-1]),
    ]
    assert [*found, math.cos(inclination[-1])] == pytest.approx(mean, abs=1e-12)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"bit_depth": 1600.0}, "at most the end of the survey"),
        ({"bit_depth": 80.0}, "below the other items"),
        ({"bit_depth": 1200.0, "well": None, "length": 9.0}, "a well"),
        ({"well": None}, "a well"),
        ({"string": [COLLAR, {"kind": "pipe", "od": 0.1, "length": "fill"}]}, "topmost"),
        (
            {"string": [{"kind": "body", "length": 1, "mass": 9}, COLLAR], "bit_depth": 1200.0},
            "a pipe as the topmost",
        ),
    ],
)
def test_refused(keys: dict[str, Any], words: str) -> None:
    with pytest.raises(CaseError, match=words):
        case(**keys)
