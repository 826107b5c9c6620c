"""Soft string: torque and drag of a string that lies on the wall and has no bending stiffness.

Johancsik, Friesen and Dawson, "Torque and Drag in Directional Wells - Prediction and Measurement", JPT 36(6),
1984 (SPE 11380), in the form of a differential equation (Sheppard, Wick and Burgess, SPEDE 1987, SPE 15463).
With T the axial force (compression negative), M the torque, t the tangent of the hole, kappa = dt/ds, w the
buoyed weight per length, and md counted downwards (manual: eq-soft-string-contact, eq-soft-string-force):

    dT/ds = -(w cos I + a mu N)      dM/ds = -c mu N R_o      N = |T kappa + w_perp|      w_perp = w (z - (z.t) t)

(a, c) = (v, omega R_o) / |(v, omega R_o)| is the slip direction, v positive when hoisting (manual:
eq-soft-string-slip).
Without motion there is no friction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drillpetsc.arrays import sums_from_below
from drillpetsc.geometry.well import Well

Array = NDArray[np.float64]

MAX_STEP = 5.0  # longest step of the integration [m]
_GAUSS = np.array([0.5 - np.sqrt(3) / 6, 0.5 + np.sqrt(3) / 6])
# two-stage Gauss collocation, order 4 (Hairer, Norsett and Wanner,
# Solving Ordinary Differential Equations I, section II.7)
_A11, _A12, _A21, _A22 = 0.25, 0.25 - np.sqrt(3) / 6, 0.25 + np.sqrt(3) / 6, 0.25


@dataclass(frozen=True)
class TorqueDrag:
    """Results along the string, at n + 1 boundaries from the top down, with n intervals between them.

    md: (n+1,) measured depths [m].
    axial_force: (n+1,) [N], compression negative.
    torque: (n+1,) [N m].
    contact_force: (n+1,) [N/m], mean of the two sides of a boundary.
    wall_direction: (n+1, 3) unit direction of the contact load, from the hole axis to the touched wall; zero
    without contact.
    mean_contact_force: (n,) over each interval [N/m], from which friction is summed.
    elongation: (n+1,) [m] and twist: (n+1,) [rad], from the top down to each boundary.
    """

    md: Array
    axial_force: Array
    torque: Array
    contact_force: Array
    wall_direction: Array
    mean_contact_force: Array
    elongation: Array
    twist: Array

    @property
    def hook_load(self) -> float:
        """Axial force at the top [N]."""
        return float(self.axial_force[0])

    @property
    def surface_torque(self) -> float:
        """Torque at the top [N m]."""
        return float(self.torque[0])

    @property
    def stretch(self) -> float:
        """Elongation of the whole string [m]."""
        return float(self.elongation[-1])


def slip_direction(axial_velocity: float, rotation: float, contact_radius: ArrayLike) -> tuple[Array, Array]:
    """Compute the slip direction (v, omega R_o)/|(v, omega R_o)| (manual: eq-soft-string-slip).

    axial_velocity: v [m/s], positive when hoisting.
    rotation: omega [rad/s].
    contact_radius: (n,) R_o [m].
    Returns the axial and the circumferential component, (n,) each; both are zero without motion.
    """
    around = rotation * np.asarray(contact_radius, dtype=float)
    speed = np.hypot(axial_velocity, around)
    scale = np.divide(1.0, speed, out=np.zeros_like(speed), where=speed > 0)
    return axial_velocity * scale, around * scale


def torque_drag(
    well: Well,
    md: ArrayLike,
    weight: ArrayLike,
    contact_radius: ArrayLike,
    axial_stiffness: ArrayLike,
    torsional_stiffness: ArrayLike,
    *,
    bottom_force: float = 0.0,
    bottom_torque: float = 0.0,
    axial_velocity: float = 0.0,
    rotation: float = 0.0,
) -> TorqueDrag:
    """Integrate the soft string from the bottom up (manual: sec-soft-string-integration).

    Values per interval are (n,), or one number for all.

    well: the hole.
    md: (n+1,) interval boundaries [m], increasing.
    weight: buoyed weight per length [N/m], positive down.
    contact_radius: [m].
    axial_stiffness: EA [N]; torsional_stiffness: GJ [N m2].
    bottom_force: axial force at md[-1] [N], compression negative.
    bottom_torque: torque of the rock on the string [N m].
    axial_velocity: [m/s], positive when hoisting; rotation: [rad/s].

    Raises ValueError where md does not increase.
    """
    md = np.asarray(md, dtype=float)
    n = len(md) - 1
    if n < 1 or not (np.diff(md) > 0).all():
        raise ValueError("md needs two or more increasing interval boundaries")
    weight, contact_radius, ea, gj = (
        np.broadcast_to(np.asarray(v, dtype=float), (n,))
        for v in (weight, contact_radius, axial_stiffness, torsional_stiffness)
    )
    edges, interval = _steps(well, md)
    h = np.diff(edges)
    points = edges[:-1, None] + h[:, None] * _GAUSS  # (k, 2)
    _, tangent, curvature = well.at(points)
    mu = well.friction(points)
    along, around = slip_direction(axial_velocity, rotation, contact_radius)
    w = weight[interval][:, None]
    down = w * tangent[..., 2]
    across = -down[..., None] * tangent  # w_perp
    across[..., 2] += w

    tension, at_points = _integrate(h, down, along[interval][:, None] * mu, curvature, across, bottom_force)
    contact = np.linalg.norm(at_points[..., None] * curvature + across, axis=-1)
    point_weight = 0.5 * h  # weight of each Gauss point
    torque_step = point_weight * around[interval] * contact_radius[interval] * (mu * contact).sum(axis=1)
    torque = bottom_torque + sums_from_below(torque_step)
    # to the order of the scheme M is linear in a step; T is known at the Gauss points
    stretch_step = point_weight * at_points.sum(axis=1) / ea[interval]
    twist_step = point_weight * (torque[:-1] + torque[1:]) / gj[interval]

    boundary = np.searchsorted(edges, md)
    force, wall_direction = _at_boundaries(well, md, tension[boundary], weight)
    return TorqueDrag(
        md=md,
        axial_force=tension[boundary],
        torque=torque[boundary],
        contact_force=force,
        wall_direction=wall_direction,
        mean_contact_force=np.bincount(interval, point_weight * contact.sum(axis=1), n) / np.diff(md),
        elongation=np.r_[0.0, np.cumsum(stretch_step)][boundary],
        twist=np.r_[0.0, np.cumsum(twist_step)][boundary],
    )


def _steps(well: Well, md: Array) -> tuple[Array, NDArray[np.int64]]:
    """Compute the edges of the integration steps (k+1,) [m] and the interval of each step (k,).

    Steps end at every interval boundary, well node and end of a radius or friction transition, so that no
    value jumps within a step.
    """
    rows = well.transitions
    marks = np.concatenate([well.node_md, rows[:, 0], rows[:, 0] + rows[:, 1]])
    marks = marks[(marks > md[0]) & (marks < md[-1])]
    after = np.searchsorted(md, marks)
    # a mark at a boundary up to rounding would make a very short step
    separate = np.minimum(marks - md[after - 1], md[after] - marks) > 1e-6
    coarse = np.unique(np.concatenate([md, marks[separate]]))
    pieces = np.ceil(np.diff(coarse) / MAX_STEP).astype(int)
    first = np.repeat(np.cumsum(pieces) - pieces, pieces)
    fraction = (np.arange(pieces.sum()) - first) / np.repeat(pieces, pieces)
    edges = np.append(np.repeat(coarse[:-1], pieces) + fraction * np.repeat(np.diff(coarse), pieces), md[-1])
    interval = np.searchsorted(md, 0.5 * (edges[:-1] + edges[1:])) - 1
    return edges, interval


def _integrate(
    h: Array, down: Array, drag: Array, curvature: Array, across: Array, bottom: float
) -> tuple[Array, Array]:
    """Integrate the axial force from the bottom up (manual: eq-soft-string-force, eq-soft-string-square).

    N^2 = T^2 |kappa|^2 + 2 T kappa.w_perp + |w_perp|^2.  The stage equations are solved by fixed-point
    iteration (drag kappa h << 1).

    h: (k,) step lengths [m]; bottom: axial force at the lower end [N].
    At the Gauss points: down: (k, 2) w cos I [N/m]; drag: (k, 2) a mu [-]; curvature: (k, 2, 3) kappa [1/m];
    across: (k, 2, 3) w_perp [N/m].
    Returns the axial force at the step edges (k+1,) and at the Gauss points (k, 2) [N].
    """
    kk = (curvature * curvature).sum(axis=-1)
    kw = (curvature * across).sum(axis=-1)
    ww = (across * across).sum(axis=-1)
    tension, inner = np.empty(len(h) + 1), np.empty((len(h), 2))
    tension[-1] = t = bottom
    table = np.column_stack([h, down, drag, kk, kw, ww]).tolist()
    for i in range(len(h) - 1, -1, -1):
        step, g1, g2, m1, m2, k1, k2, c1, c2, w1, w2 = table[i]
        # the integration goes up, so the first stage is the lower Gauss point (index 2)
        lower = upper = t
        for _ in range(50):
            n2 = max(lower * lower * k2 + 2 * lower * c2 + w2, 0.0) ** 0.5
            n1 = max(upper * upper * k1 + 2 * upper * c1 + w1, 0.0) ** 0.5
            f2, f1 = g2 + m2 * n2, g1 + m1 * n1
            new_lower, new_upper = t + step * (_A11 * f2 + _A12 * f1), t + step * (_A21 * f2 + _A22 * f1)
            change = abs(new_lower - lower) + abs(new_upper - upper)
            lower, upper = new_lower, new_upper
            if change <= 1e-12 * (abs(t) + step * (abs(f1) + abs(f2))):
                break
        inner[i] = upper, lower
        t += 0.5 * step * (f1 + f2)
        tension[i] = t
    return tension, inner


def _at_boundaries(well: Well, md: Array, tension: Array, weight: Array) -> tuple[Array, Array]:
    """Compute contact force (n+1,) [N/m] and its direction (n+1, 3) at the boundaries.

    Inside the string they are means of the values above and below.

    tension: (n+1,) axial force [N]; weight: (n,) per length [N/m].
    """
    load = np.zeros((len(md), 3))
    beside = min(1e-6 * max(1.0, float(md[-1] - md[0]) / 1e3), 0.5 * float(np.diff(md).min()))
    above, below = np.arange(1, len(md)), np.arange(len(md) - 1)  # boundaries with an interval above, below
    for i, shift in ((above, -beside), (below, beside)):
        _, t, kappa = well.at(md[i] + shift)
        across = -(weight * t[:, 2])[:, None] * t
        across[:, 2] += weight
        load[i] += tension[i, None] * kappa + across
    load[1:-1] *= 0.5
    force = np.linalg.norm(load, axis=1)
    small = force <= 1e-9 * np.abs(weight).max()
    return force, np.divide(load, force[:, None], out=np.zeros_like(load), where=~small[:, None])
