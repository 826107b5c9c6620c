"""What may end a run from outside: signals, and files that cannot be written.  One rank notices, all ranks
act at the same step."""

from __future__ import annotations

import signal
import threading
from typing import Any

from drillpetsc.errors import cannot_write

NOTHING, SAVE, STOP, FAILED = range(4)  # the larger one wins
EVERY = 16  # steps between two questions to the other ranks


class RunControl:
    """Within it SIGTERM and SIGINT ask for the end of the run after a step, SIGUSR1 for a checkpoint; a
    second SIGINT ends it at once.

    Signals may reach one rank only; ``poll`` makes it known to all.  Outside the main thread signals are left alone.
    """

    def __init__(self, mpi: Any):
        self.mpi, self.error = mpi, ""
        self._mine, self._number, self._steps = NOTHING, 0, 0
        self._received = 0  # the number that any rank got
        self._before: dict[int, Any] = {}

    def __enter__(self) -> RunControl:
        if threading.current_thread() is threading.main_thread():
            for name, handler in (("SIGTERM", self._stop), ("SIGINT", self._stop), ("SIGUSR1", self._save)):
                number = getattr(signal, name, None)
                if (
                    number is not None and signal.getsignal(number) != signal.SIG_IGN
                ):  # who starts us may have had it ignored
                    self._before[number] = signal.signal(number, handler)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(
                number, handler if handler is not None else signal.SIG_DFL
            )  # None: not set from Python
        self._before = {}

    def _stop(self, number: int, frame: object) -> None:
        if self._mine >= STOP and number == signal.SIGINT:
            raise KeyboardInterrupt
        self._mine, self._number = max(self._mine, STOP), number

    def _save(self, number: int, frame: object) -> None:
        self._mine = max(self._mine, SAVE)

    def report_write_error(self, error: OSError, what: str) -> None:
        """This rank could not write."""
        self._mine, self.error = FAILED, cannot_write(error, what)

    def poll(self, now: bool) -> int:
        """What is to be done after this step, the same on all ranks, which must all call it with the same
        ``now``: at once, or only if the time for a question has come."""
        self._steps += 1
        if self.mpi.size > 1:
            if not now and self._steps % EVERY:
                return NOTHING
            from mpi4py import MPI

            # by the first of the two; the handler alone writes _number: a signal may arrive just now
            asked, self._received = self.mpi.allreduce((self._mine, self._number), op=MPI.MAX)
        else:
            asked = self._mine
        if asked == SAVE:
            self._mine = NOTHING
        return int(asked)

    @property
    def name(self) -> str:
        """Of the signal that asked for the end."""
        number = self._received or self._number
        return signal.Signals(number).name if number else "a signal"
