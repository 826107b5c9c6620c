"""Places of the matrix entries, fixed unknowns among them, results of all blocks in one call."""

from __future__ import annotations

import numpy as np

from drillpetsc.solvers.chain import block_tridiagonal
from drillpetsc.solvers.time.newton import chain_factor, shared_factor
from tests.helpers.component_models import KINDS, SHIFT, build, dense
from tests.helpers.tables import each_row

WEIGHTS = (1.0, SHIFT, SHIFT**2)


@each_row("kind", KINDS)
def test_rows_and_columns_of_fixed_unknowns_are_those_of_the_unit_matrix(kind):
    """In the sum of all entries the diagonal is the number of entries there: at least one, and whole."""
    system = build(kind)
    asm, n = system.assembly, system.layout.size
    asm.jacobian(0.2, WEIGHTS, condensed=True)
    free = dense(system)
    mask = np.random.default_rng(3).random(n) < 0.3
    asm.freeze(mask)
    asm.jacobian(0.2, WEIGHTS, condensed=True)
    fixed = dense(system)
    assert np.array_equal(fixed[np.ix_(~mask, ~mask)], free[np.ix_(~mask, ~mask)])
    diagonal = fixed.diagonal()[mask]
    assert np.all(diagonal >= 1.0)
    assert np.array_equal(diagonal, np.round(diagonal))
    fixed[mask, mask] = 0.0
    assert not fixed[mask].any()
    assert not fixed[:, mask].any()
    asm.freeze(None)
    asm.jacobian(0.2, WEIGHTS, condensed=True)
    assert np.array_equal(dense(system), free)


@each_row("kind", KINDS)
def test_patterns_of_entries_do_not_depend_on_the_room_for_them(kind, monkeypatch):
    """Too little room is enlarged, and the factors stay the same to the bit."""
    system = build(kind)
    asm = system.assembly
    asm.jacobian(0.2, WEIGHTS, condensed=True)
    stores = []
    for capacity in (block_tridiagonal.PATTERN_CAPACITY, 1):
        monkeypatch.setattr(block_tridiagonal, "PATTERN_CAPACITY", capacity)
        factor = chain_factor(system)
        factor.factor(asm.values)
        stores.append(factor.piece.store.tobytes())
    assert stores[0] == stores[1]


def test_a_uniform_chain_has_few_patterns():
    """The lists of a chain of equal elements do not grow by more than a few numbers a node."""
    system = build("plain") if "plain" in KINDS else build(KINDS[0])
    factor = chain_factor(system)
    numbers = sum(len(table) for table in factor.piece._runs)
    assert len(factor.piece._runs[2]) < 20 * factor.piece.n  # runs
    assert numbers < len(system.assembly.values)


def test_solves_that_share_the_solver_know_whose_factors_it_has():
    system = build(KINDS[0])
    one = shared_factor(system)
    assert shared_factor(system) is one
    assert one.factorisations == 0
    system.assembly.jacobian(0.2, WEIGHTS, condensed=True)
    one.factor(system.assembly.values)
    assert one.factorisations == 1


@each_row("kind", KINDS)
def test_results_of_all_blocks_at_once_are_those_one_by_one(kind):
    """What one state was asked for is computed in one call at the next; another order or less does not change a bit."""
    system = build(kind)
    asm = system.assembly

    def figures() -> bytes:
        return np.array([*system.local_powers(0.2), *system.energies(0.2)]).tobytes()

    apart = figures()
    for _ in range(2):
        with asm.unchanged():
            assert figures() == apart
    asm.x[: system.layout.size] *= 1.0 + 1e-3
    moved = figures()
    with asm.unchanged():
        energies = system.energies(0.2)
    with asm.unchanged():
        assert system.energies(0.2) == energies
        assert figures() == moved
