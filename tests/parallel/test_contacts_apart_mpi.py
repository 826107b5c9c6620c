"""Contacts are renewed apart on several ranks, too (manual: sec-time-contact-entries)."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.helpers.mpi import have_mpi, run_mpi

pytestmark = [pytest.mark.parallel, pytest.mark.skipif(not have_mpi(), reason="no mpirun")]


@pytest.mark.parametrize("ranks", [1, 2, 3])
def test_factors_are_those_of_a_whole_elimination(ranks, tmp_path):
    """To the last bit, on a rank that eliminates a tail, on one that has no changed entry, and on the others."""
    script = Path(__file__).parent / "contacts_apart_mpi.py"
    out = run_mpi(ranks, script, ["cases/benchmark/coupled-2000m.yaml", str(tmp_path / "run")])
    assert f"renewed apart on {ranks} ranks" in out
