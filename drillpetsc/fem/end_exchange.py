"""Values at the nodes that two ranks share: from the rank that owns the node to its neighbour, and sums of both.

A rank has a run of neighbouring elements with all their nodes (manual: sec-chain-structure), so it shares at most the two ends of its
run. Each is shared with one other rank.  Scatters of whole vectors, as PETSc's meshes have them, copy a hundred
kilobytes for these few numbers.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray

_TAG = 1  # PETSc takes its tags from the upper end


class EndExchange:
    """Exchange at the shared nodes of one rank; every call is collective among neighbours.

    comm: mpi4py's communicator of the chain.
    vertices: (nv,) numbers of this rank's nodes, ascending; owned: (nv,) whether it owns them.
    vertex_of: (n,) index in ``vertices`` of each local unknown; the unknowns of a node have the same order on both ranks.
    owned_index: (n,) index of each unknown in the owned part of a vector, -1 if another rank owns it.
    """

    def __init__(
        self, comm: Any, vertices: IntArray, owned: np.ndarray, vertex_of: IntArray, owned_index: IntArray
    ) -> None:
        self._comm = comm
        ends = (int(vertices[0]), int(vertices[-1])) if len(vertices) else ()
        runs: list[tuple[int, ...]] = comm.allgather(ends)
        #: (other rank, local unknowns of the node) of the shared nodes that this rank does not own, and of those that it owns
        self._ghosts: list[tuple[int, IntArray]] = []
        self._owned: list[tuple[int, IntArray]] = []
        self._owned_rows: list[IntArray] = []
        for local in {0, len(vertices) - 1} if ends else ():
            for rank in (r for r, run in enumerate(runs) if r != comm.rank and int(vertices[local]) in run):
                dofs = np.flatnonzero(vertex_of == local)
                if owned[local]:
                    self._owned.append((rank, dofs))
                    self._owned_rows.append(owned_index[dofs])
                else:
                    self._ghosts.append((rank, dofs))

    def spread(self, *arrays: FloatArray) -> None:
        """Copy the owners' values of local arrays (n,) to the ghosts, in place; one message to a neighbour for all arrays."""
        sent = [np.concatenate([a[dofs] for a in arrays]) for _, dofs in self._owned]
        received = [np.empty(len(arrays) * len(dofs)) for _, dofs in self._ghosts]
        self._pass(self._owned, sent, self._ghosts, received)
        for (_, dofs), values in zip(self._ghosts, received, strict=True):
            for array, part in zip(arrays, values.reshape(len(arrays), -1), strict=True):
                array[dofs] = part

    def add(self, local: FloatArray, rows: FloatArray) -> None:
        """Add the ghosts' values of a local array (n,) to the owned part ``rows`` (owned,) of the owners, in place."""
        sent = [local[dofs] for _, dofs in self._ghosts]
        received = [np.empty(len(dofs)) for _, dofs in self._owned]
        self._pass(self._ghosts, sent, self._owned, received)
        for places, values in zip(self._owned_rows, received, strict=True):
            rows[places] += values

    def _pass(self, to: list, sent: list[FloatArray], of: list, received: list[FloatArray]) -> None:
        """Send one array to each neighbour of ``to`` and receive one from each of ``of``."""
        comm = self._comm
        pending = [comm.Irecv(a, source=rank, tag=_TAG) for (rank, _), a in zip(of, received, strict=True)]
        pending += [comm.Isend(a, dest=rank, tag=_TAG) for (rank, _), a in zip(to, sent, strict=True)]
        for request in pending:
            request.Wait()
