"""What ranks hold of a string, and when they write."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.helpers.mpi import run_mpi

ROOT = Path(__file__).parents[2]


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


@pytest.mark.parallel
@pytest.mark.parametrize("ranks", [2, 3])
def test_files_do_not_depend_on_how_many_steps_are_evaluated_together(ranks, tmp_path):
    """To the byte, and the ranks agree on when rows that have waited are written."""
    script = ROOT / "tests" / "parallel" / "steps_together_mpi.py"
    assert f"same files on {ranks} ranks" in run_mpi(ranks, script, [str(tmp_path)])
