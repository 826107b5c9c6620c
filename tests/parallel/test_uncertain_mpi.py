"""Samples shared out over 1, 2 and 3 ranks."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.cli.test_limits_cli import CASE
from tests.cli.test_uncertain_cli import DENSITY, FRICTION, ROADMAP
from tests.helpers.command import succeeds
from tests.helpers.mpi import run_mpi

SURVEY = "  well.survey: {path: {inclination: 0.1 deg, lateral: 0.2 deg, length: 800 m}}\n"
SCRIPT = Path(__file__).with_name("run_command.py")


@pytest.mark.parallel
def test_same_file_on_1_2_and_3_ranks(tmp_path):
    """To the last bit, with a number of samples that 2 and 3 do not divide."""
    case = tmp_path / "small.yaml"
    case.write_text(CASE + ROADMAP + "uncertain:\n" + FRICTION + DENSITY + SURVEY)
    words = ["uncertain", str(case), "--samples", "25", "--out"]
    succeeds(*words, tmp_path / "1", cwd=tmp_path)
    for n in (2, 3):
        run_mpi(n, SCRIPT, [*words, str(tmp_path / str(n))])
    one, *others = [(tmp_path / str(n) / "uncertain.csv").read_bytes() for n in (1, 2, 3)]
    assert len(one) > 500
    assert all(other == one for other in others)
