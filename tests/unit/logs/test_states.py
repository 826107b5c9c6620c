"""Quality, rig states and points of planted logs of about 200 rows, whose truth is known from how they are made."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.errors import CaseError
from drillpetsc.logs.channels import CHANNELS
from drillpetsc.logs.log import Log
from drillpetsc.logs.points import Every, points_of, read_every
from drillpetsc.logs.quality import (
    check_sizes,
    dead_flag,
    gaps,
    held_values,
    spikes,
    weight_off_bottom,
    without_jumps,
)
from drillpetsc.logs.states import Limits, read_limits, states_of

BLOCK, STRING = 600e3, 800e3  # [N]
STEP = 5.0  # between rows [s]
RPM, FLOW = 12.0, 0.05  # [rad/s], [m3/s]
#: rig word, rows, speed [m/s], hook load, rotation, flow
TRIP = [
    ("in_slips", 16, 0.0, BLOCK, 0.0, 0.0),
    ("trip_in", 14, 0.5, 1.3e6, 0.0, 0.0),
    ("connection", 16, 0.0, BLOCK, 0.0, 0.0),
    ("trip_in", 14, 0.5, 1.3e6, 0.0, 0.0),
    ("in_slips", 16, 0.0, BLOCK, 0.0, 0.0),
    ("hanging", 16, 0.0, 1.4e6, 0.0, 0.0),
    ("circulate", 16, 0.0, 1.38e6, 0.0, FLOW),
    ("rotate_off", 16, 0.0, 1.4e6, RPM, FLOW),
    ("backream", 8, -0.2, 1.45e6, RPM, FLOW),
    ("ream_down", 8, 0.2, 1.35e6, RPM, FLOW),
    ("hanging", 16, 0.0, 1.4e6, 0.0, 0.0),
    ("trip_out", 14, -0.5, 1.5e6, 0.0, 0.0),
    ("in_slips", 16, 0.0, BLOCK, 0.0, 0.0),
]


def planted(parts=TRIP, seed=1):
    """(log, words of its rows) of parts one after another, with noise of 1 % in the hook load."""
    noise = np.random.default_rng(seed)
    words, depth, hook, rpm, flow = [], [], [], [], []
    at = 2000.0
    for word, rows, speed, load, turns, pumps in parts:
        for _ in range(rows):
            words.append(word)
            depth.append(at)
            hook.append(load * (1 + 0.003 * noise.standard_normal()))
            rpm.append(turns)
            flow.append(pumps)
            at += speed * STEP
    time = STEP * np.arange(len(words))
    values = {
        "time": time,
        "bit_depth": np.array(depth),
        "hole_depth": np.full(len(words), 3000.0),
        "hook_load": np.array(hook),
        "rpm": np.array(rpm),
        "flow_rate": np.array(flow),
    }
    return Log(values, {name: name for name in CHANNELS}), np.array(words)


def _states(log, given=BLOCK, limits=None):
    far, _ = gaps(log)
    return states_of(log, np.full(len(log), STRING), given, limits or Limits(), far), far


def _inner(words):
    """Rows whose word is that of five rows before and after, 25 s: farther from a change than an edge."""
    out = np.ones(len(words), dtype=bool)
    for shift in (1, 2, 3, 4, 5):
        same = words[shift:] == words[:-shift]
        out[shift:] &= same
        out[:-shift] &= same
    out[:5] = out[-5:] = False
    return out


def test_states_of_a_planted_trip():
    log, words = planted()
    states, _ = _states(log)
    inner = _inner(words)
    assert inner.sum() > 40
    wrong = [(i, words[i], states.word[i]) for i in np.flatnonzero(inner) if words[i] != states.word[i]]
    assert not wrong
    assert states.block == pytest.approx(BLOCK, rel=0.005)


def test_edges_are_never_points():
    log, words = planted()
    log.values["torque"] = np.full(len(log), 5.0)  # what a drive at rest shows
    states, far = _states(log)
    change = np.flatnonzero((words[1:] == "in_slips") != (words[:-1] == "in_slips"))
    assert (states.word == "edge").sum() > 20 and len(change)
    points = points_of(log, states, np.full(len(log), STRING), Every(), far)
    assert {p.operation for p in points} == {"trip_in", "trip_out", "rotate_off_bottom", "backreaming"}
    for point in points:
        true = next(load for word, _, _, load, _, _ in TRIP if point.operation.startswith(word))
        assert point.values["hook_load"] == pytest.approx(true, rel=0.005)
    assert all("torque" not in p.values and p.values["rpm"] == 0 for p in points if p.operation == "trip_in")
    speeds = {p.operation: p.speed for p in points}
    assert speeds["trip_in"] == pytest.approx(0.5) and speeds["backreaming"] == pytest.approx(0.2)


def test_trips_make_no_points_where_slips_are_not_recognised():
    log, _ = planted()
    far, _ = gaps(log)
    nothing = np.full(len(log), np.nan)
    states = states_of(log, nothing, None, Limits(), far)
    assert states.block is None and (states.word == "trip_in").any() and not states.in_slips.any()
    assert {p.operation for p in points_of(log, states, nothing, Every(), far)} == {"rotate_off_bottom"}


def test_block_is_found_without_a_case_value():
    log, _ = planted()
    assert _states(log, None)[0].block == pytest.approx(BLOCK, rel=0.005)
    hanging = [("hanging", 100, 0.0, 1.4e6, 0.0, 0.0)]  # no row in slips: its load is not that of the block
    states, _ = _states(planted(hanging)[0], None)
    assert states.block is None and not states.in_slips.any()


def test_limits_are_options():
    assert read_limits(["edge_time=14 s", "moving=3 m/min"]).moving == pytest.approx(0.05)
    assert read_limits(["block_weight=60 t"]).block_weight == pytest.approx(588399.0)
    for text in ("edge_time", "nothing=1", "edge_time=1 kg", "bottom=-1 m"):
        with pytest.raises(CaseError, match="--states"):
            read_limits([text])
    log, _ = planted()
    few, many = (
        (_states(log, limits=read_limits([f"edge_time={t} s"]))[0].word == "edge").sum() for t in (6, 20)
    )
    assert few < many


def test_drilling_and_sliding_on_bottom():
    log, _ = planted([("drilling", 30, 0.005, 1.3e6, RPM, FLOW), ("slide", 30, 0.005, 1.3e6, 0.0, FLOW)])
    log.values["hole_depth"] = log.values["bit_depth"] + 0.1
    log.values["wob"] = np.full(60, 50e3)
    words = _states(log)[0].word
    assert set(words[:30]) == {"drilling"} and set(words[30:]) == {"slide"}
    turns = log.values.pop("rpm")
    assert set(_states(log)[0].word) == {"unknown"}  # it drills or slides
    log.values["rpm"] = turns
    log.values["hole_depth"] = log.values["bit_depth"] + 1.0
    assert not set(_states(log)[0].word) & {"drilling", "slide"}


def test_a_jump_out_and_back_is_dropped_and_a_move_is_not():
    depth = 1900 + 0.03 * np.arange(200)
    depth[[20, 21, 90]] += 2.0
    log = Log({"bit_depth": depth, "hook_load": np.arange(200.0)}, {})
    kept, check = without_jumps(log)
    assert check.count == 3 and len(kept) == 197 and (np.diff(kept.values["bit_depth"]) >= 0).all()
    assert not np.isin([20.0, 21.0, 90.0], kept.values["hook_load"]).any()
    trip, _ = planted()
    assert without_jumps(trip)[1].count == 0  # the bit turns round, which is not a jump
    trip.values["bit_depth"][50] += 200.0
    assert without_jumps(trip)[1].count == 1


def test_gap_held_value_spike_and_drifted_weight():
    log, _ = planted([("circulate", 200, 0.0, 1.4e6, 0.0, FLOW)])
    log.values["time"][100:] += 60.0
    far, check = gaps(log)
    assert np.flatnonzero(far).tolist() == [100] and check.count == 1
    log.values["hook_load"][40] *= 1.2
    assert [(q.channel, q.count) for q in spikes(log)] == [("hook_load", 1)]
    log.values["hook_load"] = np.repeat(log.values["hook_load"][::4], 4)
    assert [(q.channel, q.count) for q in held_values(log)] == [("hook_load", 150)]
    log.values["wob"] = np.where(np.arange(200) < 50, 10e3, 1e3)
    assert [(q.channel, q.count, q.n) for q in weight_off_bottom(log)] == [("wob", 50, 200)]


def test_a_dead_flag_is_named():
    log, words = planted()
    slips = np.isin(words, ["in_slips", "connection"])
    log.values["in_slips"] = np.zeros(len(log))
    (check,) = dead_flag(log, slips)
    assert check.name == "dead flag" and check.count == slips.sum()
    log.values["in_slips"] = slips.astype(float)
    assert not dead_flag(log, slips)


def test_units_are_tested_by_size():
    def expected(depth):
        return np.full(len(depth), BLOCK + STRING)

    log, _ = planted()
    assert not check_sizes(log, expected)
    for factor, words in (
        (9.80665, "kN read as t"),
        (1 / 9.80665, "t read as kN"),
        (1 / 4.4482, "klbf read as kN"),
    ):
        wrong, _ = planted()
        wrong.values["hook_load"] = wrong.values["hook_load"] * factor
        with pytest.raises(CaseError, match=words):
            check_sizes(wrong, expected)
        from dataclasses import replace

        assert (
            "in the unit that --map gives"
            in check_sizes(replace(wrong, mapped=frozenset({"hook_load"})), expected)[0]
        )
    log.values["torque"] = np.full(len(log), 2e6)
    assert "gauge in psi" in check_sizes(log, None)[0]
    log.values.update(
        {
            "torque": np.full(len(log), 2e4),
            "rop": np.full(len(log), 0.01),
            "rpm": np.full(len(log), 0.26),
        }
    )
    assert "in Hz?" in check_sizes(log, None)[0]


def test_points_by_depth_hold_rotation_and_flow_apart():
    n = 400
    depth = 1000 + 0.05 * np.arange(n)
    rpm = np.where(np.arange(n) % 40 < 8, 10.0, RPM)
    log = Log({"bit_depth": depth, "hook_load": 1e6 + 1e3 * depth, "rpm": rpm, "rop": np.full(n, 0.01)}, {})
    states = states_of(log, np.full(n, np.nan), None, Limits(), gaps(log)[0])
    points = points_of(log, states, np.full(n, np.nan), Every(1.0), gaps(log)[0])
    assert sum(p.n for p in points) == n
    assert {round(p.values["rpm"], 6) for p in points} == {10.0, RPM}
    assert max(p.n for p in points) <= 20


def test_every():
    assert read_every("1m", False).depth == 1.0 and read_every("10s", True).time == 10.0
    for text, by_time in (("10s", False), ("1", True), ("1 kg", True), ("0 m", True)):
        with pytest.raises(CaseError, match="--every"):
            read_every(text, by_time)
