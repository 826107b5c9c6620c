"""Measured points beside a roadmap: what its curves give at their depths, and points that lie far off."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.analysis.loads.torque_drag.readings.calibration import RELATIVE_SIGMA, SMALLEST_SIGMA
from drillpetsc.case.blocks.roadmap import MeasuredPoint
from drillpetsc.case.plausible.plausible_operations import readings
from drillpetsc.unit_systems import System, shown

FAR = 3.0  # standard errors of a reading between it and the nearest curve
MOST_LINES = 12  # readings on the screen
WORDS = {"hook_load": ("hook load", "force"), "surface_torque": ("torque", "torque")}


@dataclass(frozen=True)
class Reading:
    """One reading beside the curves of its operation.

    key: hook_load or surface_torque; value: as read; low, high: range of the curves over the friction factors there, nan where
    the roadmap has none [N], [N m]; sigma: standard error of the reading.
    """

    point: MeasuredPoint
    key: str
    value: float
    low: float
    high: float
    sigma: float

    @property
    def off(self) -> float:
        """Signed distance to the nearest curve [N], [N m]: positive above all of them, 0 between them; nan without curves."""
        return max(self.value - self.high, 0.0) - max(self.low - self.value, 0.0)


def beside_curves(
    rows: Sequence[dict[str, Any]], points: Sequence[MeasuredPoint], block: float
) -> list[Reading]:
    """Readings with the range of the curves at their depths.

    rows: of the roadmap, in SI; block: weight that the measured hook loads contain [N].
    """
    curves: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for row in rows:
        pair = f"{row['ff_cased']} {row['ff_open_hole']} {row['ff_groups']}"
        curves.setdefault((row["operation"], pair), []).append(row)
    out = []
    for point in points:
        read = {"hook_load": point.hook_load, "surface_torque": point.torque}
        for key, value in read.items():
            if value is None:
                continue
            found = [
                _at(curve, key, point.bit_depth) for (o, _), curve in curves.items() if o == point.operation
            ]
            known = [q for q in found if np.isfinite(q)]
            shift = block if key == "hook_load" else 0.0
            low, high = (min(known) + shift, max(known) + shift) if known else (np.nan, np.nan)
            sigma = max(RELATIVE_SIGMA * abs(value), SMALLEST_SIGMA[key])
            if key == "hook_load" and point.sigma is not None:
                sigma = point.sigma
            out.append(Reading(point, key, value, low, high, sigma))
    return out


def _at(curve: list[dict[str, Any]], key: str, depth: float) -> float:
    """A curve between its bit depths; nan above the first and below the last one."""
    known = sorted((row["bit_depth"], row[key]) for row in curve if np.isfinite(row[key]))
    if not known:
        return np.nan
    md, values = np.array(known).T
    if not md[0] - 1e-6 <= depth <= md[-1] + 1e-6:
        return np.nan
    return float(np.interp(depth, md, values))


def measured_lines(found: Sequence[Reading], units: System) -> list[str]:
    """A line for each reading: as read, and as computed over the friction factors."""
    lines = []
    for q in found[:MOST_LINES]:
        words, kind = WORDS[q.key]
        place = f"MD {shown(q.point.bit_depth, 'length', units, 5)}"
        low, high = shown(q.low, kind, units), shown(q.high, kind, units)
        computed = low if low == high else f"{low.split()[0]} to {high}"
        computed = f"computed {computed}" if np.isfinite(q.low) else "no curve there"
        lines.append(
            f"  measured {q.point.operation} at {place}: {words} {shown(q.value, kind, units)}, {computed}"
        )
    if len(found) > MOST_LINES:
        lines.append(f"  ... and {len(found) - MOST_LINES} more readings")
    return lines


def measured_warnings(
    found: Sequence[Reading],
    points: Sequence[MeasuredPoint],
    hole: float | None,
    block: float | None,
    excludes: bool,
    units: System,
) -> list[str]:
    """What is wrong with the points: below the hole, swapped, far off the curves, read without the block.

    hole: end of the hole [m]; block: rig.block_weight [N]; excludes: hookload_excludes_block.
    """
    out = readings(points, hole, units)
    absent = [
        q.point for q in found if np.isnan(q.low) and (hole is None or q.point.bit_depth <= hole + 1e-6)
    ]
    if absent:
        words = ", ".join(dict.fromkeys(point.operation for point in absent))
        out.append(
            f"{len(absent)} readings ({words}) have no curve: the roadmap has no such operation or bit depth"
        )
    hooks = [q for q in found if q.key == "hook_load" and np.isfinite(q.low)]
    far = [q for q in found if np.isfinite(q.low) and abs(q.off) > FAR * q.sigma]
    if far:
        worst = max(far, key=lambda q: abs(q.off) / q.sigma)
        words, kind = WORDS[worst.key]
        nearest = worst.high if worst.off > 0 else worst.low
        out.append(
            f"{len(far)} of {len(found)} readings lie far off the curves, more than {FAR:g} standard errors: first "
            f"{worst.point.operation} at MD {shown(worst.point.bit_depth, 'length', units, 5)}, {words} "
            f"{shown(worst.value, kind, units)} against {shown(nearest, kind, units)}"
        )
    if block and hooks and any(q.key == "hook_load" for q in far):
        gaps = np.array([q.value - 0.5 * (q.low + q.high) for q in hooks])
        other = gaps - block if excludes else gaps + block
        if np.abs(other).max() < 0.5 * np.abs(gaps).min():
            state = "false" if excludes else "true"
            out.append(
                f"with hookload_excludes_block: {state} the measured hook loads lie nearer: the difference is about "
                f"rig.block_weight, {shown(block, 'force', units)}"
            )
    return out
