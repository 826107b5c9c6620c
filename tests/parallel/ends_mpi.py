"""The exchange at shared nodes against PETSc's scatters of whole vectors, and the residual of a step by its parts, to the bit."""

import petsc4py

petsc4py.init([])

import numpy as np  # noqa: E402
from petsc4py import PETSc  # noqa: E402

from drillpetsc.kernels import pointer  # noqa: E402
from tests.helpers.component_models import KINDS, SHIFT, build  # noqa: E402


def fill(vector: PETSc.Vec, seed: int) -> None:
    """Numbers of the whole vector, the same on any number of ranks."""
    first, last = vector.getOwnershipRange()
    vector.getArray()[:] = 0.1 * np.random.default_rng(seed).standard_normal(vector.getSize())[first:last]


def check(kind: str) -> bool:
    """True where the residual is one call."""
    system = build(kind)
    layout, asm, n = system.layout, system.assembly, system.layout.size
    q, state, rate = system.new_condensed(), system.new_state(), system.new_state()
    fill(q, 1), fill(state, 2), fill(rate, 3)
    local_q, local_state, local_rate = (
        dm.createLocalVec() for dm in (layout.condensed_dm, layout.state_dm, layout.state_dm)
    )
    layout.condensed_dm.globalToLocal(q, local_q)
    layout.state_dm.globalToLocal(state, local_state)
    layout.state_dm.globalToLocal(rate, local_rate)
    system.load_unknowns(q)
    assert np.array_equal(asm.x[:n], local_q.getArray())
    s, v = local_state.getArray(), local_rate.getArray()
    rates = layout.y_local >= 0
    system.load_state(state, rate)
    assert np.array_equal(asm.x[:n], s[layout.x_local])
    assert np.array_equal(asm.y[:n][rates], s[layout.y_local[rates]])
    assert np.array_equal(asm.y[:n][~rates], v[layout.x_local[~rates]])
    assert np.array_equal(asm.a[:n][rates], v[layout.y_local[rates]])
    shift = 3.0
    system.load_step(state, rate, shift)
    assert np.array_equal(asm.x[:n], s[layout.x_local])
    assert np.array_equal(asm.y[:n][rates], s[layout.y_local[rates]])
    assert np.allclose(asm.v0, (v - shift * s)[layout.x_local], rtol=0, atol=1e-14)
    assert np.allclose(asm.v1[rates], (v - shift * s)[layout.y_local[rates]], rtol=0, atol=1e-14)
    # the sum of both ranks' rows
    asm.x[:n] = local_q.getArray()
    r, summed = PETSc.Vec().createSeq(n, comm=PETSc.COMM_SELF), system.new_condensed()
    asm.residual(0.4)
    r.getArray()[:] = asm.r[:n]
    layout.condensed_dm.localToGlobal(r, summed, addv=PETSc.InsertMode.ADD_VALUES)
    if system.ends is not None:
        rows = asm.r[layout.local_of_owned].copy()
        system.ends.add(asm.r, rows)
        assert np.array_equal(rows, summed.getArray())
    # one call, with the messages between its parts
    second, expected, rows = 1.3 * SHIFT, system.new_condensed(), system.new_condensed()
    for _ in range(2):
        system.load_unknowns(q)
        asm.condense(SHIFT, second)
        asm.apply_prescribed_rates(0.4, second)
        system.sum_residual(0.4, expected)
    kept = [a.copy() for a in (asm.x, asm.y, asm.a)]
    for a in (asm.x, asm.y, asm.a):
        a[:n] = np.nan
    at = pointer(q.getArray()), pointer(rows.getArray())
    done = asm.step_rows(0.4, SHIFT, second, at, system.ends, rows.getArray())
    assert done == (not asm.stabilized)
    if done:
        assert np.array_equal(rows.getArray(), expected.getArray())
        assert all(np.array_equal(a, b) for a, b in zip((asm.x, asm.y, asm.a), kept, strict=True))
    return done


together = [check(kind) for kind in KINDS]
assert any(together)
if PETSc.COMM_WORLD.rank == 0:
    print("exchange agrees on", PETSc.COMM_WORLD.size, "ranks,", len(together), "systems")
