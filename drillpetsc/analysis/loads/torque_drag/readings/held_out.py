"""The points of a calibration in two parts: one is fitted, the other one is predicted with what was found."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.analysis.calibration.estimator import Fit
from drillpetsc.analysis.loads.torque_drag.readings.by_depth import deepest_factor
from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.analysis.loads.torque_drag.readings.model_error import ModelError, relative
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.errors import CaseError
from drillpetsc.units import UnitError, bare_number, to_si

TINY = 1e-6
BAND, BAND_SIGMAS = 0.90, 1.645  # share of readings that the band of a prediction is to hold


@dataclass(frozen=True)
class Prediction:
    """Readings that were not fitted.

    work: the points; computed: (n,) expected readings; band: (n,) half width of the 90 % band of a reading [N], [N m].
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


def predict(fitted: Calibration, fit: Fit, held: Calibration) -> Prediction:
    """Predict points with the result of a fit to others.

    Errors of the fitted readings are carried on along depth by `ModelError`, which gives the band, too.
    """
    held.fixed = fitted.fixed
    names = (*fit.kept, *fitted.fixed)
    values, deepest = {**fit.best, **fitted.fixed}, deepest_factor(fitted, fit)
    known = np.array([fitted.priors[q][1] ** -2 if q in fitted.priors else 0.0 for q in names])
    away = np.array([fitted.priors[q][0] - values[q] if q in fitted.priors else 0.0 for q in names])
    error = ModelError(relative(fitted, values, names, deepest), known, away)
    rest = relative(held, values, names, deepest)
    mean, sigma = error.predict(rest)
    computed = held.computed([values])[0]
    return Prediction(held, computed + mean * rest.size, BAND_SIGMAS * sigma * rest.size)
