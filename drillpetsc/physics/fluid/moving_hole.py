"""The hole about the elements of a string that moves along it: where their nodes are, and how much hole there
is above each.

A node at measured depth s has the volume W of hole above it; dW/dt = a ds/dt with the hole's area a at the
node.  An element between two nodes has W2 - W1, the chamber under the bit what is left below the last one:
nothing is lost between them.  The rows of mass contain these rates (WIDENING in
kernels/fluid/annulus_flow.hpp is a2 - a1 over the length), so what the hole is wider or narrower at the new
place flows in or out as mud.  Looking at the hole anew, W has grown by a times the way, just what the rates
brought: mass is kept whatever a is. It is chosen such that W becomes the hole's true volume ``AHEAD`` further
on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.well import Well
from drillpetsc.physics.fluid.channels import Annulus, AnnulusWalls, HoleVolume

REFRESH = 0.01  # a node looks at the hole anew after this way [m]: over it, 3 deg/30 m turn the hole by 2e-5
AHEAD = 0.5  # [m], as long as the shortest transition of a hole between two diameters
OTHER_SIZE = (
    0.01  # relative change of the hole's diameter after which added mass and damping are worked out anew
)


@dataclass(frozen=True)
class LateralCoefficients:
    """What mud does to a string that moves across the hole: added mass over displaced mass (n,), damping (n,)
    [N s/m2], and torque per length and spin (n,) [N s].  by_eccentricity gives the added mass (k,) of
    elements of outer diameters and in holes of diameters (k,) [m] at eccentricities (k,) from 0 to 1."""

    added: FloatArray
    damping: FloatArray
    turning: FloatArray
    by_eccentricity: Callable[[FloatArray, FloatArray, FloatArray], FloatArray] | None = None


class MovingHole:
    """The hole as it is now, and the local nodes in it.

    current_well: the hole, a new object whenever it has grown.  sideways: from the sizes of elements to what
    mud does to them. (nv,) each, when the node last looked: depth, measured [m]; volume of hole above it
    [m3]; area [m2]; ahead, the way for which that is good [m].
    """

    def __init__(
        self,
        mesh: StringMesh,
        walls: AnnulusWalls,
        current_well: Callable[[], Well],
        sideways: Callable[[Annulus], LateralCoefficients],
    ):
        self.mesh, self.walls, self.current_well, self.sideways = mesh, walls, current_well, sideways
        self._hole = HoleVolume(current_well())
        self._near: np.ndarray | None = None
        self.depth = self.volume = self.area = self.ahead = np.zeros(0)

    @property
    def placed(self) -> bool:
        """Whether the nodes have looked at the hole yet."""
        return len(self.depth) > 0

    @property
    def hole(self) -> HoleVolume:
        well = self.current_well()
        if well is not self._hole.well:
            self._hole = HoleVolume(well)
        return self._hole

    def node_depths(self, state) -> FloatArray:
        """(nv,) measured depth of the local vertices [m]."""
        found = self.current_well().project(state.x[state.layout.dofs["string.position"]], self._near)
        self._near = found.segment
        return found.md

    def annulus(self, e: np.ndarray, ends: FloatArray) -> Annulus:
        """Annulus of the elements ``e`` (k,) whose nodes are at the measured depths ``ends`` (k, 2) [m]."""
        return self.walls.annulus(self.hole, e, ends[:, 0] + self.mesh.rigid_above[e], ends[:, 1])

    def look(self, depths: FloatArray, keep: bool) -> np.ndarray:
        """Let the nodes that have moved, now at ``depths`` (nv,), look at the hole; returns which (nv,) did.

        keep: volumes grow by what the rates of flow have brought (a node that has come further than it could
        foresee takes the hole as it finds it); without, they are the hole's.
        """
        if not self.placed:
            self.depth, (self.volume, self.area, self.ahead), keep = (
                depths.copy(),
                np.zeros((3, len(depths))),
                False,
            )
            moved = np.ones(len(depths), dtype=bool)
        else:
            moved = np.abs(depths - self.depth) > REFRESH
        if moved.any():
            hole, here, way = self.hole, depths[moved], depths[moved] - self.depth[moved]
            volume, ahead = hole.volume(here), np.full(len(here), AHEAD)
            if keep:
                volume = np.where(
                    np.abs(way) > self.ahead[moved], volume, self.volume[moved] + self.area[moved] * way
                )
                ahead = np.copysign(np.maximum(AHEAD, 2 * np.abs(way)), way)
            self.depth[moved], self.volume[moved], self.ahead[moved] = here, volume, np.abs(ahead)
            self.area[moved] = (hole.volume(here + ahead) - volume) / ahead
        return moved

    def sizes(self, ends: np.ndarray) -> tuple[FloatArray, FloatArray]:
        """Mean area of the hole [m2] between nodes ``ends`` (k, 2), and its change with their depth [m]."""
        first, second = ends.T
        length = self.depth[second] - self.depth[first]
        return (self.volume[second] - self.volume[first]) / length, (
            self.area[second] - self.area[first]
        ) / length

    def get_state(self) -> FloatArray:
        """(nv, 4) what a continued run needs to know."""
        return np.column_stack([self.depth, self.volume, self.area, self.ahead])

    def set_state(self, memory: FloatArray) -> None:
        """Go on from a ``memory``."""
        self.depth, self.volume, self.area, self.ahead = np.array(memory.T)
