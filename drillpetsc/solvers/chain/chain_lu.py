"""Direct solver for the equations of one drillstring: block tridiagonal LU, distributed over the ranks.

The unknowns belong to the nodes of a chain (manual: eq-chain-matrix).  Each rank has a run of neighbouring
elements and all their nodes, so the end node of a run belongs to two ranks.  Such a node is called an
interface.

In serial this is the block Thomas algorithm with partial pivoting inside the pivot block (manual:
eq-chain-thomas; Golub & Van Loan, Matrix Computations, 4th ed., section 4.5.1).  In parallel every rank
eliminates its interior nodes towards its interfaces (manual: eq-chain-fill).  The Schur complement of the
interfaces is block tridiagonal with one node fewer than ranks (manual: eq-chain-schur).  All ranks assemble
it from one Allgatherv and factorise it with identical results (partition method: Wang 1981, ACM Trans. Math.
Softw. 7(2):170-183).

Work per node of block size b, leading term (manual: sec-chain-cost): 14/3 b^3 towards one interface (serial,
first and last rank): LU of the pivot block 2/3, two-sided solve 2, update of the next block 2.  Between two
interfaces it is 38/3 b^3: the fill towards the first interface costs one more solve, 2, and three more
products, 6.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from drillpetsc.errors import SolveError
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import structure
from drillpetsc.solvers.chain.block_tridiagonal import LARGEST_BLOCK, Piece, aligned

#: length of the header before the blocks of a rank's message: failed node (-1: none), its column, smallest
#: and largest pivot ratio, node of the smallest
_HEADER = 5

_ChainCall = structure("chain_call")  # ChainCall of kernels/newton/newton.cpp
_gather = function("chain_gather", "ippp")
_scatter = function("chain_scatter", "ippp")
_scatter_add = function("chain_scatter_add", "ippp")


class ZeroPivot(SolveError):
    """A pivot block has no usable pivot.

    node: number along the chain; unknown: its number at that node.
    """

    def __init__(self, node: int, unknown: int) -> None:
        super().__init__(
            f"the matrix of the string is singular to working precision at node {node}, its unknown {unknown}",
            hint="a part of the string moves without resistance, or an equation is missing there",
        )
        self.node = node
        self.unknown = unknown


def _raise_on_all_ranks(comm: Any, problem: str | None) -> None:
    """Raise ValueError with the first problem of any rank on every rank, so that no rank waits forever.

    Collective.
    """
    problems = [problem] if comm is None else comm.allgather(problem)
    for rank, text in enumerate(problems):
        if text:
            raise ValueError(text if len(problems) == 1 else f"rank {rank}: {text}")


def _check_local(nodes: np.ndarray, sizes: np.ndarray, node_of_dof: np.ndarray) -> str | None:
    """Describe what is wrong with this rank's nodes and unknowns; None if nothing is."""
    if np.any(np.diff(nodes) != 1):
        return f"the nodes of a rank must follow each other along the string, got {nodes.tolist()}"
    if len(node_of_dof) and (node_of_dof.min() < 0 or node_of_dof.max() >= len(nodes)):
        return "an unknown does not belong to a local node"
    if len(sizes) and not 1 <= sizes.min() <= sizes.max() <= LARGEST_BLOCK:
        return f"a node needs 1 to {LARGEST_BLOCK} unknowns, got {sizes.min()} to {sizes.max()}"
    return None


def _chain_order(runs: list) -> list[int]:
    """Return the ranks that have nodes, in the order of the chain.

    runs[rank]: None, or first and last node, then size and owner flags of the first and of the last node.
    """
    order = sorted((r for r, run in enumerate(runs) if run), key=lambda r: runs[r][0])
    if not order:
        raise ValueError("no rank holds a node of the string")
    for a, b in zip(order, order[1:], strict=False):
        (a_first, a_last, *_, a_size, a_owned), (b_first, b_last, b_size, b_owned, *_) = runs[a], runs[b]
        if a_first == a_last or b_first == b_last:
            raise ValueError(f"ranks {a} and {b}: a rank needs an element or no node at all")
        if a_last != b_first or a_size != b_size:
            text = f"rank {a} ends at node {a_last} ({a_size} unknowns), rank {b} starts at node {b_first} ({b_size})"
            raise ValueError(text)
        if any(p == q for p, q in zip(a_owned, b_owned, strict=True)):
            raise ValueError(
                f"ranks {a} and {b}: an unknown of their interface, node {a_last}, needs exactly one owner"
            )
    return order


