"""Pressures and flow rates of the mud, at its ends and along the string."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity

PUMP_FLOW = Quantity(
    "pump_flow",
    "m3/s",
    label="Flow rate in",
    mnemonic="MFIA",
    sign="into the bore; negative in reverse circulation",
    doc="Flow rate of the pump, as volume at zero pressure.",
    values=lambda mud, steps: mud.pump_flow(steps),
    panel=8,
)
OUTLET_FLOW = Quantity(
    "outlet_flow",
    "m3/s",
    label="Flow rate out",
    mnemonic="MFOA",
    sign="out of the annulus at the top",
    doc="Flow rate out of the flow line (without an annulus: out of the string), as volume at zero pressure.",
    values=lambda mud, steps: mud.outlet_flow(steps),
    panel=8,
    interest=10,
)
MUD: tuple[Quantity, ...] = (
    Quantity(
        "pump_pressure",
        "Pa",
        kind="pressure",
        label="Pump pressure",
        mnemonic="SPP",
        sign="gauge pressure",
        doc="Pressure in the bore at the string's upper end, plus the loss of the surface line, if the case has one.",
        values=lambda mud, steps: mud.pump_pressure(steps),
        panel=7,
        interest=4,
    ),
    Quantity(
        "bit_pressure",
        "Pa",
        kind="pressure",
        label="Pressure under the bit",
        mnemonic="BHP",
        sign="gauge pressure",
        doc="Pressure of the mud under the bit, outside the nozzles; inside the end of a closed string without an annulus.",
        values=lambda mud, steps: mud.bit_pressure(steps),
        panel=7,
        interest=9,
    ),
    OUTLET_FLOW,
    PUMP_FLOW,
    Quantity(
        "bit_flow",
        "m3/s",
        label="Flow rate through the bit",
        mnemonic="MFBT",
        sign="out of the string",
        doc="Flow rate through the nozzles, as volume at zero pressure.",
        values=lambda mud, steps: mud.bit_flow(steps),
    ),
)
#: column that exists only with nozzles above the bit
SIDE_FLOW = Quantity(
    "side_flow",
    "m3/s",
    label="Flow rate above the bit",
    mnemonic="MFSD",
    sign="out of the string",
    doc="Flow rate through the nozzles of reamers and stabilizers, as volume at zero pressure.",
    values=lambda mud, steps: mud.side_flow(steps),
)
#: columns that exist only with mud in the bore
BORE_ONLY = ("pump_pressure", "pump_flow", "bit_flow")
#: samples of the mass balance besides the two flow rates; not written to files
CUTTINGS_FLOW = Quantity(
    "cuttings_flow",
    "m3/s",
    label="Cuttings",
    doc="Rock that the mud takes up, as volume of mud.",
    values=lambda mud, steps: mud.cuttings_flow(steps),
)
MUD_CONTENT = Quantity(
    "mud_content",
    "m3",
    label="Content",
    doc="Volume at zero pressure of all mud.",
    values=lambda mud, steps: mud.content(steps),
)
MUD_FIELDS: tuple[Quantity, ...] = (
    Quantity(
        "internal_pressure",
        "Pa",
        kind="pressure",
        on="node",
        label="Pressure in the bore",
        mnemonic="PPRS",
        sign="gauge pressure",
        doc="Pressure of the mud in the bore.",
        value=lambda mud, sample: mud.pressure("bore"),
    ),
    Quantity(
        "annulus_pressure",
        "Pa",
        kind="pressure",
        on="node",
        label="Pressure in the annulus",
        mnemonic="APRS",
        sign="gauge pressure",
        doc="Pressure of the mud in the annulus.",
        value=lambda mud, sample: mud.pressure("annulus"),
    ),
    Quantity(
        "internal_flow",
        "m3/s",
        on="element",
        label="Flow rate in the bore",
        mnemonic="FLWP",
        sign="towards the bit",
        doc="Flow rate in the bore, as volume at zero pressure.",
        value=lambda mud, sample: mud.flow("bore"),
    ),
    Quantity(
        "internal_speed",
        "m/s",
        on="element",
        label="Speed of the mud in the bore",
        mnemonic="VELP",
        sign="towards the bit",
        doc="Mean speed of the mud over the section of the bore.",
        value=lambda mud, sample: mud.speed("bore", sample),
    ),
    Quantity(
        "annulus_flow",
        "m3/s",
        on="element",
        label="Flow rate in the annulus",
        mnemonic="FLWA",
        sign="towards the bit: normal circulation is negative",
        doc="Flow rate in the annulus, as volume at zero pressure.",
        value=lambda mud, sample: mud.flow("annulus"),
    ),
    Quantity(
        "annulus_speed",
        "m/s",
        on="element",
        label="Speed of the mud in the annulus",
        mnemonic="VELA",
        sign="towards the bit: normal circulation is negative",
        doc="Mean speed of the mud over the section of the annulus.",
        value=lambda mud, sample: mud.speed("annulus", sample),
    ),
)
