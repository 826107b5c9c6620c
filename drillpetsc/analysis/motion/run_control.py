"""Signals and write failures.  Detected on one rank, acted on by all ranks after the same step."""

from __future__ import annotations

import signal
import threading
from typing import Any

from drillpetsc.errors import cannot_write
from drillpetsc.parallel import ENDING

NOTHING, WRITE, SAVE, STOP, FAILED = range(
    5
)  # actions after a step; of those of all ranks the largest is taken
POLL_INTERVAL = 16  # steps between two exchanges with the other ranks


class RunControl:
    """Context in which signals control a run.

    SIGTERM, SIGHUP, SIGQUIT and SIGINT end the run after a step, SIGUSR1 writes a checkpoint, and a second SIGINT ends the
    run at once. A signal may reach one rank only; ``poll`` distributes it to all ranks.  Outside the main thread
    no signal handler is set.

    mpi: communicator of the run.
    """

    def __init__(self, mpi: Any):
        self.mpi, self.error = mpi, ""
        self._local_action, self._number, self._steps = NOTHING, 0, 0
        self._received = 0  # number of the signal that any rank got
        self._before: dict[int, Any] = {}

    def __enter__(self) -> RunControl:
        if threading.current_thread() is threading.main_thread():
            for name in (*ENDING, "SIGUSR1"):
                handler = self._stop if name in ENDING else self._save
                number = getattr(signal, name, None)
                # a signal that the parent process ignores stays ignored
                if number is not None and signal.getsignal(number) != signal.SIG_IGN:
                    self._before[number] = signal.signal(number, handler)
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            # None: the earlier handler was not set from Python
            signal.signal(number, handler if handler is not None else signal.SIG_DFL)
        self._before = {}

    def _stop(self, number: int, frame: object) -> None:
        if self._local_action >= STOP and number == signal.SIGINT:
            raise KeyboardInterrupt
        self._local_action, self._number = max(self._local_action, STOP), number

    def _save(self, number: int, frame: object) -> None:
        self._local_action = max(self._local_action, SAVE)

    def report_write_error(self, error: OSError, what: str) -> None:
        """Report that this rank could not write ``what``; ``poll`` then returns FAILED on all ranks."""
        self._local_action, self.error = FAILED, cannot_write(error, what)

    def poll(self, now: bool, overdue: bool = False) -> int:
        """Return the action after this step, the same on all ranks.

        Collective, with the same ``now`` on every rank.

        now: exchange with the other ranks at this step; otherwise every ``POLL_INTERVAL`` steps.
        overdue: this rank has rows that should be written: WRITE, unless there is more to do.
        """
        self._steps += 1
        wanted = max(self._local_action, WRITE if overdue else NOTHING)
        if self.mpi.size > 1:
            if not now and self._steps % POLL_INTERVAL:
                return NOTHING
            from mpi4py import MPI

            # the maximum is by the action; only the handler writes _number, since a signal may arrive during
            # this call
            action, self._received = self.mpi.allreduce((wanted, self._number), op=MPI.MAX)
        else:
            action = wanted
        if action == SAVE:
            self._local_action = NOTHING
        return int(action)

    @property
    def name(self) -> str:
        """Name of the signal that ends the run."""
        number = self._received or self._number
        return signal.Signals(number).name if number else "a signal"
