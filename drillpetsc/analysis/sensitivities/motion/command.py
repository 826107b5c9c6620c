"""`sensitivities --analysis run`: a run with the derivatives of its history, its files and its check with frozen steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.motion.session.live_outputs import SessionOutput
from drillpetsc.analysis.sensitivities.answer import Answer
from drillpetsc.analysis.sensitivities.derivatives import ONE_SIDED, Derivative, both_sides, full_difference
from drillpetsc.analysis.sensitivities.doubts import (
    Checked,
    Followed,
    HoleRenewed,
    Stepped,
    Unchecked,
)
from drillpetsc.analysis.sensitivities.keys import Key
from drillpetsc.analysis.sensitivities.motion.chaos import determined_until
from drillpetsc.analysis.sensitivities.motion.outputs import RunOutput, parsed_outputs
from drillpetsc.analysis.sensitivities.motion.run_of_case import TOLERANCE, RunOfCase, RunSeries, converged
from drillpetsc.analysis.sensitivities.solution import Output
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.fem.quantity import Quantity
from drillpetsc.output import write_table
from drillpetsc.output.files.run_folder import SENSITIVITIES_HISTORY
from drillpetsc.output.job import Job, RunResult
from drillpetsc.solvers import petsc_options as options
from drillpetsc.solvers.time.generalized_alpha import GeneralizedAlpha
from drillpetsc.solvers.time.scaled_tolerance import scaled_tolerance

USUAL = ("surface_torque.mean", "hook_load.mean")
#: relative, of the differences of runs with frozen steps: at ten times these, their curvature in stick-slip leaves 3e-4
CHECK_STEPS = 1e-4, 1e-5
#: the same in mud, where differences of 1e-5 show the noise of static starts
CHECK_STEPS_IN_MUD = 1e-3, 1e-4
#: of these differences, relative to output and key: static starts with mud converge to 1e-10 of usual pressures, and the weight on a bit
#: that cuts follows from positions that are rounded
ROUNDING_OF_DIFFERENCES = 5e-6
LOOSER = 10.0  # tolerance of the run with which the derivatives are compared, over that of the run
MOVES, SMALL = (
    0.1,
    0.01,
)  # change of a derivative by it, and of the largest one of the output, from which it is flagged
UNDETERMINED = "not determined"  # flag of outputs that end in chaotic motion
#: of the largest value of a column: smaller effects of a change of a key by its own size are rounding
ROUNDING = 1e-9
STEPS = "steps"  # flag of derivatives that looser steps move
Numbers = list[tuple[float, FloatArray]]


def run_sensitivities_of_run(
    job: Job, asked: Sequence[str], keys: Sequence[Key], check: int, skips: bool
) -> RunResult:
    """Run once, with derivatives in every step, and write sensitivities.csv, sensitivities_history.csv and summary.json (collective).

    check: number of keys whose derivatives are compared with runs of changed cases that take the same steps.
    skips: keys that cannot be followed are left out, with the reasons.
    Raises CaseError for a run, a key or an output whose derivatives are not computed.
    """
    case = job.case
    with options.applied(case.petsc), converged():
        run = RunOfCase(case, job.comm)
        if check and run.has_events:
            want = "0: changed cases have the events of the jar at other times, and cannot take the steps of this run"
            raise CaseError(at="--check", got=str(check), want=want)
        end = float(case.given_time.end)
        outputs = parsed_outputs(
            asked or [w for w in USUAL if w.partition(".")[0] in run.names], run.names, end
        )
        columns = list(dict.fromkeys(q.column for q in outputs))
        described = {q.name: q for q in run.outputs.described()}
        series = run.series(keys, columns, skips)
        coarse = _at_looser_steps(case, job.comm, series, columns)
    repeated = _Repeated(case, job.comm, outputs, columns, series)
    followed = [
        Followed(case, column, _until(series, i, [key.name for key in series.keys]))
        for i, column in enumerate(columns)
    ]
    found, moved = _with_looser_steps(_derivatives(repeated, described, followed), outputs, columns, coarse)
    cost: dict[str, float] = {"steps": float(len(series.steps)), "with_derivatives": series.seconds}
    compared = repeated.checked(found, check)
    if repeated.seconds:
        cost |= {"alone": repeated.seconds, "ratio": series.seconds / repeated.seconds}
    stepped = [Stepped(case, name, *worst) for name, worst in moved.items()]
    renews = case.fluid is not None and isinstance(run.integrator, GeneralizedAlpha)
    surveyed = [key.name for key in series.keys if renews and key.name.startswith("well.survey")]
    moments = [
        *followed,
        *stepped,
        *compared,
        Unchecked(case, repeated.unchecked),
        HoleRenewed(case, surveyed),
    ]
    answer = Answer(
        case,
        "run",
        {q.name: value for q, (value, _) in zip(outputs, repeated.numbers, strict=True)},
        found,
        compared,
        series.skipped,
        cost=cost,
    )
    summary = answer.summary(moments)
    folder = job.make_folder()
    if job.comm.rank == 0:
        units = {name: q.unit for name, q in described.items()}
        every = case.output.history_every
        rows_at = _rows(series.times, series.times[-1] if every is None else float(every))
        _write_history(folder.path / SENSITIVITIES_HISTORY, columns, units, series, rows_at)
    text = f"  {cost['steps']:.0f} steps in {cost['with_derivatives']:.3g} s of processor time"
    text += f", {cost['ratio']:.2g} times that of the run alone" if "ratio" in cost else ""
    lines = [*answer.lines("runs with the same steps"), text]
    return job.result(folder, summary, lines, answer.tables)


def _until(series: RunSeries, column: int, names: Sequence[str]) -> dict[str, float]:
    """Time [s] up to which the derivatives of a column by each key are determined."""
    values, slopes = series.values[:, column], series.slopes[:, column]
    return {
        name: determined_until(series.times, values, slopes[:, k] * series.keys[k].size)
        for k, name in enumerate(names)
    }


def _derivatives(
    repeated: _Repeated, described: dict[str, SessionOutput], followed: Sequence[Followed]
) -> list[Derivative]:
    """Derivatives of all outputs by all keys; those beyond the time up to which they are determined have no number."""
    series, out = repeated.series, []
    until = {at.column: at.until for at in followed}
    kinks = [k for k, flag in enumerate(series.flags) if ONE_SIDED in flag]
    sides = {k: repeated.both_sides(series.keys[k]) for k in kinks}
    for i, (q, (value, slopes)) in enumerate(zip(repeated.outputs, repeated.numbers, strict=True)):
        column = described[q.column]
        quantity = Quantity(
            q.name, column.unit, on="scalar", label=q.name, mnemonic="", doc=column.description
        )
        for k, key in enumerate(series.keys):
            known = q.window[1] <= until[q.column][key.name]
            flag = ", ".join(filter(None, [series.flags[k], "" if known else UNDETERMINED]))
            below, above = sides[k][:, i].tolist() if k in sides else (np.nan, np.nan)
            column_values = series.values[:, repeated.columns.index(q.column)]
            slope = _without_rounding(float(slopes[k]), key, column_values) if known else np.nan
            out.append(Derivative(Output(quantity), key, value, slope, flag, below, above))
    return out


def _without_rounding(slope: float, key: Key, values: FloatArray) -> float:
    """The derivative of a column with these ``values``, or zero if it is rounding."""
    return 0.0 if abs(slope * key.size) <= ROUNDING * np.abs(values).max() else slope


def _numbers(outputs: Sequence[RunOutput], columns: Sequence[str], series: RunSeries) -> Numbers:
    """Value and derivatives (k,) of each output."""
    at = [columns.index(q.column) for q in outputs]
    return [
        q.of(series.times, series.values[:, i], series.slopes[:, i], series.events)
        for q, i in zip(outputs, at, strict=True)
    ]


# ---------------------------------------------------------------------- a run with looser steps
def _at_looser_steps(
    case: Case, comm: PETSc.Comm, series: RunSeries, columns: Sequence[str]
) -> RunSeries | None:
    """The run with ten times the tolerance of its steps; None if it does not come to its end (collective).

    The derivatives are those of the formula's steps.  Where a bit breaks loose or a contact opens within a few steps, they converge more
    slowly than the run itself.
    """
    given = {name: value for name, value in PETSc.Options().getAll().items() if name != TOLERANCE}
    with scaled_tolerance(given, LOOSER):
        try:
            return RunOfCase(case, comm).series(series.keys, columns)
        except SolveError:
            return None


def _with_looser_steps(
    found: Sequence[Derivative],
    outputs: Sequence[RunOutput],
    columns: Sequence[str],
    coarse: RunSeries | None,
) -> tuple[list[Derivative], dict[str, tuple[str, float, float]]]:
    """The derivatives with a flag where looser steps move them, and of each output the key, effect and other effect that differ most."""
    numbers = None if coarse is None else _numbers(outputs, columns, coarse)
    count, out = len(found) // max(len(outputs), 1), list[Derivative]()
    moved: dict[str, tuple[str, float, float]] = {}
    for i, q in enumerate(outputs):
        mine = found[i * count : (i + 1) * count]
        largest = max((abs(d.effect) for d in mine if np.isfinite(d.slope)), default=0.0)
        for k, d in enumerate(mine):
            other = np.nan
            if coarse is not None and numbers is not None:
                slope, values = float(numbers[i][1][k]), coarse.values[:, columns.index(q.column)]
                other = _without_rounding(slope, d.key, values) * d.key.per
            gap = abs(d.effect - other)
            moves = not gap <= max(MOVES * abs(d.effect), SMALL * largest) and np.isfinite(d.slope)
            out.append(replace(d, flag=", ".join(filter(None, [d.flag, STEPS]))) if moves else d)
            before = moved.get(q.name)
            if moves and (before is None or not gap <= abs(before[1] - before[2])):
                moved[q.name] = (d.key.name, d.effect, other)
    return out, moved


# ---------------------------------------------------------------------- runs with the same steps
class _Repeated:
    """Outputs of a run, and of runs of changed cases that take its steps.

    numbers: value and derivatives of each output; seconds: processor time of one run alone [s], zero before the first.
    unchecked: keys for which no such run took the same steps.
    """

    def __init__(
        self,
        case: Case,
        comm: PETSc.Comm,
        outputs: Sequence[RunOutput],
        columns: Sequence[str],
        series: RunSeries,
    ) -> None:
        self.case, self.comm, self.outputs, self.columns, self.series = case, comm, outputs, columns, series
        self.numbers, self.seconds = _numbers(outputs, columns, series), 0.0
        self.unchecked: list[str] = []

    def values(self, case: Case) -> FloatArray:
        """Outputs (m,) of the run of a changed case; collective.

        Raises SolveError if it cannot take the same steps.
        """
        with options.applied(case.petsc), converged():
            run = RunOfCase(case, self.comm)
            if not run.has_events:
                run.freeze(self.series.steps)
            series = run.series([], self.columns)
        if len(series.steps) != len(self.series.steps) or not np.allclose(series.steps, self.series.steps):
            raise SolveError("Newton's method fails with the steps of the run")
        self.seconds = self.seconds or series.seconds
        return np.array([value for value, _ in _numbers(self.outputs, self.columns, series)])

    def both_sides(self, key: Key) -> FloatArray:
        """Effects (2, m) of the stated change below and above; nan where there is none."""
        return both_sides(self.case, key, self.values, np.array([value for value, _ in self.numbers]))

    def checked(self, found: Sequence[Derivative], count: int) -> list[Checked]:
        """Compare the derivatives by the first ``count`` keys without a flag with central differences."""
        out, flagged = [], {d.key.name for d in found if d.flag not in ("", STEPS)}
        rounding = ROUNDING_OF_DIFFERENCES if self.case.fluid or self.case.formation else 0.0
        steps = CHECK_STEPS_IN_MUD if self.case.fluid else CHECK_STEPS
        for key in [key for key in self.series.keys if key.name not in flagged][:count]:
            try:
                full, first = full_difference(self.case, key, self.values, steps)
            except SolveError:
                self.unchecked.append(key.name)
                continue
            own = [d for d in found if d.key is key]
            ours = np.array([d.slope for d in own])
            # the first has the noise of two runs, the other one the curvature within its step: a wrong derivative is near neither
            full = np.where(abs(full - ours) < abs(first - ours), full, first)
            for d, slope in zip(own, full, strict=True):
                scale = key.value / d.value if d.value and key.value else 0.0
                out.append(
                    Checked(
                        self.case, d.output.name, key.name, d.slope * scale, float(slope) * scale, rounding
                    )
                )
        return out


# ---------------------------------------------------------------------- files and screen
def _rows(times: FloatArray, every: float) -> FloatArray:
    """Numbers of the steps that are written: the first one at or after each row of the history [s]."""
    wanted = np.arange(0.0, times[-1] + 1e-9, every)
    return np.unique(np.minimum(np.searchsorted(times, wanted - 1e-9), len(times) - 1))


def _write_history(
    path: Any, columns: Sequence[str], units: dict[str, str], series: RunSeries, at: FloatArray
) -> None:
    """Columns at the steps ``at`` and, after each, its change by a change of each key by its own value, p ds/dp; of a key of zero, by its usual size."""
    titles, values = [("time", "s")], [series.times[at]]
    for i, name in enumerate(columns):
        titles.append((name, units[name]))
        values.append(series.values[at, i])
        for k, key in enumerate(series.keys):
            titles.append((f"{name} by {key.name}", units[name]))
            values.append(series.slopes[at, i, k] * key.size)
    write_table(path, titles, values)
