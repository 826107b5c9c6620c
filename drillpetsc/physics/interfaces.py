"""Interfaces of components that have more than one implementation: beam, top, bit, drive."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.component import Component
from drillpetsc.fem.quantity import OneStep
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well


class Beam(Component):
    """Elements of the string."""

    #: whether the string moves; one that is held has no unknowns
    moves: bool = True
    #: name of the formation in the case file: ``ancf`` or ``quaternion``
    formulation: str = ""
    #: statics starts from the equilibrium of the ANCF element, which Newton's method corrects
    needs_ancf_equilibrium: bool = False
    #: field of the section's direction at a node, whose rows hold the couples about the node
    orientation: str = ""
    #: the spin angle is known up to a multiple of this [rad]; 0: it counts all turns
    angle_period: float = 0.0

    @abstractmethod
    def place(self, system: Any, position: FloatArray, tangent: FloatArray) -> None:
        """Put the unstrained string at rest on ``position`` (n_nodes, 3) [m] with directions ``tangent``
        (n_nodes, 3).
        """

    @abstractmethod
    def set_rigid_motion(
        self,
        system: Any,
        tangent: FloatArray,
        curvature: FloatArray,
        lowering: float | FloatArray,
        rotation: float | FloatArray,
    ) -> None:
        """Set the velocity of every node to ``lowering`` [m/s] along the hole, its spin to ``rotation`` [rad/s].

        lowering, rotation: (n_nodes,) if they differ along the string.
        tangent: (n_nodes, 3) of the hole at the nodes; curvature: (n_nodes, 3) its derivative [1/m].
        """

    @abstractmethod
    def impose_rigid_motion(self, system: Any, rates: FloatArray, lowering: float, rotation: float) -> None:
        """Write the rates of a string that moves along itself with ``lowering`` [m/s] and turns in place with ``rotation`` [rad/s].

        rates: (n,) of the local unknowns, in which the rates of the string's position and section are replaced.
        """

    @abstractmethod
    def first_node(self, fields: Mapping[str, FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position (3,) [m], slope (3,) [-] and spin angle (1,) [rad] of the top node.

        fields: (n_nodes, size) values of the string's fields, by name.
        """

    @abstractmethod
    def section(self, state: Any, vertex: int | IntArray) -> tuple[FloatArray, FloatArray, Any]:
        """Position (3,) [m], slope (3,) [-] and spin rate [rad/s] of a local vertex; of k vertices (k, 3), (k, 3), (k,)."""

    @abstractmethod
    def nodal_motion(self, state: Any, vertices: IntArray) -> FloatArray:
        """(3, k, 7) position [m], slope [-] and spin angle [rad] of k local vertices, their rates and accelerations.

        The rate of the spin angle is the spin rate, the rate of rotation about the tangent.
        """

    @abstractmethod
    def columns(self, state: Any) -> FloatArray:
        """Return (nv, 8) at the local vertices: position (3) [m], velocity (3) [m/s], spin rate [rad/s], spin
        angle [rad].
        """

    @abstractmethod
    def couple(self, values: FloatArray, rows: FloatArray) -> FloatArray:
        """(n, 3) couples about nodes [N m] that the rows of the field ``orientation`` stand for, across the tangent.

        values, rows: (n, k) the field and its rows; what a result has along the tangent has no meaning.
        """

    @abstractmethod
    def element_results(self, state: Any) -> FloatArray:
        """(nc, 9) per local cell in depth order: the columns of ``physics.beam.RESULT_NAMES``."""


class Top(Component):
    """Upper end of the string, fixed or moved.  ``anchor``: prescribed values at time 0 [m, -, rad].

    ``shift`` changes them.
    """

    anchor: FloatArray
    #: whether anything is prescribed at this end
    prescribes: bool = True

    @abstractmethod
    def shift(self, distance: float) -> None:
        """Move the prescribed axial position by ``distance`` [m], down positive."""

    @property
    def on_path(self) -> bool:
        """Whether the end moves along a curved path; ``anchor`` then has coordinates on the path."""
        return False

    def prescribed_position(self) -> FloatArray:
        """Return the prescribed position (3,) at time 0 [m]; only where ``on_path``."""
        raise NotImplementedError

    def place(self) -> tuple[float, FloatArray, FloatArray]:
        """Return a point of the path near the end: depth [m], centre (3,) [m], tangent (3,); only of a top that may be free."""
        raise NotImplementedError

    def displace(self, offset: FloatArray) -> None:
        """Move the prescribed position by ``offset`` (3,) [m]."""
        for condition in self.prescribed():
            self.anchor += condition.directions[:, :3] @ offset

    def place_across(self, position: FloatArray) -> None:
        """Prescribe at time 0 the place of ``position`` (3,) [m] across the path of the top."""

    def copy_position(self, other: Top) -> None:
        """Copy the prescribed position at time 0 from the top of another model with other elements."""

    def align(self, position: FloatArray, slope: FloatArray, spin: FloatArray) -> None:
        """Prescribe at time 0 the given position (3,) [m], slope (3,) [-] and spin angle (1,) [rad] of the top node."""
        for condition in self.prescribed():
            self.anchor[:] = condition.directions @ np.concatenate([position, slope, spin])


