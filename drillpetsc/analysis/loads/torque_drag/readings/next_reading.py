"""Which further readings would determine what the measured points do not (manual: sec-calibrate-next)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.calibration.estimator import ALIKE, Fit
from drillpetsc.analysis.calibration.words import widths_told
from drillpetsc.analysis.loads.torque_drag.readings.calibration import (
    LOCKED,
    RELATIVE_SIGMA,
    SMALLEST_SIGMA,
    Calibration,
)
from drillpetsc.analysis.loads.torque_drag.string_rows import rows_at
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.files.measured_file import OPERATIONS
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.unit_systems import shown

MOST = 6  # readings that are proposed
TURNING = ("rotate_off_bottom", "drilling", "backreaming")
OFF_BOTTOM = (
    "trip_in",
    "trip_out",
    "rotate_off_bottom",
)  # on bottom, and in reaming, readings contain the load of the bit
NOTHING_KNOWN = (
    1e-6  # precision of a parameter of which the points say nothing, in units of what determines it
)
WORDS = {"hook_load": "hook load", "surface_torque": "torque"}


@dataclass(frozen=True)
class NextReading:
    """A reading that is proposed.

    key: hook_load or surface_torque; widths: half width of the 95 % interval of each parameter that was not determined, expected with
    this reading and those proposed before it.
    """

    operation: str
    bit_depth: float
    key: str
    widths: dict[str, float]


def next_readings(work: Calibration, fit: Fit) -> list[NextReading]:
    """Up to six readings with which all parameters would be determined; none if no readings can do so.

    The information of the fitted readings, J^T J, grows by that of each reading that the soft string computes with the numbers found.
    """
    from scipy.stats import t as student

    values = {name: work.default(name) for name in fit.parameters} | work.fixed | fit.best
    names = tuple(name for name in fit.parameters if np.isfinite(values[name]))
    wanted = [k for k, name in enumerate(names) if name in fit.reasons]
    if not wanted or len(names) < len(fit.parameters):
        return []
    of_bit = any(names[k].startswith("roadmap.") for k in wanted)
    trial = _trial(work, OPERATIONS if of_bit else OFF_BOTTOM)
    if trial is None:
        return []
    goal = np.array([work.allowed(name) for name in names])
    alone = np.array([work.enough(name) for name in names]) / goal
    own = work.slopes(values, names, work.soft) / work.data.sigma * goal[:, None]
    known = np.array([1 / work.priors[q][1] if q in work.priors else 0.0 for q in names]) * goal
    power = own @ own.T / fit.readings_alike + np.diag(known**2 + NOTHING_KNOWN)
    computed, d = trial.computed([values])[0], trial.data
    least = np.where(d.hook, SMALLEST_SIGMA["hook_load"], SMALLEST_SIGMA["surface_torque"])
    sigma = np.maximum(RELATIVE_SIGMA * np.abs(computed), least)
    rows = (trial.slopes(values, names) / sigma * goal[:, None]).T
    rows[np.abs(computed) > 0.1 * LOCKED] = 0.0
    freedom, scatter = _scatter(
        own, (work.computed([values], work.soft)[0] - work.data.value) / work.data.sigma
    )
    out: list[NextReading] = []
    while len(out) < MOST:
        spread = scatter * float(student.ppf(0.975, max(freedom + len(out) + 1, 1)))
        found = [_widths(power + np.outer(row, row), spread, alone) for row in rows]
        missing = np.array([lacks[wanted] for _, lacks in found])
        best = int(np.argmin(np.maximum(np.log(missing), 0.0).sum(axis=1)))
        power += np.outer(rows[best], rows[best])
        point = trial.points[d.point[best]]
        key = "hook_load" if d.hook[best] else "surface_torque"
        expected = {names[k]: float(found[best][0][k] * goal[k]) for k in wanted}
        out.append(NextReading(point.operation, point.bit_depth, key, expected))
        if (missing[best] <= 1).all():
            return out
    return []


def _scatter(slopes: FloatArray, residual: FloatArray) -> tuple[int, float]:
    """(readings to spare, their root mean square beside the best values), of weighted slopes (k, n) and residuals (n,); at least 1."""
    left = residual - slopes.T @ np.linalg.lstsq(slopes.T, residual, rcond=None)[0]
    freedom = len(residual) - len(slopes)
    return freedom, max(float(np.sqrt(left @ left / freedom)), 1.0) if freedom > 0 else 1.0


def _widths(power: FloatArray, spread: float, alone: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(k,) half widths of the 95 % intervals, and over what determines a parameter; in units of the widest one that does.

    alone: (k,) what determines a parameter that acts like another one.
    """
    covariance = np.linalg.inv(power)
    width = spread * np.sqrt(np.diag(covariance))
    alike = np.abs(covariance) / np.sqrt(np.outer(np.diag(covariance), np.diag(covariance))) > ALIKE
    wide = width / alone
    worst = np.where(
        alike, wide, 0.0
    )  # of two that act alike both are narrow enough, or neither is determined
    np.fill_diagonal(worst, 0.0)
    twin = worst.max(axis=1)
    return width, np.maximum(width, np.where(twin > 0, np.maximum(twin, wide), 0.0))


def _trial(work: Calibration, operations: Sequence[str]) -> Calibration | None:
    """Operations at the ends of the hole's sections and at the points' least, middle and largest depth; None if there are none."""
    depths = np.array([point.bit_depth for point in work.points])
    case, end = work.case, float(work.case.given_well.survey.md[-1])
    ends = [end if section.to is None else float(section.to) for section in case.given_well.sections]
    chosen = {*np.quantile(depths, [0.0, 0.5, 1.0], method="nearest").tolist(), *ends}
    points = tuple(
        MeasuredPoint.model_validate(
            {
                "bit_depth": depth,
                "operation": word,
                "hook_load": 1.0,
                "torque": 1.0 if word in TURNING else None,
            }
        )
        for depth in sorted(chosen)
        if depth <= end and _fits(work, depth)
        for word in operations
    )
    try:
        return Calibration(case, points, work.excludes_block)
    except (CaseError, SolveError):  # no steady flow
        return None


def _fits(work: Calibration, depth: float) -> bool:
    try:
        return not rows_at(work.case, depth).misfit
    except CaseError:
        return False


def told(readings: Sequence[NextReading], work: Calibration) -> str:
    """The readings as a sentence; empty without any."""
    if not readings:
        return ""
    parts = [
        f"{WORDS[q.key]} of {q.operation} at {shown(q.bit_depth, 'length', work.units, 5)}" for q in readings
    ]
    verb = "would determine" if len(parts) == 1 else "would together determine"
    return f"{', '.join(parts)} {verb} {widths_told(work, readings[-1].widths)}"
