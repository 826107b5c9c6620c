"""The parallel matrix: every row of `matrix.py` on 1, 2 and 3 ranks, and restarted from its checkpoints bit for bit."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.helpers.mpi import have_mpi
from tests.helpers.ranks import OTHERWISE, all_on_ranks, same_histories
from tests.helpers.restarts import restarted_is_identical
from tests.helpers.tables import each_row
from tests.parallel.matrix import ROWS

ON_RANKS = [name for name, row in ROWS.items() if row.ranks is not None]


@pytest.mark.parallel
@pytest.mark.skipif(not have_mpi(), reason="no mpirun")
def test_ranks_agree(tmp_path):
    """Histories on two and three ranks against one, within the share of the row; and something moves."""
    jobs = {
        name: (ROWS[name].written(tmp_path, f"case{k}"), ROWS[name].ranks) for k, name in enumerate(ON_RANKS)
    }
    folders = all_on_ranks(jobs, tmp_path)

    @each_row("name", ON_RANKS)
    def agree(name):
        row = ROWS[name]
        history = same_histories(folders[name], row.share, row.least, without=row.without)
        assert [c for c, v in history.items() if np.ptp(v) > 0 and not c.startswith(("time", *OTHERWISE))]
        row.shows(folders[name], history)

    agree()


@pytest.mark.parametrize("name", [name for name, row in ROWS.items() if row.restarts])
def test_restarts_reproduce_the_run(name, tmp_path, monkeypatch):
    """Every file of a run continued from a checkpoint is that of the run that was not interrupted."""
    row = ROWS[name]
    run = restarted_is_identical(row.written(tmp_path), tmp_path, monkeypatch, row.restarts, row.checkpoints)
    row.shows([run], read_table(run / "history.csv"))
