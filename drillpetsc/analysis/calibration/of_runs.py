"""Numbers of a case from a log in time: the run is the model of the readings, with derivatives from its steps (manual: sec-calibrate-runs)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.calibration.estimator import (
    SMALLEST_SPREAD,
    SOFT_SCALE,
    Estimator,
    Fit,
    Known,
    Readings,
)
from drillpetsc.analysis.calibration.log_series import SMALLEST_SHARE, LogSeries
from drillpetsc.analysis.loads.torque_drag.readings.along_depth import NEGLIGIBLE, Lengths
from drillpetsc.analysis.loads.torque_drag.readings.parameters import Parameter, parameter_of
from drillpetsc.analysis.sensitivities.keys import changed_case, key_of
from drillpetsc.analysis.sensitivities.motion.chaos import determined_until
from drillpetsc.analysis.sensitivities.motion.run_of_case import TOLERANCE, RunOfCase, RunSeries, converged
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.model.mesh import MeshOf
from drillpetsc.solvers import petsc_options as options
from drillpetsc.solvers.time.scaled_tolerance import scaled_tolerance

FINEST = 0.01  # of the standard error at first: least one that residuals show
FINER = 0.1  # tolerance of the steps of the run that tells their error, over the case's
ALMOST, MOST_MORE = 0.999, 1.5  # largest correlation of neighbours; see ``readings_alike``
ROUNDS = 3  # of the number of residuals that count as one, which its own bias depends on
FAR = 1e6  # standard errors of a reading without a run: it fits nothing
MOST_RUNS = 6  # that are kept
SCATTER = 1.5  # rms of the residuals over the standard error, or the inverse, from which that is renewed
#: columns that a further sensor could read
SENSORS = ("surface_torque", "hook_load", "top_speed", "bit_speed", "bit_torque", "wob")
Values = dict[str, float]


@dataclass(frozen=True)
class NextColumn:
    """A further column that would determine what is not determined.  widths: half widths of the intervals with it [SI]."""

    column: str
    widths: dict[str, float]


class RunCalibration(Estimator):
    """A log beside the history of a run.

    run: of the case; log: the readings.  Every rank computes the same.
    """

    noun = "readings"

    def __init__(self, run: RunOfCase, log: LogSeries) -> None:
        super().__init__()
        self.case, self.comm, self.log = run.case, run.comm, log
        self.units = run.case.shown_units
        self.names: Sequence[str] = run.names
        self._mesh: MeshOf = run.mesh
        self._parameters: dict[str, Parameter] = {}
        self._kept: dict[tuple[object, ...], RunSeries | None] = {}
        self.start: Values = {}  # of the search; those not in it start at the case's value
        self.set_scatter(log.scatter)

    def read(self, log: LogSeries) -> None:
        """Take other readings of the same columns at the same times."""
        self.log, self.start = log, {}
        self.set_scatter(log.scatter)

    def set_scatter(self, scatter: FloatArray) -> None:
        """Take standard errors (columns,) of the readings of each column."""
        self.scatter = scatter
        self.data = Readings(self.log.value, scatter[self.log.column])

    # ------------------------------------------------------------------ the model
    def parameter(self, name: str) -> Parameter:
        """A number of the case; raises CaseError for another name."""
        if name not in self._parameters:
            if "." not in name and "[" not in name:
                want = "numbers of the case such as formation.bit_law.static; friction groups and the rig's numbers belong to --model soft and stiff"
                raise CaseError(at="--fit", got=name, want=want)
            self._parameters[name] = parameter_of(self.case, name, ())
        return self._parameters[name]

    def default(self, name: str) -> float:
        """The case's value."""
        key = self.parameter(name).key
        assert key is not None
        return key.value

    def computed(self, sets: list[Values], forward: object = None) -> FloatArray:
        """(s, n) readings for s sets of parameters; far from those of the log where there is no run."""
        out = np.empty((len(sets), len(self.data.value)))
        for row, values in zip(out, sets, strict=True):
            series = self._series(self.fixed | values)
            row[:] = (
                self.data.value + FAR * self.data.sigma
                if series is None
                else self._at_log(series, series.values)
            )
        return out

    def slopes(self, values: Values, names: Sequence[str], forward: object = None) -> FloatArray:
        """(k, n) change of the readings per unit of each parameter, at some values; raises SolveError without a run."""
        series = self.followed(self.fixed | values, names)
        # one that chaotic motion has lost pulls nowhere; ``_misfitting`` names it where the search ends
        return np.nan_to_num([self._at_log(series, series.slopes[:, :, k]) for k in range(len(names))])

    def followed(self, values: Values, names: Sequence[str], more: Sequence[str] = ()) -> RunSeries:
        """The run at some values with the derivatives by ``names``; more: further columns."""
        found = self._series(values, tuple(names), tuple(more))
        if found is None:
            raise SolveError("the run does not come to the end of the log")
        return found

    def _series(
        self, values: Values, names: tuple[str, ...] = (), more: tuple[str, ...] = ()
    ) -> RunSeries | None:
        key = tuple(sorted(values.items())), names, more
        if key not in self._kept:
            while len(self._kept) >= MOST_RUNS:
                del self._kept[next(iter(self._kept))]
            self._kept[key] = self._run(values, names, more)
        return self._kept[key]

    def fresh(self, values: Values) -> FloatArray | None:
        """(n,) readings at some values by a run of its own; None without a run."""
        series = self._run(values, (), ())
        return None if series is None else self._at_log(series, series.values)

    def _run(self, values: Values, names: tuple[str, ...], more: tuple[str, ...]) -> RunSeries | None:
        keys = {self.parameter(name).key: value for name, value in values.items()}
        at_case = not any(value != self.default(name) for name, value in values.items())
        try:
            case = (
                self.case
                if at_case
                else changed_case(self.case, {k: v for k, v in keys.items() if k is not None})
            )
            with options.applied(case.petsc), converged():
                run = RunOfCase(case, self.comm, like=self._mesh)
                return run.series(
                    [key_of(case, name) for name in names], [*self.log.columns, *more], end=self.log.end
                )
        except CaseError as error:
            if not at_case:
                return None
            at = "--fit" if error.at == "--to" else error.at
            raise CaseError(at=at, got=error.got, want=error.want, hint=error.hint) from None
        except SolveError:
            if at_case:
                raise
            return None

    def _at_log(self, series: RunSeries, table: FloatArray) -> FloatArray:
        """(n,) numbers of the columns of a table (m, columns) at the readings."""
        out = np.empty(len(self.log.time))
        for j in range(len(self.log.columns)):
            mine = self.log.column == j
            out[mine] = np.interp(self.log.time[mine], series.times, table[:, j])
        return out

    # ------------------------------------------------------------------ what the estimator needs
    def _solve(self, names: tuple[str, ...]) -> tuple[FloatArray, FloatArray]:
        first = [self.start.get(name, self.default(name)) for name in names]
        return self._solve_with(names, np.array(first))

    def _not_identifiable(self, parameters: tuple[str, ...]) -> dict[str, str]:
        """Numbers whose largest change is less than the errors of all readings together; all of them in chaotic motion."""
        out = self._lost(self.start, parameters)
        if out:
            return out
        slopes = self.slopes(self.start, parameters)
        for name, slope in zip(parameters, slopes, strict=True):
            p = self.parameter(name)
            low, high = p.bounds
            if not np.linalg.norm(slope / self.data.sigma) * (high - low) / 2 > SMALLEST_SPREAD:
                ends = f"{p.shown(low, self.units)} to {p.shown(high, self.units)}"
                out[name] = f"values from {ends} change the readings by less than their scatter"
        return out

    def _misfitting(self, kept: tuple[str, ...], best: FloatArray) -> dict[str, str]:
        """All of them in chaotic motion."""
        return self._lost(dict(zip(kept, best.tolist(), strict=True)), kept)

    def _lost(self, values: Values, names: tuple[str, ...]) -> dict[str, str]:
        """All of the ``names``, with the reason, where the motion is chaotic at some values."""
        until, column, name = self.known_until(values, names)
        if until >= self.log.end:
            return {}
        why = f"the motion is chaotic: from {until:.4g} s on, 1 % of {name} moves {column} by a tenth of its range; end the log there"
        return dict.fromkeys(names, why)

    def known_until(self, values: Values, names: Sequence[str]) -> tuple[float, str, str]:
        """First time [s] at which a derivative is no longer determined, with column and parameter; infinity if all are."""
        series = self.followed(self.fixed | values, names)
        found = [(np.inf, "", "")]
        for j, column in enumerate(self.log.columns):
            for k, key in enumerate(series.keys):
                until = determined_until(series.times, series.values[:, j], series.slopes[:, j, k] * key.size)
                found.append((until, column, names[k]))
        return min(found)

    def _correlated_widths(self, fit: Fit, residual: FloatArray, jacobian: FloatArray) -> FloatArray:
        """Least squares of readings with errors that fade as exp(-t/T) in each column (manual: eq-calibrate-run-covariance)."""
        from scipy.stats import t as student

        count, log = len(self.data.value), self.log
        series = np.array(log.columns)[log.column]
        loss = 1 / np.sqrt(1 + (residual[:count] / SOFT_SCALE) ** 2)
        rows, prior = jacobian[:count] * loss[:, None], jacobian[count:]
        power = jacobian[:count].T @ rows + prior.T @ prior
        middle = self.readings_alike * prior.T @ prior
        of_column = [np.flatnonzero(series == name) for name in log.columns]
        # the columns of one run have errors of one kind, and a single estimate is often too small
        alike = max(readings_alike(fit.computed[mine] - log.value[mine]) for mine in of_column)
        for mine in of_column:
            gap = np.diff(log.time[mine])
            kept = np.append(0.0, ((alike - 1) / (alike + 1)) ** (gap / gap.mean()))
            sums = np.zeros(
                (len(mine), rows.shape[1])
            )  # of what the readings before have in common with each
            for i, share in enumerate(kept):
                sums[i] = rows[mine[i]] + (share * sums[i - 1] if i else 0.0)
            both = rows[mine].T @ sums
            variance = float(loss[mine] @ residual[mine] ** 2 / loss[mine].sum())
            middle = middle + variance * (both + both.T - rows[mine].T @ rows[mine])
        size = dict(zip(log.columns, map(len, of_column), strict=True))
        time = {name: alike * float(np.ptp(log.time)) / n for name, n in size.items()}
        fit.lengths = Lengths(time, {}, {name: n / alike for name, n in size.items()}, size)
        independent = count / alike
        freedom = max(independent - rows.shape[1], 1.0)
        inverse = np.linalg.inv(power)
        fit.covariance = inverse @ middle @ inverse * independent / freedom
        return np.asarray(student.ppf(0.975, freedom) * np.sqrt(np.diag(fit.covariance)))


