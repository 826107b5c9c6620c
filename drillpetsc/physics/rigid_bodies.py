"""Rigid bodies on nodes (stabiliser, bit, drive), unbalance and distributed eccentricity, stress-free curvature.

Manual: sec-junctions-bodies, sec-junctions-unbalance, sec-junctions-eccentric, sec-junctions-curvature.
"""

from __future__ import annotations

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


class RigidBodies(Component):
    """Rigid items on nodes, and pipes whose centre of mass is off their axis.

    mesh: of the string; frames: reference frames of its nodes; gravity: (3,) [m/s2].
    balanced: leave out offsets from the axis, whose effect averages out over a turn.
    """

    name = "bodies"

    def __init__(self, mesh: StringMesh, frames: Frames, gravity: FloatArray, balanced: bool = False):
        self.mesh, self.frames = mesh, frames
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
        self._nodes, self._blocks, self._cells = np.zeros(0, dtype=int), [], []
        out: tuple[ElementBlock, ...] = ()
        if len(self.entries):
            out += (self._on_nodes(part),)
        m = self.mesh
        junction = m.below_junction
        for below in (False, True):
            if not (self.eccentric & (junction == below)).any():
                continue  # the same decision on every rank
            chosen = np.flatnonzero(self.eccentric[part.cells] & (junction[part.cells] == below)).astype(
                np.int32
            )
            e = part.cells[chosen]
            params = Parameters(
                "eccentric",
                len(e),
                length=m.length[e],
                mass=m.mass[e],
                offset=m.eccentricity[e],
                rigid=m.rigid_above[e],
                gravity=self.gravity,
                **end_frames(self.frames, e),
            )
            self._blocks.append(
                ElementBlock(
                    "eccentric_junction" if below else "eccentric",
                    "eccentric_junction" if below else "eccentric",
                    "cell",
                    chosen,
                    JUNCTION_SLOTS if below else SLOTS,
                    (0, 1),
                    params.array,
                )
            )
            self._cells.append(e)
        return out + tuple(self._blocks)

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
            reference=self.frames.reference[self._nodes],
            second=self.frames.second_director[self._nodes],
        )
        self._block = ElementBlock("bodies", "body", "vertex", vertices, VERTEX_SLOTS, (0,), params.array)
        return self._block

    def update_reference_frames(self) -> None:
        if len(self._nodes):
            p = self._block.named
            p["reference"], p["second"] = (
                self.frames.reference[self._nodes],
                self.frames.second_director[self._nodes],
            )
        for b, e in zip(self._blocks, self._cells, strict=True):
            b.named.update(end_frames(self.frames, e))

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
