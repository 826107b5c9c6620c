"""Mass balance of the mud: volumes that went in and came out since the start, and the change of content."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from drillpetsc.fem.component import FloatArray


class MassBalance:
    """Integrates flow rates by the formula that the pressures take.

    start_content, content: volume of all mud at the start and after the last step [m3]; all volumes are at zero pressure.
    """

    def __init__(self) -> None:
        self.start_content = self.content = 0.0
        self._sums = [0.0, 0.0, 0.0]  # volumes pumped, returned, and of cuttings taken up [m3]
        self._before: tuple[list[float], float] | None = None  # sums one step ago and that step [m3, s]

    def start(self, content: float) -> None:
        """Begin with a content [m3], summed over ranks."""
        self._sums, self._before = [0.0, 0.0, 0.0], None
        self.start_content = self.content = content

    def step(self, rates: Sequence[float], dt: float, fresh: bool) -> None:
        """Integrate ``rates`` (3,) [m3/s] of pump, return and cuttings over an accepted step ``dt`` [s].

        BDF of order 2, the formula of the pressures (manual: eq-time-bdf): its error at a wave front is then not a loss
        of mud.  fresh: the formula restarts, with a half step of order 1 as in PETSc.
        """
        old = self._sums
        if fresh or self._before is None:
            before, gap = old, 0.5 * dt
            old, rest = [s + gap * rate for s, rate in zip(old, rates, strict=True)], 0.5 * dt
        else:
            (before, gap), rest = self._before, dt
        # derivative at the end of the parabola through three times: new, `rest` and `rest + gap` before it
        a0, a1, a2 = 1 / rest + 1 / (rest + gap), -(rest + gap) / (rest * gap), rest / (gap * (rest + gap))
        self._before = self._sums, dt
        self._sums = [
            (rate - a1 * s1 - a2 * s2) / a0 for rate, s1, s2 in zip(rates, old, before, strict=True)
        ]

    def balance(self) -> dict[str, Any]:
        """Volumes since the start [m3].

        content_change: of the hole as it is now; cuttings: rock that the mud carries, counted as mud; error_share:
        error over the largest of pumped, returned and changed volume.
        """
        change, (pumped, returned, cuttings) = self.content - self.start_content, map(float, self._sums)
        error = change - pumped + returned - cuttings
        largest = max(abs(pumped), abs(returned), abs(change), 1e-300)
        return {
            "pumped": pumped,
            "returned": returned,
            **({"cuttings": cuttings} if cuttings else {}),
            "content_change": change,
            "error": error,
            "error_share": error / largest,
        }

    def get_state(self) -> dict[str, FloatArray]:
        """For a checkpoint; the same on all ranks."""
        sums, step = self._before if self._before is not None else ([0.0, 0.0, 0.0], 0.0)
        return {"mud": np.array([*self._sums, self.start_content, *sums, step, self.content])}

    def set_state(self, saved: dict[str, FloatArray]) -> None:
        """Continue from a checkpoint."""
        volumes = saved["mud"].tolist()
        self._sums, self.start_content = volumes[:3], volumes[3]
        self._before = (volumes[4:7], volumes[7]) if volumes[7] > 0.0 else None
        self.content = volumes[8]
