"""Teams of ranks that compute the members of an ensemble, each on a communicator of its own.

While members run, teams share nothing but files (ensemble_table): no rank ever waits for another team, so a
member that fails or hangs holds up none but its own ranks.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from petsc4py import PETSc

from drillpetsc.parallel import wait_for

LEAST_ELEMENTS = (
    120  # per rank of a team: two ranks were slower than one with 100 elements in all, and no faster with 225
)
RANK_TIMEOUT = (
    60.0  # how long a rank waits for the others of its team once its own part of a member has ended [s]
)


def team_sizes(costs: Sequence[float], elements: Sequence[int], ranks: int) -> list[int]:
    """Number of ranks of each team; team k begins with member k.

    costs: expected, falling; elements: of each member's mesh.  A member gets one rank, or as many as its
    share of the whole cost comes to; with more ranks than members those left over go where most work stands
    per rank.  No team gets more ranks than its first member has work for, so ranks may stay without a team.
    """
    total = sum(costs)
    most = [max(1, n // LEAST_ELEMENTS) for n in elements]
    sizes: list[int] = []
    left = ranks
    for cost, limit in zip(costs, most, strict=True):
        if left == 0:
            break
        share = int(cost * ranks / total) if total > 0 else 1
        sizes.append(min(max(1, share), limit, left))
        left -= sizes[-1]
    while left > 0:
        open_ = [k for k, size in enumerate(sizes) if size < most[k]]
        if not open_:
            break
        sizes[max(open_, key=lambda k: costs[k] / sizes[k])] += 1
        left -= 1
    return sizes


@dataclass
class WorkerGroup:
    """The ranks that compute a member together.

    number: from 0; comm: for the computation; talk: of the same ranks, for what stands beside it, so that a
    message of a rank that has failed cannot meet one of the computation; ranks: their numbers in the whole
    job.
    """

    number: int
    comm: PETSc.Comm
    talk: Any
    ranks: tuple[int, ...]
    _kept: list[Any] = field(default_factory=list)

    @property
    def first(self) -> bool:
        return self.talk.rank == 0

    def gathered(self, on_rank: Any) -> list[Any] | None:
        """``mine`` of each rank of the team; None when a rank has not come within RANK_TIMEOUT, and never
        will."""
        if self.talk.size == 1:
            return [on_rank]
        if not wait_for(self.talk.Ibarrier(), RANK_TIMEOUT):
            return None
        return self.talk.allgather(on_rank)


def split(mpi: Any, sizes: Sequence[int]) -> WorkerGroup | None:
    """This rank's team, of neighbouring ranks; None for a rank without one.  Collective over ``mpi``
    (mpi4py's)."""
    from mpi4py import MPI

    teams = [number for number, size in enumerate(sizes) for _ in range(size)]
    number = teams[mpi.rank] if mpi.rank < len(teams) else MPI.UNDEFINED
    part = mpi.Split(number, mpi.rank)
    if part == MPI.COMM_NULL:
        return None
    # PETSc's own duplicate is held as long as the team lives: freed with its last object, it could be made
    # anew on one rank alone
    comm = PETSc.Comm(part).duplicate()
    return WorkerGroup(number, comm, part.Dup(), tuple(part.allgather(mpi.rank)), [part])
