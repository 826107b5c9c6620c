"""Lateral equilibrium of a string under a given axial force in its hole: a small problem of four unknowns a node.

Manual: sec-statics-buckled-start.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np

from drillpetsc.arrays import FloatArray

WIDTH = 7  # diagonals above and below the main one: two nodes of four unknowns
SOFT_SHARE = 0.05  # penetration of the softest wall under the contact force of a helix, over the clearance
STIFFENING = 10.0  # factor of the wall's stiffness from one solve to the next
LEAST_CLEARANCE = 1e-3  # that limits steps [m]
LARGEST_MOVE = 0.5  # of a node across the hole in one step, as a share of the clearance
CONVERGED = 1e-6  # largest lateral motion of a converged step, as a share of the clearance
TURNING_SHARE = 0.2  # of the clearance, closer to the axis than which a node does not turn about it
ON_AXIS = 1e-12  # distance from the axis of the hole that is none [m]
MAX_INNER = 80
STALL = 30  # Newton steps without half the increment after which a solve ends
MAX_STEPS = 300
MAX_ITERATIONS = 2000  # of all Newton steps of a descent
GROWTH_MOVE = 0.1  # motion of a step, as a share of the clearance, below which a buckle grows slowly
SETTLED_MOVE = 0.3  # motion of a step from a stable state after which the shift is left out


@dataclass
class ContactPoints:
    """Points where the string may touch the wall, (m,) each unless said otherwise.

    cell: element; shape: (m, 4) factors of its lateral displacements and slopes u, u', at the upper and lower end.
    clearance [m]; length: that the point stands for [m]; friction: force about the axis over contact force [-].
    offset: (m, 2) place from the axis of the hole where all displacements vanish [m].
    """

    cell: np.ndarray
    shape: FloatArray
    clearance: FloatArray
    length: FloatArray
    friction: FloatArray
    offset: FloatArray


class LateralBeam:
    """Beam of n elements whose lateral displacements and slopes (n + 1, 4) = (u2, u3, u2', u3') are unknown.

    Its energy is that of bending, of a given axial force, of dead loads and of the wall.

    length, bending, force: (n,) of the elements: length [m], bending stiffness [N m2], tension [N].
    rigid: (n,) length of rigid items between the upper node and the element [m].
    load: (n+1, 4) forces [N] and moments [N m] that work on the unknowns.
    points: where it may touch the wall; wall(d, c): force [N/m] per length at depth d [m] where the clearance is c [m], and its derivative.
    held: (n+1, 4) mask of the unknowns that keep their values.
    clearance: (n+1,) of the nodes [m].
    """

    def __init__(
        self,
        length: FloatArray,
        bending: FloatArray,
        force: FloatArray,
        rigid: FloatArray,
        load: FloatArray,
        points: ContactPoints,
        wall: Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]],
        held: np.ndarray,
        clearance: FloatArray,
    ):
        order = np.argsort(points.cell, kind="stable")
        self.points = ContactPoints(*(getattr(points, f.name)[order] for f in fields(points)))
        self.wall, self.load, self.held = wall, load, held
        self.nodes = len(length) + 1
        self._elastic = element_matrices(length, bending, force, rigid)
        self._band = self._assembled(self._elastic)
        h = np.zeros(self.nodes)
        h[:-1] += 0.5 * length
        h[1:] += 0.5 * length
        self._weight = np.column_stack([h, h, h**3 / 100, h**3 / 100])
        push = np.maximum(-force, 0.0)
        #: above the most negative curvature of the energy of a long beam, F^2/4EI [N/m2]
        self.first_shift = 1.05 * float(np.max(push**2 / (4 * bending), initial=0.0))
        self.clearance = np.maximum(clearance, LEAST_CLEARANCE)
        self.turning = clearance > LEAST_CLEARANCE
        self.factor = 1.0  # of the wall's stiffness
        self.iterations = 0
        loads = np.hypot(load[:, 0], load[:, 1]) / np.maximum(h, 1e-9)
        helix = float(np.max(self.clearance[:-1] * push**2 / (4 * bending), initial=0.0))
        self.usual_force = max(helix, float(np.quantile(loads, 0.9)))  # on the wall [N/m]

    # ---------------------------------------------------------------- matrices
    def _assembled(self, plane: FloatArray) -> FloatArray:
        """Banded matrix (15, 4 nodes) of element matrices (n, 4, 4) of each plane."""
        n = self.nodes - 1
        band = np.zeros((2 * WIDTH + 1, 4 * self.nodes))
        for a in range(4):
            for b in range(4):
                for p in range(2):
                    r, c = 2 * a + p, 2 * b + p
                    band[WIDTH + r - c, c : c + 4 * n : 4] += plane[:, a, b]
        return band

    def _times(self, U: FloatArray) -> FloatArray:
        """Elastic rows (n+1, 4) of ``U``."""
        ends = np.concatenate([U[:-1].reshape(-1, 2, 2), U[1:].reshape(-1, 2, 2)], axis=1)  # (n, 4, plane)
        rows = np.einsum("eab,ebp->eap", self._elastic, ends).reshape(-1, 8)
        out = np.zeros_like(U)
        out[:-1] += rows[:, :4]
        out[1:] += rows[:, 4:]
        return out

    def place(self, U: FloatArray) -> FloatArray:
        """Lateral places (m, 2) of the contact points [m]."""
        e = self.points.cell
        ends = np.concatenate([U[e].reshape(-1, 2, 2), U[e + 1].reshape(-1, 2, 2)], axis=1)
        return self.points.offset + np.einsum("ma,map->mp", self.points.shape, ends)

    def rows(self, U: FloatArray, friction: float = 0.0) -> tuple[FloatArray, FloatArray]:
        """Rows (n+1, 4) of the equilibrium and the banded matrix."""
        q, n, elements = self.points, self.nodes, self.nodes - 1
        x = self.place(U)
        rho = np.hypot(x[:, 0], x[:, 1])
        force, slope = self.wall(rho - q.clearance, q.clearance)
        touching = np.flatnonzero(slope > 0)
        x, rho, e, shape = x[touching], rho[touching], q.cell[touching], q.shape[touching]
        on_axis = rho < ON_AXIS  # of a hole without clearance
        x[on_axis], rho[on_axis] = [ON_AXIS, 0.0], ON_AXIS
        N = self.factor * force[touching] * q.length[touching]
        dN = self.factor * slope[touching] * q.length[touching]
        N[on_axis] = 0.0
        mean = np.where(on_axis, dN, N / rho)
        mu = friction * q.friction[touching]
        out, inward = x.T / rho, np.stack([-x[:, 1], x[:, 0]]) / rho  # directions off the axis and about it
        band, rows = self._band.copy(), self._times(U) - self.load
        for p in range(2):
            f = N * (out[p] + mu * inward[p])
            for a in range(4):
                sums = np.bincount(e, shape[:, a] * f, elements)
                rows[a // 2 : a // 2 + elements, 2 * (a % 2) + p] += sums
            for r in range(2):
                K = dN * (out[p] + mu * inward[p]) * out[r] + mean * (inward[p] - mu * out[p]) * inward[r]
                for a in range(4):
                    left = shape[:, a] * K
                    for b in range(4):
                        i, j = 2 * a + p, 2 * b + r
                        sums = np.bincount(e, left * shape[:, b], elements)
                        band[WIDTH + i - j, j : j + 4 * elements : 4] += sums
        return rows.reshape(n, 4), band

    # ---------------------------------------------------------------- steps
    def _hold(self, band: FloatArray, rows: FloatArray) -> None:
        for k in np.flatnonzero(self.held.ravel()):
            lo, hi = max(0, k - WIDTH), min(band.shape[1], k + WIDTH + 1)
            for c in range(lo, hi):
                band[WIDTH + k - c, c] = 0.0
                band[WIDTH + c - k, k] = 0.0
            band[WIDTH, k] = 1.0
        rows[self.held] = 0.0

    def stable(self, U: FloatArray) -> bool:
        """Whether the matrix without friction is positive definite."""
        return self._definite(self.rows(U)[1], 0.0)

    def _definite(self, band: FloatArray, shift: float) -> bool:
        import scipy.linalg

        band = band.copy()
        band[WIDTH] += shift * self._weight.ravel()
        self._hold(band, np.zeros((self.nodes, 4)))
        try:
            scipy.linalg.cholesky_banded(band[WIDTH:], lower=True, check_finite=False)
        except np.linalg.LinAlgError:
            return False
        return True

    def _advance(self, U: FloatArray, p: FloatArray) -> FloatArray:
        """``U`` after the step ``p``; nodes near the wall turn about the axis of the hole."""
        out = U + p
        x, d = U[:, :2], p[:, :2]
        rho = np.hypot(x[:, 0], x[:, 1])
        turns = (rho > TURNING_SHARE * self.clearance) & self.turning
        n = x[turns] / rho[turns, None]
        b = np.column_stack([-n[:, 1], n[:, 0]])
        angle = np.sum(d[turns] * b, axis=1) / rho[turns]
        radial = rho[turns] + np.sum(d[turns] * n, axis=1)
        c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
        out[turns, :2] = radial[:, None] * (c * n + s * b)
        v = U[turns, 2:] + p[turns, 2:]
        w = v - np.column_stack([-U[turns, 3], U[turns, 2]]) * angle[:, None]
        out[turns, 2:] = c * w + s * np.column_stack([-w[:, 1], w[:, 0]])
        return out

    def _limit(self, U: FloatArray, p: FloatArray) -> float:
        size = np.hypot(p[:, 0], p[:, 1]) / self.clearance
        return min(1.0, LARGEST_MOVE / max(float(size.max(initial=0.0)), 1e-300))

    def soften(self) -> list[float]:
        """Factors of the wall's stiffness, rising to 1."""
        depth = SOFT_SHARE * float(self.clearance.min())
        softest = self.usual_force / max(float(self.wall(np.array([depth]), np.array([depth]))[0][0]), 1e-300)
        count = int(np.ceil(-np.log(softest) / np.log(STIFFENING))) if softest < 1 else 0
        return list(np.geomspace(softest, 1.0, count + 1)) if count else [1.0]

    def move(self, a: FloatArray, b: FloatArray) -> float:
        """Largest lateral motion from ``a`` to ``b``, as a share of the clearance."""
        d = b - a
        return float(np.max(np.hypot(d[:, 0], d[:, 1]) / self.clearance))

    def solve_step(
        self, start: FloatArray, U: FloatArray, shift: float, friction: float
    ) -> FloatArray | None:
        """Solve rows + shift M (U - start) = 0 from ``U`` by Newton's method; None where it does not converge."""
        import scipy.linalg

        best, since = np.inf, 0
        for _ in range(MAX_INNER):
            self.iterations += 1
            g, band = self.rows(U, friction)
            g = g + shift * self._weight * (U - start)
            band[WIDTH] += shift * self._weight.ravel()
            self._hold(band, g)
            p = scipy.linalg.solve_banded(
                (WIDTH, WIDTH), band, -g.ravel(), overwrite_ab=True, check_finite=False
            ).reshape(-1, 4)
            alpha = self._limit(U, p)
            U = self._advance(U, alpha * p)
            size = float(np.max(np.hypot(p[:, 0], p[:, 1]) / self.clearance))
            if not np.isfinite(size):
                return None
            if size < CONVERGED:
                return U
            since = 0 if size < 0.5 * best else since + 1
            best = min(best, size)
            if since > STALL:
                break
        return None


