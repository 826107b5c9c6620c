"""Tables of a report: the fit of a calibration, and rows of the deepest bit in a cut table."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from drillpetsc.reporting.page import SHOWN, grid_of
from drillpetsc.reporting.results import _fitted


def test_fitted_values_with_intervals_and_reasons():
    """A block weight in the units of the report; a parameter without a value has its reason."""
    fit = {
        "cased": {"value": 0.2, "interval": [0.15, 0.25], "status": "determined"},
        "open_hole": {"value": None, "interval": None, "status": "not determined: no point"},
        "block_weight": {"value": 266893.295, "interval": [2e5, 3e5], "status": "determined"},
    }
    run = SimpleNamespace(summary={"fit": fit}, name="c")
    (grid,) = _fitted(run, "field", "c/summary.json")
    assert grid.rows[0] == ("friction, cased", "0.2", "0.15", "0.25", "determined")
    assert grid.rows[1] == ("friction, open hole", "-", "-", "-", "not determined: no point")
    assert grid.rows[2][:2] == ("block weight [klbf]", "60")
    assert _fitted(SimpleNamespace(summary={}, name="c"), "field", "c") == []


def test_cut_table_keeps_the_deepest_row_of_each_curve():
    depth = np.tile(np.linspace(100.0, 3000.0, 31), 12)
    table = {"bit_depth [m]": depth, "hook_load [N]": np.arange(len(depth), dtype=float)}
    grid = grid_of(table, "SI", "roadmap.csv", "r/roadmap.csv")
    shown = [float(row[0]) for row in grid.rows]
    assert SHOWN <= len(shown) < len(depth) and shown.count(3000.0) == 12


def test_each_reading_has_its_unit():
    """A column that holds forces and torques: 1 klbf is 4448.2 N, 1000 ft-lbf are 1355.8 N m."""
    table = {
        "compared [-]": np.array(["hook_load", "surface_torque"]),
        "measured [N or N m]": np.array([444_822.16, 13_558.18]),
    }
    shown = grid_of(table, "field", "calibration", "run/calibration.csv")
    assert [row[1] for row in shown.rows] == ["100 klbf", "10000 ft-lbf"]
    assert "N or N m" not in " ".join(shown.heads)


def test_trip_speed_without_a_limit_is_a_lower_bound():
    """The fastest speed tried, where nothing limits it."""
    table = {
        "max_trip_speed [m/s]": np.array([3.048, 1.524]),
        "limited_by [-]": np.array(["none", "pore at TVD 1233 m"]),
    }
    shown = grid_of(table, "field", "trips", "run/max_trip_speed.csv")
    first, second = (row[0] for row in shown.rows)
    assert first.startswith("> 600") and second.startswith("300")
