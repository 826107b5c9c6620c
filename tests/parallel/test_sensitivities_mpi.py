"""Derivatives on 1, 2 and 3 ranks."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from tests.helpers.command import succeeds
from tests.helpers.mpi import ROOT, run_mpi

SCRIPT = Path(__file__).with_name("run_commands.py")
CASES = {
    "cases/verification/p16-j-well.yaml": (
        "well.sections[0].friction,string[0].material.density",
        "--motion",
        "hoist",
    ),
    "cases/directional.yaml": ("well.sections[0].friction,material.density,fluid.density,initial.wob",),
    "cases/stick-slip-2000m.yaml": (
        "formation.bit_law.static,string[0].od,top.rotation.value,material.density",
        *(
            "--analysis",
            "run",
            "--set",
            "time.end=2 s",
            "--of",
            "surface_torque.mean,bit_speed.max,hook_load.final",
        ),
    ),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Run folders of the cases by number of ranks and case: one job on each number."""
    made = tmp_path_factory.mktemp("sensitivities")
    for n in (1, 2, 3):
        lines = []
        for case, (keys, *words) in CASES.items():
            out = made / str(n) / Path(case).stem
            lines.append(["sensitivities", str(ROOT / case), "--to", keys, *words, "--out", str(out)])
        if n == 1:
            for line in lines:
                succeeds(*line, cwd=made)
        else:
            (made / "jobs.json").write_text(json.dumps(lines))
            run_mpi(n, SCRIPT, [str(made / "jobs.json")])
    return made


@pytest.mark.parallel
@pytest.mark.parametrize("case", CASES)
def test_equal_on_1_2_and_3_ranks(case, folder):
    """Relative derivatives of hook load and torque agree to 1e-5: those of the residual have a rounding of 1e-7 over a small step."""
    found = []
    for n in (1, 2, 3):
        rows = json.loads((folder / str(n) / Path(case).stem / "summary.json").read_text())["sensitivities"]
        found.append({(row["output"], row["key"]): row["relative"] for row in rows if row["relative"]})
    assert len(found[0]) >= 2
    for other in found[1:]:
        assert other.keys() == found[0].keys()
        assert np.abs([other[k] - found[0][k] for k in other]).max() < 1e-5
