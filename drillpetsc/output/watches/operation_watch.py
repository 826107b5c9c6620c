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
from drillpetsc.unit_systems import shown

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
    """

    def __init__(self, case: Case, columns: Sequence[tuple[str, str]]) -> None:
        self.case, self.rows = case, 0
        self.spells: dict[str, Spell] = {}
        place = {name: k for k, (name, _) in enumerate(columns)}
        self._time = place["time"]
        self._signs: list[_Sign] = []
        self._stops: dict[str, tuple[ShockSub, bool]] = {}
        hung = case.well is not None and case.top.force is None and case.top.hoist is None
        if (
            hung and not isinstance(case.top, HeldTop) and "hook_load" in place
        ):  # the hoist warns if its lines go slack
            self._signs.append(_Sign("push", place["hook_load"], LEAST_PUSH, -1.0))
        self._stall = 0.0
        motor = next((q for q in case.string if isinstance(q, PositiveDisplacementMotor)), None)
        if motor is not None and "motor_output_torque" in place:
            law, curve = motor_law(motor.pdm), motor.pdm.curve
            self._stall = max(law.stall_torque(q) for q in (curve.flows if curve is not None else (0.0,)))
            self._signs.append(_Sign("stall", place["motor_output_torque"], NEAR_STALL * self._stall))
        top = 0.0
        for item in case.string:
            if isinstance(item, ShockSub) and item.stroke is not None:
                travel = place.get(f"joint_{top + item.joint_at:g}_travel")
                for closed, end in zip((True, False), item.stroke, strict=True):
                    if travel is not None:
                        name, sign = f"stop {len(self._stops)}", -1.0 if closed else 1.0
                        self._signs.append(_Sign(name, travel, sign * end - STOP_ROUNDING, sign))
                        self._stops[name] = item, closed
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

    def warnings(self, told: Sequence[str] = ()) -> list[str]:
        """Sentences for the summary.  told: names of signs that it already contains."""
        units, out = self.case.shown_units, []
        for name, spell in self.spells.items():
            if name in told:
                continue
            since = f"from {spell.first:.6g} s on in {100 * spell.rows / self.rows:.2g} % of the rows"
            if name == "push":
                out.append(
                    f"the top pushes the string into the hole {since}, with up to {shown(spell.largest, 'force', units, 4)} at "
                    f"{spell.at:.6g} s: a hook can only pull; the block would rest on the string"
                )
            elif name == "stall":
                out.append(
                    f"the torque of the motor is above {100 * NEAR_STALL:g} % of its stall torque "
                    f"{shown(self._stall, 'torque', units, 4)} {since}, first at {spell.first:.6g} s: the motor hardly turns, and "
                    "most of the mud leaks through it"
                )
            else:
                item, closed = self._stops[name]
                how = "closed to" if closed else "extended to"
                out.append(f"{item.name or 'shock sub'}: {how} its stop {since}: it acts as rigid there")
        return out

    # ------------------------------------------------------------------ checkpoints
    def get_notes(self) -> dict[str, Any]:
        """For a checkpoint."""
        return {"rows": self.rows, **{k: [s.first, s.rows, s.largest, s.at] for k, s in self.spells.items()}}

    def set_notes(self, saved: dict[str, Any]) -> None:
        """Continue from ``get_notes``; if the case has changed, only with the signs still checked."""
        known = {sign.name for sign in self._signs}
        self.rows = int(saved.get("rows", 0))
        self.spells = {k: Spell(*v) for k, v in saved.items() if k in known}
