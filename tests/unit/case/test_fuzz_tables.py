"""Mutants of tallies, and of surveys and logs in workbooks, are read as they are or refused: the changes of scripts/fuzz-tables."""

from __future__ import annotations

import random
import sys
from pathlib import Path

import pytest

pytest.importorskip("openpyxl")
sys.path.insert(0, str(Path(__file__).parents[3] / "scripts" / "tools"))
import fuzz_tables  # noqa: E402
from fuzz_judge import Failure  # noqa: E402


def test_no_mutant_is_guessed_or_crashes(tmp_path: Path) -> None:
    wrong, outcomes = [], set()
    for number in range(240):
        try:
            outcomes.add(fuzz_tables.try_one(number, 5, tmp_path))
        except Failure as failure:
            wrong.append((number, str(failure)))
    assert not wrong and outcomes == {"read", "refused"}


def test_the_judge_finds_a_guess(tmp_path: Path) -> None:
    """A tally that is read in another unit than it says fails, so that the fuzz can fail."""
    made = fuzz_tables.sheet(random.Random(1))
    path = tmp_path / "tally.csv"
    path.write_text("\n".join(made.separator.join(row) for row in made.cells()))
    text, _ = fuzz_tables.fragment([str(path)], tmp_path)
    fuzz_tables.judge_tally(made, text)
    made.truth[0]["length"] *= 3.28
    with pytest.raises(Failure, match="length"):
        fuzz_tables.judge_tally(made, text)
