"""Forces and couples at the ends of the elements, and the curvature of the string there (manual: sec-beam-nodal)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from drillpetsc.fem.assembly import Assembly
from drillpetsc.fem.bound_parts import BoundBlock
from drillpetsc.fem.component import FloatArray
from drillpetsc.geometry.frames import cross, directors, high_sides
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.tools.steering import PointTool

#: represents the areas of a rigid item whose mud is left out of the element below it [m2]
NO_AREA = 1e-30


@dataclass(frozen=True)
class EndForces:
    """Forces that the string below a point exerts on the string above it, at both ends of each local element.

    tangent: (nc, 2, 3) of the string [-].
    force: (nc, 2, 3) [N], effective: with the pressures of the mud on the section.
    moment: (nc, 2, 3) bending moment, across the tangent [N m]; zero in joints.
    """

    tangent: FloatArray
    force: FloatArray
    moment: FloatArray

    @cached_property
    def shear(self) -> FloatArray:
        """(nc, 2, 3) force across the tangent [N]."""
        return self.force - self.tangent * np.sum(self.tangent * self.force, axis=2, keepdims=True)

    @cached_property
    def moment_size(self) -> FloatArray:
        """(nc, 2) bending moment [N m]."""
        return np.asarray(np.linalg.norm(self.moment, axis=2))

    @cached_property
    def shear_size(self) -> FloatArray:
        """(nc, 2) shear force [N]."""
        return np.asarray(np.linalg.norm(self.shear, axis=2))

    @property
    def towards_bend(self) -> FloatArray:
        """(nc, 2, 3) bending moment turned to the direction in which it bends the string [N m]."""
        return cross(self.moment.reshape(-1, 3), self.tangent.reshape(-1, 3)).reshape(self.moment.shape)


def end_forces(model: DrillingModel, time: float = 0.0) -> EndForces:
    """Forces and bending moments at the ends of the local elements, from the elements' equilibrium.

    They follow from the rows of all components on an element: elastic and damping forces less distributed loads and inertia.
    At an end of an element they are the forces of its neighbour. So they are exact for a straight beam under loads distributed
    by the element (manual: eq-beam-nodal-moment).  time: of inputs [s].
    """
    system, beam = model.system, model.beam
    asm, mesh, cells = system.assembly, system.mesh, system.chain.cells
    count = len(cells)
    turned = asm.x[asm.dofs_of(beam.orientation)][system.chain.ends]  # (nc, 2, k)
    both = np.zeros((count, 2, 3 + turned.shape[2]))  # rows of position and orientation
    for bound in asm.bound_blocks:
        if bound.block.on == "cell" and bound.count:
            rows = _rows(asm, bound, time)
            points = (
                slice(None) if bound.count == count else bound.block.points
            )  # all of them are in depth order
            for end, (position, orientation) in _places(bound, beam.orientation).items():
                if position.stop == orientation.start:  # as a rule: one sum instead of two
                    both[points, end] += rows[:, position.start : orientation.stop]
                else:
                    both[points, end, :3] += rows[:, position]
                    both[points, end, 3:] += rows[:, orientation]
    forces, turning = np.ascontiguousarray(both[..., :3]), both[..., 3:]
    flat = turned.reshape(-1, turned.shape[2]), turning.reshape(-1, turned.shape[2])
    couples = beam.couple(*flat).reshape(count, 2, 3)
    slope = asm.x[asm.dofs_of("string.tangent")][system.chain.ends]
    tangent = slope / np.linalg.norm(slope, axis=2, keepdims=True)
    # the upper node of an element below a rigid item lies at the item's upper end
    lever = mesh.rigid_above[cells][:, None] * tangent[:, 0]
    couples[:, 0] -= cross(lever, forces[:, 0])
    for bound in asm.bound_blocks:  # loads that are shared out to the nodes of an element
        if bound.block.elements is not None and (bound.block.elements >= 0).any():
            chosen = np.flatnonzero(bound.block.elements >= 0)
            cell, vertex = bound.block.elements[chosen], bound.block.points[chosen]
            end = (system.chain.ends[cell, 1] == vertex).astype(int)
            rows, values = asm.block_rows(bound, time)[chosen], asm.x[bound.index[chosen]]
            position, orientation = _places(bound, beam.orientation)[0]
            np.add.at(forces, (cell, end), rows[:, position])
            np.add.at(couples, (cell, end), beam.couple(values[:, orientation], rows[:, orientation]))
    for values in (forces, couples):
        values[:, 0] *= -1.0
        values[mesh.is_joint[cells]] = 0.0
    couples -= tangent * np.sum(tangent * couples, axis=2, keepdims=True)
    return EndForces(tangent, forces, couples)


def _places(bound: BoundBlock, orientation: str) -> dict[int, tuple[slice, slice]]:
    """Columns of position and orientation of the string in a block's unknowns, by end; empty without the string."""
    found = bound.columns
    return {
        end: (found["string.position", end], found[orientation, end])
        for end in (0, 1)
        if ("string.position", end) in found and (orientation, end) in found
    }


