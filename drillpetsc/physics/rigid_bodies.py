"""Rigid bodies on nodes (stabiliser, bit, drive), unbalance and distributed eccentricity, stress-free curvature.

Manual: sec-junctions-bodies, sec-junctions-unbalance, sec-junctions-eccentric, sec-junctions-curvature.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock, Energies
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.kernels import function, pointer
from drillpetsc.physics.beam import SLOTS, SPLIT_SLOTS

_body_energy = function("body_energy", "ippppp")
_eccentric_energy = function("eccentric_energy", "iippppp")
_curved_energy = function("curved_energy", "iipppp")
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
        junction = m.junction if len(m.junction) else np.zeros(m.nodes, dtype=bool)
        for split in (False, True):
            if not (self.eccentric & (junction[:-1] == split)).any():
                continue  # the same decision on every rank
            chosen = np.flatnonzero(self.eccentric[part.cells] & (junction[part.cells] == split)).astype(
                np.int32
            )
            e = part.cells[chosen]
            gravity = np.tile(self.gravity, (len(e), 1))
            params = np.column_stack(
                [
                    m.length[e],
                    m.mass[e],
                    m.eccentricity[e],
                    m.rigid_above[e],
                    gravity,
                    frame_columns(self.frames, e),
                ]
            )
            self._blocks.append(
                ElementBlock(
                    "eccentric_junction" if split else "eccentric",
                    "eccentric_split" if split else "eccentric",
                    "cell",
                    chosen,
                    SPLIT_SLOTS if split else SLOTS,
                    (0, 1),
                    np.ascontiguousarray(params),
                )
            )
            self._cells.append(e)
        return out + tuple(self._blocks)

    def _on_nodes(self, part) -> ElementBlock:
        chosen, vertices = local_vertices(part, self.entries[:, 0].astype(int))
        e = self.entries[chosen]
        self._nodes = e[:, 0].astype(int)
        gravity = np.tile(self.gravity, (len(e), 1))
        params = np.column_stack(
            [e[:, 1:7], gravity, self.frames.reference[self._nodes], self.frames.second[self._nodes]]
        )
        self._block = ElementBlock(
            "bodies", "body", "vertex", vertices, VERTEX_SLOTS, (0,), np.ascontiguousarray(params)
        )
        return self._block

    def update_reference_frames(self) -> None:
        if len(self._nodes):
            self._block.params[:, 9:12] = self.frames.reference[self._nodes]
            self._block.params[:, 12:15] = self.frames.second[self._nodes]
        for b, e in zip(self._blocks, self._cells, strict=True):
            b.params[:, 8:20] = frame_columns(self.frames, e)

    def energies(self, t: float, state) -> Energies:
        total = np.zeros(2)
        if len(self._nodes):
            out, index = np.zeros((len(self._nodes), 2)), state.index_of(self._block)
            _body_energy(
                len(out),
                pointer(index),
                pointer(self._block.params),
                pointer(state.x),
                pointer(state.y),
                pointer(out),
            )
            total += out.sum(axis=0)
        for b in self._blocks:
            out, index = np.zeros((len(b.points), 2)), state.index_of(b)
            _eccentric_energy(
                len(out),
                index.shape[1],
                pointer(index),
                pointer(b.params),
                pointer(state.x),
                pointer(state.y),
                pointer(out),
            )
            total += out.sum(axis=0)
        return Energies(kinetic=float(total[0]), potential=float(total[1]))


def frame_columns(frames: Frames, e: np.ndarray) -> FloatArray:
    """Return (k, 12) reference direction and second director of the upper and the lower node of elements ``e`` (k,)."""
    return np.hstack([frames.reference[e], frames.second[e], frames.reference[e + 1], frames.second[e + 1]])


class Precurvature(Component):
    """Stress-free curvature of the elements, (2,) [1/m] along the node directors.

    Manual: eq-curved-field.
    """

    name = "curvature"

    def __init__(self, mesh: StringMesh, frames: Frames):
        self.mesh, self.frames = mesh, frames

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        m, bent = self.mesh, np.any(self.mesh.curvature != 0, axis=1)
        junction = m.junction if len(m.junction) else np.zeros(m.nodes, dtype=bool)
        self._blocks, self._cells = [], []
        for split in (False, True):
            if not (bent & (junction[:-1] == split)).any():
                continue
            chosen = np.flatnonzero(bent[part.cells] & (junction[part.cells] == split)).astype(np.int32)
            e = part.cells[chosen]
            params = np.column_stack(
                [
                    m.length[e],
                    m.bending_stiffness[e],
                    m.curvature[e],
                    m.rigid_above[e],
                    frame_columns(self.frames, e),
                ]
            )
            self._blocks.append(
                ElementBlock(
                    "curvature_junction" if split else "curvature",
                    "curved_split" if split else "curved",
                    "cell",
                    chosen,
                    SPLIT_SLOTS if split else SLOTS,
                    (0, 1),
                    np.ascontiguousarray(params),
                )
            )
            self._cells.append(e)
        return tuple(self._blocks)

    def average_over_turn(self, turning: bool) -> None:
        """Leave out the curvature while the string turns: its average over a turn is zero."""
        share = 0.0 if turning else 1.0
        for b, e in zip(self._blocks, self._cells, strict=True):
            b.params[:, 2:4] = share * self.mesh.curvature[e]

    def update_reference_frames(self) -> None:
        for b, e in zip(self._blocks, self._cells, strict=True):
            b.params[:, 5:17] = frame_columns(self.frames, e)

    def energies(self, t: float, state) -> Energies:
        total = 0.0
        for b in self._blocks:
            index, out = state.layout.index(b), np.zeros(len(b.points))
            _curved_energy(
                len(out), index.shape[1], pointer(index), pointer(b.params), pointer(state.x), pointer(out)
            )
            total += out.sum()
        # the constant EI kappa0^2/2 makes the energy of the free shape zero
        for e in self._cells:
            m = self.mesh
            total += float(
                np.sum(0.5 * m.bending_stiffness[e] * m.length[e] * np.sum(m.curvature[e] ** 2, axis=1))
            )
        return Energies(strain=float(total))
