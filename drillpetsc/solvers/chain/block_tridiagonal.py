"""Block tridiagonal LU of one run of nodes on one process: packed storage, and calls into kernels/chain/chain.cpp.

Manual: eq-chain-thomas (factorisation), eq-chain-sweeps (solve), eq-chain-fill (fill towards an interface),
eq-chain-inertia (negative eigenvalues), sec-chain-storage.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import columns, constant

LARGEST_BLOCK = int(constant("largest_block"))  # unknowns per node
_TABLE, _STATS = columns("chain_table"), columns("chain_stats")
_SIZE, _LD, _DIAG, _UPPER, _LOWER, _LEFT, _TOP, _VEC = (
    _TABLE[name] for name in ("size", "ld", "diag", "upper", "lower", "left", "top", "vec")
)

_factor = function("chain_factor", "iiipppppppppp" + "ppdppp", int)
_forward = function("chain_forward", "iippppp")
_backward = function("chain_backward", "iippp")
_solve = function("chain_solve", "ippppippppp")
_residual = function("chain_residual", "ipppp")
_count_runs = function("chain_count_runs", "ippppip", int)
_runs = function("chain_runs", "ipppppippppipp", int)
_tiles = function("chain_tiles", "ippppp" + "p")
_TILE = int(constant("tile"))  # numbers of a tile
#: numbers for the patterns of the entries, more if they do not suffice (manual: sec-chain-storage)
PATTERN_CAPACITY = 1 << 16
_negative = function("chain_negative", "iipp", int)


def aligned(count: int) -> np.ndarray:
    """Allocate ``count`` zeros that start on a cache line."""
    raw = np.zeros(count + 8)
    start = -(pointer(raw) // 8) % 8
    return raw[start : start + count]


def chain_flops(size: int, after: int, fill: int) -> tuple[int, int]:
    """Count the operations of a factorisation and of a solve for one eliminated node (manual: sec-chain-cost).

    size, after: unknowns of the node and of the next one; fill: of an interface at the other end, 0 without one.
    """
    factor = sum((size - k - 1) * (2 * (size - k - 1) + 1) for k in range(size)) + 2 * size * size * (
        after + fill
    )
    factor += 2 * size * (after + fill) ** 2
    return factor, 2 * size * size + 4 * size * (after + fill)


class Piece:
    """Packed blocks of one run of n nodes on one process, without MPI.

    sizes: (n,) unknowns per node.
    interfaces: bit 0 (1) is set if the first (last) node is an interface, which the elimination leaves.

    store: blocks of the matrix, later of its factors; saved: copy of the matrix for ``subtract_matrix``, or None.
    blocks: copy of the pivot blocks for ``negative_eigenvalues``, or None.
    length: entries of a padded vector; node i starts at ``table[i, _VEC]``.
    stats: (4,) column without a pivot, smallest and largest pivot ratio, node of the smallest.
    """

    def __init__(self, sizes: np.ndarray, interfaces: int):
        n, b = len(sizes), np.asarray(sizes, dtype=np.int64)
        ld = -(-b // 4) * 4
        after = np.append(b, 0)[1:]  # columns of A(i,i+1)
        before = np.append(0, b)[:-1]
        # what the forward sweep reads, node after node, then what the backward sweep reads
        block_sizes = np.concatenate([np.stack([ld * b, ld * before], axis=1).ravel(), ld * after])
        start = np.concatenate([[0], np.cumsum(block_sizes)])
        table = np.zeros((n, _TABLE.width), dtype=np.int64)
        table[:, _SIZE], table[:, _LD] = b, ld
        table[:, [_DIAG, _LOWER]], table[:, _UPPER] = start[: 2 * n].reshape(n, 2), start[2 * n : -1]
        self.matrix = end = int(start[-1])  # entries of ``store`` without the fill to node 0
        if interfaces & 1:
            for column, need in ((_LEFT, ld * b[0]), (_TOP, ld[0] * b)):
                table[:, column] = end + np.cumsum(need) - need
                end += int(need.sum())
            # at node 1 the fill is the matrix itself
            table[1:2, _LEFT], table[1:2, _TOP] = table[1:2, _LOWER], table[0, _UPPER]
        table[:, _VEC] = np.cumsum(ld) - ld
        self.pivots = int((ld * b).sum())  # entries of all pivot blocks
        self.n, self.interfaces, self.table, self.length = n, interfaces, table, int(ld.sum())
        self.store, self.inverse = aligned(end), aligned(self.length)
        # each node's rows keep their order, because rows of the padding stay in place
        self.pivot = (np.arange(self.length) - np.repeat(table[:, _VEC], ld)).astype(np.int32)
        self.stats = np.zeros(_STATS.width)
        self.saved: np.ndarray | None = None
        self.blocks: np.ndarray | None = None
        self._piece = (n, interfaces, pointer(table), pointer(self.store))
        self._lu = (pointer(self.inverse), pointer(self.pivot))

    def set_matrix_entries(
        self,
        rows: np.ndarray,
        columns: np.ndarray,
        node: np.ndarray,
        component: np.ndarray,
        source: np.ndarray | None = None,
    ) -> None:
        """Set the positions of the entries (m,) of a matrix in the blocks.

        rows, columns: unknowns, negative if an entry is left out; node, component: (size,) of each unknown.
        source: (m,) numbers of the entries in the values of ``factor``, None for 0 to m - 1; duplicates add up.
        Raises ValueError if an entry couples nodes that are not neighbours.
        """
        rows, columns, node, component = (
            np.ascontiguousarray(a, dtype=np.int32) for a in (rows, columns, node, component)
        )
        if source is not None:
            source = np.ascontiguousarray(source, dtype=np.int32)
        entries = pointer(rows), pointer(columns), 0 if source is None else pointer(source), pointer(node)
        start = np.zeros(self.n + 1, dtype=np.int32)
        wrong = _count_runs(len(rows), *entries, self.n, pointer(start))
        if wrong >= 0:
            raise ValueError(
                f"an entry couples local nodes {node[rows[wrong]]} and {node[columns[wrong]]}: not neighbours"
            )
        first, pattern = np.empty((2, start[-1]), dtype=np.int32)
        begin, patterns, capacity = np.zeros(start[-1] + 1, dtype=np.int32), -1, PATTERN_CAPACITY
        while patterns < 0:
            slots, now = np.empty(capacity, dtype=np.int32), start.copy()
            tables = (pointer(a) for a in (self.table, now, first, pattern))
            found = pointer(begin), pointer(slots)
            patterns = _runs(len(rows), *entries, pointer(component), self.n, *tables, capacity, *found)
            capacity *= 8
        count = int(begin[patterns])
        tile_begin, single_begin = np.empty((2, patterns + 1), dtype=np.int32)
        tiles, singles = np.empty((count, _TILE), dtype=np.int32), np.empty((count, 2), dtype=np.int32)
        _tiles(patterns, *map(pointer, (begin, slots, tile_begin, tiles, single_begin, singles)))
        tiles, singles = tiles[: tile_begin[-1]].copy(), singles[: single_begin[-1]].copy()
        self._runs = start, first, pattern, tile_begin, tiles, single_begin, singles
        self._entries = tuple(map(pointer, self._runs))

    def interface_blocks(self) -> list[np.ndarray]:
        """Return the positions in ``store`` of the blocks between interfaces, rows of the first interface first."""
        t, last, b = self.table, self.n - 1, self.table[:, _SIZE]
        ends = self.interface_nodes()
        out = []
        for i in ends:
            for j in ends:
                start = t[i, _DIAG] if i == j else t[last, _TOP] if i == 0 else t[last, _LEFT]
                out.append((start + np.arange(b[j])[:, None] * t[i, _LD] + np.arange(b[i])).ravel())
        return out

    def factor(self, values: np.ndarray, tolerance: float, start: int = 0) -> int:
        """Assemble ``values`` (m,) and eliminate (manual: eq-chain-thomas, eq-chain-fill).

        start: nodes before this one keep the factors of the last call, whose entries they share (manual: sec-chain-tail).
        tolerance: a pivot must exceed this fraction of the largest entry of its column in the diagonal block.
        Returns -1, or the local node without a pivot (``stats[0]``: its column).
        """
        saved = 0 if self.saved is None else pointer(self.saved)
        blocks = 0 if self.blocks is None else pointer(self.blocks)
        stats = pointer(self.stats)
        if start and (self.interfaces & 1 or self.saved is not None or self.blocks is not None):
            start = 0
        return _factor(
            start,
            *self._piece,
            *self._entries,
            pointer(values),
            *self._lu,
            tolerance,
            stats,
            saved,
            blocks,
        )

    def record(self) -> dict[str, int]:
        """Sizes and addresses of the piece for compiled code, by the names of ChainCall in kernels/newton/newton.cpp."""
        names = ("start", "first_entry", "pattern", "tile_begin", "tiles", "single_begin", "singles")
        n, _, table, store = self._piece
        inverse, pivot = self._lu
        own = {
            "n": n,
            "length": self.length,
            "table": table,
            "store": store,
            "inverse": inverse,
            "pivot": pivot,
        }
        return own | dict(zip(names, self._entries, strict=True)) | {"stats": pointer(self.stats)}

    def forward(self, vec: np.ndarray) -> None:
        """Sweep towards the interfaces, in place on a padded vector (manual: eq-chain-sweeps).

        Eliminated nodes get D^-1 (...), interfaces their reduced right-hand side.
        """
        _forward(*self._piece, *self._lu, pointer(vec))

    def backward(self, vec: np.ndarray) -> None:
        """Sweep from the interfaces, which contain their solution, to all nodes.

        In place on a padded vector.
        """
        _backward(*self._piece, pointer(vec))

    def solve(self, source: int, b: int, vec: int, target: int, x: int) -> None:
        """Solve a piece without interfaces: x[target] is the solution for b[source].  All are addresses of arrays.

        source, target: (length,) indices into b and x, -1 for padding and for unknowns without an entry.
        vec: (length,) work array.
        """
        n, _, table, store = self._piece
        _solve(n, table, store, *self._lu, self.length, source, b, vec, target, x)

    def subtract_matrix(self, x: np.ndarray, r: np.ndarray) -> None:
        """Compute r -= A x for padded vectors, with the matrix in ``saved``."""
        assert self.saved is not None
        _residual(self.n, pointer(self.table), pointer(self.saved), pointer(x), pointer(r))

    def interface_nodes(self) -> list[int]:
        """Local nodes that the elimination leaves."""
        return [i for i, bit in ((0, 1), (self.n - 1, 2)) if self.interfaces & bit]

    def positions_of(self, node: int) -> np.ndarray:
        """Positions of a node's unknowns in a padded vector."""
        return self.table[node, _VEC] + np.arange(self.table[node, _SIZE])

    def components(self) -> np.ndarray:
        """(unknowns,) number of each unknown within its node, node after node."""
        b = self.table[:, _SIZE]
        return np.arange(b.sum()) - np.repeat(np.cumsum(b) - b, b)

    def positions(self) -> np.ndarray:
        """(unknowns,) position of each unknown in a padded vector, node after node."""
        b = self.table[:, _SIZE]
        return np.repeat(self.table[:, _VEC], b) + self.components()

    def flops(self) -> tuple[int, int]:
        """Count the multiplications and additions of a factorisation and of a solve, without padding.

        Manual: sec-chain-cost.
        """
        b = self.table[:, _SIZE].tolist()
        first, last = self.interfaces & 1, self.n - (self.interfaces >> 1)
        fill = b[0] if first else 0
        parts = [chain_flops(b[i], b[i + 1] if i + 1 < self.n else 0, fill) for i in range(first, last)]
        factor, solve = np.sum(parts, axis=0).tolist() if parts else (0, 0)
        return int(factor), int(solve)

    def negative_eigenvalues(self) -> int:
        """Count the negative eigenvalues of the symmetrised pivot blocks of the last factorisation with ``blocks``.

        Manual: eq-chain-inertia.
        """
        assert self.blocks is not None
        n, interfaces, table, _ = self._piece
        return _negative(n, interfaces, table, pointer(self.blocks))
