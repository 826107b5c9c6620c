"""Mutants of logs are read as they are, or refused: the changes of scripts/fuzz-logs, which tries very many more."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[3] / "scripts" / "tools"))
import fuzz_logs  # noqa: E402
from fuzz_judge import Failure  # noqa: E402


def test_no_mutant_is_guessed_or_crashes(tmp_path):
    wrong = []
    outcomes = set()
    for number in range(400):
        try:
            outcomes.add(fuzz_logs.try_one(number, 3, tmp_path))
        except Failure as failure:
            wrong.append((number, str(failure)))
    assert not wrong and outcomes == {"read", "refused"}


def test_the_judge_finds_a_guess(tmp_path):
    """A log that is read in another unit than it says fails, so that the fuzz can fail."""
    import random

    made = fuzz_logs.table(random.Random(1))
    path = tmp_path / "log.csv"
    path.write_text(made.text())
    log = fuzz_logs.read_log([path])
    fuzz_logs.judge(made, log)
    made.truth["torque"] = made.truth["torque"] * 1.3558
    with pytest.raises(Failure, match="torque"):
        fuzz_logs.judge(made, log)
