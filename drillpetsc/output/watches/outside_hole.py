"""Watches a string without contact in a hole with mud around it: outside the hole the mud's forces mean nothing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.model.drilling_model import DrillingModel

HINT = (
    "with contact: none the string is not confined to its hole: contact: {}, or a fluid without the annulus"
)


@dataclass(frozen=True)
class Outside:
    """A point of the string outside the hole.

    beyond, distance: from the wall and from the axis of the hole [m]; depth: measured depth there [m]; time: [s].
    """

    beyond: float
    distance: float
    depth: float
    time: float


def outside(model: DrillingModel, t: float) -> Outside | None:
    """Compute the point of the local nodes that is furthest outside the hole at time ``t`` [s], None if all are inside."""
    foot = model.given_well.project(model.system.field("string.position"))
    distance = np.linalg.norm(foot.offset, axis=1)
    beyond = distance - model.given_well.radius(foot.md)
    k = int(np.argmax(beyond)) if len(beyond) else -1
    if k < 0 or beyond[k] <= 0:
        return None
    return Outside(float(beyond[k]), float(distance[k]), float(foot.md[k]), t)


def may_leave_hole(model: DrillingModel) -> bool:
    """Whether mud surrounds a string that no contact keeps in its hole."""
    return model.annulus is not None and model.contact is None and model.well is not None and model.beam.moves


def furthest_outside(model: DrillingModel) -> Outside | None:
    """The point furthest outside the hole in the present state, None if all are inside or contact keeps them there; collective."""
    return _furthest(model, outside(model, 0.0)) if may_leave_hole(model) else None


def _furthest(model: DrillingModel, here: Outside | None) -> Outside | None:
    comm = model.system.comm
    every = [here] if comm.size == 1 else comm.tompi4py().allgather(here)
    return max((p for p in every if p is not None), key=lambda p: p.beyond, default=None)


class HoleMonitor:
    """Finds when the string is furthest outside its hole during a run; nothing is computed if contact keeps it inside."""

    def __init__(self, model: DrillingModel) -> None:
        self.model = model
        self.worst: Outside | None = None
        self.watches = may_leave_hole(model)

    def update(self, t: float) -> None:
        """After an accepted step to ``t`` [s]; not collective."""
        if self.watches:
            found = outside(self.model, t)
            if found is not None and (self.worst is None or found.beyond > self.worst.beyond):
                self.worst = found

    def share(self) -> None:
        """Combine ``worst`` over all ranks; collective."""
        if self.watches:
            self.worst = _furthest(self.model, self.worst)

    def get_notes(self) -> dict[str, Any]:
        """For a checkpoint."""
        return {} if self.worst is None else dict(vars(self.worst))

    def set_notes(self, saved: dict[str, Any]) -> None:
        """Continue from ``get_notes``."""
        self.worst = Outside(**saved) if saved else None
