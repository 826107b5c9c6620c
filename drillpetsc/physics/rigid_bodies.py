"""Rigid bodies on nodes (stabiliser, bit, drive), unbalance and distributed eccentricity, stress-free curvature.

Manual: sec-junctions-bodies, sec-junctions-unbalance, sec-junctions-eccentric, sec-junctions-curvature.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.kernels.parameters import Parameters
from drillpetsc.physics.beam import JUNCTION_SLOTS, SLOTS

VERTEX_SLOTS = (("string.position", 0), ("string.tangent", 0), ("string.spin", 0))


def local_vertices(part, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Find the ``nodes`` (k,) that this rank owns.

    Returns their positions in ``nodes`` and local vertex numbers.
    """
    local = {int(v): i for i, v in enumerate(part.vertices) if part.owned[i]}
    chosen = [k for k, node in enumerate(nodes) if int(node) in local]
    return np.array(chosen, dtype=int), np.array([local[int(nodes[k])] for k in chosen], dtype=np.int32)


class OnCells(Component):
    """Elements on some cells of the string, with the frames of their ends."""

    def __init__(self, mesh: StringMesh, frames: Frames):
        self.mesh, self.frames = mesh, frames
        self._blocks: list[ElementBlock] = []
        self._cells: list[np.ndarray] = []

    def _on_cells(
        self,
        part,
        mask: np.ndarray,
        names: tuple[str, str],
        parameters: Callable[[np.ndarray], dict[str, Any]],
    ) -> list[ElementBlock]:
        """Blocks of the cells of a ``mask`` (n,), below a junction or not.

        names: of the blocks and of their kernel; parameters(e): of the cells ``e`` (k,).
        """
        m, self._blocks, self._cells = self.mesh, [], []
        for below in (False, True):
            chosen = mask & (m.below_junction == below)
            if not chosen.any():
                continue  # the same decision on every rank
            points = np.flatnonzero(chosen[part.cells]).astype(np.int32)
            e = part.cells[points]
            name, kernel = (q + "_junction" * below for q in names)
            params = Parameters(
                names[1],
                len(e),
                length=m.length[e],
                rigid=m.rigid_above[e],
                **parameters(e),
                **end_frames(self.frames, e),
            )
            slots = JUNCTION_SLOTS if below else SLOTS
            self._blocks.append(ElementBlock(name, kernel, "cell", points, slots, (0, 1), params.array))
            self._cells.append(e)
        return self._blocks

    def update_reference_frames(self) -> None:
        for b, e in zip(self._blocks, self._cells, strict=True):
            b.named.update(end_frames(self.frames, e))


class RigidBodies(OnCells):
    """Rigid items on nodes, and pipes whose centre of mass is off their axis.

    mesh: of the string; frames: reference frames of its nodes; gravity: (3,) [m/s2].
    balanced: leave out offsets from the axis, whose effect averages out over a turn.
    """

    name = "bodies"

    def __init__(self, mesh: StringMesh, frames: Frames, gravity: FloatArray, balanced: bool = False):
        super().__init__(mesh, frames)
        self.gravity = np.asarray(gravity, dtype=float)
        # node, mass [kg], centre of gravity along the tangent and in the two directors [m], axial and
        # transverse inertia [kg m2]
        entries = [
            (b.node, b.mass, b.center, *((0.0, 0.0) if balanced else b.offset), b.axial, b.transverse)
            for b in mesh.bodies
        ]
        self.entries = np.array(entries, dtype=float).reshape(-1, 7)
        self.eccentric = np.any(mesh.eccentricity != 0, axis=1) & (not balanced)  # (n,) elements

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        m, self._nodes = self.mesh, np.zeros(0, dtype=int)
        on_nodes = (self._on_nodes(part),) if len(self.entries) else ()
        on_cells = self._on_cells(
            part,
            self.eccentric,
            ("eccentric", "eccentric"),
            lambda e: {"mass": m.mass[e], "offset": m.eccentricity[e], "gravity": self.gravity},
        )
        return (*on_nodes, *on_cells)

    def _on_nodes(self, part) -> ElementBlock:
        chosen, vertices = local_vertices(part, self.entries[:, 0].astype(int))
        e = self.entries[chosen]
        self._nodes = e[:, 0].astype(int)
        _, mass, center, offset2, offset3, axial, transverse = e.T
        params = Parameters(
            "body",
            len(e),
            mass=mass,
            center=center,
            offset=np.column_stack([offset2, offset3]),
            axial=axial,
            transverse=transverse,
            gravity=self.gravity,
            **self._node_frames(),
        )
        self._block = ElementBlock("bodies", "body", "vertex", vertices, VERTEX_SLOTS, (0,), params.array)
        return self._block

    def update_reference_frames(self) -> None:
        super().update_reference_frames()
        if len(self._nodes):
            self._block.named.update(self._node_frames())

    def _node_frames(self) -> dict[str, FloatArray]:
        nodes = self._nodes
        return {"reference": self.frames.reference[nodes], "second": self.frames.second_director[nodes]}

    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        kinetic = potential = 0.0
        blocks = [(self._block, "body_energy")] if len(self._nodes) else []
        for b, kernel in blocks + [(b, "eccentric_energy") for b in self._blocks]:
            part = steps.sums(b, kernel, 2)
            kinetic, potential = kinetic + part[:, 0], potential + part[:, 1]
        return kinetic, 0.0, potential


def end_frames(frames: Frames, e: np.ndarray) -> dict[str, FloatArray]:
    """Reference directions and second directors (k, 3) of the upper and the lower node of elements ``e``
    (k,), by the names of the kernels' parameters."""
    return {
        "reference1": frames.reference[e],
        "second1": frames.second_director[e],
        "reference2": frames.reference[e + 1],
        "second2": frames.second_director[e + 1],
    }
