"""Measurements of the drilling fluid at its ends after each of many recorded steps, as ``flow_recorder`` has them of one."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.step_record import StepRecord
from drillpetsc.model.fluid import FluidComponents
from drillpetsc.physics.fluid.channel_flow import RESULT_NAMES

_CONTENT = RESULT_NAMES.index("content")
BIT_FLOW, CHAMBER, CUTTINGS = 1, 4, 6  # in the results of the flow at the bit


class FlowsOfSteps:
    """(k,) numbers of this rank after each of k steps; None if a model provides them one by one only.

    fluid: components of the mud; last: local number of the last node, None on ranks without it.
    """

    def __init__(self, fluid: FluidComponents, last: int | None) -> None:
        self.fluid, self._last = fluid, last

    def pump_flow(self, steps: StepRecord) -> FloatArray:
        """Flow rate into the bore [m3/s]."""
        bore = self.fluid.bore
        flow = None if bore is None else bore.pumped_of(steps)
        return np.zeros(len(steps)) if flow is None else flow

    def pump_pressure(self, steps: StepRecord) -> FloatArray:
        """Pressure at the upper end of the bore, plus the loss of the surface line [Pa]."""
        bore, line = self.fluid.bore, self.fluid.surface_line
        flow = None if bore is None else bore.pumped_of(steps)
        if bore is None or flow is None:
            return np.zeros(len(steps))
        pressure = bore.upper_pressure_of(steps)
        if line is None:
            return pressure
        lost = {q: line.loss(q) for q in set(flow.tolist())}  # a pump's flow is the same in most steps
        return np.asarray(pressure + [lost[q] for q in flow.tolist()])

    def bit_pressure(self, steps: StepRecord) -> FloatArray | None:
        """Pressure outside the lower end [Pa]."""
        if self._last is None:
            return np.zeros(len(steps))
        bit, channel = self.fluid.bit, self.fluid.annulus or self.fluid.bore
        if channel is None or (self.fluid.annulus is None and bit is not None and bit.has_link):
            return None
        return channel.pressure_at_of(steps, self._last)

    def bit_flow(self, steps: StepRecord) -> FloatArray:
        """Flow rate out of the string [m3/s]."""
        bit = self.fluid.bit
        return np.zeros(len(steps)) if bit is None else bit.results_of(steps)[:, BIT_FLOW]

    def outlet_flow(self, steps: StepRecord) -> FloatArray | None:
        """Flow rate out of the flow line, or out of the string without an annulus [m3/s]."""
        if self.fluid.annulus is not None:
            return self.fluid.annulus.outflow_of(steps)
        return None if self.fluid.side is not None else self.bit_flow(steps)

    def cuttings_flow(self, steps: StepRecord) -> FloatArray | None:
        """Rock that the mud takes up [m3/s]."""
        if self.fluid.rings is not None:
            return None
        bit = self.fluid.bit
        return np.zeros(len(steps)) if bit is None else bit.results_of(steps)[:, CUTTINGS]

    def content(self, steps: StepRecord) -> FloatArray | None:
        """Volume of all mud at zero pressure [m3]."""
        if self.fluid.seals is not None:
            return None
        content = np.zeros(len(steps))
        for channel in (self.fluid.bore, self.fluid.annulus):
            if channel is not None:
                content += channel.sums_of(steps)[:, _CONTENT]
        if self.fluid.bit is not None:
            content += self.fluid.bit.results_of(steps)[:, CHAMBER]
        if self.fluid.annulus is not None:
            content += self.fluid.annulus.content_above_of(steps)
        return content
