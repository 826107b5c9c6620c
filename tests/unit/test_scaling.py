"""Pictures of times and speed-ups (scripts/scaling): the cases that are timed, and the files that are drawn."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from drillpetsc.case import load_case
from drillpetsc.model.drilling_model import build_model

sys.path.insert(0, str(Path(__file__).parents[2] / "scripts" / "tools"))
import scaling  # noqa: E402


@pytest.mark.parametrize("elements", [600, 1200])
def test_the_case_has_the_elements_asked_for(elements, tmp_path):
    """Within one in a hundred: pipe and collars are divided on their own; the time is the given one."""
    case = load_case(scaling.case_file(tmp_path, elements, 0.25))
    assert case.time is not None and case.time.end == 0.25
    model = build_model(case)
    assert int((~model.mesh.is_joint).sum()) == pytest.approx(elements, rel=0.01)


def test_pictures_are_drawn(tmp_path):
    calls = dict.fromkeys(scaling.PHASES, 0.001)
    stored = {
        "phases": [{"elements": n, "calls": calls, "step": 1e-2} for n in (2400, 600)],
        "ranks": [{"elements": 2399, "ranks": p, "step": 1e-2 / p} for p in (1, 2)],
    }
    for file in scaling.draw(stored, tmp_path / "pictures"):
        assert file.read_bytes().startswith(b"\x89PNG") and file.stat().st_size > 10_000
