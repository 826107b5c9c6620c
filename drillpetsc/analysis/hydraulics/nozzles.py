"""Flow, loss and power of the nozzles of a steady flow: of the bit, and of items above it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.hydraulics import trade_formulas as trade
from drillpetsc.analysis.hydraulics.flow_model import FlowModel
from drillpetsc.case.blocks.items.reamer import Reamer
from drillpetsc.case.blocks.items.string import Bit
from drillpetsc.physics.fluid.bit_flow import RESULTS
from drillpetsc.physics.fluid.side_nozzles import RESULTS as SIDE_RESULTS


def bit_flow(flow: FlowModel) -> float:
    """Flow rate through the bit at zero pressure [m3/s]; 0 without a way out there."""
    bit = flow.fluid.bit
    if bit is None or not bit.has_link:
        return 0.0
    return float(bit.element_results(flow.system.assembly)[RESULTS["flow"]])


def nozzle_loss(flow: FlowModel) -> float:
    """Compute the loss of the nozzles and the check valve [Pa]; 0 without them (manual: eq-mud-nozzle)."""
    bit, bore, through = flow.fluid.bit, flow.pressure("bore"), bit_flow(flow)
    if bit is None or bore is None or not through:
        return 0.0
    lost = float(bit.element_results(flow.system.assembly)[RESULTS["lost"]])
    mean = 0.5 * (
        float(bore[-1]) + flow.bottom_pressure()
    )  # the pressure at which the kernel takes the volume
    return lost / through * np.exp(mean / flow.fluid.constants.bulk_modulus)


@dataclass(frozen=True)
class NozzleGroup:
    """Nozzles of one item, SI: a row of nozzles.csv.

    item: number of the string item; md: measured depth [m]; area: of the nozzles [m2].
    flow: flow rate out of the string at zero pressure [m3/s]; pressure_loss: [Pa]; density: of the mud at zero pressure [kg/m3].
    power_per_area: power over the area of rock that the item cuts [W/m2]; nan for an item that does not cut.
    """

    item: int
    md: float
    area: float
    flow: float
    pressure_loss: float
    density: float
    power_per_area: float = np.nan

    @property
    def jet_velocity(self) -> float:
        """Mean speed of the jets [m/s]."""
        return trade.jet_velocity(self.flow, self.area)

    @property
    def power(self) -> float:
        """Loss times flow rate [W]."""
        return trade.hydraulic_power(self.pressure_loss, self.flow)

    @property
    def impact_force(self) -> float:
        """Density times flow rate times speed of the jets [N]."""
        return trade.impact_force(self.flow, self.density, self.area)


def nozzle_groups(flow: FlowModel) -> list[NozzleGroup]:
    """Nozzles of items above the bit, from the top down, and those of the bit; nothing where only the bit has nozzles.

    The nozzles of several items at one node have the same loss, so the flow goes by their areas.
    """
    side = flow.fluid.side
    if side is None:
        return []
    modulus = flow.fluid.constants.bulk_modulus
    inside, outside = flow.pressure("bore"), flow.pressure("annulus")
    assert inside is not None
    results = side.element_results(flow.system.assembly)
    out: list[NozzleGroup] = []
    for k, link in zip(side.local_links(), results, strict=True):
        node, rate = side.links[k].node, float(link[SIDE_RESULTS["flow"]])
        beside = flow.bottom_pressure() if outside is None else float(outside[node])
        middle = 0.5 * (float(inside[node]) + beside)
        lost = float(link[SIDE_RESULTS["lost"]]) / rate * np.exp(middle / modulus) if rate else 0.0
        for number, area in side.links[k].items:
            share = rate * area / side.links[k].area
            out.append(
                _group(flow, flow.string.number[number], float(flow.md[node]), area, share, float(lost))
            )
    bit = flow.fluid.bit
    if bit is not None and bit.has_link:
        area, last = bit.end.nozzle or bit.end.bore, len(flow.case.string) - 1
        out.append(_group(flow, last, flow.string.depth, area, bit_flow(flow), nozzle_loss(flow)))
    return out


def _group(flow: FlowModel, number: int, md: float, area: float, rate: float, loss: float) -> NozzleGroup:
    """The nozzles of the string item ``number``: depth [m], area [m2], flow rate [m3/s] and loss [Pa]."""
    item, cut = flow.case.string[number], np.nan
    if isinstance(item, Bit):
        cut = 0.25 * np.pi * item.od**2
    elif isinstance(item, Reamer) and item.od is not None:
        pilot = item.pilot or flow.case.string[-1].od or 0.0
        cut = 0.25 * np.pi * (item.od**2 - pilot**2)
    power = trade.hydraulic_power(loss, rate)
    return NozzleGroup(number, md, area, rate, loss, flow.fluid.constants.density, power / cut)
