"""Peak memory of a run, and whether it keeps growing."""

from __future__ import annotations

import ctypes
import resource
import sys

from mpi4py import MPI

RSS_UNIT = 1 if sys.platform == "darwin" else 1024  # unit of ru_maxrss [bytes]
WARM_UP = 0.1  # fraction of the simulated time after which memory should not grow


def peak() -> int:
    """Return the largest resident memory of this process so far [bytes]."""
    return RSS_UNIT * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def give_back() -> None:
    """Return unused memory to the operating system after a phase with large work arrays, if the C library can."""
    trim = getattr(ctypes.CDLL(None), "malloc_trim", None)
    if trim is not None:
        trim(0)


class Memory:
    """Peak memory of all ranks: at the start of the motion, after a tenth of its time, at its last step, overall.

    What writes the last checkpoint and the summary comes after the last step.

    mpi: communicator; start, end: of the motion [s].
    """

    def __init__(self, mpi: MPI.Intracomm, start: float, end: float):
        self.mpi, self.warm_up_end = mpi, start + WARM_UP * (end - start)
        self.at_start, self.after_warm_up = peak(), 0
        self.at_end = self.at_start

    def update(self, t: float) -> None:
        """After the step to ``t`` [s]: measure at the end of the warm-up."""
        if not self.after_warm_up and t >= self.warm_up_end:
            self.after_warm_up = self.at_end = peak()

    def end(self) -> None:
        """Measure after the last step; the peak never falls, so earlier steps need no measurement."""
        self.at_end = peak()

    def as_dict(self, all_ranks: bool) -> dict[str, int]:
        """Return the entries of summary.json [bytes].

        With ``all_ranks`` the sum over ranks, which is collective.
        """
        local = {
            "start": self.at_start,
            "after_a_tenth": self.after_warm_up or self.at_end,
            "end": self.at_end,
            "peak": peak(),
        }
        return {k: self.mpi.allreduce(v) if all_ranks else v for k, v in local.items()}
