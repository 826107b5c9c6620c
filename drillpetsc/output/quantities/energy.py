"""Energies of a run."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity

ENERGY: tuple[Quantity, ...] = (
    Quantity(
        "kinetic_energy",
        "J",
        kind="energy",
        on="scalar",
        label="Kinetic energy",
        mnemonic="EKIN",
        doc="Kinetic energy of string and mud.",
        interpolate="none",
        mean=False,
        value=lambda balance, sample: balance.energies[0],
        panel=9,
        numerics=True,
    ),
    Quantity(
        "strain_energy",
        "J",
        kind="energy",
        on="scalar",
        label="Strain energy",
        mnemonic="ESTR",
        doc="Energy stored in the string, in contacts, springs and compressed mud.",
        interpolate="none",
        mean=False,
        value=lambda balance, sample: balance.energies[1],
        panel=9,
        numerics=True,
    ),
    Quantity(
        "energy_error",
        "J",
        kind="energy",
        on="scalar",
        label="Energy error",
        mnemonic="EERR",
        sign="the time integration created energy",
        doc="Stored energy gained plus dissipated less supplied energy since the start.",
        interpolate="none",
        mean=False,
        value=lambda balance, sample: balance.error,
        panel=10,
        numerics=True,
    ),
)
#: samples of the energy balance: dissipated and supplied power; not written to files
POWERS = Quantity(
    "powers",
    "W",
    on="scalar",
    label="Powers",
    doc="Dissipated and supplied power.",
    value=lambda balance, sample: sample.system.local_powers(sample.time),
    values=lambda balance, steps: steps.system.powers_of(steps),
    size=2,
)
