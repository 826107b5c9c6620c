"""The hole drilled by one run is the survey of the next, which continues from its end (manual:
verif-survey-of-a-drilled-hole)."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import drillpetsc
from drillpetsc.case import Case
from drillpetsc.geometry.trajectory import SURVEY_TOLERANCE
from drillpetsc.model.hole import build_well
from drillpetsc.output import read_table

OLD = 120.0  # depth of the first case's hole [m]
INTERVAL = 0.5  # between the nodes of new hole [m]


def drilling(survey: Any, last: dict[str, Any], end: float) -> Case:
    """A rotary assembly with a stabiliser that drills 10 m/h from the end of a bent hole."""
    return Case(
        **{
            "well": {
                "survey": survey,
                "sections": [
                    {"to": 60, "kind": "casing", "diameter": 0.2244},
                    {"kind": "open_hole", "diameter": 0.2159, **last},
                ],
            },
            "string": [
                {"kind": "pipe", "length": 60, "od": 0.127, "id": 0.1086, "element_length": 6},
                {"kind": "pipe", "length": 58, "od": 0.1715, "id": 0.0714, "element_length": 4},
                {"kind": "stabilizer", "length": 1.5, "od": 0.212, "id": 0.0714, "mass": 200},
                {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60},
            ],
            "top": {"kind": "top_drive", "rotation": "120 rpm", "lowering": "10 m/h"},
            "bottom": {"kind": "bit"},
            "formation": {"node_spacing": INTERVAL},
            "initial": {"wob": 6e4},
            "time": {"end": end, "mode": "quasi_static"},
            "output": {"history_every": 36.0},
        }
    )


@pytest.fixture(scope="module")
def drilled(tmp_path_factory):
    """Folder of a run that drilled 2 m."""
    survey = {"md": [0, 60, OLD], "inclination": [0, 0, "10 deg"], "azimuth": ["20 deg"] * 3}
    folder = tmp_path_factory.mktemp("next") / "run"
    drillpetsc.run(drilling(survey, {"to": OLD}, 720.0), folder, progress="silent")
    return folder


def test_the_centreline_is_that_of_the_drilled_hole(drilled):
    """Between two nodes the survey deviates by at most SURVEY_TOLERANCE for any path (closed form:
    unit/case/test_hole_as_survey.py), and the arcs of the old hole are exact. So the distance at a station is
    at most SURVEY_TOLERANCE per node of the new hole.  The new path begins where the centre of the bit was at
    the start, half the bit's diameter above the end of the old hole."""
    table = read_table(drilled / "trajectory.csv")
    md, place = table["md [m]"], np.column_stack([table[f"{name} [m]"] for name in ("north", "east", "tvd")])
    case = drilling(str(drilled), {}, 36.0)
    again = build_well(case)
    assert case.well is not None and again is not None
    assert md[-1] == pytest.approx(OLD + 2.0, abs=0.05) and case.well.sections[-1].to == again.depth == md[-1]
    off = np.linalg.norm(again.at(md)[0] - place, axis=1)
    new = md > OLD - 0.5 * 0.2159 - 0.05 * INTERVAL - 1e-6
    assert new.sum() >= 4 and off[~new].max() < 1e-8
    assert off.max() <= SURVEY_TOLERANCE * np.ceil((md[-1] - OLD) / INTERVAL + 2)
    assert np.linalg.norm(place[-1] - place[~new][-1]) > 1.9


def test_the_next_case_continues_drilling(drilled, tmp_path):
    """The next run starts at the end of the hole with the given weight on bit, although its string has the
    same length: its top starts lower."""
    drillpetsc.run(
        drilling(str(drilled / "trajectory.csv"), {"to": "end"}, 180.0), tmp_path / "run", progress="silent"
    )
    old, new = (read_table(folder / "trajectory.csv")["md [m]"] for folder in (drilled, tmp_path / "run"))
    history = read_table(tmp_path / "run" / "history.csv")
    assert history["hole_depth [m]"][0] == pytest.approx(old[-1], abs=1e-6)
    assert history["wob [N]"][0] == pytest.approx(6e4, rel=0.01)
    assert new[-1] == pytest.approx(
        old[-1] + 0.5, abs=0.03
    )  # 180 s at 10 m/h, but for the shortening of the string
    # the reader of the case rounds to 12 digits
    assert np.abs(old[:, None] - new).min(axis=1).max() < 1e-9
