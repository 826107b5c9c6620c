"""Controllers of the top drive that are Python functions (manual: sec-python-controller)."""

from __future__ import annotations

import textwrap

import numpy as np
import pytest

import drillpetsc
from drillpetsc import Case, run
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.output import read_table
from drillpetsc.physics.top.top_drive import MotorDrive
from tests.helpers import top_drive_models as m

PIPE = {"kind": "pipe", "length": 10.0, "od": 0.127, "id": 0.1086, "element_length": 5.0}
P, I, SAMPLE = 8e3, 12e3, 2e-3
MODULE = f"""
def pi(t, measured, memory):
    error = measured["set_point"] - measured["top_speed"]
    memory["integral"] = memory.get("integral", 0.0) + {SAMPLE} * error
    memory["calls"] = memory.get("calls", 0.0) + 1
    return {P} * error + {I} * memory["integral"]

def pi_fast(t, measured, memory):
    error = measured["set_point"] - measured["top_speed"]
    memory["integral"] = memory.get("integral", 0.0) + {SAMPLE} / 2 * error
    return {P} * error + {I} * memory["integral"]

def constant(t, measured):
    return 1e3 if t < 0.1 - 1e-9 else -500.0

def broken(t, measured):
    return float("nan")

def one(t):
    return 0.0
"""


@pytest.fixture(autouse=True)
def laws(tmp_path, monkeypatch):
    """The module of the functions in the present folder."""
    (tmp_path / "laws_of_test.py").write_text(textwrap.dedent(MODULE))
    monkeypatch.chdir(tmp_path)


def case(
    function: str, sample: float = SAMPLE, end: float = 0.5, rotation=None, string=(PIPE,), joints=(), **motor
) -> Case:
    """Ten metres of pipe under a drive whose torque a function gives."""
    control = {"kind": "python", "function": f"laws_of_test.{function}", "sample": sample}
    speed = {"ramp": 0.05, "value": 10.0} if rotation is None else rotation
    return Case(
        string=list(string),
        joints=list(joints),
        top=m.top(control, speed, **motor),
        gravity=0.0,
        initial={"from": "rest"},
        time={"end": end},
        output={"history_every": 0.01},
    )


def column(folder, name: str) -> np.ndarray:
    return next(v for k, v in read_table(folder / "history.csv").items() if k.split(" ")[0] == name)


def test_a_sampled_law_is_the_continuous_one_but_for_its_delay(tmp_path):
    """PI law every 2 ms and every 1 ms against the same law as states: the difference is of the order of the sample.

    The mean delay is half a sample and at most an eighth of one: p times the ramp's 200 rad/s2 times that, over the inertia,
    for 0.05 s, 0.034 rad/s at 2 ms.
    """
    smooth = case("pi").replace({"top.control": {"kind": "pi", "p": P, "i": I}})
    run(smooth, tmp_path / "smooth", progress="silent")
    exact, differences = column(tmp_path / "smooth", "top_speed"), []
    for name, sample in (("pi", SAMPLE), ("pi_fast", SAMPLE / 2)):
        run(case(name, sample), tmp_path / name, progress="silent")
        differences.append(np.abs(exact - column(tmp_path / name, "top_speed")).max())
        assert np.all(column(tmp_path / name, "control_mode") == 5)
    assert exact.max() > 7 and 0.014 < differences[0] < 0.034
    assert differences[1] == pytest.approx(differences[0] / 2, rel=0.15)


def test_a_held_torque_is_constant_between_samples(tmp_path):
    """1 kN m, from 0.1 s on -500 N m: impulse over the inertia of drive and pipe; the change acts half a step late."""
    run(case("constant", sample=0.01, end=0.2, rotation=0.0), tmp_path / "run", progress="silent")
    speed, time = column(tmp_path / "run", "top_speed"), column(tmp_path / "run", "time")
    inertia = m.INERTIA + m.DENSITY * m.POLAR * 10.0
    late = 1500.0 * 0.5 * 0.01 / 4
    impulse = inertia * np.interp([0.1, 0.2], time, speed)
    assert impulse[0] == pytest.approx(100.0, rel=2e-3)
    assert -0.1 < impulse[1] - 50.0 < 1.1 * late
    torque = column(tmp_path / "run", "motor_torque")
    assert set(np.round(torque[1:][time[1:] < 0.099], 6)) == {1e3} and torque[-1] == pytest.approx(-500)


