"""The points of a calibration in two parts: one is fitted, the other one is predicted with what was found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.torque_drag.readings.along_depth import walk_of
from drillpetsc.analysis.loads.torque_drag.readings.calibration import FACTOR_STEP, STEP, Calibration, Fit
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, bare_number, to_si

TINY = 1e-6
BAND, BAND_SIGMAS = 0.90, 1.645  # share of readings that the band of a prediction is to hold


@dataclass(frozen=True)
class Prediction:
    """Readings that were not fitted.

    work: the points; computed: (n,) with the fitted values; band: (n,) half width of the 90 % band of a reading [N], [N m].
    """

    work: Calibration
    computed: FloatArray
    band: FloatArray

    def errors(self) -> dict[str, dict[str, Any]]:
        """By quantity: number, bias, rms, 95th percentile and largest error over the reading, share inside the band."""
        out = {}
        d = self.work.data
        for name, rows in (("hook_load", d.hook), ("surface_torque", ~d.hook)):
            if not rows.any():
                continue
            error = (self.computed - d.value)[rows]
            share = error / np.maximum(np.abs(d.value[rows]), TINY * np.abs(d.value[rows]).max())
            out[name] = {
                "readings": int(rows.sum()),
                "bias": float(share.mean()),
                "rms": float(np.sqrt(np.mean(share**2))),
                "p95": float(np.percentile(np.abs(share), 95)),
                "largest": float(np.abs(share).max()),
                "in_band": float(np.mean(np.abs(error) <= self.band[rows])),
            }
        return out


def hold_out_depth(text: str, points: tuple[MeasuredPoint, ...]) -> float:
    """Bit depth [m] of `--hold-out` below which points are predicted: a depth, or the share of the depths that is held out."""
    depths = np.array([point.bit_depth for point in points])
    share = bare_number(text)
    if share is not None and 0 < share < 1:
        at = float(depths.max() - share * np.ptp(depths))
    else:
        try:
            if share is not None:
                raise UnitError(text, "")
            at = to_si(text, "m")
        except UnitError:
            want = "a share between 0 and 1, such as 0.5, or a bit depth with its unit, such as 2150 m"
            raise CaseError(at="--hold-out", got=text, want=want) from None
    if not depths.min() < at < depths.max():
        want = f"a depth between those of the points, {depths.min():g} and {depths.max():g} m"
        raise CaseError(at="--hold-out", got=text, want=want)
    return at


def _depths(work: Calibration) -> FloatArray:
    """(n,) bit depth of each reading [m]."""
    return np.array([work.points[i].bit_depth for i in work.data.point])


def predict(fitted: Calibration, fit: Fit, held: Calibration) -> Prediction:
    """Predict points with the result of a fit to others.

    The band has the errors of the parameters and, relative to the reading and by quantity, the scatter of the fitted residuals and
    their walk: beyond the fitted depths it grows by as much as they change along the fitted ones.
    """
    best, held.fixed = fit.best, fitted.fixed
    computed = held.computed([best])[0]
    steps = [STEP.get(name, FACTOR_STEP) for name in fit.kept]
    variance = np.zeros(len(computed))
    if fit.kept:
        sets = [{**best, name: best[name] + step} for name, step in zip(fit.kept, steps, strict=True)]
        slope = (held.computed(sets) - computed) / np.array(steps)[:, None]
        covariance = fit.covariance * (1.0 if fit.lengths is not None else fit.chi2)
        variance = np.einsum("in,ij,jn->n", slope, covariance, slope)
    for rows, mine in ((held.data.hook, fitted.data.hook), (~held.data.hook, ~fitted.data.hook)):
        if rows.any() and mine.any():
            error, read = (fit.computed - fitted.data.value)[mine], fitted.data.value[mine]
            size = max(float(np.sqrt(np.mean(read**2))), TINY)
            depth, away = _depths(fitted)[mine], _depths(held)[rows]
            beyond = np.maximum(np.maximum(away - depth.max(), depth.min() - away), 0.0)
            share = np.mean(error**2) / size**2 + walk_of(depth, error / size) * beyond
            variance[rows] += share * held.data.value[rows] ** 2
    return Prediction(held, computed, BAND_SIGMAS * np.sqrt(variance))
