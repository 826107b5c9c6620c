"""A bent motor that drills in mud: restarts bit for bit, and several ranks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import load_case
from drillpetsc.analysis.transient import run
from tests.helpers.ranks import FIXED, runs_on_ranks, same_histories
from tests.parallel.test_restart import files, run_with_copies

#: the joint of the motor lies between ranks of three; the rotor is out of balance
CASE = """
well:
  survey: {md: [0 m, 60 m], inclination: [40 deg, 45 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 60 m, kind: open_hole, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 30 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}
  - kind: pdm
    length: 29.7 m
    od: 171.5 mm
    id: 90 mm
    element_length: 10 m
    joint_at: 15.7 m
    bend: {angle: 0.5 deg, position: 20 m, tool_face: 40 deg}
    pdm: {rev_per_volume: 0.29 rev/gal, no_load_pressure: 0.6 MPa, stall_torque: 14 kN m, lobes: [5, 6], rotor_mass: 300 kg,
      eccentricity: 6 mm, rotor_inertia: 3 kg m2}
  - {kind: bit, length: 0.3 m, od: 215.9 mm, mass: 60 kg, nozzle_area: 400 mm2}
top: {kind: top_drive, rotation: {ramp: 0.5 s, value: 30 rpm}, lowering: 20 m/h}
bottom: {kind: bit}
fluid: {density: 1200 kg/m3, rheology: {model: newtonian, viscosity: 20 mPa s}, flow_rate: 25 l/s}
formation: {drillability: 4.0e-8}
initial: {from: statics, wob: 30 kN}
time: {end: 0.1 s}
petsc: {q_snes_stol: 1.0e-10}
output: {history_every: 5 ms, field_every: 50 ms, checkpoint_every: 7 ms}
"""


@pytest.fixture(scope="module")
def case(tmp_path_factory) -> Path:
    path: Path = tmp_path_factory.mktemp("case") / "case.yaml"
    path.write_text(CASE)
    return path


def test_restarts_reproduce_the_run(case, tmp_path, monkeypatch):
    copies = run_with_copies(case, tmp_path / "run", monkeypatch)
    whole = files(tmp_path / "run")
    for copy in copies[:: max(1, len(copies) // 4)]:
        run(load_case(case), copy, restart=True, progress="silent")
        assert files(copy) == whole


@pytest.mark.parallel
def test_ranks_agree(case, tmp_path):
    """Fixed steps on two and three ranks, against one."""
    rounding = ("joint_45.7_torque", "joint_45.7_angle", "joint_45.7_travel")
    one = same_histories(runs_on_ranks(case, tmp_path, FIXED), without=rounding)
    assert 5 < one["motor_speed [rad/s]"].min() < one["motor_speed [rad/s]"].max() < 15
    assert np.ptp(one["tool_face [rad]"]) > 1e-4
