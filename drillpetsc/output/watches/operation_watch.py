"""Checks the rows of a run for states that a rig or a tool cannot reach: a pushing hook, a stalled motor, a shock sub on a stop.

Manual: sec-outputs-watch.  Events between two rows are not seen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.case import Case
from drillpetsc.case.blocks.ends import HeldTop
from drillpetsc.case.blocks.items.motor import PositiveDisplacementMotor
from drillpetsc.case.blocks.items.tools import ShockSub
from drillpetsc.model.tools.mud_motor import motor_law
from drillpetsc.physics.joints import STOP_ROUNDING

LEAST_PUSH = 1e3  # push at the top that is reported [N]
NEAR_STALL = 0.95  # ratio of a motor's torque to its stall torque above which it is reported: its speed is then below a fifth


@dataclass
class Spell:
    """Rows in which something holds: time of the first [s], their number, and the largest value with its time [s]."""

    first: float
    rows: int
    largest: float
    at: float


class _Sign:
    """One state to check for: the sentence about it, and its measure in the rows."""

    def __init__(self, name: str, column: int, least: float, scale: float = 1.0) -> None:
        self.name, self.column, self.least, self.scale = name, column, least, scale

    def sizes(self, rows: FloatArray) -> FloatArray:
        """(k,) measure in the ``rows`` (k, columns)."""
        return np.asarray(self.scale * rows[:, self.column])


class OperationWatch:
    """Collects from rows of history.csv what no rig or tool does; rows are on the first rank only.

    columns: names and units of the rows.
    spells, rows: what was found in how many rows.  stall_torque: of the motor [N m].  stops: shock sub and whether it is closed, by
    the name of the spell.
    """

    def __init__(self, case: Case, columns: Sequence[tuple[str, str]]) -> None:
        self.case, self.rows = case, 0
        self.spells: dict[str, Spell] = {}
        place = {name: k for k, (name, _) in enumerate(columns)}
        self._time = place["time"]
        self._signs: list[_Sign] = []
        self.stops: dict[str, tuple[ShockSub, bool]] = {}
        hung = case.well is not None and case.top.force is None and case.top.hoist is None
        if (
            hung and not isinstance(case.top, HeldTop) and "hook_load" in place
        ):  # the hoist warns if its lines go slack
            self._signs.append(_Sign("push", place["hook_load"], LEAST_PUSH, -1.0))
        self.stall_torque = 0.0
        motor = next((q for q in case.string if isinstance(q, PositiveDisplacementMotor)), None)
        if motor is not None and "motor_output_torque" in place:
            law, curve = motor_law(motor.pdm), motor.pdm.curve
            self.stall_torque = max(
                law.stall_torque(q) for q in (curve.flows if curve is not None else (0.0,))
            )
            self._signs.append(_Sign("stall", place["motor_output_torque"], NEAR_STALL * self.stall_torque))
        top = 0.0
        for item in case.string:
            if isinstance(item, ShockSub) and item.stroke is not None:
                travel = place.get(f"joint_{top + item.joint_at:g}_travel")
                for closed, end in zip((True, False), item.stroke, strict=True):
                    if travel is not None:
                        name, sign = f"stop {len(self.stops)}", -1.0 if closed else 1.0
                        self._signs.append(_Sign(name, travel, sign * end - STOP_ROUNDING, sign))
                        self.stops[name] = item, closed
            top += float(item.length)

    def update(self, rows: FloatArray) -> None:
        """Take rows (k, columns) of history.csv."""
        self.rows += len(rows)
        for sign in self._signs:
            sizes = sign.sizes(rows)
            found = np.flatnonzero(sizes > sign.least)
            if not len(found):
                continue
            times, k = rows[:, self._time], found[int(np.argmax(sizes[found]))]
            spell = self.spells.setdefault(sign.name, Spell(float(times[found[0]]), 0, -np.inf, 0.0))
            spell.rows += len(found)
            if sizes[k] > spell.largest:
                spell.largest, spell.at = float(sizes[k]), float(times[k])

    # ------------------------------------------------------------------ checkpoints
    def get_notes(self) -> dict[str, Any]:
        """For a checkpoint."""
        return {"rows": self.rows, **{k: [s.first, s.rows, s.largest, s.at] for k, s in self.spells.items()}}

    def set_notes(self, saved: dict[str, Any]) -> None:
        """Continue from ``get_notes``; if the case has changed, only with the signs still checked."""
        known = {sign.name for sign in self._signs}
        self.rows = int(saved.get("rows", 0))
        self.spells = {k: Spell(*v) for k, v in saved.items() if k in known}
