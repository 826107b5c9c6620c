"""Remarks and warnings are said where they hold, with their numbers, and not otherwise."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from drillpetsc.analysis.calibration.estimator import Fit
from drillpetsc.analysis.hydraulics.doubts import TripPlan
from drillpetsc.analysis.linear.doubts import grows_at_speeds
from drillpetsc.analysis.loads.torque_drag.readings.calibrate import _warnings
from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.case import Case
from drillpetsc.doubts.doubt import doubts_at
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well
from tests.verification import test_calibrate_command as readings

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
    """What a surge leaves out or assumes (manual: sec-guide-surge)."""
    keys = {"string": [PIPE], "well": simple_well(400.0, 0.2159), "top": "clamped", "bottom": "free"}
    case = Case(**(keys | change | {"fluid": MUD | change.get("fluid", {})}))
    found = doubts_at(TripPlan(case, pipes, acceleration, None, top), "remark")
    expected = sorted([*said, NO_WINDOW])
    assert [text[: len(want)] for text, want in zip(sorted(found), expected, strict=True)] == expected


@each_row(("growing", "said"), [([], []), ([120.0, 180.0], [(2, 3, 120.0)])])
def test_modes_that_grow_are_said_with_their_speeds(
    growing: list[float], said: list[tuple[float, ...]]
) -> None:
    """Rotary speeds of 60, 120 and 180 rpm."""
    speeds = [
        SimpleNamespace(speed=rpm * np.pi / 30, grows=np.array([False, rpm in growing]))
        for rpm in (60.0, 120.0, 180.0)
    ]
    found = grows_at_speeds.look(SimpleNamespace(speeds=speeds))
    assert [(v["grows"], v["count"], round(v["first"], 9)) for v in found] == said


@each_row(("chi2", "said"), [(0.5, []), (3.9, []), (9.0, ["3.0"]), (6.25, ["2.5"])])
def test_a_misfit_beyond_two_standard_errors_is_said(chi2: float, said: list[str]) -> None:
    work, parameters = (
        Calibration(readings.case(), readings.synthetic(depths=(800,))),
        ("cased", "block_weight"),
    )
    fit = Fit(parameters, np.array([0.2, 1e5]), np.array([0.01, 1e3]), np.eye(2), chi2, np.zeros(3))
    found = [text for text in _warnings(work, fit, parameters, None) if "misfit" in text]
    assert [text.split()[3] for text in found] == said
