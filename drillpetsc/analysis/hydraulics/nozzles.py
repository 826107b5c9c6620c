"""Flow, loss and power of the nozzles of a steady flow: of the bit, and of items above it."""

from __future__ import annotations

from typing import Any

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


def nozzle_rows(flow: FlowModel, pump_flow: float) -> list[dict[str, Any]]:
    """Rows of nozzles.csv by name, SI: items above the bit, from the top down, and the bit; nothing where only the bit has nozzles.

    The nozzles of several items at one node have the same loss, so the flow goes by their areas.  pump_flow: [m3/s].
    """
    side = flow.fluid.side
    if side is None:
        return []
    modulus = flow.fluid.constants.bulk_modulus
    inside, outside = flow.pressure("bore"), flow.pressure("annulus")
    assert inside is not None
    results = side.element_results(flow.system.assembly)
    found: list[tuple[int, float, float, float, float]] = []
    for k, link in zip(side.local_links(), results, strict=True):
        node, rate = side.links[k].node, float(link[SIDE_RESULTS["flow"]])
        beside = flow.bottom_pressure() if outside is None else float(outside[node])
        middle = 0.5 * (float(inside[node]) + beside)
        lost = float(link[SIDE_RESULTS["lost"]]) / rate * np.exp(middle / modulus) if rate else 0.0
        for number, area in side.links[k].items:
            share = rate * area / side.links[k].area
            found.append((flow.string.number[number], float(flow.md[node]), area, share, float(lost)))
    bit = flow.fluid.bit
    if bit is not None and bit.has_link:
        area, last = bit.end.nozzle or bit.end.bore, len(flow.case.string) - 1
        found.append((last, flow.string.depth, area, bit_flow(flow), nozzle_loss(flow)))
    return [_row(flow, pump_flow, *group) for group in found]


def _row(
    flow: FlowModel, pump_flow: float, number: int, md: float, area: float, rate: float, loss: float
) -> dict[str, Any]:
    """The row of the string item ``number``: depth [m], area [m2], flow rate [m3/s] and loss [Pa]; nan for a number that is not there."""
    item, cut = flow.case.string[number], np.nan
    if isinstance(item, Bit):
        cut = 0.25 * np.pi * item.od**2
    elif isinstance(item, Reamer) and item.od is not None:
        pilot = item.pilot or flow.case.string[-1].od or 0.0
        cut = 0.25 * np.pi * (item.od**2 - pilot**2)
    power = trade.hydraulic_power(loss, rate)
    return {
        "pump_flow": pump_flow,
        "item": item.name,
        "md": md,
        "nozzle_area": area,
        "nozzle_flow": rate,
        "nozzle_share": rate / pump_flow if pump_flow else np.nan,
        "nozzle_jet_velocity": trade.jet_velocity(rate, area),
        "nozzle_loss": loss,
        "nozzle_power": power,
        "nozzle_power_per_area": power / cut,
        "nozzle_impact_force": trade.impact_force(rate, flow.fluid.constants.density, area),
    }
