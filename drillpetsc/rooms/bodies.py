"""Rigid bodies on nodes (stabiliser, bit, drive), unbalance and distributed eccentricity, stress-free curvature."""

from __future__ import annotations

import numpy as np

from drillpetsc.field import Block, Energies, FloatArray, Powers, Prescribed
from drillpetsc.frames import Frames
from drillpetsc.kernels import function, pointer
from drillpetsc.rooms.beam import SLOTS, SPLIT_SLOTS
from drillpetsc.tubulars import StringMesh

_body_energy = function("body_energy", "ippppp")
_curved_energy = function("curved_energy", "iipppp")
VERTEX_SLOTS = (("string.position", 0), ("string.tangent", 0), ("string.spin", 0))


class Passive:
    """Defaults of a room that adds rows to the string's unknowns and owns none."""

    name = ""

    def fields(self):
        return ()

    def blocks(self, part) -> tuple[Block, ...]:
        return ()

    def prescribed(self) -> tuple[Prescribed, ...]:
        return ()

    def breaks(self) -> tuple[float, ...]:
        return ()

    def energies(self, t: float, state) -> Energies:
        return Energies()

    def powers(self, t: float, state) -> Powers:
        return Powers()

    def refresh_gauges(self) -> None:
        """Nothing to renew."""


def local_vertices(part, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which of ``nodes`` (k,) this rank owns: (positions in ``nodes``, local vertex numbers)."""
    local = {int(v): i for i, v in enumerate(part.vertices) if part.owned[i]}
    chosen = [k for k, node in enumerate(nodes) if int(node) in local]
    return np.array(chosen, dtype=int), np.array([local[int(nodes[k])] for k in chosen], dtype=np.int32)


class Bodies(Passive):
    """Masses that ride on nodes.

    Each entry: (node, mass [kg], centre of gravity along the tangent and in the two directors [m], axial and transverse inertia
    [kg m2], carried: the beam already has the mass).  balanced: without what is off the axis, which averages out over a turn.
    """

    name = "bodies"

    def __init__(self, mesh: StringMesh, frames: Frames, gravity: FloatArray, balanced: bool = False):
        self.frames = frames
        entries = [(b.node, b.mass, b.center, *((0.0, 0.0) if balanced else b.offset), b.axial, b.transverse, 0.0) for b in mesh.bodies]
        for e in () if balanced else np.flatnonzero(np.any(mesh.eccentricity != 0, axis=1)):
            half = 0.5 * mesh.mass[e] * mesh.length[e]
            for node, center in ((e, mesh.rigid_above[e]), (e + 1, 0.0)):
                entries.append((node, half, center, *mesh.eccentricity[e], 0.0, 0.0, 1.0))
        self.entries = np.array(entries, dtype=float).reshape(-1, 8)
        self.gravity = np.asarray(gravity, dtype=float)

    def blocks(self, part) -> tuple[Block, ...]:
        chosen, vertices = local_vertices(part, self.entries[:, 0].astype(int))
        e = self.entries[chosen]
        nodes = e[:, 0].astype(int)
        gravity = np.tile(self.gravity, (len(e), 1))
        params = np.column_stack([e[:, 1:7], gravity, self.frames.gauge[nodes], self.frames.second[nodes], e[:, 7]])
        self._block = Block("bodies", "body", "vertex", vertices, VERTEX_SLOTS, (0,), np.ascontiguousarray(params))
        self._nodes = nodes
        return (self._block,)

    def refresh_gauges(self) -> None:
        self._block.params[:, 9:12] = self.frames.gauge[self._nodes]
        self._block.params[:, 12:15] = self.frames.second[self._nodes]

    def energies(self, t: float, state) -> Energies:
        out = np.zeros((len(self._nodes), 2))
        index = state.layout.index(self._block)
        _body_energy(len(out), pointer(index), pointer(self._block.params), pointer(state.x), pointer(state.y), pointer(out))
        return Energies(kinetic=float(out[:, 0].sum()), potential=float(out[:, 1].sum()))


class Curvature(Passive):
    """Pipe that is bent when free of stress: curvature (2,) [1/m] in the node directors, element by element."""

    name = "curvature"

    def __init__(self, mesh: StringMesh, frames: Frames):
        self.mesh, self.frames = mesh, frames

    def blocks(self, part) -> tuple[Block, ...]:
        m, bent = self.mesh, np.any(self.mesh.curvature != 0, axis=1)
        junction = m.junction if len(m.junction) else np.zeros(m.nodes, dtype=bool)
        self._blocks, self._cells = [], []
        for split in (False, True):
            if not (bent & (junction[:-1] == split)).any():
                continue
            chosen = np.flatnonzero(bent[part.cells] & (junction[part.cells] == split)).astype(np.int32)
            e = part.cells[chosen]
            params = np.column_stack([m.length[e], m.bending_stiffness[e], m.curvature[e], m.rigid_above[e], self._frame_columns(e)])
            self._blocks.append(Block("curvature_junction" if split else "curvature", "curved_split" if split else "curved", "cell",
                                      chosen, SPLIT_SLOTS if split else SLOTS, (0, 1), np.ascontiguousarray(params)))
            self._cells.append(e)
        return tuple(self._blocks)

    def scale(self, share: float) -> None:
        """Take ``share`` of the curvature: nothing of it is left on average while the string turns."""
        for b, e in zip(self._blocks, self._cells, strict=True):
            b.params[:, 2:4] = share * self.mesh.curvature[e]

    def _frame_columns(self, e: np.ndarray) -> FloatArray:
        f = self.frames
        return np.hstack([f.gauge[e], f.second[e], f.gauge[e + 1], f.second[e + 1]])

    def refresh_gauges(self) -> None:
        for b, e in zip(self._blocks, self._cells, strict=True):
            b.params[:, 5:17] = self._frame_columns(e)

    def energies(self, t: float, state) -> Energies:
        total = 0.0
        for b in self._blocks:
            index, out = state.layout.index(b), np.zeros(len(b.points))
            _curved_energy(len(out), index.shape[1], pointer(index), pointer(b.params), pointer(state.x), pointer(out))
            total += out.sum()
        # the constant EI kappa0^2/2 makes the energy of the free shape zero
        for e in self._cells:
            m = self.mesh
            total += float(np.sum(0.5 * m.bending_stiffness[e] * m.length[e] * np.sum(m.curvature[e] ** 2, axis=1)))
        return Energies(strain=float(total))
