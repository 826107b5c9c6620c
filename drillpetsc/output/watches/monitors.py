"""Checks of a run after every step for states that make results doubtful: boiling mud, a free end or a string outside the hole."""

from __future__ import annotations

from typing import Any, Protocol

from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.watches.boiling import BoilingMonitor
from drillpetsc.output.watches.free_end import FreeEndWatch
from drillpetsc.output.watches.outside_hole import HoleMonitor


class Monitor(Protocol):
    """Checks for one such state."""

    watches: bool  # whether such a state is possible on this rank

    def update(self, t: float) -> None:
        """After an accepted step to ``t`` [s]; not collective."""

    def share(self) -> None:
        """Combine the findings over all ranks; collective."""

    def get_notes(self) -> dict[str, Any]:
        """For a checkpoint."""

    def set_notes(self, saved: dict[str, Any]) -> None:
        """Continue from ``get_notes``."""


class Monitors:
    """All monitors of a run of ``model``, as one."""

    def __init__(self, model: DrillingModel) -> None:
        self.boiling, self.free_end = BoilingMonitor(model.system, model.fluid), FreeEndWatch(model)
        self.outside = HoleMonitor(model)
        self._all: dict[str, Monitor] = {
            "boiling": self.boiling,
            "free_end": self.free_end,
            "outside": self.outside,
        }
        self._watching = [monitor for monitor in self._all.values() if monitor.watches]

    def update(self, t: float) -> None:
        """After an accepted step to ``t`` [s]; not collective."""
        for monitor in self._watching:
            monitor.update(t)

    def share(self) -> None:
        """Combine the findings over all ranks; collective."""
        for monitor in self._all.values():
            monitor.share()

    def get_notes(self) -> dict[str, dict[str, Any]]:
        """For a checkpoint."""
        return {name: monitor.get_notes() for name, monitor in self._all.items()}

    def set_notes(self, saved: dict[str, Any]) -> None:
        """Continue from ``get_notes``."""
        for name, monitor in self._all.items():
            monitor.set_notes(saved.get(name, {}))
