"""`available_wob` of `limits`: what a string brings down by its own weight (manual: sec-guide-limits)."""

from __future__ import annotations

import math

import pytest

from drillpetsc.analysis.loads.limits.limits import run_limits
from drillpetsc.output.job import Job
from tests.verification.test_limits_command import FT, case, hole, level_pipe

BIT = {"kind": "bit", "length": 0.0, "od": 0.2, "mass": 0.0}
WEIGHT, LENGTH, FRICTION = 315.0, 1000.0, 0.3  # [N/m], [m]
HELICAL = 356.16e3  # of the level string, Wicks et al. (2008) [N]


def available(inclination: float, folder, block: float | None = None, friction: float = FRICTION):
    string = [level_pipe(LENGTH, element_length=25.0), BIT]
    rig = {} if block is None else {"rig": {"block_weight": block}}
    given = case(string, hole(LENGTH, inclination, 0.222, friction), **rig)
    return run_limits(Job(given, folder / "r"), "rob").summary


def test_slacked_off_on_an_incline(tmp_path):
    """60 deg: nothing is left on the hook at w L (cos I - a mu sin I), with a = 1 sliding and v/sqrt(v^2 + (omega R)^2) drilling."""
    angle = math.radians(60)
    found = available(angle, tmp_path)["available_wob"]
    speed, spin = 60 * FT / 3600, 100 * math.pi / 30 * 0.07
    for operation, share in (("sliding", 1.0), ("drilling", speed / math.hypot(speed, spin))):
        expected = WEIGHT * LENGTH * (math.cos(angle) - share * FRICTION * math.sin(angle))
        assert found[operation]["wob"] == pytest.approx(expected, rel=2e-3)
        assert found[operation]["limited_by"] == "hook_load"
        assert found[operation]["item"] == "tubing" and found[operation]["md"] == pytest.approx(0.0, abs=1.0)


@pytest.mark.parametrize("block", [None, 60e3, 200e3, 500e3])
def test_a_level_string_is_pushed_by_the_block(block, tmp_path):
    """Drag mu w L = 94.5 kN: no weight without a block or with a light one; a heavier block less the drag, up to the helical load."""
    drag = FRICTION * WEIGHT * LENGTH
    found = available(math.pi / 2, tmp_path, block)["available_wob"]["sliding"]
    left = (block or 0.0) - drag
    if left <= 0:
        assert found["wob"] == 0.0 and found["limited_by"] == "hook_load"
    elif left < HELICAL - drag:
        assert found["wob"] == pytest.approx(left, rel=2e-3) and found["limited_by"] == "hook_load"
    else:
        assert found["wob"] == pytest.approx(HELICAL - drag, rel=2e-3) and found["limited_by"] == "helical"


def test_no_friction_and_no_hole(tmp_path):
    """Without friction all of w L cos I comes down, and both operations agree; without a hole there is no figure."""
    angle = math.radians(60)
    found = available(angle, tmp_path, friction=0.0)["available_wob"]
    for row in found.values():
        assert row["wob"] == pytest.approx(WEIGHT * LENGTH * math.cos(angle), rel=2e-3)
    bare = run_limits(Job(case([level_pipe(LENGTH, element_length=25.0)]), tmp_path / "bare")).summary
    assert bare["available_wob"] is None
