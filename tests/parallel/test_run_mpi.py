"""The same run on 1, 2 and 3 ranks."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.helpers.mpi import run_mpi

ROOT = Path(__file__).parents[2]
EXACT = ["-ts_adapt_type", "none", "-ts_dt", "2e-3", "-q_snes_stol", "1e-12"]


@pytest.mark.parallel
def test_a_second_with_contact_is_the_same_on_1_2_and_3_ranks(tmp_path):
    """Fixed steps and Newton to rounding: histories equal to 1e-8 of each column's size."""
    runs = []
    for n in (1, 2, 3):
        out = tmp_path / f"ranks{n}"
        run_mpi(
            n,
            ROOT / "tests" / "parallel" / "run_case.py",
            [str(ROOT / "cases" / "lying-string.yaml"), str(out), *EXACT],
            timeout=300,
        )
        runs.append((read_table(out / "history.csv"), json.loads((out / "summary.json").read_text())))
    one = runs[0][0]
    for other, summary in runs[1:]:
        for column, values in one.items():
            if column.startswith(("energy_error", "newton", "step")):
                continue
            size = np.abs(values).max()
            assert np.abs(other[column] - values).max() <= 5e-8 * size, column
        assert summary["steps"] == runs[0][1]["steps"]
        assert summary["newton_iterations"] == pytest.approx(runs[0][1]["newton_iterations"], rel=0.02)
    assert os.path.getsize(tmp_path / "ranks3" / "checkpoint.h5") > 0


@pytest.mark.parallel
def test_no_rank_holds_the_whole_string(tmp_path):
    """Local sizes on 2 ranks are about half of the string, and so is the work of factorisation."""
    out = run_mpi(
        2,
        ROOT / "tests" / "parallel" / "local_sizes.py",
        [str(ROOT / "cases" / "vertical-2000m.yaml")],
        timeout=120,
    )
    words = [json.loads(line) for line in out.splitlines() if line.startswith("{")]
    assert len(words) == 2
    for w in words:
        assert w["unknowns"] <= 0.55 * w["all_unknowns"]
        assert w["elements"] <= 0.55 * w["all_elements"]
        assert w["values"] <= 0.55 * w["all_values"]
        assert w["factor_flops"] <= 0.55 * w["serial_flops"]
