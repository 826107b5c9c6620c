"""Columns of history.csv of probes, and of each rigid item with ``output.item_forces``."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np

from drillpetsc.fem.quantity import FloatArray, Quantity


def _probe_positions(probes: Any, steps: Any) -> FloatArray:
    return np.asarray(probes.motions(steps)[..., :3])


def _probe_offset(probes: Any, positions: FloatArray, depths: FloatArray) -> FloatArray:
    return np.asarray(probes.offset(positions))


PROBES: tuple[Quantity, ...] = (
    Quantity(
        "x_NNN",
        "m",
        kind="diameter",
        on="probe",
        label="Offset to the high side at NNN m",
        mnemonic="OXNNN",
        sign="towards the high side (north in a vertical hole)",
        doc="Offset of the string's centre from the hole's axis.",
        interpolate="motion",
        values=_probe_positions,
        size=3,
        finish=_probe_offset,
        index=0,
    ),
    Quantity(
        "y_NNN",
        "m",
        kind="diameter",
        on="probe",
        label="Offset to the right at NNN m",
        mnemonic="OYNNN",
        sign="to the right of the high side, looking down (east in a vertical hole)",
        doc="Offset of the string's centre from the hole's axis.",
        interpolate="motion",
        values=_probe_positions,
        size=3,
        finish=_probe_offset,
        index=1,
    ),
    Quantity(
        "spin_NNN",
        "rad/s",
        on="probe",
        label="Spin rate at NNN m",
        mnemonic="RPMNNN",
        sign="clockwise (looking down)",
        doc="Spin rate of the string about its axis.",
        interpolate="motion",
        values=lambda probes, steps: probes.motions(steps)[..., 3],
    ),
    Quantity(
        "contact_NNN",
        "N",
        on="probe",
        label="Contact force at NNN m",
        mnemonic="SFNNN",
        sign="push of the wall on the string, not negative",
        doc="Normal force of the wall on the element that holds the probe.",
        values=lambda probes, steps: probes.contact_forces(steps),
    ),
)


WALL_NUMBERS = 13  # numbers that make up the loads of an item, see ``output.measured.rigid_items``


def _resultants(items: Any, values: Any, depth: Any) -> Any:
    return items.resultants(values)


_of_item = partial(
    Quantity,
    on="rigid_item",
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
