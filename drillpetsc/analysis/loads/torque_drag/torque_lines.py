"""What the pipe at the rig bears in torque: lines in the picture of the surface torque of a roadmap."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.analysis.hydraulics.flow_model import string_at
from drillpetsc.analysis.loads.limits.strength import torque_at_yield
from drillpetsc.analysis.loads.torque_drag.string_rows import SHORTEST, StringRows
from drillpetsc.case.blocks.items.tubulars import Jointed
from drillpetsc.case.case import Case


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