class FreeTop(Top):
    """Upper end at which nothing is prescribed."""

    prescribes = False

    def __init__(self) -> None:
        self.anchor = np.empty(0)

    def shift(self, distance: float) -> None:
        """Nothing moves: the axial position is not prescribed."""


@dataclass(frozen=True)
class SideContact:
    """Contact of a bit that cuts with the side of its hole, at one point of its axis.

    below: distance of that point below the bit's node [m]; stiffness [N/m], 0: it does not touch; clearance: radial [m].
    """

    below: float
    stiffness: float
    clearance: float


class Bit(Component):
    """The bit at the lower end of the string.  ``stiffness``: of its contact with the bottom [N/m]."""

    #: the growing hole of a bit that cuts rock, None otherwise
    hole: GrowingHole | None = None
    stiffness: float = 0.0

    @property
    def side_contact(self) -> SideContact | None:
        """Contact with the side of the hole; None: as a rigid item."""
        return None

    @abstractmethod
    def element_results_of(self, steps: OneStep) -> FloatArray:
        """(k, columns) results of the bit after each of k steps, zero on ranks without it: weight [N] and torque [N m] first."""

    def element_results(self, state: Any) -> FloatArray:
        """(columns,) ``element_results_of`` the present state."""
        return np.asarray(self.element_results_of(OneStep(state, 0.0))[0])

    def weight_and_torque(self, state: Any) -> tuple[float, float]:
        """Weight on bit [N] and torque on bit [N m], zero on ranks without the bit."""
        weight, torque = self.element_results(state)[:2].tolist()
        return weight, torque

    def direction_of(self, steps: Any) -> FloatArray:
        """(k, 3) direction of the hole that the bit drills, at its end, after each of k recorded steps."""
        raise NotImplementedError("this bit drills no hole")

    @abstractmethod
    def depth_of_face(self, state: Any) -> tuple[float, FloatArray]:
        """Compute the depth of the face below the end of the hole [m] and its gradient (n,) by the local unknowns."""

    @abstractmethod
    def depth_for(self, weight: float) -> float:
        """Compute the depth [m] at which the resting bit carries ``weight`` [N]."""

    @abstractmethod
    def torque_for(self, weight: float, spin: float) -> float:
        """Compute the torque [N m] of the bit that turns with ``spin`` [rad/s] under ``weight`` [N].

        It is not negative; it brakes the rotation.
        """

    @abstractmethod
    def copy_sliding_direction(self, other: Any) -> None:
        """Copy the sliding direction that statics imposed on the bit of another model."""

    def rate_under(
        self, force: FloatArray, axis: FloatArray, omega: float, drilled: float = 0.0
    ) -> FloatArray:
        """(3,) rate of penetration [m/s] under ``force`` (3,) of the bit on the rock [N]; zero without rock.

        axis: (3,) of the bit; omega: its rotation [rad/s]; drilled: length of new hole [m].
        """
        return np.zeros(3)

    def progress_of(self, steps: OneStep) -> FloatArray:
        """(k, 2) length drilled since the start [m] and rate of penetration [m/s] after each of k steps, zero on ranks without the
        bit."""
        return np.zeros((len(steps), 2))

    @property
    def side_strength(self) -> float | None:
        """Force at which the rock beside the bit yields [N]; None if it does not."""
        return None

    def orbit_and_overgauge(self, state: Any) -> tuple[float, float]:
        """Distance of the bit's centre from the axis of its hole and radius of the hole beside the bit minus radius of the bit [m].

        Zero on ranks without the bit, and without rock.
        """
        return 0.0, 0.0

    def drilled_hole(self) -> Well | None:
        """Return the hole with its new part; None if nothing is drilled."""
        return None

    @property
    def drills(self) -> bool:
        """Whether the bit cuts rock."""
        return self.hole is not None


class Drive(Component):
    """A drive that turns the upper end."""

    def torque(self, t: float, state: Any) -> float:
        """Torque of the drive on the string [N m], this rank's share."""
        raise NotImplementedError

    def results(self, state: Any) -> FloatArray:
        """Results of the drive on the rank with the top, zero elsewhere; empty for a drive without any."""
        return np.zeros(0)

    def figures(self, t: float, state: Any) -> FloatArray:
        """Numbers of its quantities at the time ``t`` [s], this rank's share; empty for a drive without any."""
        return np.zeros(0)
