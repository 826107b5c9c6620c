"""Cases that are valid, but hardly meant, are doubted with key, value and reason; usual ones are not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case, load_case
from drillpetsc.case.plausible.plausibility import plausibility
from tests.helpers.tables import each_row

EAGLE = Path(__file__).parents[3] / "cases" / "field" / "eagle.yaml"

USUAL = {
    "units": "field",
    "well": {
        "survey": {"md": [0, 3000, 8000], "inclination": [0, 0, 0], "azimuth": [0, 0, 0]},
        "sections": [
            {"to": 4500, "kind": "casing", "diameter": 8.681, "friction": 0.2},
            {"to": "end", "kind": "open_hole", "diameter": 8.5, "friction": 0.3},
        ],
    },
    "string": [
        {"kind": "drill_pipe", "length": 6899, "pipe": "5in 19.5 S-135 NC50"},
        {"kind": "hwdp", "length": 900, "pipe": "5in 49.3 NC50"},
        {"kind": "drill_collar", "name": "DC", "length": 200, "od": 6.75, "id": 2.8125},
        {"kind": "bit", "length": 1, "od": 8.5, "nozzles": "3x12"},
    ],
    "top": {"kind": "top_drive", "rotation": 120},
    "bottom": "bit",
    "initial": {"wob": 25},
    "fluid": {"density": 10.5, "rheology": {"pv": 20, "yp": 15}, "flow_rate": 550},
    "rig": {"max_surface_torque": 45000},
    "roadmap": {"drilling": {"wob": 25, "tob": 5000, "flow_rate": 550}},
}


def doubts(**changes):
    """Lines of the usual case with other top-level blocks."""
    return plausibility(Case(**{**USUAL, **changes}))


def test_a_mesh_that_no_element_follows():
    """`mesh` is for automatic element lengths: doubted only if no item has one."""
    free, *rest = USUAL["string"]
    all_given = [item | {"element_length": "9 m"} for item in USUAL["string"][:3]] + rest[2:]
    for string, mesh, found in (
        (all_given, {"refinement": 2}, ["mesh.refinement changes nothing"]),
        (all_given, {"frequency": "20 Hz"}, ["mesh.frequency changes nothing"]),
        (all_given, {}, []),
        ([free, *all_given[1:]], {"refinement": 2}, []),
    ):
        said = [line for line in doubts(string=string, mesh=mesh) if line.startswith("mesh.")]
        assert [line.split(":")[0] for line in said] == found


def string(**lengths):
    items = [dict(item) for item in USUAL["string"]]
    for key, length in lengths.items():
        items[int(key[1:])]["length"] = length
    return items


def measured(*points):
    keys = ("bit_depth", "operation", "hook_load", "torque")
    return {"measured": [{k: v for k, v in zip(keys, p, strict=True) if v is not None} for p in points]}


def test_usual_cases_are_not_doubted():
    """Nor is one whose string ends a single short of the rig, or the first case of the project."""
    assert doubts() == []
    assert doubts(string=string(_0=6870)) == []
    assert plausibility(load_case(EAGLE)) == []


UPWARDS = [USUAL["string"][i] for i in (0, 2, 1, 3)]


@each_row(
    ("changes", "words"),
    [
        (
            {"string": string(_0=5899)},
            ["7000 ft long, 1000 ft short of its hole of 8000 ft", "1000 ft below the rig"],
        ),
        ({"string": string(_2=75)}, ["125 ft short"]),
        ({"string": string(_0=5899), "initial": {}}, ["1000 ft above the bottom"]),
        ({"string": UPWARDS}, ["string[2]", "heavy-wall pipe right above the bit", "top down"]),
        ({"initial": {"wob": 60}}, ["initial.wob is 60 klbf", "below the drill pipe"]),
        ({"roadmap": {"drilling": {"tob": 5}}}, ["roadmap.drilling.tob is 5 ft-lbf", "5 kft-lbf?"]),
        ({"rig": {"max_surface_torque": 45}}, ["rig.max_surface_torque is 45 ft-lbf", "45 kft-lbf?"]),
        ({"fluid": {**USUAL["fluid"], "flow_rate": 34.7}}, ["fluid.flow_rate is 34.7 gpm", "little"]),
        ({"fluid": {**USUAL["fluid"], "flow_rate": 2082}}, ["fluid.flow_rate is 2082 gpm", "much"]),
        (
            {
                "well": {
                    **USUAL["well"],
                    "sections": [
                        {**USUAL["well"]["sections"][0], "diameter": 9.625},
                        USUAL["well"]["sections"][1],
                    ],
                }
            },
            ["well.sections[0].diameter is 9.625 in", "bore"],
        ),
        ({"roadmap": measured((9000, "PU", 200, None))}, ["1 of 1 measured points", "8000 ft", "9000 ft"]),
        ({"roadmap": measured((7000, "ROB", 200, 11.5))}, ["measured torque at 7000 ft is 11.5 ft-lbf"]),
        (
            {"roadmap": measured((7000, "PU", 150, None), (7000, "SO", 230, None))},
            ["at 7000 ft", "pick-up load, 150 klbf", "slack-off load, 230 klbf", "swapped?"],
        ),
    ],
)
def test_mistakes_are_doubted(changes, words):
    """One line each, in the units of the case."""
    lines = doubts(**changes)
    assert len(lines) == 1
    assert all(word in lines[0] for word in words), lines


def test_buoyed_weight_below_the_drill_pipe():
    """900 ft of 49.3 lb/ft, 200 ft of 6 3/4 x 2 13/16 in and the bit, in 10.5 ppg: 54.2 klbf by hand, cos 0 = 1.

    Collar: pi/4 (6.75^2 - 2.8125^2) in2 x 12 in/ft x 7850 kg/m3 = 100.6 lb/ft; buoyancy 1 - 10.5/65.5.
    """
    by_hand = (900 * 49.3 + 200 * 100.6) * (1 - 10.5 / 65.51) / 1e3
    line = doubts(initial={"wob": 60})[0]
    found = float(line.split("along the hole, ")[1].split()[0])
    assert found == pytest.approx(by_hand, rel=0.01)  # and a bit of some 0.15 klb


def test_highly_deviated_pipe_may_be_in_compression():
    """Above 60 deg the wall holds drill pipe straight, and no weight on bit is doubted."""
    well = {
        **USUAL["well"],
        "survey": {"md": [0, 3000, 6000, 8000], "inclination": [0, 0, 85, 85], "azimuth": [0] * 4},
    }
    assert doubts(well=well, initial={"wob": 30}) == []


def test_weight_without_mud_is_not_said_to_be_in_mud():
    dry = {k: v for k, v in USUAL.items() if k not in ("fluid", "roadmap")}
    (line,) = plausibility(Case(**dry | {"initial": {"wob": 90}}))
    assert "below the drill pipe along the hole" in line


SLIDING = {"top": {"kind": "top_drive", "lowering": "30 ft/hr"}, "time": {"end": 10.0}}
MOTOR = {
    "kind": "pdm",
    "length": 25,
    "od": 6.75,
    "id": 3.5,
    "pdm": {"rev_per_volume": "0.29 rev/gal", "stall_torque": 9000},
}


@each_row(
    ("changes", "doubted"),
    [
        ({"formation": {}}, True),
        ({"formation": {"bit_law": "drag_bit"}}, True),
        ({"formation": {"rotary_exponent": 0}}, False),
        ({"formation": {"layers": [{"from": 8001, "rotary_exponent": 0}]}}, False),
        ({"formation": {"drillability": "0 m/(s N)"}}, False),
        ({"formation": {}, "top": {"kind": "top_drive"}}, False),
        ({"formation": {}, "top": SLIDING["top"] | {"rotation": {"ramp": 5.0, "value": 60}}}, False),
        ({"formation": {}, "string": [*string(_0=6874)[:-1], MOTOR, USUAL["string"][-1]]}, False),
        ({}, False),
    ],
)
def test_a_bit_that_nothing_turns_is_doubted(changes, doubted):
    """Lowered onto rock that only a turning bit drills, the string would be pushed without end."""
    lines = [line for line in doubts(**SLIDING | changes) if "drills nothing" in line]
    assert len(lines) == doubted


def test_a_mass_in_another_unit_is_doubted():
    """A bit of 60 t, or of 60 g, is named beside the mass of a steel cylinder, 87.6 kg; one of 60 kg and a lumped one are not.

    In the units of the case: 60 t are 60000/0.45359237 lb.
    """

    def said(mass: str) -> list[str]:
        bit = {**USUAL["string"][-1], "mass": mass}
        return [line for line in doubts(string=[*USUAL["string"][:-1], bit]) if "mass" in line]

    assert said("60 kg") == said("1000 kg") == []
    for mass, number in (("60 t", "132277 lb"), ("60 g", "0.132277 lb")):
        (line,) = said(mass)
        assert line.startswith(f"string[3].mass is {number}") and "193 lb" in line


def test_a_history_interval_beyond_the_run_is_doubted():
    """Its history has one row."""
    time = {"end": "2 s"}
    (line,) = [q for q in doubts(time=time, output={"history_every": "5 s"}) if "history" in q]
    assert line.startswith("output.history_every is 5 s") and "2 s" in line
    assert not [q for q in doubts(time=time, output={"history_every": "2 s"}) if "history" in q]


def survey_of(md, inclination, azimuth) -> dict:
    """The usual well with another survey, in field units: degrees."""
    end = md[-1]
    sections = [USUAL["well"]["sections"][0] | {"to": 0.5 * end}, USUAL["well"]["sections"][1]]
    return {
        "well": {"survey": {"md": md, "inclination": inclination, "azimuth": azimuth}, "sections": sections}
    }


def test_a_survey_in_radians_is_doubted():
    """The directional well of the cases, its angles read as degrees; the well itself is not doubted."""
    survey = load_case(EAGLE).well.survey
    md = [q / 0.3048 for q in survey.md]
    tilt, turn = ([float(np.degrees(q)) for q in angles] for angles in (survey.inclination, survey.azimuth))
    for angles, doubted in (((survey.inclination, survey.azimuth), True), ((tilt, turn), False)):
        lines = doubts(**survey_of(md, *map(list, angles)))
        assert any("were rad meant?" in line for line in lines) is doubted


def test_a_plan_in_radians_with_one_azimuth_is_doubted():
    """Build and hold to 60 degrees towards 45 degrees, written in radians; in degrees, or as a nearly straight hole, it is not doubted."""
    md = [0.0, 1500, 2000, 2500, 3000, 3500, 4000, 9000]
    plan = np.radians([0.0, 0, 12, 24, 36, 48, 60, 60])
    for tilt, turn, doubted in (
        (plan, np.radians(45), True),
        (np.degrees(plan), 45.0, False),
        (0.3 * plan, np.radians(45), False),
        (plan[[0, 1, 2, 3, 4, 5, 4, 3]], np.radians(45), False),
        (np.full(8, 0.6), 3.0, False),  # a nearly vertical hold
    ):
        lines = doubts(**survey_of(md, [float(q) for q in tilt], [float(turn)] * len(md)))
        assert any("were rad meant?" in line for line in lines) is doubted


def test_a_vertical_well_is_not_taken_for_one_in_radians():
    """Measured: inclinations up to 1.5 deg, azimuths all around; planned: one azimuth."""
    random = np.random.default_rng(3)
    for _ in range(200):
        count = int(random.integers(4, 40))
        md = [*np.linspace(0.0, 9000.0, count + 1).tolist()]
        tilt = [0.0, *random.uniform(0, 1.5, count).tolist()]
        for turn in ([0.0, *random.uniform(0, 360, count).tolist()], [5.0] * (count + 1)):
            assert not any("rad meant" in line for line in doubts(**survey_of(md, tilt, turn)))
