"""What every calibration says of its fit: lines on the screen, keys of summary.json, warnings."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.analysis.calibration.estimator import Estimator, Fit


def undetermined(work: Estimator, fit: Fit) -> list[str]:
    """Warnings on parameters that are not determined."""
    out = []
    for name, reason in fit.reasons.items():
        held = work.default(name)
        also = not np.isnan(fit.value).all() and np.isfinite(held)
        words = work.parameter(name).shown(held, work.units)
        out.append(
            f"{name} is not determined: {reason}"
            + (f"; the others are found with {words} of the case" if also else "")
        )
    return out


def keys_of_fit(work: Estimator, fit: Fit) -> dict[str, Any]:
    """Keys of summary.json that tell the fit."""

    def plain(x: float) -> float | None:
        return None if np.isnan(x) else float(x)

    return {
        "fit": {
            name: {
                "value": plain(value),
                "interval": None if np.isnan(width) else [float(value - width), float(value + width)],
                "independent_interval": None if np.isnan(own) else [float(value - own), float(value + own)],
                "unit": work.parameter(name).si_unit,
                "status": _status(fit, name),
            }
            for name, value, width, own in zip(
                fit.parameters, fit.value, fit.interval, fit.independent, strict=True
            )
        },
        "parameters": list(fit.parameters),
        "correlation": [[plain(x) for x in row] for row in fit.correlation],
        "reduced_chi2": plain(fit.chi2),
    }


def _status(fit: Fit, name: str) -> str:
    if name in fit.reasons:
        return f"not determined: {fit.reasons[name]}"
    return "prior kept" if name in fit.priors else "determined"


def widths_told(work: Estimator, widths: dict[str, float]) -> str:
    """Half widths [SI] by parameter, as they are expected."""
    return ", ".join(f"{name} to +-{work.parameter(name).shown(w, work.units)}" for name, w in widths.items())


def lines_of_fit(work: Estimator, fit: Fit) -> list[str]:
    """Parameters with their intervals, the misfit and the correlations."""
    system, lines = work.units, list[str]()
    for name, value, width, own in zip(fit.parameters, fit.value, fit.interval, fit.independent, strict=True):
        p = work.parameter(name)
        (scale, unit), words = p.unit(system), p.words
        unit = f" {unit}" if unit else ""
        if np.isnan(value):
            lines.append(f"  {words:<22} not determined: {fit.reasons[name]}")
        elif np.isnan(width):
            lines.append(
                f"  {words:<22} {value / scale:10.4g}{unit}   no interval: as many unknowns as readings"
            )
        else:
            a, b = (value - width) / scale, (value + width) / scale
            more = f"; the prior is kept: the {work.noun} add nothing" if name in fit.priors else ""
            if fit.lengths is not None:
                more = f" ({(value - own) / scale:.4g} to {(value + own) / scale:.4g} were the errors independent){more}"
            lines.append(
                f"  {words:<22} {value / scale:10.4g}{unit}   95 % interval {a:.4g} to {b:.4g}{more}"
            )
    if not np.isnan(fit.chi2):
        lines.append(f"  reduced chi2 {fit.chi2:.3g}")
    kept = [fit.parameters.index(name) for name in fit.kept]
    for a, i in enumerate(kept):
        for j in kept[a + 1 :]:
            lines.append(
                f"  correlation of {fit.parameters[i]} and {fit.parameters[j]}: {fit.correlation[i, j]:.3f}"
            )
    return lines
