"""Motion of a top drive with a motor: speed steps, the power curve, starts, and stick-slip (manual: verif-top-drive)."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import trapezoid

from drillpetsc import Case, run
from drillpetsc.output import read_table
from tests.helpers import top_drive_models as m

PIPE = {"kind": "pipe", "length": 10.0, "od": 0.127, "id": 0.1086, "element_length": 5.0}
TOTAL = m.INERTIA + m.DENSITY * m.POLAR * 10.0  # of drive and pipe [kg m2]


def history(case: dict, folder) -> tuple[dict[str, np.ndarray], dict]:
    """Columns of history.csv without units, and the summary."""
    result = run(Case(**case), folder, progress="silent")
    table = read_table(result.folder / "history.csv")
    return {title.split(" ")[0]: column for title, column in table.items()}, result.summary


def alone(control, rotation, end: float, every: float = 0.01, petsc=None, **motor) -> dict:
    """The drive with 10 m of pipe below it, at rest at the start."""
    return {
        "string": [PIPE],
        "material": {"young": m.YOUNG, "poisson": 0.3, "density": m.DENSITY},
        "top": m.top(control, rotation, **motor),
        "gravity": 0.0,
        "initial": {"from": "rest"},
        "time": {"end": end},
        "output": {"history_every": every},
        "petsc": {} if petsc is None else petsc,
    }


def step(speed: float, at: float = 0.1) -> dict:
    """A set point that jumps from 0 to ``speed`` [rad/s]."""
    return {"time": [0, at, at], "value": [0, 0, speed]}


def test_speed_step(tmp_path):
    """PI control of the inertia alone: overshoot 21.80 % at 1.105 s, first torque p times the step, 0.5 % (C5).

    e'' + p/I e' + i/I e = 0 with e = 10, e' = -p e/I at the start: its first minimum after the jump.
    """
    p, i = 8e3, 12e3
    a, w = p / (2 * TOTAL), np.sqrt(i / TOTAL - (p / (2 * TOTAL)) ** 2)
    t = np.linspace(0, 2, 200001)
    error = 10 * np.exp(-a * t) * (np.cos(w * t) - a / w * np.sin(w * t))
    assert -error.min() / 10 == pytest.approx(0.2180, abs=5e-5)
    assert t[error.argmin()] == pytest.approx(1.105, abs=5e-4)
    got, summary = history(alone({"kind": "pi", "p": p, "i": i}, step(10.0), 2.0, 0.001), tmp_path / "run")
    top = got["top_speed"].argmax()
    parabola = np.polyfit(
        got["time"][top - 5 : top + 6] - got["time"][top], got["top_speed"][top - 5 : top + 6], 2
    )
    peak = -parabola[1] / (2 * parabola[0])
    assert got["top_speed"][top] / 10 - 1 == pytest.approx(-error.min() / 10, rel=5e-3)
    assert got["time"][top] + peak - 0.1 == pytest.approx(t[error.argmin()], rel=5e-3)
    first = np.flatnonzero(got["time"] > 0.1005)[0]
    later = got["time"][first] - 0.1
    torque = p * np.interp(later, t, error) + i * trapezoid(error[t <= later], t[t <= later])
    assert got["motor_torque"][first] == pytest.approx(torque, rel=5e-3)
    assert got["motor_torque"].max() == pytest.approx(80e3, rel=5e-3)
    assert got["surface_torque"] == pytest.approx(got["pipe_torque"])
    assert abs(summary["energy"]["error_share"]) < 1e-3


def test_start_on_the_power_curve(tmp_path):
    """60 kN m up to 800 kW: 13.333 rad/s after I w/T and 20 rad/s after I (w^2 - w_b^2)/2P more, 1 % (C6)."""
    torque, power = 60e3, 800e3
    base = power / torque
    first = TOTAL * base / torque
    second = first + TOTAL * (20**2 - base**2) / (2 * power)
    assert [first, second] == pytest.approx([0.6447, 1.0476], abs=2e-4)
    limits = {"max_torque": torque, "power": power}
    got, _ = history(alone("stiff", step(30.0), 3.0, 0.005, **limits), tmp_path / "run")
    passed = [np.interp(w, got["top_speed"][:300], got["time"][:300]) - 0.1 for w in (base, 20.0)]
    assert passed == pytest.approx([first, second], rel=1e-2)
    accelerating = (got["top_speed"] < 20) & (got["time"] > 0.101)
    assert (got["motor_torque"] < torque * (1 + 1e-9)).all()
    assert (got["motor_power"] < power * (1 + 1e-9)).all()
    assert got["torque_limited"][accelerating].all()
    # the integrator is held: without windup the speed stays within the overshoot of the unlimited step, here none
    assert got["top_speed"].max() < 30.0 * 1.02
    assert not got["torque_limited"][-1]
