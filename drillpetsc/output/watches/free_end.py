"""A free lower end that passes the end of its hole, which nothing in the model stops (manual: sec-outputs-watch)."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.case.blocks.ends import HeldBottom
from drillpetsc.model.drilling_model import DrillingModel

BEYOND = 1e-3  # distance below the end of the hole above which it is reported [m]


def end_is_free(model: DrillingModel) -> bool:
    """Whether the lower end of a string in a hole is free: not held, and without a bit on the bottom."""
    bottom = model.case.bottom
    held = isinstance(bottom, HeldBottom) and bottom.kind != "free"
    return model.well is not None and model.beam.moves and model.bit is None and not held


class FreeEnd:
    """The free lower end of a string in a hole; not ``exists`` if it is held or rests on the bottom."""

    def __init__(self, model: DrillingModel) -> None:
        system, mesh = model.system, model.mesh
        self.exists, self.system = end_is_free(model), system
        last = system.chain.own(mesh.nodes - 1)
        self._places = None  # of its position in the unknowns, on the rank that owns it
        if last is not None and self.exists and model.well is not None:
            self._places = system.layout.dofs["string.position"][last]
            end, axis, _ = model.well.at(model.well.depth)
            self._axis = np.asarray(axis)
            self._bottom = (
                float(np.asarray(end) @ self._axis) - mesh.total_length + float(mesh.node_depth[-1])
            )

    @property
    def is_here(self) -> bool:
        """Whether it exists and this rank owns it."""
        return self._places is not None

    def below_bottom(self) -> float:
        """Distance [m] of its face below the end of the hole, negative above it; zero on other ranks."""
        if self._places is None:
            return 0.0
        return float(self.system.assembly.x[self._places] @ self._axis) - self._bottom


class FreeEndWatch:
    """Finds when a free lower end first passes the end of the hole, and how far it goes.

    first: time [s], None before; most: distance [m].  Only on the rank that owns the lower end, until ``share``.
    """

    def __init__(self, model: DrillingModel) -> None:
        self.model, self._end = model, FreeEnd(model)
        self.watches = self._end.is_here
        self.first: float | None = None
        self.most = 0.0

    def update(self, t: float) -> None:
        """After a step to ``t`` [s]; not collective."""
        beyond = self._end.below_bottom()
        if beyond > BEYOND:
            self.first = t if self.first is None else self.first
            self.most = max(self.most, beyond)

    def share(self) -> None:
        """Combine the figures over all ranks; collective."""
        if self.model.system.comm.size > 1 and self._end.exists:
            found = self.model.system.comm.tompi4py().allgather((self.first, self.most))
            self.first = min((first for first, _ in found if first is not None), default=None)
            self.most = max(most for _, most in found)

    def get_notes(self) -> dict[str, Any]:
        """For a checkpoint."""
        return {} if self.first is None else {"first": self.first, "most": self.most}

    def set_notes(self, saved: dict[str, Any]) -> None:
        """Continue from ``get_notes``."""
        self.first, self.most = saved.get("first"), saved.get("most", 0.0)
