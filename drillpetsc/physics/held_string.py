"""String that is held where it lies, around which mud flows."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.physics.beam import RESULT_NAMES
from drillpetsc.physics.interfaces import Beam


class HeldString(Beam):
    """A string without unknowns, unstrained and at rest on the axis of its hole.

    position, tangent: (n_nodes, 3) of its nodes [m, -]; vertices: those of this rank.
    """

    moves = False

    def __init__(self, position: FloatArray, tangent: FloatArray, vertices: IntArray) -> None:
        self._top = position[0], tangent[0]
        self._position, self._tangent = position[vertices], tangent[vertices]

    def place(self, system: Any, position: FloatArray, tangent: FloatArray) -> None:
        """Nothing moves the string."""

    def set_rigid_motion(
        self,
        system: Any,
        tangent: FloatArray,
        curvature: FloatArray,
        lowering: float | FloatArray,
        rotation: float | FloatArray,
    ) -> None:
        """Nothing moves the string."""

    def impose_rigid_motion(self, system: Any, rates: FloatArray, lowering: float, rotation: float) -> None:
        """Nothing moves the string."""

    def first_node(self, fields: Mapping[str, FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position (3,) [m], tangent (3,) and spin angle (1,) [rad] of the top node."""
        return *self._top, np.zeros(1)

    def section(self, state: Any, vertex: int | IntArray) -> tuple[FloatArray, FloatArray, Any]:
        """Position (3,) [m], tangent (3,) and spin rate [rad/s] of a local vertex; of k vertices (k, 3), (k, 3), (k,)."""
        return self._position[vertex], self._tangent[vertex], np.zeros(np.shape(vertex))

    def nodal_motion(self, state: Any, vertices: IntArray) -> FloatArray:
        """(3, k, 7) position [m], tangent [-] and spin angle [rad] of k local vertices, their rates and accelerations."""
        out = np.zeros((3, len(vertices), 7))
        out[0, :, :3], out[0, :, 3:6] = self._position[vertices], self._tangent[vertices]
        return out

    def columns(self, state: Any) -> FloatArray:
        """(nv, 8) at the local vertices: position [m], velocity [m/s], spin rate [rad/s], spin angle [rad]."""
        return np.pad(self._position, ((0, 0), (0, 5)))

    def couple(self, values: FloatArray, rows: FloatArray) -> FloatArray:
        """(n, 3) zeros: the string passes no couples."""
        return np.zeros((len(values), 3))

    def element_results(self, state: Any) -> FloatArray:
        """(nc, 9) zeros per local cell."""
        return np.zeros((max(0, len(self._position) - 1), len(RESULT_NAMES)))
