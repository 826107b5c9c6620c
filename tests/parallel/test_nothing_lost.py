"""Short versions of scripts/damage-runs and scripts/kill-test, which try many more."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts" / "tools"))

import damage_runs
import kill_test


def test_no_damage_of_a_run_is_continued_without_a_word(capsys) -> None:
    """Rows dropped, doubled, swapped or changed, files cut, bits turned in tables, checkpoint, frames and their list."""
    assert damage_runs.main(["--changes", "40", "--seed", "3"]) == 0, capsys.readouterr().out


@pytest.mark.slow
def test_a_signal_at_a_random_moment_is_survived(capsys) -> None:
    assert kill_test.main(["--kills", "1", "--seed", "3"]) == 0, capsys.readouterr().out
