"""Calls, bytes and operations of a run on 1, 2 and 3 ranks against the model behind the line of ``check``."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.mpi import have_mpi, run_mpi

pytestmark = [pytest.mark.parallel, pytest.mark.skipif(not have_mpi(), reason="no mpirun")]


@pytest.mark.parametrize("ranks", [1, 2, 3])
def test_counts_of_the_model(ranks, tmp_path):
    """46 elements with mud: sums within 15 %, exchanges and gathers within 5 %, operations of the busiest rank within 15 %."""
    script = Path(__file__).parent / "rank_counts_mpi.py"
    assert f"agree on {ranks} ranks" in run_mpi(ranks, script, [str(tmp_path / "run")])
