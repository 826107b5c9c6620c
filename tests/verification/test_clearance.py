"""`clearance: body` of drill pipe: buckling loads by Dawson and Paslay go with one over the root of the clearance.

5 in 19.50 S-135 NC50 in 8 1/2 in hole: radial clearance 0.9375 in at the tool joints of 6 5/8 in, 1.75 in at the body of 5 in.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import drillpetsc as dp
from tests.helpers.wells import simple_well

RATIO = (0.9375 / 1.75) ** 0.5


def case(clearance: str) -> dp.Case:
    return dp.Case(
        well=simple_well(200, "8.5 in", "60 deg", friction=0.2),
        string=[dp.DrillPipe("5in 19.50 S-135 NC50", length=150.0, element_length=10.0, clearance=clearance)],
        top={"kind": "top_drive", "lowering": "0.1 m/s"},
    )


def test_limits_and_statics_take_the_same_clearance(tmp_path: Path) -> None:
    joint, body = (dp.limits(case(word), tmp_path / word) for word in ("tool_joint", "body"))
    for name in ("sinusoidal_limit", "helical_limit"):
        one, other = np.asarray(joint.limits[name]), np.asarray(body.limits[name])
        known = np.isfinite(one)
        assert known.sum() > 10 and other[known] == pytest.approx(RATIO * one[known], rel=1e-9)
    forces = np.asarray(joint.limits["effective_tension"])
    assert np.asarray(body.limits["effective_tension"]) == pytest.approx(forces, rel=1e-12)
    assert any("from the tool joints" in note for note in joint.summary["notes"])
    assert any("from the body of the pipe" in note for note in body.summary["notes"])
    one, other = (dp.statics(case(word), tmp_path / f"s-{word}").statics for word in ("tool_joint", "body"))
    load, known = np.asarray(one["buckling_load"]), np.isfinite(one["buckling_load"])
    assert known.any()
    assert np.asarray(other["buckling_load"])[known] == pytest.approx(RATIO * load[known], rel=1e-9)


def test_the_soft_string_takes_it_too(tmp_path: Path) -> None:
    """The helical load of the roadmap's rows decides the state; the largest weight on bit is that of limits."""
    made = []
    for word in ("tool_joint", "body"):
        c = case(word).replace(
            {
                "string": [
                    dp.DrillPipe("5in 19.50 S-135 NC50", length=150.0, element_length=10.0, clearance=word),
                    dp.Bit(length=0.3, od=0.2159),
                ],
                "top": {"kind": "top_drive"},
                "bottom": "bit",
                "initial": {"wob": 1e3},
            }
        )
        wob = dp.limits(c, tmp_path / word).summary["max_wob"]["sliding"]["sinusoidal"]["wob"]
        made.append(wob)
    assert made[1] < 0.95 * made[0]
