"""Estimated time error of the main outputs of a run, and the vibrations that its steps damp.

Manual: sec-time-output-error, sec-time-damping.
"""

from __future__ import annotations

from collections.abc import Mapping
from math import log, log2, pi
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.solvers.time.local_error import BdfOutputErrors, OutputErrors
from drillpetsc.unit_systems import plain

#: an output whose range is below this fraction of its size, or below the value of its unit, does not move: what is
#: left is rounding
CONSTANT, SMALLEST_RANGE = 1e-6, {"N": 1e-4, "N m": 1e-4, "Pa": 1e-2, "rad/s": 1e-6}
SMALLEST_RANGE_SI = 1e-12  # of all other units
#: a local error above this fraction of the range is a switch between two steps, e.g. of friction
SWITCH = 0.05
#: loss of amplitude in a period from which on a vibration is called damped [-]
LOSS = 0.01
#: share of the size of an output below which its range does not matter to a report
SMALL_RANGE = 1e-3
REPORTED = 0.01  # estimated error over range from which on a report names an output
SHOWN = 3  # outputs in the report of a run
BATCH = 64  # steps that are evaluated together
#: steps are counted in classes of a quarter of an octave, the first one of 2^-40 s
CLASSES_PER_OCTAVE, FIRST_OCTAVE, CLASSES = 4, -40, 4 * 64
MEANING = (
    "estimated error of each output by the time steps.  error, and share of the range: at an instant, if the motion does not damp or "
    "amplify errors; errors of phase add up.  pace: of the size and the speed of its changes, errors of a step over the change in it.  "
    "Damping makes the error at an instant smaller, instability and impacts larger; --check-tolerance measures it"
)


class TimeError:
    """Sums of the local errors of outputs over the steps of a run, and sums of its steps.

    formula: the errors of its time formula, or the order of BDF.
    names, units: of the outputs.
    sizes: numbers of each output in the values, e.g. 3 for a position.
    """

    def __init__(
        self, formula: OutputErrors | int, names: list[str], units: list[str], sizes: list[int]
    ) -> None:
        self.formula = BdfOutputErrors(formula) if isinstance(formula, int) else formula
        self.names, self.units = names, units
        self._ends = np.cumsum([0, *sizes])
        self._times: list[
            float
        ] = []  # of the last steps, with their values; the last ``_new`` are not evaluated
        self._values: list[FloatArray] = []
        self._new = 0
        n = self._ends[-1]
        self._switched = np.zeros(len(names))  # part of the sum in steps in which an output switches
        self._sum, self._low, self._high = np.zeros(len(names)), np.full(n, np.inf), np.full(n, -np.inf)
        self._way = np.zeros(len(names))  # sum of the changes in the steps with a local error
        self._step_time, self._step_moment = (
            np.zeros(CLASSES),
            np.zeros(CLASSES),
        )  # sums of h and of h^2 by class
        self._steps = self._estimated = 0

    def step(self, t: float, dt: float, values: FloatArray, fresh: bool) -> None:
        """Count an accepted step of ``dt`` [s] that ends at ``t`` [s].

        values: (n,) of the outputs; fresh: the first step after the formula was restarted.
        """
        if fresh or len(self._times) > BATCH:
            self._evaluate()
        if fresh:
            self._times.clear()
            self._values.clear()
            self._new = 0
        self._steps += 1
        k = min(max(int((log2(dt) - FIRST_OCTAVE) * CLASSES_PER_OCTAVE), 0), CLASSES - 1)
        self._step_time[k] += dt
        self._step_moment[k] += dt * dt
        self._times.append(t)
        self._values.append(values)
        self._new += 1

    def _evaluate(self) -> None:
        """Add the local errors of the steps that were counted since the last call."""
        if not self._new:
            return
        new, self._new = np.array(self._values[-self._new :]), 0
        np.minimum(self._low, new.min(axis=0), out=self._low)
        np.maximum(self._high, new.max(axis=0), out=self._high)
        if len(self._times) > self.formula.earlier:
            e = self.formula.local_errors(np.array(self._times), np.array(self._values))
            size = np.sqrt(np.add.reduceat(e * e, self._ends[:-1], axis=1))
            extent = np.maximum.reduceat(self._high - self._low, self._ends[:-1])
            self._sum += size.sum(axis=0)
            change = np.diff(np.array(self._values), axis=0)[self.formula.earlier - 1 :]
            self._way += np.sqrt(np.add.reduceat(change * change, self._ends[:-1], axis=1)).sum(axis=0)
            self._switched += np.where(size > SWITCH * extent, size, 0.0).sum(axis=0)
            self._estimated += len(e)
        kept = self.formula.earlier  # earlier states of the next step
        del self._times[:-kept], self._values[:-kept]

    def summary(self) -> dict[str, Any]:
        """For summary.json: estimated error, range and their quotient by output; steps with and without an estimate.

        An output that switches between steps, like the torque of dry friction, has no Taylor series for the
        estimate: its error is None.  So are all errors if no step has an estimate: it needs steps before it without a jump.
        """
        self._evaluate()
        outputs: dict[str, dict[str, Any]] = {}
        for k, name in enumerate(self.names):
            part = slice(self._ends[k], self._ends[k + 1])
            extent = float(np.max(self._high[part] - self._low[part]))
            size = float(np.max(np.abs([self._high[part], self._low[part]])))
            if not np.isfinite(extent) or extent <= max(CONSTANT * size, smallest_range(self.units[k])):
                continue
            error = 0.5 * pi * self.formula.accumulation * float(self._sum[k])
            column = outputs.setdefault(
                f"{name} [{self.units[k]}]",
                {"range": extent, "size": size, "error": None, "share": None, "pace": None},
            )
            if self._estimated and self._switched[k] <= 0.5 * self._sum[k]:
                way = float(self._way[k])
                pace = self.formula.accumulation * float(self._sum[k]) / way if way > 0 else 0.0
                column |= {"error": error, "share": error / extent, "pace": pace}
        return {
            "meaning": MEANING,
            "steps": self._estimated,
            "steps_without": self._steps - self._estimated,
            "columns": outputs,
        }

    def damped_above(self) -> float | None:
        """Frequency [Hz] above which the formula removes more than ``LOSS`` of an amplitude in a period.

        It belongs to the median of the steps by time: half of the time it is lower.
        None for orders above 2, which do not damp such vibrations, for other formulas, which provide it themselves, and
        before the first step.
        """
        product = self.damped_product()
        if product is None or not self._step_time.any():
            return None
        passed = np.cumsum(self._step_time)
        k = int(np.searchsorted(passed, 0.5 * passed[-1]))
        return product * float(self._step_time[k] / self._step_moment[k])

    def damped_product(self) -> float | None:
        """Product of that frequency and the step [-]; None as in ``damped_above``."""
        order = self.formula.order if isinstance(self.formula, BdfOutputErrors) else np.inf
        return damped_frequency(int(order), 1.0) if order <= 2 else None

    def get_state(self) -> dict[str, FloatArray]:
        """For a checkpoint; the same on all ranks."""
        self._evaluate()
        return {
            "time_error": np.array([self._steps, self._estimated]),
            "time_error_steps": np.array([self._step_time, self._step_moment]),
            "time_error_sums": np.array([self._sum, self._switched, self._way]),
            "time_error_range": np.array([self._low, self._high]),
            "time_error_values": np.array([[t, *x] for t, x in zip(self._times, self._values, strict=True)]),
        }

    def set_state(self, saved: dict[str, FloatArray]) -> None:
        """Continue from a checkpoint; one without these entries starts from zero."""
        if "time_error" not in saved or saved["time_error_sums"].shape != (3, len(self._sum)):
            return
        self._steps, self._estimated = map(int, saved["time_error"])
        self._step_time, self._step_moment = np.array(saved["time_error_steps"])
        self._sum, self._switched, self._way = np.array(saved["time_error_sums"])
        self._low, self._high = np.array(saved["time_error_range"])
        self._times = [float(row[0]) for row in saved["time_error_values"]]
        self._values = [np.array(row[1:]) for row in saved["time_error_values"]]


