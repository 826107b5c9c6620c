"""How much memory a run needs, and whether it keeps growing."""

from __future__ import annotations

import resource
import sys

from mpi4py import MPI

UNIT = 1 if sys.platform == "darwin" else 1024  # of ru_maxrss [bytes]
SETTLED = 0.1  # share of the simulated span after which nothing should be added


def peak() -> int:
    """Largest memory that this process has had resident so far [bytes]."""
    return UNIT * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


class Memory:
    """Peak memory of all ranks: at the start of the motion, after a tenth of it, at the end."""

    def __init__(self, mpi: MPI.Intracomm, start: float, end: float):
        self.mpi, self.at = mpi, start + SETTLED * (end - start)
        self.started, self.settled = peak(), 0

    def look(self, t: float) -> None:
        """After every step."""
        if not self.settled and t >= self.at:
            self.settled = peak()

    def as_dict(self, together: bool) -> dict[str, int]:
        """For summary.json [bytes], the sum over ranks when they are ``together`` (collective then)."""
        on_rank = {"start": self.started, "after_a_tenth": self.settled or peak(), "peak": peak()}
        return {name: self.mpi.allreduce(value) if together else value for name, value in on_rank.items()}
