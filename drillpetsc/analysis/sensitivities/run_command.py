"""`sensitivities --analysis run`: a run with the derivatives of its history, its files and its check with frozen steps."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.sensitivities.derivatives import Derivative
from drillpetsc.analysis.sensitivities.doubts import Checked, Differentiated
from drillpetsc.analysis.sensitivities.keys import Key
from drillpetsc.analysis.sensitivities.run import RunOfCase, RunSeries
from drillpetsc.analysis.sensitivities.run_outputs import RunOutput, parsed_outputs
from drillpetsc.analysis.sensitivities.solution import Output
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.doubts import doubts_at
from drillpetsc.fem.quantity import Quantity
from drillpetsc.output import write_summary, write_table
from drillpetsc.output.files.case_files import write_case
from drillpetsc.output.files.run_folder import SENSITIVITIES_HISTORY, SENSITIVITIES_TABLE
from drillpetsc.output.job import Job
from drillpetsc.output.quantities.sensitivities import SENSITIVITIES
from drillpetsc.output.result import RunResult
from drillpetsc.output.summaries.sensitivities import SensitivitiesSummary
from drillpetsc.solvers import petsc_options as options

USUAL = ("surface_torque.mean", "hook_load.mean")
#: relative, of the differences of runs with frozen steps: at ten times these, their curvature in stick-slip leaves 3e-4
CHECK_STEPS = 1e-4, 1e-5
NEWTON = "1e-10"  # tolerance of Newton's method, whose remainder has another derivative, unless the case has its own
Numbers = list[tuple[float, FloatArray]]


def run_sensitivities_of_run(job: Job, asked: Sequence[str], keys: Sequence[Key], check: int) -> RunResult:
    """Run once, with derivatives in every step, and write sensitivities.csv, sensitivities_history.csv and summary.json (collective).

    check: number of keys whose derivatives are compared with runs of changed cases that take the same steps.
    Raises CaseError for a run, a key or an output whose derivatives are not computed.
    """
    case = job.case
    with options.applied(case.petsc), _option("q_snes_stol", NEWTON):
        run = RunOfCase(case, job.comm)
        end = float(case.given_time.end)
        outputs = parsed_outputs(
            asked or [w for w in USUAL if w.partition(".")[0] in run.names], run.names, end
        )
        columns = list(dict.fromkeys(q.column for q in outputs))
        units = {q.name: q.unit for q in run.outputs.described()}
        docs = {q.name: q.description for q in run.outputs.described()}
        series = run.series(keys, columns)
    numbers = _numbers(outputs, columns, series)
    found = [
        Derivative(
            Output(
                Quantity(q.name, units[q.column], on="scalar", label=q.name, mnemonic="", doc=docs[q.column])
            ),
            key,
            value,
            float(slopes[k]),
        )
        for q, (value, slopes) in zip(outputs, numbers, strict=True)
        for k, key in enumerate(keys)
    ]
    cost: dict[str, float] = {"steps": float(len(series.steps)), "with_derivatives": series.seconds}
    compared: list[Checked] = []
    if check:
        compared, alone = _checked(case, job.comm, outputs, columns, series, keys[:check], numbers)
        cost |= {"alone": alone, "ratio": series.seconds / alone if alone else float("nan")}
    effective = {d.key.name for d in found if d.slope}
    without = list(dict.fromkeys(d.key.name for d in found if d.key.name not in effective))
    summary = SensitivitiesSummary(
        title=case.title,
        analysis="run",
        outputs={q.name: value for q, (value, _) in zip(outputs, numbers, strict=True)},
        sensitivities=[{k: _plain(v) for k, v in _row(d).items()} for d in found],
        checked=[
            {
                "output": c.output,
                "key": c.key,
                "derivative": c.derivative,
                "difference": c.difference,
                "error": c.error,
            }
            for c in compared
        ],
        cost=cost,
        skipped={},
        units=case.shown_units,
        warnings=[sentence for at in compared for sentence in doubts_at(at)],
        notes=doubts_at(Differentiated(case, "run", False, without, {})),
    ).as_dict()
    folder = job.make_folder()
    if job.comm.rank == 0:
        write_case(case, folder)
        rows = [_row(d) for d in found]
        names = [q.column for q in SENSITIVITIES]
        write_table(
            folder.path / SENSITIVITIES_TABLE, names, [[row[q.name] for row in rows] for q in SENSITIVITIES]
        )
        _write_history(folder.path / SENSITIVITIES_HISTORY, columns, units, keys, series)
        write_summary(folder.summary, summary)
    return job.result(folder, summary, _lines(case, found, summary))


def _numbers(outputs: Sequence[RunOutput], columns: Sequence[str], series: RunSeries) -> Numbers:
    """Value and derivatives (k,) of each output."""
    at = [columns.index(q.column) for q in outputs]
    return [
        q.of(series.times, series.values[:, i], series.slopes[:, i]) for q, i in zip(outputs, at, strict=True)
    ]


# ---------------------------------------------------------------------- check
def _checked(
    case: Case,
    comm: PETSc.Comm,
    outputs: Sequence[RunOutput],
    columns: Sequence[str],
    series: RunSeries,
    keys: Sequence[Key],
    numbers: Numbers,
) -> tuple[list[Checked], float]:
    """Compare with central differences of runs that take the steps of the first one; and the processor time of one run alone [s]."""
    found, alone = [], 0.0
    for k, key in enumerate(keys):
        slopes = []
        for step in CHECK_STEPS:
            sides = []
            for sign in (-1, 1):
                repeated = _repeated(
                    key.changed(case, key.value + sign * step * key.size), comm, columns, series.steps
                )
                alone = alone or repeated.seconds
                sides.append(np.array([value for value, _ in _numbers(outputs, columns, repeated)]))
            slopes.append((sides[1] - sides[0]) / (2 * step * key.size))
        square = (CHECK_STEPS[0] / CHECK_STEPS[1]) ** 2
        full = (square * slopes[1] - slopes[0]) / (square - 1)
        for q, (value, own), difference in zip(outputs, numbers, full, strict=True):
            scale = key.value / value if value and key.value else 0.0
            found.append(Checked(case, q.name, key.name, float(own[k]) * scale, float(difference) * scale))
    return found, alone


def _repeated(case: Case, comm: PETSc.Comm, columns: Sequence[str], steps: FloatArray) -> RunSeries:
    """The run of a case with given steps, and Newton's method converged."""
    with options.applied(case.petsc), _option("q_snes_stol", NEWTON):
        run = RunOfCase(case, comm)
        run.freeze(steps)
        return run.series([], columns)


