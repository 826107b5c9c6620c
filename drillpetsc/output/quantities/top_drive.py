"""Columns of reflection.csv."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity

REFLECTION: tuple[Quantity, ...] = (
    Quantity(
        "controller",
        "-",
        on="item",
        label="Controller",
        mnemonic="CTRL",
        doc="Number of the controller in the case, from 1.",
    ),
    Quantity(
        "wave_frequency",
        "Hz",
        on="item",
        label="Frequency of the wave",
        mnemonic="WFRQ",
        sign="positive",
        doc="Frequency of a torsional wave.",
    ),
    Quantity(
        "reflection",
        "-",
        on="item",
        label="Reflected part of the wave",
        mnemonic="RFL",
        doc="Amplitude of the reflected wave over amplitude of the incoming wave.",
    ),
)
