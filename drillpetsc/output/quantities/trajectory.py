"""Columns of trajectory.csv."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity
from drillpetsc.output.quantities.along_string import INCLINATION, MD

TRAJECTORY: tuple[Quantity, ...] = (
    MD,
    INCLINATION,
    Quantity(
        "azimuth",
        "deg",
        on="node",
        label="Azimuth",
        mnemonic="AZIM",
        sign="from north over east",
        doc="Direction of the hole in the horizontal plane.",
    ),
    Quantity("north", "m", on="node", label="North", mnemonic="NS", sign="north", doc="Offset to the north."),
    Quantity("east", "m", on="node", label="East", mnemonic="EW", sign="east", doc="Offset to the east."),
    Quantity(
        "tvd",
        "m",
        on="node",
        label="True vertical depth",
        mnemonic="TVD",
        sign="down",
        doc="Vertical depth of the hole's axis.",
    ),
    Quantity(
        "dogleg_severity",
        "deg/30m",
        on="node",
        label="Dogleg severity",
        mnemonic="DLS",
        sign="not negative",
        doc="Change of the hole's direction over 30 m.",
    ),
)
