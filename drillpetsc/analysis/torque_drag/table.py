"""Rows of a roadmap from soft strings: loads at the rig, buckling, side forces, stress margins."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.analysis.torque_drag.batch import Batch, Columns, Hole
from drillpetsc.arrays import FloatArray

STATES = ("none", "sinusoidal", "helical")
TENSION_FRACTION = 0.9  # of the yield strength, in the overpull margin
OK = "ok"


def rows_of(
    hole: Hole, loads: Columns, batch: Batch, density: float, gravity: float, block: float = 0.0
) -> list[dict[str, Any]]:
    """One dictionary of values [SI] for each column; nan where a value does not exist.

    density: of the mud around and in the string [kg/m3], 0 without mud.
    block: weight that rests on the string where its own hook load is negative [N].
    """
    placed = loads.placed
    md = batch.md
    hook, torque = batch.tension[0], batch.torque[0]
    joint = hole.item_values("joint_length")[:, placed]
    side = np.nanmax(np.where(batch.inside, batch.contact * joint, np.nan), axis=0)
    factor, margin = _stress(hole, loads, batch, density, gravity)
    lowest = np.nanargmin(np.where(np.isnan(batch.tension), np.inf, batch.tension), axis=0)
    worst = batch.state.max(axis=0)
    out = []
    for c in range(len(placed)):
        tension = batch.tension[:, c]
        locked = batch.locked[c]
        row = {
            "hook_load": hook[c],
            "surface_torque": torque[c],
            "stretch": batch.elongation[c],
            "twist": batch.twist[c],
            "wob": loads.wob[c],
            "min_effective_tension": tension[lowest[c]],
            "md_of_min": md[lowest[c]],
            "neutral_point": neutral_point(md, tension),
            "buckling_state": STATES[worst[c]] if np.isnan(locked) else "lock_up",
            "max_side_force_per_joint": side[c],
            "min_safety_factor": factor[c],
            "overpull_margin": margin[c],
            "status": OK,
        }
        if batch.broken[c]:
            nothing = (
                "surface_torque",
                "min_effective_tension",
                "md_of_min",
                "neutral_point",
                "max_side_force_per_joint",
            )
            row |= dict.fromkeys((*nothing, "min_safety_factor", "overpull_margin"), np.nan)
        said = []
        if not np.isnan(locked):
            said.append(f"locked up: no weight passes MD {locked:.0f} m")
        elif row["hook_load"] + block < 0:
            said.append("must be pushed: the hook load is negative")
        if factor[c] < 1 and not batch.broken[c]:
            said.append("the string yields")
        row["status"] = "; ".join(said) or OK
        out.append(row)
    return out


def neutral_point(md: FloatArray, tension: FloatArray) -> float:
    """Measured depth [m] of the first place from the top without effective tension; nan where the top has none.

    md: (k+1,) [m]; tension: (k+1,) [N], nan below the lower end.  A string in tension throughout gives its lower end.
    """
    known = np.isfinite(tension)
    md, tension = md[known], tension[known]
    if not len(tension) or tension[0] <= 0:
        return float("nan")
    below = np.flatnonzero(tension <= 0)
    if not len(below):
        return float(md[-1])
    i = int(below[0])
    return float(md[i - 1] + (md[i] - md[i - 1]) * tension[i - 1] / (tension[i - 1] - tension[i]))


def _stress(
    hole: Hole, loads: Columns, batch: Batch, density: float, gravity: float
) -> tuple[FloatArray, FloatArray]:
    """(smallest safety factor, overpull margin [N]) of each column; nan without an item of known yield strength.

    With still mud of one density inside and outside, the pressures are equal and the von Mises stress of the outer fibre
    is that of the effective tension, of the bending of the hole, and of the torque (manual: sec-soft-string-stress).
    """
    placed = loads.placed
    yield_, area, radius, bore, young, pressed = (
        hole.item_values(name)[:, placed]
        for name in ("yield_strength", "worn_area", "worn_radius", "bore_radius", "young", "pressed_area")
    )
    known = batch.inside & np.isfinite(yield_)
    polar = 0.5 * np.pi * (radius**4 - bore**4)
    bending = young * radius * hole.curvature.max(axis=1)[:, None]
    position = np.asarray(hole.well.at(hole.edges)[0])[:, 2]
    pressure = density * gravity * np.maximum(position, 0.0)
    factor = np.full(len(placed), np.inf)
    margin = np.full(len(placed), np.inf)
    for ends in (slice(0, -1), slice(1, None)):
        tension, torque = batch.tension[ends], batch.torque[ends]
        stress = np.sqrt((np.abs(tension) / area + bending) ** 2 + 3 * (torque * radius / polar) ** 2)
        with np.errstate(divide="ignore"):
            here = np.where(known & np.isfinite(stress), yield_ / stress, np.inf)
        factor = np.minimum(factor, here.min(axis=0))
        wall = tension - pressure[ends][:, None] * pressed
        left = np.where(known & np.isfinite(wall), TENSION_FRACTION * yield_ * area - wall, np.inf)
        margin = np.minimum(margin, left.min(axis=0))
    none = ~known.any(axis=0)
    return np.where(none, np.nan, factor), np.where(none, np.nan, margin)
