"""A run that starts from the final state of another run (manual: verif-from-run)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.output import read_table

PIPE = {"kind": "pipe", "length": 100.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}


def test_a_rotating_string_continues_from_a_run(tmp_path):
    """A string in steady rotation and lowering has no torque, and moves down by speed times time in each of
    two runs (rigid motion). The second run starts at time zero, with the top drive at the final angle and
    depth of the first."""
    top = {"kind": "top_drive", "rotation": "60 rpm", "lowering": 0.1}
    first = run(Case(string=[PIPE], top=top, time={"end": 0.3}), tmp_path / "first")
    second = run(
        Case(string=[PIPE], top=top, time={"end": 0.3}, initial={"from": str(first.folder)}),
        tmp_path / "second",
    )
    one, two = (read_table(q.folder / "history.csv") for q in (first, second))
    assert two["time [s]"][0] == 0.0
    assert two["bit_depth [m]"][0] == pytest.approx(one["bit_depth [m]"][-1], abs=1e-9)
    assert two["bit_depth [m]"][-1] - one["bit_depth [m]"][-1] == pytest.approx(0.03, abs=1e-6)
    assert np.abs(two["surface_torque [N m]"]).max() < 1e-3
    assert two["bit_speed [rad/s]"] == pytest.approx(2 * np.pi, abs=1e-6)


def test_a_top_that_jumps_against_the_other_run_is_reported(tmp_path):
    """The first run ends at 90 rpm and 360 m/h. Only the speed at which the next one begins otherwise is reported."""
    top = {"kind": "top_drive", "rotation": "90 rpm", "lowering": 0.1}
    first = run(Case(string=[PIPE], top=top, time={"end": 0.1}), tmp_path / "first")
    case = Case(string=[PIPE], top=top, time={"end": 0.01}, initial={"from": str(first.folder)})

    def said(name, **changes):
        warnings = run(case.replace(changes), tmp_path / name).summary["warnings"]
        return [w for w in warnings if "from time 0 on" in w]

    assert not said("same")
    (spin,) = said("slower", **{"top.rotation": "60 rpm"})
    assert "turns at 60 rpm from time 0 on, and turned at 90 rpm at the end of" in spin
    (speed,) = said("faster", **{"top.lowering": 0.2})
    assert "is lowered at 720 m/h from time 0 on, and was at 360 m/h" in speed
