"""Checks of the solver, of parts and of runs on 1 to 4 ranks, one job on each number, against each other and against dense solves."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from tests.helpers.mpi import have_mpi, run_mpi
from tests.helpers.tables import each_row
from tests.parallel.run_checks import CHECKS, ON_FOUR
from tests.parallel.run_checks import report as report_here

pytestmark = [pytest.mark.parallel, pytest.mark.skipif(not have_mpi(), reason="no mpirun")]
RANKS = (1, 2, 3)
CASES = (
    "lower", "upper", "split", "ranks_upside_down", "uneven", "rank_without_element", "one_element_a_rank",
)  # fmt: skip


@lru_cache
def report(ranks: int) -> dict:
    """What the checks return, on one rank in this process."""
    with TemporaryDirectory() as folder:
        if ranks == 1:
            return report_here(Path(folder))
        names = [check.__name__ for check in (CHECKS if ranks < 4 else ON_FOUR)]
        run_mpi(ranks, Path(__file__).with_name("run_checks.py"), [folder, *names], timeout=300)
        return json.loads((Path(folder) / "report.json").read_text())


def chain(ranks: int) -> dict:
    return report(ranks)["chain_solver"]


@pytest.mark.parametrize("ranks", [1, 2, 3, 4])
def test_checks_hold(ranks):
    """Those of `run_checks.py` that compare within a job; on four ranks each has one element."""
    assert set(report(ranks)) == {check.__name__ for check in (CHECKS if ranks < 4 else ON_FOUR)}


@each_row("ranks", (2, 3, 4))
def test_ranks_without_an_element(ranks):
    """Two elements: hook load [N] and torque [N m] are those of one rank, to rounding."""
    one, other = report(1)["two_elements"], report(ranks)["two_elements"]
    for name, values in one.items():
        assert np.allclose(other[name], values, rtol=1e-9, atol=1e-9)


@each_row("ranks", RANKS[1:])
def test_other_integrators_are_the_same(ranks):
    """Equal steps, systems solved to rounding: position [m] and spin [rad] of the lower end equal to 1e-10."""
    one, other = report(1)["other_integrators"], report(ranks)["other_integrators"]
    assert other.keys() == one.keys() and len(one) >= 3
    for kind, end in one.items():
        assert len(end) == 4 and other[kind] == pytest.approx(end, rel=0, abs=1e-10), kind


@each_row("ranks", RANKS[1:])
@each_row(
    ("name", "size", "share"),
    [
        ("index3", 13, 1e-8),
        ("stabilized", 13, 1e-8),
        ("items", 20, 1e-7),
        ("hermite", 20, 1e-7),
    ],
)
def test_a_quaternion_string_is_the_same(name, size, share, ranks):
    """Static start and 20 steps in contact, both forms of the constraints; rigid items above other pipe with a joint, with mud of the
    Hermite form.

    Motion, multipliers, reactions and energies equal to 1e-8 of their sizes (systems solved to rounding; friction with a slip velocity
    of 0.01 m/s amplifies it), the others to 1e-7.
    """
    one, other = (np.array(report(n)["quaternion_string"][name]) for n in (1, ranks))
    assert one.shape == (size,)
    assert np.all(np.abs(other - one) <= share * np.maximum(np.abs(one), 1e-3))


@each_row("ranks", RANKS)
@each_row("case", CASES)
def test_solution_is_the_dense_one(ranks, case):
    assert chain(ranks)[case] < 1e-12


def test_empty_rank_between_others():
    assert chain(3)["empty_between"] < 1e-12


@each_row("ranks", RANKS[1:])
def test_number_of_ranks_does_not_matter(ranks):
    serial, parallel = np.array(chain(1)["x"]), np.array(chain(ranks)["x"])
    assert np.abs(parallel - serial).max() < 1e-12 * np.abs(serial).max()


@each_row("ranks", RANKS)
def test_inertia(ranks):
    """Expected: signs of the eigenvalues of the dense matrix; the third matrix has unknowns scaled by 1e-3 to
    1e3."""
    for counted, expected in chain(ranks)["inertia"]:
        assert counted == expected


@each_row("ranks", RANKS)
def test_missing_stiffness_is_named_on_every_rank(ranks):
    """Nodes inside the pieces and on the joints (6 on two ranks, 4 and 8 on three)."""
    for dead, node in chain(ranks)["dead"]:
        assert node == [dead] * ranks


@each_row("ranks", RANKS[1:])
def test_inconsistent_pieces_are_refused_on_every_rank(ranks):
    for texts in chain(ranks)["refused"]:
        assert "needs exactly one owner" in texts[0]
        assert "not neighbours" in texts[1]
        assert "must follow each other" in texts[2]


def test_two_ranks_share_the_work():
    """Elimination from both ends towards the joint has no extra cost: half the work each, plus the joint."""
    for work in ("factor_flops", "solve_flops"):
        serial, halves = chain(1)[work][0], chain(2)[work]
        assert max(halves) <= 0.55 * serial


def test_price_of_a_piece_between_two_joints():
    """Leading terms 38/3 against 14/3 b^3 (derivation in drillpetsc.solvers.chain.chain_lu): 2.71 for large blocks,
    less for b = 7."""
    first, inner, last = chain(3)["factor_flops"]
    assert first == last
    assert 2.4 < inner / first < 38 / 14


@each_row("ranks", RANKS)
def test_as_petsc_preconditioner(ranks):
    """KSP preonly: the residual with PETSc's own matrix vanishes, and the factor is computed again only for
    new values."""
    checks = chain(ranks)
    assert checks["pc_residual"] < 1e-12
    assert checks["pc_factorisations_same"] == 1
    assert checks["pc_factorisations_new"] == 2
    assert checks["pc_half"] < 1e-14  # twice the matrix, half the solution
    assert checks["pc_event_counts"] == [2, 3]
