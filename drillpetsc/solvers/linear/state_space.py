"""State-space form of a linearised system: x' = A x + B u, y = C x + D u + F u'.

Manual: sec-linear-elimination.  The equations are

    K q + C q' + M q'' + f0 I + f1 u + f2 u' = 0,  I' = u,
    y = Y0 q + Y1 q' + Y2 q'' + d0 I + d1 u + d2 u'.

Unknowns q are of second order, of first order, or algebraic.  Algebraic ones follow from their rows. If these rows do not
contain them (multipliers of constraints), the rows are constraints, and motions and equations are projected on the free
directions.  A constraint of rates (a motor that holds its speed) leaves all places free. It gives some of the rates by the
others, by places, first-order unknowns and inputs.  The rate u' leaves the state by x = z - E^-1 b u (manual: eq-linear-shift).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
import scipy.sparse as sparse

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import SolveError

RANK_TOLERANCE = 1e-9  # singular values below this fraction of the largest are zero
NOTHING = (
    1e-13  # entries below this fraction of the largest of an algebraic row, in usual units, are rounding
)
SMALL = 1e-6  # parts of a constraint below this fraction of its largest, in usual units, are rounding
EQUILIBRATIONS = 20  # scalings of rows and columns by the square roots of their largest entries (Ruiz 2001)
RELATIVE_ZERO = 1e-10  # couplings below this fraction of the largest of their row, in usual units, are none


@dataclass(frozen=True)
class Exchange:
    """How inputs act and what outputs read, in the unknowns q (n,).

    f0, f1, f2: (n, m) rows by the inputs' integrals, values and rates.
    Y0, Y1, Y2: (p, n) outputs by unknowns, their rates and accelerations.
    d0, d1, d2: (p, m) outputs by the inputs' integrals, values and rates.
    """

    f0: FloatArray
    f1: FloatArray
    f2: FloatArray
    Y0: FloatArray
    Y1: FloatArray
    Y2: FloatArray
    d0: FloatArray
    d1: FloatArray
    d2: FloatArray

    def of_unknowns(self, which: np.ndarray) -> Exchange:
        """The same for some of the unknowns."""
        rows = {k: getattr(self, k)[which] for k in ("f0", "f1", "f2")}
        columns = {k: getattr(self, k)[:, which] for k in ("Y0", "Y1", "Y2")}
        return replace(self, **rows, **columns)


@dataclass(frozen=True)
class Unknowns:
    """Unknowns q (n,) of a linearised system.

    second_order: (n,) whether the rate of the unknown is a state; scale: (n,) usual sizes; names: for the states.
    """

    second_order: np.ndarray
    scale: FloatArray
    names: list[str]


@dataclass(frozen=True)
class StateSpace:
    """x' = A x + B u, y = C x + D u + F u'.

    A: (n, n); B: (n, m); C: (p, n); D, F: (p, m) [SI].
    names: (n,) of the states.
    motions: (q, n) unknowns of the eliminated system by states; None after a reduction.
    """

    A: FloatArray
    B: FloatArray
    C: FloatArray
    D: FloatArray
    F: FloatArray
    names: tuple[str, ...] = ()
    motions: FloatArray | None = None

    @property
    def order(self) -> int:
        """Number of states."""
        return len(self.A)

    def response(self, frequency: FloatArray, rates: bool = True) -> np.ndarray:
        """Compute the response (k, p, m) at frequencies (k,) above 0 [Hz]; ``rates``: with F."""
        out = np.zeros((len(frequency), *self.D.shape), dtype=complex)
        if self.order:
            T, Z = scipy.linalg.rsf2csf(*scipy.linalg.schur(self.A, output="real"))
            B, C, diagonal = Z.conj().T @ self.B, self.C @ Z, np.diag_indices(self.order)
            for k, f in enumerate(frequency):
                shifted = -T
                shifted[diagonal] += 2j * np.pi * f
                out[k] = C @ scipy.linalg.solve_triangular(shifted, B)
        s = 2j * np.pi * np.asarray(frequency)[:, None, None]
        return out + self.D + (s * self.F if rates else 0.0)


def connected(K, C, M, scale: FloatArray, ex: Exchange) -> np.ndarray:
    """Select the unknowns (n,) that inputs act on and outputs read, directly or through others.

    scale: (n,) usual sizes of the unknowns.
    Couplings below ``RELATIVE_ZERO`` of the largest entry of a row of the same matrix are rounding.
    """
    n = len(scale)
    coupled = sparse.csr_matrix((n, n))
    for A in (K, C, M):
        size = abs(sparse.csr_matrix(A @ sparse.diags(scale)))
        largest = np.maximum(size.max(axis=1).toarray().ravel(), 1e-300)
        relative = sparse.csr_matrix(sparse.diags(1.0 / largest) @ size)
        relative.data[relative.data < RELATIVE_ZERO] = 0.0
        relative.eliminate_zeros()
        coupled = coupled + relative
    _, part = sparse.csgraph.connected_components(coupled, directed=False)
    driven = (ex.f0 != 0).any(axis=1) | (ex.f1 != 0).any(axis=1) | (ex.f2 != 0).any(axis=1)
    read = (ex.Y0 != 0).any(axis=0) | (ex.Y1 != 0).any(axis=0) | (ex.Y2 != 0).any(axis=0)
    return np.isin(part, np.intersect1d(part[driven], part[read]))


@dataclass(frozen=True)
class _Affine:
    """A quantity as z (k, n), z' (k, n), u and u' (k, m)."""

    z: FloatArray
    dz: FloatArray
    u: FloatArray
    du: FloatArray

    def __rmatmul__(self, A: FloatArray) -> _Affine:
        return _Affine(A @ self.z, A @ self.dz, A @ self.u, A @ self.du)

    __array_ufunc__ = None  # let ``matrix @ affine`` come here

    def __add__(self, other: _Affine) -> _Affine:
        return _Affine(self.z + other.z, self.dz + other.dz, self.u + other.u, self.du + other.du)

    def rate(self) -> _Affine:
        """Its rate in time, if it has no z' and no u'."""
        if self.dz.any() or self.du.any():
            raise SolveError("an output follows a second rate: it has no state-space model")
        return _Affine(self.dz, self.z, self.du, self.u)


@dataclass(frozen=True)
class _Parts:
    """Numbers of the unknowns and of the equations by their kind.

    S, F, L: unknowns of second order, of first order, and algebraic ones.
    rd, ra: equations that contain accelerations or rates of first-order unknowns, and the others, algebraic ones.
    """

    S: np.ndarray
    F: np.ndarray
    L: np.ndarray
    rd: np.ndarray
    ra: np.ndarray


def _parts(C: FloatArray, M: FloatArray, second_order: np.ndarray) -> _Parts:
    """Find the kinds of unknowns and equations from the entries of C and M (n, n)."""
    stored = C != 0
    F = np.flatnonzero(~second_order & stored.any(axis=0))
    L = np.flatnonzero(~second_order & ~stored.any(axis=0))
    dynamic = M.any(axis=1) | stored[:, F].any(axis=1)
    return _Parts(np.flatnonzero(second_order), F, L, np.flatnonzero(dynamic), np.flatnonzero(~dynamic))


def _row_sizes(K, C, M, scale: FloatArray, rate: float) -> FloatArray:
    """Largest entry (n,) of each row in usual units; raises SolveError for an empty row."""
    weights = [scale * f for f in (1.0, rate, rate**2)]
    size = np.max(
        [np.abs(A * w).max(axis=1, initial=0.0) for A, w in zip((K, C, M), weights, strict=True)], axis=0
    )
    if (size == 0).any():
        raise SolveError("a row of the linearised system is empty")
    return np.asarray(size)


def eliminate(K, C, M, unknowns: Unknowns, rate: float, ex: Exchange) -> StateSpace:
    """Form the state space; algebraic unknowns and constraints are eliminated (manual: sec-linear-elimination).

    K, C, M: (n, n) sparse.
    rate: usual rate [1/s].
    Raises SolveError if the equations have no state-space form.
    """
    scale = unknowns.scale
    K, C, M = (np.asarray(sparse.csr_matrix(A).todense()) for A in (K, C, M))
    size = _row_sizes(K, C, M, scale, rate)
    K, C, M = (np.asarray(A / size[:, None]) for A in (K, C, M))
    f0, f1, f2 = (f / size[:, None] for f in (ex.f0, ex.f1, ex.f2))

    parts = _parts(C, M, unknowns.second_order)
    S, F, L, rd, ra = parts.S, parts.F, parts.L, parts.rd, parts.ra
    free = _constraints(K, C, parts, scale, rate, (f0, f1, f2))
    motions, left, stores = free.motions, free.left, free.stores
    m, nP, nF, nV = f0.shape[1], motions.shape[1], stores.shape[1], free.rates.shape[1]
    held = np.flatnonzero((ex.f0 != 0).any(axis=0) | (ex.d0 != 0).any(axis=0))  # inputs whose integral acts
    n = nP + nV + nF + len(held)
    zero = np.zeros

    def state(start: int, count: int) -> FloatArray:
        out = zero((count, n))
        out[:, start : start + count] = np.eye(count)
        return out

    def affine(z: FloatArray) -> _Affine:
        return _Affine(z, zero(z.shape), zero((len(z), m)), zero((len(z), m)))

    integral = zero((m, n))
    integral[held] = state(nP + nV + nF, len(held))
    inputs = affine(integral)
    value = _Affine(zero((m, n)), zero((m, n)), np.eye(m), zero((m, m)))
    slope = _Affine(zero((m, n)), zero((m, n)), zero((m, m)), np.eye(m))
    p = affine(state(0, nP))
    f = affine(stores @ state(nP + nV, nF)) + (free.by_place @ p)
    f = f + (free.by_integral @ inputs) + (free.by_value @ value)
    w = affine(free.rates @ state(nP, nV)) + (free.rates_by_place @ p) + (free.rates_by_store @ f)
    w = w + (free.rates_by_integral @ inputs) + (free.rates_by_value @ value)
    q_s, v_s = motions @ p, motions @ w
    a_s = v_s.rate()
    forcing = (f0 @ inputs) + (f1 @ value) + (f2 @ slope)

    def rows(which: np.ndarray) -> _Affine:
        """Rows of the equations without algebraic unknowns."""
        at_s, at_f = np.ix_(which, S), np.ix_(which, F)
        pick = np.eye(len(K))[which]
        total = (K[at_s] @ q_s) + (C[at_s] @ v_s) + (M[at_s] @ a_s)
        return total + (K[at_f] @ f) + (C[at_f] @ f.rate()) + (pick @ forcing)

    Z = free.multipliers
    l_known = free.resolved @ (free.solved_rows @ rows(ra))  # algebraic unknowns, without multipliers
    of_rows = rows(rd) + (K[np.ix_(rd, L)] @ l_known)
    kept = left.T @ of_rows
    E = np.vstack([np.hstack([np.eye(nP), zero((nP, n - nP))]), kept.dz, zero((len(held), n))])
    Az = np.vstack([w.z, -kept.z, zero((len(held), n))])
    Bv = np.vstack([w.u, -kept.u, np.eye(m)[held]])
    Bd = np.vstack([zero((nP, m)), -kept.du, zero((len(held), m))])
    E[n - len(held) :, n - len(held) :] = np.eye(len(held))
    A, B, G = _solved(E, _usual_sizes(free, scale[S], scale[F], rate, len(held)), Az, Bv, Bd)
    l_all = l_known
    if Z.shape[1]:
        H = K[np.ix_(rd, L)] @ Z
        l_all = l_known + (-(Z @ np.linalg.pinv(H)) @ of_rows)
    y = (ex.Y0[:, S] @ q_s) + (ex.Y1[:, S] @ v_s) + (ex.Y2[:, S] @ a_s)
    y = y + (ex.Y0[:, F] @ f) + (ex.Y1[:, F] @ f.rate()) + (ex.Y0[:, L] @ l_all)
    if ex.Y1[:, L].any():
        y = y + (ex.Y1[:, L] @ l_all.rate())
    y = y + (ex.d0 @ inputs) + (ex.d1 @ value) + (ex.d2 @ slope)
    # z' = A z + B u + G u'; z = x + G u
    B = B + A @ G
    Cz = y.z + y.dz @ A
    D = y.u + y.dz @ B + y.z @ G
    feed = y.du + y.dz @ G
    every = zero((len(K), n))
    every[S], every[F], every[L] = q_s.z, f.z, l_all.z
    return StateSpace(A, B, Cz, D, feed, _state_names(unknowns.names, free, S, F, held), every)


@dataclass(frozen=True)
class _Free:
    """Directions left free by algebraic rows.

    motions: (S, k) second-order unknowns by free ones; stores: (F, l) first-order unknowns by free ones, to which
    by_place (F, k) adds what the motions, by_integral and by_value (F, m) what inputs prescribe.
    rates: (k, v) rates of the free motions by free ones, to which rates_by_place (k, k), rates_by_store (k, F),
    rates_by_integral and rates_by_value (k, m) add what constraints of rates prescribe.
    left: (rows, v + l) combinations of the dynamic rows without multipliers; multipliers: (L, c) their basis.
    resolved: (L, r) algebraic unknowns by the combinations solved_rows (r, rows) of algebraic rows.
    """

    motions: FloatArray
    stores: FloatArray
    by_place: FloatArray
    by_integral: FloatArray
    by_value: FloatArray
    rates: FloatArray
    rates_by_place: FloatArray
    rates_by_store: FloatArray
    rates_by_integral: FloatArray
    rates_by_value: FloatArray
    left: FloatArray
    multipliers: FloatArray
    resolved: FloatArray
    solved_rows: FloatArray


def _constraints(K, C, parts: _Parts, scale, rate, forcing) -> _Free:
    """Split the algebraic rows into those that determine algebraic unknowns, and constraints of all others.

    forcing: rows (n, m) by integrals, values and rates of the inputs.  Raises SolveError if a constraint is one of
    motions that an input changes, of accelerations, or of rates that others hold already.
    """
    S, F, L, rd, ra = parts.S, parts.F, parts.L, parts.rd, parts.ra
    m = forcing[0].shape[1]
    A = K[np.ix_(ra, L)] * scale[L]  # the largest entry of a whole row is 1
    A[np.abs(A) < NOTHING] = 0.0
    U, s, Vt = np.linalg.svd(A) if A.size else (np.eye(len(ra)), np.zeros(0), np.eye(len(L)))
    rank = int((s > RANK_TOLERANCE * s.max()).sum()) if s.max(initial=0.0) > 0 else 0
    resolved = -(scale[L][:, None] * Vt[:rank].T) / s[:rank]
    Y, Z = U[:, rank:], scale[L][:, None] * Vt[rank:].T
    motions, stores, left = np.eye(len(S)), np.eye(len(F)), np.eye(len(rd))
    by_integral, by_value = np.zeros((len(F), m)), np.zeros((len(F), m))
    turning, by_place = np.zeros((0, len(ra))), np.zeros((len(F), 0))
    if Y.shape[1]:
        Y, turning = _of_rates(Y, K, C, parts, scale, rate)
        by_motion, by_store = Y.T @ K[np.ix_(ra, S)] * scale[S], Y.T @ K[np.ix_(ra, F)] * scale[F]
        h0, h1, h2 = (Y.T @ f[ra] for f in forcing)
        size = max(np.abs(by_motion).max(initial=0.0), np.abs(by_store).max(initial=0.0))
        of_stores, of_motions = _split(by_store, SMALL * size)
        refused = [h2, of_motions.T @ h0, of_motions.T @ h1]
        if any(np.abs(o).max(initial=0.0) > SMALL * size for o in refused):
            raise SolveError(
                "the state-space form does not support constraints on motions that an input changes"
            )
        motions = _null_space(of_motions.T @ by_motion, scale[S])
        if of_stores.shape[1]:
            G = of_stores.T @ by_store
            stores = _null_space(G, scale[F])
            inverse = -scale[F][:, None] * np.linalg.pinv(G)
            by_integral, by_value = inverse @ of_stores.T @ h0, inverse @ of_stores.T @ h1
            by_place = inverse @ of_stores.T @ Y.T @ K[np.ix_(ra, S)] @ motions
    if Z.shape[1]:
        left = scipy.linalg.null_space((K[np.ix_(rd, L)] @ Z).T)
    if not by_place.shape[1]:
        by_place = np.zeros((len(F), motions.shape[1]))
    units = np.abs(motions.T) @ scale[S]
    G = turning @ C[np.ix_(ra, S)] @ motions * units
    if len(G) and np.linalg.matrix_rank(G) < len(G):
        raise SolveError("the state-space form does not support redundant constraints of rates")
    inverse = -units[:, None] * np.linalg.pinv(G)
    of_place, of_store = K[np.ix_(ra, S)] @ motions, K[np.ix_(ra, F)]
    r0, r1, r2, r3 = (inverse @ turning @ q for q in (of_place, of_store, forcing[0][ra], forcing[1][ra]))
    free = _null_space(G, units)
    known = (left, Z, resolved, U[:, :rank].T)
    return _Free(motions, stores, by_place, by_integral, by_value, free, r0, r1, r2, r3, *known)


def _of_rates(Y, K, C, parts: _Parts, scale, rate) -> tuple[FloatArray, FloatArray]:
    """Split combinations Y (rows, k) of the algebraic rows into combinations without rates (rows, l) and with rates (r, rows)."""
    S, F, ra = parts.S, parts.F, parts.ra
    by_rate = Y.T @ C[np.ix_(ra, S)] * scale[S] * rate
    others = [np.abs(Y.T @ K[np.ix_(ra, q)] * scale[q]).max(initial=0.0) for q in (S, F)]
    of_rates, of_others = _split(by_rate, SMALL * max(np.abs(by_rate).max(initial=0.0), *others))
    return Y @ of_others, (Y @ of_rates).T


def _split(A: FloatArray, size: float) -> tuple[FloatArray, FloatArray]:
    """Combinations of the rows of A (n, m) that are larger than ``size``, (n, r), and the others, (n, n - r)."""
    U, s, _ = np.linalg.svd(A) if A.size else (np.eye(len(A)), np.zeros(0), None)
    rank = int((s > size).sum())
    return U[:, :rank], U[:, rank:]


def _null_space(G: FloatArray, scale: FloatArray) -> FloatArray:
    """Basis (n, k) of the unknowns with G u/scale = 0; unknowns that G does not touch stay single."""
    n = len(scale)
    touched = np.abs(G).max(axis=0, initial=0.0) > RELATIVE_ZERO * np.abs(G).max(initial=0.0)
    if not touched.any():
        return np.eye(n)
    basis = scale[touched][:, None] * scipy.linalg.null_space(G[:, touched])
    single = np.eye(n)[:, ~touched]
    out = np.zeros((n, single.shape[1] + basis.shape[1]))
    out[:, : single.shape[1]] = single
    out[np.flatnonzero(touched), single.shape[1] :] = basis
    return out


def _solved(E, units, *right: FloatArray) -> list[FloatArray]:
    """Solve E X = R for each R in usual units of the states; raises SolveError if E is singular."""
    n = len(E)
    if not n:
        return [np.zeros_like(R) for R in right]
    # rows and columns of size one: otherwise light unknowns look like missing ones next to heavy ones
    scaled, rows, columns = E * units, np.ones(n), units.copy()
    for _ in range(EQUILIBRATIONS):
        by_row = np.sqrt(np.maximum(np.abs(scaled).max(axis=1), 1e-300))
        by_column = np.sqrt(np.maximum(np.abs(scaled).max(axis=0), 1e-300))
        scaled, rows, columns = scaled / by_row[:, None] / by_column, rows * by_row, columns / by_column
    anorm = np.abs(scaled).sum(axis=0).max()
    lu, pivots = scipy.linalg.lu_factor(scaled, check_finite=False)
    rcond, _ = scipy.linalg.lapack.dgecon(lu, anorm)
    if not rcond > 1e-15:
        raise SolveError(
            "an unknown of the linearised system has no inertia and no storage: there is no state-space form"
        )
    return [columns[:, None] * scipy.linalg.lu_solve((lu, pivots), R / rows[:, None]) for R in right]


def _usual_sizes(
    free: _Free, of_motions: FloatArray, of_stores: FloatArray, rate: float, integrals: int
) -> FloatArray:
    """Usual sizes (n,) of the states: a rate is ``rate`` [1/s] times the size of its motion.

    of_motions, of_stores: of the second-order and the first-order unknowns; integrals: number of held inputs.
    """
    places = np.abs(free.motions.T) @ of_motions if len(of_motions) else np.zeros(0)
    rates = rate * (np.abs(free.rates.T) @ places)
    stores = np.abs(free.stores.T) @ of_stores if len(of_stores) else np.zeros(0)
    return np.concatenate([places, rates, stores, np.ones(integrals) / rate])


def _state_names(names: list[str], free: _Free, S, F, held) -> tuple[str, ...]:
    """Names of the states: of single unknowns, or of combinations that constraints leave free."""

    def named(basis: FloatArray, of: list[str], word: str) -> list[str]:
        out = []
        for k, column in enumerate(basis.T):
            at = np.flatnonzero(column)
            out.append(of[at[0]] if len(at) == 1 else f"{word} {k}")
        return out

    of_motions = named(free.motions, [names[i] for i in S], "motion within joints")
    integrals = [f"integral of input {j + 1}" for j in held]
    rates = named(free.rates, [f"rate of {n}" for n in of_motions], "rate within joints")
    return (*of_motions, *rates, *named(free.stores, [names[i] for i in F], "combination"), *integrals)