def test_the_limit_of_the_motor_holds(tmp_path):
    run(case("pi", end=0.2, max_torque=20e3), tmp_path / "run", progress="silent")
    assert column(tmp_path / "run", "motor_torque").max() == pytest.approx(20e3, rel=0.01)
    assert column(tmp_path / "run", "torque_limited").max() > 0.9


def test_sessions_and_saved_states_keep_torque_and_memory():
    """A session is stepped off the grid of the samples; its state replays to the last bit, memory included."""
    with drillpetsc.Session(case("pi")) as s:
        s.step(0.1031)
        state, found = s.state(), []
        for _ in range(2):
            s.set_state(state)
            for _ in range(7):
                s.step(0.0113)
            held = s._model.part(MotorDrive).torque_input
            found.append(
                [*s.get_many(["top_speed", "motor_torque", "bit_speed"]), held.torque, dict(held.memory)]
            )
        assert found[0] == found[1]
        assert found[0][4]["calls"] == int((0.1031 + 7 * 0.0113) / SAMPLE) + 1


def test_wrong_functions_are_answered(tmp_path):
    with pytest.raises(CaseError, match="no_such"):
        drillpetsc.Session(case("no_such"))
    with pytest.raises(CaseError, match="1 parameters"):
        drillpetsc.Session(case("one"))
    with drillpetsc.Session(case("broken")) as s, pytest.raises(SolveError, match="broken gave nan at 0 s"):
        s.step(0.01)
    with pytest.raises(CaseError, match="module.function"):
        case("pi").replace({"top.control.function": "pi"})
    with pytest.raises(CaseError, match="above 0"):
        case("pi", sample=0.0)
    keys = {"string": [PIPE], "time": {"end": 1.0}}
    two = [{"kind": "stiff"}, {"kind": "python", "function": "laws_of_test.pi", "sample": 0.01}]
    with pytest.raises(CaseError, match="a single controller"):
        Case(**keys, top=m.top(two, 1.0))
    with pytest.raises(CaseError, match="no known reflection"):
        drillpetsc.top_drive(case("pi"), tmp_path / "t")


def test_linear_analyses_leave_the_function_out_and_say_so(tmp_path):
    found = drillpetsc.modes(case("pi"), tmp_path / "m", count=1)
    assert any("controller in Python is left out" in text for text in found.summary["warnings"])
    linear = drillpetsc.linearise(case("pi"), ["top.rotation"], ["top_speed", "speed_error"], tmp_path / "l")
    assert any("controller in Python is left out" in line for line in linear.lines)
    assert not linear.system.C[0].any()
    assert linear.system.D[1, 0] == pytest.approx(1.0)


@pytest.mark.parametrize("joints", [[], [{"at": 0.2, "kind": "universal"}]], ids=["beam", "joint"])
def test_generalised_alpha_jumps_with_the_torque(joints, tmp_path):
    """A constant torque that changes its sign at 0.1 s: dw/dt = M/J, with the speed of the rigid drive at every row."""
    short = {**PIPE, "length": 0.2, "element_length": 0.1}
    made = case("constant", string=[short, short], joints=joints)
    alpha = made.model_copy(update={"time": made.time.model_copy(update={"integrator": "generalized_alpha"})})
    done = run(alpha, tmp_path / "run", progress="silent")
    table = read_table(done.folder / "history.csv")
    t, inertia = table["time [s]"], m.INERTIA + 7850 * m.POLAR * 0.4
    exact = (1e3 * np.minimum(t, 0.1) - 500.0 * np.maximum(t - 0.1, 0.0)) / inertia
    assert table["top_speed [rad/s]"] == pytest.approx(exact, abs=1e-5 * exact.max())
    assert abs(done.summary["energy"]["error_share"]) < 1e-6
