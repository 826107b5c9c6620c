"""Fewer states: balanced truncation, or truncation to the dominant modes (manual: sec-linear-reduction).

Motions that do not decay (rigid, undamped or growing) are separated first and kept as they are.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
from scipy.linalg import lapack

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError
from drillpetsc.solvers.linear.state_space import StateSpace

UNDAMPED = 1e-9  # decay below this fraction of |s| is rounding
LARGEST_DENSE = 3000  # states up to which dense matrices are used


@dataclass(frozen=True)
class Kept:
    """Roots that do not decay, kept by every reduction.

    s: (k,) [1/s]; vectors: (n, k) states.
    """

    s: np.ndarray
    vectors: np.ndarray


@dataclass(frozen=True)
class Reduced:
    """A reduced model.

    system: the model; kept: number of its states for motions that do not decay.
    hankel: (n,) Hankel singular values of the decaying part, with inputs over ``input_size`` and outputs over
    ``output_size``; empty for modal truncation.
    bound: largest error of the response, in the same units: twice the sum of the Hankel values left out; nan for modal.
    """

    system: StateSpace
    kept: int
    hankel: FloatArray
    bound: float
    input_size: FloatArray
    output_size: FloatArray

    def error(self, full: np.ndarray, reduced: np.ndarray) -> float:
        """Largest error of responses (k, p, m) in the units of ``bound``."""
        scaled = (full - reduced) * self.input_size / self.output_size[:, None]
        return float(np.linalg.norm(scaled, 2, axis=(1, 2)).max(initial=0.0)) if scaled.size else 0.0


def not_decaying(system: StateSpace, zero: float) -> Kept:
    """Find the roots that do not decay; ``zero``: roots of this size or smaller count as zero [1/s]."""
    if not system.order:
        return Kept(np.zeros(0, dtype=complex), np.zeros((0, 0)))
    A, T = _balanced(system.A)
    s, V = np.linalg.eig(A)
    mask = _stays(s, zero) & (s.imag >= 0)
    return Kept(s[mask], T[:, None] * V[:, mask])


def _balanced(A: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A in states of balanced size, and the sizes (n,)."""
    scaled, (sizes, _) = scipy.linalg.matrix_balance(A, permute=False, separate=True)
    return scaled, sizes


def _is_zero(s: np.ndarray, zero: float) -> np.ndarray:
    """Mask of the roots that are zero up to rounding; a double root is off by the square root of it."""
    return np.abs(s) <= max(zero, np.sqrt(np.finfo(float).eps) * float(np.abs(s).max(initial=0.0)))


def _stays(s: np.ndarray, zero: float) -> np.ndarray:
    """Mask of the roots that do not decay."""
    return _is_zero(s, zero) | (s.real > -UNDAMPED * np.abs(s))


