"""Lateral equilibrium of a string under a given axial force in its hole: a small problem of four unknowns a node.

Manual: sec-statics-lateral-start.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields

import numpy as np

from drillpetsc.arrays import FloatArray, halves_at_nodes
from drillpetsc.solvers.static.search_limit import SearchLimit

WIDTH = 7  # diagonals above and below the main one: two nodes of four unknowns
SOFT_SHARE = 0.05  # penetration of the softest wall under the contact force of a helix, over the clearance
STIFFENING = 10.0  # factor of the wall's stiffness from one solve to the next
LEAST_CLEARANCE = 1e-3  # that limits steps [m]
LARGEST_MOVE = 0.5
CONVERGED = 1e-6  # largest lateral motion of a converged step, as a share of the clearance
TURNING_SHARE = 0.2  # of the clearance, closer to the axis than which a node does not turn about it
ON_AXIS = 1e-12  # distance from the axis of the hole that is none [m]
JOINT = 1e-9  # length of an element below which it is a joint [m]
TIE = 1e3  # stiffness of a joint, over that of the stiffest element
MAX_INNER = 80
STALL, SHIFTED_STALL = (
    30,
    12,
)  # Newton steps without half the increment after which a solve ends: full, shifted steps
ROUGH = 1e-3  # as CONVERGED, of a shifted step, from which the next one starts
MAX_CUTS, MOST_OVERSHOOT = 6, 0.8  # of a step whose slope rises beyond this share of the slope at its start
WAY = 1e-4  # share of a step over which its direction is differenced
MAX_STEPS = 1000
MAX_ITERATIONS = 2000, 6000  # of all Newton steps of a descent: on any mesh, on a small one
MAX_WORK = 1e7  # nodes times Newton steps of a descent, between these numbers of steps
SHARE_OF_SEARCH = 0.25  # of a Newton step, over a factorisation of the whole string
MAX_UNDISTURBED = 300  # the same of a string without side loads, which may be at a saddle
SHIFT_SCALE = 1.1  # accuracy of the side spring with which the energy is convex
SHIFT_MARGIN = 1.01  # of the side spring over the one with which the energy is convex
LEAST_SHIFT = 1e-4  # of a side spring that is tried after none, over the first
STANDSTILL = 1e-6  # motion of a step, as a share of the clearance, that leaves a saddle where it is
SETTLED_MOVE = 0.03  # motion of a quick step from a convex state after which the shift is left out
QUICK = 8  # Newton steps of a solve that converges fast
#: over EI/L^3 and T/30L; rows and columns: deflection and slope times L at both ends
_BENDING = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])
_TENSION = np.array([[36, 3, -36, 3], [3, 4, -3, -1], [-36, -3, 36, -3], [3, -1, -3, 4]])


@dataclass
class ContactPoints:
    """Points where the string may touch the wall, (m,) each unless said otherwise.

    cell: element; shape: (m, 4) factors of its lateral displacements and slopes u, u', at the upper and lower end.
    clearance [m]; length: that the point stands for [m].
    offset: (m, 2) place from the axis of the hole where all displacements vanish [m].
    at: depth along the string [m].
    """

    cell: np.ndarray
    shape: FloatArray
    clearance: FloatArray
    length: FloatArray
    offset: FloatArray
    at: FloatArray


@dataclass(frozen=True)
class Elements:
    """Elements of a beam, (n,) each.

    length [m]; bending: stiffness [N m2]; force: tension [N]; rigid: length of rigid items between the upper node and the element [m].
    hinged: the slopes at both ends of an element without length are free of each other; None: of none.  An element
    without length is a joint, which ties the displacements of its nodes, and their slopes else.
    """

    length: FloatArray
    bending: FloatArray
    force: FloatArray
    rigid: FloatArray
    hinged: np.ndarray | None = None


class LateralBeam:
    """Beam of n elements whose lateral displacements and slopes (n + 1, 4) = (u2, u3, u2', u3') are unknown.

    Its energy is that of bending, of a given axial force, of dead loads and of the wall.

    elements: see there.
    load: (n+1, 4) forces [N] and moments [N m] that work on the unknowns.
    points: where it may touch the wall; wall(d, c): force [N/m] per length at depth d [m] where the clearance is c [m], and its derivative.
    held: (n+1, 4) mask of the unknowns that keep their values.
    clearance: (n+1,) of the nodes [m].
    """

    def __init__(
        self,
        elements: Elements,
        load: FloatArray,
        points: ContactPoints,
        wall: Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]],
        held: np.ndarray,
        clearance: FloatArray,
    ):
        length, bending = elements.length, elements.bending
        order = np.argsort(points.cell, kind="stable")
        self.points = ContactPoints(*(getattr(points, f.name)[order] for f in fields(points)))
        self.wall, self.load, self.held = wall, load, held
        self.nodes = len(length) + 1
        self._elastic = _with_ties(elements)
        self._band = self._assembled(self._elastic)
        h = halves_at_nodes(length)
        self._weight = np.column_stack([h, h, h**3 / 100, h**3 / 100])
        push = np.maximum(-elements.force, 0.0)
        #: above the most negative curvature of the energy of a long beam, F^2/4EI [N/m2]
        pull = np.divide(
            push**2, 4 * bending, out=np.zeros_like(push), where=(bending > 0) & (length > JOINT)
        )
        self.first_shift = 1.05 * float(np.max(pull, initial=0.0))
        self.clearance = np.maximum(clearance, LEAST_CLEARANCE)
        self.turning = clearance > LEAST_CLEARANCE
        self.factor = 1.0  # of the wall's stiffness
        self.iterations = 0
        self.limit = SearchLimit()  # of the work of a search
        loads = np.hypot(load[:, 0], load[:, 1]) / np.maximum(h, 1e-9)
        helix = float(np.max(self.clearance[:-1] * pull, initial=0.0))
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

    def rows(self, U: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Rows (n+1, 4) of the equilibrium and the banded matrix."""
        q, n, elements = self.points, self.nodes, self.nodes - 1
        x = self.place(U)
        rho = np.hypot(x[:, 0], x[:, 1])
        force, slope = self.wall(rho - q.clearance, q.clearance)
        touching = np.flatnonzero(slope > 0)
        x, rho, e, shape = x[touching], rho[touching], q.cell[touching], q.shape[touching]
        on_axis = rho < ON_AXIS  # of a hole without clearance
        x[on_axis], rho[on_axis] = [ON_AXIS, 0.0], ON_AXIS
        factor = self._factor_at_points()[touching]
        N = factor * force[touching] * q.length[touching]
        dN = factor * slope[touching] * q.length[touching]
        N[on_axis] = 0.0
        mean = np.where(on_axis, dN, N / rho)
        out, inward = x.T / rho, np.stack([-x[:, 1], x[:, 0]]) / rho  # directions off the axis and about it
        band, rows = self._band.copy(), self._times(U) - self.load
        for p in range(2):
            f = N * out[p]
            for a in range(4):
                sums = np.bincount(e, shape[:, a] * f, elements)
                rows[a // 2 : a // 2 + elements, 2 * (a % 2) + p] += sums
            for r in range(2):
                K = dN * out[p] * out[r] + mean * inward[p] * inward[r]
                for a in range(4):
                    left = shape[:, a] * K
                    for b in range(4):
                        i, j = 2 * a + p, 2 * b + r
                        sums = np.bincount(e, left * shape[:, b], elements)
                        band[WIDTH + i - j, j : j + 4 * elements : 4] += sums
        return rows.reshape(n, 4), band

    def contact_force(self, U: FloatArray) -> FloatArray:
        """Contact force (m,) [N] at the points."""
        q, x = self.points, self.place(U)
        force = self.wall(np.hypot(x[:, 0], x[:, 1]) - q.clearance, q.clearance)[0]
        return self._factor_at_points() * force * q.length

    def _factor_at_points(self) -> FloatArray:
        """Factor (m,) of the wall's stiffness at the points.

        What has no clearance is held everywhere, and has no boundary of contact that a soft wall would help to find: a bit
        below a joint would leave the hole on it.
        """
        return np.where(self.points.clearance > 0, self.factor, 1.0)

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
        """Whether the matrix is positive definite."""
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

    def least_shift(self, U: FloatArray, last: float) -> float:
        """Smallest side spring [N/m2] with which the energy at ``U`` is convex, at most ``SHIFT_SCALE`` of it above; 0 if it is.

        last: a guess.
        """
        band = self.rows(U)[1]
        if self._definite(band, 0.0):
            return 0.0
        high, low = last, last
        while not self._definite(band, high) and high < 1e6 * self.first_shift:
            low, high = high, 2 * high
        while low == high and high > 1e-8 * self.first_shift:
            low = 0.5 * high
            if self._definite(band, low):
                high = low
        while high > SHIFT_SCALE * low > 0:
            middle = float(np.sqrt(low * high))
            low, high = (low, middle) if self._definite(band, middle) else (middle, high)
        return high

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

    def _way(self, U: FloatArray, p: FloatArray, alpha: float) -> FloatArray:
        """Direction (n+1, 4) of the way that ``_advance`` takes from ``U`` along ``p``, at ``alpha``."""
        return (self._advance(U, (alpha + WAY) * p) - self._advance(U, (alpha - WAY) * p)) / (2 * WAY)

    def soften(self) -> list[float]:
        """Factors of the wall's stiffness, rising to 1."""
        depth = SOFT_SHARE * float(self.clearance.min())
        softest = self.usual_force / max(float(self.wall(np.array([depth]), np.array([depth]))[0][0]), 1e-300)
        count = int(np.ceil(-np.log(softest) / np.log(STIFFENING))) if 0 < softest < 1 else 0
        return list(np.geomspace(softest, 1.0, count + 1)) if count else [1.0]

    def size(self, p: FloatArray) -> float:
        """Largest lateral motion in a step ``p`` (n+1, 4), as a share of the clearance."""
        return float(np.max(np.hypot(p[:, 0], p[:, 1]) / self.clearance))

    def solve_step(
        self, start: FloatArray, U: FloatArray, shift: float, plain: bool = False
    ) -> FloatArray | None:
        """Solve rows + shift M (U - start) = 0 from ``U`` by Newton's method; None if it does not converge.

        The energy falls in each step, unless ``plain`` chooses Newton's own steps, which converge to a saddle, too.
        """
        import scipy.linalg

        best, since, extra = np.inf, 0, 0.0
        g, band = self._shifted_rows(start, U, shift)
        for _ in range(MAX_INNER):
            self.iterations += 1
            self.limit.count(SHARE_OF_SEARCH)
            if plain:
                try:
                    p = scipy.linalg.solve_banded((WIDTH, WIDTH), band, -g.ravel(), check_finite=False)
                except np.linalg.LinAlgError:  # nothing holds a motion across the hole
                    return None
                p = p.reshape(-1, 4)
            else:
                p, extra = self._fall(band, g, extra)
            size = self.size(p)
            if not np.isfinite(size):
                return None
            alpha, slope0, before = min(1.0, LARGEST_MOVE / max(size, 1e-300)), float(np.sum(g * p)), U
            for _ in range(MAX_CUTS):
                U = self._advance(before, alpha * p)
                g, band = self._shifted_rows(start, U, shift)
                slope = float(np.sum(g * self._way(before, p, alpha)))
                if slope0 >= 0 or (size < CONVERGED) or slope <= MOST_OVERSHOOT * abs(slope0):
                    break
                alpha *= min(0.7, max(0.1, slope0 / (slope0 - slope)))
            if size < (ROUGH if shift else CONVERGED) and not extra:
                return U
            since = 0 if size < 0.5 * best else since + 1
            best = min(best, size)
            if since > (SHIFTED_STALL if shift else STALL):
                break
        return None

    def _fall(self, band: FloatArray, g: FloatArray, extra: float) -> tuple[FloatArray, float]:
        """Step (n+1, 4) along which the energy with the matrix ``band`` and the gradient ``g`` falls, and its side spring.

        extra: side spring [N/m2] of the last step.
        """
        import scipy.linalg

        weight, extra = np.where(self.held, 0.0, self._weight).ravel(), extra / 8
        if extra < 1e-6 * self.first_shift:
            extra = 0.0
        for _ in range(40):
            lower = band[WIDTH:].copy()
            lower[0] += extra * weight
            try:
                factor = scipy.linalg.cholesky_banded(
                    lower, lower=True, check_finite=False, overwrite_ab=True
                )
            except np.linalg.LinAlgError:
                extra = max(4 * extra, 1e-5 * self.first_shift)
                continue
            p = scipy.linalg.cho_solve_banded((factor, True), -g.ravel(), check_finite=False)
            return p.reshape(-1, 4), extra
        return np.full(g.shape, np.nan), 0.0

    def _shifted_rows(self, start: FloatArray, U: FloatArray, shift: float) -> tuple[FloatArray, FloatArray]:
        """Rows (n+1, 4) and banded matrix at ``U`` with a side spring to ``start``, and the held unknowns' own rows."""
        g, band = self.rows(U)
        g = g + shift * self._weight * (U - start)
        band[WIDTH] += shift * self._weight.ravel()
        self._hold(band, g)
        return g, band


def _with_ties(elements: Elements) -> FloatArray:
    """Element matrices (n, 4, 4) of each plane; joints are stiff springs between their nodes."""
    length, bending, force, rigid = elements.length, elements.bending, elements.force, elements.rigid
    joint, hinged = length <= JOINT, elements.hinged
    L = np.where(joint, 1.0, length)
    EI, T = np.where(joint, 0.0, bending), np.where(joint, 0.0, force)
    K = element_matrices(L, EI, T, rigid)
    tie, turn = TIE * float(np.max(12 * EI / L**3)), TIE * float(np.max(4 * EI / L))
    for e in np.flatnonzero(joint):
        apart = np.array([1.0, rigid[e], -1.0, 0.0])
        K[e] = tie * np.outer(apart, apart)
        if hinged is None or not hinged[e]:
            apart = np.array([0.0, 1.0, 0.0, -1.0])
            K[e] += turn * np.outer(apart, apart)
        K[e, 1, 1] += force[e] * rigid[e]  # the rigid part leans
    return K


def element_matrices(
    length: FloatArray, bending: FloatArray, force: FloatArray, rigid: FloatArray
) -> FloatArray:
    """Element matrices (n, 4, 4) of one plane by (u, u') at the upper node and (u, u') at the lower one."""
    one = np.ones_like(length)
    scale = np.stack([one, length, one, length], axis=1)
    K = (bending / length**3)[:, None, None] * _BENDING + (force / (30 * length))[:, None, None] * _TENSION
    K *= scale[:, :, None] * scale[:, None, :]
    move = np.broadcast_to(np.eye(4), K.shape).copy()
    move[:, 0, 1] = rigid
    K = np.einsum("eba,ebc,ecd->ead", move, K, move)
    K[:, 1, 1] += force * rigid  # the rigid part leans
    return K


@dataclass(frozen=True)
class LateralState:
    """Equilibrium of a ``LateralBeam``.

    place: displacements and slopes (n+1, 4); disturbed: the string buckles, and the disturbance acts.
    """

    place: FloatArray
    disturbed: bool


def lateral_state(
    beam: LateralBeam, start: FloatArray, disturbance: FloatArray, disturbed: bool = False
) -> LateralState | None:
    """Find a stable state of ``beam``; None if none is found.

    A straight string above its buckling load is a saddle of the energy, which the disturbance leads off.  The steps follow
    the fall of the energy, on a soft wall first: each solves for the equilibrium with a side spring to the last state, with
    which the energy is convex but for the wall's part.

    disturbed: ``start`` is a buckled state under the disturbance, of almost the same loads.
    start: (n+1, 4) otherwise the string as it lies without buckling; disturbance: (n+1, 4) loads that lead it off a saddle, and stay.
    """
    if disturbed:
        beam.load += disturbance
    U = beam.solve_step(start, start, 0.0, plain=True)
    if disturbed:
        if U is None or not beam.stable(U):
            U = _settle(beam, start)
    else:
        if U is None:
            U = _settle(beam, start, MAX_UNDISTURBED)
        disturbed = U is None or not beam.stable(U)
        if disturbed:
            beam.load += disturbance
            U = _settle(beam, start)
    return None if U is None else LateralState(U, disturbed)


def _settle(beam: LateralBeam, U: FloatArray, most: int | None = None) -> FloatArray | None:
    """Find a stable state from ``U`` while the wall becomes stiff; None if none is found."""
    beam.iterations = 0
    if most is None:
        most = int(min(max(MAX_WORK / beam.nodes, MAX_ITERATIONS[0]), MAX_ITERATIONS[1]))
    found: FloatArray | None = U
    for factor in beam.soften():
        beam.factor = factor
        found = None if found is None else _descend(beam, found, most)
    return found


def _descend(beam: LateralBeam, U: FloatArray, most: int) -> FloatArray | None:
    """Follow the fall of the energy from ``U`` to a stable state; None if none is found.

    The side spring makes the energy convex where each step starts, and is weakened while the steps converge fast; one with
    which a step failed is not tried again at once.  most: Newton steps.
    """
    least, floor, first, failed = beam.least_shift(U, beam.first_shift), 0.0, beam.first_shift, 0.0
    for _ in range(MAX_STEPS):
        shift, before = max(SHIFT_MARGIN * least, floor), beam.iterations
        V = beam.solve_step(U, U, shift)
        taken = beam.iterations - before
        if beam.iterations > most:
            return None
        convex = 0.0 if V is None else beam.least_shift(V, max(least, LEAST_SHIFT * first))
        if V is None or (convex and not shift):  # a full step ended at a saddle
            if (
                shift >= 1e4 * first
            ):  # at once if no element is in compression: no side spring follows from that
                return None
            floor = failed = max(4 * shift, LEAST_SHIFT * first)
            continue
        move, U, least = beam.size(V - U), V, convex
        if not shift:
            return U
        if least and move < STANDSTILL:
            return None  # nothing leads off this saddle
        floor *= 0.1 if taken <= 3 else 0.5 if taken <= QUICK else 1.0
        failed *= 0.5
        small = floor < LEAST_SHIFT * first and failed < 0.1 * LEAST_SHIFT * first
        settled = not least and move < SETTLED_MOVE and taken <= QUICK
        floor = 0.0 if small or settled else max(floor, failed)
    return None
