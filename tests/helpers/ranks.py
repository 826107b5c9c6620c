"""The same run on 1 rank in this process, and on 2 and 3 by mpirun: a start takes longer than a short run."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from drillpetsc.output import read_table
from tests.helpers.command import ROOT, drillpetsc
from tests.helpers.mpi import run_mpi

SCRIPT = Path(__file__).parents[1] / "parallel" / "run_cases.py"
OTHERWISE = ("energy_error", "newton", "step")  # columns about the computation, not about the string


def run_here(case: object, out: object, options: Sequence[str]) -> None:
    done = drillpetsc("run --progress silent", case, "--out", out, *options, cwd=ROOT)
    assert done.returncode == 0, done.stderr


def all_on_ranks(
    jobs: dict[str, tuple[Path, tuple[str, ...]]], folder: Path, timeout: float = 400
) -> dict[str, list[Path]]:
    """Run folders of many cases on 1, 2 and 3 ranks, by name; the start of a job costs as much as a short run.

    jobs: file of the case, and PETSc's options of its runs.
    """
    folders: dict[str, list[Path]] = {name: [] for name in jobs}
    for n in (1, 2, 3):
        rows = []
        for k, (name, (case, options)) in enumerate(jobs.items()):
            folders[name].append(folder / f"case{k}-ranks{n}")
            rows.append([str(case), str(folders[name][-1]), options])
        if n == 1:
            for file, out, given in rows:
                run_here(file, out, given)
            continue
        (folder / "jobs.json").write_text(json.dumps(rows))
        run_mpi(n, SCRIPT, [str(folder / "jobs.json")], timeout=timeout)
    return folders


def same_histories(
    folders: list[Path],
    share: float = 1e-7,
    least: float = 0.0,
    until: float = np.inf,
    without: tuple[str, ...] = (),
    table: str = "history.csv",
) -> dict[str, np.ndarray]:
    """Columns of the first history; asserts that those of the others differ by ``share`` of the largest value at most.

    least: largest values below it count as it; until: time of the last row compared [s]; without: beginnings of the names of
    columns that are rounding; table: file of the run folders.
    """
    one, *others = (read_table(folder / table) for folder in folders)
    rows = one["time [s]"] <= until
    for other in others:
        assert list(other) == list(one)
        for name, values in one.items():
            if not name.startswith((*OTHERWISE, *without)):
                difference = np.abs(other[name] - values)[rows].max()
                assert difference <= share * max(np.abs(values).max(), least), name
    return one