@dataclass(frozen=True)
class _Split:
    """Two parts of a system that do not act on each other: the first ``count`` states, and the others."""

    A: FloatArray
    B: FloatArray
    C: FloatArray
    count: int

    @property
    def first(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        k = self.count
        return self.A[:k, :k], self.B[:k], self.C[:, :k]

    @property
    def second(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        k = self.count
        return self.A[k:, k:], self.B[k:], self.C[:, k:]


def _schur(A: FloatArray) -> tuple[FloatArray, FloatArray, np.ndarray]:
    """Real Schur form, vectors, and eigenvalues in its order."""
    T, Z = scipy.linalg.schur(A, output="real", check_finite=False)
    return T, Z, _roots(T)


def _roots(T: FloatArray) -> np.ndarray:
    """Eigenvalues of a real Schur form in its order."""
    s = np.diag(T).astype(complex)
    for i in np.flatnonzero(np.diag(T, -1)):
        s[i : i + 2] = np.linalg.eigvals(T[i : i + 2, i : i + 2])
    return s


def _nilpotent(A: FloatArray, B: FloatArray, C: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The part of the roots that are zero, without the rounding that makes them grow or swing.

    The states are turned so that the states with A x = 0 come first, then the states that move only these, and so on. A
    double root differs from zero by the square root of the rounding, the null space of A only by the rounding.
    """
    A, B, C, start, n = A.copy(), B.copy(), C.copy(), 0, len(A)
    while start < n:
        _, size, Vt = np.linalg.svd(A[start:, start:])
        null = size <= np.sqrt(np.finfo(float).eps) * max(float(size.max()), float(np.abs(A).max()))
        if not null.any():
            return A, B, C  # no null space: leave what there is
        turn = np.eye(n)
        turn[start:, start:] = np.vstack([Vt[null], Vt[~null]]).T
        A, B, C = turn.T @ A @ turn, turn.T @ B, C @ turn
        end = start + int(null.sum())
        A[start:, start:end] = 0.0
        start = end
    return A, B, C


def _split(T: FloatArray, Z: FloatArray, B: FloatArray, C: FloatArray, select: np.ndarray) -> _Split:
    """Separate the selected roots from the others."""
    n, k = len(T), int(select.sum())
    if 0 < k < n:
        T, Z, *_, info = lapack.dtrsen(select.astype(np.int32), T, Z, job=b"N")
        if info:
            raise SolveError("decaying and non-decaying roots are too close to be separated")
        X, factor, _ = lapack.dtrsyl(T[:k, :k], T[k:, k:], -T[:k, k:], isgn=-1)
        X = X / factor
        T = scipy.linalg.block_diag(T[:k, :k], T[k:, k:])
        B, C = Z.T @ B, C @ Z
        B[:k] -= X @ B[k:]
        C[:, k:] += C[:, :k] @ X
        return _Split(T, B, C, k)
    return _Split(T, Z.T @ B, C @ Z, k)


def _output_sizes(A, B, C, D, input_size) -> FloatArray:
    """Largest response (p,) of each output of the decaying part to usual inputs; 1 if there is none."""
    s = np.linalg.eigvals(A) if len(A) else np.zeros(0, dtype=complex)
    at = np.unique(np.abs(s.imag[s.imag >= 0]))
    at = at[:: max(1, len(at) // 200)] if len(at) else np.zeros(1)
    system = StateSpace(A, B, C, D, np.zeros_like(D))
    size = (np.abs(system.response(at / (2 * np.pi))) * input_size).max(axis=(0, 2), initial=0.0)
    return np.where(size > 0, size, 1.0)


def reduce(system: StateSpace, method: str, order: int, zero: float, input_size: FloatArray) -> Reduced:
    """Reduce a model to ``order`` states, motions that do not decay included.

    method: ``balanced`` or ``modal``; zero: as in ``not_decaying``; input_size: (m,) usual sizes of the inputs.
    A model with no more states than ``order`` stays as it is.  Modal truncation keeps conjugate pairs whole and may have one
    state less.  Sources: Moore 1981 (balanced truncation), Glover 1984 (bound), Rommes and Martins 2006 (dominance).

    Raises SolveError if more motions than ``order`` do not decay, or roots cannot be separated.
    """
    A, sizes = _balanced(system.A) if system.order else (system.A, np.ones(0))
    B, C = system.B / sizes[:, None], system.C * sizes
    T, Z, s = _schur(A) if system.order else (A, A, np.zeros(0, dtype=complex))
    limit = max(zero, np.sqrt(np.finfo(float).eps) * float(np.abs(s).max(initial=0.0)))
    rigid = _split(T, Z, B, C, _is_zero(s, limit))
    T2, B2, C2 = rigid.second
    parts = _split(T2, np.eye(len(T2)), B2, C2, _stays(_roots(T2), limit))
    k = rigid.count + parts.count
    if k > order:
        raise SolveError(
            f"{k} states belong to non-decaying motions, which are all kept: order {order} is too small",
            hint="give a larger --order, or the string some damping (material.damping)",
        )
    A2, B2, C2 = parts.second
    p = len(C)
    output_size = _output_sizes(A2, B2, C2, np.zeros((p, B.shape[1])), input_size)
    wanted = order - k
    D = system.D
    hankel, bound = np.zeros(0), float("nan")
    if method == "balanced":
        Bs, Cs = B2 * input_size, C2 / output_size[:, None]
        Lp, Lq = _gramian(A2, Bs), _gramian(A2.T, Cs.T)
        U, hankel, Vt = np.linalg.svd(Lq.T @ Lp)
        wanted = min(wanted, int((hankel > 1e-13 * hankel.max(initial=0.0)).sum()))
        root = np.sqrt(hankel[:wanted])
        right, left = Lp @ Vt[:wanted].T / root, (Lq @ U[:, :wanted] / root).T
        reduced = (left @ A2 @ right, left @ B2, C2 @ right)
        bound = 2.0 * float(hankel[wanted:].sum())
    else:
        reduced, D = _dominant(A2, B2 * input_size, C2 / output_size[:, None], wanted)
        reduced = (reduced[0], reduced[1] / input_size, reduced[2] * output_size[:, None])
        D = system.D + D * output_size[:, None] / input_size
    if system.order <= order:
        return Reduced(system, k, hankel, 0.0 if method == "balanced" else bound, input_size, output_size)
    (A0, B0, C0), (A1, B1, C1) = _nilpotent(*rigid.first), parts.first
    joined = StateSpace(
        scipy.linalg.block_diag(A0, A1, reduced[0]),
        np.vstack([B0, B1, reduced[1]]),
        np.hstack([C0, C1, reduced[2]]),
        D,
        system.F,
        tuple(
            [f"not decaying {i + 1}" for i in range(k)]
            + [f"{method} {i + 1}" for i in range(len(reduced[0]))]
        ),
    )
    return Reduced(joined, k, hankel, bound, input_size, output_size)


def _gramian(A: FloatArray, B: FloatArray) -> FloatArray:
    """Factor L of the gramian, A L L' + L L' A' + B B' = 0."""
    if not len(A):
        return np.zeros((0, 0))
    P = scipy.linalg.solve_continuous_lyapunov(A, -B @ B.T)
    values, vectors = np.linalg.eigh((P + P.T) / 2)
    return vectors * np.sqrt(np.maximum(values, 0.0))


def _dominant(A, B, C, wanted: int) -> tuple[tuple[FloatArray, FloatArray, FloatArray], FloatArray]:
    """The dominant modes of a decaying part, and the static response (p, m) of all others."""
    T, Z, s = _schur(A) if len(A) else (A, A, np.zeros(0, dtype=complex))
    if not len(A):
        return (A, B, C), np.zeros((len(C), B.shape[1]))
    values, left, right = scipy.linalg.eig(A, left=True)
    products = np.sum(left.conj() * right, axis=0)
    size = np.linalg.norm(C @ right, axis=0) * np.linalg.norm(left.conj().T @ B, axis=1)
    size = size / (np.abs(products) * np.abs(values.real))
    select, count = np.zeros(len(s), dtype=bool), 0
    for i in np.argsort(-size, kind="stable"):
        near = np.flatnonzero(~select & (np.abs(s - values[i]) <= 1e-6 * np.abs(s)))
        near = np.concatenate(
            [near[:1], np.flatnonzero(~select & (np.abs(s - values[i].conj()) <= 1e-6 * np.abs(s)))[:1]]
        )
        near = np.unique(near) if values[i].imag else near[:1]
        if len(near) and count + len(near) <= wanted:
            select[near] = True
            count += len(near)
        if count == wanted:
            break
    pieces = _split(T, Z, B, C, select)
    A2, B2, C2 = pieces.second
    static = -C2 @ np.linalg.solve(A2, B2) if len(A2) else np.zeros((len(C), B.shape[1]))
    return pieces.first, static