def damped_frequency(order: int, step: float) -> float:
    """Compute the frequency [Hz] at which BDF takes ``LOSS`` of an amplitude in a period (manual: eq-time-damping).

    order: 1 or 2; step: [s].
    """
    loss = -log(1.0 - LOSS)
    phase = loss / pi if order == 1 else (2.0 * loss / pi) ** (1 / 3)
    return phase / (2.0 * pi * step)


def smallest_range(unit: str) -> float:
    """Return the range [SI] up to which an output of this unit does not move but for rounding."""
    return SMALLEST_RANGE.get(unit, SMALLEST_RANGE_SI)


def doubtful_outputs(estimate: Mapping[str, Any]) -> list[tuple[str, float]]:
    """Names and estimated errors over range of the outputs that a report names, the largest first.

    estimate: as returned by ``TimeError.summary``.
    """
    found = [
        (title.partition(" [")[0], column["share"])
        for title, column in estimate["columns"].items()
        if column["share"] is not None
        and column["share"] > REPORTED
        and column["range"] > SMALL_RANGE * column["size"]
    ]
    return sorted(found, key=lambda pair: -pair[1])


def time_error_lines(estimate: Mapping[str, Any], checked: bool = False) -> list[str]:
    """Lines for the screen: the largest estimated errors.

    estimate: as returned by ``TimeError.summary``; checked: it is also measured.
    """
    hint = "" if checked else " (run --check-tolerance measures it)"
    without = estimate["steps_without"]
    if not estimate["steps"] and estimate["columns"]:
        return [f"  time error: no estimate, {without} steps are too few for one{hint}"]
    jumping = [
        title.partition(" [")[0]
        for title, c in estimate["columns"].items()
        if c["share"] is None and c["range"] > SMALL_RANGE * c["size"]
    ]
    none_of = f"no estimate of {', '.join(jumping)}, which jumps between steps"
    if all(c["share"] is None for c in estimate["columns"].values()):
        return [f"  time error: {none_of}{hint}"] if jumping else []
    if jumping:
        hint = f"; {none_of}{hint}"
    left_out = f", {without} steps without an estimate left out" if without > estimate["steps"] else ""
    doubtful = doubtful_outputs(estimate)
    if not doubtful:
        return [
            f"  time error, estimated: at most {100 * REPORTED:g} % of the range of each {'other ' if jumping else ''}main output"
            f"{left_out}{hint if jumping else ''}"
        ]
    pace = {title.partition(" [")[0]: c["pace"] for title, c in estimate["columns"].items()}
    named = ", ".join(
        f"{name} {plain(100 * pace[name], 1)} % in size and pace, {_at_an_instant(share)}"
        for name, share in doubtful[:SHOWN]
    )
    return [f"  time error, estimated: {named}{left_out}{hint}"]


def _at_an_instant(share: float) -> str:
    """Sentence on the accuracy of an output at an instant, from its estimated error over its range."""
    return (
        f"{plain(100 * share, 2)} % of its range at an instant"
        if share < 1
        else "not determined at an instant"
    )