def readings_alike(residual: FloatArray) -> float:
    """How many residuals (n,) in order of time count as one: L = 1 + 2 sum (rho_k + L/n), until a term is negligible.

    Correlations about the mean of n residuals come out too small by L/n, the variance of that mean over their own. The tail that is cut
    off has that share of the sum of an autoregression. In a short series the sum often ends too early: neighbours of an autoregression say
    (1 + rho)/(1 - rho), which is taken up to half as much again, because neighbours of a smooth series say nothing.
    """
    x, count = residual - residual.mean(), len(residual)
    power, found = float(x @ x), 1.0
    if not power > 0:
        return found
    for _ in range(ROUNDS):
        lacking, found = found / count, 1.0
        for k in range(1, count):
            rho = float(x[:-k] @ x[k:]) / power + lacking
            if rho < NEGLIGIBLE:
                break
            found += 2 * rho / (1 - NEGLIGIBLE)
    neighbours = min(float(x[:-1] @ x[1:]) / power + found / count, ALMOST)
    return min(max(found, min((1 + neighbours) / (1 - neighbours), MOST_MORE * found)), float(count))


def fit_run(
    work: RunCalibration,
    parameters: tuple[str, ...],
    correlated: bool,
    priors: Known,
) -> Fit:
    """Fit parameters, and once more with the errors that the residuals show."""
    until, column, name = work.known_until({}, parameters)
    if until < work.log.end:
        want = f"one that ends before {until:.4g} s: from there on the motion is chaotic, and 1 % of {name} moves {column} by a tenth of its range"
        raise CaseError(at="--log", got=f"a log to {work.log.end:.4g} s", want=want)
    fit = work.fit(parameters, correlated, priors)
    seen = scatter_of(work, fit)
    if fit.kept and ((seen > SCATTER * work.scatter) | (SCATTER * seen < work.scatter)).any():
        work.set_scatter(np.maximum(seen, FINEST * work.scatter))
        work.start = fit.best
        fit = work.fit(parameters, correlated, priors)
    return fit


