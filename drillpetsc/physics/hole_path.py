"""Path of a string's end along the centreline of the hole (manual: sec-prescribed-path)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.geometry.frames import high_side, smallest_rotation
from drillpetsc.geometry.well import Well

PARTS = 8  # a segment of the centreline is followed in so many parts


@dataclass(frozen=True)
class PathPoint:
    """Point of the path.

    centre: (3,) [m]; axes: (3, 3) rows: unit tangent and the two transported normals.
    curvature: (3,) derivative of the tangent by the measured depth [1/m].
    """

    centre: FloatArray
    axes: FloatArray
    curvature: FloatArray


class HolePath:
    """Centreline of a hole with normals that are transported along it without rotation about the tangent.

    Above measured depth 0 and below the survey the path is straight.

    well: the hole; start: measured depth at which the first normal is ``normal`` [m].
    normal: (3,) unit, across the tangent at ``start``; None: the high side.
    """

    def __init__(self, well: Well, start: float = 0.0, normal: FloatArray | None = None):
        self.well = well
        edges = well.node_md
        parts = np.linspace(0.0, 1.0, PARTS, endpoint=False)
        self._depths = np.append((edges[:-1, None] + np.diff(edges)[:, None] * parts).ravel(), edges[-1])
        self._tangents = np.asarray(well.at(self._depths)[1])
        self._normals = [high_side(self._tangents[0])]
        self._cosine, self._sine = 1.0, 0.0
        self._last: tuple[float, PathPoint] | None = None
        _, (t, one, two), _ = self._frame(start)
        normal = high_side(t) if normal is None else normal
        angle = np.arctan2(normal @ two, normal @ one)
        self._cosine, self._sine = float(np.cos(angle)), float(np.sin(angle))

    def at(self, depth: float) -> PathPoint:
        """Return the point at the measured ``depth`` [m]."""
        if self._last is None or self._last[0] != depth:
            self._last = depth, PathPoint(*self._frame(depth))
        return self._last[1]

    def _frame(self, depth: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        centre, t, curvature = (np.asarray(q) for q in self.well.at(depth))
        k = int(np.clip(np.searchsorted(self._depths, depth, side="right") - 1, 0, len(self._depths) - 1))
        while len(self._normals) <= k:  # from the first node on, so that the result depends on the depth only
            i = len(self._normals)
            self._normals.append(
                smallest_rotation(self._tangents[i - 1], self._tangents[i], self._normals[-1])
            )
        one = smallest_rotation(self._tangents[k], t, self._normals[k])
        one -= (one @ t) * t
        one /= np.linalg.norm(one)
        two = np.cross(t, one)
        normals = np.array([self._cosine * one + self._sine * two, self._cosine * two - self._sine * one])
        return centre, np.vstack([t, normals]), curvature

    def coordinates(self, position: FloatArray) -> FloatArray:
        """Compute the measured depth and the offsets along both normals (3,) [m] of ``position`` (3,)."""
        depth = self.depth_of(position)
        here = self.at(depth)
        return np.append(depth, here.axes[1:] @ (position - here.centre))

    def position(self, coordinates: FloatArray) -> FloatArray:
        """Return the position (3,) [m] at the ``coordinates`` (3,), as the method of this name does."""
        here = self.at(float(coordinates[0]))
        return here.centre + coordinates[1:] @ here.axes[1:]

    def depth_of(self, point: FloatArray) -> float:
        """Return the measured depth [m] of the point of the path closest to ``point`` (3,)."""
        return float(self.well.project(point[None]).md[0])


def is_curved(well: Well) -> bool:
    """Whether the centreline is not one straight line."""
    t = well.node_tangent
    return bool(np.any(np.abs(t - t[0]) > 1e-12))
