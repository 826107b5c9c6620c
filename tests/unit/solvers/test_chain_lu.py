"""The chain solver on one process against numpy's dense routines (LAPACK)."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

from drillpetsc.kernels.parameters import columns
from drillpetsc.solvers.chain.block_tridiagonal import Piece
from drillpetsc.solvers.chain.chain_lu import ChainFactor, ChainNumbering, ZeroPivot
from tests.helpers.tables import each_row

SHAPES = {
    "one node": [7],
    "one unknown": [1],
    "one element": [7, 7],
    "one element, two sizes": [8, 3],
    "sevens": [7] * 30,
    "eights": [8] * 12,
    "twelves": [12] * 9,
    "sixteens": [16] * 5,
    "wide": [7, 8, 7, 17, 7, 24, 20, 32, 28, 7, 32],
    "scalar": [1] * 40,
    "mixed": [7, 7, 8, 7, 3, 12, 7, 1, 8, 2, 7, 7, 16, 7, 5, 4, 7, 9, 8, 13, 7],
}


def dense_chain(sizes, rng):
    """A random block tridiagonal matrix, and the node of each unknown."""
    node = np.repeat(np.arange(len(sizes)), sizes)
    A = rng.standard_normal((len(node), len(node)))
    A[np.abs(node[:, None] - node) > 1] = 0.0
    return A, node


def factored(A, node, split=False, **options):
    """The chain solver for a dense matrix; split: every entry comes as two halves that add up, in random
    order."""
    rows, columns = np.nonzero(np.abs(node[:, None] - node) <= 1)
    values = A[rows, columns]
    if split:
        mix = np.random.default_rng(0).permutation(2 * len(rows))
        rows, columns, values = (np.tile(a, 2)[mix] for a in (rows, columns, 0.5 * values))
    n = len(node)
    f = ChainFactor(
        None,
        ChainNumbering(np.arange(node[-1] + 1), node, np.arange(n)),
        rows.astype(np.int32),
        columns.astype(np.int32),
        **options,
    )
    f.factor(values)
    return f


@pytest.mark.parametrize("interfaces", [0, 2])
def test_each_sweep_reads_its_blocks_in_order(interfaces):
    """Blocks of the forward sweep follow each other without a gap, and then those of the backward sweep: sweeps fetch them ahead."""
    piece = Piece(np.array(SHAPES["mixed"]), interfaces)
    table, at = piece.table, columns("chain_table")
    size, ld = table[:, at["size"]], table[:, at["ld"]]
    np.testing.assert_array_equal(table[:, at["lower"]], table[:, at["diag"]] + ld * size)
    ends = table[:, at["lower"]] + ld * np.append(0, size[:-1])
    np.testing.assert_array_equal(np.append(table[1:, at["diag"]], table[0, at["upper"]]), ends)
    ends = table[:, at["upper"]] + ld * np.append(size[1:], 0)
    np.testing.assert_array_equal(np.append(table[1:, at["upper"]], piece.matrix), ends)


def solution(f, b):
    x = np.full_like(b, np.nan)
    f.solve(b, x)
    return x


@each_row("shape", SHAPES)
def test_well_conditioned(shape):
    """Diagonally dominant by blocks: the error stays at rounding level."""
    rng = np.random.default_rng(len(shape))
    A, node = dense_chain(SHAPES[shape], rng)
    A += 2.0 * np.sqrt(3 * max(SHAPES[shape])) * np.eye(len(A))
    b = rng.standard_normal(len(A))
    exact = np.linalg.solve(A, b)
    x = solution(factored(A, node, split=True), b)
    assert np.abs(x - exact).max() < 1e-13 * np.abs(exact).max()


@pytest.mark.parametrize("shape", ["sevens", "mixed"])
def test_ill_scaled(shape):
    """Rows and columns in units nine decades apart (metres beside radians, newtons beside newton metres).

    A = R C S with diagonal R and S and a well conditioned C: x = S^-1 C^-1 R^-1 b, each component to its own
    accuracy.
    """
    rng = np.random.default_rng(2)
    C, node = dense_chain(SHAPES[shape], rng)
    C += 2.0 * np.sqrt(3 * max(SHAPES[shape])) * np.eye(len(C))
    rows, columns = 10.0 ** rng.uniform(-4.5, 4.5, (2, len(C)))
    c = rng.standard_normal(len(C))
    scaled = np.linalg.solve(C, c)
    x = solution(factored(rows[:, None] * C * columns, node), rows * c)
    # cond(C) < 30, but the pivot order follows the rows' units: two digits are granted
    assert np.abs(x * columns - scaled).max() < 1e-11 * np.abs(scaled).max()


@each_row("size", [7, 8, 12])
def test_pivoting_inside_the_block(size):
    """Diagonal blocks with zeros on the diagonal: a cyclic shift of the rows of a dominant block."""
    rng = np.random.default_rng(size)
    A, node = dense_chain([size] * 20, rng)
    for i in range(20):
        span = slice(size * i, size * (i + 1))
        block = np.roll(A[span, span] + 20.0 * np.eye(size), 1, axis=0)
        np.fill_diagonal(block, 0.0)
        A[span, span] = block
    assert np.all(np.diag(A) == 0.0)
    b = rng.standard_normal(len(A))
    exact = np.linalg.solve(A, b)
    assert np.abs(solution(factored(A, node), b) - exact).max() < 1e-13 * np.abs(exact).max()


def test_lagrange_multipliers_follow_their_node():
    """A constraint row of zero diagonal beside the three displacements of every node: indefinite."""
    n = 15
    rng = np.random.default_rng(8)
    A, node = dense_chain([4] * n, rng)
    for i in range(n):
        multiplier = 4 * i + 3
        A[multiplier, :] = A[:, multiplier] = 0.0
        A[multiplier, 4 * i : 4 * i + 3] = A[4 * i : 4 * i + 3, multiplier] = [1.0, 0.5, -0.3]
    A += np.diag(np.tile([12.0, 12.0, 12.0, 0.0], n))
    b = rng.standard_normal(len(A))
    exact = np.linalg.solve(A, b)
    assert np.abs(solution(factored(A, node), b) - exact).max() < 1e-12 * np.abs(exact).max()


@each_row("shape", SHAPES)
def test_inertia(shape):
    rng = np.random.default_rng(5)
    A, node = dense_chain(SHAPES[shape], rng)
    A = A + A.T
    f = factored(A, node)
    rows, columns = np.nonzero(np.abs(node[:, None] - node) <= 1)
    assert f.negative_pivots(A[rows, columns]) == np.sum(np.linalg.eigvalsh(A) < 0)


def test_inertia_of_a_stretched_chain_of_springs():
    """K = tridiag(-1, 2, -1) - s I has the eigenvalues 2 - 2 cos(k pi / (n + 1)) - s (Golub & Van Loan
    4.8.6)."""
    n = 50
    eigenvalues = 2.0 - 2.0 * np.cos(np.arange(1, n + 1) * np.pi / (n + 1))
    for below in (0, 1, 17, 50):
        s = (
            0.0
            if below == 0
            else eigenvalues[-1] + 0.1
            if below == n
            else eigenvalues[below - 1 : below + 1].mean()
        )
        A = (2.0 - s) * np.eye(n) - np.eye(n, k=1) - np.eye(n, k=-1)
        node = np.arange(n) // 5
        rows, columns = np.nonzero(np.abs(node[:, None] - node) <= 1)
        assert factored(A, node).negative_pivots(A[rows, columns]) == below


@each_row("size", [3, 7, 8, 12])
@each_row("dead", [0, 4, 9])
def test_zero_pivot_names_the_node(size, dead):
    """An unknown without any stiffness, row and column zero."""
    A, node = dense_chain([size] * 10, np.random.default_rng(6))
    A += 12.0 * np.eye(len(A))
    k = size * dead + 1
    A[k, :] = A[:, k] = 0.0
    with pytest.raises(ZeroPivot, match=f"node {dead}") as caught:
        factored(A, node)
    assert (caught.value.node, caught.value.unknown) == (dead, 1)
    assert pickle.loads(pickle.dumps(caught.value)).node == dead


def test_singular_only_after_elimination():
    """Two equal springs in series without a support: the last pivot vanishes."""
    K = np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    with pytest.raises(ZeroPivot) as caught:
        factored(K, np.arange(3))
    assert caught.value.node == 2


def test_tiny_pivot_threshold_and_measure():
    """Supported by a spring of 1e-10: the last pivot is that, its column 1; refused only with a coarser
    limit."""
    K = np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0 + 1e-10]])
    f = factored(K, np.arange(3))
    assert f.smallest_pivot == pytest.approx(1e-10, rel=1e-5)
    assert f.smallest_pivot_node == 2
    assert f.growth == pytest.approx(1.0)
    with pytest.raises(ZeroPivot):
        factored(K, np.arange(3), pivot_tolerance=1e-8)


def test_not_a_number_is_an_error():
    A, node = dense_chain([7] * 4, np.random.default_rng(7))
    A[10, 10] = np.nan
    with pytest.raises(ZeroPivot, match="node 1"):
        factored(A, node)


def test_refusals():
    rows = np.zeros(1, dtype=np.int32)
    with pytest.raises(ValueError, match="not neighbours"):
        ChainFactor(None, ChainNumbering(np.arange(3), np.arange(3), np.arange(3)), rows, rows + 2)
    with pytest.raises(ValueError, match="unknowns, got 33"):
        ChainFactor(None, ChainNumbering(np.arange(1), np.zeros(33, dtype=int), np.arange(33)), rows, rows)
    with pytest.raises(ValueError, match="follow each other"):
        ChainFactor(None, ChainNumbering(np.array([0, 2]), np.arange(2), np.arange(2)), rows, rows)
    f = ChainFactor(None, ChainNumbering(np.arange(1), np.zeros(1, dtype=int), np.arange(1)), rows, rows)
    with pytest.raises(ValueError, match="2 values|\\(2,\\) values"):
        f.factor(np.ones(2))


@pytest.mark.parametrize("b", [7, 12])
def test_flop_count(b):
    """Per node 14/3 b^3 to factor and 6 b^2 to solve, leading terms (LU: Golub & Van Loan 3.2; two
    products)."""
    n = 400
    node = np.repeat(np.arange(n), b)
    none = np.zeros(0, dtype=np.int32)
    f = ChainFactor(None, ChainNumbering(np.arange(n), node, np.arange(n * b)), none, none)
    assert f.factor_flops == pytest.approx(14 / 3 * b**3 * n, rel=0.06)
    assert f.solve_flops == pytest.approx(6 * b**2 * n, rel=0.01)


class Provider:
    def __init__(self, values):
        self.values = values
        self.version = 1


@pytest.fixture
def petsc():
    return pytest.importorskip("petsc4py.PETSc")


def ksp_with(petsc, A, node):
    from drillpetsc.solvers.chain.chain_lu import ChainPC

    f = factored(A, node)
    rows, columns = np.nonzero(np.abs(node[:, None] - node) <= 1)
    provider = Provider(A[rows, columns])
    matrix = petsc.Mat().createDense(A.shape, array=A.copy(order="F"), comm=petsc.COMM_SELF)
    matrix.assemble()
    ksp = petsc.KSP().create(petsc.COMM_SELF)
    ksp.setType("preonly")
    ksp.setOperators(matrix)
    ksp.getPC().setType("python")
    ksp.getPC().setPythonContext(ChainPC(f, provider))
    return ksp, matrix, provider


def test_preconditioner_without_pivot(petsc):
    """KSP reports DIVERGED_PC_FAILED, the context has the reason, and good values mend it."""
    A, node = dense_chain([7] * 6, np.random.default_rng(9))
    A += 12.0 * np.eye(len(A))
    ksp, matrix, provider = ksp_with(petsc, A, node)
    b, x = matrix.createVecs()
    b.setArray(np.random.default_rng(1).standard_normal(len(A)))
    ksp.solve(b, x)
    assert np.abs(A @ x.getArray() - b.getArray()).max() < 1e-12
    good = provider.values
    provider.values, provider.version = 0.0 * good, 2
    matrix.stateIncrease()
    ksp.setOperators(matrix)
    ksp.solve(b, x)
    assert isinstance(ksp.getPC().getPythonContext().error, ZeroPivot)
    assert (
        ksp.getConvergedReason() == -11
    )  # KSP_DIVERGED_PC_FAILED, named DIVERGED_PCSETUP_FAILED in old petsc4py
    provider.values, provider.version = good, 3
    matrix.stateIncrease()
    ksp.setOperators(matrix)
    x.set(0.0)
    ksp.solve(b, x)
    assert ksp.getConvergedReason() > 0
    assert np.abs(A @ x.getArray() - b.getArray()).max() < 1e-12


@each_row("shape", SHAPES)
def test_elimination_from_a_node_on(shape):
    """With other entries from a node on, the elimination from there gives all factors, to the last bit."""
    sizes, rng = SHAPES[shape], np.random.default_rng(11)
    A, node = dense_chain(sizes, rng)
    A += 2.0 * np.sqrt(3 * max(sizes)) * np.eye(len(A))
    rows, columns = np.nonzero(np.abs(node[:, None] - node) <= 1)
    for start in sorted({0, 1, len(sizes) // 2, len(sizes) - 1} & set(range(len(sizes)))):
        part = factored(A, node)
        B = A.copy()
        tail = np.minimum(node[:, None], node) >= start
        B[tail] *= 1.25
        part.factor(B[rows, columns], start)
        whole = factored(B, node)
        assert part.piece.store.tobytes() == whole.piece.store.tobytes()
        b = rng.standard_normal(len(B))
        assert np.array_equal(solution(part, b), solution(whole, b))
        if start == 0:
            assert part.smallest_pivot == whole.smallest_pivot
