"""Mud and the rings of rock that reamers cut out of the wall.

Kernel: kernels/fluid/bit_flow.hpp.  Manual: sec-reamer-mud.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.component import Component, ElementBlock, Powers
from drillpetsc.kernels.parameters import Parameters
from drillpetsc.physics.fluid.channel_flow import FluidConstants
from drillpetsc.physics.rigid_bodies import local_vertices
from drillpetsc.physics.tools.reamer import Reamer


class ReamedRings(Component):
    """Volume that the annulus gains, and rock that becomes mud, as reamers advance (manual: eq-reamer-mud).

    The hole above the nodes below a reamer grows by its ring (``physics.fluid.moving_hole``).  If the cuttings are removed,
    mud fills the ring. If they are returned, the rock becomes mud without any flow.

    last: number of the last node, whose chamber takes the ring of a reamer there by itself.
    reamers: from the top; fluid: constants; returned: the mud returns the cuttings.
    """

    name = "reamed_rings"

    def __init__(self, last: int, reamers: tuple[Reamer, ...], fluid: FluidConstants, returned: bool):
        self.reamers, self.fluid, self.returned, self._last = reamers, fluid, returned, last

    def _gained(self, reamer: Reamer) -> float:
        """Volume of mud that flows in per metre reamed [m2]; negative if rock becomes mud in the chamber at the bit."""
        in_chamber = reamer.node == self._last
        return reamer.ring * (float(not in_chamber) - float(self.returned))

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        out = []
        self._here: list[tuple[Reamer, int]] = []
        for reamer in self.reamers:
            _, vertices = local_vertices(part, np.array([reamer.node]))
            self._here += [(reamer, int(v)) for v in vertices]
            gained = self._gained(reamer)
            if gained == 0.0:
                continue
            params = Parameters("reamed_ring", len(vertices), ring=gained)
            block = ElementBlock(
                f"ring_of_{reamer.name}",
                "reamed_ring",
                "vertex",
                vertices,
                (("annulus.pressure", 0), (reamer.depth_field, 0)),
                (),
                params.array,
                context=self.fluid.address,
            )
            block.keep = (self.fluid,)
            out.append(block)
        return tuple(out)

    def _state(self, reamer: Reamer, vertex: int, state) -> tuple[float, float, float]:
        """Pressure [Pa] and head [Pa] of the mud at the reamer, and its rate [m/s]."""
        dofs = state.layout.dofs
        pressure = float(state.x[dofs["annulus.pressure"][vertex, 0]])
        head = self.fluid.density * float(self.fluid.gravity @ state.x[dofs["string.position"][vertex]])
        return pressure, head, float(state.y[dofs[reamer.depth_field][vertex, 0]])

    def cuttings(self, state) -> float:
        """Rock that becomes mud [m3/s at zero pressure], on this rank."""
        out = 0.0
        for reamer, vertex in self._here if self.returned else ():
            pressure, _, rate = self._state(reamer, vertex, state)
            out += reamer.ring * rate * float(np.exp(pressure / self.fluid.bulk_modulus))
        return out

    def powers(self, t: float, state) -> Powers:
        """The rock yields to the pressure; cuttings bring their flow work and their height."""
        supplied = 0.0
        for reamer, vertex in self._here:
            pressure, head, rate = self._state(reamer, vertex, state)
            if reamer.node != self._last:  # the chamber at the bit counts the work on the rock below it
                supplied -= pressure * reamer.ring * rate
            if self.returned:
                mud = reamer.ring * rate * float(np.exp(pressure / self.fluid.bulk_modulus))
                supplied += mud * (float(self.fluid.enthalpy(pressure)) - head)
        return Powers(supplied=supplied)
