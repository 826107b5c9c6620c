"""The well: centreline, hole radius and friction along measured depth, closest point of the centreline.

Axes x north, y east, z down; measured depth 0 at the origin (manual: sec-borehole).  The survey becomes
minimum-curvature arcs (manual: eq-borehole-arc; Sawaryn and Thorogood, "A Compendium of Directional
Calculations Based on the Minimum Curvature Method", SPE 84246, 2005).  Every arc is cut into pieces of at
most 10 m and 2 deg, and each piece is a cubic Hermite segment (manual: eq-borehole-hermite).  A `Well` is
plain data, the same on every rank.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from drillpetsc.arrays import components

Array = NDArray[np.float64]

MAX_STEP = 10.0  # m, longest piece of an arc
MAX_ANGLE = np.radians(2.0)  # rad, largest turn of a piece
STRAIGHT = 1e-12  # rad, below this a survey interval is a straight line
SHORTEST_SECTION = 0.1  # m


@dataclass(frozen=True)
class ClosestPoints:
    """Closest points of the centreline to n positions.

    md: (n,) measured depths [m].
    centre: (n, 3) closest points [m].
    tangent: (n, 3) unit tangents.
    offset: (n, 3) from the closest point to the position [m].
    radius: (n,) of the hole [m]; friction: (n,) [-].
    segment: (n,) int32 numbers of the segments, as starting points of the next search.
    """

    md: Array
    centre: Array
    tangent: Array
    offset: Array
    radius: Array
    friction: Array
    segment: NDArray[np.int32]


@dataclass(frozen=True)
class StraightAxis:
    """The axis of a string that lies in no hole: a straight line without ends.

    start: (3,) point at measured depth 0 [m]; direction: (3,) unit vector down the line.
    """

    start: Array
    direction: Array

    def at(self, md: ArrayLike) -> tuple[Array, Array, Array]:
        """Position (..., 3) [m], tangent (..., 3) and curvature vector (..., 3) [1/m] at md (...) [m]."""
        position = self.start + np.asarray(md, dtype=float)[..., None] * self.direction
        return position, np.broadcast_to(self.direction, position.shape).copy(), np.zeros_like(position)

    def project(self, points: Array) -> ClosestPoints:
        """Closest points to ``points`` (n, 3) [m]; no wall is near."""
        d = points - self.start
        md = np.sum(d * self.direction, axis=1)
        along = md[:, None] * self.direction
        n, tangent = len(d), np.tile(self.direction, (len(d), 1))
        nothing = np.zeros(n, dtype=np.int32)
        return ClosestPoints(
            md, self.start + along, tangent, d - along, np.full(n, np.inf), np.zeros(n), nothing
        )


@dataclass(frozen=True, eq=False)
class Well:
    """Centreline nodes and hole sections; `from_survey` creates one from a survey.

    node_md: (n,) measured depths of the nodes [m], n >= 2.
    node_position: (n, 3) [m]; node_tangent: (n, 3) unit vectors down the hole.
    section_to: (m,) lower end of each section [m].
    section_radius: (m,) [m]; section_friction: (m,) [-].
    section_kind: (m,) kinds as in the case file.
    """

    node_md: Array
    node_position: Array
    node_tangent: Array
    section_to: Array
    section_radius: Array
    section_friction: Array
    section_kind: tuple[str, ...]

    @classmethod
    def from_survey(
        cls,
        md: ArrayLike,
        inclination: ArrayLike,
        azimuth: ArrayLike,
        section_to: ArrayLike,
        section_radius: ArrayLike,
        section_friction: ArrayLike,
        section_kind: Sequence[str] | None = None,
        *,
        max_step: float = MAX_STEP,
        max_angle: float = MAX_ANGLE,
    ) -> Well:
        """Create a well from a survey and hole sections, both from the surface down.

        Manual: sec-borehole-survey.

        A survey that starts below md 0 is continued upward along its first direction.  A survey that ends
        above the bottom of the last section is continued downward.  A straight line has no nodes between its
        ends.

        md: (k,) measured depths of the stations [m].
        inclination, azimuth: (k,) [rad].
        section_to, section_radius, section_friction, section_kind: see `Well`.
        max_step: longest piece of an arc [m]; max_angle: largest turn of a piece [rad].

        Raises ValueError when stations or sections are out of order or impossible.
        """
        stations, tangents = _check_survey(md, inclination, azimuth)
        to, radius, friction, kinds = _check_sections(
            section_to, section_radius, section_friction, section_kind
        )
        if stations[0] > 0:
            stations, tangents = np.r_[0.0, stations], np.vstack([tangents[:1], tangents])
        if to[-1] > stations[-1]:
            stations, tangents = np.r_[stations, to[-1]], np.vstack([tangents, tangents[-1:]])
        node_md, position, tangent = minimum_curvature(stations, tangents, max_step, max_angle)
        return cls(node_md, position, tangent, to, radius, friction, kinds)

    # ------------------------------------------------------------------ centreline
    @property
    def depth(self) -> float:
        """Measured depth of the hole bottom [m]: the lower end of the last section."""
        return float(self.section_to[-1])

    @cached_property
    def handle(self) -> Array:
        """Tangent length m of each Hermite segment (n-1,) [m] (manual: eq-borehole-handle).

        m = 4 R tan(beta/4) = chord / cos^2(beta/4).  The second form follows from
        chord = 2 R sin(beta/2) = 4 R sin(beta/4) cos(beta/4) and holds for straight pieces as well.
        """
        chord = np.linalg.norm(np.diff(self.node_position, axis=0), axis=1)
        return chord / np.cos(_angle(self.node_tangent[:-1], self.node_tangent[1:]) / 4) ** 2

    @cached_property
    def cubic(self) -> tuple[Array, Array]:
        """Coefficients a2, a3 (n-1, 3) [m] of the segments c(u) = x0 + m t0 u + a2 u^2 + a3 u^3, u from 0 to 1.

        Manual: eq-borehole-hermite.
        """
        t0, t1 = self.node_tangent[:-1], self.node_tangent[1:]
        m, dx = self.handle[:, None], np.diff(self.node_position, axis=0)
        a2, a3 = 3 * dx - m * (2 * t0 + t1), m * (t0 + t1) - 2 * dx
        straight = _angle(t0, t1) < STRAIGHT
        a2[straight] = 0.0  # rounding only
        a3[straight] = 0.0
        return a2, a3

    def at(self, md: ArrayLike) -> tuple[Array, Array, Array]:
        """Compute position (..., 3) [m], unit tangent (..., 3) and curvature vector dt/ds (..., 3) [1/m] at
        md (...) [m].

        Measured depth within a segment is s(u) = s0 + u L + (m - L) u (1-u)(1-2u) (manual:
        eq-borehole-depth).  This cubic has ds/du = m at both ends, so dc/ds is the unit tangent at every node
        (C1 in s), and s is the arc length up to order beta^4 inside.  Beyond both ends the centreline
        continues straight.  At a node the curvature is taken from the segment below it.
        """
        md = np.asarray(md, dtype=float)
        s = np.clip(md, self.node_md[0], self.node_md[-1])
        i = np.clip(np.searchsorted(self.node_md, s, side="right") - 1, 0, len(self.node_md) - 2)
        length, m = np.diff(self.node_md)[i], self.handle[i]
        u = v = (s - self.node_md[i]) / length
        k = m / length - 1
        for _ in range(3):
            u = u - (u + k * u * (1 - u) * (1 - 2 * u) - v) / (1 + k * (1 - 6 * u + 6 * u * u))
        u, m = u[..., None], m[..., None]
        a2, a3 = self.cubic[0][i], self.cubic[1][i]
        t0 = self.node_tangent[i]
        d1 = m * t0 + u * (2 * a2 + 3 * u * a3)
        d2 = 2 * a2 + 6 * u * a3
        speed2 = np.sum(d1 * d1, axis=-1, keepdims=True)
        tangent = d1 / np.sqrt(speed2)
        curvature = (d2 - np.sum(d2 * tangent, axis=-1, keepdims=True) * tangent) / speed2
        beyond = (md - s)[..., None]
        position = self.node_position[i] + u * (m * t0 + u * (a2 + u * a3)) + beyond * tangent
        return position, tangent, np.where(beyond == 0, curvature, 0.0)

    def inclination(self, md: ArrayLike) -> Array:
        """Inclination from the vertical [rad] at md (...) [m]."""
        north, east, down = components(self.at(md)[1])
        return np.arctan2(np.hypot(north, east), down)

    def azimuth(self, md: ArrayLike) -> Array:
        """Azimuth from north over east, 0 to 2 pi [rad], at md (...) [m]; 0 in a vertical hole."""
        north, east, _ = components(self.at(md)[1])
        return np.arctan2(east, north) % (2 * np.pi)

    # ------------------------------------------------------------------ hole
    @cached_property
    def transitions(self) -> Array:
        """Transitions of radius and friction between sections (manual: eq-borehole-transition).

        Rows (start [m], width [m], radius above [m], its change [m], friction above [-], its change [-]).
        Each section boundary is smoothed over max(0.5 m, 10 |dR|) centred on it, or over the shorter of its
        two neighbouring sections if that is less, so that transitions do not overlap.
        """
        dr, df = np.diff(self.section_radius), np.diff(self.section_friction)
        length = np.diff(np.r_[-np.inf, self.section_to[:-1], np.inf])
        width = np.minimum(np.maximum(0.5, 10 * np.abs(dr)), np.minimum(length[:-1], length[1:]))
        rows = np.stack(
            [
                self.section_to[:-1] - width / 2,
                width,
                self.section_radius[:-1],
                dr,
                self.section_friction[:-1],
                df,
            ],
            axis=1,
        )
        return rows[(dr != 0) | (df != 0)]

    def _smoothed(self, md: ArrayLike, column: int, top: float) -> Array:
        md, rows = np.asarray(md, dtype=float), self.transitions
        if not len(rows):
            return np.full(md.shape, top)
        i = np.searchsorted(rows[:, 0], md, side="right") - 1
        row = rows[np.maximum(i, 0)]
        u = np.clip((md - row[..., 0]) / row[..., 1], 0.0, 1.0)
        return np.asarray(row[..., column] + row[..., column + 1] * u * u * (3 - 2 * u))

    def radius(self, md: ArrayLike) -> Array:
        """Hole radius [m] at md (...) [m]."""
        return self._smoothed(md, 2, self.section_radius[0])

    def friction(self, md: ArrayLike) -> Array:
        """Friction coefficient [-] at md (...) [m]."""
        return self._smoothed(md, 4, self.section_friction[0])

    def kind(self, md: float) -> str:
        """Kind of the section at md [m]."""
        return self.section_kind[min(int(np.searchsorted(self.section_to, md)), len(self.section_kind) - 1)]

    # ------------------------------------------------------------------ growth
    def extended(self, md: float, position: ArrayLike, tangent: ArrayLike) -> Well:
        """Return this well with one more node, to which the last section reaches.

        md: of the node [m], below the last node; position: (3,) [m]; tangent: (3,).

        Raises ValueError if the node is not below the last one.
        """
        if md <= self.node_md[-1]:
            raise ValueError(f"the new node at {md} m must lie below the last one at {self.node_md[-1]} m")
        t = np.asarray(tangent, dtype=float)
        return replace(
            self,
            node_md=np.r_[self.node_md, md],
            node_position=np.vstack([self.node_position, np.asarray(position, dtype=float)]),
            node_tangent=np.vstack([self.node_tangent, t / np.linalg.norm(t)]),
            section_to=np.r_[self.section_to[:-1], max(md, self.depth)],
        )

    def cut(self, md: float) -> Well:
        """Return this well cut at ``md`` [m]: the drilled part of a planned path, which `extended` can continue.

        Raises ValueError if the centreline does not reach ``md``.
        """
        if not 0 < md <= self.node_md[-1]:
            raise ValueError(f"cannot end the well at {md} m: its centreline runs to {self.node_md[-1]} m")
        above = self.node_md < md - 1e-6
        x, t, _ = self.at(md)
        sections = min(int(np.searchsorted(self.section_to, md)) + 1, len(self.section_to))
        return replace(
            self,
            node_md=np.r_[self.node_md[above], md],
            node_position=np.vstack([self.node_position[above], x]),
            node_tangent=np.vstack([self.node_tangent[above], t]),
            section_to=np.r_[self.section_to[: sections - 1], md],
            section_radius=self.section_radius[:sections],
            section_friction=self.section_friction[:sections],
            section_kind=self.section_kind[:sections],
        )

    # ------------------------------------------------------------------ kernels
    @cached_property
    def _packed(self) -> Array:
        from drillpetsc.kernels.parameters import Table, columns

        n, steps = len(self.node_md), self.transitions
        second, third = (np.vstack([a, np.zeros(3)]) for a in self.cubic)
        rows = Table(
            columns("well_node"),
            n,
            depth=self.node_md,
            length=np.append(np.diff(self.node_md), 0.0),
            handle=np.append(self.handle, 0.0),
            position=self.node_position,
            tangent=self.node_tangent,
            second=second,
            third=third,
            unused=0.0,
        )
        header = Table(
            columns("well_header"),
            1,
            nodes=n,
            transitions=len(steps),
            radius=self.section_radius[0],
            friction=self.section_friction[0],
            steepest=np.max(1.5 * np.abs(steps[:, 3]) / steps[:, 1], initial=0.0),  # of a smoothstep
        )
        names = ("start", "width", "radius", "radius_change", "friction", "friction_change")
        changes = Table(columns("well_step"), len(steps), **dict(zip(names, steps.T, strict=True)))
        packed = np.concatenate([table.array.ravel() for table in (header, rows, changes)])
        packed.flags.writeable = False
        return packed

    def packed(self) -> Array:
        """Pack the well for the C++ kernels: one float64 array in the layout of kernels/contact/well.hpp
        (read-only, cached).
        """
        return self._packed

    def project(self, points: ArrayLike, segment: NDArray[np.int32] | None = None) -> ClosestPoints:
        """Find the closest points of the centreline (manual: sec-borehole-projection).

        points: (n, 3) positions [m].
        segment: (n,) numbers of segments from an earlier result, from which the search starts.

        Raises ValueError for a wrong shape of ``segment``.
        """
        from drillpetsc.kernels import pointer

        x = np.ascontiguousarray(points, dtype=float).reshape(-1, 3)
        n = len(x)
        hint = np.full(n, -1, np.int32) if segment is None else np.array(segment, np.int32)
        if hint.shape != (n,):
            raise ValueError(f"segment has shape {hint.shape}, expected ({n},)")
        found = np.empty(12 * n)
        scalars, vectors = found[: 3 * n].reshape(3, n), found[3 * n :].reshape(3, n, 3)
        first = pointer(found)
        second = first + 24 * n
        md, radius, friction = (first + 8 * n * k for k in range(3))
        centre, tangent, offset = (second + 24 * n * k for k in range(3))
        _project_kernel()(
            pointer(self.packed()),
            n,
            pointer(x),
            pointer(hint),
            md,
            centre,
            tangent,
            offset,
            radius,
            friction,
        )
        return ClosestPoints(scalars[0], vectors[0], vectors[1], vectors[2], scalars[1], scalars[2], hint)


@cache
def _project_kernel() -> Any:
    from drillpetsc.kernels import function  # here: a well is also read by programs without kernels

    return function("well_project", "pi" + "p" * 8)


def direction(inclination: ArrayLike, azimuth: ArrayLike) -> Array:
    """Compute the unit tangent (..., 3), north-east-down: (sin I cos A, sin I sin A, cos I).

    Manual: eq-borehole-tangent.

    inclination, azimuth: (...) [rad].
    """
    i, a = np.broadcast_arrays(np.asarray(inclination, dtype=float), np.asarray(azimuth, dtype=float))
    return np.stack([np.sin(i) * np.cos(a), np.sin(i) * np.sin(a), np.cos(i)], axis=-1)


def _angle(t0: Array, t1: Array) -> Array:
    """Compute the angle (...) [rad] between unit vectors (..., 3).

    The form 2 atan2(|t1-t0|, |t1+t0|) is accurate for small and for large angles.
    """
    return 2 * np.arctan2(np.linalg.norm(t1 - t0, axis=-1), np.linalg.norm(t1 + t0, axis=-1))


def minimum_curvature(
    md: Array, tangents: Array, max_step: float = MAX_STEP, max_angle: float = MAX_ANGLE
) -> tuple[Array, Array, Array]:
    """Compute nodes on the minimum-curvature arcs between stations.

    The first station is at md 0 at the origin.

    Arc between stations (manual: eq-borehole-arc; SPE 84246):
    x(f) = x1 + (ds/b)[sin(f b) e1 + (1 - cos f b) e2], e1 = t1, e2 = (t2 - cos b t1)/sin b.

    md: (k,) measured depths of the stations [m]; tangents: (k, 3) unit tangents.
    max_step: longest piece of an arc [m]; max_angle: largest turn of a piece [rad].
    Returns measured depth (n,) [m], position (n, 3) [m] and tangent (n, 3) of the nodes.
    """
    turn, length = _angle(tangents[:-1], tangents[1:]), np.diff(md)
    straight = turn < STRAIGHT
    pieces = np.where(straight, 1, np.ceil(np.maximum(length / max_step, turn / max_angle) - 1e-9)).astype(
        int
    )
    arc, last = np.repeat(np.arange(len(pieces)), pieces), np.cumsum(pieces) - 1
    number = np.arange(1, len(arc) + 1) - (last - pieces + 1)[arc]
    t0 = tangents[:-1]
    across = tangents[1:] - np.sum(t0 * tangents[1:], axis=1, keepdims=True) * t0
    with np.errstate(divide="ignore", invalid="ignore"):  # straight ones, which are replaced
        e2, radius = across / np.linalg.norm(across, axis=1)[:, None], length / turn
        a = (turn[arc] * number / pieces[arc])[:, None]
        # 1 - cos = 2 sin^2(half), free of cancellation
        along = radius[arc, None] * (np.sin(a) * t0[arc] + 2 * np.sin(a / 2) ** 2 * e2[arc])
        s, t = md[arc] + radius[arc] * a[:, 0], np.cos(a) * t0[arc] + np.sin(a) * e2[arc]
    along[last[straight]] = (length[:, None] * t0)[straight]
    s[last], t[last] = md[1:], tangents[1:]  # depth and tangent of the station without rounding
    ends = np.cumsum(np.vstack([md[:1, None] * tangents[:1], along[last]]), axis=0)
    kept = np.full(len(arc), True)
    kept[last[:-1][straight[:-1] & straight[1:]]] = False  # the intervals belong to the same straight line
    x = ends[arc] + along
    return np.r_[md[:1], s[kept]], np.vstack([ends[:1], x[kept]]), np.vstack([tangents[:1], t[kept]])


def _check_survey(md: ArrayLike, inclination: ArrayLike, azimuth: ArrayLike) -> tuple[Array, Array]:
    """Return depths (k,) [m] and tangents (k, 3) of a survey; ValueError names the station that is wrong."""
    s, i, a = (np.atleast_1d(np.asarray(v, dtype=float)) for v in (md, inclination, azimuth))
    if not (s.ndim == 1 and len(s) and s.shape == i.shape == a.shape):
        raise ValueError(
            f"survey md, inclination and azimuth need the same length, got {s.shape}, {i.shape}, {a.shape}"
        )
    if not (np.isfinite(s).all() and np.isfinite(i).all() and np.isfinite(a).all()):
        raise ValueError("the survey contains a value that is not a number")
    if s[0] < 0:
        raise ValueError(f"the survey starts at {s[0]} m; measured depth counts from 0 at the rotary table")
    if (bad := np.flatnonzero(np.diff(s) <= 0)).size:
        raise ValueError(
            f"survey md must increase: station {bad[0] + 2} at {s[bad[0] + 1]} m follows {s[bad[0]]} m"
        )
    if (bad := np.flatnonzero((i < 0) | (i > np.pi))).size:
        raise ValueError(f"inclination must lie in 0 to pi rad, station {bad[0] + 1} has {i[bad[0]]}")
    t = direction(i, a)
    if (bad := np.flatnonzero(_angle(t[:-1], t[1:]) > np.radians(170))).size:
        where = f"between {s[bad[0]]} m and {s[bad[0] + 1]} m"
        raise ValueError(f"the hole turns by more than 170 deg {where}: the arc is not defined")
    return s, t


def _check_sections(
    to: ArrayLike, radius: ArrayLike, friction: ArrayLike, kind: Sequence[str] | None
) -> tuple[Array, Array, Array, tuple[str, ...]]:
    """Return the checked arrays (m,) of the sections; ValueError names the section that is wrong."""
    s, r, f = (np.atleast_1d(np.asarray(v, dtype=float)) for v in (to, radius, friction))
    kinds = tuple(kind) if kind is not None else ("open_hole",) * len(s)
    if not (len(s) and s.shape == r.shape == f.shape == (len(kinds),)):
        got = f"{s.shape}, {r.shape}, {f.shape}, {len(kinds)}"
        raise ValueError(f"sections: to, radius, friction, kind need the same length, got {got}")
    length = np.diff(np.r_[0.0, s])
    if not (length >= SHORTEST_SECTION).all():
        i = int(np.flatnonzero(~(length >= SHORTEST_SECTION))[0])
        rule = f"sections go down and are {SHORTEST_SECTION} m or longer"
        raise ValueError(f"section {i + 1} (to {s[i]} m) is {length[i]:g} m long: {rule}")
    if not (np.isfinite(r).all() and (r > 0).all()):
        raise ValueError(f"section radii must be above 0, got {r}")
    if not (np.isfinite(f).all() and (f >= 0).all()):
        raise ValueError(f"section friction must be 0 or above, got {f}")
    return s, r, f, kinds
