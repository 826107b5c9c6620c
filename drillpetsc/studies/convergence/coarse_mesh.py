"""Mesh error of a run, by a companion: the same case on elements twice as long, its history beside the
run's."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.case import Case
from drillpetsc.case.blocks.string import Flexible
from drillpetsc.output import RunFolder, read_summary, read_table, write_summary
from drillpetsc.output.files.tables import split_name
from drillpetsc.studies.convergence.error_norms import FloatArray, errors_of, extent, moves

COARSER = 2.0
FOLDER = "companion"
LEFT_OUT = ("time", "step", "newton", "energy_error")  # columns that tell of the computation, not of the well
MEANING = (
    "difference of the history columns between this run and one on elements twice as long, as shares of the column's range in this "
    "run: with a mesh error of order p this run's own is 1/(2^p - 1) of it.  Time errors of both are in it, too"
)


def coarser(case: Case, factor: float = COARSER) -> Case:
    """The case with its elements ``factor`` times as long; an item keeps at least one element."""
    items = [
        item.model_copy(update={"element_length": min(factor * item.element_length, item.length)})
        if isinstance(item, Flexible)
        else item
        for item in case.string
    ]
    return case.model_copy(update={"string": tuple(items)})


def add_companion(
    case: Case, folder: Path, summary: dict[str, Any], name: str, comm: Any = None, progress: str = "silent"
) -> dict[str, Any]:
    """Run the companion of a finished run in ``folder``/companion and state the differences in its
    summary.json; collective.

    Returns the summary with `error_estimate.mesh`.
    """
    from drillpetsc.analysis.transient import run

    other = run(
        coarser(case), folder / FOLDER, overwrite=True, name=f"{name}-{FOLDER}", comm=comm, progress=progress
    )
    reported = {"meaning": MEANING, "elements": other.summary["elements"], "columns": {}}
    here = comm is None or comm.rank == 0
    if here:
        reported["columns"] = differences(
            read_table(RunFolder(folder).history), read_table(RunFolder(other.folder).history)
        )
        whole = read_summary(RunFolder(folder).summary)
        whole["error_estimate"] = {**(whole.get("error_estimate") or {}), "mesh": reported}
        write_summary(RunFolder(folder).summary, whole)
    return {**summary, "error_estimate": {**(summary.get("error_estimate") or {}), "mesh": reported}}


def differences(
    history: Mapping[str, FloatArray], other: Mapping[str, FloatArray]
) -> dict[str, dict[str, Any]]:
    """By column: range [SI], and max, rms, end and mean difference as shares of it; rows at the same times
    are compared."""
    time = next(iter(history))
    rows, others = _common(history[time], other[next(iter(other))])
    out: dict[str, dict[str, Any]] = {}
    for title, column in history.items():
        if split_name(title)[0] in LEFT_OUT or title not in other:
            continue
        values, reference = other[title][others], column[rows]
        if len(reference) < 2 or not (np.isfinite(values).all() and np.isfinite(reference).all()):
            continue
        if moves(reference):
            out[title] = {"range": extent(reference), **errors_of(values, reference)}
    return out


def _common(a: FloatArray, b: FloatArray) -> tuple[np.ndarray, np.ndarray]:
    """Row numbers of the times (k,), (m,) [s] that stand in both."""
    _, rows, others = np.intersect1d(np.round(a, 9), np.round(b, 9), return_indices=True)
    return rows, others


def mesh_lines(summary: Mapping[str, Any]) -> list[str]:
    """For the screen: the largest differences."""
    columns = summary["error_estimate"]["mesh"]["columns"]
    worst = sorted(columns.items(), key=lambda pair: -pair[1]["rms"])[:4]
    return [
        "  mesh, against elements twice as long (rms / range): "
        + ", ".join(f"{split_name(t)[0]} {c['rms']:.2g}" for t, c in worst)
    ]
