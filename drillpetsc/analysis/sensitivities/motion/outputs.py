"""Outputs of a run over windows of time: `surface_torque.mean[2:4]`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray, halves_at_nodes
from drillpetsc.case.key_paths import suggestion
from drillpetsc.errors import CaseError

Events = Sequence[tuple[float, FloatArray]]
STATISTICS = ("mean", "rms", "max", "final")
_FORM = re.compile(r"([\w.]+?)(?:\.(mean|rms|max|final))?(?:\[([^:\]]*):([^:\]]*)\])?")


@dataclass(frozen=True)
class RunOutput:
    """A number of a column of the history.  statistic: one of ``STATISTICS``; window: from, to [s].

    mean: over time; rms: of the deviation from zero, over time; max: largest value; final: at the end of the window.
    """

    column: str
    statistic: str
    window: tuple[float, float]
    name: str

    def of(
        self, times: FloatArray, values: FloatArray, slopes: FloatArray, events: Events = ()
    ) -> tuple[float, FloatArray]:
        """The number, and its derivatives (k,).  times: (m,) [s]; values: (m,); slopes: (m, k) derivatives of the values.

        events: times at which values may jump to those of the next row, with the derivatives (k,) of these times.
        """
        inside = (times >= self.window[0] - 1e-9) & (times <= self.window[1] + 1e-9)
        t, v, s = times[inside], values[inside], slopes[inside]
        if not len(t):
            want = f"a window with rows of output.history_every, from {times[0]:g} to {times[-1]:g} s"
            raise CaseError(at="--of", got=self.name, want=want)
        if self.statistic == "final" or len(t) == 1:
            return float(v[-1]), s[-1]
        if self.statistic == "max":
            top = int(v.argmax())
            return float(v[top]), s[top]
        weight = halves_at_nodes(np.diff(t)) / (t[-1] - t[0])
        if self.statistic == "mean":
            return float(weight @ v), weight @ s + _by_jumps(t, v, events)
        size = float(np.sqrt(weight @ v**2))
        more = 0.5 * _by_jumps(t, v**2, events)
        return size, ((weight * v) @ s + more) / size if size else np.zeros(s.shape[1])


def _by_jumps(times: FloatArray, values: FloatArray, events: Events) -> FloatArray | float:
    """Derivatives (k,) of a mean by the moments at which the values jump."""
    out: FloatArray | float = 0.0
    for moment, slopes in events:
        at = int(np.searchsorted(times, moment))
        if times[0] < moment and at + 1 < len(times):
            out = out + (values[at] - values[at + 1]) / (times[-1] - times[0]) * slopes
    return out


def parsed_outputs(asked: Sequence[str], columns: Sequence[str], end: float) -> list[RunOutput]:
    """Outputs of their words, `surface_torque` (mean of the whole run) or `bit_speed.max[5:8]`.

    columns: of the history; end: of the run [s].  Raises CaseError for a word that is not one.
    """
    out = []
    for word in asked:
        match = _FORM.fullmatch(word.strip())
        if match is None or match[1] not in columns:
            name = word.strip() if match is None else match[1]
            want = f"a column of history.csv, with .{', .'.join(STATISTICS)} and [from:to] in seconds"
            raise CaseError(at="--of", got=word, want=want, hint=suggestion(name, list(columns)))
        try:
            window = float(match[3] or 0.0), float(match[4] or end)
        except ValueError:
            raise CaseError(at="--of", got=word, want="a window in seconds, such as [2:4]") from None
        if not 0 <= window[0] <= window[1] <= end * (1 + 1e-9):
            raise CaseError(at="--of", got=word, want=f"a window from 0 to {end:g} s")
        out.append(RunOutput(match[1], match[2] or "mean", window, word.strip()))
    return out
