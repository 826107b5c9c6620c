"""Interfaces of beam, top end and bit, for callers that work with every kind of them."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well


class Beam(Component):
    """Elements of the string."""

    #: name of the formation in the case file: ``ancf`` or ``quaternion``
    formulation: str = ""
    #: statics starts from the equilibrium of the ANCF element, which Newton's method corrects
    needs_ancf_equilibrium: bool = False

    @abstractmethod
    def place(self, system: Any, position: FloatArray, tangent: FloatArray) -> None:
        """Put the unstrained string at rest on ``position`` (n_nodes, 3) [m] with directions ``tangent``
        (n_nodes, 3).
        """

    @abstractmethod
    def set_rigid_motion(self, system: Any, tangent: FloatArray, lowering: float, rotation: float) -> None:
        """Set the velocity of every node to ``lowering`` [m/s] along ``tangent`` (n_nodes, 3), its spin to
        ``rotation`` [rad/s].
        """

    @abstractmethod
    def section(self, state: Any, vertex: int) -> tuple[FloatArray, FloatArray, float]:
        """Position [m], slope [-] and spin rate [rad/s] of a local vertex."""

    @abstractmethod
    def columns(self, state: Any) -> FloatArray:
        """Return (nv, 8) at the local vertices: position (3) [m], velocity (3) [m/s], spin rate [rad/s], spin
        angle [rad].
        """

    @abstractmethod
    def report(self, layout: Any, x: FloatArray, y: FloatArray) -> FloatArray:
        """Compute (nc, 9) for the local cells in depth order: the columns of ``physics.beam.REPORT``.

        x, y: (array_length,) unknowns and rates of the assembly.
        """


class Top(Component):
    """Upper end of the string, fixed or moved.  ``anchor``: prescribed values at time 0 [m, -, rad].

    ``shift`` changes them.
    """

    anchor: FloatArray

    @abstractmethod
    def shift(self, distance: float) -> None:
        """Move the prescribed axial position by ``distance`` [m], down positive."""

    def displace(self, offset: FloatArray) -> None:
        """Move the prescribed position by ``offset`` (3,) [m]."""
        for condition in self.prescribed():
            self.anchor += condition.directions[:, :3] @ offset

    def copy_position(self, other: Top) -> None:
        """Copy the prescribed position at time 0 from the top of another model with other elements."""

    def align(self, position: FloatArray, slope: FloatArray, spin: FloatArray) -> None:
        """Prescribe at time 0 the given position (3,) [m], slope (3,) [-] and spin angle (1,) [rad] of the top node."""
        for condition in self.prescribed():
            self.anchor[:] = condition.directions @ np.concatenate([position, slope, spin])


class Bit(Component):
    """The bit at the lower end of the string.  ``stiffness``: of its contact with the bottom [N/m]."""

    #: the growing hole of a bit that cuts rock, None otherwise
    hole: GrowingHole | None = None
    stiffness: float = 0.0

    @abstractmethod
    def weight_and_torque(self, state: Any) -> tuple[float, float]:
        """Compute weight on bit [N] and torque on bit [N m], zero on ranks without the bit."""

    @abstractmethod
    def depth_of_face(self, state: Any) -> tuple[float, FloatArray]:
        """Compute the depth of the face below the end of the hole [m] and its gradient (n,) by the local unknowns."""

    @abstractmethod
    def depth_for(self, weight: float) -> float:
        """Compute the depth [m] at which the resting bit carries ``weight`` [N]."""

    @abstractmethod
    def torque_for(self, weight: float) -> float:
        """Compute the torque [N m] of the turning bit under ``weight`` [N]."""

    @abstractmethod
    @contextmanager
    def preloaded(self, weight: float, travel: float) -> Iterator[None]:
        """Context in which a soft spring replaces the bottom.

        It carries ``weight`` [N] after ``travel`` [m].
        """

    @abstractmethod
    def copy_sliding_direction(self, other: Any) -> None:
        """Copy the sliding direction that statics imposed on the bit of another model."""

    def first_cut(self, state: Any) -> None:
        """Set the rates of a bit that begins to drill from its weight and speed."""

    def progress(self, state: Any) -> tuple[float, float]:
        """Length drilled since the start [m] and rate of penetration [m/s], zero on ranks without the bit."""
        return 0.0, 0.0

    def drilled_hole(self) -> Well | None:
        """Return the hole with its new part; None where nothing is drilled."""
        return None

    @property
    def drills(self) -> bool:
        """Whether the bit cuts rock."""
        return self.hole is not None
