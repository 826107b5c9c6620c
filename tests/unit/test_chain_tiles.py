"""Assembly of element matrices into the blocks of the chain: tiles, their last rows and columns, and single entries."""

from __future__ import annotations

import numpy as np

from drillpetsc.solvers.chain.block_tridiagonal import aligned
from drillpetsc.solvers.chain.chain_lu import ChainFactor, ChainNumbering
from tests.helpers.tables import each_row


def element_entries(
    sizes: list[int], order: np.random.Generator | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rows and columns of all elements between neighbouring nodes, by rows of each element; node of each unknown.

    order: shuffles the unknowns of an element, so that its rows are no neighbours in the blocks.
    """
    node = np.repeat(np.arange(len(sizes)), sizes)
    rows, columns = [], []
    for k in range(len(sizes) - 1):
        dofs = np.flatnonzero((node == k) | (node == k + 1))
        if order is not None:
            order.shuffle(dofs)
        rows.append(np.repeat(dofs, len(dofs)))
        columns.append(np.tile(dofs, len(dofs)))
    return np.concatenate(rows), np.concatenate(columns), node


@each_row("sizes", [[7] * 6, [11] * 5, [7, 8, 7, 7], [1, 2, 3, 4, 5], [2, 1, 1, 6], [13, 7, 9, 12]])
@each_row("shuffled", [False, True])
@each_row("left_out", [0, 3])
def test_assembled_blocks_are_sums_of_the_entries(sizes, shuffled, left_out):
    """Two sets of element matrices; the blocks are those of numpy's sums to the bit, and the solution that of numpy.

    left_out: every so many entries is left out, which breaks rows into pieces.
    """
    rng = np.random.default_rng(len(sizes) + sizes[0])
    parts = [element_entries(sizes, rng if shuffled else None) for _ in range(2)]
    node = parts[0][2]
    rows, columns = (np.concatenate([p[i] for p in parts]) for i in (0, 1))
    values = rng.standard_normal(len(rows)) + 10.0 * len(node) * (rows == columns)
    if left_out:
        rows = np.where((np.arange(len(rows)) % left_out == 1) & (rows != columns), -1, rows)
    n, kept = len(node), rows >= 0
    dense = np.zeros((n, n))
    np.add.at(dense, (rows[kept], columns[kept]), values[kept])
    chain = ChainFactor(None, ChainNumbering(np.arange(len(sizes)), node, np.arange(n)), rows, columns)
    piece, place = chain.piece, chain.piece.positions()
    piece.saved = aligned(piece.matrix)
    chain.factor(values)
    blocks = np.zeros((n, n))
    unit, padded, out = np.zeros(n), np.zeros(piece.length), np.zeros(piece.length)
    for j in range(n):  # columns of the assembled matrix by products with it
        unit[:] = 0.0
        unit[j] = 1.0
        padded[:], out[:] = 0.0, 0.0
        padded[place] = unit
        piece.subtract_matrix(padded, out)
        blocks[:, j] = -out[place]
    assert np.array_equal(blocks, dense)
    b, x = rng.standard_normal(n), np.zeros(n)
    chain.solve(b, x)
    assert np.allclose(x, np.linalg.solve(dense, b), rtol=1e-10, atol=1e-13)
    assert np.isfinite(padded).all()
