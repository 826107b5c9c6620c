"""Forces of circulating mud at hundreds of bit depths, interpolated between a few (manual: sec-calibrate-logs)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.loads.torque_drag.circulation import Circulation, circulations
from drillpetsc.arrays import FloatArray
from drillpetsc.case.case import Case

NARROW = 1.1  # ratio of the largest to the smallest rate up to which forces are a straight line between them


@dataclass(frozen=True)
class FlowTable:
    """Forces of the mud at some bit depths and rates, between which they are interpolated by height above the bit.

    A log has hundreds of bit depths and rates, and steady flow at each costs more than the whole fit. At a height above the bit the
    hole changes little between depths 20 m apart. Over the rate, forces are a parabola through three rates.

    depths: (d,) [m]; rates: (r,) [m3/s]; found: (d, r) of `Circulation`.
    """

    depths: FloatArray
    rates: FloatArray
    found: tuple[tuple[Circulation, ...], ...]

    def forces(self, depth: float, flow: float, edges: FloatArray) -> tuple[FloatArray, float]:
        """(lift per length (k,) [N/m] between measured depths ``edges`` (k+1,) [m], thrust of the jets [N])."""
        i = int(np.clip(np.searchsorted(self.depths, depth) - 1, 0, max(len(self.depths) - 2, 0)))
        j = min(i + 1, len(self.depths) - 1)
        gap = float(self.depths[j] - self.depths[i])
        along = (depth - float(self.depths[i])) / gap if gap else 0.0
        below, thrust = np.zeros(len(edges)), 0.0
        for row, share in ((i, 1 - along), (j, along)):
            for some, part in zip(self.found[row], self._shares(flow), strict=True):
                below += share * part * np.interp(edges - depth, some.md - some.md[-1], some.below)
                thrust += share * part * some.thrust
        return -np.diff(below) / np.diff(edges), thrust

    def _shares(self, flow: float) -> list[float]:
        """Lagrange's polynomials of the rates at a rate."""
        others = [[q for q in self.rates if q != rate] for rate in self.rates]
        return [
            float(np.prod([(flow - q) / (rate - q) for q in rest]))
            for rate, rest in zip(self.rates, others, strict=True)
        ]


def flow_table(case: Case, depths: FloatArray, rates: FloatArray, spacing: float, at: str) -> FlowTable:
    """Forces of the mud at bit depths ``spacing`` [m] apart over the range of ``depths`` [m], and over that of ``rates`` [m3/s]."""
    low, high = float(rates.min()), float(rates.max())
    some = np.unique(np.linspace(low, high, 2 if high < NARROW * low else 3))
    count = max(int(np.ceil(np.ptp(depths) / spacing)), 1)
    places = np.unique(np.linspace(depths.min(), depths.max(), count + 1))
    found = tuple(circulations(case, float(d), some, at) for d in places)
    return FlowTable(places, some, found)