def _rows(asm: Assembly, bound: BoundBlock, time: float) -> FloatArray:
    """Rows (n, d) of a block; the mud in and around a rigid item, which acts on the item, is left out."""
    table = bound.block.named
    areas = [name for name in ("area_above", "outer_above") if name in table.columns.at]
    kept = {name: np.array(table[name]) for name in areas}
    for name in areas:
        table[name] = NO_AREA
    try:
        return asm.block_rows(bound, time)
    finally:
        for name, values in kept.items():
            table[name] = values


def across_hole(model: DrillingModel, vectors: FloatArray) -> FloatArray:
    """(nc, 2, 2) components of ``vectors`` (nc, 2, 3) at the ends of the local elements.

    Towards the high side of the hole at the node (north in a vertical hole), and to the right of it looking down.
    """
    return all_across_hole(model, vectors)[0]


def all_across_hole(model: DrillingModel, *vectors: FloatArray) -> list[FloatArray]:
    """The same of several ``vectors``."""
    ends = model.system.chain.ends
    tangents = np.asarray(model.axis.project(model.system.field("string.position")).tangent)
    first = high_sides(tangents)
    axes = [axis[ends] for axis in (first, cross(tangents, first))]
    return [np.stack([np.sum(v * axis, axis=2) for axis in axes], axis=2) for v in vectors]


def curvatures(model: DrillingModel, moment: FloatArray) -> FloatArray:
    """(nc, 2, 3) curvature vectors [1/m] of the local elements at both ends: M/EI plus the stress-free curvature.

    moment: (nc, 2, 3) bending moment [N m], without damping.
    """
    mesh, chain = model.mesh, model.system.chain
    e = chain.cells
    stiffness = mesh.bending_stiffness[e]
    flexible = (stiffness > 0) & ~mesh.is_joint[e]
    out = np.zeros_like(moment)
    out[flexible] = moment[flexible] / stiffness[flexible, None, None]
    if mesh.curvature.any():
        v, phi = (model.system.field(f"string.{k}") for k in ("tangent", "spin"))
        for end in (0, 1):
            node = chain.ends[:, end]
            d2, d3 = directors(model.frames, chain.vertices[node], v[node], phi[node, 0])
            out[:, end] += mesh.curvature[e][:, :1] * d2 + mesh.curvature[e][:, 1:] * d3
        out[mesh.is_joint[e]] = 0.0
    for tool in model.parts(PointTool):
        cells, towards = tool.stress_free_curvature()
        slope = model.system.field("string.tangent")[chain.ends[cells]]
        tangent = slope / np.linalg.norm(slope, axis=2, keepdims=True)
        for end in (0, 1):
            out[cells, end] += cross(tangent[:, end], towards)
    return out
