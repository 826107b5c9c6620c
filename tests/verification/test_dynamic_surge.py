"""Surge while a string starts to move (`surge --dynamic`; manual: verif-dynamic-surge)."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.hydraulics import dynamic_surge as module
from drillpetsc.analysis.hydraulics import surge as command
from drillpetsc.analysis.hydraulics.dynamic_surge import dynamic_surge
from drillpetsc.analysis.hydraulics.flow_model import string_at
from drillpetsc.errors import SolveError
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from tests.helpers.mud import DENSITY, LENGTH, MUD, OPEN, RIGID, SOLID, hole
from tests.helpers.trips import trips_of
from tests.verification.test_tripping import friction, pipe

SHORT = 100.0  # [m]


def stiff_string(valve: bool = False) -> Case:
    return Case(
        string=[pipe() | {"axial_stiffness": 1e16}],
        top="clamped",
        bottom={"kind": "free", "plugged": not valve},
        contact="none",
        well=hole(LENGTH + 100),
        fluid={**MUD, **RIGID, "check_valve": valve},
    )


def short_string(**fluid) -> Case:
    return Case(
        string=[{"kind": "drill_pipe", "length": SHORT, "pipe": "5in 19.50 S-135 NC50"}],
        top="clamped",
        bottom="free",
        well=hole(SHORT),
        fluid=MUD | fluid,
    )


@pytest.mark.parametrize(("velocity", "pipe_state"), [(0.5, "closed"), (-0.5, "closed"), (0.5, "open")])
def test_start_of_a_stiff_string_in_stiff_mud(velocity, pipe_state, monkeypatch):
    """Closed, or open at the top and with a check valve, which shuts: friction at the trip speed and inertia of the mud, rho L (A_o/A_a) a with a = 0.3 m/s2, at the end of the acceleration; then friction.

    The string is a thousand times stiffer than elsewhere, so that its oscillation has died out by then.
    """
    case, sign = stiff_string(valve=pipe_state == "open"), np.sign(velocity)
    inertia = DENSITY * LENGTH * SOLID / OPEN * 0.3
    monkeypatch.setattr(module, "PASSAGES", 290.0)  # 2 s of them in this mud
    found = dynamic_surge(case, string_at(case, LENGTH), pipe_state, velocity)
    assert found.last == pytest.approx(LENGTH * friction(velocity), rel=2e-3)
    assert found.pressure == pytest.approx(LENGTH * friction(velocity) + sign * inertia, rel=0.01)
    assert found.time == pytest.approx(0.5 / 0.3, abs=0.05)


def test_a_check_valve_lets_mud_out_of_a_starting_string():
    """Pulled out, the string with a valve is the open one."""
    plain, valve = (
        dynamic_surge(c, string_at(c, SHORT), "open", -0.3)
        for c in (short_string(), short_string(check_valve=True))
    )
    assert valve.pressure == pytest.approx(plain.pressure, rel=1e-6)


@pytest.mark.parametrize(("speed", "pipe_state"), [(1e-4, "closed"), (3.0, "open"), (0.3, "pumping")])
def test_unlucky_speeds(speed, pipe_state):
    """Hardly moving, faster than a trip, a bit on bottom that runs in: a sign that fits, and a number."""
    case = short_string(flow_rate=0.02)
    for sign in (1.0, -1.0):
        found = dynamic_surge(case, string_at(case, SHORT), pipe_state, sign * speed, 0.02)
        assert np.isfinite(found.pressure) and sign * found.pressure > 0
        assert 0 < found.time <= module.duration(case, SHORT, speed)[1]


def test_columns_of_the_command(tmp_path: Path, monkeypatch):
    """Two more columns with --dynamic alone; a run that fails leaves them empty and says why."""
    case, trips = short_string(), {"speeds": "0.3 m/s", "operation": "trip_in", "pipe": "closed"}
    plain = command.run_surge(Job(case, tmp_path / "plain"), trips_of(**trips))
    assert not any("dynamic" in name for name in read_table(plain.folder / "surge.csv"))
    found = command.run_surge(Job(case, tmp_path / "dynamic"), trips_of(**trips, dynamic=True))
    table = read_table(found.folder / "surge.csv")
    assert table["dynamic_surge_pressure [Pa]"][0] > table["surge_pressure [Pa]"][0] > 0
    assert any("while the string starts" in line for line in found.lines)

    def fails(*_):
        raise SolveError("no step can be taken")

    monkeypatch.setattr(command, "dynamic_surge", fails)
    failed = command.run_surge(Job(case, tmp_path / "failed"), trips_of(**trips, dynamic=True))
    assert np.isnan(read_table(failed.folder / "surge.csv")["dynamic_surge_pressure [Pa]"]).all()
    assert any("no step can be taken" in line for line in failed.lines)
