"""Rows of a roadmap from soft strings: loads at the rig, buckling, side forces, stress margins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.analysis.hydraulics.flow_model import string_at
from drillpetsc.analysis.loads.limits.fatigue import tension_factor
from drillpetsc.analysis.loads.limits.side_force import force_on_joint
from drillpetsc.analysis.loads.limits.strength import stresses, torque_at_yield
from drillpetsc.analysis.loads.torque_drag.batch import Batch, Columns, Hole
from drillpetsc.analysis.loads.torque_drag.string_rows import SHORTEST, StringRows
from drillpetsc.arrays import FloatArray
from drillpetsc.case.blocks.items.tubulars import Jointed
from drillpetsc.case.case import Case

STATES = ("none", "sinusoidal", "helical")
TENSION_FRACTION = 0.9  # of the yield strength, in the overpull margin
OK = "ok"
LEAST_PUSH = 1.0  # [N]; a smaller push is rounding


def rows_of(
    hole: Hole, loads: Columns, batch: Batch, mud: Pressures, block: float = 0.0
) -> list[dict[str, Any]]:
    """One dictionary of values [SI] for each column; nan where a value does not exist.

    mud: pressures in and around the strings.
    block: weight that rests on the string where its own hook load is negative [N].
    """
    placed = loads.placed
    md = batch.md
    hook, torque = batch.tension[0], batch.torque[0]
    wob = np.broadcast_to(loads.wob, len(placed))
    joint = hole.item_values("joint_length")[:, placed]
    side = [_side_force(hole, batch, joint[:, c], c) for c in range(len(placed))]
    factor, margin = stress_and_margin(hole, loads, batch, mud)
    lowest = np.nanargmin(np.where(np.isnan(batch.tension), np.inf, batch.tension), axis=0)
    worst, ratios = batch.state.max(axis=0), batch.ratios.max(axis=1)
    out = []
    for c in range(len(placed)):
        tension = batch.tension[:, c]
        locked = batch.locked[c]
        row = {
            "hook_load": hook[c],
            "surface_torque": torque[c],
            "stretch": batch.elongation[c],
            "twist": batch.twist[c],
            "wob": wob[c],
            "min_effective_tension": tension[lowest[c]],
            "md_of_min": md[lowest[c]],
            "neutral_point": neutral_point(md, tension),
            "sinusoidal_ratio": ratios[0, c],
            "helical_ratio": ratios[1, c],
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
        row["status"] = said_of(row, block, float(locked)) or OK
        out.append(row)
    return out


#: numbers of a row that a solution gives
FOUND = (
    "hook_load",
    "surface_torque",
    "stretch",
    "twist",
    "min_effective_tension",
    "md_of_min",
    "neutral_point",
    "sinusoidal_ratio",
    "helical_ratio",
    "max_side_force_per_joint",
    "min_safety_factor",
    "overpull_margin",
)


def failed(reason: str) -> dict[str, Any]:
    """Entries of a row without a solution: no number, and the reason."""
    words = " ".join(reason.partition("hint:")[0].split())
    state = "lock_up" if "locked up" in words else "none"
    return {**dict.fromkeys(FOUND, float("nan")), "buckling_state": state, "status": f"failed: {words}"}


def said_of(row: dict[str, Any], block: float, locked: float = np.nan) -> str:
    """What the status of a row must say; empty if there is nothing.

    block: weight that rests on the string [N]; locked: measured depth that no weight passes [m], nan: none.
    """
    said = []
    if not np.isnan(locked):
        said.append(f"locked up: no weight passes MD {locked:.0f} m")
    elif row["hook_load"] + block < -LEAST_PUSH:
        said.append("must be pushed: the hook load is negative")
    if row["min_safety_factor"] < 1:
        said.append("the string yields")
    return "; ".join(said)


def _side_force(hole: Hole, batch: Batch, joint: FloatArray, c: int) -> float:
    """Largest side force [N] on a joint of the string ``c``."""
    inside = batch.inside[:, c] & np.isfinite(batch.contact[:, c])
    if not inside.any():
        return float("nan")
    md = np.column_stack([hole.edges[:-1], hole.edges[1:]])[inside]
    return float(force_on_joint(md, batch.contact[inside, c] * hole.h[inside], joint[inside]).max())


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


@dataclass(frozen=True)
class Pressures:
    """At the edges of the steps, (k+1, c): pressures of the mud [Pa], and density times the square of the flow in the bore [N m2]."""

    inside: FloatArray
    outside: FloatArray
    momentum: FloatArray


def still_mud(
    hole: Hole, bores: Sequence[tuple[float, float]], densities: tuple[float, float], gravity: float
) -> Pressures:
    """Pressures of still mud inside and outside strings.

    bores: measured depths between which there is mud in each string (``mud_in_bore``) [m]; densities: inside, outside [kg/m3].
    """
    depth = np.maximum(np.asarray(hole.well.at(hole.edges)[0])[:, 2], 0.0)
    upper, lower = np.array(bores).T
    surface = np.where(upper > 0, np.asarray(hole.well.at(upper)[0])[:, 2], 0.0)
    filled = np.where(hole.edges[:, None] <= lower, np.maximum(depth[:, None] - surface, 0.0), 0.0)
    inside = gravity * densities[0] * filled
    return Pressures(
        inside, np.tile((gravity * densities[1] * depth)[:, None], len(bores)), np.zeros_like(inside)
    )


def stress_and_margin(
    hole: Hole, loads: Columns, batch: Batch, mud: Pressures
) -> tuple[FloatArray, FloatArray]:
    """(smallest safety factor, overpull margin [N]) of each column; nan without an item of known yield strength.

    The stresses are those of `limits`, with the bending moment of the hole's curvature (manual: sec-soft-string-stress).
    """
    placed = loads.placed
    names = ("yield_strength", "worn_radius", "bore_radius", "young", "pressed_area", "half_joint")
    yield_, radius, bore, young, pressed, half = (hole.item_values(name)[:, placed] for name in names)
    known = batch.inside & np.isfinite(yield_)
    stiffness = np.where(known, hole.of["bending_stiffness"][:, placed], np.nan)
    bend = young * 0.25 * np.pi * (radius**4 - bore**4) * hole.curvature.max(axis=1)[:, None]
    opening, area = np.pi * bore**2, np.pi * (radius**2 - bore**2)
    factor = np.full(len(placed), np.inf)
    margin = np.full(len(placed), np.inf)
    for ends in (slice(0, -1), slice(1, None)):
        tension, torque = batch.tension[ends], batch.torque[ends]
        inside, outside = mud.inside[ends], mud.outside[ends]
        with np.errstate(divide="ignore", invalid="ignore"):
            wall = tension + inside * opening - outside * (opening + pressed)
            wall += np.where(opening > 0, mud.momentum[ends] / opening, 0.0)
            gathered = 1 / tension_factor(np.maximum(tension, 0.0), stiffness, half)
            moment = bend * np.where(np.isfinite(gathered), gathered, 1.0)
            stress = stresses(2 * radius, 2 * bore, wall, moment, torque, inside, outside).von_mises
            here = np.where(known & np.isfinite(stress), yield_ / stress, np.inf)
        factor = np.minimum(factor, here.min(axis=0))
        left = np.where(known & np.isfinite(wall), TENSION_FRACTION * yield_ * area - wall, np.inf)
        margin = np.minimum(margin, left.min(axis=0))
    none = ~known.any(axis=0)
    return np.where(none, np.nan, factor), np.where(none, np.nan, margin)


def torque_lines(
    case: Case, strings: list[StringRows], rows: list[dict[str, Any]]
) -> dict[str, list[float | None]]:
    """Make-up torque and torque at yield [N m] of the pipe at the rig over the bit depth [m].

    rows: of the roadmap, whose largest hook load among rows with a surface torque is the pull at each bit depth; 0 where all failed.
    None where a figure is not known.  Source: API RP 7G, A.8.2 and A.9.2.
    """
    pull: dict[float, float] = {}
    for row in rows:
        if row["surface_torque"] > 0 and np.isfinite(row["hook_load"]):
            pull[row["bit_depth"]] = max(pull.get(row["bit_depth"], 0.0), row["hook_load"])
    out: dict[str, list[float | None]] = {
        "bit_depth [m]": [],
        "make_up_torque [N m]": [],
        "torque_at_yield [N m]": [],
    }
    for string in strings:
        top = next(item for item in string_at(case, string.depth).items if item.length >= SHORTEST)
        made_up = top.tool_joint.make_up_torque if isinstance(top, Jointed) else None
        limit = float("nan")
        if np.isfinite(string.yield_strength[0]):
            outer, bore = 2 * string.worn_radius[0], 2 * string.bore_radius[0]
            limit = float(torque_at_yield(outer, bore, string.yield_strength[0], pull.get(string.depth, 0.0)))
        out["bit_depth [m]"].append(string.depth)
        out["make_up_torque [N m]"].append(made_up)
        out["torque_at_yield [N m]"].append(None if np.isnan(limit) else limit)
    return out


def passed(
    lines: dict[str, list[float | None]], rows: list[dict[str, Any]]
) -> list[tuple[str, list[dict[str, Any]]]]:
    """(words of a line, rows whose surface torque is above it) for the lines that are passed."""
    out = []
    for key, words in (
        ("make_up_torque [N m]", "the make-up torque of the pipe at the rig"),
        ("torque_at_yield [N m]", "the torque at which the pipe at the rig yields"),
    ):
        limit = dict(zip(lines["bit_depth [m]"], lines[key], strict=True))
        above = [
            row
            for row in rows
            if (most := limit[row["bit_depth"]]) is not None and row["surface_torque"] > most
        ]
        if above:
            out.append((words, above))
    return out
