"""The quick ones of the extreme scenes, with the criteria of drillpetsc.extreme_* (closed forms and their
sources stand there).

scripts/extreme runs them all.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.robustness.criteria import Run
from tests.robustness.run import compute
from tests.robustness.scenes import SCENES, Part, chosen

CASES = Path(__file__).parents[2] / "cases" / "extreme"
QUICK = ["X02", "X10", "X14", "X18", "X21", "Y01", "Y03", "Y04"]


@pytest.mark.parametrize("number", QUICK)
def test_scene_meets_its_criteria(number, tmp_path):
    (model,) = chosen([number])
    for part in model.parts:
        compute(part, CASES, tmp_path)
    rows = model.check({part.name: Run(tmp_path / part.name) for part in model.parts})
    assert not [row for row in rows if not row.passed]
    assert len(rows) > len(model.parts)


def test_every_case_belongs_to_a_scene():
    used = {part.case for model in SCENES for part in model.parts}
    assert used == {path.stem for path in CASES.glob("*.yaml")}


def test_a_run_that_gains_energy_or_sinks_in_does_not_pass(tmp_path):
    """The common criteria see what they are there for: numbers spoiled in the files of a run that passes."""
    from tests.robustness.criteria import common

    part = Part("run", "x14-one-element-10m")
    compute(part, CASES, tmp_path)

    def missed(**change) -> list[str]:
        run = Run(tmp_path / "run")
        run.__dict__.update({name: value(getattr(run, name)) for name, value in change.items()})
        return [row.criterion.split(": ")[1].split(" [")[0] for row in common("X14", run) if not row.passed]

    assert missed() == []
    assert missed(summary=lambda s: s | {"energy": s["energy"] | {"gained_share": 0.02}}) == [
        "energy gained / exchanged"
    ]
    assert missed(summary=lambda s: s | {"rejected_steps": 4 * s["steps"]}) == ["rejected / accepted steps"]
    assert missed(history=lambda h: h | {"hook_load": h["hook_load"] * np.nan}) == ["finite"]
    assert missed(penetration=lambda p: p + 0.05 * (np.arange(len(p)) > 0)[:, None]) == [
        "penetration at the frames"
    ]
    assert missed(summary=lambda s: s | {"status": "failed: x"}) == ["done"]
