"""A jar that meters, fires and hits: restarts bit for bit, and several ranks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import load_case
from drillpetsc.analysis.transient import run
from drillpetsc.output import read_table
from tests.helpers.mpi import run_mpi
from tests.parallel.test_restart import files, run_with_copies

SCRIPT = Path(__file__).parent / "run_case.py"
CASE = """
string:
  - {kind: pipe, length: 10 m, od: 177.8 mm, id: 71.4 mm, element_length: 5 m}
  - {kind: jar, length: 2 m, od: 177.8 mm, id: 71.4 mm, jar: {stroke: 40 mm, threshold: 15 kN, metering_stroke: 2 mm, metering_resistance: 100 kN s/m}}
  - {kind: pipe, length: 5 m, od: 177.8 mm, id: 71.4 mm, element_length: 5 m}
  - {kind: body, length: 0.5 m, mass: 2 t}
top: clamped
material: {damping: {stiffness: 1.0e-3}}
time: {end: 0.14 s}
petsc: {ts_type: KIND, q_snes_stol: 1.0e-11}
output: {history_every: 2 ms, field_every: 50 ms, checkpoint_every: 9 ms}
"""


@pytest.fixture(scope="module", params=["bdf", "alpha2"])
def case(request, tmp_path_factory) -> Path:
    path: Path = tmp_path_factory.mktemp("case") / "case.yaml"
    path.write_text(CASE.replace("KIND", request.param))
    return path


def test_restarts_reproduce_the_run(case, tmp_path, monkeypatch):
    copies = run_with_copies(case, tmp_path / "run", monkeypatch)
    whole = files(tmp_path / "run")
    found = read_table(tmp_path / "run" / "history.csv")
    assert set(found["jar_state [-]"]) == {0, 1, 2} and found["jar_impact_force [N]"].max() > 1e5
    for copy in copies[:: max(1, len(copies) // 5)]:
        run(load_case(case), copy, restart=True, progress="silent")
        assert files(copy) == whole


@pytest.mark.parallel
def test_ranks_agree(case, tmp_path):
    """Two and three ranks, against one: within 1e-6 of the largest value of each column.

    Generalised-alpha: 2e-5.  Its accelerations are differences of positions of 17 m, which are rounded to 2e-15 m, over half a step squared.
    Up to an event it takes steps of 1 us: 4e-3 m/s2 of noise, 1e-5 of those of a shot.  How much of it a table shows hangs on the order of sums
    (1e-7 to 7e-6 were seen), not on Newton's tolerance.
    """
    limit = 2e-5 if "alpha2" in case.read_text() else 1e-6
    run(load_case(case), tmp_path / "1", progress="silent")
    one = read_table(tmp_path / "1" / "history.csv")
    for n in (2, 3):
        run_mpi(n, SCRIPT, [str(case), str(tmp_path / str(n))], timeout=120)
        other = read_table(tmp_path / str(n) / "history.csv")
        for column, values in one.items():
            if not column.startswith(("energy_error", "newton", "step")):
                assert np.abs(other[column] - values).max() <= limit * max(np.abs(values).max(), 1e-3), column
