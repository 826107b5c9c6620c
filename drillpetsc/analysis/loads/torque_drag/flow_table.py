"""Forces of circulating mud at hundreds of bit depths, interpolated between a few (manual: sec-calibrate-logs)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.loads.torque_drag.circulation import Circulation, circulation
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case


@dataclass(frozen=True)
class FlowTable:
    """Forces of the mud at some bit depths and two rates, between which they are interpolated by height above the bit.

    A log has hundreds of bit depths and rates, and steady flow at each costs more than the whole fit. Between depths 20 m apart
    the hole changes little at a height above the bit, and forces follow the rate squared within a few per cent of their change.

    depths: (d,) [m]; rates: (2,) [m3/s]; found: (d, 2) of `Circulation`.
    """

    depths: FloatArray
    rates: tuple[float, float]
    found: tuple[tuple[Circulation, Circulation], ...]

    def forces(self, depth: float, flow: float, edges: FloatArray) -> tuple[FloatArray, float]:
        """(lift per length (k,) [N/m] between measured depths ``edges`` (k+1,) [m], thrust of the jets [N])."""
        i = int(np.clip(np.searchsorted(self.depths, depth) - 1, 0, max(len(self.depths) - 2, 0)))
        j = min(i + 1, len(self.depths) - 1)
        gap = float(self.depths[j] - self.depths[i])
        along = (depth - float(self.depths[i])) / gap if gap else 0.0
        low, high = (q**2 for q in self.rates)
        faster = (flow**2 - low) / (high - low) if high > low else 0.0
        below, thrust = np.zeros(len(edges)), 0.0
        for row, share in ((i, 1 - along), (j, along)):
            for column, part in ((0, 1 - faster), (1, faster)):
                some = self.found[row][column]
                height = depth - edges
                below += share * part * np.interp(-height, some.md - some.md[-1], some.below)
                thrust += share * part * some.thrust
        return -np.diff(below) / np.diff(edges), thrust


def flow_table(case: Case, depths: FloatArray, rates: FloatArray, spacing: float, at: str) -> FlowTable:
    """Forces of the mud at bit depths ``spacing`` [m] apart over the range of ``depths`` [m], and at the ends of ``rates`` [m3/s]."""
    low, high = float(rates.min()), float(rates.max())
    count = max(int(np.ceil((depths.max() - depths.min()) / spacing)), 1)
    some = np.linspace(depths.min(), depths.max(), count + 1)
    found = []
    for depth in some:
        slow = circulation(case, float(depth), low, at)
        found.append((slow, slow if high == low else circulation(case, float(depth), high, at)))
    return FlowTable(some, (low, high), tuple(found))
