"""A rigid item as the first of the string, on automatic elements, on 1, 2 and 3 ranks."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.ranks import runs_on_ranks, same_histories

ROOT = Path(__file__).parents[2]
CASE = """
well: {survey: {md: [0, 60], inclination: [0.5, 0.6], azimuth: [0, 0]},
       sections: [{to: 60, kind: casing, diameter: 0.2, friction: 0.2}]}
string:
  - {kind: stabilizer, length: 2, od: 0.19, mass: 100}
  - {kind: pipe, length: 30, od: 0.127, id: 0.1}
  - {kind: pipe, length: 9, od: 0.14, id: 0.07, element_length: 3}
material: {damping: {stiffness: 1.0e-3}}
top: {kind: top_drive, rotation: 6}
time: {end: 0.04}
output: {history_every: 0.02}
"""
EXACT = ["-ts_adapt_type", "none", "-ts_dt", "1e-3", "-q_snes_stol", "1e-12"]


@pytest.mark.parallel
def test_a_rigid_top_is_the_same_on_1_2_and_3_ranks(tmp_path):
    """Statics, then fixed steps with Newton to rounding: histories equal to 1e-7 of each column; the mesh does not
    depend on the number of ranks."""
    case = tmp_path / "rigid.yaml"
    case.write_text(CASE)
    same_histories(runs_on_ranks(case, tmp_path, EXACT), least=1e-3)
