"""Cases of the parallel matrix with drilling fluid: string fixed, rotating and lowered, drilling, or plugged and lowered."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.helpers.mud import GRAVITY, MUD, NOZZLE, hole, string

PUMP = {"flow_rate": {"time": [0.0, 0.02, 0.05, 9.0], "value": [0.03, 0.03, 0.01, 0.01]}, "flow_line": 2.0}
LOWERED = {
    "kind": "top_drive",
    "rotation": 10.0,
    "lowering": {"time": [0.0, 0.1, 0.2], "value": [0.3, 0.3, 0.0]},
}
SMALL = {
    "surface_torque [N m]": 1.0,
    "bit_torque [N m]": 1.0,
}  # quantities that are zero except for the rounding of a solve, 1e-10 of a twist
FREE = {"hold_string": False, "well": hole(160.0), "top": LOWERED}
CASES: dict[str, dict] = {
    "held": {"fluid": PUMP},
    "moving": {
        "fluid": {**PUMP, "choke": {"area": 6e-4}},
        "bottom": {"kind": "free"},
        "contact": {"stiffness": 1e7},
        **FREE,
    },
    "drilling": {
        "fluid": {**PUMP, "cuttings": "returned"},
        "bottom": "bit",
        "formation": {"drillability": 5e-6},
        "contact": "none",
        **FREE,
        "well": hole(150.5),
        "top": {**LOWERED, "lowering": 0.01},
        "initial": {"wob": 2e3},
    },
    "hole that narrows": {
        "fluid": {"flow_line": 2.0, "formulation": "hermite"},
        "bottom": "free",
        "contact": "none",
        "time": {"end": 0.1},
        **FREE,
        "well": hole(160.0)
        | {"sections": [{"to": 72.0, "kind": "casing", "diameter": 0.3}, *hole(160.0)["sections"]]},
    },
    "plugged": {
        "fluid": {"flow_line": 2.0},
        "bottom": {"kind": "free", "plugged": True},
        "contact": "none",
        **FREE,
    },
}


def keys(fluid: dict, **more: Any) -> dict[str, Any]:
    """Keys of a case of 150 m."""
    whole = {
        "well": hole(150.5),
        "string": string(150.0, 30, nozzle_area=NOZZLE),
        "hold_string": True,
        "bottom": "bit",
        "gravity": GRAVITY,
        "fluid": {**MUD, **fluid},
        "time": {"end": 0.3},
        "output": {"history_every": 0.01, "field_every": 0.1},
    }
    return whole | more


def same_flow(switches: bool, folders: list[Path], history: dict[str, np.ndarray]) -> None:
    """Histories equal to 1e-9 of each column's size, equal counts of steps, and volumes.

    switches: contact, or a bit on bottom.

    Newton's tolerance is at rounding level here: at changes of contact, or with the bit on bottom, a step in
    a hundred may need one iteration more or less.  One rank renews contacts apart (manual: sec-time-contact-entries), with up to 5 % more or less
    iterations at this tolerance; two and three ranks take the same path.
    """
    summaries = [json.loads((folder / "summary.json").read_text()) for folder in folders]
    assert [t["ranks"] for t in summaries] == [1, 2, 3]
    flow = history["outlet_flow [m3/s]"]
    assert np.ptp(flow) > 0.1 * np.abs(flow).max()  # the case is not at rest
    for folder, summary in zip(folders[1:], summaries[1:], strict=True):
        other = read_table(folder / "history.csv")
        for column, values in history.items():
            if not column.startswith(
                ("energy_error", "newton")
            ):  # a difference of large numbers; counts see below
                size = max(np.abs(values).max(), SMALL.get(column, 0.0))
                assert np.abs(other[column] - values).max() <= 1e-9 * size, column
        assert summary["steps"] == summaries[0]["steps"]
        for one in summaries[:2]:  # of 630: contacts apart; sums in another order
            assert abs(summary["newton_iterations"] - one["newton_iterations"]) <= (40 if switches else 0)
        for figure in ("pumped", "returned", "content_change"):
            assert summary["mass"][figure] == pytest.approx(summaries[0]["mass"][figure], rel=1e-9)
