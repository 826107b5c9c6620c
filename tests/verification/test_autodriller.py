"""Autodriller: weight, rate, torque and pressure as limits of the drum's speed (manual: verif-autodriller).

The string and line are a spring k in series with a bit that drills D W: W' = k (v - D W), v the drum's speed.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drillpetsc import Case, Session, modes
from drillpetsc.output import read_table
from drillpetsc.physics.top.hoist import Hoist
from tests.helpers.hoist_models import DRILLABILITY, EA, HOIST, LINE_STIFFNESS, drilling, history
from tests.helpers.wells import newtonian

P, I = 5.0e-8, 2.0e-9  # default gains [m/s/N], [m/s2/N]


def reference(
    loops, rate, k: float, times: np.ndarray, filter: float = 0.0, most: float = 1.5, least: float = 0.0
):
    """Weights [N] and drum speeds [m/s] at ``times`` by Runge-Kutta.

    loops: (set point over time, p, i) of weight loops; rate: speed limit over time, None: none.  The loop with the smallest speed is in charge; the
    integrators of all follow the drum's speed with the time p/i.
    """

    def speeds(t, q):
        seen = q[1] if filter else q[0]
        wanted = [p * (goal(t) - seen) + q[2 + j] for j, (goal, p, _) in enumerate(loops)]
        return min(max(min([*wanted, *([rate(t)] if rate is not None else [])]), least), most)

    def f(t, q):
        v = speeds(t, q)
        tracking = [(v - q[2 + j]) * i / p for j, (_, p, i) in enumerate(loops)]
        return [k * (v - DRILLABILITY * q[0]), (q[0] - q[1]) / filter if filter else 0.0, *tracking]

    out = solve_ivp(
        f, (0, times[-1]), np.zeros(2 + len(loops)), t_eval=times, rtol=1e-9, atol=1e-9, max_step=0.05
    )
    return out.y[0], np.array([speeds(t, q) for t, q in zip(times, out.y.T, strict=True)])


def drill(autodriller: dict, end: float, length: float = 2000.0, hoist=None, **more) -> dict:
    """The string of the checks on a hoist with an autodriller, from zero weight."""
    top = {"hoist": HOIST | (hoist or {}), "autodriller": autodriller}
    return drilling(top, length, time={"end": end}, output={"history_every": 0.5}, **more)


def series(length: float = 2000.0) -> float:
    """Stiffness of string and line [N/m]."""
    return 1 / (length / EA + 1 / LINE_STIFFNESS)


def test_weight_on_bit_step(tmp_path):
    """C10: 100 kN from 0: W/100 kN = 0.18050, 0.54877, 0.97642 at 10, 30, 60 s, peak 1.20408 at 108.2 s, 1 %."""
    got, summary = history(drill({"wob": 100e3}, 130.0), tmp_path / "run")
    share = got["wob"] / 100e3
    assert np.interp([10, 30, 60], got["time"], share) == pytest.approx([0.18050, 0.54877, 0.97642], rel=1e-2)
    assert share.max() == pytest.approx(1.20408, rel=1e-2)
    near = np.abs(got["time"] - 108) < 8
    a, b, _ = np.polyfit(got["time"][near] - 108, share[near], 2)
    assert 108 - b / (2 * a) == pytest.approx(108.2, rel=1e-2)
    assert got["wob_surface"] == pytest.approx(got["wob"], abs=1.5e3)
    assert set(got["autodriller_mode"]) == {1.0}
    assert abs(summary["energy"]["error_share"]) < 1e-3
    assert any("give max_speed, or also the mode rop" in text for text in summary["warnings"])
    assert summary["hoist"]["autodriller"]["loops"] == [{"kind": "wob", "p": P, "i": I}]


def test_other_gains_and_lengths(tmp_path):
    """60 kN on 900 m with a filter of 2 s, gains of their own: the reference equations, 1 % of the set point."""
    keys = {"wob": 60e3, "p": 8e-8, "i": 6e-9, "filter": 2.0}
    got, _ = history(drill(keys, 40.0, 900.0), tmp_path / "run")
    expected, _ = reference([(lambda t: 60e3, 8e-8, 6e-9)], None, series(900.0), got["time"], 2.0)
    assert expected.max() > 65e3
    settled = got["time"] > 2  # before, the first axial waves
    assert got["wob"][settled] == pytest.approx(expected[settled], abs=600)


def test_rate_of_penetration(tmp_path):
    """The drum at 10 m/h: the weight rises to 99.206 kN, which drills as fast (C10)."""
    got, _ = history(drill({"mode": "rop", "rop": "10 m/h"}, 600.0), tmp_path / "run")
    assert got["wob"][-1] == pytest.approx(99.206e3, rel=5e-3)
    assert got["rop"][-1] == pytest.approx(10 / 3600, rel=5e-3)
    assert got["drum_speed"] == pytest.approx(10 / 3600, rel=1e-12)
    assert set(got["autodriller_mode"]) == {2.0}
    k = series()
    expected = 99.206e3 * (1 - np.exp(-k * DRILLABILITY * got["time"]))
    assert got["wob"] == pytest.approx(expected, abs=1e3)


def test_the_smallest_speed_is_in_charge_without_windup(tmp_path):
    """Weight and rate: the rate limits until the weight is reached, the weight limits, a lower set point stops the drum, and a
    low rate limits again.  The weight does not overshoot after the limits, because the integrator follows the drum.

    A PI loop that winds up while the rate limits would overshoot by a third.
    """
    goal = {"time": [0, 80, 80, 140, 140], "value": [60e3, 60e3, 5e3, 5e3, 60e3]}
    rate = {"time": [0, 140, 140], "value": [8 / 3600, 8 / 3600, 3 / 3600]}
    case = drill({"mode": ["wob", "rop"], "wob": goal, "rop": rate}, 220.0)
    got, summary = history(case, tmp_path / "run")

    def over(table):
        return lambda t: table["value"][np.searchsorted(table["time"], t, side="right") - 1]

    weight, speed = reference([(over(goal), P, I)], over(rate), series(), got["time"])
    assert weight.max() < 61.5e3 and speed[got["time"] < 20] == pytest.approx(8 / 3600)
    assert got["wob"] == pytest.approx(weight, abs=1.2e3)
    off_jumps = (np.abs(got["time"] - 80) > 1) & (np.abs(got["time"] - 140) > 1)
    assert got["drum_speed"][off_jumps] == pytest.approx(speed[off_jumps], abs=1.2e-4)
    assert got["drum_speed"].min() < 3e-6 and got["drum_speed"].min() >= 0
    assert set(got["autodriller_mode"]) == {1.0, 2.0}
    assert abs(summary["energy"]["error_share"]) < 1e-3


def test_limit_of_the_drum(tmp_path):
    """A largest speed of 12 m/h acts like the mode rop, and does not wind up; a drum that may reverse lifts the string."""
    goal = {"time": [0, 60, 60], "value": [80e3, 80e3, 10e3]}
    keys = {"wob": goal, "max_speed": 12 / 3600, "reverse": True, "p": 2e-7, "i": 1e-8}
    got, _ = history(drill(keys, 120.0), tmp_path / "run")
    most = 12 / 3600
    loop = (lambda t: 80e3 if t < 60 else 10e3, 2e-7, 1e-8)
    weight, _ = reference([loop], None, series(), got["time"], most=most, least=-most)
    assert got["wob"] == pytest.approx(weight, abs=1.5e3)
    assert got["drum_speed"].max() < most * (1 + 1e-9)
    assert got["drum_speed"].min() == pytest.approx(-most, rel=1e-3)


def test_start_of_the_autodriller_is_bumpless(tmp_path):
    """The drum pays out 6 m/h until 20 s; then the weight's set point rises by 1 kN/s from the weight of then, so that the drum's
    speed goes on from 6 m/h."""
    keys = {"wob": 70e3, "from": 20.0, "ramp": 1e3, "filter": 0.5}
    case = drill(keys, 80.0)
    case["top"]["lowering"] = 6 / 3600
    case["output"]["history_every"] = 0.1
    got, _ = history(case, tmp_path / "run")
    before, near = got["time"] < 20, np.abs(got["time"] - 20) < 1.5
    assert got["drum_speed"][before] == pytest.approx(6 / 3600) and set(got["autodriller_mode"][before]) == {
        0.0
    }
    assert np.abs(got["drum_speed"][near] - 6 / 3600).max() < 0.15 * 6 / 3600
    start = np.interp(20.0, got["time"], got["wob_surface"])

    def goal(t: float) -> float:
        return min(70e3, start + 1e3 * max(0.0, t))

    k = series()

    def f(t, q):
        v = P * (goal(t) - q[1]) + q[2]
        return [k * (v - DRILLABILITY * q[0]), (q[0] - q[1]) / 0.5, P * 0 + I * (goal(t) - q[1])]

    after = got["time"][~before]
    out = solve_ivp(f, (0, 60), [start, start, 6 / 3600], t_eval=after - 20, rtol=1e-8, max_step=0.1)
    assert got["wob"][~before] == pytest.approx(out.y[0], abs=1e3)


@pytest.mark.parametrize(
    "keys", [{"measure": "bit"}, {"sample": 0.5}, {"measure": "bit", "sample": 0.5, "filter": 0.5}]
)
def test_measured_at_the_bit_and_in_samples(keys, tmp_path):
    """The weight at the bit, and samples of 0.5 s: the course of the weight stays that of C10 within 2 % of the set point; the
    steps are not longer than a sample."""
    got, _ = history(drill({"wob": 100e3, **keys}, 60.0), tmp_path / "run")
    tau, mean = (
        keys.get("filter", 0.0),
        0.5 * keys.get("sample", 0.0),
    )  # a sample is late by half its interval
    expected, _ = reference([(lambda t: 100e3, P, I)], None, series(), got["time"], max(tau + mean, 0.0))
    assert got["wob"] == pytest.approx(expected, abs=2e3)
    if "sample" in keys:
        assert got["step"].max() <= 0.5 * (1 + 1e-9)


def test_torque(tmp_path):
    """A rotating string with a bit that grips: the autodriller finds the weight whose torque is the set point."""
    keys = {"mode": ["torque", "rop"], "torque": 400.0, "rop": "5 m/h", "torque_p": 1e-5, "torque_i": 5e-7}
    case = drill(keys, 150.0, 500.0)
    case["bottom"]["friction"] = 0.3
    case["top"]["rotation"] = 10.0
    case["material"] = case["material"] | {"damping": {"stiffness": 5e-3}}
    got, summary = history(case, tmp_path / "run")
    assert got["surface_torque"][-1] == pytest.approx(400, rel=1e-2)
    assert got["bit_torque"][-1] == pytest.approx(400, rel=2e-2)
    assert {2.0, 3.0} <= set(got["autodriller_mode"])


def test_set_points_of_a_session():
    """The weight is set from Python; state and set_state repeat the same numbers."""
    with Session(Case(**drill({"mode": ["wob", "rop"], "wob": 20e3, "rop": 30 / 3600}, 10.0, 500.0))) as s:
        names = [q.name for q in s.inputs]
        assert (
            "top.autodriller.wob" in names and "top.autodriller.rop" in names and "top.lowering" not in names
        )
        s.step(40.0)
        assert s.get("wob") == pytest.approx(20e3, rel=0.1)
        s.set("top.autodriller.wob", 50e3)
        state = s.state()
        s.step(3.0)
        first = s.get_many(["wob", "block_position", "drum_speed"])
        assert first[0] > 1.1 * 20e3
        s.set_state(state)
        s.step(3.0)
        assert s.get_many(["wob", "block_position", "drum_speed"]) == first
        s.set("top.autodriller.rop", 0.0)
        s.step(3.0)
        assert s.get("drum_speed") == pytest.approx(0.0, abs=3e-6)
        assert s.get("autodriller_mode") == 2


def test_differential_pressure(tmp_path):
    """The flow rises after the autodriller has begun: the pump pressure passes the set point above its value of then, and the
    drum stops; with the flow back the rate is in charge again."""
    keys = {
        "mode": ["rop", "differential_pressure"],
        "rop": "20 m/h",
        "differential_pressure": "5 bar",
        "pressure_p": 2e-8,
        "pressure_i": 1e-9,
        "from": 4.0,
        "filter": 0.2,
    }
    case = drill(keys, 24.0, 300.0)
    case["string"][0]["element_length"] = 30.0
    del case["gravity"], case["contact"]  # the pressure would buckle a pipe without weight
    case["string"].append({"kind": "bit", "length": 0.3, "od": 0.2, "mass": 30.0, "nozzle_area": 4e-4})
    case["well"]["survey"]["md"][1] = case["well"]["sections"][0]["to"] = 300.3
    case["fluid"] = newtonian(
        1200.0,
        0.01,
        flow_rate={"time": [0, 8, 9, 14, 15], "value": [0.02, 0.02, 0.026, 0.026, 0.02]},
        dynamics="quasi_steady",
    )
    got, _ = history(case, tmp_path / "run")
    t, v = got["time"], got["drum_speed"]
    tare = np.interp(4.0, t, got["pump_pressure"])
    high = (t > 10) & (t < 14)
    assert (got["pump_pressure"][high] - tare > 5e5).all()
    assert v[(t > 4.5) & (t < 8)] == pytest.approx(20 / 3600, rel=2e-2)
    assert v[(t > 12) & (t < 14)] == pytest.approx(0.0, abs=3e-6)
    assert v[t > 22] == pytest.approx(20 / 3600, rel=2e-2)
    assert {0.0, 2.0, 4.0} <= set(got["autodriller_mode"])


@pytest.mark.parametrize(("length", "p", "i"), [(2000.0, P, I), (800.0, 4e-8, 6e-9)])
def test_modes_of_the_weight_loop(length, p, i, tmp_path):
    """Linearised about its set point, weight loop, string, line and bit have the roots of s^2 + k (D + p) s + k i = 0, 1 %."""
    case = drill({"wob": 100e3, "p": p, "i": i}, 1.0, length, wob=20e3, lying=True)
    case["top"]["rotation"] = 10.0
    result = modes(Case(**case), out=tmp_path / "modes", kind="axial", count=2)
    table = read_table(result.folder / "modes.csv")
    k = 1 / (1 / series(length) + 1e-8)  # with the contact of the bit
    expected = np.roots([1, k * (DRILLABILITY + p), k * i])[0]
    slow = (table["frequency [Hz]"] > 0) & (table["frequency [Hz]"] < 0.1)
    assert table["growth [1/s]"][slow] == pytest.approx(expected.real, rel=1e-2)
    assert 2 * np.pi * table["frequency [Hz]"][slow] == pytest.approx(abs(expected.imag), rel=1e-2)


def test_a_ramp_limits_every_change_of_the_weight():
    """With a ramp of 2 kN/s a set point that jumps in a session is followed at that rate: drum speed without a kick."""
    keys = {"wob": 20e3, "ramp": 2e3}
    with Session(Case(**drill(keys, 10.0, 500.0))) as s:
        s.step(40.0)
        before = s.get("drum_speed")
        s.set("top.autodriller.wob", 60e3)
        s.step(0.5)
        assert abs(s.get("drum_speed") - before) < P * 1.2e3
        s.step(4.5)
        goal = s._model.part(Hoist)._goal("wob", s.time)
        assert goal == pytest.approx(20e3 + 2e3 * 5.0, rel=1e-6)
        s.step(20.0)
        assert s._model.part(Hoist)._goal("wob", s.time) == 60e3


def test_landing(tmp_path):
    """A string whose bit hangs above the bottom: the rate is in charge until the bit has landed and carries the weight; the hook load
    falls by the weight."""
    keys = {"mode": ["wob", "rop"], "wob": 60e3, "rop": "15 m/h", "filter": 0.5, "p": 2e-7, "i": 5e-9}
    case = drill(keys, 60.0, 1000.0)
    del case["gravity"], case["initial"]["wob"]
    case["string"] = [
        {"kind": "pipe", "length": 985.0, "od": 0.127, "id": 0.1086, "element_length": 49.25},
        {"kind": "bit", "length": 10.0, "od": 0.2159, "mass": 20e3},
    ]
    case["well"]["survey"]["md"][1] = case["well"]["sections"][0]["to"] = 995.5
    got, summary = history(case, tmp_path / "run")
    hanging = got["wob"] == 0
    assert 5 < got["time"][hanging].max() < 30 and got["drum_speed"][hanging] == pytest.approx(
        15 / 3600, rel=1e-2
    )
    assert got["wob"].max() == pytest.approx(60e3, rel=0.1)
    assert got["hook_load"][0] - got["hook_load"][-1] == pytest.approx(got["wob"][-1], rel=1e-3)
    assert not any("max_speed" in text for text in summary["warnings"])
    assert abs(summary["energy"]["error_share"]) < 1e-3


def test_a_step_of_a_session_that_ends_at_the_start_but_for_rounding():
    """`from` at 0.3 s and steps of 0.1 s, whose third ends at 0.30000000000000004 s: the drum goes on from its speed of before."""
    case = drill({"wob": 20e3, "from": 0.3, "ramp": 1e3}, 1.0, 500.0)
    case["top"]["lowering"] = 4e-3
    with Session(Case(**case)) as s:
        for _ in range(3):
            s.step(0.1)
        assert s.time > 0.3 and s.get("autodriller_mode") == 0
        s.step(0.1)
        assert s.get("autodriller_mode") == 1 and s.get("drum_speed") == pytest.approx(4e-3, rel=0.05)
