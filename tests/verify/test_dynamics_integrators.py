"""The assembled first-order system beside the condensed one: exact Jacobian, other solvers and integrators, what each refuses."""

from __future__ import annotations

import numpy as np
import pytest
from petsc4py import PETSc

from drillpetsc.solve.plain import PlainSystem
from tests.rooms.scenes import KINDS, SHIFT, build


@pytest.mark.parametrize("kind", KINDS)
def test_plain_jacobian_matches_central_differences(kind):
    """dF/dx + shift dF/dxdot of the whole system against fourth-order differences of its own residual."""
    model, t = build(kind), 0.4
    plain, state, rate = PlainSystem(model), model.new_state(), model.new_state()
    rng, n = np.random.default_rng(5), model.new_state().getLocalSize()
    model.assembly.condense(SHIFT)
    model.store_state(state)
    rate.getArray()[:] = rng.standard_normal(n)
    x0, v0 = state.getArray().copy(), rate.getArray().copy()
    plain.jacobian(None, t, state, rate, SHIFT, plain.matrix, plain.matrix)
    J = plain.matrix.convert("dense").getDenseArray().copy()
    f = model.new_state()

    def rows(step):
        state.getArray()[:], rate.getArray()[:] = x0 + step, v0 + SHIFT * step
        plain.function(None, t, state, rate, f)
        return f.getArray().copy()

    h, F = 1e-4, np.zeros((n, n))
    for j in range(n):
        e = np.zeros(n)
        e[j] = h
        F[:, j] = (rows(-2 * e) - 8 * rows(-e) + 8 * rows(e) - rows(2 * e)) / (12 * h)
    assert np.abs(J - F).max() < 3e-7 * np.abs(J).max()
