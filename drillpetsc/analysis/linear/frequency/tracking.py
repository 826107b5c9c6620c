"""Modes that belong together at successive rotary speeds, by the assurance criterion (manual: sec-campbell-tracking)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import linear_sum_assignment

from drillpetsc.analysis.linear.frequency.beside_lines import Band
from drillpetsc.arrays import FloatArray
from drillpetsc.solvers.linear.quadratic_eigenproblem import damping_ratio, growing

LEAST_MAC = 0.9  # below which two modes are not the same
CLUSTER = 2e-3  # relative distance of eigenvalues below which their shapes may be any of their span
OWN_SHAPE = 0.1  # weight of a mode's own shape beside that of its cluster
EDGE = 0.95  # share of the highest frequency up to which a mode that is missing is lost, not outside
FAR = 0.5  # relative change of an eigenvalue between two speeds beyond which modes are not compared


@dataclass(frozen=True)
class SpeedModes:
    """Modes at one rotary speed, the same on all ranks.

    speed: [rad/s]; s: (m,) eigenvalues [1/s].
    x, wx: (n, m) energy vectors, and the metric applied to them: x_i* W x_j is an energy [J]; x_j* W x_j = 1.
    kind: (m,) kinds; whirl: (m,) ``forward``, ``mixed``, ``backward``; ``none`` for modes that are not lateral.
    counted: (m,) whether a mode belongs to the lowest that were asked for.
    near: (m,) whether a mode was sought beside an excitation line; bands: those searches.
    stuck: the string is at rest without friction, which it has at any speed above: another state.
    zero: eigenvalues of this size or smaller count as zero [1/s].
    """

    speed: float
    s: np.ndarray
    x: np.ndarray
    wx: np.ndarray
    kind: tuple[str, ...]
    whirl: tuple[str, ...]
    counted: np.ndarray
    stuck: bool = False
    zero: float = 0.0
    near: np.ndarray | None = None
    bands: tuple[Band, ...] = ()

    @property
    def starts(self) -> np.ndarray:
        """(m,) mask of the oscillating modes that begin a branch."""
        return (self.counted if self.near is None else self.counted | self.near) & (self.s.imag > 0)

    def awaits(self, before: SpeedModes, mode: int, after: np.ndarray) -> bool:
        """Whether a mode of the speed before, which has found no partner, should have one among these.

        It lies below the highest of the lowest ones; or it was sought beside a line that passes its frequency on the way, and a mode
        of its kind, without a partner as well, lies across the line.  after: partners of the modes before (``Pairing``).
        """
        frequency = before.s[mode].imag
        if before.near is None or not before.near[mode]:
            lowest = self.s.imag if self.near is None else self.s.imag[~self.near]
            return bool(frequency <= EDGE * lowest.max(initial=0.0))
        free = np.array([q == before.kind[mode] for q in self.kind]) & self.starts
        free[after[after >= 0]] = False
        for old in (q for q in before.bands if q.holds(before.s[mode])):
            line = old.middle * self.speed / before.speed
            side = frequency - old.middle
            passes = side * (frequency - line) <= 0
            if passes and np.any(side * (self.s.imag[free] - line) <= 0):
                return True
        return False

    @property
    def grows(self) -> np.ndarray:
        """(m,) mask of the modes that grow, eigenvalues at zero left out."""
        return growing(self.s, self.zero)

    @property
    def damping_ratio(self) -> FloatArray:
        """(m,) [-]."""
        return damping_ratio(self.s)


def assurance(before: SpeedModes, after: SpeedModes) -> FloatArray:
    """Compute the modal assurance criterion (m, k) [-] of the modes at two speeds.

    |x_i* W x_j|^2/((x_i* W x_i)(x_j* W x_j)) {cite}`allemang2003`; 0 for eigenvalues far from each other.
    """
    mac = np.abs(before.x.conj().T @ after.wx) ** 2
    size = np.maximum(np.abs(before.s)[:, None], np.abs(after.s)[None])
    return np.asarray(np.where(np.abs(before.s[:, None] - after.s[None]) < FAR * size, mac, 0.0))


def clusters(s: np.ndarray) -> list[np.ndarray]:
    """Groups of nearly equal eigenvalues (m,)."""
    left, out = list(np.argsort(s.imag, kind="stable")), []
    while left:
        group = [left.pop(0)]
        for j in list(left):
            if abs(s[j] - s[group[-1]]) <= CLUSTER * abs(s[j]):
                group.append(j)
                left.remove(j)
        out.append(np.array(group))
    return out


def _span(modes: SpeedModes, group: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vectors orthonormal in the metric that span the modes of a group, and the metric applied to them."""
    x, wx = modes.x[:, group], modes.wx[:, group]
    gram = x.conj().T @ wx
    values, vectors = np.linalg.eigh(0.5 * (gram + gram.conj().T))
    kept = values > 1e-8 * values.max()
    turn = vectors[:, kept] / np.sqrt(values[kept])
    return x @ turn, wx @ turn


