"""Quantities of a static state alone: columns of statics.csv and the summary of the command `statics`."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.quantities.history import HOOK_LOAD_TOTAL, TOP_END, TOP_TRAVEL
from drillpetsc.physics.quantities import BIT

CURVATURE = Quantity(
    "curvature",
    "1/m",
    on="node",
    label="Curvature",
    mnemonic="CURV",
    sign="not negative",
    doc="Magnitude of the string's curvature.",
)
BENDING_STRESS = Quantity(
    "bending_stress",
    "Pa",
    kind="stress",
    on="node",
    label="Bending stress",
    mnemonic="BSTR",
    sign="not negative",
    doc="Bending stress at the outer fibre.",
)
BUCKLING_LOAD = Quantity(
    "buckling_load",
    "N",
    on="node",
    label="Sinusoidal buckling load",
    mnemonic="SBKL",
    sign="compression",
    doc="2 sqrt(EI q/r) of the string in the hole (Dawson and Paslay 1984); nan without side load or clearance.",
)
BUCKLING_RATIO = Quantity(
    "buckling_ratio",
    "-",
    on="node",
    label="Compression over buckling load",
    mnemonic="SBKR",
    sign="not negative",
    doc="Effective compression over the sinusoidal buckling load.",
)
ECD = Quantity(
    "ecd",
    "kg/m3",
    kind="mud_weight",
    on="node",
    label="Equivalent circulating density",
    mnemonic="ECD",
    doc="Pressure in the annulus (in the summary: at the bottom) over gravity and the vertical depth below the flow line; empty if the depth is less than 1 m.",
)
ITEM_SIDE_FORCE = Quantity(
    "item_side_force",
    "N",
    on="node",
    label="Side force on rigid items",
    mnemonic="ISFC",
    sign="push of the wall on the string, not negative",
    doc="Normal force of the wall on the rigid items that hang on the node (stabilizer, body, bit).",
)
STRETCH = Quantity(
    "stretch",
    "m",
    kind="length",
    label="Stretch",
    mnemonic="STRC",
    sign="longer than free of stress",
    doc="Elongation of the whole string by axial force, in the summary of statics.",
)
TWIST = Quantity(
    "twist",
    "rad",
    label="Twist",
    mnemonic="TWST",
    sign="not negative",
    doc="Angle between the ends of the string, in the summary of statics.",
)
TWIST_ANGLE = Quantity(
    "twist_angle",
    "rad",
    on="node",
    label="Twist from the top",
    mnemonic="TWSA",
    sign="the section lags behind the top that turns clockwise (looking down)",
    doc="Angle by which the torque has turned the section against the top of the string.",
)
#: shown after the `statics` command
STATIC_SUMMARY: tuple[Quantity, ...] = (*TOP_END, HOOK_LOAD_TOTAL, TOP_TRAVEL, *BIT, STRETCH, TWIST)
