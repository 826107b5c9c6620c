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
