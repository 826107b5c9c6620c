"""The error of a survey: its covariance, and closed forms of what it does to torque."""

from __future__ import annotations

import json

import numpy as np
import pytest

from drillpetsc.analysis.uncertain.draws import correlation_of, draw
from drillpetsc.analysis.uncertain.linear import slopes_of
from drillpetsc.analysis.uncertain.responses import RoadmapResponse
from drillpetsc.analysis.uncertain.spread import spreads_of
from drillpetsc.analysis.uncertain.survey_path import survey_path
from drillpetsc.analysis.uncertain.uncertain_keys import uncertain_keys
from drillpetsc.case import Case
from drillpetsc.case.blocks.uncertain import SurveyError
from drillpetsc.case.blocks.well import Survey
from drillpetsc.cli import main
from drillpetsc.errors import CaseError
from drillpetsc.geometry.trajectory import dogleg
from drillpetsc.geometry.well import direction
from drillpetsc.parallel import initialise_petsc
from tests.helpers.command import main_succeeds

DEGREE = np.pi / 180


@pytest.fixture(scope="module", autouse=True)
def _petsc() -> None:
    initialise_petsc()


def slanted(angle: float, stations: int, **error) -> Case:
    """A straight hole of 2000 m with a string that turns off bottom."""
    md = np.linspace(0, 2000, stations)
    return Case(
        well={
            "survey": {
                "md": md.tolist(),
                "inclination": [angle] * stations,
                "azimuth": [0.3] * stations,
            },
            "sections": [{"kind": "open_hole", "to": "end", "diameter": "216 mm", "friction": 0.25}],
        },
        string=[{"kind": "pipe", "length": "2000 m", "od": "127 mm", "id": "108.6 mm"}],
        top={"kind": "top_drive", "rotation": "60 rpm"},
        bottom="bit",
        roadmap={"operations": ["rotate_off_bottom", "trip_out"], "bit_depth": "2000 m"},
        uncertain={"well.survey": {"path": error}},
    )


@pytest.mark.parametrize(("length", "stations"), [("100 m", 2), ("300 m", 2), ("300 m", 201), ("1500 m", 21)])
def test_torque_in_a_straight_hole(length, stations):
    """The side force changes by q cos(I) dI - T dI'. With T = q cos(I) (L - s), the integral over the string is T(0) dI(0).

    The torque therefore varies by cot(I) times the inclination's error at surface, whatever its length and the stations are.
    An error across the hole acts in second order only.
    """
    inclination = 60 * DEGREE
    case = slanted(inclination, stations, inclination="0.1 deg", lateral="0.1 deg", length=length)
    keys = uncertain_keys(case)
    response = RoadmapResponse(case, keys)
    slopes, _ = slopes_of(case, "roadmap", response, keys, None)
    at = next(i for i, q in enumerate(response.outputs) if q.name == "rotate_off_bottom.surface_torque")
    found = np.sqrt((slopes[at] ** 2).sum()) / response.base[at]
    assert found == pytest.approx(0.1 * DEGREE / np.tan(inclination), rel=0.01)


def test_quantiles_of_samples_agree_with_the_linear_method():
    case = slanted(60 * DEGREE, 21, inclination="0.1 deg", lateral="0.1 deg", length="400 m")
    keys = uncertain_keys(case)
    spreads = [key.spread for key in keys]
    draws = draw(spreads, correlation_of([key.name for key in keys], spreads), 200, 1)
    response = RoadmapResponse(case, keys)
    found = spreads_of("monte-carlo", draws, response.values(draws), (0.1, 0.9))
    slopes, _ = slopes_of(case, "roadmap", response, keys, None)
    for i, output in enumerate(response.outputs):
        if output.name in ("rotate_off_bottom.surface_torque", "trip_out.hook_load"):
            linear = np.sqrt((slopes[i] ** 2).sum())
            assert found.deviation[i] == pytest.approx(linear, rel=0.1)  # of 200 samples: 5 %


def test_covariance_along_the_hole():
    """Angles at the stations have the deviations and the correlation of the key, to the variance that is left out."""
    md = np.linspace(0, 3000, 101)
    incl = np.interp(md, [0, 500, 1500, 3000], [0, 0, 1.0, 1.2])
    survey = Survey(md=md.tolist(), inclination=incl.tolist(), azimuth=np.linspace(1, 2, 101).tolist())
    path = survey_path(survey, SurveyError(inclination=0.003, lateral=0.001, length=250.0))
    far = np.exp(-0.5 * ((path.md[:, None] - path.md) / 250.0) ** 2)
    for k, size in enumerate((0.003, 0.001)):
        mine = path.modes[:, :, k]
        assert np.abs(mine.T @ mine / size**2 - far).max() < 0.02
    assert set(md) <= set(path.md)
    still = path.at(np.zeros(len(path.modes)))
    there = np.isin(path.md, md)
    assert np.asarray(still.inclination)[there] == pytest.approx(incl, abs=1e-12)


