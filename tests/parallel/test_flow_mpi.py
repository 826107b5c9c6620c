"""The drilling fluid on 1, 2 and 3 ranks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.helpers.mud import hole, loop
from tests.helpers.ranks import all_on_ranks

PUMP = {"flow_rate": {"time": [0.0, 0.02, 0.05, 9.0], "value": [0.03, 0.03, 0.01, 0.01]}, "flow_line": 2.0}
LOWERED = {
    "kind": "top_drive",
    "rotation": 10.0,
    "lowering": {"time": [0.0, 0.1, 0.2], "value": [0.3, 0.3, 0.0]},
}
EXACT = ("-ts_adapt_type", "none", "-ts_dt", "2e-3", "-q_snes_stol", "1e-12")
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
    "plugged": {
        "fluid": {"flow_line": 2.0},
        "bottom": {"kind": "free", "plugged": True},
        "contact": "none",
        **FREE,
    },
}


@pytest.fixture(scope="module")
def runs(tmp_path_factory) -> dict[str, list[Path]]:
    """Run folders on 1, 2 and 3 ranks of each case."""
    folder, jobs = tmp_path_factory.mktemp("flow"), {}
    for kind, keys in CASES.items():
        case = {"time": {"end": 0.3}, "output": {"history_every": 0.01, "field_every": 0.1}, **keys}
        jobs[kind] = (folder / f"{kind}.yaml", EXACT)
        loop(case.pop("fluid"), 30, 150.0, **case).case.dump(jobs[kind][0])
    return all_on_ranks(jobs, folder)


@pytest.mark.parallel
@pytest.mark.parametrize("kind", CASES)
def test_flow_is_the_same_on_1_2_and_3_ranks(kind, runs):
    """Pump turned down; string fixed, rotating and lowered, drilling, or plugged and lowered; fixed steps:
    histories equal to 1e-9 of each column's size, equal counts of steps.

    Newton's tolerance is at rounding level here: at changes of contact, or with the bit on bottom, a step in
    a hundred may need one iteration more or less.  One rank renews contacts apart (manual: sec-time-contact-entries), with up to 5 % more or less
    iterations at this tolerance; two and three ranks take the same path.
    """
    tables = [read_table(folder / "history.csv") for folder in runs[kind]]
    summaries = [json.loads((folder / "summary.json").read_text()) for folder in runs[kind]]
    assert [t["ranks"] for t in summaries] == [1, 2, 3]
    flow = tables[0]["outlet_flow [m3/s]"]
    assert np.ptp(flow) > 0.1 * np.abs(flow).max()  # the case is not at rest
    for other, summary in zip(tables[1:], summaries[1:], strict=True):
        for column, values in tables[0].items():
            if not column.startswith(
                ("energy_error", "newton")
            ):  # a difference of large numbers; counts see below
                assert np.abs(other[column] - values).max() <= 1e-9 * max(
                    np.abs(values).max(), SMALL.get(column, 0.0)
                ), column
        assert summary["steps"] == summaries[0]["steps"]
        switches = kind in ("drilling", "moving")  # of 630: contacts apart; sums in another order
        iterations = [t["newton_iterations"] for t in (summary, summaries[0], summaries[1])]
        assert abs(iterations[0] - iterations[1]) <= (40 if switches else 0)
        assert abs(iterations[0] - iterations[2]) <= (40 if switches else 0)
        for figure in ("pumped", "returned", "content_change"):
            assert summary["mass"][figure] == pytest.approx(summaries[0]["mass"][figure], rel=1e-9)