class _Message:
    """Buffers of an Allgatherv; counts: (ranks,) numbers that each rank sends."""

    def __init__(self, counts: np.ndarray, rank: int):
        self.counts, self.sent, self.received = counts, np.zeros(counts[rank]), np.zeros(counts.sum())

    def exchange(self, comm: Any) -> None:
        """Send ``sent`` and fill ``received``; collective."""
        comm.Allgatherv(self.sent, (self.received, self.counts))


@dataclass(frozen=True)
class ChainNumbering:
    """Nodes and unknowns of this rank's piece of a chain.

    nodes: (n,) numbers along the chain of the local nodes, ascending by one; empty on a rank without
    elements.
    node_of_dof: (size,) index in ``nodes`` of every unknown of the ghosted local vector.  The unknowns of an
    interface must come in the same order on both ranks.
    local_of_owned: (owned,) local number of each owned unknown, in the order of the global vector.
    """

    nodes: np.ndarray
    node_of_dof: np.ndarray
    local_of_owned: np.ndarray


class ChainFactor:
    """Factors of the matrix of one chain.

    Built once for a mesh, refilled by ``factor`` and used by ``solve``.

    comm: communicator of the chain (PETSc's, mpi4py's, or None for one process); collective.
    numbering: of the nodes and unknowns on this rank.
    rows, columns: (m,) local numbers of the matrix entries.  Entries with a negative number are left out.
    Duplicates add up, and so do the contributions of two ranks to their interface.
    pivot_tolerance: a pivot must exceed this fraction of the largest entry of its column in the diagonal
    block.

    After ``factor``:
    smallest_pivot, growth: smallest and largest of that ratio of |pivot| to the column of the diagonal block,
    over all nodes and ranks; columns that are zero in the block are not counted.
    smallest_pivot_node: number of its node along the chain.
    factor_flops, solve_flops: operations of one call on this rank, the interface system included.
    factorisations: number of calls of ``factor`` so far.

    Raises ValueError on every rank if nodes, unknowns or entries do not form a chain.
    """

    def __init__(
        self,
        comm: Any,
        numbering: ChainNumbering,
        rows: np.ndarray,
        columns: np.ndarray,
        *,
        pivot_tolerance: float = 1e-15,
    ) -> None:
        comm = comm.tompi4py() if hasattr(comm, "tompi4py") else comm
        self.comm = comm if comm is not None and comm.size > 1 else None
        nodes = np.asarray(numbering.nodes, dtype=np.int64)
        node_of_dof = np.asarray(numbering.node_of_dof, dtype=np.int64)
        local_of_owned = np.asarray(numbering.local_of_owned)
        n, self.size = len(nodes), len(node_of_dof)
        sizes = np.bincount(np.maximum(node_of_dof, 0), minlength=n)[:n] if n else np.zeros(0, dtype=np.int64)
        _raise_on_all_ranks(self.comm, _check_local(nodes, sizes, node_of_dof))
        owned = np.zeros(self.size, dtype=bool)
        owned[local_of_owned] = True
        interfaces = self._find_interfaces(
            nodes, sizes, [owned[node_of_dof == i].tolist() for i in (0, n - 1)]
        )
        #: the last rank eliminates from the bottom up, towards its only interface
        self._backwards = interfaces == 1
        if self._backwards:
            nodes, sizes, node_of_dof, interfaces = nodes[::-1], sizes[::-1], n - 1 - node_of_dof, 2
        self.nodes, self.piece = nodes, Piece(sizes, interfaces)
        self.pivot_tolerance, self.factorisations = pivot_tolerance, 0
        self._number_unknowns(node_of_dof, owned, local_of_owned)
        problem = None
        try:
            self._set_entries(node_of_dof, np.asarray(rows), np.asarray(columns))
        except ValueError as error:
            problem = str(error)
        _raise_on_all_ranks(self.comm, problem)
        tables = (self._local_at, self._owned_local_at, self._owned_global_at, self._vec)
        self._addresses = {id(table): pointer(table) for table in tables}  # they are never reallocated
        self._prepare_messages()
        self.factor_flops, self.solve_flops = np.add(self.piece.flops(), self.interface.flops()).tolist()
        self.smallest_pivot, self.growth, self.smallest_pivot_node = np.inf, 0.0, -1

    # ------------------------------------------------------------------ tables, once
    def _find_interfaces(self, nodes: np.ndarray, sizes: np.ndarray, owners: list[list[bool]]) -> int:
        """Find the neighbours along the chain; returns the bits of ``Piece.interfaces``; collective."""
        ends = None
        if len(nodes):
            ends = int(nodes[0]), int(nodes[-1]), int(sizes[0]), owners[0], int(sizes[-1]), owners[1]
        runs: list[Any] = [ends] if self.comm is None else self.comm.allgather(ends)
        self._order = _chain_order(runs)
        self._interface_nodes = [runs[r][1] for r in self._order[:-1]]
        self._interface_sizes = [runs[r][4] for r in self._order[:-1]]
        if ends is None:
            return 0
        q = self._order.index(0 if self.comm is None else self.comm.rank)
        return int(q > 0) | int(q < len(self._order) - 1) << 1

    def _number_unknowns(
        self, node_of_dof: np.ndarray, owned: np.ndarray, local_of_owned: np.ndarray
    ) -> None:
        """Build the tables from positions in padded vectors to local vectors and to owned parts of global ones."""
        dofs = np.argsort(node_of_dof, kind="stable")
        position = np.empty(self.size, dtype=np.int64)
        position[dofs] = self.piece.positions()
        number = np.full(self.size, -1)
        number[local_of_owned] = np.arange(len(local_of_owned))
        self._local_at, self._owned_local_at, self._owned_global_at = (
            np.full(self.piece.length, -1, dtype=np.int32) for _ in range(3)
        )
        self._local_at[position] = np.arange(self.size)
        self._owned_local_at[position] = np.where(owned, np.arange(self.size), -1)
        self._owned_global_at[position] = number
        self._component = np.empty(self.size, dtype=np.int64)
        self._component[dofs] = self.piece.components()
        self._vec = aligned(self.piece.length)

    def _set_entries(self, node_of_dof: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> None:
        """Check the matrix entries (m,) and set their positions in the blocks.

        ValueError if one is wrong.
        """
        if rows.shape != columns.shape or rows.ndim != 1:
            raise ValueError(f"rows {rows.shape} and columns {columns.shape} must be flat and of one length")
        largest = max(rows.max(initial=-1), columns.max(initial=-1))
        if largest >= self.size:
            raise ValueError(f"an entry refers to local unknown {largest}, there are {self.size}")
        self._entries = len(rows)
        self.piece.set_matrix_entries(rows, columns, node_of_dof, self._component)

    def _prepare_messages(self) -> None:
        """Build the tables of the interface system: the numbers that each rank sends, and their positions in it.

        Manual: eq-chain-schur.
        """
        self.interface = interface = Piece(np.array(self._interface_sizes, dtype=np.int64), 0)
        if self.comm is None:
            return
        b, size = self._interface_sizes, self.comm.size
        none = np.zeros(0, dtype=np.int64)
        counts, entries = np.zeros((2, size), dtype=int), [np.zeros((5, 0), dtype=np.int64)]
        positions = [none]
        for rank in range(size):
            q = self._order.index(rank) if rank in self._order else -1
            ends = [j for j in (q - 1, q) if q >= 0 and 0 <= j < len(b)]
            start = counts[0].sum() + _HEADER
            for i in ends:
                for j in ends:  # as in Piece.interface_blocks: column by column
                    column, row = (a.ravel() for a in np.indices((b[j], b[i])))
                    number, all_i, all_j = np.arange(len(row)), np.full(len(row), i), np.full(len(row), j)
                    entries.append(np.array([all_i, row, all_j, column, start + number]))
                    start += len(row)
            counts[:, rank] = start - counts[0].sum(), sum(b[j] for j in ends)
            positions += [interface.positions_of(j) for j in ends]
            if rank == self.comm.rank:
                self._from_interface = np.concatenate([none] + [interface.positions_of(j) for j in ends])
        all_i, row, all_j, column, source = np.concatenate(entries, axis=1)
        before = np.cumsum(b, dtype=np.int64) - b  # unknowns of the interfaces above each
        node = np.repeat(np.arange(len(b)), b)
        interface.set_matrix_entries(
            before[all_i] + row, before[all_j] + column, node, interface.components(), source
        )
        self._received_rhs = np.concatenate(positions).astype(np.int32)
        self._sent_blocks = np.concatenate([none] + self.piece.interface_blocks())
        self._at_interface = np.concatenate(
            [none] + [self.piece.positions_of(i) for i in self.piece.interface_nodes()]
        )
        self._headers = (np.cumsum(counts[0]) - counts[0])[:, None] + np.arange(_HEADER)
        self._matrix_message = _Message(counts[0], self.comm.rank)
        self._rhs_message = _Message(counts[1], self.comm.rank)
        self._interface_vec = aligned(interface.length)

    # ------------------------------------------------------------------ numbers
    def factor(self, values: np.ndarray, start: int = 0) -> None:
        """Factor the matrix with entries ``values`` (m,); collective.

        start: the first of this rank's nodes whose entries differ from the last call, or their number if none does.
        Raises ZeroPivot on every rank if a pivot is missing.
        """
        self.factorisations += 1
        values = np.ascontiguousarray(values, dtype=float)
        if values.shape != (self._entries,):
            raise ValueError(f"{values.shape} values for {self._entries} entries")
        piece = self.piece
        failed_node = -1
        if not start or start < piece.n:
            failed_node = piece.factor(values, self.pivot_tolerance, 0 if self._backwards else start)
        column, smallest, largest, smallest_node = piece.stats
        heads = np.array(
            [
                [
                    self.nodes[failed_node] if failed_node >= 0 else -1,
                    column,
                    smallest,
                    largest,
                    self.nodes[int(smallest_node)] if smallest_node >= 0 else -1,
                ]
            ]
        )
        if self.comm is not None:
            message = self._matrix_message
            message.sent[:_HEADER] = heads
            np.take(piece.store, self._sent_blocks, out=message.sent[_HEADER:])
            message.exchange(self.comm)
            heads = message.received[self._headers]
            if self.interface.n and heads[:, 0].max() < 0:
                failed_node = self.interface.factor(message.received, self.pivot_tolerance)
                column, smallest, largest, smallest_node = self.interface.stats
                nodes = [
                    self._interface_nodes[int(i)] if i >= 0 else -1 for i in (failed_node, smallest_node)
                ]
                heads = np.vstack([heads, [nodes[0], column, smallest, largest, nodes[1]]])
        failed = heads[heads[:, 0] >= 0]
        if len(failed):
            raise ZeroPivot(int(failed[0, 0]), int(failed[0, 1]))
        least = heads[np.argmin(heads[:, 2])]
        self.smallest_pivot, self.smallest_pivot_node = float(least[2]), int(least[4])
        self.growth = float(heads[:, 3].max())

    def record(self) -> Any:
        """Arguments of factorisations and solves of owned unknowns in compiled code, on one process."""
        assert self.comm is None
        at = {"vec": pointer(self._vec), "index": pointer(self._owned_global_at)}
        return _ChainCall(**self.piece.record(), **at, tolerance=self.pivot_tolerance)

    def renewed(self, times: int) -> None:
        """Count factorisations that compiled code has done with ``record``."""
        self.factorisations += times
        column, smallest, growth, node = self.piece.stats.tolist()
        if times and column < 0:
            self.smallest_pivot, self.growth = smallest, growth
            self.smallest_pivot_node = int(self.nodes[int(node)]) if node >= 0 else -1

    def _solve_packed(self, vec: np.ndarray) -> None:
        """Solve in place on a padded vector; at interfaces the right-hand sides of two ranks add up."""
        self.piece.forward(vec)
        if self.interface.n:
            message, shared = self._rhs_message, self._interface_vec
            np.take(vec, self._at_interface, out=message.sent)
            message.exchange(self.comm)
            shared[:] = 0.0
            _scatter_add(
                len(message.received), pointer(self._received_rhs), pointer(message.received), pointer(shared)
            )
            self.interface.forward(shared)
            self.interface.backward(shared)
            vec[self._at_interface] = shared[self._from_interface]
        self.piece.backward(vec)

    def _solve(self, source: np.ndarray, b: np.ndarray, target: np.ndarray, x: np.ndarray) -> None:
        n, vec = self.piece.length, self._vec
        if not self.interface.n:
            at = self._addresses
            return self.piece.solve(at[id(source)], pointer(b), at[id(vec)], at[id(target)], pointer(x))
        _gather(n, pointer(source), pointer(b), pointer(vec))
        self._solve_packed(vec)
        _scatter(n, pointer(target), pointer(vec), pointer(x))

    def solve(self, b: np.ndarray, x: np.ndarray) -> None:
        """Solve A x = b for ghosted local arrays (size,); collective.

        b is read at owned entries; x is filled at ghosts as well.  Raises ValueError for other lengths or
        types.
        """
        self._check(b, x, self.size)
        self._solve(self._owned_local_at, b, self._local_at, x)

    def solve_owned(self, b: np.ndarray, x: np.ndarray) -> None:
        """Solve A x = b for the owned parts (owned,) of global vectors; collective."""
        self._solve(self._owned_global_at, b, self._owned_global_at, x)

    @staticmethod
    def _check(b: np.ndarray, x: np.ndarray, size: int) -> None:
        if b.shape != (size,) or x.shape != (size,) or b.dtype != float or x.dtype != float:
            got = f"{b.dtype}{b.shape} and {x.dtype}{x.shape}"
            raise ValueError(f"b and x must be float arrays of length {size}, got {got}")

    def negative_pivots(self, values: np.ndarray) -> int:
        """Count the negative eigenvalues of the symmetric matrix with entries ``values`` (m,), and factor it.

        Collective.

        The inertia of a block LDL^T factorisation without exchanges between blocks is the sum of the inertias
        of the pivot blocks (manual: eq-chain-inertia; Haynsworth 1968, Linear Algebra Appl. 1(1):73-81).
        Raises ZeroPivot as ``factor``.
        """
        pieces = self.piece, self.interface
        for piece in pieces:
            piece.blocks = aligned(piece.pivots)
        try:
            self.factor(values)
            local, shared = self.piece.negative_eigenvalues(), self.interface.negative_eigenvalues()
        finally:
            for piece in pieces:
                piece.blocks = None
        return shared + (local if self.comm is None else self.comm.allreduce(local))


class MatrixValues(Protocol):
    """Provider of matrix entries: ``version`` changes on all ranks whenever ``values`` (m,) change."""

    values: np.ndarray
    version: int


_NUMERIC_ZERO_PIVOT = 2  # PC_FACTOR_NUMERIC_ZEROPIVOT of PCFailedReason


class ChainPC:
    """Context of a PETSc PC of type python (manual: sec-chain-petsc).

    It solves exactly with ``chain`` for KSP preonly, or preconditions a Krylov method with a lagged factor.
    PETSc calls ``setUp`` when the state of the operator changed: assemble it, or call its stateIncrease.  The
    matrix is factored again only where ``provider.version`` changed.

    If a pivot is missing, the KSP diverges with DIVERGED_PC_FAILED, so that the time step can be reduced, and
    ``error`` is the reason.

    chain: the solver; provider: its matrix entries.
    """

    def __init__(self, chain: ChainFactor, provider: MatrixValues):
        from petsc4py import PETSc  # this import starts MPI, so it is not at the head of the module

        self.chain, self.provider = chain, provider
        self.version: int | None = None
        #: number of the chain's factorisation with these values; others may also use the chain
        self._factored = -1
        self.factorisations = 0
        self.error: ZeroPivot | None = None
        self._log = PETSc.Log
        self._factor_event, self._solve_event = PETSc.Log.Event("ChainFactor"), PETSc.Log.Event("ChainSolve")

    def setUp(self, pc) -> None:
        """Factor the matrix if its values are new."""
        if (self.version, self._factored) == (self.provider.version, self.chain.factorisations):
            return
        self.version, self.error = None, None
        self._factor_event.begin()
        try:
            self.chain.factor(self.provider.values)
            self.version, self._factored = self.provider.version, self.chain.factorisations
        except ZeroPivot as error:
            self.error = error
        finally:
            self._factor_event.end()
        _set_failed_reason(pc, _NUMERIC_ZERO_PIVOT if self.error else 0)
        self.factorisations += 1
        self._log.logFlops(self.chain.factor_flops)

    def apply(self, pc, b, x) -> None:
        """Compute x = A^-1 b for global vectors."""
        self._solve_event.begin()
        if self.error is None:
            self.chain.solve_owned(b.getArray(readonly=1), x.getArray())
        else:
            x.set(float("inf"))
        self._log.logFlops(self.chain.solve_flops)
        self._solve_event.end()

    def view(self, pc, viewer) -> None:
        """Print the solver's state, for ``-ksp_view``."""
        c = self.chain
        viewer.printfASCII(
            f"  block tridiagonal LU of the chain, {c.interface.n} interfaces between ranks, smallest pivot "
            f"{c.smallest_pivot:.1e} at node {c.smallest_pivot_node}, growth {c.growth:.1e}\n"
        )


def _set_failed_reason(pc, reason: int) -> None:
    """Set the PCFailedReason of ``pc``, with petsc4py or with the C library."""
    if hasattr(pc, "setFailedReason"):
        pc.setFailedReason(reason)
        return
    import ctypes

    from petsc4py import PETSc

    call = ctypes.CDLL(PETSc.__file__).PCSetFailedReason  # in the C library of 3.18, not in its petsc4py
    call.argtypes = [ctypes.c_void_p, ctypes.c_int]
    if call(pc.handle, reason):
        raise PETSc.Error(reason)
