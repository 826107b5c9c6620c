"""Progress of a run: a live line on a terminal, a plain line every few seconds in a log, or nothing."""

from __future__ import annotations

import os
import shutil
import sys
import time
from typing import Literal, TextIO

Mode = Literal["auto", "live", "log", "silent"]


class Progress:
    """Shows simulated time, step number, step size, real-time factor and the time still needed.

    update() is called after every accepted step; between two prints it costs a clock reading (well under 1
    us). The factor is simulated seconds per wall second over the last prints (about the last 30 s of wall
    time), so that the estimate follows a run that slows down; finish() gives the one over the whole run.
    """

    def __init__(
        self,
        end: float,
        start: float = 0.0,
        mode: Mode = "auto",
        interval: float | None = None,
        stream: TextIO | None = None,
        label: str = "",
    ) -> None:
        """end, start: simulated time [s]. interval: wall seconds between prints (0.2 live, 5 in a log).
        label: a name in front, for several wells at once."""
        self.stream = sys.stderr if stream is None else stream
        self.mode = _mode_of(self.stream) if mode == "auto" else mode
        self.interval = interval if interval is not None else (0.2 if self.mode == "live" else 5.0)
        self.start, self.end, self.label = start, end, f"{label}: " if label else ""
        self._began = self._clock = time.monotonic()
        self._next = float("inf") if self.mode == "silent" else self._began + self.interval
        self._marks = [(self._began, start)]
        self._shown = False

    def update(self, simulated: float, step: int, step_size: float) -> None:
        """simulated: time reached [s]; step: number of accepted steps; step_size: the last one [s]."""
        now = time.monotonic()
        if now >= self._next:
            self._print(now, simulated, step, step_size)

    def message(self, text: str) -> None:
        """Print a line of its own without tearing the live line."""
        if self.mode == "silent":
            return
        self._clear()
        self.stream.write(text + "\n")
        self.stream.flush()

    def finish(self, simulated: float, step: int) -> None:
        """Leave one last line: what was reached in what time."""
        if self.mode == "silent":
            return
        wall = max(time.monotonic() - self._began, 1e-9)
        self._clear()
        self.stream.write(
            f"{self.label}{simulated:.4g} s of {self.end:g} s in {step} steps, {duration(wall)} wall, "
            f"real-time factor {(simulated - self.start) / wall:.3g}\n"
        )
        self.stream.flush()
        self._next = float("inf")

    def line(self, now: float, simulated: float, step: int, step_size: float) -> str:
        """The text shown at wall clock `now`."""
        then, since = self._marks[0]
        factor = (simulated - since) / max(now - then, 1e-9)
        remaining = duration((self.end - simulated) / factor) if factor > 0 else "?"
        span = self.end - self.start
        percent = 100 * (simulated - self.start) / span if span > 0 else 100.0
        return (
            f"{self.label}{simulated:.4g} / {self.end:g} s ({percent:.0f} %)  step {step}  dt {step_size:.2e} s  "
            f"real-time factor {factor:.3g}  ETA {remaining}"
        )

    def _print(self, now: float, simulated: float, step: int, step_size: float) -> None:
        text = self.line(now, simulated, step, step_size)
        if self.mode == "live":
            width = shutil.get_terminal_size().columns
            self.stream.write("\r" + text[: max(width - 1, 20)] + "\x1b[K")
            self._shown = True
        else:
            self.stream.write(text + "\n")
        self.stream.flush()
        self._next = now + self.interval
        self._marks.append((now, simulated))
        while len(self._marks) > 2 and now - self._marks[0][0] > 30.0:
            self._marks.pop(0)

    def _clear(self) -> None:
        if self._shown:
            self.stream.write("\r\x1b[K")
            self._shown = False


def _mode_of(stream: TextIO) -> Mode:
    terminal = hasattr(stream, "isatty") and stream.isatty() and os.environ.get("TERM", "dumb") != "dumb"
    return "live" if terminal else "log"


def duration(seconds: float) -> str:
    """4000.0 -> "1 h 07 min", 75.0 -> "1 min 15 s", 3.2 -> "3 s"."""
    if not seconds < 1e9:
        return "?"
    whole = int(round(seconds))
    if whole >= 3600:
        return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
    if whole >= 60:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{seconds:.1f} s" if seconds < 10 else f"{whole} s"
