"""Mud beside rigid items and the bit that move across the hole: added mass, damping and swirl (kernels/fluid/mud_item.hpp).

Manual: sec-mud-items.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock
from drillpetsc.geometry.well import Well
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import Parameters, columns
from drillpetsc.physics.fluid.swirl import MeanSpins, Swirl
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices

_axes = function("mud_item_axes", "pipppp")
RESULTS = columns("mud_item_results")
SIZE = len(RESULTS.names)


def end_leakage(length: FloatArray, outer_diameter: FloatArray, hole_diameter: FloatArray) -> FloatArray:
    """Compute the share (n,) [-] that leakage past its ends leaves of the added mass and damping of a body of finite length.

    1 - tanh(q)/q with q = length/(D_o + D_w), the pressure in a thin gap whose ends are at constant pressure (manual:
    eq-mud-item-leakage).  Diameters and length: (n,) [m].
    """
    q = length / (0.5 * (outer_diameter + hole_diameter))
    return np.asarray(1.0 - np.tanh(q) / q)


@dataclass(frozen=True)
class MudItem:
    """Mud about one rigid item.

    node: number from the top; arm: from the node down to the item's middle [m].
    mass [kg], damping [N s/m]: of the mud across the hole; share: swirl over spin [-].
    """

    node: int
    arm: float
    mass: float
    damping: float
    share: float


class MudItems(Component):
    """Mud about the rigid items of a string, lumped at their middles.

    items: the items; current_well(): the present hole.
    """

    name = "mud_items"

    def __init__(self, items: tuple[MudItem, ...], current_well: Callable[[], Well]):
        self.items, self.current_well = items, current_well
        #: the hole of the last call that finds it, and the arguments of that call
        self._packed = np.zeros(0)
        self._axes_call: tuple[int, ...] = ()

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        self._chosen, self._vertices = local_vertices(part, np.array([q.node for q in self.items]))
        self._count = len(part.vertices)
        self._segments = np.full(len(self._vertices), -1, dtype=np.int32)  # of the hole, at the last search
        here = [self.items[k] for k in self._chosen]
        params = Parameters(
            "mud_item",
            len(here),
            arm=[q.arm for q in here],
            mass=[q.mass for q in here],
            damping=[q.damping for q in here],
            **dict.fromkeys(("share", "swirl", "swirl_rate", "spin_rate"), 0.0),
            axis=np.zeros((len(here), 3)),
            tangent=np.tile([0.0, 0.0, 1.0], (len(here), 1)),
        )
        self._block = ElementBlock(
            self.name,
            "mud_item",
            "vertex",
            self._vertices,
            VERTEX_SLOTS,
            (0,),
            params.array,
            remembers=True,
        )
        self._swirl: Swirl | None = None
        if any(q.share for q in self.items):
            self._swirl = Swirl(np.array([q.share for q in here]))
            self._swirl.attach(self._block, rows=np.arange(len(here)))
            self._spins = MeanSpins(np.column_stack([self._vertices, self._vertices]))
        return (self._block,)

    # ------------------------------------------------------------------ hole and swirl
    def locate_hole(self, state) -> None:
        """Find the hole beside the items, with mud at rest."""
        if self._swirl is not None:
            self._swirl.stop()
        self._locate(state)

    def settle(self, t, state) -> None:
        """Set the swirl of the mud to its steady value for the present spins."""
        if self._swirl is not None:
            self._swirl.start(t, self._spins(state))

    def accept(self, t, state) -> None:
        """Find the hole beside the items after an accepted step, and the swirl."""
        self._locate(state)
        if self._swirl is not None:
            self._swirl.accept(t, self._spins(state))

    def follow(self, leader: Component, state) -> None:
        assert isinstance(leader, MudItems)
        if self._swirl is not None and leader._swirl is not None:
            self._swirl.join(leader._swirl, self._spins, state)

    def accept_beside(self, t, others) -> None:
        if self._swirl is None:
            return super().accept_beside(t, others)
        for other, state in others:
            other._locate(state)
        return self._swirl.accept_beside(t)

    def _locate(self, state) -> None:
        if not len(self._vertices):
            return
        packed, index = self.current_well().packed(), state.index_of(self._block)
        if packed is not self._packed:
            self._packed = packed
            arrays = index, state.x, self._block.params, self._segments
            self._axes_call = pointer(packed), len(index), *map(pointer, arrays)
        _axes(*self._axes_call)

    # ------------------------------------------------------------------ energy
    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        return steps.sums(self._block, "mud_item_results", SIZE)[:, RESULTS["kinetic"]], 0.0, 0.0

    def powers_of(self, steps) -> tuple[Any, Any]:
        sums = steps.sums(self._block, "mud_item_results", SIZE)
        return sums[:, RESULTS["dissipated"]], sums[:, RESULTS["left_out"]]

    # ------------------------------------------------------------------ checkpoints
    def get_local_state(self) -> dict[str, FloatArray]:
        """(nv, m) at the local nodes: axis, direction and swirl of up to m items of a node."""
        p, width = self._block.named, 6 + Swirl.STATE
        rows = np.hstack([p["axis"], p["tangent"], np.zeros((len(p["axis"]), Swirl.STATE))])
        if self._swirl is not None:
            rows[:, 6:] = self._swirl.get_state()
        out = np.zeros((self._count, self._most * width))
        for (vertex, place), row in zip(self._places(), rows, strict=True):
            out[vertex, place * width : (place + 1) * width] = row
        return {"vertex": out}

    def set_local_state(self, saved: dict[str, FloatArray]) -> None:
        """Continue from the local part of ``get_local_state``."""
        if not saved:
            return
        width = 6 + Swirl.STATE
        rows = np.zeros((len(self._vertices), width))
        for k, (vertex, place) in enumerate(self._places()):
            rows[k] = saved["vertex"][vertex, place * width : (place + 1) * width]
        p = self._block.named
        p["axis"], p["tangent"] = rows[:, :3], rows[:, 3:6]
        if self._swirl is not None:
            self._swirl.set_state(rows[:, 6:])

    @property
    def _most(self) -> int:
        """Largest number of items of one node."""
        return max(np.unique([q.node for q in self.items], return_counts=True)[1].tolist())

    def _places(self) -> list[tuple[int, int]]:
        """Node and number among its items of each local item."""
        seen: dict[int, int] = {}
        out = []
        for vertex in self._vertices.tolist():
            out.append((vertex, seen.get(vertex, 0)))
            seen[vertex] = seen.get(vertex, 0) + 1
        return out
