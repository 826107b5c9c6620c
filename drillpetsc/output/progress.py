"""Progress of a run: a live line on a terminal, a plain line every few seconds in a log, or nothing."""

from __future__ import annotations

import os
import shutil
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from typing import Any, Literal, TextIO, TypeVar

from drillpetsc.errors import CaseError

Item = TypeVar("Item")
Mode = Literal["auto", "live", "log", "silent"]
Receiver = Callable[[float, str], Any]
"""A function called with the share of the work done, from 0 to 1, and a line of text."""


def check_progress(progress: Any, words: tuple[str, ...]) -> None:
    """Raise CaseError if the progress is not one of the words or a function."""
    if not callable(progress) and progress not in words:
        raise CaseError(
            at="progress", got=progress, want=f"{', '.join(words)}, or a function of (share, text)"
        )


class Progress:
    """Shows simulated time, step number, step size, real-time factor and the time still needed.

    update() is called after every accepted step; between two prints it costs a clock reading (well under 1
    us). The factor is simulated seconds per wall second over the last prints (about the last 30 s of wall
    time), so the estimate follows a run that slows down. finish() gives the factor over the whole run.
    """

    def __init__(
        self,
        end: float,
        start: float = 0.0,
        mode: Mode | Receiver = "auto",
        interval: float | None = None,
        stream: TextIO | None = None,
        label: str = "",
    ) -> None:
        """end, start: simulated time [s]. interval: wall seconds between prints (0.2 live, 5 in a log).
        label: a name in front, for several wells at once.
        mode: or a function, which receives the lines instead of the stream, as often as a terminal does."""
        self.stream = sys.stderr if stream is None else stream
        self._receiver: Receiver | None = mode if callable(mode) else None
        if callable(mode):
            self.mode: str = "log"
        else:
            self.mode = _mode_of(self.stream) if mode == "auto" else mode
        often = self.mode == "live" or self._receiver is not None
        self.interval = interval if interval is not None else (0.2 if often else 5.0)
        self.start, self.end, self.label = start, end, f"{label}: " if label else ""
        self._began = self._clock = time.monotonic()
        self._next = float("inf") if self.mode == "silent" else self._began + self.interval
        self._marks = [(self._began, start)]
        self._shown, self._share = False, 0.0

    def update(self, simulated: float, step: int, step_size: float) -> None:
        """simulated: time reached [s]; step: number of accepted steps; step_size: the last one [s]."""
        now = time.monotonic()
        if now >= self._next:
            self._print(now, simulated, step, step_size)

    def message(self, text: str) -> None:
        """Print a separate line without breaking the live line."""
        if self.mode == "silent":
            return
        self.clear()
        self._write_line(text)

    def finish(self, simulated: float, step: int) -> None:
        """Print a last line: simulated time, steps and wall time."""
        if self.mode == "silent":
            return
        wall = max(time.monotonic() - self._began, 1e-9)
        self.clear()
        self._share = self._share_at(simulated)
        self._write_line(
            f"{self.label}{simulated:.4g} s of {self.end:g} s in {step} steps, {duration(wall)} wall, "
            f"real-time factor {(simulated - self.start) / wall:.3g}"
        )
        self._next = float("inf")

    def line(self, now: float, simulated: float, step: int, step_size: float) -> str:
        """The text shown at wall clock `now`."""
        then, since = self._marks[0]
        factor = (simulated - since) / max(now - then, 1e-9)
        remaining = duration((self.end - simulated) / factor) if factor > 0 else "?"
        percent = 100 * self._share_at(simulated)
        return (
            f"{self.label}{simulated:.4g} / {self.end:g} s ({percent:.0f} %)  step {step}  dt {step_size:.2e} s  "
            f"real-time factor {factor:.3g}  ETA {remaining}"
        )

    def _print(self, now: float, simulated: float, step: int, step_size: float) -> None:
        text = self.line(now, simulated, step, step_size)
        self._share = self._share_at(simulated)
        if self.mode == "live":
            width = shutil.get_terminal_size().columns
            self.stream.write("\r" + text[: max(width - 1, 20)] + "\x1b[K")
            self._shown = True
            self.stream.flush()
        else:
            self._write_line(text)
        self._next = now + self.interval
        self._marks.append((now, simulated))
        while len(self._marks) > 2 and now - self._marks[0][0] > 30.0:
            self._marks.pop(0)

    def _share_at(self, simulated: float) -> float:
        """Share of the run that is done."""
        span = self.end - self.start
        return (simulated - self.start) / span if span > 0 else 1.0

    def _write_line(self, text: str) -> None:
        """A line for the stream, or for the receiver; one that has failed is not called again."""
        if self._receiver is None:
            self.stream.write(text + "\n")
            self.stream.flush()
            return
        receiver, self._receiver, self.mode = self._receiver, None, "silent"
        receiver(self._share, text)
        self._receiver, self.mode = receiver, "log"

    def clear(self) -> None:
        """Remove the live line."""
        if self._shown:
            self.stream.write("\r\x1b[K")
            self._shown = False


def counted(items: Iterable[Item], what: str, rank: int = 0, stream: TextIO | None = None) -> Iterator[Item]:
    """Yield the items, and show on rank 0 how many are done and how long the others will take.

    Nothing is shown in the first three seconds, or ten in a log: most commands are shorter.
    what: the items, such as `points`.
    """
    items, stream = list(items), sys.stderr if stream is None else stream
    live = _mode_of(stream) == "live"
    began, width = time.monotonic(), 0
    shown = began + (3.0 if live else 10.0)
    for done, item in enumerate(items):
        now = time.monotonic()
        if done and rank == 0 and now >= shown:
            left = duration((now - began) / done * (len(items) - done))
            text = f"{done} of {len(items)} {what} ({100 * done // len(items)} %)  ETA {left}"
            stream.write(f"\r{text}\x1b[K" if live else text + "\n")
            stream.flush()
            width, shown = len(text), now + (0.2 if live else 10.0)
        yield item
    if live and width:
        stream.write("\r\x1b[K")
        stream.flush()


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
