"""The filter of `follow`: sigma points against closed forms, walks between readings, sums of alarms."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.follow.alarms import BY_STANDS, EXPONENT, PULL, WEIGHT, Error, PressureTrack, Watch
from drillpetsc.analysis.follow.sigma_points import Belief, corrected, expected
from drillpetsc.analysis.follow.state import State, first_belief, states_of, walked, with_priors
from drillpetsc.errors import CaseError

RNG = np.random.default_rng(7)
ROOT = RNG.standard_normal((4, 4))
BELIEF = Belief(np.array([1.0, -2.0, 0.5, 3.0]), ROOT @ ROOT.T)


def test_a_linear_function_gives_the_filter_of_kalman():
    """Mean A x, covariance A P A', gain P A' S^-1, P - K S K'."""
    a, noise = RNG.standard_normal((2, 4)), np.diag([0.3, 0.7])
    seen = expected(BELIEF, lambda points: points @ a.T)
    p = BELIEF.covariance
    np.testing.assert_allclose(seen.mean, a @ BELIEF.mean, rtol=1e-9)
    np.testing.assert_allclose(seen.covariance, a @ p @ a.T, rtol=1e-8)
    reading = a @ BELIEF.mean + np.array([0.1, -0.2])
    after = corrected(BELIEF, seen, reading, noise, gate=1e9)
    spread = a @ p @ a.T + noise
    gain = p @ a.T @ np.linalg.inv(spread)
    np.testing.assert_allclose(after.mean, BELIEF.mean + gain @ (reading - a @ BELIEF.mean), rtol=1e-7)
    np.testing.assert_allclose(after.covariance, p - gain @ spread @ gain.T, atol=1e-7)


def test_a_square_has_its_normal_moments():
    """E[x^2] = m^2 + v; var(x^2) = 4 m^2 v + 2 v^2."""
    mean, variance = 1.5, 0.4
    seen = expected(Belief(np.array([mean]), np.array([[variance]])), lambda points: points**2)
    assert seen.mean[0] == pytest.approx(mean**2 + variance, rel=1e-9)
    assert seen.covariance[0, 0] == pytest.approx(4 * mean**2 * variance + 2 * variance**2, rel=1e-9)


def test_an_outlier_is_widened_and_not_dropped():
    """One state read directly: noise r becomes r d2/gate with d2 = v^2/(p + r)."""
    belief, r, gate, off = Belief(np.zeros(1), np.eye(1)), 0.5, 6.635, 10.0
    seen = expected(belief, lambda points: points)
    wide = r * (off**2 / (1 + r)) / gate
    after = corrected(belief, seen, np.array([off]), np.array([[r]]), gate)
    assert after.mean[0] == pytest.approx(off / (1 + wide), rel=1e-9)


def test_walks_between_readings():
    """P grows by q^2 s; an error of readings is forgotten along its length and keeps its variance."""
    states = (State("mu", 0.2, 0.1, 0.002), State("error", 0.0, 6e3, length=15.0))
    belief = Belief(np.array([0.2, 3e3]), np.diag([0.01, 4e6]))
    after = walked(states, belief, 30.0)
    keep = np.exp(-2.0)
    assert after.covariance[0, 0] == pytest.approx(0.01 + 0.002**2 * 30)
    assert after.mean.tolist() == pytest.approx([0.2, 3e3 * keep])
    assert after.covariance[1, 1] == pytest.approx(36e6 + keep**2 * (4e6 - 36e6))
    half = walked(states, walked(states, belief, 12.0), 18.0)
    np.testing.assert_allclose(half.covariance, after.covariance)


def test_priors_name_states():
    states = states_of({"cased": 0.2, "open_hole": 0.25}, 600e3, 0.1)
    first = first_belief(with_priors(states, {"cased": (0.18, 0.01)}))
    assert first.mean[0] == 0.18 and first.sd[0] == pytest.approx(0.01)
    with pytest.raises(CaseError, match="block_weight"):
        with_priors(states, {"blocks": (1.0, 1.0)})


def test_sums_of_alarms():
    """g = max(0, g + e - 0.7) passes 5 with errors of 2 sd at the fourth stand; the other sign is another kind."""
    watch = Watch()
    up = {"hook_load": Error(120.0, 100.0, 10.0)}
    found = [watch.see("trip_out", 2000.0 - 28 * i, up) for i in range(4)]
    assert [len(q) for q in found] == [0, 0, 0, 1]
    alarm = found[3][0]
    assert (alarm.kind, alarm.since, alarm.excess, alarm.share) == (PULL, 2000.0, 20.0, pytest.approx(0.2))
    assert int(np.ceil(BY_STANDS[1] / (2 - BY_STANDS[0]))) == 4
    down = {"hook_load": Error(20.0, 100.0, 10.0)}
    assert [q.kind for q in watch.see("trip_out", 1880.0, down)] == [WEIGHT]
    saved = Watch()
    saved.restore(watch.saved())
    assert saved.saved() == watch.saved()


def test_pressure_follows_the_flow_rate():
    """A pump pressure that rises with Q^1.85 is forecast; half of it is not."""
    track = PressureTrack()
    for _ in range(5):
        track.see(20e6, 0.06, True)
    level = track.level
    same = track.error(20e6 * 0.8**EXPONENT, 0.048, level, 30.0, 2000.0)
    lost = track.error(10e6, 0.06, level, 30.0, 2000.0)
    assert abs(same.standard) < 1e-6 and lost.standard < -10
    assert track.error(20e6, 0.0, level, 30.0, 2000.0) is None


def test_a_string_that_grows_near_the_surface_is_no_pack_off():
    """40 bar at the bit, 90 m of collars with 0.2 bar/m and pipe with 0.03 bar/m, run in from the rig: the second stand adds 13 % of
    pressure, and no alarm.  At 2000 m, 20 % more within a stand is one."""

    def alarms(lengths: list[float], pressures: list[float]) -> list:
        track, watch, found = PressureTrack(), Watch(), []
        for length, pressure in zip(lengths, pressures, strict=True):
            error = track.error(pressure, 0.02, track.level, 30.0, length)
            if error is not None:
                found += watch.see("trip_in", length, {"pump_pressure": error})
            track.walk(30.0)
            track.see(pressure, 0.02, True)
        return found

    shallow = [4.0 + 30.0 * k for k in range(9)]
    assert alarms(shallow, [40e5 + 2e4 * min(q, 90) + 3e3 * max(q - 90, 0) for q in shallow]) == []
    assert len(alarms([1970.0, 2000.0, 2030.0], [200e5, 240e5, 240e5])) == 1
