"""What the readings of a calibration say depth by depth: the friction of windows, and that of each reading alone."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.calibration.estimator import Fit
from drillpetsc.analysis.loads.torque_drag.readings.along_depth import Drift, drift_of, windows
from drillpetsc.analysis.loads.torque_drag.readings.calibration import LOCKED, Calibration
from drillpetsc.arrays import FloatArray
from drillpetsc.physics.roots import bracketed_root

FEWEST_WINDOWS, DRIFT_STEPS = 5, 4  # of a drift; steps of Newton's method in each window
SMALLEST_EFFECT = 1e-6  # of a friction factor of 1 on a reading that shows it at all [-]
ALONE_GRID = 41  # friction factors from 0 to 1 between which a point alone is solved


def deepest_factor(work: Calibration, fit: Fit) -> str:
    """The friction factor of the deepest hole that readings determine; of the deepest hole if they determine none."""
    names = [name for name in fit.kept if work.parameter(name).is_factor] or list(work.factors)
    return "open_hole" if "open_hole" in names else names[-1]


def drift_by_windows(work: Calibration, fit: Fit) -> Drift | None:
    """The deepest friction factor window by window of depth, the others as fitted; None if there are too few readings."""
    if fit.lengths is None or not any(work.parameter(name).is_factor for name in fit.kept):
        return None
    name, d = deepest_factor(work, fit), work.data
    depth = np.array([work.points[i].bit_depth for i in d.point])
    parts = windows(depth)
    if len(parts) < FEWEST_WINDOWS:
        return None
    p = work.parameter(name)
    value = np.full(len(parts), fit.best[name])

    def moved(k: int, computed: FloatArray, slopes: FloatArray) -> float:
        """The value of a window after a step of Newton's method with readings and slopes (n,) there."""
        rows = parts[k]
        slope = slopes[rows] / d.sigma[rows]
        away = (d.value[rows] - computed[rows]) / d.sigma[rows]
        power = float(slope @ slope)
        return float(np.clip(value[k] + (float(slope @ away) / power if power else 0.0), *p.bounds))

    if work.is_soft:
        for _ in range(DRIFT_STEPS):
            sets = [{**fit.best, name: float(v) + h} for v in value for h in (0.0, p.step)]
            found = work.computed(sets)
            steps = [(found[2 * k], (found[2 * k + 1] - found[2 * k]) / p.step) for k in range(len(parts))]
            value = np.array([moved(k, *step) for k, step in enumerate(steps)])
    else:
        slopes = work.slopes(fit.best, (name,))[0]
        value = np.array([moved(k, fit.computed, slopes) for k in range(len(parts))])
    middle = np.array([depth[rows].mean() for rows in parts])
    sigma = float(fit.interval[fit.parameters.index(name)]) / 1.96
    return drift_of(name, middle, value, sigma)


def alone_by_reading(work: Calibration, fit: Fit) -> FloatArray:
    """(n,) open-hole factor at which each reading alone is met, nan where there is none in 0..1.

    Brent's method on a monotone cubic through the readings of soft strings at ``ALONE_GRID`` factors; of the beam the tangent.
    """
    from scipy.interpolate import PchipInterpolator

    d = work.data
    out = np.full(len(d.value), np.nan)
    if "open_hole" not in work.factors:
        return out
    values = {
        name: float(value)
        for name, value in zip(fit.parameters, fit.value, strict=True)
        if not np.isnan(value)
    }
    if not work.is_soft:
        return _alone_by_tangent(work, fit, values)
    values.pop("open_hole", None)
    grid = np.linspace(0.0, 1.0, ALONE_GRID)
    table = work.computed([{**values, "open_hole": float(mu)} for mu in grid]) - d.value
    for i in range(len(d.value)):
        known = np.abs(table[:, i]) < 0.1 * LOCKED  # the string is not locked up
        change = np.flatnonzero((np.sign(table[:-1, i]) != np.sign(table[1:, i])) & known[1:] & known[:-1])
        if not len(change) or np.ptp(table[known, i]) < 1e-6 * abs(d.value[i]):
            continue
        curve = PchipInterpolator(grid[known], table[known, i])
        low, high = grid[change[0] : change[0] + 2].tolist()
        out[i] = bracketed_root(curve, low, high)
    return out


def _alone_by_tangent(work: Calibration, fit: Fit, values: dict[str, float]) -> FloatArray:
    """As ``alone_by_reading``, to first order about the fitted ``values``."""
    slope = work.slopes(values, ("open_hole",))[0]
    own = np.abs(slope) > SMALLEST_EFFECT * np.abs(work.data.value)
    alone = np.full(len(slope), np.nan)
    here = values.get("open_hole", work.default("open_hole"))
    alone[own] = here + (work.data.value - fit.computed)[own] / slope[own]
    return np.where((alone >= 0) & (alone <= 1), alone, np.nan)
