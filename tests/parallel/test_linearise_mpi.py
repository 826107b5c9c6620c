"""A linear model is the same on any number of ranks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import drillpetsc
from tests.helpers.mpi import have_mpi, run_mpi

CASE = """
well:
  survey: {md: [0 m, 110 m], inclination: [90 deg, 90 deg], azimuth: [0 deg, 0 deg]}
  sections: [{to: 110 m, kind: casing, diameter: 216 mm, friction: 0.2}]
string: [{kind: pipe, length: 100 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}]
material: {damping: {stiffness: 1.0e-3 s}}
top: {kind: top_drive, rotation: 60 rpm, motor: {inertia: 500 kg m2}, control: {kind: pi, p: 2000 N m s/rad, i: 3000 N m/rad}}
"""
OUTPUTS = ["bit_speed", "motor_torque", "surface_torque"]


@pytest.mark.parallel
@pytest.mark.skipif(not have_mpi(), reason="no mpirun")
@pytest.mark.parametrize("ranks", [2, 3])
def test_a_lying_string_in_contact(ranks, tmp_path):
    """Responses of one rank and of several: 1e-5 of the largest (differences of the outputs, sums in another order)."""
    (tmp_path / "case.yaml").write_text(CASE)
    one = drillpetsc.linearise(tmp_path / "case.yaml", ["top.rotation"], OUTPUTS, tmp_path / "one")
    assert any("11 contacts" in line or "10 contacts" in line for line in one.lines)
    words = [
        "linearise", str(tmp_path / "case.yaml"), "--inputs", "top.rotation", "--outputs", ",".join(OUTPUTS),
    ]  # fmt: skip
    run_mpi(ranks, Path(__file__).parent / "run_command.py", [*words, "--out", str(tmp_path / "many")])
    a, b = (np.load(tmp_path / name / "linear.npz")["response"] for name in ("one", "many"))
    assert np.all(np.abs(a - b).max(axis=(0, 2)) < 1e-5 * np.abs(a).max(axis=(0, 2)))
