"""Measured points beside what the case gives at each of them: residuals, band, and their statistics (measured.csv)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.torque_drag.circulation import circulation
from drillpetsc.analysis.loads.torque_drag.operations import Pair, load_of, plan_of, running_speed
from drillpetsc.analysis.loads.torque_drag.readings.calibration import Calibration
from drillpetsc.analysis.loads.torque_drag.readings.sensor import DIRECTION, sensor_of
from drillpetsc.analysis.loads.torque_drag.string_rows import rows_at
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.unit_systems import System, plain, shown

NINETY = 1.645  # half width of a 90 % interval of a normal error [standard errors]
WORDS = {"hook_load": ("hook load", "force"), "surface_torque": ("torque", "torque")}


@dataclass(frozen=True)
class BesidePoints:
    """Rows of measured.csv [SI], and for each kind of reading bias, rms, largest residual [N], [N m] and [-] and the share in the band."""

    rows: list[dict[str, Any]]
    summary: dict[str, dict[str, Any]]

    def lines(self, units: System) -> list[str]:
        """One line for each kind of reading."""
        out = []
        for key, found in self.summary.items():
            words, kind = WORDS[key]
            bias, rms, most = (
                f"{shown(found[q], kind, units)} ({plain(100 * found[f'{q}_relative'], 2)} %)"
                for q in ("bias", "rms", "largest")
            )
            out.append(
                f"  {found['readings']} readings of {words}: computed less measured {bias} in the mean, rms {rms}, largest {most}; "
                f"{100 * found['in_band']:.0f} % in the band"
            )
        return out


def beside_points(
    case: Case,
    read: Sequence[MeasuredPoint],
    points: Sequence[MeasuredPoint],
    pairs: Sequence[Pair],
    excludes_block: bool,
) -> BesidePoints:
    """Readings beside the soft string at their depths, with their own weight and torque on bit, speed, rotation and flow.

    read: as in the file; points: the same with the weight on the hook; pairs: friction factors of the band.
    """
    possible = [i for i, point in enumerate(points) if _can_be_there(case, point)]
    rows: list[dict[str, Any]] = []
    if possible:
        rows = _rows(
            case, [read[i] for i in possible], tuple(points[i] for i in possible), pairs, excludes_block
        )
    nothing = dict.fromkeys(("computed", "residual", "sigma", "band_low", "band_high"), np.nan)
    for i in sorted(set(range(len(points))) - set(possible)):
        for key, value, weight in (
            ("hook_load", read[i].hook_load, points[i].hook_load),
            ("surface_torque", read[i].torque, points[i].torque),
        ):
            if value is not None:
                rows.append(_head(points[i], key) | {"measured": value, "corrected": weight} | nothing)
    return BesidePoints(rows, {key: q for key in WORDS if (q := _statistics(rows, key)) is not None})


def _head(point: MeasuredPoint, key: str) -> dict[str, Any]:
    return {"bit_depth": point.bit_depth, "operation": point.operation, "compared": key}


def _can_be_there(case: Case, point: MeasuredPoint) -> bool:
    """Whether the string can be at the depth of a point; the roadmap warns of points where it cannot."""
    if point.bit_depth > case.given_well.survey.md[-1] + 1e-6:
        return False
    rotation = load_of(case, plan_of(case), point.operation).rotation if point.rpm is None else point.rpm
    if point.hook_load is None and not rotation:
        return False  # a torque without rotation is not a reading
    try:
        return not rows_at(case, point.bit_depth).misfit
    except CaseError:
        return False


def _rows(
    case: Case,
    read: Sequence[MeasuredPoint],
    points: tuple[MeasuredPoint, ...],
    pairs: Sequence[Pair],
    excludes_block: bool,
) -> list[dict[str, Any]]:
    work = Calibration(case, points, excludes_block)
    computed = work.computed([{}])[0]
    own, over = work.own, []
    for pair in pairs:
        work.own = pair.friction
        over.append(work.computed([{}])[0])
    work.own = own
    d, sensor, rows = work.data, sensor_of(case), []
    drag = _running_drag(case, work, points)[d.point] * d.hook
    computed, low, high = (
        computed + drag,
        np.min([computed, *over], axis=0),
        np.max([computed, *over], axis=0),
    )
    low, high = low + drag, high + drag
    for n, (i, hook) in enumerate(zip(d.point, d.hook, strict=True)):
        key = "hook_load" if hook else "surface_torque"
        reading = read[i].hook_load if hook else read[i].torque
        # a block at rest leaves the sheaves' friction anywhere between hoisting and lowering
        least, most = sensor.range(DIRECTION[points[i].operation]) if hook else (1.0, 1.0)
        centre = sensor.factor(DIRECTION[points[i].operation]) if hook else 1.0
        wide = NINETY * d.sigma[n]
        rows.append(
            _head(points[i], key)
            | {
                "measured": reading,
                "corrected": float(d.value[n]),
                "computed": float(computed[n]),
                "residual": float(computed[n] - d.value[n]),
                "sigma": float(d.sigma[n]),
                "band_low": float(low[n] - wide - (most / centre - 1) * abs(d.value[n])),
                "band_high": float(high[n] + wide + (1 - least / centre) * abs(d.value[n])),
            }
        )
    return rows


def _running_drag(case: Case, work: Calibration, points: Sequence[MeasuredPoint]) -> FloatArray:
    """(n,) force of the displaced mud on the hook [N] at the points; its effect on the side forces is left out."""
    out = np.zeros(len(points))
    for i, point in enumerate(points):
        speed = running_speed(case, point.operation, float(work.loads[i, 2]))
        if speed:
            flow = point.flow_rate or 0.0
            moving, still = (circulation(case, point.bit_depth, flow, "measured", v) for v in (speed, 0.0))
            out[i] = still.below[0] - moving.below[0]
    return out


def _statistics(rows: Sequence[dict[str, Any]], key: str) -> dict[str, Any] | None:
    """Statistics of the readings of one kind; None without any that can be computed."""
    some = [row for row in rows if row["compared"] == key and np.isfinite(row["residual"])]
    if not some:
        return None
    residual = np.array([row["residual"] for row in some])
    value = np.array([row["corrected"] for row in some])
    relative = residual / np.maximum(np.abs(value), 1e-300)
    worst = int(np.argmax(np.abs(residual)))
    inside = [row["band_low"] <= row["corrected"] <= row["band_high"] for row in some]
    return {
        "readings": len(some),
        "bias": float(residual.mean()),
        "rms": float(np.sqrt(np.mean(residual**2))),
        "largest": float(residual[worst]),
        "bias_relative": float(relative.mean()),
        "rms_relative": float(np.sqrt(np.mean(relative**2))),
        "largest_relative": float(relative[np.argmax(np.abs(relative))]),
        "in_band": float(np.mean(inside)),
    }
