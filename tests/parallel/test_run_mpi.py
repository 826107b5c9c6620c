"""The same run on 1, 2 and 3 ranks."""

from __future__ import annotations

import json
import os
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.output import read_table
from tests.helpers.mpi import run_mpi
from tests.helpers.ranks import runs_on_ranks, same_histories
from tests.parallel.test_restart import CASE as WHIRL

ROOT = Path(__file__).parents[2]
EXACT = ["-ts_adapt_type", "none", "-ts_dt", "2e-3", "-q_snes_stol", "1e-12"]


@pytest.mark.parallel
def test_generalised_alpha_is_the_same_on_1_2_and_3_ranks(tmp_path):
    """Contact, mud, a bend and a jump of the top's motion (tests/parallel/test_restart.py), with fixed steps.

    After the jump at 60 ms the string strikes the wall, which multiplies rounding a thousandfold.
    """
    (tmp_path / "case.yaml").write_text(WHIRL)
    exact = ["1e-3" if word == "2e-3" else word for word in EXACT] + ["-ts_type", "alpha2"]
    folders = runs_on_ranks(tmp_path / "case.yaml", tmp_path, exact)
    same_histories(folders, share=5e-8, until=0.06)
    same_histories(folders, share=2e-6)


@pytest.mark.parallel
def test_a_second_with_contact_is_the_same_on_1_2_and_3_ranks(tmp_path):
    """Fixed steps and Newton to rounding: histories equal to 1e-8 of each column's size."""
    folders = runs_on_ranks(ROOT / "cases" / "lying-string.yaml", tmp_path, EXACT, timeout=300)
    same_histories(folders, share=5e-8)
    first, *others = (json.loads((out / "summary.json").read_text()) for out in folders)
    for other in others:
        assert other["steps"] == first["steps"]
        assert other["newton_iterations"] == pytest.approx(first["newton_iterations"], rel=0.02)
    assert os.path.getsize(tmp_path / "ranks3" / "checkpoint.h5") > 0


CURVE = """
well:
  survey: {md: [0 m, 700 m], inclination: [0 deg, 70 deg], azimuth: [20 deg, 60 deg]}
  sections: [{to: 700 m, kind: open_hole, diameter: 215.9 mm, friction: 0.2}]
string:
  - {kind: pipe, length: 299.5 m, od: 127 mm, id: 108.6 mm, element_length: 20 m}
  - {kind: bit, length: 0.5 m, od: 215.9 mm, mass: 60 kg}
top: {kind: top_drive, lowering: 0.5 m/s, rotation: 20 rpm}
bottom: free
initial: {from: statics}
time: {end: 0.2 s}
"""


@pytest.mark.parallel
def test_a_top_that_goes_down_a_curve_is_the_same_on_1_2_and_3_ranks(tmp_path):
    """Fixed steps and Newton to rounding: histories equal to 1e-8 of each column's size."""
    case, runs = tmp_path / "curve.yaml", []
    case.write_text(CURVE)
    for n in (1, 2, 3):
        out = tmp_path / f"ranks{n}"
        script = ROOT / "tests" / "parallel" / "run_case.py"
        run_mpi(n, script, [str(case), str(out), *EXACT], timeout=300)
        runs.append(read_table(out / "history.csv"))
    for other in runs[1:]:
        for column in ("hook_load [N]", "surface_torque [N m]", "bit_depth [m]"):
            size = np.abs(runs[0][column]).max()
            assert np.abs(other[column] - runs[0][column]).max() <= 5e-8 * size, column


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
