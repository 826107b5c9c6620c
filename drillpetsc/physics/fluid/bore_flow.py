"""Drilling fluid in the bore of the string, pumped in at its upper end (kernels/fluid/bore_flow.hpp; manual:
sec-mud).
"""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import ElementBlock, Energies, Powers
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.physics.fluid.channel_flow import FIGURES, ChannelFlow, FluidConstants
from drillpetsc.physics.fluid.channels import Bore
from drillpetsc.physics.rigid_bodies import local_vertices
from drillpetsc.time_function import TimeFunction

_CONTROLLED = 11  # column of the given pressure, as in the kernel


class BoreFlow(ChannelFlow):
    """Flow in the bore: pressure [Pa] at the nodes, flow rate at zero pressure [m3/s] in the elements, towards the bit.

    mesh: of the string; bore: of its elements; fluid: constants.
    poisson: (n,) Poisson's ratio [-], 0 where stretch does not narrow the bore (manual: eq-mud-narrowing).
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
        super().__init__(mesh, fluid, held_at is not None)
        self.bore, self.poisson, self.flow_rate, self.pump_pressure, self.held_at = (
            bore,
            poisson,
            flow_rate,
            pump_pressure,
            held_at,
        )

    def parameters(self, e: np.ndarray) -> FloatArray:
        m, b = self.mesh, self.bore
        above = b.area[np.maximum(e - 1, 0)]
        step = np.where(e > 0, 0.5 * (1 / b.area[e] ** 2 - 1 / above**2), 0.0)
        length, zero = m.length[e], np.zeros(len(e))
        drop = head = zero
        if self.held_at is not None:
            length = length + m.rigid_above[e]
            drop = (self.held_at[e + 1] - self.held_at[e]) @ self.fluid.gravity
            head = 0.5 * (self.held_at[e + 1] + self.held_at[e]) @ self.fluid.gravity
        control = np.where((e == 0) & (self.pump_pressure is not None), 1.0, 0.0)
        return np.column_stack(
            [
                length,
                m.rigid_above[e] if self.held_at is None else zero,
                self.poisson[e],
                b.area[e],
                b.area_above[e],
                b.wall[e],
                b.diameter[e],
                b.diameter_above[e],
                step,
                zero,
                control,
                zero,
                drop,
                head,
            ]
        )

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        elements = super().blocks(part)
        _, vertices = local_vertices(part, np.array([0]))
        self._is_top = bool(len(vertices))
        if self.flow_rate is None:
            return elements
        params, flow = np.zeros((len(vertices), 1)), self.flow_rate

        def update(t: float) -> None:
            params[:, 0] = flow.value(t)

        self._pump = ElementBlock(
            "pump", "pump", "vertex", vertices, (("bore.pressure", 0),), (), params, update=update
        )
        return (*elements, self._pump)

    def _update_of(self, block: ElementBlock):
        pressure = self.pump_pressure
        if pressure is None or self._top is None or self._top[0] is not block:
            return None
        row = self._top[1]

        def update(t: float) -> None:
            block.params[row, _CONTROLLED] = pressure.value(t)

        return update

    def breaks(self) -> tuple[float, ...]:
        return (self.flow_rate or self.pump_pressure).breaks()  # type: ignore[union-attr]

    def pumped(self, t: float, state) -> float | None:
        """Return the flow rate into the string [m3/s] at ``t`` [s]; None on ranks without its top."""
        if not self._is_top:
            return None
        return float(self.flow_rate.value(t)) if self.flow_rate is not None else self.upper_flow(state)

    def energies(self, t: float, state) -> Energies:
        return Energies(*map(float, self.figures(state)[:, :3].sum(axis=0)))

    def powers(self, t: float, state) -> Powers:
        figures = self.figures(state)
        supplied, flow = 0.0, self.pumped(t, state)
        if flow is not None and self._top is not None:
            speed = figures[int(self._top[0].points[self._top[1]]), FIGURES.index("speed")]
            supplied = flow * (
                float(self.fluid.enthalpy(self.upper_pressure(state))) + 0.5 * self.fluid.density * speed**2
            )
        return Powers(float(figures[:, FIGURES.index("dissipated")].sum()), supplied)
