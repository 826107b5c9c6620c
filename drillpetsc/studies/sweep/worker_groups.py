"""Worker groups: the ranks of a job divided into groups, each of which computes one member at a time on a separate
communicator.

While members run, the groups share files only (table.py). Ranks do not wait for other groups, so a member
that fails or hangs blocks only the ranks of its group.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from petsc4py import PETSc

from drillpetsc.parallel import wait_for

#: fewest elements per rank of a group: two ranks were slower than one with 100 elements in all, and no faster
#: with 225
LEAST_ELEMENTS = 120
#: time that a rank waits for the others of its group after its part of a member has ended [s]
RANK_TIMEOUT = 60.0


def group_sizes(costs: Sequence[float], elements: Sequence[int], ranks: int) -> list[int]:
    """Number of ranks of each worker group; group k begins with member k.

    costs: expected cost of each member, in descending order.
    elements: number of elements of each member's mesh.
    ranks: number of ranks of the job.

    A member gets one rank, or the number of ranks that corresponds to its part of the total cost. If there
    are more ranks than members, the remaining ranks go to the groups with the largest cost per rank. A group never gets
    more ranks than its first member can use, so some ranks may belong to no group.
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

    number: number of the group, from 0.
    comm: communicator of the computation.
    control: mpi4py communicator of the same ranks for messages outside the computation. A message of a rank
        that has failed can then not be received by the computation.
    ranks: ranks of the group in the communicator of the job.
    """

    number: int
    comm: PETSc.Comm
    control: Any
    ranks: tuple[int, ...]
    _kept: list[Any] = field(default_factory=list)

    @property
    def first(self) -> bool:
        """Whether this is the first rank of the group."""
        return self.control.rank == 0

    def gather(self, value: Any) -> list[Any] | None:
        """Gather ``value`` from all ranks of the group; None if a rank does not arrive within RANK_TIMEOUT."""
        if self.control.size == 1:
            return [value]
        if not wait_for(self.control.Ibarrier(), RANK_TIMEOUT):
            return None
        return self.control.allgather(value)


def split(mpi: Any, sizes: Sequence[int]) -> WorkerGroup | None:
    """Divide the ranks of ``mpi`` (mpi4py) into groups of neighbouring ranks (collective).

    Returns the group of this rank, or None if it belongs to none.
    """
    from mpi4py import MPI

    groups = [number for number, size in enumerate(sizes) for _ in range(size)]
    number = groups[mpi.rank] if mpi.rank < len(groups) else MPI.UNDEFINED
    part = mpi.Split(number, mpi.rank)
    if part == MPI.COMM_NULL:
        return None
    # The group holds PETSc's own duplicate. If it were freed with its last object, a single rank could create
    # it again, and creating it is collective.
    comm = PETSc.Comm(part).duplicate()
    return WorkerGroup(number, comm, part.Dup(), tuple(part.allgather(mpi.rank)), [part])
