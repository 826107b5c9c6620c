"""A scene given memory: line, layout, assembly, and the way between PETSc's vectors and the kernels'
arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.assembly import Assembly
from drillpetsc.fem.chain import build_chain
from drillpetsc.fem.component import Component, Energies, Powers
from drillpetsc.fem.dof_layout import build_dof_layout
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames


class DiscreteSystem:
    """The discrete scene on this rank.

    rooms: in the order in which they add rows; frames: shared with the beam room; ``comm`` a PETSc or mpi4py
    communicator.
    """

    def __init__(
        self,
        mesh: StringMesh,
        frames: Frames,
        components: Sequence[Component],
        comm: PETSc.Comm | None = None,
    ):
        self.mesh, self.frames, self.components = mesh, frames, tuple(components)
        # the two nodes of a joint stand at one depth: there the line counts nodes instead
        self.chain = build_chain(
            np.arange(mesh.nodes, dtype=float) if mesh.joints else mesh.node_depth, comm or PETSc.COMM_WORLD
        )
        self.comm = self.chain.plex.comm
        junction = mesh.junction if len(mesh.junction) else np.zeros(mesh.nodes, dtype=bool)
        order = np.arange(mesh.nodes)
        regions = {
            "string": order >= 0,
            "junction": junction,
            "below_top": order > 0,
            "bottom": order == mesh.nodes - 1,
        }
        for component in self.components:
            regions |= component.regions()
        self.regions = regions
        #: constraint rows with multipliers, whole string: so many negative eigenvalues has the tangent of a
        #: stable state
        self.multipliers = sum(component.multipliers for component in self.components)
        #: whether the equations are a DAE of index 2 or 3
        self.constrained = self.multipliers > 0 or any(
            component.has_constraints for component in self.components
        )
        fields = tuple(f for component in self.components for f in component.fields())
        # a string with other unknowns than position, slope and spin gives these as derived fields
        other = next((component for component in self.components if component.derived_fields), None)
        self.layout = build_dof_layout(self.chain, fields, regions, other.derived_fields if other else None)
        blocks = tuple(b for component in self.components for b in component.blocks(self.chain))
        if other is not None:
            blocks = tuple(map(other.translate, blocks))
        prescribed = tuple(p for component in self.components for p in component.prescribed())
        stabilizations = tuple(component.velocity_stabilization(self.chain) for component in self.components)
        self.assembly = Assembly(
            self.layout,
            blocks,
            prescribed,
            frames.reference[self.chain.vertices],
            tuple(s for s in stabilizations if s),
        )
        layout, asm = self.layout, self.assembly
        asm.derive = other.derive if other else None
        self._x = PETSc.Vec().createWithArray(asm.x[: layout.size], comm=PETSc.COMM_SELF)
        self._r = PETSc.Vec().createWithArray(asm.r[: layout.size], comm=PETSc.COMM_SELF)
        self._state = layout.state_dm.createLocalVec()
        self.owned_place = np.full(layout.size, -1, dtype=np.int32)
        self.owned_place[layout.local_of_owned] = np.arange(len(layout.local_of_owned))
        self._alone = self.comm.size == 1
        scale = np.array([f.scale for f in layout.fields])
        self.scale = scale[layout.field_of]  # (n,) usual magnitude of each local unknown
        self._rated = layout.y_local >= 0

    @property
    def has_contact(self) -> bool:
        """Whether rows of any component are switched by contact."""
        return any(component.has_contact for component in self.components)

    def contact_signature(self) -> int:
        """A number that changes when contacts open or close on this rank; the Jacobian is then rebuilt."""
        return hash(
            tuple(component.contact_signature() for component in self.components if component.has_contact)
        )

    # ------------------------------------------------------------------ vectors
    def new_state(self) -> PETSc.Vec:
        return self.layout.state_dm.createGlobalVec()

    def new_condensed(self) -> PETSc.Vec:
        return self.layout.condensed_dm.createGlobalVec()

    def load_unknowns(self, q: PETSc.Vec) -> None:
        """Condensed global vector into ``assembly.x``, ghosts included."""
        self.layout.condensed_dm.globalToLocal(q, self._x)

    def load_state(self, state: PETSc.Vec, rate: PETSc.Vec | None = None) -> None:
        """State (and its rate) into the assembly's x, y (and a)."""
        layout, asm = self.layout, self.assembly
        layout.state_dm.globalToLocal(state, self._state)
        s = self._state.getArray(readonly=1)
        asm.x[: layout.size] = s[layout.x_local]
        asm.y[: layout.size] = np.where(self._rated, s[layout.y_local], 0.0)
        if rate is not None:
            layout.state_dm.globalToLocal(rate, self._state)
            s = self._state.getArray(readonly=1)
            asm.y[: layout.size] = np.where(self._rated, asm.y[: layout.size], s[layout.x_local])
            asm.a[: layout.size] = np.where(self._rated, s[layout.y_local], 0.0)

    def load_history(self, constant: PETSc.Vec) -> None:
        """Constant part of the rates, Ydot = shift Y + constant, into v0 and v1."""
        layout, asm = self.layout, self.assembly
        layout.state_dm.globalToLocal(constant, self._state)
        s = self._state.getArray(readonly=1)
        asm.v0[:] = s[layout.x_local]
        asm.v1[:] = np.where(self._rated, s[layout.y_local], 0.0)

    def store_state(self, state: PETSc.Vec) -> None:
        """The assembly's x and y into the owned part of ``state``."""
        layout, asm = self.layout, self.assembly
        out = state.getArray()
        out[layout.x_owned] = asm.x[layout.local_of_owned]
        has = layout.y_owned >= 0
        out[layout.y_owned[has]] = asm.y[layout.local_of_owned[has]]

    def store_unknowns(self, q: PETSc.Vec) -> None:
        q.getArray()[:] = self.assembly.x[self.layout.local_of_owned]

    def sum_residual(self, t: float, out: PETSc.Vec) -> None:
        """Residual of all rooms at the assembly's x, y, a, summed over ranks, prescribed rows replaced."""
        self.assembly.residual(t)
        if self._alone:
            out.getArray()[:] = self.assembly.r[self.layout.local_of_owned]
        else:
            out.set(0.0)
            self.layout.condensed_dm.localToGlobal(self._r, out, addv=PETSc.InsertMode.ADD_VALUES)
        if self.assembly.row_replacements:
            self.assembly.replace_rows(t, out.getArray(), self.owned_place)

    def sum_local(self, rows: FloatArray) -> FloatArray:
        """Contributions (n+1,) of this rank's elements to local rows, summed over ranks; (n,) valid at owned
        unknowns."""
        self.assembly.r[: len(rows)] = rows
        out = self.new_condensed()
        self.layout.condensed_dm.localToGlobal(self._r, out, addv=PETSc.InsertMode.ADD_VALUES)
        local = np.zeros(self.layout.size)
        local[self.layout.local_of_owned] = out.getArray(readonly=1)
        return local

    def locate_largest_residual(self, t: float) -> dict[str, Any]:
        """Where the rows are worst: room, element and measured depth of the largest (or first non-finite)
        residual."""
        asm, worst = self.assembly, (-1.0, "", -1, 0.0)
        for b in asm.bound_blocks:
            if not b.count:
                continue
            rows = asm.block_rows(b, t)
            bad = ~np.isfinite(rows)
            size = np.where(bad, np.inf, np.abs(rows)).max(axis=1)
            e = int(size.argmax())
            if size[e] > worst[0]:
                number = (
                    self.chain.cells[b.block.points[e]]
                    if b.block.on == "cell"
                    else self.chain.vertices[b.block.points[e]]
                )
                worst = (float(size[e]), b.block.component, int(number), float(self.mesh.node_depth[number]))
        if not self._alone:
            worst = max(self.comm.tompi4py().allgather(worst))
        return {"component": worst[1], "element": worst[2], "measured_depth": worst[3]}

    def accept(self) -> None:
        """Accept the current state and update components with history variables (collective).

        Rank-local changes are returned by ``local_update``; their sum over ranks is passed to ``apply_update``.
        """
        for component in self.components:
            component.accept(self.assembly)
            if component.update_size:
                change = component.local_update(self.assembly)
                component.apply_update(change if self._alone else self.comm.tompi4py().allreduce(change))

    def renew_reference_frames(self) -> bool:
        """Replace reference directions that are nearly opposite to the tangent; True where any changed (collective)."""
        changed = [component.renew_reference_frames(self) for component in self.components]
        return any(changed)

    # ------------------------------------------------------------------ energies and reactions
    def energies(self, t: float) -> Energies:
        """Stored energies at the assembly's x, y, summed over ranks."""
        parts = np.array([component.energies(t, self.assembly) for component in self.components]).sum(axis=0)
        return Energies(*(parts if self._alone else self.comm.tompi4py().allreduce(parts)))

    def powers(self, t: float) -> Powers:
        """Dissipated and supplied power at the assembly's x, y, a, summed over ranks; the reactions of the
        last residual supply."""
        parts = self.own_powers(t)
        return Powers(*(parts if self._alone else self.comm.tompi4py().allreduce(parts)))

    def own_powers(self, t: float) -> FloatArray:
        """(2,) this rank's share of the dissipated and the supplied power [W]."""
        parts = np.array([component.powers(t, self.assembly) for component in self.components]).sum(axis=0)
        parts[1] += sum(
            float(f.reaction @ f.condition.rate(t)) for f in self.assembly.row_replacements if f.owned
        )
        if self.assembly.dead_load is not None:
            parts[1] += self.assembly.dead_load @ self.assembly.y[: self.layout.size]
        return parts

    def reaction(self, name: str) -> float:
        """Reaction that the prescribed component ``name`` needs (0 where there is none), the same on all
        ranks [N or N m]."""
        value = 0.0
        for f in self.assembly.row_replacements:
            if f.owned and name in f.condition.names:
                value += float(f.reaction[f.condition.names.index(name)])
        value += sum(component.reaction(name, self.assembly) for component in self.components)
        return value if self._alone else float(self.comm.tompi4py().allreduce(value))

    def all_entries(self, on_rank: list) -> list:
        """The lists of all ranks joined in the order of the ranks, on every rank; collective."""
        if self._alone:
            return on_rank
        return [entry for part in self.comm.tompi4py().allgather(on_rank) for entry in part]

    def gather(self, values: FloatArray, on: str = "vertex") -> FloatArray | None:
        """Values (nv, k) at local vertices, or (nc, k) at local cells, collected on rank 0 in depth order;
        None elsewhere."""
        chain = self.chain
        if on == "vertex":
            numbers, values, size = chain.vertices[chain.owned], values[chain.owned], chain.size
        else:
            numbers, size = chain.cells, chain.size - 1
        if self._alone:
            out = np.empty((size, *values.shape[1:]))
            out[numbers] = values
            return out
        pieces = self.comm.tompi4py().gather((numbers, values))
        if pieces is None:
            return None
        out = np.empty((size, *values.shape[1:]))
        for number, piece in pieces:
            out[number] = piece
        return out

    def field(self, name: str, what: str = "x") -> FloatArray:
        """(nv, size) values of a field at local vertices: what = x, y or a; absent places give the field's
        value at rest."""
        place = self.layout.dofs[name]
        values = getattr(self.assembly, what)[np.maximum(place, 0)]
        rest = next(f.default for f in self.layout.fields if f.name == name) if what == "x" else 0.0
        return np.where(place >= 0, values, rest)

    def set_field(self, name: str, values: FloatArray, what: str = "x") -> None:
        """Set a field's local values from (n_nodes, size) values over the whole string."""
        place = self.layout.dofs[name]
        has = place >= 0
        getattr(self.assembly, what)[place[has]] = values[self.chain.vertices][has]