def element_matrices(
    length: FloatArray, bending: FloatArray, force: FloatArray, rigid: FloatArray
) -> FloatArray:
    """Element matrices (n, 4, 4) of one plane by (u, u') at the upper node and (u, u') at the lower one."""
    L = length
    one = np.ones_like(L)
    bend = (
        np.stack(
            [
                np.stack([12 * one, 6 * L, -12 * one, 6 * L], 1),
                np.stack([6 * L, 4 * L**2, -6 * L, 2 * L**2], 1),
                np.stack([-12 * one, -6 * L, 12 * one, -6 * L], 1),
                np.stack([6 * L, 2 * L**2, -6 * L, 4 * L**2], 1),
            ],
            1,
        )
        * (bending / L**3)[:, None, None]
    )
    tens = (
        np.stack(
            [
                np.stack([36 * one, 3 * L, -36 * one, 3 * L], 1),
                np.stack([3 * L, 4 * L**2, -3 * L, -(L**2)], 1),
                np.stack([-36 * one, -3 * L, 36 * one, -3 * L], 1),
                np.stack([3 * L, -(L**2), -3 * L, 4 * L**2], 1),
            ],
            1,
        )
        * (force / (30 * L))[:, None, None]
    )
    K = bend + tens
    move = np.broadcast_to(np.eye(4), K.shape).copy()
    move[:, 0, 1] = rigid
    K = np.einsum("eba,ebc,ecd->ead", move, K, move)
    K[:, 1, 1] += force * rigid  # the rigid part leans
    return K


