"""Columns of reflection.csv."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity

REFLECTION: tuple[Quantity, ...] = (
    Quantity(
        "frequency",
        "Hz",
        on="item",
        label="Frequency",
        mnemonic="FREQ",
        sign="positive",
        doc="Frequency of the wave.",
    ),
    Quantity(
        "reflection_NNN",
        "-",
        on="item",
        label="Reflection by controller NNN",
        mnemonic="RFLNNN",
        sign="not negative",
        doc="Size of the torsional wave that the top reflects, over that of the wave that comes up; by number of the controller.",
    ),
)
