"""Pulls out of a log that grows: rows over which the hook load rises with the block. A string that is free moves at a steady load."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.units import to_si

WINDOW = 6.0  # height of the block above which rows are forgotten: no string stretches so far [m]
HELD, LONGEST = (
    5.0,
    60.0,
)  # times without a higher load after which a pull is looked at again, and no longer [s]
FALLEN = 0.02  # share of the highest load by which it falls when the pull is over
LEAST = to_si("50 kN", "N")  # rise of the load in a pull


@dataclass(frozen=True)
class Pull:
    """Rows of a pull, (n,) each: height of the block [m], hook load [N]; bit_depth: at the last row [m]."""

    bit_depth: float
    height: FloatArray
    hook_load: FloatArray


class Pulls:
    """Pulls of rows as they come."""

    def __init__(self) -> None:
        self._rows: list[list[float]] = []  # time, height, bit depth, hook load
        self._top = 0  # number of the row with the highest load
        self._given = 0.0  # time of the last row that was given

    def take(self, time: float, height: float, bit_depth: float, hook_load: float, hangs: bool) -> list[Pull]:
        """Add a row; returns the pull that it ends, or that rises no more.  hangs: whether the string hangs on the hook and does not turn."""
        out = []
        if not hangs or self._rows and hook_load < (1 - FALLEN) * self._rows[self._top][3]:
            out, self._rows, self._top = self._pull(), [], 0
        if not hangs or not np.isfinite([time, height, bit_depth, hook_load]).all():
            return out
        held = time - self._rows[self._top][0] if self._rows else 0.0
        if held > LONGEST and hook_load <= self._rows[self._top][3]:
            return out
        self._rows.append([time, height, bit_depth, hook_load])
        far = next(i for i, row in enumerate(self._rows) if height - row[1] <= WINDOW)
        if far:
            del self._rows[:far]
            self._top = int(np.argmax([row[3] for row in self._rows]))
        if hook_load >= self._rows[self._top][3]:
            self._top = len(self._rows) - 1
        elif held >= HELD and time - self._given >= HELD:
            out += self._pull()
        return out

    def _pull(self) -> list[Pull]:
        if not self._rows or self._rows[-1][0] == self._given:
            return []
        self._given = self._rows[-1][0]
        rows = np.array(self._rows)
        if rows[self._top, 3] - rows[: self._top + 1, 3].min() < LEAST:
            return []
        return [Pull(float(rows[-1, 2]), rows[:, 1], rows[:, 3])]

    # ------------------------------------------------------------------ restart
    def saved(self) -> dict[str, Any]:
        """Everything that a restart needs, in JSON types."""
        return {"rows": self._rows, "top": self._top, "given": self._given}

    def restore(self, saved: dict[str, Any]) -> None:
        """Continue from what was saved."""
        self._rows, self._top, self._given = saved["rows"], saved["top"], saved["given"]
