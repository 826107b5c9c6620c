"""The hole around a string that moves along it: measured depths of the nodes, and the volume of hole above each.

Manual: sec-mud-moving, eq-mud-swept.  A node at measured depth s has the volume W of hole above it, and dW/dt
= a ds/dt with the hole's area a at the node.  An element between two nodes has W2 - W1, and the chamber under
the bit has the volume below the last node, so no volume is lost between them.  The rows of mass contain these
rates (WIDENING in kernels/fluid/annulus_flow.hpp is a2 - a1 over the length); if the hole is wider or
narrower at the new position, mud flows in or out.  When the geometry is re-evaluated, W has changed by a ds,
the integral of the rates. So mass is conserved for any a.  a is chosen so that W becomes the
hole's true volume ``AHEAD`` further on.

A reamer that advances by db adds its ring to the hole above all nodes below it, dW = ring db.  While it cuts, a is
chosen for a shoulder that moves with the string.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.well import ClosestPoints, Well
from drillpetsc.kernels import function, pointer
from drillpetsc.physics.fluid.channels import Annulus, AnnulusWalls, HoleVolume
from drillpetsc.physics.tools.reamer import Reamer

_moved_along = function("moved_along", "ipppdd", ctypes.c_int)
#: when any node may have moved by SURELY_NEAR, the hole is re-evaluated at all nodes that have moved further than this [m]; 3 deg/30 m turn
#: the hole by 2e-5 over it.  With one bound for both, one of hundreds of nodes would be beside it at every step, and all be projected
REFRESH = 0.007
REAMED = 2e-4  # metres reamed after which the hole is re-evaluated at all nodes; they may differ from the metres moved by the string [m]
AHEAD = 0.5  # [m], as long as the shortest transition of a hole between two diameters
OTHER_SIZE = 0.01  # relative change of the hole's diameter after which added mass and damping are recomputed


#: a node that has moved less than this along the hole, and less than the second in all, has not moved by much more than REFRESH: measured
#: depth differs from the way along the tangent by its curvature times the squared way [m]
SURELY_NEAR = 0.008, 0.1


@dataclass(frozen=True)
class LateralCoefficients:
    """Coefficients of the mud's force on a string that moves across the hole and rotates.

    Manual: sec-mud-added-mass.

    added: (n,) added mass over displaced mass [-]; damping: (n,) [N s/m2].
    turning: (n,) torque per length and spin [N s].
    swirl: (n,) ratio of the steady spin of the mud to the spin of the string [-]; 0: the mud does not swirl.
    following(speed, outer, hole): rate (k,) [1/s] at which the swirl follows the spin, at speeds (k,) [m/s] along elements of
    outer diameters (k,) [m] in holes of diameters (k,) [m]; None: at once.
    by_place(outer, hole): coefficients (k, 5) [-] of the added mass by position in the hole (manual: eq-mud-chi-place) of elements of
    outer diameters (k,) [m] in holes of diameters (k,) [m]; None: the same everywhere.
    """

    added: FloatArray
    damping: FloatArray
    turning: FloatArray
    swirl: FloatArray
    following: Callable[[FloatArray, FloatArray, FloatArray], FloatArray] | None = None
    by_place: Callable[[FloatArray, FloatArray], FloatArray] | None = None


class MovingHole:
    """The present hole and the local nodes in it.

    mesh: of the string; walls: of the annulus.
    current_well(): the present hole, a new object whenever it has grown.
    lateral(annulus): coefficients of the mud's force on elements of this annulus.
    reamers: that widen the hole, from the top.
    nodes: (nv,) numbers of the local nodes.

    leader: hole of a run beside which this one is; it is evaluated again with the leader, at the same nodes.
    moved: (nv,) nodes at which the last ``follow`` has evaluated it; None: it has not looked where they are.

    At the last evaluation of the hole at a node, (nv,) each: depth, measured [m]; volume of hole above it
    [m3]; area [m2]; ahead: motion for which these values are valid [m].
    """

    def __init__(
        self,
        mesh: StringMesh,
        walls: AnnulusWalls,
        current_well: Callable[[], Well],
        lateral: Callable[[Annulus], LateralCoefficients],
        reamers: tuple[Reamer, ...] = (),
    ):
        self.reamers = reamers
        self._reamed = [0.0] * len(reamers)  # of each reamer when all nodes were evaluated last [m]
        self.mesh, self.walls, self.current_well, self.lateral = mesh, walls, current_well, lateral
        self._hole = HoleVolume(current_well())
        self._near: np.ndarray | None = None
        self.leader: MovingHole | None = None
        self.moved: np.ndarray | None = None
        #: hole, places (nv, 3) of the nodes' positions in the unknowns, position of each node at its depth and direction there (nv, 6)
        self._from: tuple[Well, np.ndarray, FloatArray] | None = None
        self._restored: FloatArray | None = None  # the last of them, from a checkpoint
        self.attach(np.arange(mesh.nodes), 0.0)

    def attach(self, nodes: IntArray, area: float) -> None:
        """Set the numbers of the local ``nodes`` (nv,), with the ``area`` [m2] that holds until they are evaluated."""
        self.nodes = nodes
        #: whether the hole has been evaluated at the nodes
        self.evaluated = False
        # filled in place: records of steps have their addresses
        self.depth, self.volume, self.ahead, self._ringed = np.zeros((4, len(nodes)))
        self.area = np.full(len(nodes), area)

    @property
    def hole(self) -> HoleVolume:
        """Volume of the present hole."""
        well = self.current_well()
        if well is not self._hole.well:
            self._hole = HoleVolume(well)
        return self._hole

    def follow(self, state, keep: bool) -> np.ndarray | None:
        """Re-evaluate the hole at the local nodes that have moved; returns their mask (nv,), None if no node has moved.

        keep: volumes change by the integral of the rates, as in ``update``.
        """
        self.moved = self._evaluate(state, keep)
        return self.moved if self.moved is not None and self.moved.any() else None

    def forget(self) -> None:
        """Let the next ``follow`` evaluate the hole at all nodes."""
        self.evaluated = False

    def _evaluate(self, state, keep: bool) -> np.ndarray | None:
        leader = self.leader if keep else None
        if leader is not None and leader.moved is None:
            return None
        if keep and leader is None and not self.reamers and self._stays(state):  # as after almost every step
            return None
        reamed = [reamer.reamed for reamer in self.reamers]
        ringed = bool(reamed) and any(
            abs(b - before) > REAMED for b, before in zip(reamed, self._reamed, strict=True)
        )
        if self._restored is not None:
            self._remember(state, self._restored)
        if keep and leader is None and not ringed and self._stays(state):
            return None
        position, found = self._project(state)
        way = None
        if keep and self._from is not None:
            places, directions = np.hsplit(self._from[2], 2)
            way = np.sum((position - places) * directions, axis=1)
        # at the start the shoulder is at its given depth, wherever the string has moved since
        everywhere = ringed or (bool(self.reamers) and not keep)
        moved = self.update(found.md, keep, everywhere, way, None if leader is None else leader.moved)
        if moved.all():
            self._reamed = reamed
        # positions at the depths of the last evaluation
        since = found.md - self.depth if way is None else np.where(moved, 0.0, way)
        at_depth = position - found.tangent * since[:, None]
        self._remember(state, np.hstack([at_depth, found.tangent]))
        return moved

    def _project(self, state) -> tuple[FloatArray, ClosestPoints]:
        """Positions (nv, 3) of the local nodes [m], and the points of the present hole's axis next to them."""
        position = state.x[state.layout.dofs["string.position"]]
        found = self.current_well().project(position, self._near)
        self._near = found.segment
        return position, found

    def _remember(self, state, nodes: FloatArray) -> None:
        """Keep the places of the local ``nodes`` in the hole, and its direction there, (nv, 6), for ``_stays``."""
        places = np.ascontiguousarray(state.layout.dofs["string.position"], dtype=np.int32)
        self._from, self._restored = (self.current_well(), places, nodes), None
        self._from_at = pointer(places), pointer(nodes)

    @property
    def places(self) -> FloatArray:
        """(nv, 3) positions of the local nodes when the hole was evaluated there [m]."""
        assert self._from is not None
        return self._from[2][:, :3]

    def _stays(self, state) -> bool:
        """Whether no local node has moved by SURELY_NEAR; found without a projection."""
        if self._from is None or self._from[0] is not self.current_well():
            return False
        places, nodes = self._from_at
        return not _moved_along(len(self.depth), places, state.state_at[0], nodes, *SURELY_NEAR)

    def annulus(self, e: np.ndarray, ends: FloatArray) -> Annulus:
        """Create the annulus of the elements ``e`` (k,) whose nodes are at measured depths ``ends`` (k, 2) [m]."""
        return self.walls.annulus(self.hole, e, ends[:, 0] + self.mesh.rigid_above[e], ends[:, 1])

    def update(
        self,
        depths: FloatArray,
        keep: bool,
        everywhere: bool = False,
        way: FloatArray | None = None,
        where: np.ndarray | None = None,
    ) -> np.ndarray:
        """Re-evaluate the hole at the nodes that have moved; returns their mask (nv,).

        depths: (nv,) present measured depths of the nodes [m]; everywhere: at all nodes.
        where: (nv,) at these nodes instead.
        way: (nv,) motion of the nodes in the directions of the hole at the last evaluation, which the rates of the rows integrate; it
        differs from that of the depths where a node is off the axis of a bend; None: that of the depths [m].
        keep: volumes change by the integral of the rates.  A node that has moved further than ``ahead`` gets
        the true volume.  Without ``keep`` all volumes are taken from the hole.
        """
        if not self.evaluated:
            self.depth[:], self.evaluated, keep, everywhere, where = depths, True, False, True, None
        moved = (np.abs(depths - self.depth) > REFRESH) | everywhere if where is None else where
        if moved.any():
            hole, here = self.hole, depths[moved]
            way = (depths - self.depth if way is None else way)[moved]
            volume, ahead = hole.volume(here), np.full(len(here), AHEAD)
            ringed = self._rings(moved, lambda reamer: reamer.reamed)
            if keep:
                volume = np.where(
                    np.abs(way) > self.ahead[moved],
                    volume,
                    self.volume[moved] + self.area[moved] * way + ringed - self._ringed[moved],
                )
                ahead = np.copysign(np.maximum(AHEAD, 2 * np.abs(way)), way)
            self.depth[moved], self.volume[moved], self.ahead[moved] = here, volume, np.abs(ahead)
            self._ringed[moved] = ringed
            self.area[moved] = (self._volume_ahead(moved, here, ahead) - volume) / ahead
        return moved

    def _rings(self, moved: np.ndarray, share: Callable[[Reamer], float]) -> FloatArray:
        """(k,) sum over the reamers above the ``moved`` nodes of their ring times ``share`` of the reamer."""
        out = np.zeros(int(moved.sum()))
        for reamer in self.reamers:
            out[self.nodes[moved] > reamer.node] += reamer.ring * share(reamer)
        return out

    def _volume_ahead(self, moved: np.ndarray, here: FloatArray, ahead: FloatArray) -> FloatArray:
        """(k,) volume of hole [m3] above the ``moved`` nodes at ``here`` when they are ``ahead`` further on, minus the rings
        cut on the way, which enter through the rates of the reamers."""
        hole = self.hole
        if not self.reamers or not all(reamer.stands for reamer in self.reamers):
            return hole.volume(here + ahead)
        # all of the hole below the uppermost shoulder moves along, and the hole above is as wide as there
        shoulder = self.reamers[0].shoulder + self.reamers[0].reamed
        first, last = np.minimum(here, shoulder), np.minimum(here + ahead, shoulder)
        moving = hole.volume(here) + hole.volume(last) - hole.volume(first)
        moving += hole.area(shoulder) * (ahead - (last - first))
        moving -= ahead * self._rings(moved, lambda reamer: 1.0)
        return np.where(ahead > 0, moving, hole.volume(here + ahead))

    def sizes(
        self, ends: np.ndarray, without_length: np.ndarray, rigid: FloatArray, around: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Compute the mean area of the hole (k,) [m2] between nodes ``ends`` (k, 2), and its change with
        their depth (k,) [m].

        without_length: (k,) mask of joints, between whose nodes there is only their travel.
        rigid: (k,) length of the rigid item below the first node [m], which is left out; around: (k,) area of the hole there [m2].
        """
        first, second = ends.T
        length = np.where(without_length, 1.0, self.depth[second] - self.depth[first])
        area = (self.volume[second] - self.volume[first] - around * rigid) / (length - rigid)
        return (
            np.where(without_length, self.area[second], area),
            np.where(without_length, 0.0, (self.area[second] - self.area[first]) / length),
        )

    def get_state(self) -> FloatArray:
        """Return (nv, 10) for a checkpoint: depth, volume, area, ahead, position and direction at the last evaluation; with k reamers
        (nv, 11 + k), also rings and reamed length."""
        nodes = self._restored if self._from is None else self._from[2]
        assert nodes is not None
        rings = [self._ringed, *(np.full(len(self.depth), b) for b in self._reamed)] if self.reamers else []
        return np.column_stack([self.depth, self.volume, self.area, self.ahead, nodes, *rings])

    def set_state(self, saved: FloatArray) -> None:
        """Continue from the result of ``get_state``."""
        self.depth[:], self.volume[:], self.area[:], self.ahead[:] = saved.T[:4]
        self.evaluated = True
        # anew from the present state, other nodes would be renewed, or at another step, than without the checkpoint
        self._from, self._restored = None, np.ascontiguousarray(saved[:, 4:10])
        self._ringed[:] = saved.T[10] if self.reamers else 0.0
        self._reamed = [float(row[0]) for row in saved.T[11:]]
