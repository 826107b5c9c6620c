"""Exact direct solver for the equations of one drillstring: block tridiagonal LU, shared out over the ranks.

The unknowns live on the nodes of a chain; each rank holds a run of neighbouring elements and all their nodes,
so the end node of a run also stands on the neighbouring rank.  Serially this is the block Thomas algorithm
(Golub & Van Loan, Matrix Computations, 4th ed., section 4.5.1) with partial pivoting inside the pivot block.
In parallel every rank eliminates its own nodes towards its joints; what is left is a block tridiagonal system
of the joints, one fewer than ranks, which all ranks assemble from one Allgatherv and solve alike (the
partition method: Wang 1981, ACM Trans. Math. Softw. 7(2):170-183).

Work per node of block size b, leading term: 14/3 b^3 towards one joint (first and last rank, and serial: LU
of the pivot block 2/3, two-sided solve 2, update of the next block 2), 38/3 b^3 between two joints (the fill
to the first joint costs one more solve, 2, and three more products, 6).
"""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np

from drillpetsc.errors import SolveError
from drillpetsc.kernels import function, pointer
from drillpetsc.solvers.block_tridiagonal import LARGEST_BLOCK, Piece, aligned

#: numbers before the blocks of a rank's message: failed node (-1: none), its column, smallest and largest
#: pivot ratio,
#: node of the smallest
_HEADER = 5

_gather = function("chain_gather", "ippp")
_scatter = function("chain_scatter", "ippp")
_scatter_add = function("chain_scatter_add", "ippp")


class ZeroPivot(SolveError):
    """A pivot block has no usable pivot.  node: number along the chain; unknown: its number at that node."""

    def __init__(self, node: int, unknown: int) -> None:
        super().__init__(
            f"the matrix of the string is singular to working precision at node {node}, its unknown {unknown}",
            hint="part of the string is free to move without resistance, or an equation is missing there",
        )
        self.node = node
        self.unknown = unknown


def _agree(comm: Any, problem: str | None) -> None:
    """Raise the first problem of any rank on every rank, so that none is left waiting."""
    problems = [problem] if comm is None else comm.allgather(problem)
    for rank, text in enumerate(problems):
        if text:
            raise ValueError(text if len(problems) == 1 else f"rank {rank}: {text}")


def _check_local(nodes: np.ndarray, sizes: np.ndarray, node_of_dof: np.ndarray) -> str | None:
    if np.any(np.diff(nodes) != 1):
        return f"the nodes of a rank must follow each other along the string, got {nodes.tolist()}"
    if len(node_of_dof) and (node_of_dof.min() < 0 or node_of_dof.max() >= len(nodes)):
        return "an unknown belongs to no local node"
    if len(sizes) and not 1 <= sizes.min() <= sizes.max() <= LARGEST_BLOCK:
        return f"a node needs 1 to {LARGEST_BLOCK} unknowns, got {sizes.min()} to {sizes.max()}"
    return None


def _chain_order(runs: list) -> list[int]:
    """Ranks with nodes, in the order of the chain; runs[rank]: None or first and last node, size and owners
    of both."""
    order = sorted((r for r, run in enumerate(runs) if run), key=lambda r: runs[r][0])
    if not order:
        raise ValueError("no rank holds a node of the string")
    for a, b in zip(order, order[1:], strict=False):
        (a_first, joint, *_, a_size, a_owned), (b_first, b_last, b_size, b_owned, *_) = runs[a], runs[b]
        if a_first == joint or b_first == b_last:
            raise ValueError(f"ranks {a} and {b}: a rank needs an element or no node at all")
        if joint != b_first or a_size != b_size:
            text = f"rank {a} ends at node {joint} ({a_size} unknowns), rank {b} starts at node {b_first} ({b_size})"
            raise ValueError(text)
        if any(p == q for p, q in zip(a_owned, b_owned, strict=True)):
            raise ValueError(
                f"ranks {a} and {b}: an unknown of their joint, node {joint}, needs exactly one owner"
            )
    return order


