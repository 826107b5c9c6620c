"""Sums over ranks (drillpetsc.parallel) on 1 to 4 ranks."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.mpi import have_mpi, run_mpi

pytestmark = pytest.mark.skipif(not have_mpi(), reason="no mpirun")


@pytest.mark.parametrize("ranks", [1, 2, 3, 4])
def test_totals(ranks):
    """Sum, largest value and condition: right, the same bits on every rank, also where one rank has not a number."""
    assert f"agree on {ranks} ranks" in run_mpi(ranks, Path(__file__).parent / "totals_mpi.py")
