"""The discrete system on this rank: chain, dof layout and assembly, and copies between PETSc vectors and arrays.

Manual: sec-time-state (state and condensed vector).
"""

from __future__ import annotations

import zlib
from collections.abc import Sequence
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.assembly import Assembly
from drillpetsc.fem.chain import build_chain
from drillpetsc.fem.component import Component, ElementBlock, Energies, Powers
from drillpetsc.fem.dof_layout import build_dof_layout
from drillpetsc.fem.end_exchange import EndExchange
from drillpetsc.fem.step_record import StepRecord
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.kernels import function, pointer
from drillpetsc.parallel import total
from drillpetsc.unit_systems import System, shown

_gather = function("chain_gather", "ippp")
_load_step, _store_step = function("load_step", "ippppdpppp"), function("store_step", "ippippppp")


class DiscreteSystem:
    """All components of a model on this rank, discretised.

    mesh: elements and nodes of the string.
    frames: reference frames of the nodes, the same object as in the beam component.
    components: in the order in which they add rows.
    comm: PETSc or mpi4py communicator, all ranks by default.
    """

    def __init__(
        self,
        mesh: StringMesh,
        frames: Frames,
        components: Sequence[Component],
        comm: PETSc.Comm | None = None,
    ):
        self.mesh, self.frames, self.components = mesh, frames, tuple(components)
        self.item_names: tuple[str, ...] = ()  # of the items of the string, for messages
        self.units: System = "SI"  # of the case, for messages
        # the two nodes of a joint have one depth: with joints the chain is ordered by node number instead
        self.chain = build_chain(
            np.arange(mesh.nodes, dtype=float) if mesh.joints else mesh.node_depth, comm or PETSc.COMM_WORLD
        )
        self.comm = self.chain.plex.comm
        self.regions = regions = self._find_regions()
        #: number of Lagrange multipliers of the whole string; a stable equilibrium has exactly as many
        #: negative eigenvalues (manual: eq-statics-stable)
        self.multipliers = sum(component.multipliers for component in self.components)
        #: whether the equations are a DAE of index 2 or 3
        self.constrained = self.multipliers > 0 or any(
            component.has_constraints for component in self.components
        )
        fields = tuple(f for component in self.components for f in component.fields())
        # a string with other unknowns than position, slope and spin declares these as derived fields
        other = next((component for component in self.components if component.derived_fields), None)
        self.layout = build_dof_layout(self.chain, fields, regions, other.derived_fields if other else None)
        by_component = [component.blocks(self.chain) for component in self.components]
        self.assembly = asm = self._assemble(tuple(b for own in by_component for b in own), other)
        #: of each bound block: its component
        self.component_of = [c for c, own in zip(self.components, by_component, strict=True) for _ in own]
        #: components that store energy, and components with powers
        self._storing = {"": self._with_own("energies", "energies_of")}
        self._working = self._with_own("powers", "powers_of")
        #: components with history variables
        self._remembering = [c for c in self.components if c.remembers]
        #: of each component, those that follow it in systems beside this one, with their assemblies
        self._beside: list[tuple[Component, list[tuple[Component, Assembly]]]] = []
        #: how often reference frames were renewed
        self.frames_renewed = 0
        #: components with reference frames
        self._framed = self._with_own("renew_reference_frames")
        #: of all components
        self.contact_flags = tuple(f for c in self.components for f in c.contact_flags())
        layout = self.layout
        self._r = PETSc.Vec().createWithArray(asm.r[: layout.size], comm=PETSc.COMM_SELF)
        self.owned_index = np.full(layout.size, -1, dtype=np.int32)
        self.owned_index[layout.local_of_owned] = np.arange(len(layout.local_of_owned))
        self._serial = self.comm.size == 1
        #: exchange with the ranks of the neighbouring pieces; None on one rank
        self.ends: EndExchange | None = None
        if not self._serial:
            chain, mpi = self.chain, self.comm.tompi4py()
            self.ends = EndExchange(mpi, chain.vertices, chain.owned, layout.vertex_of, self.owned_index)
        scale = np.array([f.scale for f in layout.fields])
        self.scale = scale[layout.field_of]  # (n,) usual magnitude of each local unknown
        self._with_rate = np.flatnonzero(layout.y_local >= 0)  # unknowns with a rate in the state
        self._make_tables()

    def _with_own(self, *hooks: str) -> list[Component]:
        """Components that implement one of these hooks."""
        base = [getattr(Component, name) for name in hooks]
        return [c for c in self.components if [getattr(type(c), name) for name in hooks] != base]

    def _assemble(self, blocks: tuple[ElementBlock, ...], other: Component | None) -> Assembly:
        """Bind the elements of all components to the layout.

        other: the component that declares position, slope and spin as derived fields, None if they are unknowns.
        """
        stabilizations = tuple(component.velocity_stabilization(self.chain) for component in self.components)
        assembly = Assembly(
            self.layout,
            blocks if other is None else tuple(map(other.translate, blocks)),
            tuple(p for component in self.components for p in component.prescribed()),
            self.frames.reference[self.chain.vertices],
            tuple(s for s in stabilizations if s),
        )
        assembly.derive = other.derive if other else None
        return assembly

    def _find_regions(self) -> dict[str, np.ndarray]:
        """Sets of vertices by name: (n_nodes,) masks, including the sets of all components."""
        mesh, order = self.mesh, np.arange(self.mesh.nodes)
        regions = {
            "string": order >= 0,
            "junction": mesh.junction if len(mesh.junction) else np.zeros(mesh.nodes, dtype=bool),
            "below_top": order > 0,
            "bottom": order == mesh.nodes - 1,
        }
        for component in self.components:
            regions |= component.regions()
        return regions

    def _make_tables(self) -> None:
        """Places of a global state's owned part in x and y, and back."""
        layout = self.layout
        owned = np.flatnonzero(layout.y_owned >= 0)
        from_state = np.full((2, layout.size), -1, dtype=np.int32)
        from_state[:, layout.local_of_owned] = layout.x_owned, layout.y_owned
        tables = (
            from_state[0],
            from_state[1],
            layout.local_of_owned,
            layout.x_owned,
            layout.local_of_owned[owned],
            layout.y_owned[owned],
        )
        self._tables = [np.ascontiguousarray(table, dtype=np.int32) for table in tables]
        self._x_from, self._y_from, self._owned, self._x_to, self._owned_rates, self._y_to = map(
            pointer, self._tables
        )
        self._owned_counts = len(self._tables[2]), len(self._tables[4])

    @property
    def remembers(self) -> bool:
        """Whether an accepted step changes history variables of any component."""
        return bool(self._remembering)

    @property
    def has_contact(self) -> bool:
        """Whether contact switches rows of any component."""
        return any(component.has_contact for component in self.components)

    def contact_signature(self) -> int:
        """A number that changes when contacts open or close on this rank; the Jacobian is then rebuilt.

        Unlike ``hash`` the same in every process.
        """
        return zlib.crc32(b"".join(flags.values.tobytes() for flags in self.contact_flags))

    # ------------------------------------------------------------------ vectors
    def new_state(self) -> PETSc.Vec:
        """Create a global state vector: unknowns and rates of the second-order ones."""
        return self.layout.state_dm.createGlobalVec()

    def new_condensed(self) -> PETSc.Vec:
        """Create a global condensed vector: unknowns only."""
        return self.layout.condensed_dm.createGlobalVec()

    def load_unknowns(self, q: PETSc.Vec) -> None:
        """Copy the condensed global vector ``q`` into ``assembly.x``, ghosts included."""
        self.assembly.x[self.layout.local_of_owned] = q.getArray(readonly=1)
        if self.ends is not None:
            self.ends.spread(self.assembly.x)

    def load_state(self, state: PETSc.Vec, rate: PETSc.Vec | None = None) -> None:
        """Copy a state into the assembly's x and y; with ``rate`` also the rates into y and a."""
        asm = self.assembly
        self._take(state, asm.x, asm.y)
        if rate is not None:
            known = asm.y[self._with_rate]
            self._take(rate, asm.y, asm.a)
            asm.y[self._with_rate] = known

    def load_step(self, state: PETSc.Vec, rate: PETSc.Vec, shift: float) -> None:
        """Copy a state X into the assembly's x and y, and the constant V of the time formula, Xdot = shift X + V, into v0 and v1.

        Manual: eq-time-bdf.  rate: Xdot; shift: [1/s].
        """
        asm = self.assembly
        x, y, _, _ = asm.state_at
        arrays = pointer(state.getArray(readonly=1)), pointer(rate.getArray(readonly=1))
        _load_step(self.layout.size, self._x_from, self._y_from, *arrays, shift, x, y, *asm.history_at)
        if self.ends is not None:
            self.ends.spread(asm.v0, asm.v1)
            self.ends.spread(asm.x, asm.y)

    def _take(self, state: PETSc.Vec, unknowns: FloatArray, rates: FloatArray) -> None:
        """Copy both parts of a global state into local arrays, ghosts included; zero if an unknown has no rate."""
        s = pointer(state.getArray(readonly=1))
        _gather(self.layout.size, self._x_from, s, pointer(unknowns))
        _gather(self.layout.size, self._y_from, s, pointer(rates))
        if self.ends is not None:
            self.ends.spread(unknowns, rates)

    def store_state(self, state: PETSc.Vec) -> None:
        """Copy the assembly's x and y into the owned part of ``state``."""
        x, y, _, _ = self.assembly.state_at
        unknowns, rates = self._owned_counts
        _store_step(
            unknowns,
            self._owned,
            self._x_to,
            rates,
            self._owned_rates,
            self._y_to,
            x,
            y,
            pointer(state.getArray()),
        )

    def store_unknowns(self, q: PETSc.Vec) -> None:
        """Copy the assembly's x into the owned part of the condensed vector ``q``."""
        q.getArray()[:] = self.assembly.x[self.layout.local_of_owned]

    def sum_residual(self, t: float, out: PETSc.Vec) -> None:
        """Compute the residual of all components at the assembly's x, y, a into ``out``, summed over ranks.

        Rows along prescribed directions are replaced (manual: eq-prescribed-rows).  ``t``: time [s].
        """
        self.assembly.residual(t)
        rows = out.getArray()
        self.assembly.r.take(self.layout.local_of_owned, out=rows, mode="clip")
        if self.ends is not None:
            self.ends.add(self.assembly.r, rows)
        if self.assembly.row_replacements:
            self.assembly.replace_rows(t, rows, self.owned_index)

    def sum_local(self, rows: FloatArray) -> FloatArray:
        """Sum contributions of elements over ranks.

        rows: (n+1,) contributions of this rank's elements to the local rows.
        Returns (n,) sums, valid at owned unknowns.
        """
        self.assembly.r[: len(rows)] = rows
        out = self.new_condensed()
        self.layout.condensed_dm.localToGlobal(self._r, out, addv=PETSc.InsertMode.ADD_VALUES)
        local = np.zeros(self.layout.size)
        local[self.layout.local_of_owned] = out.getArray(readonly=1)
        return local

    def locate_largest_residual(self, t: float) -> dict[str, Any]:
        """Find the largest (or first non-finite) residual: component, element and measured depth [m].

        Collective.
        """
        asm, largest = self.assembly, (-1.0, "", -1, 0.0)
        for b in asm.bound_blocks:
            if not b.count:
                continue
            rows = asm.block_rows(b, t)
            bad = ~np.isfinite(rows)
            size = np.where(bad, np.inf, np.abs(rows)).max(axis=1)
            e = int(size.argmax())
            if size[e] > largest[0]:
                number = (
                    self.chain.cells[b.block.points[e]]
                    if b.block.on == "cell"
                    else self.chain.vertices[b.block.points[e]]
                )
                largest = (
                    float(size[e]),
                    b.block.component,
                    int(number),
                    float(self.mesh.node_depth[number]),
                )
        if not self._serial:
            largest = max(self.comm.tompi4py().allgather(largest))
        place = {"component": largest[1], "element": largest[2], "measured_depth": largest[3]}
        place["place"] = shown(largest[3], "length", self.units, 6)
        items = self.mesh.item
        if self.item_names and len(items):
            place["item"] = self.item_names[items[min(max(largest[2], 0), len(items) - 1)]]
        return place

    def accept(self, t: float) -> None:
        """Accept the current state at time ``t`` [s] and update components with history variables (collective).

        Rank-local changes are returned by ``local_update``; their sum over ranks is passed to
        ``apply_update``.
        """
        asm = self.assembly
        for component in self._remembering:
            component.accept(t, asm)
            self._update_component(component, asm)

    def _update_component(self, component: Component, asm: Assembly) -> None:
        if component.update_size and not component.idle:
            change = component.local_update(asm)
            component.apply_update(change if self._serial else total(self.comm, change))

    def lead(self, others: Sequence[DiscreteSystem]) -> None:
        """Let ``others``, systems beside this one, renew in ``accept_beside`` what this one has renewed in ``accept``."""
        for component in self.components:
            theirs = [(q, o.assembly) for o in others for q in o._remembering if q.name == component.name]
            for other, state in theirs:
                other.follow(component, state)
            if theirs:
                self._beside.append((component, theirs))

    def accept_beside(self, t: float) -> None:
        """Accept in the systems beside this one the end ``t`` [s] of a step that this one has accepted (collective)."""
        for component, theirs in self._beside:
            component.accept_beside(t, theirs)
            for other, state in theirs:
                self._update_component(other, state)

    @property
    def idle(self) -> bool:
        """Whether ``accept`` would change nothing after this step; the same on all ranks."""
        return all(component.idle for component in self._remembering)

    @property
    def strayed(self) -> bool:
        """Whether a component has left its leader; the same on all ranks."""
        return any(component.strayed for component in self._remembering)

    def renew_reference_frames(self) -> bool:
        """Replace reference directions that are nearly opposite to the tangent.

        True if any changed (collective).
        """
        changed = [component.renew_reference_frames(self) for component in self._framed]
        self.frames_renewed += any(changed)
        return any(changed)

    # ------------------------------------------------------------------ energies and reactions
    def energies(self, t: float, physics: str = "") -> Energies:
        """Compute the stored energies [J] at the assembly's x, y and time ``t`` [s], summed over ranks.

        physics: only components whose elements have unknowns of this physics.
        """
        return Energies(*total(self.comm, self._local_energies(t, physics)).tolist())

    def _local_energies(self, t: float, physics: str = "") -> FloatArray:
        """(3,) ``energies`` of this rank."""
        kinetic = strain = potential = 0.0
        for component in self._storing_of(physics):
            part = component.energies(t, self.assembly)
            kinetic, strain, potential = kinetic + part[0], strain + part[1], potential + part[2]
        return np.array([kinetic, strain, potential])

    def _storing_of(self, physics: str) -> list[Component]:
        """Components that store energy and have an element on this rank with unknowns of ``physics``; all if that is empty."""
        if physics not in self._storing:
            names = {f.name for f in self.layout.fields if f.physics == physics}
            pairs = zip(self.assembly.bound_blocks, self.component_of, strict=True)
            found = [c for b, c in pairs if b.count and any(name in names for name, _ in b.block.slots)]
            self._storing[physics] = [c for c in self._storing[""] if c in found]
        return self._storing[physics]

    def powers(self, t: float) -> Powers:
        """Compute the dissipated and supplied power [W] at the assembly's x, y, a, summed over ranks.

        The supplied power includes the power of the reactions of the last residual.
        """
        parts = self.local_powers(t)
        return Powers(*total(self.comm, parts).tolist())

    def local_powers(self, t: float) -> FloatArray:
        """Compute this rank's part (2,) of the dissipated and the supplied power [W]."""
        dissipated = supplied = 0.0
        for component in self._working:
            part = component.powers(t, self.assembly)
            dissipated, supplied = dissipated + part[0], supplied + part[1]
        for f in self.assembly.row_replacements:
            if f.owned:
                f.evaluate(t, self.assembly.x)
                supplied += float(f.reaction @ f.rate)
        if self.assembly.dead_load is not None:
            supplied += float(self.assembly.dead_load @ self.assembly.y[: self.layout.size])
        return np.array([dissipated, supplied])

    def energies_of(self, steps: StepRecord) -> FloatArray:
        """(k, 3) ``energies`` of this rank after each of k recorded steps [J]."""
        if self.assembly.derive is not None:
            return steps.computed(lambda sample: self._local_energies(sample.time), 3, "energies")
        out = np.zeros((len(steps), 3))
        for component in self._storing_of(""):
            for k, part in enumerate(component.energies_of(steps)):
                out[:, k] += part
        return out

    def powers_of(self, steps: StepRecord) -> FloatArray:
        """(k, 2) ``local_powers`` after each of k recorded steps [W]."""
        asm = self.assembly
        if asm.dead_load is not None or asm.derive is not None:
            return steps.computed(lambda sample: self.local_powers(sample.time), 2, "powers")
        out = np.zeros((len(steps), 2))
        for component in self._working:
            for k, part in enumerate(component.powers_of(steps)):
                out[:, k] += part
        for f in asm.row_replacements:
            if f.owned:
                every = range(len(f.reaction))
                out[:, 1] += np.sum(steps.numbers(f.reaction, every) * steps.numbers(f.rate, every), axis=1)
        return out

    def reaction(self, name: str) -> float:
        """Return the reaction ``name`` [N or N m], the same on all ranks.

        0 if nothing of this name is prescribed.
        """
        value = 0.0
        for f in self.assembly.row_replacements:
            if f.owned and name in f.condition.names:
                value += float(f.reaction[f.condition.names.index(name)])
        value += sum(component.reaction(name, self.assembly) for component in self.components)
        return float(total(self.comm, value))

    def all_entries(self, local_entries: list) -> list:
        """Join the lists of all ranks in the order of the ranks, on every rank; collective."""
        if self._serial:
            return local_entries
        return [entry for part in self.comm.tompi4py().allgather(local_entries) for entry in part]

    def gather(self, values: FloatArray, on: str = "vertex") -> FloatArray | None:
        """Collect values of all ranks on rank 0 in depth order; None on other ranks.

        values: (nv, k) at local vertices, or (nc, k) at local cells with ``on="cell"``.
        """
        chain = self.chain
        if on == "vertex":
            numbers, values, size = chain.vertices[chain.owned], values[chain.owned], chain.size
        else:
            numbers, size = chain.cells, chain.size - 1
        if self._serial:
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
        """Return the (nv, size) values of a field at local vertices.

        what: ``x``, ``y`` or ``a``.  A node without the field gets the field's default, or 0 for rates.
        """
        dofs = self.layout.dofs[name]
        values = getattr(self.assembly, what)[np.maximum(dofs, 0)]
        default = next(f.default for f in self.layout.fields if f.name == name) if what == "x" else 0.0
        return np.where(dofs >= 0, values, default)

    def set_field(self, name: str, values: FloatArray, what: str = "x") -> None:
        """Set a field's local values from (n_nodes, size) values over the whole string.

        ``what`` as in ``field``.
        """
        dofs = self.layout.dofs[name]
        present = dofs >= 0
        getattr(self.assembly, what)[dofs[present]] = values[self.chain.vertices][present]
