"""Tools together in mud, and the agitator, on 1, 2 and 3 ranks; the agitator restarted."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from drillpetsc.output import read_table
from tests.helpers.mpi import run_mpi
from tests.helpers.restarts import restarted_is_identical
from tests.helpers.whole_string import COLLAR, JAR, MOTOR, SHOCK, STEERED, combined, whole_string
from tests.verification.test_agitator import with_mud

SCRIPT = Path(__file__).parent / "run_case.py"
STEPS = 3  # that are compared
FIXED = ["-ts_adapt_type", "none", "-ts_dt"]


def write(folder: Path, kind: str) -> Path:
    if kind.startswith("whole"):
        case = whole_string(two="two" in kind)
    else:
        case = with_mud() if kind == "agitator" else combined(JAR, COLLAR, SHOCK, MOTOR, STEERED)
    # the whole string: a few steps, before one is repeated
    every = 2e-4 if kind.startswith("whole") else 4e-3
    case["time"], case["output"] = {"end": STEPS * every}, {"history_every": every, "checkpoint_every": every}
    path = folder / "case.yaml"
    path.write_text(yaml.safe_dump(case))
    return path


@pytest.mark.parallel
@pytest.mark.parametrize("kind", ["agitator", "jar, shock sub, motor, steering", "whole", "whole, two"])
def test_tools_are_the_same_on_1_2_and_3_ranks(kind, tmp_path):
    """Histories are equal to rounding; torque and angles of joints that carry none are rounding themselves.

    The whole string goes on from the state of another run: its buckles have more than one place, and which of them a search of 170
    factorisations ends at is rounding.  Stops of 1e9 N/m let Newton's method shrink a step by 1e-10; whether it reaches 1e-12 is, too.
    """
    whole = kind.startswith("whole")
    path, runs = write(tmp_path, kind), []
    options = ["2e-4", "-q_snes_stol", "1e-10"] if whole else ["1e-3", "-q_snes_stol", "1e-12"]
    if whole:
        run_mpi(1, SCRIPT, [str(path), str(tmp_path / "start"), *FIXED, *options], timeout=200)
        case = yaml.safe_load(path.read_text()) | {"initial": {"from": str(tmp_path / "start")}}
        path.write_text(yaml.safe_dump(case))
    for n in (1, 2, 3):
        out = tmp_path / f"ranks{n}"
        run_mpi(n, SCRIPT, [str(path), str(out), *FIXED, *options], timeout=200)
        runs.append((read_table(out / "history.csv"), json.loads((out / "summary.json").read_text())))
    history, summary = runs[0]
    largest = {
        unit: max(np.abs(q).max() for n, q in history.items() if n.endswith(unit))
        for unit in ("_force [N]", "_pressure [Pa]")
    }
    small = {"bearing_load": largest["_force [N]"], "motor_differential_pressure": largest["_pressure [Pa]"]}
    for other, its_summary in runs[1:]:
        assert its_summary["steps"] == summary["steps"]
        for name, values in history.items():
            if not name.startswith(("energy_error", "newton", "step")):
                # small differences of large forces and of large pressures
                size = small.get(name.split()[0], np.abs(values).max())
                assert np.abs(other[name] - values).max() <= (1e-6 if whole else 1e-7) * size + 1e-10, name


@pytest.mark.parametrize("kind", ["agitator", "whole, two"])
def test_tools_in_mud_restarted_are_bit_identical(kind, tmp_path, monkeypatch):
    restarted_is_identical(write(tmp_path, kind), tmp_path, monkeypatch, slice(None, -1, 2))
