"""The quick cases of the robustness suite. The criteria, with closed forms and sources, are in the modules of this
folder (manual: sec-verif-robustness).

scripts/extreme runs all cases.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from tests.robustness.cases import CASES, chosen
from tests.robustness.criteria import Run
from tests.robustness.run import Part, compute

CASE_FILES = Path(__file__).parents[2] / "cases" / "extreme"
QUICK = ["X02", "X10", "X14", "X18", "X21", "Y01", "Y03", "Y04"]


@pytest.mark.parametrize("number", QUICK)
def test_case_meets_its_criteria(number, tmp_path):
    (case,) = chosen([number])
    for part in case.parts:
        compute(part, CASE_FILES, tmp_path)
    rows = case.check({part.name: Run(tmp_path / part.name) for part in case.parts})
    assert not [row for row in rows if not row.passed]
    assert len(rows) > len(case.parts)


def test_every_case_file_belongs_to_the_suite():
    used = {part.case for case in CASES for part in case.parts}
    assert used == {path.stem for path in CASE_FILES.glob("*.yaml")}


def test_a_run_that_gains_energy_or_penetrates_the_wall_does_not_pass(tmp_path):
    """The common criteria detect changed results of a run that passes."""
    from tests.robustness.criteria import common

    part = Part("run", "x14-one-element-10m")
    compute(part, CASE_FILES, tmp_path)

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
