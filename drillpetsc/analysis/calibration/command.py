"""`calibrate --model dynamic`: numbers of a case from a log in time, as files and text."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

from drillpetsc.analysis.calibration.estimator import Fit
from drillpetsc.analysis.calibration.log_series import LogSeries, log_series
from drillpetsc.analysis.calibration.of_runs import (
    NextColumn,
    RunCalibration,
    fit_run,
    moved_by_steps,
    next_column,
    run_of,
    scatter_of,
)
from drillpetsc.analysis.calibration.words import keys_of_fit, lines_of_fit, undetermined
from drillpetsc.arrays import FloatArray
from drillpetsc.errors import CaseError
from drillpetsc.output.files.run_folder import CALIBRATION_SERIES
from drillpetsc.output.job import Job, RunResult

MOVED = 0.5  # change of a number by finer steps over the half width of its interval, which is told
UNEXPLAINED = 3.0  # rms of the residuals over the scatter from row to row, from which the model does not explain the log


def run_calibrate_log(
    job: Job, file: str, names: tuple[str, ...], correlated: bool, priors: dict[str, tuple[float, float]]
) -> RunResult:
    """Fit numbers of the case to a log in time; collective.  Every rank computes the same, the first one writes."""
    case = job.case
    run = run_of(case, job.comm)
    log = log_series(file, case, run.names)
    work = RunCalibration(run, log)
    parameters, priors = work.asked(names, priors)
    if len(log.value) <= len(parameters):
        want = f"more than {len(parameters)} readings, as many numbers are fitted"
        raise CaseError(file=log.file, got=f"{len(log.value)} readings", want=want)
    fit = fit_run(work, parameters, correlated, priors)
    misfit = scatter_of(work, fit) / log.scatter
    further = next_column(work, fit)
    described = {q.name: q.unit for q in run.outputs.described()}
    summary = {
        "title": case.title,
        "units": case.shown_units,
        "model": "dynamic",
        **keys_of_fit(work, fit),
        "readings": len(log.value),
        "errors": "independent" if fit.lengths is None else "correlated",
        "correlation_time": _alike(fit),
        "misfit": dict(zip(log.columns, misfit.tolist(), strict=True)),
        "next_columns": [] if further is None else [asdict(further)],
        "warnings": [*undetermined(work, fit), *_unexplained(log, misfit), *_steps(work, fit)],
        "notes": list(log.notes),
    }
    titles, columns = _table(work, fit, described)
    tables = [(CALIBRATION_SERIES, titles, zip(*columns, strict=True))]
    return job.result(job.make_folder(), summary, _lines(work, fit, summary, further), tables)


def _table(work: RunCalibration, fit: Fit, units: dict[str, str]) -> tuple[list[tuple[str, str]], list[Any]]:
    """Titles and columns: at each time of the log, what was read and what is computed; nan where nothing was read."""
    log = work.log
    times = np.unique(log.time)
    titles, out = [("time", "s")], [times]
    for j, name in enumerate(log.columns):
        mine = log.column == j
        at = np.searchsorted(times, log.time[mine])
        for word, values in (("read", log.value), ("computed", fit.computed)):
            column = np.full(len(times), np.nan)
            column[at] = values[mine]
            titles.append((f"{name} {word}", units[name]))
            out.append(column)
    return titles, out


def _alike(fit: Fit) -> dict[str, dict[str, float]] | None:
    """By column: readings, time over which errors are alike, effective number; None if errors are independent."""
    found = fit.lengths
    if found is None:
        return None
    return {
        name: {
            "readings": found.count[name],
            "alike over [s]": found.raw[name],
            "effective": found.effective[name],
        }
        for name in found.raw
    }


def _unexplained(log: LogSeries, misfit: FloatArray) -> list[str]:
    return [
        f"the computed {name} is off by {q:.1f} times the scatter of the log from row to row: the model does not explain the log, and no "
        "interval contains that error"
        for name, q in zip(log.columns, misfit, strict=True)
        if q > UNEXPLAINED
    ]


def _steps(work: RunCalibration, fit: Fit) -> list[str]:
    """What finer steps would change."""
    out = []
    for name, change in moved_by_steps(work, fit).items():
        width = fit.interval[fit.parameters.index(name)]
        if not abs(change) <= MOVED * width:
            p = work.parameter(name)
            out.append(
                f"{name} moves by {p.shown(change, work.units)} with a tenth of the tolerance of the steps, beside an interval of "
                f"+-{p.shown(width, work.units)}: lower petsc.ts_rtol"
            )
    return out


def _lines(work: RunCalibration, fit: Fit, summary: dict[str, Any], further: NextColumn | None) -> list[str]:
    log = work.log
    lines = [
        f"{work.case.title or 'case'}: calibration of the run with {len(log.value)} readings of {', '.join(log.columns)}, "
        f"{log.time.min():g} to {log.end:g} s",
        *lines_of_fit(work, fit),
    ]
    for name, row in (summary["correlation_time"] or {}).items():
        lines.append(
            f"  {name}: errors alike over {row['alike over [s]']:.3g} s; {row['readings']} readings count as {row['effective']:.3g}"
        )
    if further is not None:
        widths = (
            f"{name} to +-{work.parameter(name).shown(w, work.units)}" for name, w in further.widths.items()
        )
        lines.append(f"  next: a log of {further.column} beside these would determine {', '.join(widths)}")
    return lines