def moved_by_steps(work: RunCalibration, fit: Fit) -> dict[str, float]:
    """Change [SI] of each fitted number if the steps had a tenth of their tolerance, to first order; empty if no number is fitted."""
    if not fit.kept:
        return {}
    values = work.fixed | fit.best
    given = {**work.case.petsc, **PETSc.Options().getAll()}
    with scaled_tolerance({name: value for name, value in given.items() if name != TOLERANCE}, FINER):
        finer = work.fresh(values)
    if finer is None:
        return {}
    jacobian = work.slopes(fit.best, fit.kept) / work.data.sigma
    off = (finer - fit.computed) / work.data.sigma
    change = np.linalg.lstsq(jacobian.T, -off, rcond=None)[0]
    return dict(zip(fit.kept, change.tolist(), strict=True))


def scatter_of(work: RunCalibration, fit: Fit) -> FloatArray:
    """(columns,) rms of the residuals [SI]."""
    off = fit.computed - work.log.value
    return np.array(
        [float(np.sqrt(np.mean(off[work.log.column == j] ** 2))) for j in range(len(work.log.columns))]
    )


def next_column(work: RunCalibration, fit: Fit) -> NextColumn | None:
    """The column, read at the log's times with errors of 1 % of its range, with which all parameters are determined; None if there is none.

    Its errors are alike over as many readings as those of the log.
    """
    missing, more = (
        list(fit.reasons),
        [c for c in SENSORS if c in work.names and c not in work.log.columns],
    )
    if not missing or not more:
        return None
    names = [*fit.kept, *missing]
    series = work.followed(work.fixed | fit.best, names, more)
    known = (
        np.array([work._at_log(series, series.slopes[:, :, k]) for k in range(len(names))]) / work.data.sigma
    )
    best: tuple[float, NextColumn] | None = None
    times = np.unique(work.log.time)
    for j, column in enumerate(more, len(work.log.columns)):
        value = np.interp(times, series.times, series.values[:, j])
        if not np.ptp(value) > 0:
            continue
        slopes = [np.interp(times, series.times, series.slopes[:, j, k]) for k in range(len(names))]
        new = np.array(slopes) / (SMALLEST_SHARE * np.ptp(value))
        power = (known @ known.T + new @ new.T) / fit.readings_alike
        size = np.array([work.parameter(name).bounds[1] - work.parameter(name).bounds[0] for name in names])
        scaled = power * np.outer(size, size)
        if np.linalg.cond(scaled) > 1e12:
            continue
        width = 1.96 * np.sqrt(np.diag(np.linalg.inv(scaled))) * size
        worst = max(w / work.enough(name) for name, w in zip(names, width, strict=True))
        if worst < 1 and (best is None or worst < best[0]):
            best = worst, NextColumn(column, dict(zip(missing, width[len(fit.kept) :].tolist(), strict=True)))
    return None if best is None else best[1]


def run_of(case: Case, comm: PETSc.Comm) -> RunOfCase:
    """The run of a case; raises CaseError for one whose derivatives are not computed."""
    with options.applied(case.petsc), converged():
        return RunOfCase(case, comm)
