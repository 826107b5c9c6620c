"""What a surge leaves out or assumes is said if it holds, and not otherwise (manual: sec-guide-surge)."""

from __future__ import annotations

from typing import Any

from drillpetsc.analysis.hydraulics.doubts import TripPlan
from drillpetsc.case import Case
from drillpetsc.doubts.doubt import doubts_at
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well

PIPE = {"kind": "pipe", "name": "drill pipe", "length": 300.0, "od": 0.127, "id": 0.1086}
MUD = {"density": 1200.0, "rheology": {"model": "newtonian", "viscosity": 0.02}, "flow_rate": 0.01}
VALVE, FLOWS, PLUGGED, TOP = (
    "open pipe with fluid.check_valve", "open pipe with an outlet_pressure", "bottom.plugged holds for a closed pipe only",
    "the string's top lies at MD 100 m",
)  # fmt: skip
STEADY, START, NO_WINDOW = (
    "steady: the pressure",
    "pressure of the start: from rest with 0.5 m/s2",
    "no window",
)


@each_row(
    ("change", "pipes", "acceleration", "top", "said"),
    [
        ({}, ("closed", "open"), None, 0.0, [STEADY]),
        ({}, ("closed", "open"), 0.5, 0.0, [START]),
        ({}, ("closed",), None, 100.0, [STEADY, TOP]),
        ({"fluid": {"check_valve": True}}, ("closed", "open"), None, 0.0, [VALVE, STEADY]),
        ({"fluid": {"check_valve": True}}, ("closed", "pumping"), None, 0.0, [STEADY]),
        ({"fluid": {"outlet_pressure": 1e5}}, ("open",), None, 0.0, [FLOWS, STEADY]),
        ({"fluid": {"outlet_pressure": 1e5}}, ("closed", "pumping"), None, 0.0, [STEADY]),
        ({"bottom": {"kind": "free", "plugged": True}, "fluid": {"flow_rate": 0.0}}, ("closed", "open"), None, 0.0, [PLUGGED, STEADY]),
        ({"bottom": {"kind": "free", "plugged": True}, "fluid": {"flow_rate": 0.0}}, ("closed",), None, 0.0, [STEADY]),
    ],
)  # fmt: skip
def test_a_trip_says_what_holds(
    change: dict[str, Any], pipes: tuple[str, ...], acceleration: float | None, top: float, said: list[str]
) -> None:
    keys = {"string": [PIPE], "well": simple_well(400.0, 0.2159), "top": "clamped", "bottom": "free"}
    case = Case(**(keys | change | {"fluid": MUD | change.get("fluid", {})}))
    found = doubts_at(TripPlan(case, pipes, acceleration, None, top), "remark")
    expected = sorted([*said, NO_WINDOW])
    assert [text[: len(want)] for text, want in zip(sorted(found), expected, strict=True)] == expected
