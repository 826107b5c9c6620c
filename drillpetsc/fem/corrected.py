"""VelocityStabilization of velocities by multipliers, in the step of Gear, Gupta and Leimkuhler (J. Comp.
Appl. Math. 12/13:77-90, 1985).

x' = y - B mu, and the constraint G y = 0 beside g(x) = 0: the rates of the corrected unknowns are y = shift x
+ v0 + B mu.  The entries by mu are those by the rates times B; B's own change with x is left out of the
Jacobian, as mu is of the size of the time formula's error.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from drillpetsc.fem.component import VelocityStabilization
from drillpetsc.fem.dof_layout import DofLayout
from drillpetsc.kernels import pointer

if TYPE_CHECKING:
    from drillpetsc.fem.assembly import Assembly, BoundBlock, RowReplacement

RATES = ("string.position", "string.tangent", "string.spin")


class BoundStabilization:
    """One room's corrections in an assembly.

    touching: (block, element, where in its rows the seven rates of the vertex stand, which vertex); rows,
    columns: local numbers of the entries that ``fill`` gives.
    """

    def __init__(
        self,
        corrections: VelocityStabilization,
        layout: DofLayout,
        ready: list[BoundBlock],
        fixed: list[RowReplacement],
    ):
        self.corrections, self._layout = corrections, layout
        seven = np.hstack([layout.dofs[name][corrections.points] for name in RATES])
        self.rates = np.ascontiguousarray(seven, dtype=np.int32).reshape(-1, 7)
        self.by = layout.dofs[corrections.field][corrections.points]
        self.touching: list[tuple[BoundBlock, int, np.ndarray, int]] = []
        self._prescribed: list[
            list[tuple[np.ndarray, np.ndarray]]
        ] = []  # of each: rows of a prescribed vertex, what is kept of them
        rows, columns = [np.zeros(0, dtype=np.int32)], [np.zeros(0, dtype=np.int32)]
        for k, places in enumerate(self.rates):
            for item in ready:
                # contact keeps records by element; its damping at this one node is left out of the Jacobian
                if item.block.context:
                    continue
                for e in np.flatnonzero((item.index == places[0]).any(axis=1)):
                    slots = _slots(item.index[e], places)
                    self.touching.append((item, int(e), slots, k))
                    held = [
                        (_slots(item.index[e], f.rows), f.keep) for f in fixed if f.rows[0] in item.index[e]
                    ]
                    self._prescribed.append(held)
                    own = np.where(item.index[e] < layout.size, item.index[e], -1)
                    rows.append(np.repeat(own, 6))
                    columns.append(np.tile(self.by[k], item.width))
        self.rows, self.columns = (
            np.concatenate(rows).astype(np.int32),
            np.concatenate(columns).astype(np.int32),
        )
        self._flat = np.zeros((max(1, len(layout.chain.vertices)), 3))  # a corrected rate moves no spin rate

    def apply(self, asm: Assembly, sigma: float) -> None:
        """Correct the rates and accelerations of ``condense``."""
        B = self.corrections.directions(self.rates, asm.x)
        asm.y[self.rates] += np.einsum("kij,kj->ki", B, asm.x[self.by])
        asm.a[self.rates] = sigma * asm.y[self.rates] + asm.v1[self.rates]

    def fill(self, asm: Assembly, c: tuple[float, float, float], out: np.ndarray) -> None:
        """Entries by the corrections at the weights ``c`` of dR/dx, dR/dy, dR/da (c2/c1 is the shift)."""
        B = self.corrections.directions(self.rates, asm.x)
        weights = np.array([0.0, 1.0, c[2] / c[1]]) if c[1] else np.zeros(3)
        at = 0
        for (item, e, slots, k), held in zip(self.touching, self._prescribed, strict=True):
            K = np.zeros((item.width, item.width))
            item.jacobian(
                1,
                pointer(item.index[e]),
                pointer(item.spins[e]),
                pointer(item.block.params[e]),
                item.block.context,
                pointer(weights),
                pointer(self._flat),
                pointer(asm.x),
                pointer(asm.y),
                pointer(asm.a),
                pointer(K),
            )
            entries = K[:, slots] @ B[k]
            for rows, keep in held:
                entries[rows] = keep @ entries[rows]
            out[at : at + entries.size] = entries.ravel()
            at += entries.size


def _slots(index: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Where the unknowns ``rows`` stand among those of an element."""
    return np.array([int(np.flatnonzero(index == row)[0]) for row in rows])
