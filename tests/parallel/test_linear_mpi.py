"""The chain solver on 1, 2 and 3 ranks against dense solves and against itself (checks are in
linear_mpi.py)."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path

import numpy as np
import pytest

from tests.helpers.mpi import have_mpi, run_mpi
from tests.helpers.tables import each_row

pytestmark = [pytest.mark.parallel, pytest.mark.skipif(not have_mpi(), reason="no mpirun")]
RANKS = (1, 2, 3)
CASES = (
    "lower", "upper", "split", "refined", "ranks_upside_down", "uneven", "rank_without_element", "one_element_a_rank",
)  # fmt: skip


@lru_cache
def report(ranks: int) -> dict:
    return json.loads(run_mpi(ranks, Path(__file__).with_name("linear_mpi.py")).splitlines()[-1])


@each_row("ranks", RANKS)
@each_row("case", CASES)
def test_solution_is_the_dense_one(ranks, case):
    assert report(ranks)[case] < 1e-12


def test_empty_rank_between_others():
    assert report(3)["empty_between"] < 1e-12


@each_row("ranks", RANKS[1:])
@each_row("x", ["x", "x_refined"])
def test_number_of_ranks_does_not_matter(ranks, x):
    serial, parallel = np.array(report(1)[x]), np.array(report(ranks)[x])
    assert np.abs(parallel - serial).max() < 1e-12 * np.abs(serial).max()


@each_row("ranks", RANKS)
def test_inertia(ranks):
    """Expected: signs of the eigenvalues of the dense matrix; the third matrix has unknowns scaled by 1e-3 to
    1e3."""
    for counted, expected in report(ranks)["inertia"]:
        assert counted == expected


@each_row("ranks", RANKS)
def test_missing_stiffness_is_named_on_every_rank(ranks):
    """Nodes inside the pieces and on the joints (6 on two ranks, 4 and 8 on three)."""
    for dead, node in report(ranks)["dead"]:
        assert node == [dead] * ranks


@each_row("ranks", RANKS[1:])
def test_inconsistent_pieces_are_refused_on_every_rank(ranks):
    for texts in report(ranks)["refused"]:
        assert "needs exactly one owner" in texts[0]
        assert "not neighbours" in texts[1]
        assert "must follow each other" in texts[2]


def test_two_ranks_share_the_work():
    """Elimination from both ends towards the joint has no extra cost: half the work each, plus the joint."""
    for work in ("factor_flops", "solve_flops"):
        serial, halves = report(1)[work][0], report(2)[work]
        assert max(halves) <= 0.55 * serial


def test_price_of_a_piece_between_two_joints():
    """Leading terms 38/3 against 14/3 b^3 (derivation in drillpetsc.solvers.chain.chain_lu): 2.71 for large blocks,
    less for b = 7."""
    first, inner, last = report(3)["factor_flops"]
    assert first == last
    assert 2.4 < inner / first < 38 / 14


@each_row("ranks", RANKS)
def test_as_petsc_preconditioner(ranks):
    """KSP preonly: the residual with PETSc's own matrix vanishes, and the factor is computed again only for
    new values."""
    checks = report(ranks)
    assert checks["pc_residual"] < 1e-12
    assert checks["pc_factorisations_same"] == 1
    assert checks["pc_factorisations_new"] == 2
    assert checks["pc_half"] < 1e-14  # twice the matrix, half the solution
    assert checks["pc_event_counts"] == [2, 3]
