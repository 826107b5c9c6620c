"""The hole as it is drilled: the frozen centreline, its live end, and what follows when the end has moved
on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.well import SHORTEST_SECTION, Well

# growth after which the hole's wall follows its end [m]; the wall shifts by this times a small angle
NOTICED = 1e-3


class GrowingHole:
    """A hole whose end moves on; the same on all ranks.

    The *end* here is the centre of the bit on bottom, ``half`` [m] above the hole's deepest point.  Every
    ``interval`` [m] of new hole its place is frozen as a node of the centreline; between the last node and
    the end the hole follows the end.  radius [m] and friction: of the new hole.  ``followers`` are called
    with the new well.
    """

    def __init__(self, well: Well, half: float, radius: float, friction: float, interval: float = 0.5):
        self.well = self._frozen = self._old = well
        self.start, self.half = well.depth, half
        self.radius, self.friction, self.interval = radius, friction, interval
        self.followers: list[Callable[[Well], None]] = []
        s = self.start - half + np.linspace(-2 * interval, 0.0, 9)
        position, tangent, _ = well.at(s)
        self._trail = np.column_stack(
            [s, position, tangent]
        )  # rows: measured depth, place, direction of the end
        self._drilled = 0.0
        self.first = self.end  # (3,) at the start [m]

    @property
    def end(self) -> FloatArray:
        """(3,) place of the end when its wall was last brought up to date [m]."""
        return self._trail[-1, 1:4].copy()

    @property
    def direction(self) -> FloatArray:
        """(3,) unit vector of the hole at its end."""
        return self._trail[-1, 4:7].copy()

    def radial_clearance(self, radius: float) -> float:
        """Clearance of a bit of ``radius`` [m] at the end, not below zero [m]."""
        return max(float(self.well.radius(self._trail[-1, 0])) - radius, 0.0)

    def follow(self, drilled: float, place: FloatArray) -> bool:
        """Take the end at ``place`` (3,) after ``drilled`` metres; returns whether the hole has changed."""
        if drilled - self._drilled < NOTICED:
            return False
        self._drilled = drilled
        s = self.start - self.half + drilled
        tangent = self._tangent(s, place)
        self._trail = np.vstack([self._trail, [s, *place, *tangent]])
        while (
            s >= self._frozen.node_md[-1] + 1.5 * self.interval
        ):  # nodes at even depths, wherever a step happened to end
            self._freeze(self._frozen.node_md[-1] + self.interval)
        self._trail = self._trail[
            self._trail[:, 0] > s - 4 * self.interval - 1.0
        ]  # enough for the slopes to come
        live = s - self._frozen.node_md[-1] > 0.04 * self.interval
        self.well = self._longer(self._frozen, s, place, tangent) if live else self._frozen
        for call in self.followers:
            call(self.well)
        return True

    def whole(self, drilled: float, place: FloatArray) -> Well:
        """The hole down to its deepest point, its end at ``place`` (3,) after ``drilled`` metres."""
        if drilled <= 0.0:
            return self._frozen
        s, well = self.start - self.half + drilled, self._frozen
        tangent = self._tangent(s, place)
        if s - well.node_md[-1] > 0.04 * self.interval:
            well = self._longer(well, s, place, tangent)
        bottom = self.start + drilled
        return self._longer(well, bottom, place + self.half * tangent, tangent)

    def _longer(self, well: Well, s: float, place: FloatArray, tangent: FloatArray) -> Well:
        """``well`` with one more node; the new hole is a section of its own as soon as its radius can go over
        into the old one's."""
        longer, old = well.extended(s, place, tangent), self._old
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
        """A node at ``s``, half an interval or more behind the end, so that the path on both sides gives its
        direction."""
        h = 0.5 * self.interval
        chord = self._at(s + h)[0] - self._at(s - h)[0]
        self._frozen = self._longer(self._frozen, s, self._at(s)[0], chord / np.linalg.norm(chord))

    def _at(self, s: float) -> tuple[FloatArray, FloatArray]:
        """Place and direction (3,) on the trail at ``s``: cubic between its points."""
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

    def _tangent(self, s: float, place: FloatArray) -> FloatArray:
        """Direction (3,) at the end: slope there of the parabola through the end and two places half an
        interval apart behind it.

        Exact on an arc to second order; the bit's own wandering within a turn is averaged over half an
        interval.
        """
        h = max(
            0.5 * self.interval, s - self._trail[-1, 0]
        )  # where the trail has been, or long steps feed on themselves
        one, two = self._at(s - h)[0], self._at(s - 2 * h)[0]
        t = 3 * place - 4 * one + two
        return t / np.linalg.norm(t)

    # ------------------------------------------------------------------ checkpoints
    def get_state(self) -> dict[str, FloatArray]:
        """What a continued run needs to know of the hole."""
        w = self._frozen
        return {
            "first": self.first,
            "trail": self._trail,
            "drilled": np.array([self._drilled]),
            "nodes": np.column_stack([w.node_md, w.node_position, w.node_tangent]),
            "sections": np.column_stack([w.section_to, w.section_radius, w.section_friction]),
        }

    def set_state(self, memory: dict[str, FloatArray]) -> None:
        """Go on from ``memory``."""
        nodes, sections = memory["nodes"], memory["sections"]
        kinds = (*self._frozen.section_kind, *["open_hole"] * len(sections))[: len(sections)]
        to, radius, friction = sections.T.copy()
        self._frozen = Well(
            nodes[:, 0].copy(), nodes[:, 1:4].copy(), nodes[:, 4:7].copy(), to, radius, friction, kinds
        )
        self._trail, self._drilled, self.first = (
            np.array(memory["trail"]),
            float(memory["drilled"][0]),
            np.array(memory["first"]),
        )
        s, end = self._trail[-1, 0], self._trail[-1]
        live = s - self._frozen.node_md[-1] > 0.04 * self.interval
        self.well = self._longer(self._frozen, s, end[1:4], end[4:7]) if live else self._frozen
        for call in self.followers:
            call(self.well)
