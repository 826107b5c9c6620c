"""Convergence study: error against run time of a case; `drillpetsc study`.

From Python: ``study("case.yaml", vary="time-step").rows``.
"""

from __future__ import annotations

import math
import os
import platform
import shutil
import sys
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.linear.linearise import refuse_unknown
from drillpetsc.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import RunFolder
from drillpetsc.output.progress import duration
from drillpetsc.output.recorder import Recorder
from drillpetsc.studies.convergence.plan import (
    VARIED,
    Base,
    Point,
    case_of,
    plan_curves,
    plan_of,
    read_base,
)
from drillpetsc.studies.convergence.reference import Exact, Reference, StudyRuns, find_reference
from drillpetsc.studies.convergence.report import findings, table_rows, write_results
from drillpetsc.studies.convergence.runs import Measured, Runner, measure, outputs_of, ranks_here, run_process

LIMIT = 600.0  # longest wall time of one run [s]
REPEATS = 3  # runs of each point


@dataclass(frozen=True)
class StudyResult:
    """Result of a study.

    folder: folder of study.csv, study.json and the pictures.
    rows: one per point.
    findings: the content of study.json.
    files: the files written.
    """

    folder: Path
    rows: tuple[dict[str, Any], ...]
    findings: dict[str, Any]
    files: tuple[Path, ...]

    @property
    def failed(self) -> int:
        """Number of points that are not done."""
        return sum(row["status"] != "done" for row in self.rows)

    @property
    def useless(self) -> bool:
        """Whether no point or no reference was completed."""
        return self.failed == len(self.rows) or self.findings["reference"] is None


@dataclass(frozen=True)
class StudyRequest:
    """The runs and comparisons of a study.

    case: a Case, or the path of a case file.
    vary: the one thing that varies (VARIED); or
    curves: names of the curves (an empty list for DEFAULT_CURVES).
    values: values along the curve, or names of the curves.
    outputs: outputs to compare; by default those that change with time.
    repeats: runs of each point.
    reference: auto | exact | arkimex | bdf3 | bdf2 | a run folder.
    out: folder of the study; by default results/<case>-study-NNN.
    restart, overwrite: keep finished runs in an existing folder, or replace them.
    options: PETSc options of every run.
    limit: longest wall time of one run [s].
    few: three points per curve.
    steps, tolerances: of all curves that need them, in place of those around the case's own.
    changes: `key=value` of the case file, for every run.
    """

    case: Case | str | Path
    vary: str | None = None
    curves: Sequence[str] | None = None
    values: Sequence[str | float] = ()
    outputs: Sequence[str] = ()
    repeats: int = REPEATS
    reference: str = "auto"
    out: str | Path | None = None
    restart: bool = False
    overwrite: bool = False
    options: Mapping[str, Any] | None = None
    limit: float = LIMIT
    few: bool = False
    steps: Sequence[str | float] = ()
    tolerances: Sequence[str | float] = ()
    changes: Sequence[str] = ()

    @property
    def words(self) -> list[str]:
        """The values as words."""
        return [str(v) for v in self.values]

    @property
    def name(self) -> str:
        """Varied quantity; "curves" for a study of curves."""
        return self.vary or "curves"


def study(
    case: Case | str | Path,
    vary: str | None = None,
    curves: Sequence[str] | None = None,
    *,
    run: Runner = run_process,
    exact: Exact | None = None,
    say: Callable[[str], None] | None = None,
    **settings: Any,
) -> StudyResult:
    """Run the study of a case.

    run: function that runs one job.
    exact: closed form, see ``reference.Exact``.
    say: receives lines of progress; by default they are printed to stderr.
    settings: the other fields of StudyRequest.

    Raises CaseError for bad input, before anything is written. A run that fails is a point marked failed.
    """
    request = StudyRequest(case, vary, curves, **settings)
    report = say or (lambda line: print(line, file=sys.stderr, flush=True))
    base = read_base(
        request.case,
        {str(k): str(v) for k, v in (request.options or {}).items()},
        request.changes,
        [str(v) for v in request.steps],
        [str(v) for v in request.tolerances],
    )
    _refuse_invalid(request, base)
    folder = _folder(request, base.path.stem)
    runs = StudyRuns(base, folder, request.limit, run, request.restart, report)
    runs = replace(runs, base=_with_pilot(runs))
    points = _points(request, runs.base, request.few)
    reference = find_reference(runs, request.name, points, request.reference, _times(runs), exact)
    report(f"reference: {reference.description if reference is not None else 'all runs failed'}")
    measured = []
    began = clock.perf_counter()
    for number, point in enumerate(points, 1):
        made = measure(runs.base, point, folder, request.repeats, request.limit, run, request.restart)
        measured.append(made)
        cost = (
            f"{made.counts.get('steps', 0)} steps, {made.median('cpu'):.3g} CPU s"
            if made.done
            else f"failed: {made.message}"
        )
        left = (clock.perf_counter() - began) / number * (len(points) - number)
        eta = f"  ETA {duration(left)}" if left else ""
        report(f"[{number}/{len(points)}] {point.curve} {point.label}: {cost}{eta}")
    return _result(runs, request, measured, reference)


