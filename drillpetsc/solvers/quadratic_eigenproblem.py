"""Eigenvalues s of (K + s C + s^2 M) u = 0 near a point of the complex plane, or the slowest ones; numpy and
scipy only, one process.

M and C may be singular: an unknown of first order has no column in M, an algebraic one none in C either.
With v = s u of the second-order unknowns the problem is A z = s B z, z = (u, v),

    [ 0   I  ] [u]     [ S   0  ] [u]
    [ -K -C2 ] [v] = s [ C1  M2 ] [v]

where S picks the second-order unknowns, C1 has the columns of the others and C2, M2 their own.  B is
singular: its infinite roots become zeros of Op = (A - sigma B)^-1 B, whose eigenvalues are 1/(s - sigma).  Op
needs one factor of K + sigma C + sigma^2 M only:

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

DENSE_BELOW = 400  # length of z up to which all roots are found at once, with a dense matrix
OFF_ROOT = 0.87  # the first shift in units of the reference rate: real, positive and no likely root
SAME = 1e-4  # distances from a shift that are nearer than this share are one
REAL = 1e-6  # |Im s| below this share of |s| is rounding
WRONG = 1e-6  # backward error above which a root is none
NEUTRAL = 1e-6  # growth below this share of |s| is rounding (measured up to 1.2e-7 on 12 km)
SLOW = 4  # one slow real root is shown for so many oscillating ones
CHECKED = 4  # roots of the deflated operator that are looked at for one that was missed
# eigenvalues of the operator below this share of the largest are rounding of a zero: infinite roots
RESOLVED = 1e-11
ROUNDS = 40
DISCS = 200


@dataclass(frozen=True)
class QuadraticEigenproblem:
    """K [N/m, say], C, M: (n, n) sparse; second (n,): which unknowns are of second order; scale (n,): their
    usual sizes.

    reference [1/s]: a slow rate of the system, by which rates are scaled; shifts are real multiples of it
    where no other is asked for.
    """

    K: sparse.csr_matrix
    C: sparse.csr_matrix
    M: sparse.csr_matrix
    second: np.ndarray
    scale: FloatArray
    reference: float = 1.0

    def __post_init__(self) -> None:
        if abs(self.M[:, np.flatnonzero(~self.second)]).sum() != 0:
            raise ValueError("a first-order unknown has an inertia")

    @property
    def size(self) -> int:
        """Length of z."""
        return len(self.second) + int(self.second.sum())


@dataclass(frozen=True)
class Eigenvalues:
    """s (m,) [1/s], of each conjugate pair the one with Im s >= 0; u (n, m) its vector; error (m,): of the
    equation, relative to the sum of its terms' norms; ``radius``: all roots nearer than this to the shift are
    here [1/s]."""

    s: np.ndarray
    u: np.ndarray
    error: FloatArray
    radius: float = np.inf

    @property
    def grows(self) -> np.ndarray:
        """(m,) which grow beyond rounding."""
        return self.s.real > NEUTRAL * np.abs(self.s)

    def chosen(self, which: np.ndarray) -> Eigenvalues:
        return Eigenvalues(self.s[which], self.u[:, which], self.error[which], self.radius)


class _Scaled:
    """The pencil in units of its scales and its reference rate, rows of size one."""

    def __init__(self, p: QuadraticEigenproblem):
        w, columns = p.reference, sparse.diags(p.scale)
        parts = [sparse.csr_matrix(A @ columns) * f for A, f in ((p.K, 1.0), (p.C, w), (p.M, w**2))]
        size = np.max([abs(A).max(axis=1).toarray().ravel() for A in parts], axis=0)
        if (size == 0).any():
            raise ValueError("a row of the linearised system is empty")
        rows = sparse.diags(1.0 / size)
        self.K, self.C, self.M = (sparse.csr_matrix(rows @ A) for A in parts)
        self.second, self.place = p.second, np.flatnonzero(p.second)
        self.C1 = sparse.csr_matrix(self.C @ sparse.diags((~p.second).astype(float)))
        self.C2, self.M2 = self.C[:, self.place], self.M[:, self.place]
        self.n, self.size = len(p.second), p.size

    def operator(self, sigma: complex) -> Callable[[np.ndarray], np.ndarray]:
        """Op at the shift sigma, for vectors (size,) or matrices (size, k)."""
        shifted = sparse.csc_matrix(self.K + sigma * self.C + sigma**2 * self.M)
        try:
            factor = sparse_linalg.splu(shifted)
        except RuntimeError as error:
            raise SolveError(
                "the linearised system is singular at the shift", hint="give another --shift"
            ) from error
        second = sparse.csr_matrix(self.C2 + sigma * self.M2)
        complex_factor = np.iscomplexobj(shifted)

        def solve(b: np.ndarray) -> np.ndarray:
            if np.iscomplexobj(b) and not complex_factor:
                return factor.solve(b.real.copy()) + 1j * factor.solve(b.imag.copy())
            return factor.solve(b.astype(complex) if complex_factor else b)

        def apply(z: np.ndarray) -> np.ndarray:
            u, v = z[: self.n], z[self.n :]
            own = u[self.place]
            u = -solve(self.C1 @ u + self.M2 @ v + second @ own)
            return np.concatenate([u, own + sigma * u[self.place]])

        return apply

    def error(self, s: np.ndarray, u: np.ndarray) -> FloatArray:
        """Backward error of each root in the norm of the largest entry."""
        terms = self.K @ u, s * (self.C @ u), s**2 * (self.M @ u)
        weight = sum(
            abs(f) * sparse_linalg.norm(A, np.inf) for f, A in ((s**0, self.K), (s, self.C), (s**2, self.M))
        )
        return np.abs(sum(terms)).max(axis=0) / (weight * np.abs(u).max(axis=0))


# ---------------------------------------------------------------------- engines
def _arpack(apply, size: int, count: int, kind: type, seed: int) -> np.ndarray:
    """Vectors of about ``count`` eigenvalues of largest size: implicitly restarted Arnoldi (Lehoucq,
    Sorensen, Yang 1998)."""
    start: np.ndarray = np.random.default_rng(seed).standard_normal(size).astype(kind)
    op = sparse_linalg.LinearOperator((size, size), matvec=apply, dtype=kind)
    try:
        return sparse_linalg.eigs(
            op, count, which="LM", v0=start, ncv=min(size, max(2 * count + 2, 40)), maxiter=100 * count
        )[1]
    except sparse_linalg.ArpackNoConvergence as error:
        return error.eigenvectors


def _slepc(apply, size: int, count: int, kind: type, seed: int) -> np.ndarray:
    """The same by SLEPc's Krylov-Schur method; options with the prefix ``modes_``.  For the number type that
    PETSc has."""
    from petsc4py import PETSc
    from slepc4py import SLEPc  # type: ignore

    class Shell:
        def mult(self, matrix, x, y) -> None:
            y.setArray(apply(x.getArray(readonly=1)))

    matrix = PETSc.Mat().createPython((size, size), context=Shell(), comm=PETSc.COMM_SELF)
    matrix.setUp()
    eps = SLEPc.EPS().create(comm=PETSc.COMM_SELF)
    eps.setOptionsPrefix("modes_")
    eps.setOperators(matrix)
    eps.setProblemType(SLEPc.EPS.ProblemType.NHEP)
    eps.setWhichEigenpairs(SLEPc.EPS.Which.LARGEST_MAGNITUDE)
    eps.setDimensions(count)
    eps.setTolerances(1e-13, 100 * count)
    start = matrix.createVecRight()
    start.setArray(np.random.default_rng(seed).standard_normal(size))
    eps.setInitialSpace(start)
    eps.setFromOptions()
    eps.solve()
    real, imaginary = matrix.createVecs()
    out = []
    for i in range(eps.getConverged()):
        eps.getEigenpair(i, real, imaginary)
        out.append(real.getArray() + 1j * imaginary.getArray())
    return np.array(out).reshape(-1, size).T


def _has_slepc(kind: type) -> bool:
    """Whether SLEPc is here and computes with the wanted number type."""
    try:
        from petsc4py import PETSc
        from slepc4py import SLEPc  # noqa: F401
    except ImportError:
        return False
    return bool(np.issubdtype(PETSc.ScalarType, np.complexfloating)) == (kind is complex)


def _span(Q: np.ndarray, W: np.ndarray, real: bool) -> np.ndarray:
    """Orthonormal basis of Q (orthonormal) and the columns of W; real where the operator is."""
    X = np.hstack([W.real, W.imag]) if real else W
    X = X[:, np.linalg.norm(X, axis=0) > 0]
    for _ in range(2):
        X = X - Q @ (Q.conj().T @ X)
    new, R, _ = scipy.linalg.qr(X, mode="economic", pivoting=True)
    keep = np.abs(np.diag(R)) > 1e-9
    return np.hstack([Q, new[:, : len(keep)][:, keep]])


def _leading(apply, size: int, count: int, real: bool, engine: str) -> tuple[np.ndarray, np.ndarray, float]:
    """Eigenvalues of largest size and their vectors: at least ``count``, and none is missed that is larger
    than the third value given.

    A Krylov space shows a multiple eigenvalue only by way of rounding.  So the operator is asked again with
    what was found projected out, until it has nothing left of that size.
    """
    kind: type = float if real else complex
    method = _slepc if engine == "slepc" or (engine == "auto" and _has_slepc(kind)) else _arpack
    Q: np.ndarray = np.zeros((size, 0), dtype=kind)
    values, vectors, wanted, edge = np.zeros(0, dtype=complex), np.zeros((size, 0), dtype=complex), count, 0.0
    for seed in range(ROUNDS):
        basis = Q

        def deflated(z: np.ndarray, basis: np.ndarray = basis) -> np.ndarray:
            z = apply(z)
            return z - basis @ (basis.conj().T @ z)

        W = method(deflated, size, wanted, kind, seed)
        if not W.shape[1]:
            raise SolveError(
                "no eigenvalue of the linearised scene converged",
                hint="give another --shift or a smaller --count",
            )
        Q = _span(Q, W, real)
        small, turn = np.linalg.eig(Q.conj().T @ apply(Q))
        order = np.argsort(-np.abs(small))
        before, values, vectors = edge, small[order], Q @ turn[:, order]
        edge = float(np.abs(values[min(count, len(values)) - 1]))
        if seed and edge <= before * (1 + 1e-8):  # nothing came in among the first ``count``
            return values, vectors, edge
        wanted = CHECKED
    raise SolveError(
        f"the eigenvalues near the shift were not complete after {ROUNDS} rounds", hint="give another --shift"
    )


# ---------------------------------------------------------------------- roots
def eigenvalues_near(
    pencil: QuadraticEigenproblem, shift: complex, count: int, engine: str = "auto"
) -> Eigenvalues:
    """At least ``count`` roots nearest to ``shift`` [1/s] (both of a pair count); all of a small system.

    engine: dense, arpack, slepc, or auto: dense up to DENSE_BELOW, then SLEPc where it is installed and has
    the number type of the shift, else ARPACK.  Raises SolveError where nothing converges.
    """
    scaled, w = _Scaled(pencil), pencil.reference
    sigma: Any = complex(shift) / w
    real = sigma.imag == 0
    sigma = sigma.real if real else sigma
    apply, size = scaled.operator(sigma), scaled.size
    edge = 0.0
    if engine == "dense" or (engine == "auto" and size <= DENSE_BELOW) or count + 2 * CHECKED > size:
        values, vectors = np.linalg.eig(apply(np.eye(size)))
    else:
        values, vectors, edge = _leading(apply, size, count, real, engine)
    finite = np.abs(values) > RESOLVED * np.abs(values).max()
    values, u = values[finite], vectors[: scaled.n, finite]
    size_of = np.abs(u).max(axis=0)
    values, u = values[size_of > 0], u[:, size_of > 0] / size_of[size_of > 0]
    s = sigma + 1.0 / values
    error = scaled.error(s, u)
    good = (error < WRONG) if edge == 0.0 else (error < WRONG) & (np.abs(values) > edge * (1 + SAME))
    radius = w / (edge * (1 + SAME)) if edge else np.inf
    return _upper(
        Eigenvalues(s[good] * w, pencil.scale[:, None] * u[:, good], error[good], radius), pencil.reference
    )


def _upper(roots: Eigenvalues, reference: float) -> Eigenvalues:
    """Without the lower half plane; what is real to rounding is made real."""
    s = np.where(
        np.abs(roots.s.imag) <= REAL * np.maximum(np.abs(roots.s), REAL * reference), roots.s.real, roots.s
    )
    return Eigenvalues(s, roots.u, roots.error, roots.radius).chosen(s.imag >= 0)


def lowest_eigenvalues(
    pencil: QuadraticEigenproblem,
    count: int,
    engine: str = "auto",
    wanted: Callable[[Eigenvalues], np.ndarray] | None = None,
) -> Eigenvalues:
    """The ``count`` oscillating roots of lowest |Im s|, some of the slowest real ones, and all that grow of
    those seen; sorted by |Im s|, real ones by growth.  wanted(roots) -> (m,) mask: which roots count; the
    others are left out.

    Discs about shifts, first near zero, then ever higher up the imaginary axis, until there are enough;
    within a disc every root is found.  A root so far to the left that no disc reaches it is not seen: it dies
    out within a fraction of a period of those found.
    """
    first = OFF_ROOT * pencil.reference
    found: list[Eigenvalues] = []
    discs: list[tuple[complex, float]] = []
    height, most, enough = 0.0, 2 * count + 2 * CHECKED, 0
    for _ in range(DISCS):
        shift = 1j * height if discs else complex(first)
        roots = eigenvalues_near(pencil, shift, most, engine)
        new = np.all(
            [abs(z - c) > r for c, r in discs for z in (roots.s, np.conj(roots.s))]
            or [np.ones(len(roots.s), bool)],
            axis=0,
        )
        roots, disc = roots.chosen(new), (shift, roots.radius)
        counts = wanted(roots) if wanted else new[new]
        enough += int((counts & (roots.s.imag > 0)).sum())
        found.append(roots.chosen(counts))
        discs.append(disc)
        height = max(height, _height(disc))
        if enough >= count or not np.isfinite(disc[1]):
            break
    return _sorted(found, count)


def _height(disc: tuple[complex, float]) -> float:
    """How far up the imaginary axis a disc reaches."""
    centre, radius = disc
    return centre.imag + float(np.sqrt(max(0.0, radius**2 - centre.real**2)))


def _sorted(found: list[Eigenvalues], count: int) -> Eigenvalues:
    s, u, error = (np.concatenate([getattr(r, k) for r in found], axis=-1) for k in ("s", "u", "error"))
    every = Eigenvalues(s, u, error)
    order = np.lexsort((-s.real, s.imag))
    swinging = order[s.imag[order] > 0][:count]
    real = np.flatnonzero(s.imag == 0)
    slow = real[np.argsort(np.abs(s[real]), kind="stable")][: max(1, count // SLOW)]
    keep = every.grows
    keep[swinging], keep[slow] = True, True
    return every.chosen(order[keep[order]])
