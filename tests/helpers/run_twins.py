"""Twins of `calibrate --model dynamic`: logs of runs whose numbers are known, with noise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from petsc4py import PETSc

from drillpetsc.analysis.calibration.estimator import Fit
from drillpetsc.analysis.calibration.log_series import LogSeries, scatter_of_rows
from drillpetsc.analysis.calibration.of_runs import RunCalibration, Values, fit_run, run_of
from drillpetsc.analysis.sensitivities.keys import changed_case, key_of
from drillpetsc.analysis.sensitivities.motion.run_of_case import RunOfCase, RunSeries
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case


class NearTruth(RunCalibration):
    """A calibration whose runs are one run and its derivatives: a fit to noise then costs nothing, and has the same intervals."""

    def __init__(self, run: RunOfCase, log: LogSeries, truth: Mapping[str, float]) -> None:
        super().__init__(run, log)
        self.truth, self.names_of_truth = truth, list(truth)
        self.at_truth = super()._run(dict(truth), tuple(truth), ())

    def _run(self, values: Values, names: tuple[str, ...], more: tuple[str, ...]) -> RunSeries:
        away = [values.get(name, self.default(name)) - true for name, true in self.truth.items()]
        some = [self.names_of_truth.index(name) for name in names]
        about = self.at_truth
        assert about is not None and not more
        keys = [about.keys[k] for k in some]
        return replace(
            about, values=about.values + about.slopes @ away, slopes=about.slopes[:, :, some], keys=keys
        )


@dataclass(frozen=True)
class RunTwin:
    """A run with known numbers.  truth: by name [SI]; columns: that are read at ``times`` (m,) [s]."""

    case: Case
    truth: Mapping[str, float]
    columns: Sequence[str]
    times: FloatArray

    def clean(self) -> list[FloatArray]:
        """The columns (m,) without noise."""
        true = changed_case(self.case, {key_of(self.case, name): value for name, value in self.truth.items()})
        series = run_of(true, PETSc.COMM_SELF).series([], self.columns, end=float(self.times[-1]))
        return [np.interp(self.times, series.times, series.values[:, j]) for j in range(len(self.columns))]

    def log(self, clean: Sequence[FloatArray], share: float, seed: int, memory: float = 0.0) -> LogSeries:
        """A log with noise of a ``share`` of each column's range, an autoregression with this ``memory``."""
        draw = np.random.default_rng(seed)
        count, noisy = len(self.times), []
        for column in clean:
            noise = draw.standard_normal(count)
            for i in range(1, count):
                noise[i] = memory * noise[i - 1] + np.sqrt(1 - memory**2) * noise[i]
            noisy.append(column + share * np.ptp(column) * noise)
        number = np.repeat(np.arange(len(self.columns)), count)
        time = np.tile(self.times, len(self.columns))
        scatter = np.array([scatter_of_rows(column) for column in noisy])
        return LogSeries(
            Path("twin.csv"), tuple(self.columns), number, time, np.concatenate(noisy), scatter, ()
        )

    def fits(self, whole: int, seeds: range, share: float, memory: float = 0.0) -> list[Fit]:
        """Fits of all numbers from the case's values on, one a seed; after the first ``whole`` by the run to first order about the truth."""
        clean = self.clean()
        run, log = run_of(self.case, PETSc.COMM_SELF), self.log(clean, share, seeds[0], memory)
        works = [RunCalibration(run, log)] * whole + [NearTruth(run, log, self.truth)] * (len(seeds) - whole)
        out = []
        for seed, work in zip(seeds, works, strict=True):
            work.read(self.log(clean, share, seed, memory))
            out.append(fit_run(work, tuple(self.truth), True, {}))
        return out

    def held(self, fits: Sequence[Fit], independent: bool = False) -> list[int]:
        """How many 95 % intervals hold each number."""
        true = np.array(list(self.truth.values()))
        widths = [fit.independent if independent else fit.interval for fit in fits]
        inside = [np.abs(fit.value - true) <= width for fit, width in zip(fits, widths, strict=True)]
        return [int(q) for q in np.sum(inside, axis=0)]
