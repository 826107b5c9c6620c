"""Measurements of the drilling fluid: pressures and flow rates at its ends and along the string."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.quantity import OneStep, Quantity, Sample
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.fluid import FluidComponents
from drillpetsc.output.quantities.mud import BORE_ONLY, MUD, MUD_FIELDS, SIDE_FLOW
from drillpetsc.physics.fluid.annulus_flow import AnnulusFlow
from drillpetsc.physics.fluid.bore_flow import BoreFlow
from drillpetsc.physics.fluid.channel_flow import RESULT_NAMES, ChannelFlow

BIT_FLOW, CHAMBER, CUTTINGS = 1, 4, 6  # in the results of the flow at the bit


_CONTENT, _SPEED = RESULT_NAMES.index("content"), RESULT_NAMES.index("speed")


class FlowRecorder:
    """The mud as a source of quantities; values are this rank's share, of ends (k,) after each of k steps.

    fluid: components of the mud; some of bore, annulus and bit may be absent.
    """

    def __init__(self, system: DiscreteSystem, fluid: FluidComponents) -> None:
        self.system, self.fluid = system, fluid
        self._last = system.chain.own(system.mesh.nodes - 1)

    def quantities(self) -> tuple[Quantity, ...]:
        bore, annulus = self.fluid.bore is not None, self.fluid.annulus is not None
        absent = () if bore else BORE_ONLY
        ends = tuple(q for q in MUD if q.name not in absent)
        fields = tuple(q for q in MUD_FIELDS if (bore if q.name.startswith("internal") else annulus))
        side = (SIDE_FLOW,) if self.fluid.side is not None else ()
        return ends + side + fields

    # ------------------------------------------------------------------ ends
    def pump_flow(self, steps: OneStep) -> FloatArray:
        """Flow rate into the bore [m3/s]."""
        bore = self.fluid.bore
        flow = None if bore is None else bore.pumped_of(steps)
        return np.zeros(len(steps)) if flow is None else flow

    def pump_pressure(self, steps: OneStep) -> FloatArray:
        """Pressure at the upper end of the bore, plus the loss of the surface line [Pa]."""
        return self.fluid.pump_pressure_of(steps)

    def bit_pressure(self, steps: OneStep) -> FloatArray:
        """Pressure outside the lower end [Pa]: of the annulus, or at the outlet if there is none.

        A closed string without an annulus has no mud outside: the pressure inside its end.
        """
        bit, channel = self.fluid.bit, self.fluid.annulus or self.fluid.bore
        if self._last is None or channel is None:
            return np.zeros(len(steps))
        if self.fluid.annulus is None and bit is not None and bit.has_link:
            return bit.ambient_of(steps)
        return channel.pressure_at_of(steps, self._last)

    def bit_flow(self, steps: OneStep) -> FloatArray:
        """Flow rate out of the string [m3/s]."""
        bit = self.fluid.bit
        return np.zeros(len(steps)) if bit is None else bit.results_of(steps)[:, BIT_FLOW]

    def side_flow(self, steps: OneStep) -> FloatArray:
        """Flow rate through nozzles above the bit [m3/s]."""
        side = self.fluid.side
        return np.zeros(len(steps)) if side is None else side.outflow_of(steps)

    def outlet_flow(self, steps: OneStep) -> FloatArray:
        """Flow rate out of the flow line, or out of the string without an annulus [m3/s]."""
        if self.fluid.annulus is None:
            return self.bit_flow(steps) + self.side_flow(steps)
        flow = self.fluid.annulus.outflow_of(steps)
        return np.zeros(len(steps)) if flow is None else flow

    def cuttings_flow(self, steps: OneStep) -> FloatArray:
        """Rock that the mud takes up [m3/s]."""
        bit, rings = self.fluid.bit, self.fluid.rings
        out = np.zeros(len(steps)) if bit is None else bit.results_of(steps)[:, CUTTINGS]
        if rings is not None:
            out = out + rings.cuttings_of(steps)
        return out

    def content(self, steps: OneStep) -> FloatArray:
        """Volume of all mud at zero pressure [m3]."""
        content, fluid = np.zeros(len(steps)), self.fluid
        for channel in self.channels().values():
            content += channel.sums_of(steps)[:, _CONTENT]
        if fluid.bit is not None:
            content += fluid.bit.results_of(steps)[:, CHAMBER]
        if fluid.annulus is not None:
            content += fluid.annulus.content_above_of(steps)
        if fluid.seals is not None:
            content += fluid.seals.content_of(steps)
        return content

    # ------------------------------------------------------------------ along the string
    def channels(self) -> dict[str, ChannelFlow]:
        """The channels that exist, by name: bore, annulus."""
        both = {"bore": self.fluid.bore, "annulus": self.fluid.annulus}
        return {name: channel for name, channel in both.items() if channel is not None}

    def pressed_areas(self) -> Iterator[tuple[str, BoreFlow | AnnulusFlow, FloatArray, float]]:
        """Name, channel, area (n,) [m2] of the tube on which its pressure acts, and 1 (inside) or -1 (outside).

        Between tool joints: the mean areas of a joint, used by the equations, do not belong to any section.
        """
        bore, annulus, mesh = self.fluid.bore, self.fluid.annulus, self.system.mesh
        if bore is not None:
            yield "bore", bore, mesh.tube_bore_area, 1.0
        if annulus is not None:
            yield "annulus", annulus, mesh.tube_outer_area, -1.0

    def pressure(self, name: str) -> FloatArray:
        """(nv,) pressure [Pa] at the local vertices."""
        return self.channels()[name].pressures(self.system)

    def flow(self, name: str) -> FloatArray:
        """(nc,) flow rate [m3/s] in the local elements, towards the bit."""
        return self.channels()[name].flows(self.system)

    def speed(self, name: str, sample: Sample) -> FloatArray:
        """(nc,) speed [m/s] in the local elements, towards the bit."""
        return np.array(sample.once(self.channels()[name].element_results)[:, _SPEED])

    def wall_tension(self) -> FloatArray:
        """(nc, 2) tension [N] of the pipe's wall beyond EA times strain at both ends of the local elements.

        2 nu (p_i A_i - p_o A_o) with mean areas keeps a pipe under pressure from shortening, and the tube between tool joints
        has different areas (manual: eq-mud-effective-tension, eq-tubulars-wall-tension).
        """
        chain, mesh = self.system.chain, self.system.mesh
        out, mean = np.zeros((len(chain.cells), 2)), {"bore": mesh.bore_area, "annulus": mesh.outer_area}
        for name, channel, tube, sign in self.pressed_areas():
            pressure = channel.pressures(self.system)[chain.ends]
            area = 2 * channel.poisson * mean[name] + tube - mean[name]
            out += sign * area[chain.cells][:, None] * pressure
        return out

    def pressure_force(self) -> FloatArray:
        """(nc, 2) effective tension less tension of the wall, -p_i A_i + p_o A_o [N], at both ends of the local
        elements."""
        chain, out = self.system.chain, np.zeros((len(self.system.chain.cells), 2))
        for _, channel, area, sign in self.pressed_areas():
            out += -sign * area[chain.cells][:, None] * channel.pressures(self.system)[chain.ends]
        return out


def flow_recorder(model: DrillingModel) -> FlowRecorder | None:
    """The recorder of a model's mud, None in a dry one."""
    return None if model.fluid is None else FlowRecorder(model.system, model.fluid)