@contextmanager
def _option(name: str, value: str) -> Iterator[None]:
    """Set a PETSc option that the user has not given."""
    given = PETSc.Options()
    if given.hasName(name):
        yield
        return
    given.setValue(name, value)
    try:
        yield
    finally:
        given.delValue(name)


# ---------------------------------------------------------------------- files and screen
def _row(d: Derivative) -> dict[str, Any]:
    return {
        "output": d.output.name, "output_unit": d.output.quantity.unit, "bit_depth": np.nan, "value": d.value, "key": d.key.name,
        "key_unit": d.key.unit or "-", "key_value": d.key.value, "derivative": d.slope, "relative": d.relative, "per": d.key.per,
        "effect": d.effect, "effect_below": np.nan, "effect_above": np.nan, "flag": d.flag,
    }  # fmt: skip


def _plain(value: Any) -> Any:
    return None if isinstance(value, float) and np.isnan(value) else value


def _write_history(
    path: Any, columns: Sequence[str], units: dict[str, str], keys: Sequence[Key], series: RunSeries
) -> None:
    """Columns and, after each, its change by a change of each key by its own value, p ds/dp; of a key of zero, by its usual size."""
    titles, values = [("time", "s")], [series.times]
    for i, name in enumerate(columns):
        titles.append((name, units[name]))
        values.append(series.values[:, i])
        for k, key in enumerate(keys):
            titles.append((f"{name} by {key.name}", units[name]))
            values.append(series.slopes[:, i, k] * key.size)
    write_table(path, titles, values)


def _lines(case: Case, found: Sequence[Derivative], summary: dict[str, Any]) -> list[str]:
    lines = [f"{case.title or 'case'}: sensitivities of a run, effect of a change of each key"]
    for output in dict.fromkeys(d.output for d in found):
        mine = sorted((d for d in found if d.output == output and d.slope), key=lambda d: -abs(d.effect))
        lines.append(
            f"  {output.name} {next(d.value for d in found if d.output == output):.6g} {output.quantity.unit}"
        )
        lines += [
            f"    {d.key.name:<40} {f'{d.key.value:.6g} + {d.key.per:.3g} {d.key.unit}'.rstrip():<28} {d.effect:>+12.5g} "
            f"{output.quantity.unit:<6} {'' if np.isnan(d.relative) else f'{d.relative:>10.3f}'}".rstrip()
            for d in mine
        ]
    cost = summary["cost"]
    text = f"  {cost['steps']:.0f} steps in {cost['with_derivatives']:.3g} s of processor time"
    lines.append(text + (f", {cost['ratio']:.2g} times that of the run alone" if "ratio" in cost else ""))
    if summary["checked"]:
        worst = max(c["error"] for c in summary["checked"])
        lines.append(
            f"  {len(summary['checked'])} derivatives checked by runs with the same steps: largest error {worst:.1e}"
        )
    lines += [f"  WARNING: {w}" for w in summary["warnings"]]
    return lines + [f"  note: {note}" for note in summary["notes"]]
