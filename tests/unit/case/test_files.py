"""Cases as files: what is written reads back the same, surveys from CSV, changes from the command line."""

import math
from pathlib import Path
from typing import Any

import pytest

from drillpetsc.case import Case, load_case, override
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError
from drillpetsc.time_function import Constant
from tests.helpers.tables import each_row

CASES = Path(__file__).parents[3] / "cases"
PIPE: dict[str, Any] = {"kind": "pipe", "length": "90 m", "od": "5 in", "id": "4.276 in"}
BIT: dict[str, Any] = {"kind": "bit", "length": 0.5, "od": "8.5 in", "mass": "60 kg"}
WELL: dict[str, Any] = {
    "survey": {"md": [0, 100], "inclination": [0, 0], "azimuth": [0, 0]},
    "sections": [{"to": 100, "kind": "open_hole", "diameter": "8.5 in"}],
}


def simple(**keys: Any) -> Case:
    return Case(**{"string": [PIPE], "top": "clamped", **keys})


VALID_CASES: list[dict[str, Any]] = [
    {},
    {"well": WELL, "contact": "none"},
    {"well": WELL, "contact": {"stribeck": {"static": 0.4, "speed": 0.1}}, "time": {"end": 3}},
    {"top": {"kind": "driven", "rotation": {"ramp": 2, "value": "80 rpm"}, "damping": "5 N m s/rad"}},
    {"top": {"kind": "top_drive", "force": {"time": [0, 1, 1], "value": [1, 2, "-3 kN"]}}},
    {
        "bottom": {"kind": "force", "moment": [0, 0, "1 N m"]},
        "initial": {"from": "straight", "inclination": "90 deg"},
    },
    {"loads": [{"from": 1, "to": 2, "force": [0, 0, 1], "value_over": {"ramp": 1, "value": 1}}]},
    {
        "string": [
            {
                **PIPE,
                "bend": {"angle": "1 deg"},
                "material": {"young": "70 GPa"},
                "initial": {"imperfection": 0.01},
            }
        ]
    },
    {"string": [{**PIPE, "material": {"young": "70 GPa"}}, PIPE], "material": {"density": 2700}},
    {
        "string": [PIPE, BIT],
        "well": WELL,
        "bottom": {"kind": "bit"},
        "petsc": {"snes_monitor": None, "ts_rtol": 1e-5},
    },
    {"fluid": {"density": 1000, "rheology": {"model": "newtonian", "viscosity": 0}, "added_mass": "none"}},
    {
        "well": {**WELL, "sections": [{**WELL["sections"][0], "compliance": {"young": "20 GPa"}}]},
        "bottom": {"kind": "pinned", "plugged": True},
        "fluid": {
            "density": "12 lb/gal",
            "rheology": {
                "model": "casson",
                "plastic_viscosity": "10 cP",
                "yield_stress": "2 Pa",
                "law": "exact",
            },
            "pump_pressure": {"ramp": 2, "value": "100 bar"},
            "lateral_damping": "5 N s/m^2",
        },
    },
    {
        "hold_string": True,
        "top": None,
        "well": WELL,
        "contact": {"stiffness": 1e7},
        "fluid": {
            "density": 1200,
            "rheology": {"model": "power_law", "consistency": "0.5 Pa s^n", "index": 0.7},
            "flow_rate": {"time": [0, 1, 1], "value": [0, "30 l/s", 0]},
        },
    },
]


@each_row("keys", VALID_CASES)
def test_a_written_case_reads_back_the_same(keys: dict[str, Any], tmp_path: Path) -> None:
    case = simple(**keys)
    case.dump(tmp_path / "case.yaml")
    assert load_case(tmp_path / "case.yaml") == case
    assert Case(**case_data(case)) == case


def test_yaml_anchors_and_merges(tmp_path: Path) -> None:
    text = "string:\n  - &joint {kind: pipe, length: 9 m, od: 5 in}\n  - *joint\n  - {<<: *joint, od: 6 in}\n"
    (tmp_path / "case.yaml").write_text(text + "top: clamped\n")
    case = load_case(tmp_path / "case.yaml")
    assert [item.od for item in case.string] == pytest.approx([0.127, 0.127, 0.1524])


