"""Dof layout: PETSc sections over the chain, and the tables from a kernel's slots to dofs.

Two kinds of vectors share one chain (manual: sec-time-state).  The *state* is what the time integrator uses:
all unknowns of a vertex, then the rates of the second-order ones.  The *condensed* vector has the unknowns
only; within a step the rates follow from them (manual: eq-time-condensed).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from petsc4py import PETSc

from drillpetsc import petsc_compat
from drillpetsc.arrays import IntArray
from drillpetsc.fem.chain import Chain
from drillpetsc.fem.component import ElementBlock, Field


@dataclass(frozen=True)
class DofLayout:
    """Sections and dof tables of a discrete system.

    Below, n counts the local unknowns (ghosts included), nv the local vertices, m the owned unknowns.

    state_dm, condensed_dm: DMs whose sections lay out the two kinds of vectors.
    dofs[field]: (nv, size) indices of the field's components in the condensed local array, -1 if absent.
    field_of, vertex_of: (n,) field number and local vertex of each unknown.
    x_local, y_local: (n,) index of each unknown and of its rate (-1: none) in the local state.
    x_owned, y_owned: (m,) the same in the owned part of the global state.
    local_of_owned: (m,) local dof of each owned unknown of the condensed vector.
    derived[name]: (nv, size) indices of a derived field in the assembly's arrays, behind the unknowns.
    """

    chain: Chain
    fields: tuple[Field, ...]
    state_dm: PETSc.DM
    condensed_dm: PETSc.DM
    dofs: dict[str, IntArray]
    field_of: IntArray
    vertex_of: IntArray
    x_local: IntArray
    y_local: IntArray
    x_owned: IntArray
    y_owned: IntArray
    local_of_owned: IntArray
    derived: dict[str, IntArray] = field(default_factory=dict)

    @property
    def array_length(self) -> int:
        """Length of the assembly's arrays: unknowns, one entry for absent fields, derived fields."""
        return self.size + 1 + sum(int(dofs.size) for dofs in self.derived.values())

    def dofs_of(self, name: str) -> IntArray:
        """Return the (nv, size) indices of a field or of a derived field."""
        return self.dofs[name] if name in self.dofs else self.derived[name]

    @cached_property
    def size(self) -> int:
        """Number of unknowns of the condensed vector on this rank, ghosts included."""
        return len(self.x_local)

    def index(self, block: ElementBlock) -> IntArray:
        """Compute the (n, d) local dofs of a block's slots; absent fields have index ``size``."""
        rows = self.chain.ends[block.points] if block.on == "cell" else block.points[:, None]
        columns = [self.dofs_of(name)[rows[:, end]] for name, end in block.slots]
        table = np.hstack(columns) if len(block.points) else np.zeros((0, self.width(block)), dtype=np.int32)
        return np.ascontiguousarray(np.where(table < 0, self.size, table), dtype=np.int32)

    def width(self, block: ElementBlock) -> int:
        """Number d of unknowns of one element of ``block``."""
        return sum(self.dofs_of(name).shape[1] for name, _ in block.slots)

    def spin_vertices(self, block: ElementBlock) -> IntArray:
        """Return the (n, spins) local vertex of each spin angle of a block."""
        rows = self.chain.ends[block.points] if block.on == "cell" else block.points[:, None]
        return np.ascontiguousarray(rows[:, list(block.spins)], dtype=np.int32).reshape(
            len(block.points), len(block.spins)
        )


def _section(
    chain: Chain, fields: tuple[Field, ...], regions: dict[str, np.ndarray], with_rates: bool
) -> PETSc.DM:
    """Create a DM with a section of ``fields``.

    ``with_rates`` adds the rates of second-order fields behind them.
    """
    dm = chain.plex.clone()
    section_fields = [(f, "") for f in fields] + (
        [(f, ".rate") for f in fields if f.second_order] if with_rates else []
    )
    section = PETSc.Section().create(comm=chain.plex.comm)
    section.setNumFields(len(section_fields))
    section.setChart(*chain.plex.getChart())
    total = np.zeros(len(chain.points), dtype=int)
    for i, (f, suffix) in enumerate(section_fields):
        section.setFieldName(i, f.name + suffix)
        section.setFieldComponents(i, f.size)
        present = regions[f.region][chain.vertices]
        for point in chain.points[present]:
            section.setFieldDof(int(point), i, f.size)
        total += f.size * present
    for point, dof in zip(chain.points, total, strict=True):
        section.setDof(int(point), int(dof))
    section.setUp()
    petsc_compat.set_section(dm, section)
    return dm


