"""Watches the pressure of the mud: below its vapour pressure mud boils, which the model does not contain."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.kernels import function, pointer
from drillpetsc.model.fluid import FluidComponents

_any_below = function("any_below", "ippd", ctypes.c_int)
VAPOUR_PRESSURE = -1.0e5  # gauge pressure [Pa]: absolute zero, below which there is no liquid


@dataclass(frozen=True)
class LowPressure:
    """A pressure [Pa] below the vapour pressure, with time [s], node and channel."""

    pressure: float
    time: float
    node: int
    channel: str


class BoilingMonitor:
    """Finds where and when the pressure first falls below the vapour pressure, and its lowest value.

    first, lowest: None as long as no pressure is below it; the same on all ranks after ``share``.
    """

    def __init__(self, system: DiscreteSystem, fluid: FluidComponents | None) -> None:
        self.system = system
        channels = () if fluid is None else (fluid.bore, fluid.annulus)
        self._channels = [c for c in channels if c is not None]
        self.watches = bool(self._channels)
        self._places: np.ndarray | None = None  # of pressures in the unknowns
        self._computed: list[Any] = []  # channels whose pressures are not unknowns
        self.first: LowPressure | None = None
        self.lowest: LowPressure | None = None

    def update(self, t: float) -> None:
        """After an accepted step to ``t`` [s]; not collective."""
        if self._places is None:
            places = [channel.pressure_places(self.system) for channel in self._channels]
            known = [np.zeros(0, dtype=int), *(p for p in places if p is not None)]
            self._places = np.concatenate(known).astype(np.int32)
            self._pressures = len(self._places), pointer(self._places), self.system.assembly.state_at[0]
            self._computed = [c for c, p in zip(self._channels, places, strict=True) if p is None]
        if not _any_below(*self._pressures, VAPOUR_PRESSURE) and not self._computed:
            return
        for channel in self._channels:
            pressures = channel.pressures(self.system)
            if not len(pressures) or not pressures.min() < VAPOUR_PRESSURE:
                continue
            k = int(np.argmin(pressures))
            low = LowPressure(float(pressures[k]), t, int(self.system.chain.vertices[k]), channel.name)
            self.first = self.first or low
            if self.lowest is None or low.pressure < self.lowest.pressure:
                self.lowest = low

    def share(self) -> None:
        """Combine ``first`` and ``lowest`` over all ranks; collective."""
        if not self._channels or self.system.comm.size == 1:
            return
        found = self.system.comm.tompi4py().allgather((self.first, self.lowest))
        firsts, lows = ([q for q in quantity if q is not None] for quantity in zip(*found, strict=True))
        self.first = min(firsts, key=lambda q: q.time, default=None)
        self.lowest = min(lows, key=lambda q: q.pressure, default=None)

    def get_notes(self) -> dict[str, Any]:
        """For a checkpoint."""
        return {
            name: [low.pressure, low.time, low.node, low.channel]
            for name, low in (("first", self.first), ("lowest", self.lowest))
            if low is not None
        }

    def set_notes(self, saved: dict[str, Any]) -> None:
        """Continue from ``get_notes``."""
        self.first, self.lowest = (
            LowPressure(*saved[name]) if name in saved else None for name in ("first", "lowest")
        )
