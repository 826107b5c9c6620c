"""Eigenvalues of a problem T(s) u = 0 whose matrix is not a polynomial of s, by Newton's method from a start.

Manual: sec-eigen-nonlinear.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sparse
import scipy.sparse.linalg as sparse_linalg

MAX_STEPS = 30
CONVERGED = 1e-10  # last relative change of an eigenvalue
DIFFERENCE = 1e-6  # relative step of s for the derivative of T
FARTHEST = 0.5  # relative change of an eigenvalue in one step, at most


@dataclass(frozen=True)
class Refined:
    """An eigenvalue s [1/s] with its vector u (n,), Newton's steps, and whether they converged."""

    s: complex
    u: np.ndarray
    steps: int
    converged: bool


def refine(matrix: Callable[[complex], sparse.csr_matrix], s: complex, u: np.ndarray) -> Refined:
    """Find the eigenvalue near ``s`` by Newton's method on T(s) u = 0, w* u = 1 (manual: eq-eigen-newton).

    Each step solves T x = T' u; then s' = s - 1/(w* x) and u' = x/(w* x).  Source: Ruhe, SIAM J. Numer. Anal. 10 (1973),
    674-689.

    matrix: T as a function of s; u: (n,) start.
    """
    w = u.conj() / np.vdot(u, u)
    for step in range(1, MAX_STEPS + 1):
        T = matrix(s)
        h = DIFFERENCE * s
        by_s = (matrix(s + h) - T) / h
        size = np.asarray(abs(T).max(axis=1).toarray(), dtype=float).ravel()
        size[size == 0] = 1.0
        try:
            factor = sparse_linalg.splu(sparse.csc_matrix(sparse.diags(1.0 / size) @ T))
        except RuntimeError:  # singular to rounding: an eigenvalue
            return Refined(s, u, step, True)
        x = factor.solve(np.asarray((by_s @ u) / size, dtype=complex))
        scale = w @ x
        if not np.isfinite(scale) or scale == 0:
            return Refined(s, u, step, False)
        change = -1.0 / scale
        if abs(change) > FARTHEST * abs(s):
            change *= FARTHEST * abs(s) / abs(change)
        u = x / scale
        s = s + change
        if abs(change) < CONVERGED * abs(s):
            return Refined(s, u, step, True)
    return Refined(s, u, MAX_STEPS, False)
