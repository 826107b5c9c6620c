"""Pipe that is bent when free of stress (manual: sec-junctions-curvature)."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.fem.component import Component, ElementBlock
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.kernels.parameters import Parameters
from drillpetsc.physics.beam import JUNCTION_SLOTS, SLOTS
from drillpetsc.physics.rigid_bodies import end_frames


class Precurvature(Component):
    """Pipe that is bent when free of stress: curvature (2,) [1/m] in the node directors, element by
    element."""

    name = "curvature"

    def __init__(self, mesh: StringMesh, frames: Frames):
        self.mesh, self.frames = mesh, frames

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        m, bent = self.mesh, np.any(self.mesh.curvature != 0, axis=1)
        junction = m.below_junction
        self._blocks, self._cells, self._constants = [], [], []
        for below in (False, True):
            if not (bent & (junction == below)).any():
                continue
            chosen = np.flatnonzero(bent[part.cells] & (junction[part.cells] == below)).astype(np.int32)
            e = part.cells[chosen]
            params = Parameters(
                "curved",
                len(e),
                length=m.length[e],
                ei=m.bending_stiffness[e],
                curvature=m.curvature[e],
                rigid=m.rigid_above[e],
                **end_frames(self.frames, e),
            )
            self._blocks.append(
                ElementBlock(
                    "curvature_junction" if below else "curvature",
                    "curved_junction" if below else "curved",
                    "cell",
                    chosen,
                    JUNCTION_SLOTS if below else SLOTS,
                    (0, 1),
                    params.array,
                )
            )
            self._cells.append(e)
            squares = np.sum(m.curvature[e] ** 2, axis=1)
            self._constants.append(float(np.sum(0.5 * m.bending_stiffness[e] * m.length[e] * squares)))
        return tuple(self._blocks)

    def average_over_turn(self, turning: bool) -> None:
        """Leave out the curvature while the string turns: its effect averages out over a turn."""
        share = 0.0 if turning else 1.0
        for b, e in zip(self._blocks, self._cells, strict=True):
            b.named["curvature"] = share * self.mesh.curvature[e]

    def update_reference_frames(self) -> None:
        for b, e in zip(self._blocks, self._cells, strict=True):
            b.named.update(end_frames(self.frames, e))

    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        total: Any = 0.0
        for b in self._blocks:
            total = total + steps.sums(b, "curved_energy", 1)[:, 0]
        # the constant EI kappa0^2/2 makes the energy of the free shape zero
        for constant in self._constants:
            total = total + constant
        return 0.0, total, 0.0
