"""Columns of history.csv of probes, and of each rigid item with ``output.item_forces``."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from drillpetsc.fem.quantity import FloatArray, Quantity, quantities_of

quantity = quantities_of(Path(__file__).with_name("measured.csv"))


def _probe_positions(probes: Any, steps: Any) -> FloatArray:
    return np.asarray(probes.motions(steps)[..., :3])


def _probe_offset(probes: Any, positions: FloatArray, depths: FloatArray) -> FloatArray:
    return np.asarray(probes.offset(positions))


PROBES: tuple[Quantity, ...] = (
    quantity("x_NNN", values=_probe_positions, size=3, finish=_probe_offset, index=0),
    quantity("y_NNN", values=_probe_positions, size=3, finish=_probe_offset, index=1),
    quantity("spin_NNN", values=lambda probes, steps: probes.motions(steps)[..., 3]),
    quantity("contact_NNN", values=lambda probes, steps: probes.contact_forces(steps)),
)


WALL_NUMBERS = 13  # numbers that make up the loads of an item, see ``output.measured.rigid_items``


def _resultants(items: Any, values: Any, depth: Any) -> Any:
    return items.resultants(values)


_of_item = partial(
    quantity,
    values=lambda items, steps: items.loads_of(steps),
    size=WALL_NUMBERS,
    finish=_resultants,
)

#: in the order of ``output.measured.rigid_items.TITLES``
SIDE_FORCES: tuple[Quantity, ...] = (
    _of_item("side_force_NNN", index=0),
    _of_item("side_high_NNN", index=1),
    _of_item("side_right_NNN", index=2),
    _of_item("side_couple_NNN", index=3),
    _of_item("contact_force_sum_NNN", index=4),
)
