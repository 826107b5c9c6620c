"""Measured points beside the curves of a roadmap: standard errors, distances, and the block that a reading leaves out."""

from __future__ import annotations

from typing import Any

import pytest

from drillpetsc.analysis.loads.torque_drag.readings.measured import beside_curves, measured_warnings
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from tests.helpers.tables import each_row

BLOCK = 300e3  # [N]


def row(operation: str, depth: float, friction: float, load: float) -> dict[str, Any]:
    factors = {"ff_cased": 0.2, "ff_open_hole": friction, "ff_groups": ""}
    return {"operation": operation, "bit_depth": depth, "hook_load": load, "surface_torque": 8e3} | factors


#: two friction factors between 1000 m and 2000 m
ROWS = [
    row("trip_out", 1000.0, 0.2, 600e3), row("trip_out", 2000.0, 0.2, 800e3),
    row("trip_out", 1000.0, 0.3, 640e3), row("trip_out", 2000.0, 0.3, 900e3),
]  # fmt: skip


@each_row(
    ("given", "sigmas"),
    [  # 2 % of the reading, at least 10 kN and 0.5 kN m; a standard error given is that of the hook load
        ({"hook_load": 800e3}, [16e3]),
        ({"hook_load": 400e3}, [10e3]),
        ({"hook_load": 400e3, "sigma": 3e3}, [3e3]),
        ({"torque": 40e3}, [800.0]),
        ({"hook_load": 800e3, "torque": 9e3, "sigma": 3e3}, [3e3, 500.0]),
    ],
)
def test_standard_errors(given: dict[str, float], sigmas: list[float]) -> None:
    point = MeasuredPoint(bit_depth=1500.0, operation="trip_out", **given)
    assert [q.sigma for q in beside_curves(ROWS, [point], BLOCK)] == pytest.approx(sigmas, rel=1e-12)


@each_row(("read", "off"), [(1100e3, 65e3), (990e3, -10e3), (1020e3, 0.0)])
def test_distance_from_the_curves_at_the_depth(read: float, off: float) -> None:
    """Between the depths of a curve it is a line, 700 and 770 kN at 1500 m where these have 735; with the block on the hook."""
    rows = [*ROWS[:3], row("trip_out", 2000.0, 0.3, 830e3)]
    (found,) = beside_curves(
        rows, [MeasuredPoint(bit_depth=1500.0, operation="trip_out", hook_load=read)], BLOCK
    )
    assert (found.low, found.high) == pytest.approx((1000e3, 1035e3)) and found.off == pytest.approx(off)


@each_row(
    ("missing", "excludes", "state"),
    [(-1.0, False, "true"), (1.0, True, "false"), (0.0, False, None), (-0.4, False, None)],
)
def test_readings_that_miss_the_block(missing: float, excludes: bool, state: str | None) -> None:
    """Hook loads off by the block's weight: the other setting of hookload_excludes_block is named, and by another difference it is not."""
    on_hook = 0.0 if excludes else BLOCK
    points = [
        MeasuredPoint(bit_depth=depth, operation="trip_out", hook_load=load + on_hook + missing * BLOCK)
        for depth, load in ((1000.0, 620e3), (2000.0, 850e3))
    ]
    found = beside_curves(ROWS, points, on_hook)
    said = [
        t
        for t in measured_warnings(found, points, 3000.0, BLOCK, excludes, "SI")
        if "hookload_excludes_block" in t
    ]
    assert [t.split(" the measured")[0] for t in said] == (
        [f"with hookload_excludes_block: {state}"] if state else []
    )
