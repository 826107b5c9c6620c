"""A friction factor that no hole has is doubted: accepted, with a line that says so."""

from __future__ import annotations

from drillpetsc import Case
from drillpetsc.case.plausible.plausibility import plausibility
from tests.helpers.tables import each_row


@each_row(
    ("hole", "own", "places"),
    [
        (0.3, None, []),
        (1.0, 0.9, []),
        (3.0, None, ["well.sections[0].friction is 3"]),
        (0.3, 8.0, ["string[0].friction is 8: "]),
    ],
)
def test_large_friction_is_doubted(hole, own, places):
    case = Case(
        well={
            "survey": {"md": [0.0, 500.0], "inclination": [0.0, 0.0], "azimuth": [0.0, 0.0]},
            "sections": [{"to": 500.0, "kind": "open_hole", "diameter": 0.2159, "friction": hole}],
        },
        string=[{"kind": "pipe", "length": 500.0, "od": 0.127, "id": 0.1086, "friction": own}],
        top={"kind": "top_drive"},
        bottom={"kind": "free"},
    )
    lines = [line for line in plausibility(case) if "friction" in line]
    assert len(lines) == len(places)
    assert all(line.startswith(place) for line, place in zip(lines, places, strict=True))
    assert all("8 %?" in line for line in lines if own == 8.0)


@each_row(
    ("keys", "said"),
    [
        ({}, []),
        ({"gravity": 0}, []),
        ({"gravity": -9.81}, ["gravity is -9.81 m/s2 downward: the string falls upward"]),
        ({"gravity": 98.1}, ["gravity is 98.1 m/s2 downward: 9.81"]),
        ({"bottom": {"kind": "bit", "friction": 5}}, ["bottom.friction is 5: "]),
        (
            {"top": {"kind": "top_drive", "lowering": 30}},
            ["top.lowering is 1800 m/min: faster than any hoist"],
        ),
        # a pipe of 127 mm at 60 rpm slides at 399 mm/s: 0.399/sqrt(0.399^2 + 2^2) = 0.196
        (
            {"contact": {"slip_velocity": 2}},
            ["contact.slip_velocity is 2000 mm/s: a string that slides at 399 mm/s has 20 %"],
        ),
        ({"contact": {"slip_velocity": 2}, "time": None}, []),
    ],
)
def test_values_that_change_an_answer_without_a_word_are_doubted(keys, said):
    case = Case(
        **{
            "well": {
                "survey": {"md": [0.0, 500.0], "inclination": [0.0, 0.0], "azimuth": [0.0, 0.0]},
                "sections": [{"to": 500.0, "kind": "open_hole", "diameter": 0.2159}],
            },
            "string": [{"kind": "pipe", "length": 500.0, "od": 0.127, "id": 0.1086}],
            "top": {"kind": "top_drive", "rotation": "60 rpm"},
            "time": {"end": 1},
        }
        | keys
    )
    lines = plausibility(case)
    assert len(lines) == len(said)
    assert all(line.startswith(words) for line, words in zip(lines, said, strict=True))
