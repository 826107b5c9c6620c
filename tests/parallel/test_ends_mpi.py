"""Ends of the string, and built-in controllers that sample, on 1, 2 and 3 ranks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml

from drillpetsc.output import read_table
from tests.helpers.mpi import have_mpi, run_mpi
from tests.verification import test_ends as ends
from tests.verification import test_sampled_law as sampled

pytestmark = [pytest.mark.parallel, pytest.mark.skipif(not have_mpi(), reason="no mpirun")]
SCRIPT = Path(__file__).parent / "run_case.py"
STEPS = ["-ts_adapt_type", "none", "-q_snes_stol", "1e-12", "-ts_dt"]


def turning(element: str) -> dict[str, Any]:
    """A pipe that hangs on a universal joint at depth 0 and is pulled aside."""
    return {
        "string": [ends.PIPE],
        "top": {"kind": "top_drive", "rotation": 5.0},
        "bottom": "free",
        "joints": [ends.UNIVERSAL],
        "loads": [{"at": ends.LENGTH, "force": [500.0, 300.0, 0.0]}],
        "beam": {"formulation": element},
    }


def across(hinged: bool) -> dict[str, Any]:
    """A pipe whose top moves across under a pull, shaken by a force that starts at once."""
    return {
        "string": [ends.PIPE],
        "top": {"kind": "top_drive", "force": 2e4, "guided": False, "hinged": hinged, "rotation": 3.0},
        "bottom": "clamped",
        "gravity": 0.0,
        "loads": [
            {"at": 10.0, "force": [300, 100, 0], "value_over": {"time": [0, 0.02, 1], "value": [0, 1, 1]}}
        ],
    }


def weight_and_force() -> dict[str, Any]:
    """A weight on bit with a top force that does not hold it: the string starts to move."""
    return {
        "string": [
            {"kind": "pipe", "length": 500.0, "od": 0.127, "id": 0.1086},
            {"kind": "pipe", "length": 99.5, "od": 0.1715, "id": 0.0714},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60},
        ],
        "well": ends.WELL,
        "bottom": "bit",
        "top": {"kind": "top_drive", "rotation": 5.0, "force": 1e5},
        "initial": {"from": "statics", "wob": 30e3},
    }


def controlled(law: dict, **motor: float) -> dict[str, Any]:
    """The pipe of the checks of sampled laws, in six elements so that every rank has some."""
    return {
        "string": [{**sampled.PIPE, "element_length": 10.0 / 6}],
        "top": sampled.m.top(law | {"sample": 4e-3}, {"ramp": 0.05, "value": 10.0}, **motor),
        "gravity": 0.0,
        "initial": {"from": "rest"},
    }


CASES = {
    "universal joint, ancf": (turning("ancf"), 1e-3),
    "universal joint, quaternion": (turning("quaternion"), 1e-3),
    "top across": (across(False), 1e-3),
    "hinged top across": (across(True), 1e-3),
    "weight and top force": (weight_and_force(), 1e-3),
    "sampled pi": (controlled(sampled.PI), 1e-3),
    "sampled pi, limited": (controlled(sampled.PI, max_torque=2e4, min_torque=0.0), 1e-3),
    "sampled soft torque": (controlled(sampled.SOFT), 1e-3),
    "sampled z torque": (controlled(sampled.Z_TORQUE | {"delay": 8e-3}), 1e-3),
}


@pytest.mark.parametrize("name", CASES)
def test_the_same_on_1_2_and_3_ranks(name, tmp_path):
    """Every column of the history to rounding."""
    case, step = CASES[name]
    path = tmp_path / "case.yaml"
    path.write_text(yaml.safe_dump(case | {"time": {"end": 0.06}, "output": {"history_every": 0.01}}))
    runs = []
    for n in (1, 2, 3):
        out = tmp_path / f"ranks{n}"
        run_mpi(n, SCRIPT, [str(path), str(out), *STEPS, str(step)], timeout=100)
        runs.append(read_table(out / "history.csv"))
    moved = [c for c in runs[0] if np.ptp(runs[0][c]) > 0 and not c.startswith(("time", "step", "newton"))]
    assert moved
    for other in runs[1:]:
        assert list(other) == list(runs[0])
        for column, values in runs[0].items():
            if not column.startswith(("energy_error", "newton", "step")):
                assert np.abs(other[column] - values).max() <= 1e-7 * np.abs(values).max() + 1e-9, column
