"""The `calibrate` command: friction factors from measured hook loads and torques, with intervals, as files and text."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from functools import partial
from typing import Any

import numpy as np

from drillpetsc.analysis.calibration.estimator import Fit
from drillpetsc.analysis.calibration.words import keys_of_fit, lines_of_fit, undetermined
from drillpetsc.analysis.loads.torque_drag.operations import plan_of
from drillpetsc.analysis.loads.torque_drag.readings.along_depth import RESAMPLES, Drift
from drillpetsc.analysis.loads.torque_drag.readings.by_depth import alone_by_reading, drift_by_windows
from drillpetsc.analysis.loads.torque_drag.readings.calibration import WEIGHT_ERROR, Calibration
from drillpetsc.analysis.loads.torque_drag.readings.forward_stiff import StiffForward
from drillpetsc.analysis.loads.torque_drag.readings.held_out import Prediction, hold_out_depth, predict
from drillpetsc.analysis.loads.torque_drag.readings.next_reading import next_readings, told
from drillpetsc.analysis.loads.torque_drag.readings.reading import corrected_points
from drillpetsc.analysis.loads.torque_drag.roadmap import MODELS
from drillpetsc.analysis.loads.torque_drag.string_rows import bends_left_out, cutters_left_out
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case
from drillpetsc.case.plausible.plausible_operations import readings
from drillpetsc.errors import CaseError
from drillpetsc.output.files.run_folder import CALIBRATION_TABLE
from drillpetsc.output.job import Job, RunResult
from drillpetsc.output.quantities.tables import COLUMNS
from drillpetsc.unit_systems import System, shown

FEWEST_DEPTHS = (
    30  # different bit depths from which errors are taken as correlated where the user says nothing
)


@dataclass(frozen=True)
class Choices:
    """How points are fitted.

    parameters: names of groups of sections, of numbers of the rig, or of the case; None: all friction factors.
    hold_out: text of the option, points that are predicted; correlated: errors along depth, None: if the points are many.
    priors: name -> (mean, standard deviation); model: of the string, soft or stiff.
    """

    parameters: tuple[str, ...] | None = None
    hold_out: str | None = None
    correlated: bool | None = None
    priors: dict[str, tuple[float, float]] = field(default_factory=dict)
    model: str = "soft"


def run_calibrate(
    job: Job, points: tuple[MeasuredPoint, ...] | None, choices: Choices = Choices()
) -> RunResult:
    """Fit friction factors to measured points (collective).

    points: measured; None: the case's. Every rank computes the same, the first one writes.
    """
    case = job.case
    plan, system = plan_of(case), case.shown_units
    points = plan.measured if points is None else points
    if not points:
        raise CaseError(at="--measured", want="a file of measured points, or roadmap.measured in the case")
    points = corrected_points(case, points, plan.hookload_excludes_block)
    held: tuple[MeasuredPoint, ...] = ()
    if choices.hold_out is not None:
        below = hold_out_depth(choices.hold_out, points)
        points, held = (tuple(p for p in points if (p.bit_depth > below) == out) for out in (False, True))
    forward = None if choices.model == "soft" else partial(StiffForward, comm=job.comm)
    with options_of(case):
        work = Calibration(case, points, plan.hookload_excludes_block, forward)
        rest = Calibration(case, held, plan.hookload_excludes_block, forward) if held else None
    asked = work.factors if choices.parameters is None else choices.parameters
    parameters, priors = work.asked(asked, choices.priors)
    correlated = choices.correlated
    if correlated is None:
        correlated = len({point.bit_depth for point in points}) >= FEWEST_DEPTHS
    notes = _notes(case, work, parameters)
    fit = work.fit(parameters, correlated, priors)
    drift, prediction = drift_by_windows(work, fit), None if rest is None else predict(work, fit, rest)
    warnings, further = _warnings(work, fit, parameters, drift), next_readings(work, fit)
    summary = _summary(case, work, fit, system, warnings, notes) | {"readings": len(work.data.value)}
    summary |= _of_depth(fit, drift, prediction) | {"next_readings": [asdict(q) for q in further]}
    nothing = np.full(len(fit.computed), np.nan)
    rows = _rows(work, fit.computed, nothing, alone_by_reading(work, fit), "fitted")
    if prediction is not None:
        alone = np.full(len(prediction.computed), np.nan)
        rows += _rows(prediction.work, prediction.computed, prediction.band, alone, "held_out")
    lines = _lines(work, fit, summary, told(further, work))
    return job.result(job.make_folder(), summary, lines, [(CALIBRATION_TABLE, COLUMNS["measured"], rows)])


def _rows(work: Calibration, computed: Any, band: Any, alone: Any, part: str) -> list[dict[str, Any]]:
    """Rows of calibration.csv for the readings of some points."""
    d, points = work.data, work.points
    return [
        {
            "bit_depth": points[i].bit_depth,
            "operation": points[i].operation,
            "compared": "hook_load" if d.hook[k] else "surface_torque",
            "measured": d.value[k],
            "computed": computed[k],
            "residual": computed[k] - d.value[k],
            "sigma": d.sigma[k],
            "part": part,
            "band": band[k],
            "ff_open_hole_alone": alone[k],
        }
        for k, i in enumerate(d.point)
    ]


def _of_depth(fit: Fit, drift: Drift | None, prediction: Prediction | None) -> dict[str, Any]:
    """What is along depth, for `summary.json`: correlation of the errors, drift, points that were held out."""
    out: dict[str, Any] = dict.fromkeys(("correlation_length", "block", "resamples", "drift", "hold_out"))
    out["errors"] = "independent" if fit.lengths is None else "correlated"
    if fit.lengths is not None:
        found = fit.lengths
        out["correlation_length"] = {
            name: {
                "readings": found.count[name],
                "raw [m]": found.raw[name],
                "detrended [m]": found.detrended[name],
                "effective": found.effective[name],
            }
            for name in found.raw
        }
        out["block"], out["resamples"] = fit.block, RESAMPLES
    if drift is not None:
        out["drift"] = {
            "parameter": drift.name,
            "drifts": drift.drifts,
            "depth [m]": drift.middle.tolist(),
            "value": drift.value.tolist(),
            "slope [1/m]": drift.slope,
            "rank_correlation": drift.rank,
        }
    if prediction is not None:
        out["hold_out"] = prediction.errors()
    return out


def _notes(case: Case, work: Calibration, parameters: tuple[str, ...]) -> list[str]:
    notes = []
    block = None if case.rig is None else case.rig.block_weight
    if (
        block is None
        and not work.excludes_block
        and "block_weight" not in parameters
        and work.data.hook.any()
    ):
        notes.append("no rig.block_weight: measured hook loads are taken as those of the string alone")
    if case.fluid is not None and work.still:
        where = f" in {', '.join(work.still)}" if work.pumped else ""
        notes.append(f"the mud stands still{where}: forces of the flow on the string are left out")
    idle = [
        p
        for p, turns in zip(work.points, work.loads[:, 3], strict=True)
        if p.torque is not None and not turns
    ]
    if idle:
        which = ", ".join(dict.fromkeys(p.operation for p in idle))
        notes.append(
            f"{len(idle)} torques without rotation ({which}) are not fitted: they do not depend on friction"
        )
    some = [p for p in work.points if p.operation in ("drilling", "sliding")]
    if any(p.wob is None for p in some):
        notes.append("drilling or sliding points without wob take the roadmap's")
    if any(p.torque is not None and p.tob is None for p in some):
        notes.append(
            "torque while drilling or sliding without tob: the torque on bit of the roadmap is taken"
        )
    if any(item.friction is not None for item in case.string):
        notes.append("items with a friction of their own keep it")
    return notes + cutters_left_out(case) + (bends_left_out(case) if work.is_soft else [])


def _warnings(work: Calibration, fit: Fit, parameters: tuple[str, ...], drift: Drift | None) -> list[str]:
    out = undetermined(work, fit)
    if not {"block_weight", "weight_factor"} & set(parameters):
        out += _weight_error(work)
    if drift is not None and drift.drifts:
        ends = f"{drift.value[0]:.3f} to {drift.value[-1]:.3f}"
        where = " to ".join(
            shown(float(q), "length", work.units, 4) for q in (drift.middle[0], drift.middle[-1])
        )
        out.append(
            f"{drift.name} drifts with depth: {ends} from {where}, {100 * drift.slope:+.3g} per 100 m; one number does not hold "
            "for all depths, nor below the deepest point"
        )
    end = None if work.case.well is None else float(work.case.well.survey.md[-1])
    out += readings(work.points, end, work.units)
    if fit.chi2 > 4:
        out.append(
            f"the misfit is {np.sqrt(fit.chi2):.1f} standard errors: the model does not explain the points"
        )
    return out


def _weight_error(work: Calibration) -> list[str]:
    """Warn where the hook loads of rotating off bottom, which no friction changes, are not those computed."""
    off = [(point, point.hook_load or 0.0, computed) for point, computed in work.weight_misfit()]
    weights = np.array([[read - work.block, computed - work.block] for _, read, computed in off])
    if not off or abs(weights[:, 1].sum() / max(weights[:, 0].sum(), 1.0) - 1) <= WEIGHT_ERROR:
        return []
    point, read, computed = max(off, key=lambda row: abs(row[2] - row[1]))
    share, more = computed / read - 1 if read else np.inf, "above" if computed > read else "below"
    block = f", {abs(weight_share(work, read, computed)):.1%} of the string's weight" if work.block else ""
    text = (
        f"rotating off bottom at {shown(point.bit_depth, 'length', work.units, 5)} the computed hook load, "
        f"{shown(computed, 'force', work.units)}, is {abs(share):.1%} {more} the measured one, "
        f"{shown(read, 'force', work.units)}{block}: an error of the weight (mud, pipe, block), which friction factors must not "
        "absorb; --fit weight_factor or block_weight fits it"
    )
    gaps = weights[:, 1] - weights[:, 0]
    if work.block and np.abs(gaps - work.block).max() < 0.5 * np.abs(gaps).min():
        text += (
            f"; the difference is about rig.block_weight, {shown(work.block, 'force', work.units)}: were the hook loads read "
            "without the block (roadmap.hookload_excludes_block: true)?"
        )
    return [text]


def weight_share(work: Calibration, read: float, computed: float) -> float:
    """Difference of two hook loads [N] over the measured weight of the string without the block [-]."""
    return (computed - read) / max(abs(read - work.block), 1.0)


def _summary(
    case: Case, work: Calibration, fit: Fit, system: System, warnings: list[str], notes: list[str]
) -> dict[str, Any]:
    return {
        "title": case.title,
        "units": system,
        "model": "soft" if work.is_soft else "stiff",
        **keys_of_fit(work, fit),
        "warnings": warnings,
        "notes": notes,
    }


def _lines(work: Calibration, fit: Fit, summary: dict[str, Any], further: str) -> list[str]:
    lines = [
        f"{work.case.title or 'case'}: calibration with {len(work.data.value)} readings of {len(work.points)} points"
        + ("" if work.is_soft else f", {MODELS['stiff']}")
    ]
    lines += lines_of_fit(work, fit)
    for name, row in (summary["correlation_length"] or {}).items():
        lines.append(
            f"  {name}: errors correlated over {row['raw [m]']:.3g} m, {row['detrended [m]']:.3g} m without their trend; "
            f"{row['readings']} readings count as {row['effective']:.2g}"
        )
    for name, row in (summary["hold_out"] or {}).items():
        lines.append(
            f"  held out, {name.replace('_', ' ')}: {row['readings']} readings, bias {row['bias']:+.2%}, rms {row['rms']:.2%}, 95 % "
            f"within {row['p95']:.2%}, largest {row['largest']:.2%}; {row['in_band']:.0%} inside the 90 % band"
        )
    return lines + ([f"  next: {further}"] if further else [])