class _Message:
    """Buffers of an Allgatherv with counts (ranks,)."""

    def __init__(self, counts: np.ndarray, rank: int):
        self.counts, self.sent, self.received = counts, np.zeros(counts[rank]), np.zeros(counts.sum())

    def exchange(self, comm: Any) -> None:
        comm.Allgatherv(self.sent, (self.received, self.counts))


class ChainFactor:
    """Factors of the matrix of one chain; built once for a mesh, refilled by ``factor`` and used by
    ``solve``.

    comm: communicator of the chain (PETSc's, mpi4py's, or None for one process); collective.
    nodes: (n,) numbers along the chain of the local nodes, ascending by one; empty on a rank without
    elements.
    node_of_dof: (size,) position in ``nodes`` of every unknown of the ghosted local vector; the unknowns of a
    shared node must come in the same order on both ranks.
    local_of_owned: (owned,) local number of each owned unknown, in the order of the global vector.
    rows, columns: (m,) local numbers of the matrix entries; entries with a negative number are left out,
    duplicates add up, and so do the contributions of two ranks to their joint.
    refine: steps of iterative refinement in every solve.
    pivot_tolerance: a pivot must exceed this fraction of the largest entry of its column in the diagonal
    block.

    After ``factor``: smallest_pivot and growth, the smallest and largest of that ratio of |pivot| to the
    column of the diagonal block over all nodes and ranks (columns that are zero in the block not counted),
    and smallest_pivot_node. factor_flops, solve_flops: work of one call on this rank, the joint system
    included.
    """

    def __init__(
        self,
        comm: Any,
        nodes: np.ndarray,
        node_of_dof: np.ndarray,
        local_of_owned: np.ndarray,
        rows: np.ndarray,
        columns: np.ndarray,
        *,
        refine: int = 0,
        pivot_tolerance: float = 1e-15,
    ) -> None:
        comm = comm.tompi4py() if hasattr(comm, "tompi4py") else comm
        self.comm = comm if comm is not None and comm.size > 1 else None
        nodes, node_of_dof = np.asarray(nodes, dtype=np.int64), np.asarray(node_of_dof, dtype=np.int64)
        n, self.size = len(nodes), len(node_of_dof)
        sizes = np.bincount(np.maximum(node_of_dof, 0), minlength=n)[:n] if n else np.zeros(0, dtype=np.int64)
        _agree(self.comm, _check_local(nodes, sizes, node_of_dof))
        owned = np.zeros(self.size, dtype=bool)
        owned[local_of_owned] = True
        keep = self._join(nodes, sizes, [owned[node_of_dof == i].tolist() for i in (0, n - 1)])
        backwards = keep == 1  # the last rank eliminates from the bottom up, towards its only joint
        if backwards:
            nodes, sizes, node_of_dof, keep = nodes[::-1], sizes[::-1], n - 1 - node_of_dof, 2
        self.nodes, self.piece = nodes, Piece(sizes, keep)
        self.refine, self.pivot_tolerance = refine, pivot_tolerance
        self._place_unknowns(node_of_dof, owned, np.asarray(local_of_owned))
        problem = None
        try:
            self._place_entries(node_of_dof, np.asarray(rows), np.asarray(columns))
        except ValueError as error:
            problem = str(error)
        _agree(self.comm, problem)
        self._prepare_messages()
        if refine:
            self.piece.saved = aligned(self.piece.matrix)
        self.factor_flops, self.solve_flops = np.add(self.piece.flops(), self.joint.flops()).tolist()
        self.smallest_pivot, self.growth, self.smallest_pivot_node = np.inf, 0.0, -1

    # ------------------------------------------------------------------ tables, once
    def _join(self, nodes: np.ndarray, sizes: np.ndarray, owners: list[list[bool]]) -> int:
        """Find the neighbours along the chain; returns which end nodes are joints (see Piece.keep)."""
        ends = None
        if len(nodes):
            ends = int(nodes[0]), int(nodes[-1]), int(sizes[0]), owners[0], int(sizes[-1]), owners[1]
        runs: list[Any] = [ends] if self.comm is None else self.comm.allgather(ends)
        self._order = _chain_order(runs)
        self._joint_nodes = [runs[r][1] for r in self._order[:-1]]
        self._joint_sizes = [runs[r][4] for r in self._order[:-1]]
        if ends is None:
            return 0
        q = self._order.index(0 if self.comm is None else self.comm.rank)
        return int(q > 0) | int(q < len(self._order) - 1) << 1

    def _place_unknowns(self, node_of_dof: np.ndarray, owned: np.ndarray, local_of_owned: np.ndarray) -> None:
        """Where an unknown stands in padded vectors, local vectors and the owned part of global ones."""
        dofs = np.argsort(node_of_dof, kind="stable")
        place = np.empty(self.size, dtype=np.int64)
        place[dofs] = self.piece.positions()
        number = np.full(self.size, -1)
        number[local_of_owned] = np.arange(len(local_of_owned))
        self._of_place, self._owned_of_place, self._global_of_place = (
            np.full(self.piece.length, -1, dtype=np.int32) for _ in range(3)
        )
        self._of_place[place] = np.arange(self.size)
        self._owned_of_place[place] = np.where(owned, np.arange(self.size), -1)
        self._global_of_place[place] = number
        self._component = np.empty(self.size, dtype=np.int64)
        self._component[dofs] = self.piece.components()
        self._vec, self._rhs, self._sum = (aligned(self.piece.length) for _ in range(3))

    def _place_entries(self, node_of_dof: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> None:
        if rows.shape != columns.shape or rows.ndim != 1:
            raise ValueError(f"rows {rows.shape} and columns {columns.shape} must be flat and of one length")
        used = (rows >= 0) & (columns >= 0)
        r, c = rows[used], columns[used]
        if len(r) and max(r.max(), c.max()) >= self.size:
            raise ValueError(f"an entry names local unknown {max(r.max(), c.max())}, there are {self.size}")
        self._entries = len(rows)
        at = self._component
        self.piece.place_entries(node_of_dof[r], at[r], node_of_dof[c], at[c], np.flatnonzero(used))

    def _prepare_messages(self) -> None:
        """Tables of the joint system: what each rank sends, and where it goes."""
        self.joint = joint = Piece(np.array(self._joint_sizes, dtype=np.int64), 0)
        if self.comm is None:
            return
        b, size = self._joint_sizes, self.comm.size
        none = np.zeros(0, dtype=np.int64)
        counts, entries, places = np.zeros((2, size), dtype=int), [np.zeros((5, 0), dtype=np.int64)], [none]
        for rank in range(size):
            q = self._order.index(rank) if rank in self._order else -1
            ends = [j for j in (q - 1, q) if q >= 0 and 0 <= j < len(b)]
            at = counts[0].sum() + _HEADER
            for i in ends:
                for j in ends:  # as in Piece.joints: column by column
                    column, row = (a.ravel() for a in np.indices((b[j], b[i])))
                    number, all_i, all_j = np.arange(len(row)), np.full(len(row), i), np.full(len(row), j)
                    entries.append(np.array([all_i, row, all_j, column, at + number]))
                    at += len(row)
            counts[:, rank] = at - counts[0].sum(), sum(b[j] for j in ends)
            places += [joint.places(j) for j in ends]
            if rank == self.comm.rank:
                self._from_joint = np.concatenate([none] + [joint.places(j) for j in ends])
        joint.place_entries(*np.concatenate(entries, axis=1))
        self._received_rhs = np.concatenate(places).astype(np.int32)
        self._sent_blocks = np.concatenate([none] + self.piece.joints())
        self._kept = np.concatenate([none] + [self.piece.places(i) for i in self.piece.kept()])
        self._headers = (np.cumsum(counts[0]) - counts[0])[:, None] + np.arange(_HEADER)
        self._matrix_message = _Message(counts[0], self.comm.rank)
        self._rhs_message = _Message(counts[1], self.comm.rank)
        self._joint_vec = aligned(joint.length)

    # ------------------------------------------------------------------ numbers
    def factor(self, values: np.ndarray) -> None:
        """Factor the matrix with entries values (m,); collective.  Without a pivot raises ZeroPivot on every
        rank."""
        values = np.ascontiguousarray(values, dtype=float)
        if values.shape != (self._entries,):
            raise ValueError(f"{values.shape} values for {self._entries} entries")
        piece = self.piece
        bad = piece.factor(values, self.pivot_tolerance)
        column, smallest, largest, where = piece.stats
        heads = np.array(
            [
                [
                    self.nodes[bad] if bad >= 0 else -1,
                    column,
                    smallest,
                    largest,
                    self.nodes[int(where)] if where >= 0 else -1,
                ]
            ]
        )
        if self.comm is not None:
            message = self._matrix_message
            message.sent[:_HEADER] = heads
            np.take(piece.store, self._sent_blocks, out=message.sent[_HEADER:])
            message.exchange(self.comm)
            heads = message.received[self._headers]
            if self.joint.n and heads[:, 0].max() < 0:
                bad = self.joint.factor(message.received, self.pivot_tolerance)
                column, smallest, largest, where = self.joint.stats
                at = [self._joint_nodes[int(i)] if i >= 0 else -1 for i in (bad, where)]
                heads = np.vstack([heads, [at[0], column, smallest, largest, at[1]]])
        failed = heads[heads[:, 0] >= 0]
        if len(failed):
            raise ZeroPivot(int(failed[0, 0]), int(failed[0, 1]))
        least = heads[np.argmin(heads[:, 2])]
        self.smallest_pivot, self.smallest_pivot_node = float(least[2]), int(least[4])
        self.growth = float(heads[:, 3].max())

    def _solve_packed(self, vec: np.ndarray) -> None:
        """Padded vector in place; on kept nodes the contributions of the ranks add up."""
        self.piece.forward(vec)
        if self.joint.n:
            message, shared = self._rhs_message, self._joint_vec
            np.take(vec, self._kept, out=message.sent)
            message.exchange(self.comm)
            shared[:] = 0.0
            _scatter_add(
                len(message.received), pointer(self._received_rhs), pointer(message.received), pointer(shared)
            )
            self.joint.forward(shared)
            self.joint.backward(shared)
            vec[self._kept] = shared[self._from_joint]
        self.piece.backward(vec)

    def _solve(self, source: np.ndarray, b: np.ndarray, target: np.ndarray, x: np.ndarray) -> None:
        n, vec = self.piece.length, self._vec
        if not (self.joint.n or self.refine):
            return self.piece.solve(source, b, vec, target, x)
        _gather(n, pointer(source), pointer(b), pointer(vec))
        if self.refine:
            self._rhs[:] = vec
            self._solve_packed(vec)
            for _ in range(self.refine):
                self._sum[:] = vec
                vec[:] = self._rhs
                self.piece.subtract_matrix(self._sum, vec)
                self._solve_packed(vec)
                vec += self._sum
        else:
            self._solve_packed(vec)
        _scatter(n, pointer(target), pointer(vec), pointer(x))

    def solve(self, b: np.ndarray, x: np.ndarray) -> None:
        """Solve for ghosted local arrays (size,): b is read at owned entries, x filled at ghosts too.
        Collective."""
        self._check(b, x, self.size)
        self._solve(self._owned_of_place, b, self._of_place, x)

    def solve_owned(self, b: np.ndarray, x: np.ndarray) -> None:
        """The same for the owned parts of global vectors, (owned,)."""
        self._solve(self._global_of_place, b, self._global_of_place, x)

    @staticmethod
    def _check(b: np.ndarray, x: np.ndarray, size: int) -> None:
        if b.shape != (size,) or x.shape != (size,) or b.dtype != float or x.dtype != float:
            got = f"{b.dtype}{b.shape} and {x.dtype}{x.shape}"
            raise ValueError(f"b and x must be float arrays of length {size}, got {got}")

    def negative_pivots(self, values: np.ndarray) -> int:
        """Number of negative eigenvalues of the symmetric matrix with entries values (m,); factors it too.
        Collective.

        Sylvester's law of inertia for the block LDL^T factorisation (no exchange between blocks): the inertia
        is the sum of the inertias of the pivot blocks (Haynsworth 1968, Linear Algebra Appl. 1(1):73-81).
        """
        pieces = self.piece, self.joint
        for piece in pieces:
            piece.blocks = aligned(piece.matrix)
        try:
            self.factor(values)
            own, shared = self.piece.negative(), self.joint.negative()
        finally:
            for piece in pieces:
                piece.blocks = None
        return shared + (own if self.comm is None else self.comm.allreduce(own))


class MatrixValues(Protocol):
    """Provider of matrix entries: ``version`` changes, on all ranks alike, with ``values`` (m,)."""

    values: np.ndarray
    version: int


_NUMERIC_ZERO_PIVOT = 2  # PC_FACTOR_NUMERIC_ZEROPIVOT of PCFailedReason


class ChainPC:
    """Context of a PETSc PC of type python: exact solve with ``chain``, for KSP preonly or around a lagged
    factor.

    PETSc calls ``setUp`` when the state of the operator changed (assemble it, or call its stateIncrease); the
    matrix is factored again only if ``provider.version`` moved on.  stop: a missing pivot raises ZeroPivot;
    else the KSP diverges with DIVERGED_PC_FAILED, so that a time step can be cut, and ``error`` keeps the
    reason.
    """

    def __init__(self, chain: ChainFactor, provider: MatrixValues, *, stop: bool = True):
        from petsc4py import PETSc  # starts MPI: not at import

        self.chain, self.provider, self.stop = chain, provider, stop
        self.version: int | None = None
        self.factorisations = 0
        self.error: ZeroPivot | None = None
        self._log = PETSc.Log
        self._factor_event, self._solve_event = PETSc.Log.Event("ChainFactor"), PETSc.Log.Event("ChainSolve")

    def setUp(self, pc) -> None:
        """Factor if the values are new."""
        if self.version == self.provider.version:
            return
        self.version, self.error = None, None
        self._factor_event.begin()
        try:
            self.chain.factor(self.provider.values)
            self.version = self.provider.version
        except ZeroPivot as error:
            if self.stop:
                raise
            self.error = error
        finally:
            self._factor_event.end()
        _set_failed_reason(pc, _NUMERIC_ZERO_PIVOT if self.error else 0)
        self.factorisations += 1
        self._log.logFlops(self.chain.factor_flops)

    def apply(self, pc, b, x) -> None:
        """x = A^-1 b for global vectors."""
        self._solve_event.begin()
        if self.error is None:
            self.chain.solve_owned(b.getArray(readonly=1), x.getArray())
        else:
            x.set(float("inf"))
        self._log.logFlops((1 + self.chain.refine) * self.chain.solve_flops)
        self._solve_event.end()

    def view(self, pc, viewer) -> None:
        c = self.chain
        viewer.printfASCII(
            f"  block tridiagonal LU of the chain, {c.joint.n} joints between ranks, smallest pivot "
            f"{c.smallest_pivot:.1e} at node {c.smallest_pivot_node}, growth {c.growth:.1e}\n"
        )


def _set_failed_reason(pc, reason: int) -> None:
    if hasattr(pc, "setFailedReason"):
        pc.setFailedReason(reason)
        return
    import ctypes

    from petsc4py import PETSc

    call = ctypes.CDLL(PETSc.__file__).PCSetFailedReason  # in the C library of 3.18, not in its petsc4py
    call.argtypes = [ctypes.c_void_p, ctypes.c_int]
    if call(pc.handle, reason):
        raise PETSc.Error(reason)
