"""The chain: one DMPlex of the string's nodes (vertices) and elements (cells), distributed over the ranks.

Every rank has a piece of neighbouring cells (manual: sec-chain-structure).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.arrays import IntArray


@dataclass(frozen=True)
class Chain:
    """This rank's part of the chain; global numbers count from the top of the string.

    plex: DMPlex of the whole communicator; size: number of vertices of the whole string.
    vertices: (nv,) global numbers of the local vertices in depth order, ghosts included.
    points: (nv,) DMPlex points of these vertices.
    owned: (nv,) whether this rank owns the vertex.
    cells: (nc,) global numbers of the cells of this rank in depth order.
    ends: (nc, 2) local numbers (indices into ``vertices``) of the upper and lower vertex of each cell.
    """

    plex: PETSc.DMPlex
    size: int
    vertices: IntArray
    points: IntArray
    owned: np.ndarray
    cells: IntArray
    ends: IntArray

    def own(self, vertex: int) -> int | None:
        """Local number of a vertex of the whole string that this rank owns, None if another one does."""
        found = np.flatnonzero(self.owned & (self.vertices == vertex))
        return int(found[0]) if len(found) else None


def build_chain(measured_depth: np.ndarray, comm: PETSc.Comm) -> Chain:
    """Distribute a string over the ranks of ``comm``.

    Every cell belongs to one rank (overlap 0), and a rank's cells are neighbours.

    measured_depth: (n+1,) depths of the vertices [m], ascending.
    comm: PETSc communicator.
    """
    petsc_compat.free_dropped(comm)  # those of earlier models: a session or a study makes one after another
    count = len(measured_depth)
    if comm.rank == 0:
        cells = np.column_stack([np.arange(count - 1), np.arange(1, count)]).astype(np.int32)
        coordinates = np.asarray(measured_depth, dtype=float).reshape(-1, 1)
    else:
        cells, coordinates = np.zeros((0, 2), dtype=np.int32), np.zeros((0, 1))
    plex = PETSc.DMPlex().createFromCellList(1, cells, coordinates, interpolate=False, comm=comm)
    if comm.size > 1:
        part = plex.getPartitioner()
        part.setType("simple")
        part.setFromOptions()
        plex.distribute(overlap=0)
    return _describe(plex, np.asarray(measured_depth, dtype=float))


def _describe(plex: PETSc.DMPlex, measured_depth: np.ndarray) -> Chain:
    """Number this rank's vertices and cells by depth; ``measured_depth`` (n+1,) [m]."""
    first, last = plex.getDepthStratum(0)
    depth = plex.getCoordinatesLocal().getArray(readonly=1).real
    number = np.searchsorted(measured_depth, depth - 1e-9 * max(1.0, measured_depth[-1]))
    order = np.argsort(number, kind="stable")
    points = (np.arange(first, last, dtype=np.int32))[order]
    local_of_point = {int(p): i for i, p in enumerate(points)}
    _, leaves, _ = plex.getPointSF().getGraph() if plex.comm.size > 1 else (0, (), None)
    ghost = set(range(0)) if leaves is None else {int(p) for p in leaves}
    owned = np.array([int(p) not in ghost for p in points], dtype=bool)
    c0, c1 = plex.getHeightStratum(0)
    ends = np.array(
        [[local_of_point[int(p)] for p in plex.getCone(c)] for c in range(c0, c1)], dtype=np.int32
    ).reshape(-1, 2)
    ends.sort(axis=1)
    ends = ends[np.argsort(ends[:, 0], kind="stable")]
    vertices = number[order].astype(np.int32)
    cells = vertices[ends[:, 0]] if len(ends) else np.zeros(0, dtype=np.int32)
    return Chain(plex, len(measured_depth), vertices, points, owned, cells.astype(np.int32), ends)
