"""Checks of the chain solver on all ranks; `run_checks.py` calls them, `test_checks_mpi.py` reads their numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from drillpetsc.solvers.chain.chain_lu import ChainFactor, ChainNumbering, ChainPC, ZeroPivot

COMM = PETSc.COMM_WORLD.tompi4py()
RANK, SIZE = COMM.rank, COMM.size
MIXED = [7, 7, 8, 7, 3, 12, 7, 7, 8, 1, 7, 7, 16, 7, 5, 7, 7, 8, 8, 7, 7]


@dataclass
class Local:
    """A rank's part of a chain whose element matrices all ranks have."""

    nodes: np.ndarray
    node_of_dof: np.ndarray
    number: np.ndarray  # global number (in chain order) of each local unknown
    local_of_owned: np.ndarray
    rows: np.ndarray
    columns: np.ndarray
    values: np.ndarray

    def factor(self) -> ChainFactor:
        return ChainFactor(
            COMM,
            ChainNumbering(self.nodes, self.node_of_dof, self.local_of_owned),
            self.rows,
            self.columns,
        )


def chain(sizes, seed, symmetric=False, scale=None):
    """Element matrices of a random chain (nodes of the given sizes), its first unknowns, and the dense
    matrix."""
    rng = np.random.default_rng(seed)
    first = np.concatenate([[0], np.cumsum(sizes)])
    elements, dense = [], np.zeros((first[-1], first[-1]))
    for e in range(len(sizes) - 1):
        dofs = np.arange(first[e], first[e + 2])
        K = rng.standard_normal((len(dofs), len(dofs)))
        K = K + K.T if symmetric else K + 3.0 * np.eye(len(dofs))
        if scale is not None:
            K = K * scale[dofs][:, None] * scale[dofs]
        elements.append(K)
        dense[np.ix_(dofs, dofs)] += K
    return elements, first, dense


def share(elements, first, cuts, owner="lower", order=None) -> Local:
    """Elements cuts[q] to cuts[q+1] belong to rank order[q]; joints belong to the lower or upper part, or to
    both ("split").

    Local numbers increase upwards, so that neither node order nor rank order is assumed.
    """
    order = list(range(SIZE)) if order is None else order
    q, sizes = order.index(RANK), np.diff(first)
    a, b = cuts[q], cuts[q + 1]
    nodes = np.arange(a, b + 1) if b > a else np.zeros(0, dtype=int)
    first_run, last_run = all(c == 0 for c in cuts[: q + 1]), all(c == cuts[-1] for c in cuts[q + 1 :])
    number, node_of_dof, owned, start = [], [], [], {}
    for i in range(len(nodes) - 1, -1, -1):
        start[i] = len(number)
        for k, dof in enumerate(range(first[nodes[i]], first[nodes[i] + 1])):
            number.append(dof)
            node_of_dof.append(i)
            lower = {"lower": True, "upper": False, "split": k % 2 == 0}[
                owner
            ]  # the joint belongs to the run below it
            here = True
            if i == 0 and not first_run:
                here = lower
            elif i == len(nodes) - 1 and not last_run:
                here = not lower
            owned.append(here)
    rows, columns, values = [], [], []
    for e in range(a, b):
        local = np.concatenate([start[j] + np.arange(sizes[nodes[j]]) for j in (e - a, e - a + 1)])
        rows.append(np.append(np.repeat(local, len(local)), -1))
        columns.append(np.append(np.tile(local, len(local)), 0))
        values.append(np.append(elements[e].ravel(), 1e300))  # the last entry is to be ignored
    flat = [np.concatenate([np.zeros(0)] + part) for part in (rows, columns, values)]
    ints = [np.array(x, dtype=np.int32) for x in (number, node_of_dof)]
    return Local(
        nodes,
        ints[1],
        ints[0],
        np.flatnonzero(owned),
        flat[0].astype(np.int32),
        flat[1].astype(np.int32),
        flat[2],
    )


def even(count):
    return [round(count * q / SIZE) for q in range(SIZE + 1)]


def solved(part: Local, dense) -> tuple[float, np.ndarray]:
    """Largest error, relative to the dense solution, over all local unknowns of all ranks; and the whole
    solution."""
    rng = np.random.default_rng(99)
    b = rng.standard_normal(len(dense))
    exact = np.linalg.solve(dense, b)
    f = part.factor()
    worst = 0.0
    for _ in range(2):  # the second time over a used factor
        f.factor(part.values)
        local = np.full(len(part.number), np.nan)  # ghosts of b must not be read
        local[part.local_of_owned] = b[part.number[part.local_of_owned]]
        x = np.zeros(len(local))
        f.solve(local, x)
        worst = max(worst, float(np.max(np.abs(x - exact[part.number]), initial=0.0)) / np.abs(exact).max())
    pieces = COMM.allgather((part.number, x))
    whole = np.zeros(len(dense))
    for number, values in pieces:
        whole[number] = values
    return max(COMM.allgather(worst)), whole


