"""A string of fewer elements than ranks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_series, read_table
from tests.helpers.mpi import have_mpi, run_mpi

RUN = Path(__file__).parent / "run_command.py"
pytestmark = [pytest.mark.parallel, pytest.mark.skipif(not have_mpi(), reason="no mpirun")]


CASE = """
title: Two elements
string: [{kind: pipe, length: 20 m, od: 127 mm, id: 108.6 mm, element_length: 10 m}]
material: {young: 206 GPa, poisson: 0.3, density: 7850 kg/m3}
top: {kind: top_drive, rotation: {ramp: 2 s, value: 80 rpm}}
bottom: free
gravity: 9.81 m/s2
time: {end: 0.05 s}
output: {history_every: 0.01 s, field_every: 0.02 s}
"""


def test_ranks_without_an_element(tmp_path):
    """Two elements on four ranks: a run with frames gives what two ranks give, to rounding."""
    (tmp_path / "case.yaml").write_text(CASE)
    rows = []
    for ranks in (2, 4):
        run_mpi(ranks, RUN, ["run", str(tmp_path / "case.yaml"), "--out", str(tmp_path / str(ranks))])
        history = read_table(tmp_path / str(ranks) / "history.csv")
        rows.append([history["hook_load [N]"], history["surface_torque [N m]"]])
        assert len(read_series(tmp_path / str(ranks))) == 3
    assert np.allclose(rows[0], rows[1], rtol=1e-9, atol=1e-9)