def build_dof_layout(
    chain: Chain,
    fields: tuple[Field, ...],
    regions: dict[str, np.ndarray],
    derived_fields: dict[str, int] | None = None,
) -> DofLayout:
    """Lay out fields over the chain.

    chain: this rank's part of the chain.
    fields: unknowns of all components, in the order of the section.
    regions[name]: mask over all vertices of the string, the same on every rank.
    derived_fields: components at a vertex of quantities that follow from unknowns and are used like fields.
    """
    state, condensed = _section(chain, fields, regions, True), _section(chain, fields, regions, False)
    s_sec, c_sec = petsc_compat.get_section(state), petsc_compat.get_section(condensed)
    size = c_sec.getStorageSize()
    x_local, y_local = np.full(size, -1, dtype=np.int32), np.full(size, -1, dtype=np.int32)
    field_of, vertex_of = np.zeros(size, dtype=np.int32), np.zeros(size, dtype=np.int32)
    dofs = {f.name: np.full((len(chain.points), f.size), -1, dtype=np.int32) for f in fields}
    # fields of a point follow each other, so one offset a point is enough
    present = [regions[f.region][chain.vertices] for f in fields]
    points = chain.points.tolist()
    at_c, at_s = (
        np.array([section.getOffset(point) for point in points], dtype=np.int64) for section in (c_sec, s_sec)
    )
    for i, (f, here) in enumerate(zip(fields, present, strict=True)):
        places, vertices = np.arange(f.size), np.flatnonzero(here)
        at_vertex = at_c[vertices, None] + places
        dofs[f.name][vertices] = at_vertex
        field_of[at_vertex], vertex_of[at_vertex] = i, vertices[:, None]
        x_local[at_vertex] = at_s[vertices, None] + places
        at_c, at_s = at_c + f.size * here, at_s + f.size * here
    for f, here in zip(fields, present, strict=True):
        if f.second_order:
            vertices = np.flatnonzero(here)
            y_local[dofs[f.name][vertices]] = at_s[vertices, None] + np.arange(f.size)
            at_s = at_s + f.size * here
    owned = _owned_tables(chain, state, condensed, x_local, y_local)
    derived, next_index = {}, size + 1
    for name, components in (derived_fields or {}).items():
        count = len(chain.points) * components
        derived[name] = np.arange(next_index, next_index + count, dtype=np.int32).reshape(-1, components)
        next_index += count
    return DofLayout(
        chain, fields, state, condensed, dofs, field_of, vertex_of, x_local, y_local, *owned, derived=derived
    )


def _owned_tables(
    chain: Chain, state: PETSc.DM, condensed: PETSc.DM, x_local, y_local
) -> tuple[IntArray, IntArray, IntArray]:
    """Compute x_owned, y_owned and local_of_owned from the local-to-global maps of both sections."""
    lgm_c = condensed.getLGMap().getIndices()
    lgm_s = state.getLGMap().getIndices()
    first_c = condensed.createGlobalVec().getOwnershipRange()
    first_s = state.createGlobalVec().getOwnershipRange()
    local_owned = np.flatnonzero((lgm_c >= first_c[0]) & (lgm_c < first_c[1]))
    local_of_owned = np.empty(first_c[1] - first_c[0], dtype=np.int32)
    local_of_owned[lgm_c[local_owned] - first_c[0]] = local_owned
    x_owned = (lgm_s[x_local[local_of_owned]] - first_s[0]).astype(np.int32)
    rates = y_local[local_of_owned]
    y_owned = np.where(rates >= 0, lgm_s[np.maximum(rates, 0)] - first_s[0], -1).astype(np.int32)
    return x_owned, y_owned, local_of_owned
