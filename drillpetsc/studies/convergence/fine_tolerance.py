"""Check of a run's tolerance: the same case at a tenth of it, classes of motion and main outputs compared.

Manual: sec-time-classes.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.arrays import FloatArray
from drillpetsc.case import Case
from drillpetsc.output import RunFolder, read_table
from drillpetsc.output.balances.time_error import SMALL_RANGE, smallest_range
from drillpetsc.output.files.tables import split_name
from drillpetsc.output.measured.motion_classes import changed_classes
from drillpetsc.solvers.time.scaled_tolerance import scaled_tolerance
from drillpetsc.studies.convergence.coarse_mesh import differences, second_run, with_estimate
from drillpetsc.studies.convergence.error_norms import extent
from drillpetsc.unit_systems import System, shown

REFINEMENT = 10.0  # tolerance of the run over the fine run's tolerance
FOLDER = "fine-tolerance"  # folder of the fine run, in the run's folder
LIMIT = 0.01  # difference of a mean or of a range, as a share of the range, from which on a run is warned of
MEANING = (
    "differences of the history columns between this run and one at a tenth of its tolerance, as shares of the column's range in the fine "
    "run (mean and range: of at least 0.1 % of the column's size), and classes of motion that differ in the second half of the runs"
)


def add_tolerance_check(
    case: Case, folder: Path, summary: dict[str, Any], name: str, progress: str = "silent"
) -> dict[str, Any]:
    """Run the case of a finished run at a tenth of its tolerance, and add the comparison to its summary.json
    (collective).

    case: case of the finished run, which was watched for classes of motion.
    folder: folder of the finished run; the fine run goes to ``folder``/fine-tolerance.
    summary: summary of the finished run.
    name: name of the case.

    Returns the summary with `error_estimate.tolerance` and its warnings.
    """
    with scaled_tolerance(summary["petsc_options"], 1 / REFINEMENT) as words:
        fine = second_run(case, folder, FOLDER, name, progress, watch_motion=True)
    check: dict[str, Any] = {"meaning": MEANING, "options": words, "steps": fine.summary["steps"]}
    check |= {"columns": {}, "changed": changed_classes(summary["motion"], fine.summary["motion"])}
    if PETSc.COMM_WORLD.rank == 0:
        tables = (read_table(RunFolder(f).history) for f in (folder, fine.folder))
        check["columns"] = compared(*tables)
    check = PETSc.COMM_WORLD.tompi4py().bcast(check)
    check["warnings"] = _warnings(check, case.shown_units)
    warnings = [*summary["warnings"], *check["warnings"]]
    return with_estimate(folder, summary, {"tolerance": check}, warnings=warnings)


def compared(
    history: Mapping[str, FloatArray], fine: Mapping[str, FloatArray]
) -> dict[str, dict[str, float]]:
    """Differences of two histories by column: max, rms, end, mean and range.

    As in ``coarse_mesh.differences``, but mean and range are shares of at least 0.1 % of the column's size: an
    almost constant load is not doubtful because of its small variation.
    """
    out = {}
    for title, column in differences(fine, history).items():
        values, reference = history[title], fine[title]
        if max(extent(values), column["range"]) <= smallest_range(split_name(title)[1]):
            continue
        scale = max(column["range"], SMALL_RANGE * float(np.abs(reference).max()))
        column["mean"] *= column["range"] / scale
        column["range_change"] = abs(extent(values) - extent(reference)) / scale
        out[title] = column
    return out


def _warnings(check: Mapping[str, Any], units: System) -> list[str]:
    """Sentences on changed classes, and on outputs that differ by more than the limit."""
    out = [
        f"a tolerance ten times finer changes the motion of {c['name']} at MD {shown(c['md [m]'], 'length', units, 6)}: {c['what']} is "
        f"'{c['is']}' there, '{c['was']}' in this run"
        for c in check["changed"]
    ]
    doubtful = [
        (split_name(title)[0], column["mean"], column["range_change"])
        for title, column in check["columns"].items()
        if max(column["mean"], column["range_change"]) > LIMIT
    ]
    if doubtful:
        doubtful.sort(key=lambda row: -max(row[1:]))
        named = ", ".join(f"{name} (mean {mean:.2g}, range {span:.2g})" for name, mean, span in doubtful[:4])
        out.append(f"a tolerance ten times finer changes, as shares of the range: {named}")
    return out


def tolerance_lines(summary: Mapping[str, Any]) -> list[str]:
    """Lines for the screen: changes by a finer tolerance."""
    check = summary["error_estimate"]["tolerance"]
    if check["warnings"]:
        return [f"  warning: {text}" for text in check["warnings"]] + [
            f"  tolerance: not fine enough; repeat with {check['options']} and check again"
        ]
    return [
        f"  tolerance, against {check['options']}: the same classes of motion, means and ranges of the history within {LIMIT:.0%}".replace(
            "%", " %"
        )
    ]
