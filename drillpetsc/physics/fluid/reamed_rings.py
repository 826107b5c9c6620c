"""Mud and the rings of rock that reamers cut out of the wall.

Kernel: kernels/fluid/bit_flow.hpp.  Manual: sec-reamer-mud.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock
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

    def _mud_of(self, steps, reamer: Reamer, vertex: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Pressure [Pa] of the mud at the reamer, metres reamed per time [m/s], and mud that their rock becomes [m3/s at zero
        pressure], (k,) each."""
        dofs = steps.assembly.layout.dofs
        pressure = steps.unknowns(dofs["annulus.pressure"].item(vertex, 0))
        rate = steps.rates(dofs[reamer.depth_field].item(vertex, 0))
        mud = reamer.ring * rate * np.exp(pressure / self.fluid.bulk_modulus)
        return pressure, rate, mud if self.returned else 0.0 * mud

    def cuttings_of(self, steps) -> Any:
        """(k,) rock that becomes mud [m3/s at zero pressure], on this rank."""
        return sum(self._mud_of(steps, *here)[2] for here in self._here)

    def powers_of(self, steps) -> tuple[Any, Any]:
        """The rock yields to the pressure; cuttings bring their flow work and their height."""
        supplied: Any = 0.0
        for reamer, vertex in self._here:
            pressure, rate, mud = self._mud_of(steps, reamer, vertex)
            place = steps.unknowns(steps.assembly.layout.dofs["string.position"][vertex])
            head = self.fluid.density * (place @ self.fluid.gravity)
            if reamer.node != self._last:  # the chamber at the bit counts the work on the rock below it
                supplied = supplied - pressure * reamer.ring * rate
            supplied = supplied + mud * (self.fluid.enthalpy(pressure) - head)
        return 0.0, supplied
