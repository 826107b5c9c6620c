"""Doubts about a rig's log: import log."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from drillpetsc.doubts.doubt import Values, doubt
from drillpetsc.unit_systems import System


@dataclass(frozen=True)
class Imported:
    """A log of a rig has been divided into states and points (import log).

    states: state -> rows; points: number; block: the hook load in slips is known; by_time: the index is time, else depth.
    """

    states: Mapping[str, int]
    points: int
    block: bool
    by_time: bool
    units: System = "SI"


@doubt(
    "the log makes no points for calibrate: {why}",
    "Give `--case`, whose string tells slips; a part of the log with trips, drilling or rotation off bottom (`--between`); "
    "or shorter points (`--every`).",
)
def no_points(at: Imported) -> Values:
    """No spell of the log makes a point, so there is nothing to calibrate with (manual: guide-logs)."""
    if at.points:
        return
    moving = [word for word in ("trip_in", "trip_out", "backream") if word in at.states]
    some = [word for word in (*moving, "drilling", "slide", "rotate_off") if word in at.states]
    if not some:
        why = "no row trips, drills or rotates off bottom"
        if not at.by_time:
            why += " (it is read by depth: if it has clock times, --map time=TITLE names their column, date=TITLE that of the date)"
    elif some == moving and not at.block:
        why = "trips need the hook load in slips, which is not known"
    else:
        why = f"spells of {', '.join(some)} are too short or too slow, or have neither hook load nor torque"
    yield {"why": why}
