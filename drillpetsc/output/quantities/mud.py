"""Pressures and flow rates of the mud, at its ends and along the string."""

from __future__ import annotations

from pathlib import Path

from drillpetsc.fem.quantity import Quantity, quantities_of

quantity = quantities_of(Path(__file__).with_name("measured.csv"))

PUMP_FLOW = quantity("pump_flow", values=lambda mud, steps: mud.pump_flow(steps))
OUTLET_FLOW = quantity("outlet_flow", values=lambda mud, steps: mud.outlet_flow(steps))
MUD: tuple[Quantity, ...] = (
    quantity("pump_pressure", values=lambda mud, steps: mud.pump_pressure(steps)),
    quantity("bit_pressure", values=lambda mud, steps: mud.bit_pressure(steps)),
    OUTLET_FLOW,
    PUMP_FLOW,
    quantity("bit_flow", values=lambda mud, steps: mud.bit_flow(steps)),
)
#: column that exists only with nozzles above the bit
SIDE_FLOW = quantity("side_flow", values=lambda mud, steps: mud.side_flow(steps))
#: columns that exist only with mud in the bore
BORE_ONLY = ("pump_pressure", "pump_flow", "bit_flow")
#: samples of the mass balance besides the two flow rates; not written to files
CUTTINGS_FLOW = quantity("cuttings_flow", values=lambda mud, steps: mud.cuttings_flow(steps))
MUD_CONTENT = quantity("mud_content", values=lambda mud, steps: mud.content(steps))
MUD_FIELDS: tuple[Quantity, ...] = (
    quantity("internal_pressure", value=lambda mud, sample: mud.pressure("bore")),
    quantity("annulus_pressure", value=lambda mud, sample: mud.pressure("annulus")),
    quantity("internal_flow", value=lambda mud, sample: mud.flow("bore")),
    quantity("internal_speed", value=lambda mud, sample: mud.speed("bore", sample)),
    quantity("annulus_flow", value=lambda mud, sample: mud.flow("annulus")),
    quantity("annulus_speed", value=lambda mud, sample: mud.speed("annulus", sample)),
)
