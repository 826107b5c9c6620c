"""Random wells, strings, muds and operations, judged without references (manual: verif-physics-fuzz).

The cases are those of scripts/physics-fuzz, which tries many more.
"""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts" / "tools"))

from physics_fuzz import judged

# refused are pushes into level holes with friction 0.4 that lock up (46, 137), which were read
SEED, CASES, CHUNK = 1, 200, 10


@pytest.mark.parametrize("first", range(0, CASES, CHUNK))
def test_random_cases_are_right_or_refused_with_a_reason(first: int, tmp_path: Path) -> None:
    outcomes = [judged(SEED, number, tmp_path) for number in range(first, first + CHUNK)]
    wrong = [f"{o.number} ({o.title}): {o.problems}" for o in outcomes if o.kind == "wrong"]
    assert not wrong, "\n".join(wrong)
    refused = [o for o in outcomes if o.kind == "refused"]
    assert len(refused) <= 2 and all(len(o.problems[0]) > 20 for o in refused)
