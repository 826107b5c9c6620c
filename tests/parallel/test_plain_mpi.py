"""The first-order system on several ranks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import petsc_compat
from tests.helpers.mpi import run_mpi

SCRIPT = Path(__file__).with_name("run_plain.py")


@pytest.mark.parallel
def test_other_integrators_are_the_same_on_1_2_and_3_ranks():
    """Equal steps, systems solved to rounding: position [m] and spin [rad] of the lower end equal to
    1e-10."""
    # arkimex of newer PETSc is of first order with prescribed rows (test_dynamics_integrators.py), and its
    # solves fail in parallel
    kinds = ["bdf", "theta", "rosw"] + ["arkimex"] * (petsc_compat.VERSION < (3, 19, 0))
    runs = []
    for n in (1, 2, 3):
        lines = run_mpi(n, SCRIPT, kinds).splitlines()
        runs.append(
            np.array([[float(w) for w in line.split()[2:]] for line in lines if line.startswith("END")])
        )
    assert runs[0].shape == (len(kinds), 4)
    for other in runs[1:]:
        assert np.abs(other - runs[0]).max() < 1e-10
