"""Error against run time of a case: runs, reference, table, pictures; `drillpetsc study`.

From Python: ``study("case.yaml", vary="time-step").rows``.
"""

from __future__ import annotations

import math
import os
import platform
import shutil
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.errors import CaseError, SolveError
from drillpetsc.output import RunFolder
from drillpetsc.studies.convergence.plan import (
    DEFAULT_CURVES,
    VARIED,
    Base,
    Options,
    Point,
    as_options,
    case_of,
    plan_curves,
    plan_of,
    read_base,
)
from drillpetsc.studies.convergence.reference import Bench, Exact, Reference, find_reference
from drillpetsc.studies.convergence.report import findings, table_rows, write_results
from drillpetsc.studies.convergence.runs import Measured, Runner, measure, outputs_of, ranks_here, run_process

LIMIT = 600.0  # wall seconds that one run may take
REPEATS = 3


@dataclass(frozen=True)
class StudyResult:
    """folder: of study.csv, study.json and pictures; rows: one a point; findings: the content of
    study.json."""

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
        """Whether no point came to an end, or nothing that they could be compared with."""
        return self.failed == len(self.rows) or self.findings["reference"] is None


def study(
    case: str | Path,
    vary: str | None = None,
    curves: Sequence[str] | None = None,
    *,
    values: Sequence[str | float] = (),
    outputs: Sequence[str] = (),
    repeats: int = REPEATS,
    reference: str = "auto",
    out: str | Path | None = None,
    restart: bool = False,
    overwrite: bool = False,
    options: Mapping[str, Any] | None = None,
    limit: float = LIMIT,
    few: bool = False,
    steps: Sequence[str | float] = (),
    tolerances: Sequence[str | float] = (),
    changes: Sequence[str] = (),
    run: Runner = run_process,
    exact: Exact | None = None,
    say: Callable[[str], None] | None = None,
) -> StudyResult:
    """Run a study of a case file: ``vary`` one thing (VARIED), or the named ``curves``; values along the
    curve, or names of curves.

    reference: auto | exact | arkimex | bdf3 | bdf2 | a run folder; exact: a closed form of the caller's;
    options: PETSc's, for every run;
    changes: `key=value` of the case file, for every run; limit: wall seconds of one run; few: three points a
    curve; steps, tolerances: of all curves that need them, in place of those around the case's own.
    Raises CaseError for bad input, before anything is written; a run that fails is a point marked failed.
    """
    tell = say or (lambda line: print(line, file=sys.stderr, flush=True))
    words = [str(v) for v in values]
    base = read_base(
        case, as_options(options or {}), changes, [str(v) for v in steps], [str(v) for v in tolerances]
    )
    _refuse_nonsense(base, vary, curves, words, repeats, reference)
    folder = _folder(Path(case).stem, out, restart, overwrite)
    bench = Bench(base, folder, limit, run, restart, tell)
    bench = replace(bench, base=_with_pilot(bench))
    points = _points(bench.base, vary, curves, words, few)
    refers = find_reference(bench, vary or "curves", points, reference, _times(bench), exact)
    tell(f"reference: {refers.words if refers is not None else 'none came to an end'}")
    measured = []
    for number, point in enumerate(points, 1):
        made = measure(bench.base, point, folder, repeats, limit, run, restart)
        measured.append(made)
        cost = (
            f"{made.counts.get('steps', 0)} steps, {made.median('cpu'):.3g} CPU s"
            if made.done
            else f"failed: {made.message}"
        )
        tell(f"[{number}/{len(points)}] {point.curve} {point.label}: {cost}")
    return _result(bench, vary or "curves", measured, refers, outputs)


def _refuse_nonsense(
    base: Base,
    vary: str | None,
    curves: Sequence[str] | None,
    words: Sequence[str],
    repeats: int,
    reference: str,
) -> None:
    if (vary is None) == (curves is None):
        raise CaseError(want="either --vary or --curves")
    if vary is not None and vary not in VARIED:
        raise CaseError(at="--vary", got=vary, want=" | ".join(VARIED))
    if repeats < 1:
        raise CaseError(at="--repeats", got=repeats, want="1 or more")
    if ranks_here() > 1:
        raise CaseError(
            got=f"{ranks_here()} ranks",
            want="study without mpirun",
            hint="its runs are processes of their own; --vary ranks calls mpirun itself",
        )
    if reference not in ("auto", "exact", "arkimex", "bdf3", "bdf2") and not Path(reference).is_dir():
        raise CaseError(
            at="--reference",
            got=reference,
            want="auto | exact | arkimex | bdf3 | bdf2, or a run folder that exists",
        )
    case_of(base, Point("", "", 0.0))
    _points(base, vary, curves, words, False)


