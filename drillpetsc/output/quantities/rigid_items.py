"""Column of history.csv of each rigid item, where ``output.item_forces`` asks for it."""

from __future__ import annotations

from drillpetsc.fem.quantity import Quantity

SIDE_FORCE = Quantity(
    "side_force_NNN",
    "N",
    on="rigid_item",
    label="Side force of the rigid item at NNN m",
    mnemonic="SINNN",
    sign="push of the wall on the string, not negative",
    doc="Normal force of the wall on a rigid item; NNN is the measured depth of its middle at the start.",
    value=lambda items, sample: items.forces(sample),
    values=lambda items, steps: items.forces_of(steps),
)
