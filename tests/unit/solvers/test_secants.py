"""Newton's iteration with a kept matrix and the secants of its steps (manual: sec-time-secants)."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest

from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import constant, structure
from drillpetsc.solvers.time.newton_iteration import Reason

N = 40
SOLVE = function("newton_solve", "p", ctypes.c_int)
PART, REDUCTION = (
    ctypes.CFUNCTYPE(ctypes.c_int),
    ctypes.CFUNCTYPE(ctypes.c_int, ctypes.POINTER(ctypes.c_double), ctypes.c_int),
)


def solved(matrix, kept, scale, secants=True, most=30, steps=None):
    """Reason, iterations and unknowns of ``matrix`` q = 1 from zero, with increments of the matrix ``kept``."""
    q, rows, increment = np.zeros(N), -np.ones(N), np.zeros(N)
    memory, squares = np.zeros((int(constant("secant_vectors")), N)), scale**-2.0

    def residual():
        rows[:] = matrix @ q - 1.0
        if steps is not None:
            steps.append(q.copy())
        return 0

    def solution():
        increment[:] = np.linalg.solve(kept, rows)
        return 0

    held = PART(residual), PART(solution)
    parts = structure("parts_call")(
        rows=ctypes.cast(held[0], ctypes.c_void_p).value, solve=ctypes.cast(held[1], ctypes.c_void_p).value
    )
    reasons = structure("reason_call")(
        converged=Reason.CONVERGED_SNORM_RELATIVE, too_many=Reason.DIVERGED_MAX_IT
    )
    step, pairs = (
        structure("step_call")(sigma=1.0),
        structure("secant_call")(memory=pointer(memory), weights=pointer(squares), n=N),
    )
    call = structure("newton_call")(
        step=ctypes.addressof(step), reasons=ctypes.addressof(reasons), parts=ctypes.addressof(parts),
        secants=ctypes.addressof(pairs) if secants else None,
        q=pointer(q), rows=pointer(rows), increment=pointer(increment), scale=pointer(scale),
        lag_shift=1.0, shift_change=0.2, contraction=100.0, tolerance=1e-9, rounding=1e-14, eta=1.0,
        n=N, max_iterations=most, lag_iterations=most, good=1, factored=1, rows_known=1,
    )  # fmt: skip
    return SOLVE(ctypes.addressof(call)), call.iterations, q


def test_a_matrix_that_differs_along_two_directions():
    """A kept matrix that differs from the present one by rank two: two steps span the difference, so the fourth increment ends in
    the solution (Walker and Ni, SIAM J. Numer. Anal. 49, 2011: the method is GMRES for linear systems) and the next finds nothing left.
    Without secants the difference is so large that the iteration does not converge.
    """
    random = np.random.default_rng(3)
    matrix = np.eye(N) + 0.1 * random.standard_normal((N, N)) / np.sqrt(N)
    kept = matrix + random.standard_normal((N, 2)) @ random.standard_normal((2, N)) / np.sqrt(N)
    scale = 10.0 ** random.uniform(-2, 2, N)
    reason, iterations, q = solved(matrix, kept, scale)
    assert reason == Reason.CONVERGED_SNORM_RELATIVE
    assert iterations <= 6
    assert q == pytest.approx(np.linalg.solve(matrix, np.ones(N)), abs=1e-9)
    assert solved(matrix, kept, scale, secants=False)[0] != Reason.CONVERGED_SNORM_RELATIVE


def test_a_shift_that_has_moved():
    """Mass and stiffness at a shift 15 % from that of the factors: fewer iterations, and the error is what the test says."""
    k = np.diag(np.full(N, 2.0)) - np.diag(np.ones(N - 1), 1) - np.diag(np.ones(N - 1), -1)
    matrix, kept = np.eye(N) + k, 1.15**2 * np.eye(N) + k
    exact, scale = np.linalg.solve(matrix, np.ones(N)), np.ones(N)
    plain, fast = solved(matrix, kept, scale, secants=False), solved(matrix, kept, scale)
    assert fast[1] < plain[1]
    for found in (plain, fast):
        assert np.abs(found[2] - exact).max() < 1e-9


def test_rows_that_a_step_meets_stay_met():
    """A row that matrices share, as a constraint's is, is met after the first step and by all later ones."""
    random = np.random.default_rng(5)
    matrix = np.eye(N) + 0.2 * random.standard_normal((N, N)) / np.sqrt(N)
    kept = matrix + random.standard_normal((N, 3)) @ random.standard_normal((3, N)) / N
    kept[7] = matrix[7]
    states: list = []
    solved(matrix, kept, np.ones(N), steps=states)
    assert len(states) > 3
    assert [matrix[7] @ q for q in states] == pytest.approx(np.ones(len(states)), abs=1e-12)