def _refuse_invalid(request: StudyRequest, base: Base) -> None:
    """Raise CaseError for a request that cannot be run."""
    if (request.vary is None) == (request.curves is None):
        raise CaseError(at="--vary", got=request.vary or "", want="either --vary or --curves")
    if request.vary is not None and request.vary not in VARIED:
        raise CaseError(at="--vary", got=request.vary, want=" | ".join(VARIED))
    if request.repeats < 1:
        raise CaseError(at="--repeats", got=request.repeats, want="1 or more")
    if not request.limit > 0:
        raise CaseError(at="--limit", got=request.limit, want="seconds, above 0")
    if ranks_here() > 1:
        raise CaseError(
            got=f"{ranks_here()} ranks",
            want="study without mpirun",
            hint="each run is a separate process; --vary ranks calls mpirun itself",
        )
    named = request.reference in ("auto", "exact", "arkimex", "bdf3", "bdf2")
    if not named and not Path(request.reference).is_dir():
        raise CaseError(
            at="--reference",
            got=request.reference,
            want="auto | exact | arkimex | bdf3 | bdf2, or a run folder that exists",
        )
    case = case_of(base, Point("", "", 0.0))
    _points(request, base, few=False)
    if request.outputs:
        recorder = Recorder(build_model(case, PETSc.COMM_SELF))
        known = [name for name, _ in (*recorder.columns, *recorder.probe_columns) if name != "time"]
        refuse_unknown("--outputs", request.outputs, known)


def _points(request: StudyRequest, base: Base, few: bool) -> list[Point]:
    """Points of the study."""
    if request.curves is not None:
        return plan_curves("curves", request.curves, base, few)
    assert request.vary is not None
    points = plan_of(request.vary, base, request.words)
    if len({(p.curve, p.label) for p in points}) < len(points):
        raise CaseError(at="--values", got=",".join(request.words), want="each value once")
    return points


def _folder(request: StudyRequest, case: str) -> Path:
    """Create or find the folder of the study."""
    out, overwrite = request.out, request.overwrite
    name = f"{case}-study"
    try:
        folder = RunFolder.create(name, out, restart=request.restart, overwrite=overwrite).path
        if overwrite:
            shutil.rmtree(folder / "runs", ignore_errors=True)
        return folder
    except (OSError, ValueError) as error:
        raise CaseError(at="--out", got=str(out) if out else "", want=str(error)) from None


def _with_pilot(runs: StudyRuns) -> Base:
    """The base with the mean step of the unchanged case.

    The pilot also compiles the kernels, so that no timed run does.
    """
    made = runs.one(Point("pilot", "as-it-stands", 0.0))
    if not made.done:
        runs.say(f"the unchanged case fails: {made.message}")
        return runs.base
    runs.say(
        f"the unchanged case: {made.counts['steps']} steps, mean {made.step:.3g} s, {made.median('cpu'):.3g} CPU s"
    )
    return replace(runs.base, step=made.step)


def _times(runs: StudyRuns) -> np.ndarray:
    """Times (k,) [s] of the rows of the history."""
    every = runs.base.history_every
    return np.arange(int(math.floor(runs.base.end / every * (1 + 1e-9))) + 1) * every


def _result(
    runs: StudyRuns, request: StudyRequest, measured: Sequence[Measured], reference: Reference | None
) -> StudyResult:
    """Compare the points with the reference, and write the files."""
    outputs, vary = request.outputs, request.name
    units: dict[str, str] = {}
    found: dict[int, dict[str, np.ndarray]] = {}
    for k, m in enumerate(measured):
        if m.done:
            _, found[k], units = outputs_of(runs.out / m.folder)
    if reference is not None and outputs:
        wrong = [name for name in outputs if name not in reference.values]
        if wrong:
            raise CaseError(at="--outputs", got=wrong[0], want=" | ".join(reference.values))
    rows = table_rows(measured, found, reference, outputs)
    case = case_of(runs.base, Point("", "", 0.0))
    content = {
        "title": case.title or runs.base.path.stem,
        "case": runs.base.path.name,
        "vary": vary,
        "machine": _machine(),
        "simulated": runs.base.end,
        "history_every": runs.base.history_every,
        **findings(vary, measured, rows, reference, units, case.string_length),
    }
    files = write_results(runs.out, rows, content)
    if reference is None and measured and not any(m.done for m in measured):
        runs.say("all points failed")
    return StudyResult(runs.out, tuple(rows), content, tuple(files))


def _machine() -> dict[str, Any]:
    """Machine on which the times were measured."""
    name = platform.processor()
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as file:
            name = next(
                (line.partition(":")[2].strip() for line in file if line.startswith("model name")), name
            )
    except OSError:
        pass
    return {"processor": name, "cores": os.cpu_count(), "python": platform.python_version()}


def closing_lines(result: StudyResult) -> list[str]:
    """Lines that a study prints at its end: failed points, reference and orders."""
    content = result.findings
    lines = [f"{len(result.rows) - result.failed} of {len(result.rows)} points done"]
    failed: dict[tuple[str, str], list[str]] = {}
    for row in result.rows:
        if row["status"] != "done":
            failed.setdefault((row["curve"], row["message"]), []).append(row["point"])
    lines += [
        f"  {curve} at {', '.join(points)} failed: {message}" for (curve, message), points in failed.items()
    ]
    if content["reference"] is not None:
        lines.append(f"  reference: {content['reference']['what']}")
    for curve, by_output in content["orders"].items():
        for name, by_norm in by_output.items():
            order = by_norm.get("rms")
            if order:
                lines.append(
                    f"  order of {curve} in {name}: {order['order']:.2f} ({order['low']:.2f} to {order['high']:.2f}, rms)"
                )
    lines += [f"  {file}" for file in result.files]
    return lines


__all__ = ["StudyRequest", "StudyResult", "closing_lines", "study"]
