"""A bit that rests on the end of the hole: a spring along its axis, friction against turning and sliding (manual: sec-bit-on-bottom)."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import ElementBlock
from drillpetsc.fem.quantity import Quantity
from drillpetsc.kernels.parameters import Parameters, columns, constant
from drillpetsc.physics import quantities as declared
from drillpetsc.physics.contact import penetration
from drillpetsc.physics.interfaces import Bit
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices

NOT_IMPOSED = constant("not_imposed")
RESULTS = columns("bit_contact_results")
_WEIGHT, _POWER = RESULTS["weight"], RESULTS["power"]


def bit_torque(weight: float, friction: float, radius: float) -> float:
    """Torque [N m] of a disc that turns under ``weight`` [N], pressed evenly: 2/3 of friction, weight and radius [m]."""
    return weight * friction * radius * 2 / 3


class BitOnBottom(Bit):
    """The bit rests on the end of the hole: a spring along its axis, and friction of its face."""

    name = "bit"

    def __init__(
        self,
        node: int,
        face: float,
        radius: float,
        stiffness: float,
        friction: float,
        end: FloatArray,
        axis: FloatArray,
        slip_velocity: float = 0.01,
    ):
        self.node = node
        self.stiffness = stiffness
        self.face, self.radius, self.friction, self.slip_velocity = face, radius, friction, slip_velocity
        self.end, self.axis = np.array(end, dtype=float), np.array(axis, dtype=float)

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([self.node]))
        params = Parameters(
            "bit_contact",
            len(vertices),
            face=self.face,
            radius=self.radius,
            stiffness=self.stiffness,
            friction=self.friction,
            end=self.end,
            axis=self.axis,
            slip=self.slip_velocity,
            imposed=NOT_IMPOSED,
        )
        self._block = ElementBlock(
            "bit_bottom", "bit_contact", "vertex", vertices, VERTEX_SLOTS, (0,), params.array
        )
        return (self._block,)

    def impose_sliding_direction(
        self, axial: float, spin: float, side: float = 1.0, motor: float = 0.0
    ) -> None:
        self._block.named["imposed"] = np.sign(spin + motor)

    def release_sliding_direction(self) -> None:
        self._block.named["imposed"] = NOT_IMPOSED

    def copy_sliding_direction(self, other) -> None:
        """Take over the sliding that statics imposed on the bit of another model."""
        self._block.params[:] = other._block.params

    def element_results_of(self, steps) -> FloatArray:
        """(k, 3) weight on bit [N], torque on bit [N m] and power of the friction of its face [W]."""
        return np.asarray(steps.sums(self._block, "bit_contact_results", RESULTS.width))

    def depth_of_face(self, state) -> tuple[float, FloatArray]:
        """How far the face is below the end of the hole [m], and its gradient by the local unknowns (n,);
        zero without the bit."""
        gradient = np.zeros(len(state.x))
        if not len(self._block.points):
            return 0.0, gradient[: state.layout.size]
        index = state.index_of(self._block)[0]
        face, end, axis = self.face, self.end, self.axis
        v = state.x[index[3:6]]
        n = np.linalg.norm(v)
        gradient[index[:3]] = axis
        gradient[index[3:6]] = face * (axis - v * (v @ axis) / n**2) / n
        return float((state.x[index[:3]] + face * v / n - end) @ axis), gradient[: state.layout.size]

    def torque_for(self, weight: float, spin: float) -> float:
        """Friction torque [N m] of the bit that turns with ``spin`` [rad/s] under ``weight`` [N]."""
        return bit_torque(weight, self.friction, self.radius)

    def depth_for(self, weight: float) -> float:
        """Penetration [m] at which the bit carries ``weight`` [N] (manual: eq-contact-onset)."""
        return float(penetration(weight / self.stiffness))

    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        return 0.0, 0.5 * self.element_results_of(steps)[:, _WEIGHT] ** 2 / self.stiffness, 0.0

    def powers_of(self, steps) -> tuple[Any, Any]:
        return self.element_results_of(steps)[:, _POWER], 0.0

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.BIT