@dataclass(frozen=True)
class LateralState:
    """Equilibrium of a ``LateralBeam``: displacements and slopes (n+1, 4).

    alone: without friction; with_friction: with friction about the axis, None where there is none, or none was asked for.
    disturbed: the string buckles, and the disturbance acts.
    """

    alone: FloatArray
    with_friction: FloatArray | None
    disturbed: bool


def lateral_state(
    beam: LateralBeam, start: FloatArray, disturbance: FloatArray, friction: bool
) -> LateralState | None:
    """Find a stable state of ``beam``; None where none is found.

    A straight string above its buckling load is a saddle of the energy, which the disturbance leads off.  The steps follow
    the fall of the energy, on a soft wall first: each solves for the equilibrium with a side spring to the last state, with
    which the energy is convex but for the wall's part.

    start: (n+1, 4) the string as it lies without buckling; disturbance: (n+1, 4) loads that lead it off a saddle, and stay.
    friction: the state with the friction of ``ContactPoints`` is asked for, too.
    """
    U = beam.solve_step(start, start, 0.0, 0.0)
    if U is None:
        U = _settle(beam, start)
    disturbed = U is None or not beam.stable(U)
    if disturbed:
        beam.load += disturbance
        U = _settle(beam, start)
        if U is None:
            return None
    assert U is not None
    turned = beam.solve_step(U, U, 0.0, 1.0) if friction else None
    if turned is not None and not beam.stable(turned):
        turned = None
    return LateralState(U, turned, disturbed)


