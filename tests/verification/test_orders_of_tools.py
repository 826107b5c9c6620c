"""Order in time of a shock sub and of a downhole motor (manual: verif-tool-orders)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.output import read_table
from tests.verification.test_mud_motor import SECTION, hung
from tests.verification.test_shock_sub import sub

BASE = {"ts_adapt_type": "none", "q_snes_stol": 1e-13}


def last(case: dict, out: Path, names: tuple[str, ...]) -> list[float]:
    """Values of the last row of the columns whose names end as ``names`` say."""
    run(Case(**case), out, progress="silent")
    got = {k.split(" [")[0]: q for k, q in read_table(out / "history.csv").items()}
    return [next(float(q[-1]) for name, q in got.items() if name.endswith(ending)) for ending in names]


def ratios(case: dict, steps: tuple[float, ...], out: Path, names: tuple[str, ...]) -> np.ndarray:
    """Change by halving the step over that by halving it again."""
    rows = []
    for step in steps:
        case["petsc"] = BASE | {"ts_dt": step, "ts_type": case["petsc"]["ts_type"]}
        rows.append(last(case, out / f"{step:g}", names))
    coarse, fine = np.diff(rows, axis=0)
    return np.asarray(coarse / fine)


@pytest.mark.parametrize("kind", ["bdf", "alpha2"])
def test_a_shock_sub_is_of_second_order_in_time(kind, tmp_path):
    """A mass on the sub under a ramp of force: travel and spring force at fixed steps, halving divides their change by 4.

    Spring 2 MN/m, 10 kN s/m and 1 t: 7.1 Hz, damping ratio 0.11; the ramp begins after steps of its own.
    """
    case = {
        "string": [sub(stiffness=2e6, damping=1e4), {"kind": "body", "length": 0.5, "mass": 1000.0}],
        "top": "clamped",
        "gravity": 0.0,
        "loads": [{"at": 0.1, "force": [0, 0, 3e4], "value_over": {"time": [0, 0.1, 9], "value": [0, 1, 1]}}],
        "time": {"end": 0.08},
        "output": {"history_every": 0.02},
        "petsc": {"ts_type": kind},
    }
    found = ratios(case, (2e-3, 1e-3, 5e-4), tmp_path, ("_travel", "_force"))
    assert found == pytest.approx([4.0, 4.0], rel=0.15)


@pytest.mark.parametrize("kind", ["bdf", "alpha2"])
def test_a_motor_is_of_second_order_in_time(kind, tmp_path):
    """Rotor of 100 kg m2 on its law, stator on 20 m of pipe, load from 0 to 9 kN m: speed and torque at fixed steps.

    Long elements with material damping: the torque follows the speeds at once, and would show the undamped torsional waves that the
    beginning of the ramp sends into the pipe.
    """
    case = hung(20.0, 0.0, pdm={**SECTION, "rotor_inertia": 100.0}, joint_at=8.8)
    for item in case["string"]:
        item["element_length"] = 11.0
    case["material"] = {"damping": {"stiffness": 5e-3}}
    ramp = {"time": [0, 0.2, 9.0], "value": [0, 1, 1]}
    case["loads"] = [{"at": 20.0, "moment": [0, 0, -9e3], "value_over": ramp}]
    case["time"], case["output"], case["petsc"] = {"end": 0.16}, {"history_every": 0.04}, {"ts_type": kind}
    found = ratios(case, (2e-3, 1e-3, 5e-4), tmp_path, ("bit_speed", "motor_output_torque"))
    assert found == pytest.approx([4.0, 4.0], rel=0.1)
