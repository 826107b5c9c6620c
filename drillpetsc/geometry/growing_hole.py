"""The growing borehole: fixed nodes of the centreline, the moving end, and callbacks on growth.

Manual: sec-borehole-growing.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.well import SHORTEST_SECTION, Well

#: growth after which the wall of the hole is updated [m]; the wall then shifts by this times a small angle
SMALLEST_GROWTH = 1e-3
#: distance of the two nodes on either side of the beginning of the path, over the distance of the other nodes [-]
KINK = 0.1


class GrowingHole:
    """A hole whose end advances; the same on all ranks.

    The *end* is the centre of the bit on bottom, above the hole's deepest point.  The new path begins at its
    initial position, ``half`` above the bottom of the old hole.  After every ``interval`` of new hole a node
    of the centreline is fixed.  Between the last node and the end the hole follows the end.

    well: the hole at the start.
    half: distance from the end down to the deepest point [m].
    radius [m], friction [-]: of the new hole.
    interval: distance of new nodes [m].

    before_change: functions that are called before the hole changes.
    followers: functions that are called with the new well whenever the hole changes.
    leader: hole of a run beside which this one is; this one grows, fixes nodes and is reamed whenever that one does, never by
    its own length.
    """

    def __init__(self, well: Well, half: float, radius: float, friction: float, interval: float = 0.5):
        self.well = self.original = well
        self.start, self.half = well.depth, half
        self.radius, self.friction, self.interval = radius, friction, interval
        self.before_change: list[Callable[[], None]] = []
        self.followers: list[Callable[[Well], None]] = []
        self.path_start = self.start - half - 0.5 * KINK * interval
        self._frozen = _centreline_down_to(well, self.path_start)
        self._old_nodes = len(self._frozen.node_md)
        self.leader: GrowingHole | None = None
        self._grown, self._reamed_often = 0, dict[int, int]()  # how often; by number of the section
        s = self.start - half + np.linspace(-2 * interval - 1.0, 0.0, 17)
        position, tangent, _ = well.at(s)
        # rows: measured depth [m], position [m] and direction of the end
        self._trail = np.column_stack([s, position, tangent])
        self._drilled = 0.0
        self._unreamed = well
        #: by number of the section of the hole at the start: its end now and in ``well`` [m]
        self._reamed_to: dict[int, float] = {}
        self._reamed_shown: dict[int, float] = {}
        self.start_point = self.end  # (3,) at the start [m]

    @property
    def end(self) -> FloatArray:
        """(3,) position of the end at the last update of the wall [m]."""
        return self._trail[-1, 1:4].copy()

    @property
    def direction(self) -> FloatArray:
        """(3,) unit vector of the hole at its end."""
        return self._trail[-1, 4:7].copy()

    def radial_clearance(self, radius: float) -> float:
        """Compute the radial clearance [m] of a bit of ``radius`` [m] at the end, zero at least."""
        return max(float(self.well.radius(self._trail[-1, 0])) - radius, 0.0)

    def widen(self, section: int) -> None:
        """Let the end of a ``section`` of the hole at the start move down with a reamer (``widen_to``)."""
        self._reamed_to[section] = self._reamed_shown[section] = float(self.original.section_to[section])
        self._reamed_often[section] = 0

    def widen_to(self, section: int, distance: float) -> bool:
        """Put the end of a reamed ``section`` ``distance`` [m] below its place at the start; returns whether the hole changes."""
        self._reamed_to[section] = float(self.original.section_to[section]) + distance
        if self.leader is not None:
            changes = self.leader._reamed_often[section] > self._reamed_often[section]
        else:
            changes = abs(self._reamed_to[section] - self._reamed_shown[section]) >= SMALLEST_GROWTH
        if not changes:
            return False
        self._reamed_often[section] += 1
        self._announce()
        self._show(self._unreamed)
        for call in self.followers:
            call(self.well)
        return True

    def _reamed(self, well: Well, ends: dict[int, float] | None = None) -> Well:
        """Return ``well``, given without reamers, with its sections reamed down to the present depths of the reamers."""
        if not self._reamed_to:
            return well
        to, first = well.section_to.copy(), min(self._reamed_to)
        for section, end in (self._reamed_to if ends is None else ends).items():
            to[section] = end
        kept = list(range(first + 1))  # and what the sections above have not reached
        kept += [i for i in range(first + 1, len(to)) if to[i] > to[:i].max() + SHORTEST_SECTION]
        to[kept[-1]] = well.section_to[-1]
        return replace(
            well,
            section_to=to[kept],
            section_radius=well.section_radius[kept],
            section_friction=well.section_friction[kept],
            section_kind=tuple(well.section_kind[i] for i in kept),
        )

    def _show(self, unreamed: Well) -> None:
        """Make the present hole from the one without reamers."""
        self._unreamed, self._reamed_shown = unreamed, dict(self._reamed_to)
        self.well = self._reamed(unreamed)

    def grows_to(self, drilled: float) -> bool:
        """Whether the hole changes with a length ``drilled`` [m] of new hole."""
        if self.leader is not None:
            return self.leader._grown > self._grown
        return drilled - self._drilled >= SMALLEST_GROWTH

    def follow(self, drilled: float, position: FloatArray) -> bool:
        """Move the end; returns whether the hole has changed.

        drilled: length of new hole [m]; position: (3,) of the end [m].
        """
        if not self.grows_to(drilled):
            return False
        self._announce()
        self._drilled, self._grown = drilled, self._grown + 1
        s = self.start - self.half + drilled
        tangent = self._tangent(s, position)
        self._trail = np.vstack([self._trail, [s, *position, *tangent]])
        while self._reaches(*self._next_node()):  # independent of the time steps
            self._freeze(*self._next_node())
        # this length is enough for the directions of coming nodes
        self._trail = self._trail[self._trail[:, 0] > s - 4 * self.interval - 1.0]
        self._show(self._longer(self._frozen, s, position, tangent) if self._is_live else self._frozen)
        for call in self.followers:
            call(self.well)
        return True

    def _announce(self) -> None:
        for call in self.before_change:
            call()

    def whole_path(self, drilled: float, position: FloatArray) -> Well:
        """Return the hole down to its deepest point.

        drilled: length of new hole [m]; position: (3,) of the end [m].
        """
        if drilled <= 0.0:
            return self._reamed(self.original)
        s, well = self.start - self.half + drilled, self._frozen
        tangent = self._tangent(s, position)
        if s - well.node_md[-1] > 0.04 * self.interval:
            well = self._longer(well, s, position, tangent)
        bottom = self.start + drilled
        return self._reamed(self._longer(well, bottom, position + self.half * tangent, tangent))

    def _longer(self, well: Well, s: float, position: FloatArray, tangent: FloatArray) -> Well:
        """Return ``well`` with one more node at ``s`` [m], ``position`` (3,) [m] and ``tangent`` (3,).

        The new hole becomes a separate section as soon as it is long enough for a transition of the radius.
        """
        longer, old = well.extended(s, position, tangent), self.original
        same = (self.radius, self.friction) == (old.section_radius[-1], old.section_friction[-1])
        if same or not self._is_section(len(well.node_md) - self._old_nodes, s):
            return longer
        return replace(
            longer,
            section_to=np.r_[old.section_to, s],
            section_radius=np.r_[old.section_radius, self.radius],
            section_friction=np.r_[old.section_friction, self.friction],
            section_kind=(*old.section_kind, "open_hole"),
        )

    def _is_section(self, node: int, s: float) -> bool:
        """Whether new hole is a section down to its ``node`` at ``s`` [m]."""
        if self.leader is not None:
            nodes = self.leader._frozen.node_md[self.leader._old_nodes :]
            return self.leader._is_section(
                node, nodes[node] if node < len(nodes) else self.leader._trail[-1, 0]
            )
        return bool(s - self.original.depth >= SHORTEST_SECTION)

    @property
    def _fixed_nodes(self) -> int:
        return len(self._frozen.node_md) - self._old_nodes

    def _reaches(self, node: float, reach: float) -> bool:
        """Whether the hole goes on by ``reach`` below the next ``node`` [m]."""
        if self.leader is not None:
            return self.leader._fixed_nodes > self._fixed_nodes
        return bool(self._trail[-1, 0] >= node + reach)

    @property
    def _is_live(self) -> bool:
        """Whether the end of the trail is a node of the hole."""
        if self.leader is not None:
            return self.leader._is_live
        return bool(self._trail[-1, 0] - self._frozen.node_md[-1] > 0.04 * self.interval)

    def _next_node(self) -> tuple[float, float]:
        """Return the measured depth of the next node and the reach of its chord [m].

        The first node of the new path is close to the last one of the old hole: the path may have a kink
        between them, over which a long cubic would swing.  All others are at even distances.
        """
        last = float(self._frozen.node_md[-1])
        if last <= self.path_start:
            return last + KINK * self.interval, 0.5 * KINK * self.interval
        return last + self.interval, 0.5 * self.interval

    def _freeze(self, s: float, h: float) -> None:
        """Fix a node at ``s`` [m], ``h`` [m] or more behind the end.

        Its direction is along the chord from ``h`` above to ``h`` below it.
        """
        chord = self._at(s + h) - self._at(s - h)
        self._frozen = self._longer(self._frozen, s, self._at(s), chord / np.linalg.norm(chord))

    def _at(self, s: float) -> FloatArray:
        """Interpolate the position (3,) [m] on the trail at ``s`` [m]: cubic between its points."""
        q = self._trail
        i = int(np.clip(np.searchsorted(q[:, 0], s) - 1, 0, len(q) - 2))
        a, b = q[i], q[i + 1]
        h = b[0] - a[0]
        u = (s - a[0]) / h
        return np.asarray(
            (1 - 3 * u**2 + 2 * u**3) * a[1:4]
            + (3 * u**2 - 2 * u**3) * b[1:4]
            + h * u * (1 - u) * ((1 - u) * a[4:7] - u * b[4:7])
        )

    def _tangent(self, s: float, position: FloatArray) -> FloatArray:
        """Compute the direction (3,) at the end (manual: eq-borehole-end-direction).

        It is the direction of the chord over the last half interval, plus half the turn since the chord before
        it, but at most half the turn between that chord and its predecessor.  On an arc it is exact
        to second order.  At a kink it does not go beyond the new direction.  The wandering of the bit within a
        turn is averaged over half an interval.

        s: measured depth of the end [m]; position: (3,) of the end [m].
        """
        # the points behind are on the existing trail; otherwise long steps would extrapolate from themselves
        # direction
        h = max(0.5 * self.interval, s - self._trail[-1, 0])
        points = [position, *(self._at(s - k * h) for k in (1, 2, 3))]
        chord, above, first = (a - b for a, b in zip(points, points[1:], strict=False))
        turn, before = chord - above, above - first
        size = float(turn @ turn)
        share = min(1.0, max(0.0, float(turn @ before) / size)) if size > 0 else 0.0
        t = chord + 0.5 * share * turn
        return t / np.linalg.norm(t)

    # ------------------------------------------------------------------ checkpoints
    def get_state(self) -> dict[str, FloatArray]:
        """Return the state of the hole for a checkpoint.

        first: (3,) end at the start [m]; drilled: (1,) length of new hole [m].
        trail: (k, 7) measured depth, position, direction of the end; nodes: (m, 7) the same of fixed nodes.
        sections: (j, 3) lower end [m], radius [m], friction [-].
        reamed: (k, 2) number of each reamed section and its end in the present hole [m]; absent without reamers.
        """
        w = self._frozen
        return {
            "first": self.start_point,
            "trail": self._trail,
            "drilled": np.array([self._drilled]),
            "nodes": np.column_stack([w.node_md, w.node_position, w.node_tangent]),
            "sections": np.column_stack([w.section_to, w.section_radius, w.section_friction]),
        } | ({"reamed": np.array(list(self._reamed_shown.items()))} if self._reamed_shown else {})

    def set_state(self, state: dict[str, FloatArray]) -> None:
        """Continue from a checkpoint: ``state`` as returned by ``get_state``."""
        nodes, sections = state["nodes"], state["sections"]
        kinds = (*self._frozen.section_kind, *["open_hole"] * len(sections))[: len(sections)]
        to, radius, friction = sections.T.copy()
        self._frozen = Well(
            nodes[:, 0].copy(), nodes[:, 1:4].copy(), nodes[:, 4:7].copy(), to, radius, friction, kinds
        )
        self._trail, self._drilled, self.start_point = (
            np.array(state["trail"]),
            float(state["drilled"][0]),
            np.array(state["first"]),
        )
        s, end = self._trail[-1, 0], self._trail[-1]
        unreamed = self._longer(self._frozen, s, end[1:4], end[4:7]) if self._is_live else self._frozen
        self._unreamed = unreamed if self._drilled > 0.0 else self.original
        if "reamed" in state:
            self._reamed_shown = {int(section): float(end) for section, end in state["reamed"]}
        self.well = self._reamed(self._unreamed, self._reamed_shown)
        for call in self.followers:
            call(self.well)


def _centreline_down_to(well: Well, md: float) -> Well:
    """Return ``well`` without its nodes below ``md`` [m] and with one there; its sections keep their ends."""
    above = well.node_md < md - 1e-6
    position, tangent, _ = well.at(md)
    return replace(
        well,
        node_md=np.r_[well.node_md[above], md],
        node_position=np.vstack([well.node_position[above], position]),
        node_tangent=np.vstack([well.node_tangent[above], tangent]),
    )