def _points(
    base: Base, vary: str | None, curves: Sequence[str] | None, words: Sequence[str], few: bool
) -> list[Point]:
    if curves is not None:
        return plan_curves(curves or DEFAULT_CURVES, base, few)
    assert vary is not None
    points = plan_of(vary, base, words)
    if len({(p.curve, p.label) for p in points}) < len(points):
        raise CaseError(at="--values", got=",".join(words), want="each value once")
    return points


def _folder(name: str, out: str | Path | None, restart: bool, overwrite: bool) -> Path:
    try:
        folder = RunFolder.create(f"{name}-study", out, restart=restart, overwrite=overwrite).path
        if overwrite:
            shutil.rmtree(folder / "runs", ignore_errors=True)
        return folder
    except (OSError, ValueError) as error:
        raise CaseError(at="--out", got=str(out) if out else "", want=str(error)) from None


def _with_pilot(bench: Bench) -> Base:
    """The base with the mean step of the case as it stands; also compiles the kernels, so that no timed run
    does."""
    made = bench.one(Point("pilot", "as-it-stands", 0.0))
    if not made.done:
        bench.say(f"the case as it stands fails: {made.message}")
        return bench.base
    bench.say(
        f"the case as it stands: {made.counts['steps']} steps, mean {made.step:.3g} s, {made.median('cpu'):.3g} CPU s"
    )
    return replace(bench.base, step=made.step)


def _times(bench: Bench) -> np.ndarray:
    """Times (k,) [s] of the history's rows, as the recorder writes them."""
    every = bench.base.history_every
    return np.arange(int(math.floor(bench.base.end / every * (1 + 1e-9))) + 1) * every


def _result(
    bench: Bench, vary: str, measured: Sequence[Measured], refers: Reference | None, outputs: Sequence[str]
) -> StudyResult:
    units: dict[str, str] = {}
    found: dict[int, dict[str, np.ndarray]] = {}
    for k, m in enumerate(measured):
        if m.done:
            _, found[k], units = outputs_of(bench.out / m.folder)
    if refers is not None and outputs:
        wrong = [name for name in outputs if name not in refers.values]
        if wrong:
            raise CaseError(at="--outputs", got=wrong[0], want=" | ".join(refers.values))
    rows = table_rows(measured, found, refers, outputs)
    case = case_of(bench.base, Point("", "", 0.0))
    reported = {
        "title": case.title or bench.base.path.stem,
        "case": bench.base.path.name,
        "vary": vary,
        "machine": _machine(),
        "simulated": bench.base.end,
        "history_every": bench.base.history_every,
        **findings(vary, measured, rows, refers, units, case.string_length),
    }
    files = write_results(bench.out, rows, reported)
    if refers is None and measured and not any(m.done for m in measured):
        bench.say("no point came to an end")
    return StudyResult(bench.out, tuple(rows), reported, tuple(files))


def _machine() -> dict[str, Any]:
    """What the times were taken on."""
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
    """The table of orders and costs that ends a study on the screen."""
    reported = result.findings
    lines = [f"{len(result.rows) - result.failed} of {len(result.rows)} points done"]
    failed: dict[tuple[str, str], list[str]] = {}
    for row in result.rows:
        if row["status"] != "done":
            failed.setdefault((row["curve"], row["message"]), []).append(row["point"])
    lines += [
        f"  {curve} at {', '.join(points)} failed: {message}" for (curve, message), points in failed.items()
    ]
    if reported["reference"] is not None:
        lines.append(f"  reference: {reported['reference']['what']}")
    for curve, by_output in reported["orders"].items():
        for name, by_norm in by_output.items():
            order = by_norm.get("rms")
            if order:
                lines.append(
                    f"  order of {curve} in {name}: {order['order']:.2f} ({order['low']:.2f} to {order['high']:.2f}, rms)"
                )
    lines += [f"  {file}" for file in result.files]
    return lines


__all__ = ["Options", "SolveError", "StudyResult", "closing_lines", "study"]
