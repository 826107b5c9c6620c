"""Mesh error of a run, estimated by a coarse-mesh run: the same case with elements twice as long."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.arrays import FloatArray
from drillpetsc.case import Case
from drillpetsc.model.mesh import coarsened
from drillpetsc.output import RunFolder, read_summary, read_table, write_summary
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.job import RunResult
from drillpetsc.studies.convergence.error_norms import NUMERICS, errors_of, extent, moves

COARSENING = 2.0  # element length of the coarse-mesh run over the run's element length
FOLDER = "coarse-mesh"  # folder of the coarse-mesh run, in the run's folder
MEANING = (
    "difference of the history columns between this run and one on elements twice as long, as shares of the column's range in this "
    "run: with a mesh error of order p this run's own is 1/(2^p - 1) of it.  It includes the time errors of both"
)


def add_mesh_error(
    case: Case, folder: Path, summary: dict[str, Any], name: str, progress: str = "silent"
) -> dict[str, Any]:
    """Run the case of a finished run on a coarse mesh, and add the differences to its summary.json
    (collective).

    case: case of the finished run.
    folder: folder of the finished run; the coarse-mesh run goes to ``folder``/coarse-mesh.
    summary: summary of the finished run.
    name: name of the case.

    Returns the summary with `error_estimate.mesh`.
    """
    coarse = second_run(coarsened(case, COARSENING), folder, FOLDER, name, progress)
    mesh = {"meaning": MEANING, "elements": coarse.summary["elements"], "columns": {}}
    if PETSc.COMM_WORLD.rank == 0:
        mesh["columns"] = differences(*(read_table(RunFolder(f).history) for f in (folder, coarse.folder)))
    return with_estimate(folder, summary, {"mesh": mesh})


def second_run(
    case: Case, folder: Path, inner: str, name: str, progress: str, watch_motion: bool = False
) -> RunResult:
    """Run a case again, in the folder ``inner`` of the run in ``folder`` (collective).  name: of the case."""
    from drillpetsc.analysis.motion.transient import run

    out = folder / inner
    return run(
        case, out, overwrite=True, name=f"{name}-{inner}", progress=progress, watch_motion=watch_motion
    )


def with_estimate(
    folder: Path, summary: dict[str, Any], found: dict[str, Any], **added: Any
) -> dict[str, Any]:
    """The summary of the run in ``folder`` with more entries of `error_estimate`, and other keys; its file, too."""
    added["error_estimate"] = {**(summary.get("error_estimate") or {}), **found}
    if PETSc.COMM_WORLD.rank == 0:
        file = RunFolder(folder).summary
        write_summary(file, read_summary(file) | added)
    return {**summary, **added}


def differences(
    history: Mapping[str, FloatArray], other: Mapping[str, FloatArray]
) -> dict[str, dict[str, Any]]:
    """Differences of two histories by column: range [SI], and max, rms, end and mean difference as shares of
    it. Rows at equal times are compared."""
    time = next(iter(history))
    rows, others = _common(history[time], other[next(iter(other))])
    out: dict[str, dict[str, Any]] = {}
    for title, column in history.items():
        if split_name(title)[0] in NUMERICS or title not in other:
            continue
        values, reference = other[title][others], column[rows]
        if len(reference) < 2 or not (np.isfinite(values).all() and np.isfinite(reference).all()):
            continue
        if moves(reference):
            out[title] = {"range": extent(reference), **errors_of(values, reference)}
    return out


def _common(a: FloatArray, b: FloatArray) -> tuple[np.ndarray, np.ndarray]:
    """Row numbers of the times (k,), (m,) [s] that both have."""
    _, rows, others = np.intersect1d(np.round(a, 9), np.round(b, 9), return_indices=True)
    return rows, others


def mesh_lines(summary: Mapping[str, Any]) -> list[str]:
    """Lines for the screen: the largest differences."""
    columns = summary["error_estimate"]["mesh"]["columns"]
    worst = sorted(columns.items(), key=lambda pair: -pair[1]["rms"])[:4]
    return [
        "  mesh, against elements twice as long (rms / range): "
        + ", ".join(f"{split_name(t)[0]} {c['rms']:.2g}" for t, c in worst)
    ]
