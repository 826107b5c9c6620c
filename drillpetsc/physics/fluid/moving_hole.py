"""The hole around a string that moves along it: measured depths of the nodes, and the volume of hole above each.

Manual: sec-mud-moving, eq-mud-swept.  A node at measured depth s has the volume W of hole above it, and dW/dt
= a ds/dt with the hole's area a at the node.  An element between two nodes has W2 - W1, and the chamber under
the bit has the volume below the last node, so no volume is lost between them.  The rows of mass contain these
rates (WIDENING in kernels/fluid/annulus_flow.hpp is a2 - a1 over the length); where the hole is wider or
narrower at the new position, mud flows in or out.  When the geometry is re-evaluated, W has changed by a ds,
which is what the rates have integrated to; mass is conserved for any a.  a is chosen so that W becomes the
hole's true volume ``AHEAD`` further on.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.well import Well
from drillpetsc.physics.fluid.channels import Annulus, AnnulusWalls, HoleVolume

REFRESH = 0.01  # motion of a node after which the hole is re-evaluated [m]; 3 deg/30 m turn the hole by 2e-5 over it
AHEAD = 0.5  # [m], as long as the shortest transition of a hole between two diameters
OTHER_SIZE = 0.01  # relative change of the hole's diameter after which added mass and damping are recomputed


@dataclass(frozen=True)
class LateralCoefficients:
    """Coefficients of the mud's force on a string that moves across the hole and rotates.

    Manual: sec-mud-added-mass.

    added: (n,) added mass over displaced mass [-]; damping: (n,) [N s/m2].
    turning: (n,) torque per length and spin [N s].
    by_eccentricity(eccentricity, outer, hole): added mass (k,) at eccentricities (k,) from 0 to 1, of
    elements of outer diameters (k,) [m] in holes of diameters (k,) [m]; None: independent of the
    eccentricity.
    """

    added: FloatArray
    damping: FloatArray
    turning: FloatArray
    by_eccentricity: Callable[[FloatArray, FloatArray, FloatArray], FloatArray] | None = None


class MovingHole:
    """The present hole and the local nodes in it.

    mesh: of the string; walls: of the annulus.
    current_well(): the present hole, a new object whenever it has grown.
    lateral(annulus): coefficients of the mud's force on elements of this annulus.

    At the last evaluation of the hole at a node, (nv,) each: depth, measured [m]; volume of hole above it
    [m3]; area [m2]; ahead: motion for which these values are valid [m].
    """

    def __init__(
        self,
        mesh: StringMesh,
        walls: AnnulusWalls,
        current_well: Callable[[], Well],
        lateral: Callable[[Annulus], LateralCoefficients],
    ):
        self.mesh, self.walls, self.current_well, self.lateral = mesh, walls, current_well, lateral
        self._hole = HoleVolume(current_well())
        self._near: np.ndarray | None = None
        self.depth = self.volume = self.area = self.ahead = np.zeros(0)

    @property
    def evaluated(self) -> bool:
        """Whether the hole has been evaluated at the nodes."""
        return len(self.depth) > 0

    @property
    def hole(self) -> HoleVolume:
        """Volume of the present hole."""
        well = self.current_well()
        if well is not self._hole.well:
            self._hole = HoleVolume(well)
        return self._hole

    def node_depths(self, state) -> FloatArray:
        """Compute the measured depths (nv,) of the local vertices [m]."""
        found = self.current_well().project(state.x[state.layout.dofs["string.position"]], self._near)
        self._near = found.segment
        return found.md

    def annulus(self, e: np.ndarray, ends: FloatArray) -> Annulus:
        """Create the annulus of the elements ``e`` (k,) whose nodes are at measured depths ``ends`` (k, 2) [m]."""
        return self.walls.annulus(self.hole, e, ends[:, 0] + self.mesh.rigid_above[e], ends[:, 1])

    def update(self, depths: FloatArray, keep: bool) -> np.ndarray:
        """Re-evaluate the hole at the nodes that have moved; returns their mask (nv,).

        depths: (nv,) present measured depths of the nodes [m].
        keep: volumes change by the integral of the rates.  A node that has moved further than ``ahead`` gets
        the true volume.  Without ``keep`` all volumes are those of the hole.
        """
        if not self.evaluated:
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

    def sizes(self, ends: np.ndarray, without_length: np.ndarray) -> tuple[FloatArray, FloatArray]:
        """Compute the mean area of the hole (k,) [m2] between nodes ``ends`` (k, 2), and its change with
        their depth (k,) [m].

        without_length: (k,) mask of joints, between whose nodes there is no more than their travel.
        """
        first, second = ends.T
        length = np.where(without_length, 1.0, self.depth[second] - self.depth[first])
        area = (self.volume[second] - self.volume[first]) / length
        return (
            np.where(without_length, self.area[second], area),
            np.where(without_length, 0.0, (self.area[second] - self.area[first]) / length),
        )

    def get_state(self) -> FloatArray:
        """Return (nv, 4) depth, volume, area, ahead, for a checkpoint."""
        return np.column_stack([self.depth, self.volume, self.area, self.ahead])

    def set_state(self, saved: FloatArray) -> None:
        """Continue from the result of ``get_state``."""
        self.depth, self.volume, self.area, self.ahead = np.array(saved.T)