@each_row(
    "text",
    [
        "md,inclination,azimuth\n0,0,0\n30,1.5,359\n",
        "md [ft]; azimuth [rad]; inclination [deg]; tvd\n0; 0; 0; 0\n98.4251968503937; 6.265732014659643; 1.5; 3\n",
        "# a comment\n\nMD [m]\tInclination (deg)\tAzimuth\n0\t0\t0\n30\t1.5\t359\n",
        "\ufeffmd, inclination, azimuth\n0, 0, 0\n30, 1.5, 359\n",
    ],
)
def test_survey_files(text: str, tmp_path: Path) -> None:
    (tmp_path / "survey.csv").write_text(text, encoding="utf-8")
    text = "well:\n  survey: survey.csv\n  sections: [{to: 30 m, kind: casing, diameter: 10 in}]\n"
    (tmp_path / "case.yaml").write_text(
        text + "string: [{kind: pipe, length: 9 m, od: 5 in}]\ntop: clamped\n"
    )
    case = load_case(tmp_path / "case.yaml")
    assert case.well is not None
    assert case.well.survey.md == pytest.approx((0.0, 30.0))
    assert case.well.survey.inclination == pytest.approx((0.0, math.radians(1.5)))
    assert case.well.survey.azimuth == pytest.approx((0.0, math.radians(359)))


@each_row(
    ("text", "line", "want"),
    [
        ("", 1, "a header"),
        ("md,inclination\n0,0\n", 1, "a header"),
        ("md [s],inclination,azimuth\n0,0,0\n", 1, "a length"),
        ("md,inclination,azimuth\n0,0,0\n30,x,0\n", 3, "a number in deg"),
        ("md,inclination,azimuth\n0,0,0\n30,1\n", 1, "at least two stations"),
        ("md,inclination,azimuth\n5,5,0\n30,6,0\n", 2, "tie_in"),
        ("md,inclination,azimuth\n0,0,0\n", 1, "at least two stations"),
        ("md,inclination,azimuth\n0,0,0\n30,nan,0\n", 3, "a number in deg"),
    ],
)
def test_broken_survey_files(
    text: str, line: int, want: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "survey.csv").write_text(text)
    monkeypatch.chdir(tmp_path)
    sections = [{"to": 30, "kind": "casing", "diameter": 0.25}]
    with pytest.raises(CaseError) as caught:
        simple(well={"survey": "survey.csv", "sections": sections})
    error = caught.value
    assert (error.file, error.line) == ("survey.csv", line)
    assert want in error.want


def test_continuing_a_run(tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    text = "string: [{kind: pipe, length: 9 m, od: 5 in}]\ntop: clamped\ninitial: {from: run}\n"
    (tmp_path / "case.yaml").write_text(text)
    with pytest.raises(CaseError, match="checkpoint.h5"):
        load_case(tmp_path / "case.yaml")
    (tmp_path / "run" / "checkpoint.h5").touch()
    assert load_case(tmp_path / "case.yaml").initial.from_ == str((tmp_path / "run").resolve())


def test_override() -> None:
    data = {"string": [dict(PIPE)], "top": "clamped"}
    assert override(data, "string[0].od=8 in")["string"][0]["od"] == "8 in"
    assert override(data, "output.probes=[1 m, 2]")["output"] == {"probes": ["1 m", 2]}
    assert override(data, "top={kind: top_drive, rotation: 80 rpm}")["top"]["kind"] == "top_drive"
    assert data == {"string": [PIPE], "top": "clamped"}
    for change in ("string[1].od=1", "top", "title.x.y=1", "string.od=1", "[=1", "a..b=1", "=5"):
        with pytest.raises(CaseError):
            override({**data, "title": "t"}, change)


def test_changes_while_loading() -> None:
    case = load_case(CASES / "vertical-2000m.yaml", ["top.rotation=60 rpm", "time.end=1 s", "contact=none"])
    assert case.top.rotation == Constant(pytest.approx(2 * math.pi))
    assert case.contact is None
    with pytest.raises(CaseError, match=r"top.rotation"):
        load_case(CASES / "vertical-2000m.yaml", ["top.rotation=60 m"])