def check_solutions(report) -> None:
    elements, first, dense = chain(MIXED, 1)
    count = len(elements)
    for owner in ("lower", "upper", "split"):
        report[owner], x = solved(share(elements, first, even(count), owner), dense)
    report["x"] = x.tolist()
    report["ranks_upside_down"], _ = solved(
        share(elements, first, even(count), order=list(range(SIZE))[::-1]), dense
    )
    uneven = [0, *range(1, SIZE), count]
    report["uneven"], _ = solved(share(elements, first, uneven), dense)
    report["rank_without_element"], _ = solved(share(elements, first, [0] * SIZE + [count]), dense)
    middle = even(count)
    if SIZE == 3:
        middle[2] = middle[1]
        report["empty_between"], _ = solved(share(elements, first, middle, order=[2, 0, 1]), dense)
    few, first, dense = chain([7, 2, 8, 5][: SIZE + 1], 2)
    report["one_element_a_rank"], _ = solved(share(few, first, list(range(SIZE + 1))), dense)


def check_inertia(report) -> None:
    scale = 10.0 ** np.random.default_rng(5).uniform(-3, 3, sum(MIXED))
    pairs = []
    for seed, s in ((3, None), (4, None), (6, scale)):
        elements, first, dense = chain(MIXED, seed, True, s)
        part = share(elements, first, even(len(elements)))
        # counted on the matrix without the scaling, a congruence
        plain = dense if s is None else dense / s[:, None] / s
        pairs.append([part.factor().negative_pivots(part.values), int(np.sum(np.linalg.eigvalsh(plain) < 0))])
    report["inertia"] = pairs


def check_failure(report) -> None:
    """A node without stiffness: every rank raises an error that names it."""
    sizes = [7] * 13
    named = []
    for dead in (0, 3, 4, 6, 8, 12):
        elements, first, _ = chain(sizes, 7)
        for e, K in enumerate(elements):
            for node in (e, e + 1):
                if node == dead:
                    K[7 * (node - e) + 2, :] = 0.0
        part = share(elements, first, even(12))
        f = part.factor()
        try:
            f.factor(part.values)
            reported = None
        except ZeroPivot as error:
            reported = error.node
        named.append([dead, COMM.allgather(reported)])
    report["dead"] = named


def check_refusals(report) -> None:
    """Inconsistent pieces are refused on every rank."""
    elements, first, _ = chain([7] * 7, 8)
    texts = []
    for spoil in ("owner", "far", "gap"):
        part = share(elements, first, even(6))
        if RANK == 0 and spoil == "owner":
            part.local_of_owned = np.arange(len(part.number))
        if RANK == 0 and spoil == "far":
            part.rows[0], part.columns[0] = 0, len(part.number) - 1
        if RANK == 0 and spoil == "gap":
            part.nodes = part.nodes * 2
        try:
            part.factor()
            texts.append("")
        except ValueError as error:
            texts.append(str(error))
    report["refused"] = COMM.allgather(texts)


def check_work(report) -> None:
    sizes = [7] * 226
    elements, first, _ = chain(sizes, 9)
    part = share(elements, first, even(225))
    f = part.factor()
    report["factor_flops"], report["solve_flops"] = (
        COMM.allgather(f.factor_flops),
        COMM.allgather(f.solve_flops),
    )


def check_pc(report) -> None:
    """KSP preonly with a ChainPC against PETSc's own product with the same matrix."""
    elements, first, dense = chain(MIXED, 10)
    part = share(elements, first, even(len(elements)), "split")
    owned = len(part.local_of_owned)
    begin = COMM.scan(owned) - owned
    to_global = np.full(len(dense), -1, dtype=np.int32)
    for offset, number in COMM.allgather((begin, part.number[part.local_of_owned])):
        to_global[number] = offset + np.arange(len(number))
    A = PETSc.Mat().createAIJ(((owned, None), (owned, None)), nnz=(60, 60), comm=COMM)
    A.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
    for r, c, v in zip(part.rows, part.columns, part.values, strict=True):
        if r >= 0 and c >= 0:
            A.setValue(to_global[part.number[r]], to_global[part.number[c]], v, addv=True)
    A.assemble()

    class Values:
        values, version = part.values, 1

    context = ChainPC(part.factor(), Values())
    ksp = PETSc.KSP().create(COMM)
    ksp.setType("preonly")
    ksp.setOperators(A)
    ksp.getPC().setType("python")
    ksp.getPC().setPythonContext(context)
    b, x = A.createVecs()
    b.setRandom()
    PETSc.Log.begin()
    ksp.solve(b, x)
    r = b.duplicate()
    A.mult(x, r)
    r.axpy(-1.0, b)
    report["pc_residual"] = r.norm() / b.norm()
    A.assemble()
    ksp.setOperators(A)
    ksp.solve(b, x)
    report["pc_factorisations_same"] = context.factorisations
    A.scale(2.0)
    Values.values, Values.version = 2.0 * part.values, 2
    ksp.setOperators(A)
    y = x.duplicate()
    ksp.solve(b, y)
    y.axpy(-0.5, x)
    report["pc_half"] = y.norm() / x.norm()
    report["pc_factorisations_new"] = context.factorisations
    report["pc_event_counts"] = [
        PETSc.Log.Event(n).getPerfInfo()["count"] for n in ("ChainFactor", "ChainSolve")
    ]


def chain_solver(folder, patch) -> dict:
    report: dict = {}
    for check in (check_solutions, check_inertia, check_failure, check_refusals, check_work, check_pc):
        check(report)
    return report
