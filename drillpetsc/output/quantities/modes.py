"""Columns of modes.csv."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity

#: kinds of modes: each has a share of the energy
MODE_KINDS = ("lateral", "axial", "torsional", "fluid")
MODE_SHARES: tuple[Quantity, ...] = tuple(
    Quantity(
        f"{kind}_share",
        "-",
        on="item",
        label=f"Share of {kind} energy",
        mnemonic=f"SH{kind[:2].upper()}",
        doc=f"Share of the mode's energy in {kind} motion.",
    )
    for kind in MODE_KINDS
)
MODES: tuple[Quantity, ...] = (
    Quantity("mode", "-", on="item", label="Mode", mnemonic="MODE", doc="Number of the mode, from 1."),
    Quantity(
        "frequency",
        "Hz",
        on="item",
        label="Frequency",
        mnemonic="FREQ",
        sign="not negative",
        doc="Frequency of the oscillation, 0 for a real eigenvalue.",
    ),
    Quantity(
        "speed",
        "rpm",
        on="item",
        label="Critical speed",
        mnemonic="CRPM",
        sign="not negative",
        doc="Rotary speed at which one excitation per turn meets the mode, 0 for a real eigenvalue.",
    ),
    Quantity(
        "damping_ratio",
        "-",
        on="item",
        label="Damping ratio",
        mnemonic="DAMP",
        sign="the mode decays",
        doc="Damping as a fraction of critical damping, -sigma/|s|; nan at zero (manual: eq-eigen-figures).",
    ),
    Quantity(
        "growth",
        "1/s",
        on="item",
        label="Growth rate",
        mnemonic="GROW",
        sign="the mode grows",
        doc="Real part sigma of the eigenvalue s.",
    ),
    Quantity(
        "kind",
        "-",
        on="item",
        label="Kind of mode",
        mnemonic="KIND",
        doc="Motion with the largest share of the mode's energy.",
    ),
    *MODE_SHARES,
    Quantity(
        "backward_error",
        "-",
        on="item",
        label="Backward error",
        mnemonic="BERR",
        sign="not negative",
        doc="Backward error of the eigenvalue (manual: eq-eigen-error).",
    ),
)
STOKES_NUMBER = Quantity(
    "stokes_number",
    "-",
    on="item",
    label="Stokes number",
    mnemonic="STKN",
    sign="not negative",
    doc="Frequency times squared radius over kinematic viscosity, mean over the lateral motion; nan for other modes.",
)