def _settle(beam: LateralBeam, U: FloatArray) -> FloatArray | None:
    """Find a stable state from ``U`` while the wall becomes stiff; None where none is found."""
    beam.iterations = 0
    for factor in beam.soften():
        beam.factor = factor
        found = _descend(beam, U)
        if found is None:
            beam.factor = 1.0
            return None
        U = found
    return U


def _descend(beam: LateralBeam, U: FloatArray) -> FloatArray | None:
    """Follow the fall of the energy from ``U`` to a stable state; None where none is found."""
    shift = 0.0 if beam.stable(U) else beam.first_shift
    for _ in range(MAX_STEPS):
        if beam.iterations > MAX_ITERATIONS:
            return None
        V = beam.solve_step(U, U, shift, 0.0)
        if V is None:
            if shift > 1e4 * beam.first_shift:
                return None
            shift = max(4 * shift, 1e-3 * beam.first_shift)
            continue
        move, stable = beam.move(U, V), beam.stable(V)
        U = V
        if shift == 0.0 and stable:
            return U
        if stable:
            shift = 0.0 if move < SETTLED_MOVE or shift < 1e-3 * beam.first_shift else shift / 10
        else:
            # an unstable state is left as fast as the solves converge
            shift = max(0.5 * shift, beam.first_shift) if move > GROWTH_MOVE else 0.5 * shift
    return None
