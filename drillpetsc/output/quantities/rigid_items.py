"""Columns of history.csv of each rigid item, with ``output.item_forces``."""

from __future__ import annotations

from functools import partial
from typing import Any

from drillpetsc.fem.quantity import Quantity

WALL_NUMBERS = 13  # numbers that make up the loads of an item, see ``output.measured.rigid_items``


def _resultants(items: Any, values: Any, depth: Any) -> Any:
    return items.resultants(values)


_of_item = partial(
    Quantity,
    on="rigid_item",
    value=lambda items, sample: items.loads(sample),
    values=lambda items, steps: items.loads_of(steps),
    size=WALL_NUMBERS,
    finish=_resultants,
)

#: in the order of ``output.measured.rigid_items.TITLES``
SIDE_FORCES: tuple[Quantity, ...] = (
    _of_item(
        "side_force_NNN",
        "N",
        index=0,
        label="Side force of the rigid item at NNN m",
        mnemonic="SINNN",
        sign="push of the wall on the string, not negative",
        doc="Size of the resultant of the normal forces of the wall on a rigid item; NNN is the measured depth of its middle at the start.",
    ),
    _of_item(
        "side_high_NNN",
        "N",
        index=1,
        label="Side force to the high side of the rigid item at NNN m",
        mnemonic="SHNNN",
        sign="on the string to the high side (vertical hole: north)",
        doc="Component to the high side of the resultant of the wall's forces across the hole, friction included.",
    ),
    _of_item(
        "side_right_NNN",
        "N",
        index=2,
        label="Side force to the right of the rigid item at NNN m",
        mnemonic="SRNNN",
        sign="on the string to the right of the high side, looking down the hole",
        doc="Component to the right of the resultant of the wall's forces across the hole, friction included.",
    ),
    _of_item(
        "side_couple_NNN",
        "N m",
        index=3,
        label="Couple of the wall on the rigid item at NNN m",
        mnemonic="SCNNN",
        sign="not negative",
        doc="Size of the couple across the hole of the wall's forces about the middle of a rigid item, friction included.",
    ),
    _of_item(
        "contact_force_sum_NNN",
        "N",
        index=4,
        label="Sum of contact forces of the rigid item at NNN m",
        mnemonic="SSNNN",
        sign="not negative",
        doc="Sum of the sizes of the normal forces at the contact points of a rigid item, from which its friction follows.",
    ),
)
