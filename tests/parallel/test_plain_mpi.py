"""The assembled system on several ranks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.parallel.launch import run_mpi

SCRIPT = Path(__file__).with_name("run_plain.py")


@pytest.mark.parallel
def test_other_integrators_agree_on_1_2_and_3_ranks():
    """Same steps, systems solved to rounding: position [m] and spin [rad] of the lower end agree to 1e-10."""
    runs = []
    for n in (1, 2, 3):
        lines = run_mpi(n, SCRIPT, ["bdf", "theta", "rosw", "arkimex"]).splitlines()
        runs.append(np.array([[float(w) for w in line.split()[2:]] for line in lines if line.startswith("END")]))
    assert runs[0].shape == (4, 4)
    for other in runs[1:]:
        assert np.abs(other - runs[0]).max() < 1e-10
