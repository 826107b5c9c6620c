"""Path of a string's end along a curved hole (manual: sec-prescribed-path)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.geometry.frames import Frames, smallest_rotation
from drillpetsc.geometry.well import Well
from drillpetsc.physics.end_conditions import EndPlace, FixedEnd, TopDrive
from drillpetsc.physics.hole_path import HolePath, is_curved
from drillpetsc.time_function import Constant
from tests.helpers.tables import each_row


def helix_well() -> Well:
    """Hole that builds from 10 to 60 deg and walks from 20 to 110 deg within 300 m, straight below and above."""
    md = np.arange(0.0, 601.0, 30.0)
    share = np.clip((md - 60) / 300, 0, 1)
    return Well.from_survey(
        md, np.radians(10 + 50 * share), np.radians(20 + 90 * share), [600.0], [0.1], [0.2], ["open_hole"]
    )


def moved(path: HolePath, depth: float, step: float = 1e-3) -> list:
    return [path.at(depth + k * step) for k in (-1, 0, 1)]


@each_row("depth", [-5.0, 33.0, 77.0, 215.3, 340.0, 480.0])
def test_the_normals_do_not_rotate_about_the_tangent(depth: float) -> None:
    """n_i' = -(kappa . n_i) t (Bishop, American Mathematical Monthly 82(3), 1975)."""
    path = HolePath(helix_well())
    before, here, after = moved(path, depth)
    rate = (after.axes - before.axes) / 2e-3
    assert here.axes @ here.axes.T == pytest.approx(np.eye(3), abs=1e-14)
    assert rate[0] == pytest.approx(here.curvature, abs=1e-8)
    for k in (1, 2):
        expected = -(here.curvature @ here.axes[k]) * here.axes[0]
        assert rate[k] == pytest.approx(expected, abs=3e-6)


def test_normals_that_are_given_begin_there_and_stay_right_handed() -> None:
    t, one, two = HolePath(helix_well()).at(33.0).axes
    path = HolePath(helix_well(), 33.0, 0.6 * one + 0.8 * two)
    assert path.at(33.0).axes == pytest.approx(np.array([t, 0.6 * one + 0.8 * two, 0.6 * two - 0.8 * one]))
    assert np.linalg.det(path.at(215.3).axes) == pytest.approx(1.0)


def test_the_path_depends_on_the_depth_only() -> None:
    forth, back = HolePath(helix_well()), HolePath(helix_well())
    depths = np.linspace(-10, 620, 40)
    there = {s: forth.at(s).axes.copy() for s in depths}
    for s in depths[::-1]:
        assert (back.at(s).axes == there[s]).all()


def test_a_straight_hole_has_no_curved_path() -> None:
    straight = Well.from_survey(
        np.array([0.0, 50.0, 100.0]), np.full(3, 0.3), np.full(3, 1.0), [100.0], [0.1], [0.2], ["open_hole"]
    )
    assert not is_curved(straight) and is_curved(helix_well())


def state_on_path(path: HolePath, frames: Frames, depth: float, stretch: float, angle: float) -> np.ndarray:
    """Unknowns (7,) of a section on the path whose first director is at ``angle`` from the first normal."""
    here = path.at(depth)
    t, one, two = here.axes
    director = np.cos(angle) * one + np.sin(angle) * two
    first = smallest_rotation(frames.reference[0], t, frames.second_director[0])
    phi = np.arctan2(director @ np.cross(t, first), director @ first)
    return np.concatenate([path.position(np.array([depth, 0.01, -0.02])), stretch * t, [phi]])


@pytest.mark.parametrize("start", [41.0, 151.0])
def test_values_and_rates_of_a_top_that_moves_through_a_curve(start: float) -> None:
    """D x = value on the path, and D x' = rate with the spin rate phi' + c(v).v' (manual: eq-beam-spin-rate)."""
    path = HolePath(helix_well())
    here = path.at(start)
    frames = Frames(here.axes[:1].copy(), here.axes[1:2].copy(), np.zeros(0))
    position = path.position(np.array([start, 0.01, -0.02]))
    speed, spin = 0.71, 3.0
    top = TopDrive(
        EndPlace(position, here.axes[0], angle=0.2, path=path, frames=frames), Constant(spin), Constant(speed)
    )
    condition = top.prescribed()[0]
    assert condition.along_path is not None
    for t in (0.0, 20.0, 170.0):
        at = [
            state_on_path(path, frames, start + speed * q, 1.001, 0.2 + spin * (q - t))
            for q in (t - 1e-3, t, t + 1e-3)
        ]
        x, rate = at[1], (at[2] - at[0]) / 2e-3
        v, w, a = x[3:6], rate[3:6], frames.reference[0]
        n = np.linalg.norm(v)
        rate[6] += np.cross(v, a) @ w / (n * (n + v @ a))
        top.anchor[3] = 0.2 - spin * t
        D, value, prescribed_rate = condition.along_path(t, x)
        assert D @ D.T == pytest.approx(np.eye(len(D)), abs=1e-14)
        assert D @ x == pytest.approx(value, abs=1e-10)
        assert D @ rate == pytest.approx(prescribed_rate, abs=1e-5)
        assert condition.advance is not None
        change = condition.advance(x) * speed
        still = (at[2] - at[0]) / 2e-3
        assert change[:6] == pytest.approx(still[:6], abs=1e-5)
        assert change[6] == pytest.approx(still[6] - spin, abs=1e-5)


def test_a_clamped_end_is_shifted_along_the_hole() -> None:
    path = HolePath(helix_well(), 0.0)
    here = path.at(0.0)
    frames = Frames(here.axes[:1].copy(), here.axes[1:2].copy(), np.zeros(0))
    end = FixedEnd(EndPlace(here.centre, here.axes[0], path=path, frames=frames), "clamped")
    end.shift(200.0)
    assert end.prescribed_position() == pytest.approx(helix_well().at(200.0)[0], abs=1e-9)
    end.displace(0.05 * path.at(200.0).axes[2])
    assert end.anchor[:3] == pytest.approx([200.0, 0.0, 0.05], abs=1e-12)