def similarity(before: SpeedModes, after: SpeedModes) -> FloatArray:
    """How well the modes at two speeds agree (m, k) [-]: the assurance criterion with the span of each cluster.

    A mode of a cluster may be any combination of the cluster: two planes of a round string, or two branches that cross.
    """
    near = assurance(before, after) > 0
    best = assurance(before, after)
    for group in clusters(before.s):
        if len(group) > 1:
            basis, _ = _span(before, group)
            share = np.sum(np.abs(basis.conj().T @ after.wx) ** 2, axis=0)
            best[group] = np.maximum(best[group], np.where(near[group], share[None], 0.0))
    for group in clusters(after.s):
        if len(group) > 1:
            _, basis = _span(after, group)
            share = np.sum(np.abs(before.x.conj().T @ basis) ** 2, axis=1)
            best[:, group] = np.maximum(best[:, group], np.where(near[:, group], share[:, None], 0.0))
    return np.minimum(best, 1.0)


@dataclass(frozen=True)
class Pairing:
    """Pairs of modes at two speeds: ``after[i]`` is the partner of mode i, -1 for none; ``mac[i]`` how well it agrees."""

    after: np.ndarray
    mac: FloatArray


def pair(before: SpeedModes, after: SpeedModes) -> Pairing:
    """Find the best pairs of the modes at two speeds."""
    similar = similarity(before, after)
    change = np.abs(before.s[:, None] - after.s[None]) / np.maximum(np.abs(before.s)[:, None], 1e-300)
    score = similar + OWN_SHAPE * assurance(before, after) - 1e-3 * np.minimum(change, 1.0)
    rows, columns = linear_sum_assignment(-score)
    partner, mac = np.full(len(before.s), -1), np.zeros(len(before.s))
    for i, j in zip(rows, columns, strict=True):
        mac[i] = similar[i, j]
        if similar[i, j] >= LEAST_MAC:
            partner[i] = j
    return Pairing(partner, mac)


@dataclass
class Branch:
    """A mode over the rotary speeds.

    number: from 1; points: number of the speed and of the mode at it; mac: agreement with the point before (1 at the first).
    end: why it ends before the last speed: ``lost``, ``outside`` (above the modes that were computed), ``rest`` (the
    string at rest has no friction), or empty.
    """

    number: int
    points: list[tuple[int, int]] = field(default_factory=list)
    mac: list[float] = field(default_factory=list)
    end: str = ""


def track(speeds: list[SpeedModes], pairings: list[Pairing]) -> list[Branch]:
    """Join the modes of successive speeds to branches; ``pairings[k]`` is between the speeds k and k + 1.

    Branches are numbered by their first speed and by their frequencies there and at the speeds after it: equal modes have no order.
    """
    branches: list[Branch] = []
    open_branches: dict[int, Branch] = {}
    for k, here in enumerate(speeds):
        if k:
            pairing, moved = pairings[k - 1], dict[int, Branch]()
            for mode, branch in open_branches.items():
                partner = int(pairing.after[mode])
                if partner >= 0:
                    branch.points.append((k, partner))
                    branch.mac.append(float(pairing.mac[mode]))
                    moved[partner] = branch
                else:
                    missing = here.awaits(speeds[k - 1], mode, pairing.after)
                    branch.end = "rest" if speeds[k - 1].stuck else "lost" if missing else "outside"
            open_branches = moved
        for mode in np.flatnonzero(here.starts):
            if int(mode) not in open_branches:
                branch = Branch(len(branches) + 1, [(k, int(mode))], [1.0])
                branches.append(branch)
                open_branches[int(mode)] = branch

    def order(branch: Branch) -> tuple[float, ...]:
        return branch.points[0][0], *(float(f"{speeds[k].s[j].imag:.6g}") for k, j in branch.points)

    branches.sort(key=order)
    for number, branch in enumerate(branches, 1):
        branch.number = number
    return branches


def searched_beside(speeds: list[SpeedModes]) -> FloatArray:
    """(k,) smallest distance [rad/s] from a line, at each speed, up to which all modes are known; nan where no line lies above the lowest modes."""
    return np.array([min((band.radius for band in m.bands), default=np.nan) for m in speeds])
