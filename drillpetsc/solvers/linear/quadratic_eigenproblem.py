"""Eigenvalues s of (K + s C + s^2 M) u = 0 near a point of the complex plane, or the slowest ones.

Numpy and scipy on one process.

M and C may be singular: a first-order unknown has no column in M, an algebraic one has none in C either.
With v = s u of the second-order unknowns the problem is A z = s B z, z = (u, v) (manual: eq-eigen-linear),

    [ 0   I  ] [u]     [ S   0  ] [u]
    [ -K -C2 ] [v] = s [ C1  M2 ] [v]

where S selects the second-order unknowns, C2 and M2 have their columns, and C1 has the columns of the others.
B is singular: infinite eigenvalues become zeros of Op = (A - sigma B)^-1 B, whose eigenvalues are 1/(s -
sigma). Op needs only one factorisation, of K + sigma C + sigma^2 M (manual: eq-eigen-operator):

    u = -(K + sigma C + sigma^2 M)^-1 [C1 u0 + M2 v0 + (C2 + sigma M2) S u0],   v = S u0 + sigma S u.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.linalg
import scipy.sparse as sparse
import scipy.sparse.linalg as sparse_linalg

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError

DENSE_BELOW = 400  # length of z up to which a dense matrix gives all eigenvalues at once
FIRST_SHIFT = (
    0.87  # first shift of the search, in units of the reference rate; real, unlikely to be an eigenvalue
)
RADIUS_TOLERANCE = 1e-4  # distances from a shift count as equal within this fraction
REAL_TOLERANCE = 1e-6  # |Im s| below this fraction of |s| is rounding
LARGEST_BACKWARD_ERROR = 1e-6  # eigenvalues with a larger backward error are discarded
NEUTRAL_GROWTH = 1e-6  # growth below this fraction of |s| is rounding (measured up to 1.2e-7 on 12 km)
OSCILLATING_PER_SLOW_REAL = 4  # one slow real eigenvalue is shown for so many oscillating ones
DEFLATION_CHECKS = 4  # eigenvalues of the deflated operator that are computed to find one that was missed
#: eigenvalues of the operator below this fraction of its largest are zero up to rounding: infinite
#: eigenvalues
SMALLEST_OPERATOR_EIGENVALUE = 1e-11
MAX_DEFLATIONS = 40
MAX_DISCS = 200


def growing(s: np.ndarray, zero: float = 0.0) -> np.ndarray:
    """(m,) mask of the eigenvalues that grow beyond rounding, those within ``zero`` [1/s] left out (manual: eq-eigen-figures)."""
    size = np.abs(s)
    return (s.real > NEUTRAL_GROWTH * size) & (size > zero)


def damping_ratio(s: np.ndarray) -> FloatArray:
    """(m,) -growth/|s| of eigenvalues [-], nan at zero."""
    size = np.abs(s)
    return np.divide(-s.real, size, out=np.full(len(s), np.nan), where=size > 0)


@dataclass(frozen=True)
class QuadraticEigenproblem:
    """The problem (K + s C + s^2 M) u = 0 (manual: eq-eigen-problem).

    K, C, M: (n, n) sparse [for example N/m, N s/m, kg].
    second_order: (n,) which unknowns are of second order.
    scale: (n,) usual sizes of the unknowns [SI].
    reference: a slow rate of the system [1/s], by which rates are scaled (manual: eq-eigen-reference).
    Shifts are real multiples of it unless one is given.

    Raises ValueError if a first-order unknown has an inertia.
    """

    K: sparse.csr_matrix
    C: sparse.csr_matrix
    M: sparse.csr_matrix
    second_order: np.ndarray
    scale: FloatArray
    reference: float = 1.0

    def __post_init__(self) -> None:
        if abs(self.M[:, np.flatnonzero(~self.second_order)]).sum() != 0:
            raise ValueError("a first-order unknown has an inertia")

    @property
    def size(self) -> int:
        """Length of z = (u, v)."""
        return len(self.second_order) + int(self.second_order.sum())


@dataclass(frozen=True)
class Eigenvalues:
    """Eigenvalues with their vectors.

    s: (m,) [1/s]; of each conjugate pair the one with Im s >= 0.
    u: (n, m) eigenvectors [SI of each unknown].
    error: (m,) backward errors [-] (manual: eq-eigen-error).
    radius: all eigenvalues nearer than this to the shift are included [1/s].
    """

    s: np.ndarray
    u: np.ndarray
    error: FloatArray
    radius: float = np.inf

    @property
    def grows(self) -> np.ndarray:
        """(m,) mask of the eigenvalues that grow beyond rounding (manual: eq-eigen-figures)."""
        return growing(self.s)

    def subset(self, which: np.ndarray) -> Eigenvalues:
        """Select eigenvalues by a mask (m,) or by their numbers."""
        return Eigenvalues(self.s[which], self.u[:, which], self.error[which], self.radius)


#: which eigenvalues count: (m,) mask
Selection = Callable[[Eigenvalues], np.ndarray]


class _Scaled:
    """The problem in units of its scales and its reference rate, with rows of size one.

    Raises ValueError if a row is zero.
    """

    def __init__(self, p: QuadraticEigenproblem):
        w, columns = p.reference, sparse.diags(p.scale)
        parts = [sparse.csr_matrix(A @ columns) * f for A, f in ((p.K, 1.0), (p.C, w), (p.M, w**2))]
        size = np.max([abs(A).max(axis=1).toarray().ravel() for A in parts], axis=0)
        if (size == 0).any():
            raise ValueError("a row of the linearised system is empty")
        rows = sparse.diags(1.0 / size)
        self.K, self.C, self.M = (sparse.csr_matrix(rows @ A) for A in parts)
        self.second_order, self.second_dofs = p.second_order, np.flatnonzero(p.second_order)
        self.C1 = sparse.csr_matrix(self.C @ sparse.diags((~p.second_order).astype(float)))
        self.C2, self.M2 = self.C[:, self.second_dofs], self.M[:, self.second_dofs]
        self.n, self.size = len(p.second_order), p.size

    def operator(self, sigma: complex) -> Callable[[np.ndarray], np.ndarray]:
        """Return Op at the shift sigma, for vectors (size,) or matrices (size, k).

        Manual: eq-eigen-operator.

        Raises SolveError if the system is singular at the shift.
        """
        shifted = sparse.csc_matrix(self.K + sigma * self.C + sigma**2 * self.M)
        try:
            factor = sparse_linalg.splu(shifted)
        except RuntimeError as error:
            raise SolveError(
                "the linearised system is singular at the shift", hint="give another --shift"
            ) from error
        by_velocity = sparse.csr_matrix(self.C2 + sigma * self.M2)
        complex_factor = np.iscomplexobj(shifted)

        def solve(b: np.ndarray) -> np.ndarray:
            if np.iscomplexobj(b) and not complex_factor:
                return factor.solve(b.real.copy()) + 1j * factor.solve(b.imag.copy())
            return factor.solve(b.astype(complex) if complex_factor else b)

        def apply(z: np.ndarray) -> np.ndarray:
            u, v = z[: self.n], z[self.n :]
            selected = u[self.second_dofs]
            u = -solve(self.C1 @ u + self.M2 @ v + by_velocity @ selected)
            return np.concatenate([u, selected + sigma * u[self.second_dofs]])

        return apply

    def error(self, s: np.ndarray, u: np.ndarray) -> FloatArray:
        """Compute the backward errors (m,) of eigenvalues s (m,) with vectors u (n, m).

        Manual: eq-eigen-error.
        """
        terms = self.K @ u, s * (self.C @ u), s**2 * (self.M @ u)
        weight = sum(
            abs(f) * sparse_linalg.norm(A, np.inf) for f, A in ((s**0, self.K), (s, self.C), (s**2, self.M))
        )
        return np.abs(sum(terms)).max(axis=0) / (weight * np.abs(u).max(axis=0))


def _arpack(apply, size: int, count: int, kind: type, seed: int) -> np.ndarray:
    """Compute vectors (size, k) of about ``count`` eigenvalues of largest size by implicitly restarted Arnoldi.

    apply: the operator; kind: its number type; seed: of the random start vector.
    Source: Lehoucq, Sorensen, Yang, ARPACK Users' Guide, 1998.
    """
    start: np.ndarray = np.random.default_rng(seed).standard_normal(size).astype(kind)
    op = sparse_linalg.LinearOperator((size, size), matvec=apply, dtype=kind)
    try:
        return sparse_linalg.eigs(
            op, count, which="LM", v0=start, ncv=min(size, max(2 * count + 2, 40)), maxiter=100 * count
        )[1]
    except sparse_linalg.ArpackNoConvergence as error:
        return error.eigenvectors


def _span(Q: np.ndarray, W: np.ndarray, real: bool) -> np.ndarray:
    """Extend the orthonormal basis Q by the columns of W; ``real``: by their real and imaginary parts."""
    X = np.hstack([W.real, W.imag]) if real else W
    X = X[:, np.linalg.norm(X, axis=0) > 0]
    for _ in range(2):
        X = X - Q @ (Q.conj().T @ X)
    new, R, _ = scipy.linalg.qr(X, mode="economic", pivoting=True)
    independent = np.abs(np.diag(R)) > 1e-9
    return np.hstack([Q, new[:, : len(independent)][:, independent]])


def _leading(apply, size: int, count: int, real: bool) -> tuple[np.ndarray, np.ndarray, float]:
    """Compute at least ``count`` eigenvalues of largest size (manual: sec-eigen-search).

    A Krylov space contains a multiple eigenvalue only through rounding.  The method therefore runs again on
    the operator with the found space projected out, until no eigenvalue of that size is left.

    Returns eigenvalues (m,), vectors (size, m), and a bound: no eigenvalue larger than it is missing.
    Raises SolveError if nothing converges.
    """
    kind: type = float if real else complex
    Q: np.ndarray = np.zeros((size, 0), dtype=kind)
    values, vectors = np.zeros(0, dtype=complex), np.zeros((size, 0), dtype=complex)
    batch, bound = count, 0.0
    for seed in range(MAX_DEFLATIONS):
        basis, adjoint = Q, Q.conj().T

        def deflated(z: np.ndarray, basis: np.ndarray = basis, adjoint: np.ndarray = adjoint) -> np.ndarray:
            z = apply(z)
            return z - basis @ (adjoint @ z)

        W = _arpack(deflated, size, batch, kind, seed)
        if not W.shape[1]:
            raise SolveError(
                "no eigenvalue of the linearised system converged",
                hint="give another --shift or a smaller --count",
            )
        Q = _span(Q, W, real)
        ritz_values, ritz_vectors = np.linalg.eig(Q.conj().T @ apply(Q))
        order = np.argsort(-np.abs(ritz_values))
        before, values, vectors = bound, ritz_values[order], Q @ ritz_vectors[:, order]
        bound = float(np.abs(values[min(count, len(values)) - 1]))
        if seed and bound <= before * (1 + 1e-8):  # no new eigenvalue among the first ``count``
            return values, vectors, bound
        batch = DEFLATION_CHECKS
    raise SolveError(
        f"the eigenvalues near the shift were not complete after {MAX_DEFLATIONS} rounds",
        hint="give another --shift",
    )


# ---------------------------------------------------------------------- eigenvalues
def eigenvalues_near(
    problem: QuadraticEigenproblem, shift: complex, count: int, engine: str = "auto"
) -> Eigenvalues:
    """Compute at least ``count`` eigenvalues nearest to ``shift`` [1/s]; all of a small system.

    count: both eigenvalues of a conjugate pair count.
    engine: ``dense``, ``arpack``, or ``auto``: a dense matrix up to DENSE_BELOW, then ARPACK.

    Raises SolveError if nothing converges.  Manual: sec-eigen-search.
    """
    scaled, w = _Scaled(problem), problem.reference
    sigma: Any = complex(shift) / w
    real = sigma.imag == 0
    sigma = sigma.real if real else sigma
    apply, size = scaled.operator(sigma), scaled.size
    bound = 0.0
    if engine == "dense" or (engine == "auto" and size <= DENSE_BELOW) or count + 2 * DEFLATION_CHECKS > size:
        values, vectors = np.linalg.eig(apply(np.eye(size)))
    else:
        values, vectors, bound = _leading(apply, size, count, real)
    finite = np.abs(values) > SMALLEST_OPERATOR_EIGENVALUE * np.abs(values).max()
    values, u = values[finite], vectors[: scaled.n, finite]
    size_of = np.abs(u).max(axis=0)
    values, u = values[size_of > 0], u[:, size_of > 0] / size_of[size_of > 0]
    s = sigma + 1.0 / values
    error = scaled.error(s, u)
    accurate = error < LARGEST_BACKWARD_ERROR
    if bound != 0.0:
        accurate = accurate & (np.abs(values) > bound * (1 + RADIUS_TOLERANCE))
    radius = w / (bound * (1 + RADIUS_TOLERANCE)) if bound else np.inf
    return _upper(
        Eigenvalues(s[accurate] * w, problem.scale[:, None] * u[:, accurate], error[accurate], radius),
        problem.reference,
    )


def _upper(eigenvalues: Eigenvalues, reference: float) -> Eigenvalues:
    """Drop the lower half plane; eigenvalues that are real up to rounding become real.

    reference: rate [1/s] below whose ``REAL_TOLERANCE`` |s| counts as zero.
    """
    size = np.maximum(np.abs(eigenvalues.s), REAL_TOLERANCE * reference)
    s = np.where(np.abs(eigenvalues.s.imag) <= REAL_TOLERANCE * size, eigenvalues.s.real, eigenvalues.s)
    return Eigenvalues(s, eigenvalues.u, eigenvalues.error, eigenvalues.radius).subset(s.imag >= 0)


def lowest_eigenvalues(
    problem: QuadraticEigenproblem,
    count: int,
    engine: str = "auto",
    selected: Selection | None = None,
    sparing: bool = False,
) -> Eigenvalues:
    """Compute the oscillating eigenvalues of lowest |Im s|, sorted by |Im s|, real ones by growth.

    Some of the slowest real eigenvalues are included, and all growing ones among the computed. The search
    uses discs about shifts, first near zero, then up the imaginary axis (manual: sec-eigen-search).
    Within a disc every eigenvalue is found.  An eigenvalue far to the left, outside all discs, is missing:
    it decays within a fraction of a period of the others.

    problem: the eigenvalue problem.
    count: number of oscillating eigenvalues.
    engine: as in ``eigenvalues_near``.
    selected(eigenvalues): (m,) mask of the eigenvalues that count; the others are left out.
    sparing: discs after the first are no larger than what is still missing; fewer eigenvalues above the requested
    ones are seen, so a growing one among them may be left out.

    Raises SolveError if nothing converges.
    """
    first = FIRST_SHIFT * problem.reference
    parts: list[Eigenvalues] = []
    discs: list[tuple[complex, float]] = []
    height, per_disc, oscillating = 0.0, 2 * count + 2 * DEFLATION_CHECKS, 0
    for _ in range(MAX_DISCS):
        shift = 1j * height if discs else complex(first)
        near = eigenvalues_near(problem, shift, per_disc, engine)
        new = np.all(
            [abs(z - c) > r for c, r in discs for z in (near.s, np.conj(near.s))]
            or [np.ones(len(near.s), bool)],
            axis=0,
        )
        near, disc = near.subset(new), (shift, near.radius)
        counts = selected(near) if selected else new[new]
        oscillating += int((counts & (near.s.imag > 0)).sum())
        parts.append(near.subset(counts))
        discs.append(disc)
        height = max(height, _height(disc))
        if sparing and selected is None:  # half of a disc about the last height is new
            per_disc = 2 * max(count - oscillating, DEFLATION_CHECKS) + 2 * DEFLATION_CHECKS
        if oscillating >= count or not np.isfinite(disc[1]):
            break
    return lowest_of(parts, count)


def backward_errors(problem: QuadraticEigenproblem, s: np.ndarray, u: np.ndarray) -> FloatArray:
    """(m,) backward errors of eigenvalues s (m,) [1/s] with vectors u (n, m) (manual: eq-eigen-error)."""
    return _Scaled(problem).error(s / problem.reference, u / problem.scale[:, None])


def _height(disc: tuple[complex, float]) -> float:
    """Compute the height at which a disc (centre, radius) [1/s] meets the imaginary axis."""
    centre, radius = disc
    return centre.imag + float(np.sqrt(max(0.0, radius**2 - centre.real**2)))


def lowest_of(parts: list[Eigenvalues], count: int) -> Eigenvalues:
    """Join the parts; select ``count`` oscillating eigenvalues, the slowest real ones and all that grow."""
    s, u, error = (np.concatenate([getattr(r, k) for r in parts], axis=-1) for k in ("s", "u", "error"))
    joined = Eigenvalues(s, u, error)
    order = np.lexsort((-s.real, s.imag))
    oscillating = order[s.imag[order] > 0][:count]
    real = np.flatnonzero(s.imag == 0)
    slow_count = max(1, count // OSCILLATING_PER_SLOW_REAL)
    slow = real[np.argsort(np.abs(s[real]), kind="stable")][:slow_count]
    included = joined.grows
    included[oscillating], included[slow] = True, True
    return joined.subset(order[included[order]])
