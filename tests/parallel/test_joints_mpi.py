"""A string with joints on 1, 2 and 3 ranks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.helpers.ranks import runs_on_ranks, same_histories

ROOT = Path(__file__).parents[2]
CASE = """
well: {survey: {md: [0, 40], inclination: [0.5, 0.5], azimuth: [0, 0]},
       sections: [{to: 40, kind: casing, diameter: 0.2, friction: 0.2}]}
string:
  - {kind: pipe, length: 9, od: 0.127, id: 0.1, element_length: 3}
  - {kind: stabilizer, length: 0.4, od: 0.19, mass: 40, unbalance: 0.05}
  - {kind: pipe, length: 9, od: 0.127, id: 0.1, element_length: 3}
  - {kind: body, length: 0.5, mass: 30, od: 0.15}
  - {kind: pipe, length: 6, od: 0.127, id: 0.1, element_length: 3}
joints:
  - {at: 3, kind: revolute, axis: [0, 1, 1], constraint: stabilised}
  - {at: 9.4, kind: universal, constraint: stabilised}
  - {at: 15.4, kind: slider, spring: 1e6, damping: 1e3}
  - {at: 18.4, kind: universal}
material: {damping: {stiffness: 1.0e-3}}
top: {kind: top_drive, rotation: 6}
time: {end: 0.04}
output: {history_every: 0.02}
"""
MUD = """
fluid: {density: 1200, rheology: {model: newtonian, viscosity: 0.02}, flow_rate: {time: [0, 0.02, 0.04], value: [0.01, 0.01, 0.02]}}
"""
EXACT = ["-ts_adapt_type", "none", "-ts_dt", "1e-3", "-q_snes_stol", "1e-12"]


@pytest.mark.parallel
@pytest.mark.parametrize("mud", [False, True])
def test_joints_are_the_same_on_1_2_and_3_ranks(mud, tmp_path):
    """Statics, then fixed steps with Newton to rounding: histories, with the reactions of the joints, equal
    to 1e-7 of each column.

    Three ranks have common nodes above a stabilised joint and below another.
    """
    case = tmp_path / "joints.yaml"
    sealed = CASE.replace("damping: 1e3}", "damping: 1e3, seal_area: 50 cm2}") + MUD
    case.write_text(sealed if mud else CASE)
    one = same_histories(runs_on_ranks(case, tmp_path, EXACT), least=1e-3)
    assert np.abs(one["joint_15.4_force [N]"]).min() > 100.0
