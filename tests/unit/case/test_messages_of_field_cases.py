"""Messages speak in the units of the case, name the key that is wrong, and say what was likely meant."""

from __future__ import annotations

import copy

import pytest

from drillpetsc import Case
from drillpetsc.case.files.measured_file import operation_word
from drillpetsc.errors import CaseError
from tests.helpers.si_words import si_units
from tests.helpers.tables import each_row

BASE = {
    "units": "field",
    "rig": {"block_weight": 60},
    "well": {
        "survey": {"md": [0, 8000], "inclination": [0, 0], "azimuth": [0, 0]},
        "sections": [
            {"to": 4500, "kind": "casing", "diameter": 8.681},
            {"to": "end", "kind": "open_hole", "diameter": 8.5},
        ],
    },
    "string": [
        {"kind": "drill_pipe", "length": 7800, "pipe": "5in 19.5 S-135 NC50"},
        {"kind": "drill_collar", "length": 190, "od": 6.75, "id": 2.8125},
        {"kind": "stabilizer", "length": 9, "blade_od": 8.375, "body_od": 6.75, "id": 2.8125},
        {"kind": "bit", "length": 1, "od": 8.5},
    ],
    "top": "clamped",
    "bottom": "bit",
    "fluid": {"density": 10, "rheology": {"pv": 20, "yp": 15}},
}


REAMER = {"kind": "reamer", "length": 9, "od": 10, "body_od": 6.75, "blade_length": 20, "id": 2.8125}


def changed(path, value):
    keys = copy.deepcopy(BASE)
    block = keys
    for step in path[:-1]:
        block = block[step]
    block[path[-1]] = value
    return keys


@each_row(
    ("path", "value", "at", "words"),
    [
        (("rig", "block_weight"), 60000, "rig.block_weight", ["22480.9 klbf", "'60000 lbf' meant?"]),
        (("well", "sections", 0, "to"), 14500, "well.sections[0].to", ["at most", "survey station, 8000 ft"]),
        (
            ("well", "sections", 1, "diameter"),
            215.9,
            "string[3].od",
            ["215.9 in", "well.sections[1].diameter"],
        ),
        (
            ("well", "sections", 1, "diameter"),
            0.2159,
            "string[0].tool_joint.od",
            ["4500 ft, 0.2159 in", "6.625 in"],
        ),
        (("string", 0, "length"), 7900, "string", ["hole, 8000 ft", "8100 ft long, 100 ft too long"]),
        (("string", 3, "od"), 6, "string[2].blade_od", ["6.0625 in"]),
        (("fluid", "surface_line"), 3, "fluid.surface_line", ["{case: 3}?"]),
        (
            ("fluid", "rheology"),
            {"dial": {600: 640, 300: 41, 3: 7}},
            "fluid.rheology.dial",
            ["640 at 600 rpm"],
        ),
        (("string", 0, "pipe"), "5in 49.3 NC50", "string[0].pipe", ["kind: hwdp"]),
        (
            ("string", 2, "nozzle_area"),
            90,
            "string[2].nozzle_area",
            ["at most the area of the item, 55.0883 in2"],
        ),
        (("string", 2), REAMER | {"pilot": 8.25}, "string[2].pilot", ["the diameter of the bit, 8.5 in"]),
        (("string", 2), REAMER | {"od": 8}, "string[2].od", ["more than the diameter of the bit, 8.5 in"]),
        (("string", 1, "id"), 7, "string[1].id", ["below the outer, 6.75 in"]),
        (("string", 1, "eccentricity"), 4, "string[1].eccentricity", ["at most the outer radius, 3.375 in"]),
        (("string", 1, "bend"), {"angle": 1, "position": 200}, "string[1].bend.position", ["item, 190 ft"]),
        (("well", "survey", "md"), [0, 0], "well.survey.md[1]", ["above 0 ft, the station before"]),
        (("fluid", "flow_line"), 8001, "fluid.flow_line", ["above the end of the hole, 8000 ft"]),
        (("output",), {"probes": [900, 900]}, "output.probes[1]", ["900 ft appears twice"]),
        (("rig", "max_hookload"), 50, "rig.max_hookload", ["above the weight of the block, 60 klbf"]),
        (
            ("window",),
            {"tvd": [4500, 8000], "pore": [9, 10], "frac": [8, 13]},
            "window.frac[0]",
            ["above pore, 9 ppg"],
        ),
        (
            ("formation",),
            {
                "drillability": "1e-8 m/(s N)",
                "layers": [{"from": 8100, "to": 8050, "drillability": "2e-8 m/(s N)"}],
            },
            "formation.layers[0].to",
            ["below from, 8100 ft"],
        ),
    ],
)
def test_message(path, value, at, words):
    with pytest.raises(CaseError) as found:
        Case(**changed(path, value))
    assert found.value.at == at
    text = str(found.value)
    assert all(word in text for word in words), text
    assert si_units(text.replace("1e-8 m/(s N)", "").replace("2e-8 m/(s N)", "")) == []


def test_a_reamer_needs_one_pilot_hole_below_it():
    """Sections between the reamed hole and the end of the hole have the pilot's diameter: the law of the cutters has one ring."""
    keys = changed(("string", 2), REAMER) | {"formation": {"drillability": "1e-8 m/(s N)"}}
    sections = [(7000, 10.0), (7995, 9.0), ("end", 8.5)]
    keys["well"]["sections"] = [{"to": to, "kind": "open_hole", "diameter": d} for to, d in sections]
    with pytest.raises(CaseError) as found:
        Case(**keys)
    assert found.value.at == "well.sections[1].diameter" and "the pilot hole, 8.5 in" in str(found.value)


def test_si_cases_keep_si_messages():
    with pytest.raises(CaseError, match=r"no longer than the hole, 100 m[\s\S]*110 m long, 10 m too long"):
        Case(
            well={
                "survey": {"md": [0, 100], "inclination": [0, 0], "azimuth": [0, 0]},
                "sections": [{"kind": "open_hole", "diameter": 0.2}],
            },
            string=[{"kind": "pipe", "length": 110, "od": 0.1, "id": 0.08}],
            top="clamped",
        )


@pytest.mark.parametrize(
    ("pipe", "same"),
    [
        ('5" 19.5# S-135 NC50 DP premium class', "5in 19.5 S-135 NC50 premium"),
        ("5in 19.5 S-135 drill pipe NC50 class 2", "5in 19.5 S-135 NC50 class 2"),
    ],
)
def test_words_of_a_tally(pipe, same):
    """The kind of the item, and `class` behind premium, may stand in the text of the tally."""
    one, other = (Case(**changed(("string", 0, "pipe"), text)).string[0] for text in (pipe, same))
    assert one.model_dump(exclude={"pipe", "name"}) == other.model_dump(exclude={"pipe", "name"})


def test_heavy_wall_pipe_as_in_the_tally():
    def item(text):
        return Case(**changed(("string", 1), {"kind": "hwdp", "length": 190, "pipe": text})).string[1]

    assert item('5" HWDP 49.3 # NC50').adjusted_weight == item("5in 49.3 NC50").adjusted_weight


def test_abbreviations_with_a_slash():
    assert [operation_word(word) for word in ("P/U", "S/O", "PU")] == ["trip_out", "trip_in", "trip_out"]
