"""Drilling fluid in the bore of the string, pumped in at its upper end (kernels/fluid/bore_flow.hpp; manual:
sec-mud).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import ElementBlock
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.kernels.parameters import Parameters, Table
from drillpetsc.physics.fluid.channel_flow import SPEED, ChannelFlow, FluidConstants
from drillpetsc.physics.fluid.channels import Bore
from drillpetsc.physics.rigid_bodies import local_vertices
from drillpetsc.time_function import TimeFunction

JOINT_SHARE = 0.25  # share of the inertia of the flow above a joint that moves with the flow of the joint


class BoreFlow(ChannelFlow):
    """Flow in the bore: pressure [Pa] at the nodes, flow rate at zero pressure [m3/s] in the elements, towards the bit.

    mesh: of the string; bore: of its elements; fluid: constants.
    poisson: (n,) Poisson's ratio [-], 0 if stretch does not narrow the bore (manual: eq-mud-narrowing).
    flow_rate [m3/s] or pump_pressure [Pa]: over time, at the upper end.
    held_at: (n+1, 3) positions of the nodes of a held string [m], None for a string that moves.
    """

    name = "bore"

    def __init__(
        self,
        mesh: StringMesh,
        bore: Bore,
        fluid: FluidConstants,
        poisson: FloatArray,
        flow_rate: TimeFunction | None,
        pump_pressure: TimeFunction | None = None,
        held_at: FloatArray | None = None,
    ):
        super().__init__(mesh, fluid, poisson, held_at)
        self.bore, self.flow_rate, self.pump_pressure = bore, flow_rate, pump_pressure
        self._inertia: ElementBlock | None = None

    def parameters(self, e: np.ndarray) -> Table:
        return Parameters("bore_flow", len(e), **self._channel(e), **self._entry(e))

    def _channel(self, e: np.ndarray) -> dict[str, FloatArray]:
        """Parameters of the elements ``e`` (k,) that do not depend on how the flow is discretised."""
        b = self.bore
        return {
            **self._along(e),
            "area": b.area[e],
            "area_above": b.area_above[e],
            "wall": b.wall[e],
            **b.friction(e),
            "diameter_above": b.diameter_above[e],
        }

    def _entry(self, e: np.ndarray) -> dict[str, FloatArray]:
        """Losses at the entry of the flow into the elements ``e`` (k,), and the pressure at the upper end."""
        area, above = self.bore.area[e], self.bore.area[np.maximum(e - 1, 0)]
        zero = np.zeros(len(e))
        return {
            "step": np.where(e > 0, 0.5 * (1 / area**2 - 1 / above**2), 0.0),
            "loss": zero if self.bore.tool is None else self.bore.tool[e],
            "control": np.where((e == 0) & (self.pump_pressure is not None), 1.0, 0.0),
            "controlled": zero,
        }

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        elements = super().blocks(part)
        _, vertices = local_vertices(part, np.array([0]))
        self._is_top = bool(len(vertices))
        self._inertia = None if self.held or not self.mesh.is_joint.any() else self._inertia_of_joints(part)
        if self._inertia is not None:
            elements = (*elements, self._inertia)
        if self.flow_rate is None:
            return elements
        params, flow = Parameters("pump", len(vertices), flow=0.0), self.flow_rate
        now = params["flow"]

        def update(t: float) -> None:
            now[:] = flow.value(t)

        self._pump = ElementBlock(
            "pump", "pump", "vertex", vertices, (("bore.pressure", 0),), (), params.array, update=update
        )
        return (*elements, self._pump)

    def _inertia_of_joints(self, part) -> ElementBlock:
        """Block of the joints without an arm below an element, which share the inertia of the element's flow.

        Manual: eq-mud-joint-inertia.
        """
        m = self.mesh
        shares = m.is_joint & (m.rigid_above == 0)
        shares[0] = False
        shares[1:] &= ~m.is_joint[:-1]
        chosen = np.flatnonzero(shares[part.cells]).astype(np.int32)
        above = part.cells[chosen] - 1
        inertia = JOINT_SHARE * self.fluid.density * m.length[above] / self.bore.area[above]
        params = Parameters("joint_inertia", len(chosen), inertia=inertia)
        slots = (("bore.flow", 0), ("bore.flow", 1))
        return ElementBlock("bore_flow_inertia", "joint_inertia", "cell", chosen, slots, (), params.array)

    def _update_of(self, block: ElementBlock):
        pressure = self.pump_pressure
        if pressure is None or self._top is None or self._top[0] is not block:
            return None
        row, controlled = self._top[1], block.named["controlled"]

        def update(t: float) -> None:
            controlled[row] = pressure.value(t)

        return update

    def breaks(self) -> tuple[float, ...]:
        given = self.flow_rate or self.pump_pressure
        return given.breaks() if given is not None else ()

    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        kinetic, strain, potential = super().energies_of(steps)
        if self._inertia is not None and len(self._inertia.points):
            flows = steps.unknowns(steps.assembly.index_of(self._inertia).ravel())
            above, joint = flows[:, ::2], flows[:, 1::2]
            kinetic = kinetic + 0.5 * (joint**2 - above**2) @ self._inertia.named["inertia"]
        return kinetic, strain, potential

    def pumped_of(self, steps) -> FloatArray | None:
        """(k,) flow rate into the string [m3/s] after each of k steps; None on ranks without its top."""
        if not self._is_top:
            return None
        if self.flow_rate is None:
            return self.upper_flow_of(steps)
        return np.array([float(self.flow_rate.value(t)) for t in steps.times])

    def powers_of(self, steps) -> tuple[Any, Any]:
        supplied: Any = 0.0
        flow = self.pumped_of(steps)
        if flow is not None and self._top is not None:
            # the mud arrives at the upper node without momentum from outside
            (place, velocity), speed = self._upper_motion_of(steps), self._top_result_of(steps, SPEED)
            supplied = flow * (
                self.fluid.enthalpy(self.upper_pressure_of(steps))
                + 0.5 * self.fluid.density * (speed**2 - np.sum(velocity * velocity, axis=1))
                - self.fluid.density * np.sum(place * self.fluid.gravity, axis=1)
            )
        return self._channel_powers_of(steps, supplied)
