"""What the readings of a calibration say depth by depth: the friction of windows, and that of each reading alone."""

from __future__ import annotations

import numpy as np

from drillpetsc.analysis.loads.torque_drag.readings.along_depth import Drift, drift_of, windows
from drillpetsc.analysis.loads.torque_drag.readings.calibration import (
    BOUNDS,
    FACTOR_BOUNDS,
    FACTOR_STEP,
    Calibration,
    Fit,
)
from drillpetsc.arrays import FloatArray

FEWEST_WINDOWS, DRIFT_STEPS = 5, 4  # of a drift; steps of Newton's method in each window
ALONE_GRID = 41  # friction factors from 0 to 1 between which a point alone is solved


def deepest_factor(work: Calibration, fit: Fit) -> str:
    """The friction factor of the deepest hole that readings determine; of the deepest hole if they determine none."""
    names = [name for name in fit.kept if name not in BOUNDS] or list(work.factors)
    return "open_hole" if "open_hole" in names else names[-1]


def drift_by_windows(work: Calibration, fit: Fit) -> Drift | None:
    """The deepest friction factor window by window of depth, the others as fitted; None where there are too few readings."""
    if fit.lengths is None or not set(fit.kept) - set(BOUNDS):
        return None
    name, d = deepest_factor(work, fit), work.data
    depth = np.array([work.points[i].bit_depth for i in d.point])
    parts = windows(depth)
    if len(parts) < FEWEST_WINDOWS:
        return None
    value = np.full(len(parts), fit.best[name])
    for _ in range(DRIFT_STEPS):
        sets = [{**fit.best, name: float(v) + h} for v in value for h in (0.0, FACTOR_STEP)]
        found = work.computed(sets)
        for k, rows in enumerate(parts):
            slope = (found[2 * k + 1, rows] - found[2 * k, rows]) / FACTOR_STEP / d.sigma[rows]
            away = (d.value[rows] - found[2 * k, rows]) / d.sigma[rows]
            power = float(slope @ slope)
            value[k] = np.clip(value[k] + (float(slope @ away) / power if power else 0.0), *FACTOR_BOUNDS)
    middle = np.array([depth[rows].mean() for rows in parts])
    sigma = float(fit.interval[fit.parameters.index(name)]) / 1.96
    return drift_of(name, middle, value, sigma)


def alone_by_reading(work: Calibration, fit: Fit) -> FloatArray:
    """(n,) open-hole factor at which each reading alone is met, nan where there is none in 0..1.

    Brent's method on a monotone cubic through the readings at ``ALONE_GRID`` factors.
    """
    from scipy.interpolate import PchipInterpolator
    from scipy.optimize import brentq

    d = work.data
    out = np.full(len(d.value), np.nan)
    if "open_hole" not in work.factors:
        return out
    values = {
        name: float(value)
        for name, value in zip(fit.parameters, fit.value, strict=True)
        if not np.isnan(value)
    }
    values.pop("open_hole", None)
    grid = np.linspace(0.0, 1.0, ALONE_GRID)
    table = work.computed([{**values, "open_hole": float(mu)} for mu in grid]) - d.value
    for i in range(len(d.value)):
        known = np.abs(table[:, i]) < 1e8  # the string is not locked up
        change = np.flatnonzero((np.sign(table[:-1, i]) != np.sign(table[1:, i])) & known[1:] & known[:-1])
        if not len(change) or np.ptp(table[known, i]) < 1e-6 * abs(d.value[i]):
            continue
        curve = PchipInterpolator(grid[known], table[known, i])
        out[i] = float(brentq(curve, grid[change[0]], grid[change[0] + 1]))
    return out
