"""Quantities of the commands `hydraulics` and `surge`: their tables and summaries."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.quantities.along_string import MD
from drillpetsc.output.quantities.history import LOWER_END
from drillpetsc.output.quantities.mud import MUD, MUD_FIELDS, PUMP_FLOW, SIDE_FLOW
from drillpetsc.output.quantities.statics import ECD
from drillpetsc.output.quantities.trajectory import TRAJECTORY

_MUD = {q.name: q for q in (*MUD, *MUD_FIELDS)}
_TVD = next(q for q in TRAJECTORY if q.name == "tvd")
BIT_DEPTH = next(q for q in LOWER_END if q.name == "bit_depth")
PUMP_PRESSURE, BIT_PRESSURE = _MUD["pump_pressure"], _MUD["bit_pressure"]


def _row(name: str, unit: str, label: str, mnemonic: str, doc: str, sign: str = "") -> Quantity:
    return Quantity(name, unit, on="item", label=label, mnemonic=mnemonic, doc=doc, sign=sign)


def _sum(name: str, unit: str, label: str, mnemonic: str, doc: str, sign: str = "") -> Quantity:
    return Quantity(name, unit, on="scalar", label=label, mnemonic=mnemonic, doc=doc, sign=sign)


_LOSS = "down in the direction of the flow"
LOSS_ROWS: tuple[Quantity, ...] = (
    PUMP_FLOW,
    _row("channel", "-", "Channel", "CHAN", "Surface line, bore, nozzles, annulus or choke."),
    _row("item", "-", "Item", "ITEM", "Item of the string."),
    _row("section", "-", "Hole section", "SECT", "Section of the hole."),
    _row("from", "m", "From", "FROM", "Measured depth of the upper end."),
    _row("to", "m", "To", "TO", "Measured depth of the lower end."),
    _row("od", "m", "Outer diameter", "CHOD", "Outer diameter of the channel: bore of the pipe, or hole."),
    _row(
        "id",
        "m",
        "Inner diameter",
        "CHID",
        "Inner diameter of the channel: 0, or outer diameter of the string.",
    ),
    _row("length", "m", "Length", "LEN", "Length along the hole."),
    _row(
        "mean_velocity",
        "m/s",
        "Mean velocity",
        "VEL",
        "Mean velocity over the section.",
        "down the bore, up the annulus",
    ),
    _row(
        "reynolds",
        "-",
        "Reynolds number",
        "REYN",
        "Reynolds number by which the friction law finds the regime.",
    ),
    _row("regime", "-", "Flow regime", "REGM", "Laminar, transitional, turbulent, or inviscid."),
    _row("friction_factor", "-", "Friction factor (Fanning)", "FANN", "Wall shear over rho v^2/2."),
    _row("pressure_loss", "Pa", "Pressure loss", "PLOS", "Loss by friction.", _LOSS),
    _row(
        "critical_flow",
        "m3/s",
        "Critical flow rate",
        "QCRT",
        "Flow rate at which laminar flow ends.",
        "not negative",
    ),
    _row("volume", "m3", "Volume", "CVOL", "Volume of the channel.", "not negative"),
)
NOZZLES: tuple[Quantity, ...] = (
    PUMP_FLOW,
    LOSS_ROWS[2],
    MD,
    _row("nozzle_area", "m2", "Nozzle area", "TFA", "Flow area of the nozzles of the item.", "not negative"),
    _row("nozzle_flow", "m3/s", "Flow rate", "NZFL", "Flow rate through these nozzles.", "out of the string"),
    _row(
        "nozzle_share",
        "-",
        "Share of the flow",
        "NZSH",
        "Flow rate through these nozzles over the flow rate of the pump.",
    ),
    _row(
        "nozzle_jet_velocity", "m/s", "Jet velocity", "NZJV", "Flow rate over the area.", "out of the string"
    ),
    _row(
        "nozzle_loss",
        "Pa",
        "Pressure loss",
        "NZLS",
        "Pressure inside minus pressure outside the nozzles, by their loss.",
        _LOSS,
    ),
    _row(
        "nozzle_power",
        "W",
        "Hydraulic power",
        "NZHP",
        "Loss times the flow rate through these nozzles.",
        "lost",
    ),
    _row(
        "nozzle_power_per_area",
        "W/m2",
        "Power per area",
        "NZHS",
        "Power over the area of rock that the item cuts: the bit's hole, or the ring of a reamer.",
        "lost",
    ),
    _row(
        "nozzle_impact_force",
        "N",
        "Jet impact force",
        "NZJF",
        "Density times flow rate times jet velocity; jets above the bit point outward.",
        "on the rock",
    ),
)
ESD = Quantity(
    "esd",
    "kg/m3",
    on="node",
    label="Equivalent static density",
    mnemonic="ESD",
    doc="Pressure of the still mud in the annulus over gravity and the vertical depth below the flow line.",
)
PRESSURE_PROFILE: tuple[Quantity, ...] = (
    PUMP_FLOW,
    MD,
    _TVD,
    _MUD["internal_pressure"],
    _MUD["annulus_pressure"],
    ECD,
    ESD,
    _MUD["internal_speed"],
    _MUD["annulus_speed"],
)
ECD_BIT = _sum("ecd_bit", "kg/m3", "ECD at the bit", "ECDB", "Equivalent circulating density at the bit.")
ECD_SHOE = _sum(
    "ecd_shoe", "kg/m3", "ECD at the shoe", "ECDS", "Equivalent circulating density at the last casing shoe."
)
ECD_TD = _sum(
    "ecd_td", "kg/m3", "ECD at total depth", "ECDT", "Equivalent circulating density at the end of the hole."
)
WINDOW_MARGINS: tuple[Quantity, ...] = (
    _sum(
        "frac_margin",
        "kg/m3",
        "Margin to fracture",
        "MFRC",
        "Smallest difference of the fracture density from the equivalent density along the open hole; with a window.",
    ),
    _sum(
        "pore_margin",
        "kg/m3",
        "Margin to pore pressure",
        "MPOR",
        "Smallest difference of the equivalent density from the pore density along the open hole; with a window.",
    ),
)
LOSSES: tuple[Quantity, ...] = (
    _sum("surface_line_loss", "Pa", "Surface line", "LSUR", "Loss of the surface line.", _LOSS),
    _sum("string_loss", "Pa", "String", "LSTR", "Loss by friction in the bore of the string.", _LOSS),
    _sum("tool_loss", "Pa", "Tools", "LTOL", "Loss of items with a pressure_loss.", _LOSS),
    _sum("bit_loss", "Pa", "Bit", "LBIT", "Loss of the nozzles.", _LOSS),
    _sum("annulus_loss", "Pa", "Annulus", "LANN", "Loss by friction in the annulus.", _LOSS),
    _sum("choke_loss", "Pa", "Choke", "LCHK", "Loss of the choke at the flow line.", _LOSS),
)
LEVELS: tuple[Quantity, ...] = (
    _sum(
        "velocity_head",
        "Pa",
        "Velocity heads",
        "VHED",
        "Rise of the velocity head at changes of the section.",
        _LOSS,
    ),
    _sum(
        "column_difference",
        "Pa",
        "Column difference",
        "COLD",
        "Weight of the mud in the annulus minus weight of the mud in the bore.",
        "annulus heavier",
    ),
)
_FIGURES: tuple[Quantity, ...] = (
    _sum(
        "jet_velocity",
        "m/s",
        "Jet velocity",
        "JETV",
        "Flow rate through the bit over the area of its nozzles.",
        "out of the bit",
    ),
    _sum(
        "impact_force",
        "N",
        "Jet impact force",
        "JETF",
        "Density times flow rate through the bit times jet velocity.",
        "down",
    ),
    _sum(
        "bit_power",
        "W",
        "Hydraulic power at the bit",
        "HHPB",
        "Loss of the bit's nozzles times the flow rate through them.",
        "lost",
    ),
    _sum(
        "bit_power_per_area",
        "W/m2",
        "Power per bit area",
        "HSI",
        "Power at the bit over the area of its hole.",
        "lost",
    ),
    _sum(
        "hydraulic_power", "W", "Hydraulic power", "HHP", "Pump pressure times the flow rate.", "of the pump"
    ),
    _sum("bit_share", "-", "Share of the bit", "BSHR", "Loss of the nozzles over the pump pressure."),
    _sum(
        "bore_volume", "m3", "Volume of the bore", "VBOR", "Volume of the mud in the string.", "not negative"
    ),
    _sum(
        "annulus_volume",
        "m3",
        "Volume of the annulus",
        "VANN",
        "Volume of the mud around the string.",
        "not negative",
    ),
    _sum(
        "bottoms_up_time",
        "s",
        "Bottoms-up time",
        "TBUP",
        "Time of the mud from the bit to the flow line: volumes of the annulus over the flow rates in them.",
    ),
    _sum(
        "circulation_time",
        "s",
        "Circulation time",
        "TCIR",
        "Time of the mud down the bore and up the annulus, by way of the bit.",
    ),
    _sum(
        "lowest_annular_velocity",
        "m/s",
        "Lowest annular velocity",
        "VLOW",
        "Mean velocity in the widest part of the annulus.",
        "up",
    ),
)
HYDRAULICS_SUMMARY: tuple[Quantity, ...] = (
    PUMP_FLOW,
    PUMP_PRESSURE,
    *LOSSES,
    *LEVELS,
    _MUD["bit_flow"],
    SIDE_FLOW,
    BIT_PRESSURE,
    ECD_BIT,
    ECD_SHOE,
    ECD_TD,
    *WINDOW_MARGINS,
    *_FIGURES,
)
FLOW_CURVE: tuple[Quantity, ...] = (
    PUMP_FLOW,
    PUMP_PRESSURE,
    *LOSSES,
    *LEVELS,
    BIT_PRESSURE,
    ECD_BIT,
    ECD_SHOE,
    ECD_TD,
)

# ---------------------------------------------------------------------- mud
DIAL_READINGS: tuple[Quantity, ...] = (
    _row(
        "dial_speed",
        "rpm",
        "Speed of the viscometer",
        "RVSP",
        "Speed of the rotational viscometer.",
        "not negative",
    ),
    _row("shear_rate", "1/s", "Shear rate", "SHRT", "Shear rate, 1.7023 1/s per rpm.", "not negative"),
    _row("reading", "deg", "Dial reading", "RVRD", "Reading of the viscometer.", "not negative"),
    _row("shear_stress", "Pa", "Shear stress", "SHST", "Shear stress, 0.5107 Pa per degree.", "not negative"),
)
RHEOLOGY_FITS: tuple[Quantity, ...] = (
    _row("model", "-", "Rheology model", "RHMO", "Model of the flow curve."),
    _row("fit", "-", "Fit", "RHFI", "Fit by the rules of API RP 13D (api), by least squares, or given."),
    _row("yield_stress", "Pa", "Yield stress", "TAUY", "Yield stress of the flow curve.", "not negative"),
    _row(
        "consistency",
        "Pa s^n",
        "Consistency",
        "KCON",
        "Consistency, or viscosity with an index of 1.",
        "not negative",
    ),
    _row("index", "-", "Flow index", "NIND", "Exponent of the shear rate."),
    _row("misfit", "Pa", "Misfit", "RMSF", "Root mean square difference to the readings.", "not negative"),
    _row("used", "-", "Used", "USED", "Yes for the flow curve of the case."),
)

# ---------------------------------------------------------------------- surge
TRIP_SPEED = _sum(
    "trip_speed",
    "m/s",
    "Trip speed",
    "TRSP",
    "Speed of the string along the hole.",
    "positive; the operation names the direction",
)
SURGE: tuple[Quantity, ...] = (
    _row(
        "operation",
        "-",
        "Operation",
        "OPER",
        "Motion of the string: trip_in (running in), trip_out (pulling out); in a roadmap also rotate_off_bottom, drilling, sliding, backreaming.",
    ),
    _row("pipe", "-", "State of the pipe", "PIPE", "Closed, open, or pumping."),
    BIT_DEPTH,
    TRIP_SPEED,
    BIT_PRESSURE,
    ECD_BIT,
    ECD_SHOE,
    ECD_TD,
    _sum(
        "surge_pressure",
        "Pa",
        "Surge pressure",
        "SURG",
        "Pressure under the bit minus the pressure with the string at rest and the same flow rate.",
        "surge positive, swab negative",
    ),
    PUMP_FLOW,
    _MUD["bit_flow"],
    _MUD["outlet_flow"],
    _row(
        "limited_by",
        "-",
        "Limited by",
        "LIMB",
        "Limit of the window that is passed, with its vertical depth; or none.",
    ),
)
#: further column of surge.csv with nozzles above the bit
SIDE_SURGE: tuple[Quantity, ...] = (SIDE_FLOW,)
#: further columns of surge.csv with --dynamic
DYNAMIC_SURGE: tuple[Quantity, ...] = (
    _sum(
        "dynamic_surge_pressure",
        "Pa",
        "Surge pressure of the start",
        "SURD",
        "Largest pressure under the bit while the string starts from rest, minus the pressure at rest and the weight of the depth gained.",
        "surge positive, swab negative",
    ),
    _sum(
        "dynamic_surge_time",
        "s",
        "Time of the surge pressure of the start",
        "SURT",
        "Time from the start at which that pressure is reached.",
        "not negative",
    ),
)
MAX_TRIP_SPEED: tuple[Quantity, ...] = (
    SURGE[0],
    SURGE[1],
    BIT_DEPTH,
    _sum(
        "max_trip_speed",
        "m/s",
        "Largest trip speed",
        "TRMX",
        "Largest speed at which the open hole stays within the window.",
        "positive; the operation names the direction",
    ),
    SURGE[-1],
)
