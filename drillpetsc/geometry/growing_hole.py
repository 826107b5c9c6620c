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


class GrowingHole:
    """A hole whose end advances; the same on all ranks.

    The *end* is the centre of the bit on bottom, above the hole's deepest point.  After every ``interval`` of
    new hole a node of the centreline is fixed.  Between the last node and the end the hole follows the end.

    well: the hole at the start.
    half: distance from the end down to the deepest point [m].
    radius [m], friction [-]: of the new hole.
    interval: distance of new nodes [m].

    followers: functions that are called with the new well whenever the hole changes.
    """

    def __init__(self, well: Well, half: float, radius: float, friction: float, interval: float = 0.5):
        self.well = self._frozen = self._old = well
        self.start, self.half = well.depth, half
        self.radius, self.friction, self.interval = radius, friction, interval
        self.followers: list[Callable[[Well], None]] = []
        s = self.start - half + np.linspace(-2 * interval, 0.0, 9)
        position, tangent, _ = well.at(s)
        # rows: measured depth [m], position [m] and direction of the end
        self._trail = np.column_stack([s, position, tangent])
        self._drilled = 0.0
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

    def follow(self, drilled: float, position: FloatArray) -> bool:
        """Move the end; returns whether the hole has changed.

        drilled: length of new hole [m]; position: (3,) of the end [m].
        """
        if drilled - self._drilled < SMALLEST_GROWTH:
            return False
        self._drilled = drilled
        s = self.start - self.half + drilled
        tangent = self._tangent(s, position)
        self._trail = np.vstack([self._trail, [s, *position, *tangent]])
        # nodes at even distances, independent of the time steps
        while s >= self._frozen.node_md[-1] + 1.5 * self.interval:
            self._freeze(self._frozen.node_md[-1] + self.interval)
        # this length is enough for the directions of coming nodes
        self._trail = self._trail[self._trail[:, 0] > s - 4 * self.interval - 1.0]
        live = s - self._frozen.node_md[-1] > 0.04 * self.interval
        self.well = self._longer(self._frozen, s, position, tangent) if live else self._frozen
        for call in self.followers:
            call(self.well)
        return True

    def whole_path(self, drilled: float, position: FloatArray) -> Well:
        """Return the hole down to its deepest point.

        drilled: length of new hole [m]; position: (3,) of the end [m].
        """
        if drilled <= 0.0:
            return self._frozen
        s, well = self.start - self.half + drilled, self._frozen
        tangent = self._tangent(s, position)
        if s - well.node_md[-1] > 0.04 * self.interval:
            well = self._longer(well, s, position, tangent)
        bottom = self.start + drilled
        return self._longer(well, bottom, position + self.half * tangent, tangent)

    def _longer(self, well: Well, s: float, position: FloatArray, tangent: FloatArray) -> Well:
        """Return ``well`` with one more node at ``s`` [m], ``position`` (3,) [m] and ``tangent`` (3,).

        The new hole becomes a section of its own as soon as it is long enough for a transition of the radius.
        """
        longer, old = well.extended(s, position, tangent), self._old
        same = (self.radius, self.friction) == (old.section_radius[-1], old.section_friction[-1])
        if same or s - old.depth < SHORTEST_SECTION:
            return longer
        return replace(
            longer,
            section_to=np.r_[old.section_to, s],
            section_radius=np.r_[old.section_radius, self.radius],
            section_friction=np.r_[old.section_friction, self.friction],
            section_kind=(*old.section_kind, "open_hole"),
        )

    def _freeze(self, s: float) -> None:
        """Fix a node at ``s`` [m], half an interval or more behind the end.

        Its direction is that of the chord from half an interval above to half an interval below it.
        """
        h = 0.5 * self.interval
        chord = self._at(s + h)[0] - self._at(s - h)[0]
        self._frozen = self._longer(self._frozen, s, self._at(s)[0], chord / np.linalg.norm(chord))

    def _at(self, s: float) -> tuple[FloatArray, FloatArray]:
        """Interpolate position [m] and direction, (3,) each, on the trail at ``s`` [m]: cubic between its points."""
        q = self._trail
        i = int(np.clip(np.searchsorted(q[:, 0], s) - 1, 0, len(q) - 2))
        a, b = q[i], q[i + 1]
        h = b[0] - a[0]
        u = (s - a[0]) / h
        x = (
            (1 - 3 * u**2 + 2 * u**3) * a[1:4]
            + (3 * u**2 - 2 * u**3) * b[1:4]
            + h * u * (1 - u) * ((1 - u) * a[4:7] - u * b[4:7])
        )
        t = (
            6 * u * (1 - u) * (b[1:4] - a[1:4]) / h
            + (1 - 4 * u + 3 * u**2) * a[4:7]
            + (3 * u**2 - 2 * u) * b[4:7]
        )
        return x, t / np.linalg.norm(t)

    def _tangent(self, s: float, position: FloatArray) -> FloatArray:
        """Compute the direction (3,) at the end (manual: eq-borehole-end-direction).

        It is the slope of the parabola through the end and two points half an interval apart behind it.  On
        an arc it is exact to second order.  The wandering of the bit within a turn is averaged over half an
        interval.

        s: measured depth of the end [m]; position: (3,) of the end [m].
        """
        # both points are on the existing trail; otherwise long steps would extrapolate from their own
        # direction
        h = max(0.5 * self.interval, s - self._trail[-1, 0])
        one, two = self._at(s - h)[0], self._at(s - 2 * h)[0]
        t = 3 * position - 4 * one + two
        return t / np.linalg.norm(t)

    # ------------------------------------------------------------------ checkpoints
    def get_state(self) -> dict[str, FloatArray]:
        """Return the state of the hole for a checkpoint.

        first: (3,) end at the start [m]; drilled: (1,) length of new hole [m].
        trail: (k, 7) measured depth, position, direction of the end; nodes: (m, 7) the same of fixed nodes.
        sections: (j, 3) lower end [m], radius [m], friction [-].
        """
        w = self._frozen
        return {
            "first": self.start_point,
            "trail": self._trail,
            "drilled": np.array([self._drilled]),
            "nodes": np.column_stack([w.node_md, w.node_position, w.node_tangent]),
            "sections": np.column_stack([w.section_to, w.section_radius, w.section_friction]),
        }

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
        live = s - self._frozen.node_md[-1] > 0.04 * self.interval
        self.well = self._longer(self._frozen, s, end[1:4], end[4:7]) if live else self._frozen
        for call in self.followers:
            call(self.well)
