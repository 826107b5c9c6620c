"""A run that starts from the state another run has ended in."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.output import read_table

PIPE = {"kind": "pipe", "length": 100.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}


def test_a_turning_string_goes_on_from_a_run(tmp_path):
    """A string in steady rotation and lowering has no torque and goes down by speed times time in each of two
    runs (rigid motion); the second one's clock begins anew, its top drive at the angle and depth at which the
    first one's ended."""
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