def test_azimuths_of_a_hole_that_is_almost_vertical():
    """Random azimuths at 0.1 deg of inclination do not make the error jump from station to station."""
    rng, n = np.random.default_rng(4), 101
    md = np.linspace(0, 3000, n)
    survey = Survey(md=md.tolist(), inclination=[0.1 * DEGREE] * n, azimuth=rng.uniform(0, 6, n).tolist())
    path = survey_path(survey, SurveyError(inclination=0.003, lateral=0.003, length=300.0))
    moved = path.at(rng.standard_normal(len(path.modes)))
    turn = direction(np.asarray(moved.inclination), np.asarray(moved.azimuth)) - path.tangent
    steps = np.linalg.norm(np.diff(turn, axis=0), axis=1)
    assert steps.max() < 5 * 0.003 * 30 / 300  # the slope of a Gaussian process is sd / length; 5 deviations
    assert np.linalg.norm(turn, axis=1).max() > 0.001


def test_stations_that_are_far_apart_lie_on_the_arcs():
    survey = Survey(md=[0.0, 3000.0], inclination=[0.0, 1.2], azimuth=[0.5, 0.5])
    path = survey_path(survey, SurveyError(inclination=0.001, lateral=0.0, length=100.0))
    assert np.diff(path.md).max() < 25.001
    assert dogleg(path.tangent[:-1], path.tangent[1:]) == pytest.approx(1.2 / (len(path.md) - 1), rel=1e-9)


@pytest.mark.parametrize(
    ("spreads", "said"),
    [
        ({"well.survey": {"normal": [0, 1]}}, "path: for well.survey"),
        (
            {"rig.block_weight": {"path": {"inclination": "0.1 deg", "lateral": "0.1 deg"}}},
            "path: for well.survey",
        ),
        ({"well.survey": {"path": {"inclination": 0, "lateral": 0}}}, "an error of the inclination"),
        (
            {"well.survey": {"path": {"inclination": "0.1 deg", "lateral": 0, "length": "1 m"}}},
            "at most 4000 stations",
        ),
        (
            {
                "well.survey": {"path": {"inclination": "0.1 deg", "lateral": 0}},
                "string.weight_factor": {"normal": [1, 0.01], "correlated": {"well.survey": 0.5}},
            },
            "another key",
        ),
    ],
)
def test_refused(spreads, said):
    with pytest.raises(CaseError, match=said):
        data = slanted(1.0, 2, inclination="0.1 deg", lateral=0)._given.keys
        uncertain_keys(Case(**{**data, "uncertain": spreads}))


def test_the_command_gives_one_share_for_the_path(tmp_path, capsys):
    text = """
title: slanted
well:
  survey: {md: [0 m, 1000 m], inclination: [60 deg, 60 deg], azimuth: [0 deg, 0 deg]}
  sections: [{kind: open_hole, to: end, diameter: 216 mm, friction: 0.25}]
string: [{kind: pipe, length: 1000 m, od: 127 mm, id: 108.6 mm}]
top: {kind: top_drive, rotation: 60 rpm}
bottom: bit
uncertain:
  well.survey: {path: {inclination: 0.2 deg, lateral: 0.2 deg, length: 200 m}}
  well.sections[0].friction: {normal: [0.25, 0.01]}
"""
    (tmp_path / "case.yaml").write_text(text)
    words = ["uncertain", str(tmp_path / "case.yaml"), "--out", str(tmp_path / "out"), "--samples", "30"]
    main_succeeds(*words)
    said = capsys.readouterr().out
    assert "well.survey" in said and "well.sections[0].friction 9" in said
    keys = json.loads((tmp_path / "out" / "summary.json").read_text())["keys"]
    assert [q["key"] for q in keys] == ["well.survey", "well.sections[0].friction"]
    assert "WARNING" not in said
    (tmp_path / "case.yaml").write_text(text.replace("length: 200 m", "length: 30 m"))
    main_succeeds(*words[:-1], "160", "--overwrite")
    # the slope of a Gaussian process is sd / length: 0.2 deg sqrt(2) in 30 m
    assert "doglegs of 0.283 deg/30m (rms)" in capsys.readouterr().out
    assert main([*words[:-1], "20", "--overwrite"]) == 2
    assert "path of the survey" in capsys.readouterr().err
