"""Pipe that is bent when free of stress (manual: sec-junctions-curvature)."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.fem.component import ElementBlock
from drillpetsc.physics.rigid_bodies import OnCells


class Precurvature(OnCells):
    """Pipe that is bent when free of stress: curvature (2,) [1/m] in the node directors, element by
    element."""

    name = "curvature"

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        m = self.mesh
        blocks = self._on_cells(
            part,
            np.any(m.curvature != 0, axis=1),
            ("curvature", "curved"),
            lambda e: {"ei": m.bending_stiffness[e], "curvature": m.curvature[e]},
        )
        squares = m.bending_stiffness * m.length * np.sum(m.curvature**2, axis=1)
        self._constants = [float(np.sum(0.5 * squares[e])) for e in self._cells]
        return tuple(blocks)

    def average_over_turn(self, turning: bool) -> None:
        """Leave out the curvature while the string turns: its effect averages out over a turn."""
        share = 0.0 if turning else 1.0
        for b, e in zip(self._blocks, self._cells, strict=True):
            b.named["curvature"] = share * self.mesh.curvature[e]

    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        total: Any = 0.0
        for b in self._blocks:
            total = total + steps.sums(b, "curved_energy", 1)[:, 0]
        # the constant EI kappa0^2/2 makes the energy of the free shape zero
        for constant in self._constants:
            total = total + constant
        return 0.0, total, 0.0
