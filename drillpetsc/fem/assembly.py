"""Residual and Jacobian of a discrete system on one rank: runs the kernels on the local arrays.

Manual: sec-time-condensed (condensed rates), sec-joints-prescribed (prescribed motion), eq-joint-ggl
(corrected rates), sec-time-imposed (imposed rates).
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence

import numpy as np
from petsc4py import PETSc

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.block_state import BlockState
from drillpetsc.fem.bound_parts import (
    ROW_SCALE,
    BoundBlock,
    BoundStabilization,
    RowReplacement,
    block_call,
    fill_prescribed,
)
from drillpetsc.fem.component import ElementBlock, PrescribedMotion, VelocityStabilization
from drillpetsc.fem.dof_layout import DofLayout
from drillpetsc.fem.end_exchange import EndExchange
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import structure

_rates = function("condensed_rates", "ipddppippp" + "p")
_transport = function("spin_transport", "ippppp")
_fix_rates = function("constraint_rates", "ipppdppp")
_fix_rows = function("constraint_rows", "ippppp" + "dpp")
_lean_rates, _lean_rows = function("lean_rates", "ppdppp"), function("lean_rows", "ppdp")
_gradient = function("spin_gradient", "ippppddp")
_run_residuals = function("run_residuals", "ipip")
_step_rows = function("step_rows", "ppp")
_step_state, _step_blocks = function("step_state", "pp"), function("step_blocks", "pp")
_step_prescribed = function("step_prescribed", "pp")
_prescribed_entries = function("prescribed_entries", "pd")

_BlockCall, _PrescribedCall, _StepCall = map(structure, ("block_call", "prescribed_call", "step_call"))
_MatrixCall, _PrescribedMatrix = structure("matrix_call"), structure("prescribed_matrix")
_JacobianCall = structure("jacobian_call")

#: weight of the columns by imposed rates [1/s]; without it the pressure of a closed channel would have no
#: pivot in the block of its own node (manual: sec-time-imposed)
IMPOSED_RATE_WEIGHT = 1.0e-4


class Assembly(BlockState):
    """Residual and Jacobian of all components on this rank, at the state of its base class.

    v0, v1: (n,) constants of the time formula, y = shift x + v0 and a = second shift y + v1.
    values: all Jacobian entries, in the order of ``places``.
    reference: (nv, 3) reference directions of the local nodes.
    """

    def __init__(
        self,
        layout: DofLayout,
        blocks: tuple[ElementBlock, ...],
        prescribed: tuple[PrescribedMotion, ...],
        reference: FloatArray,
        stabilizations: tuple[VelocityStabilization, ...] = (),
    ):
        super().__init__(layout, blocks)
        n, size = layout.size, self.bound_blocks[-1].span.stop if blocks else 0
        self.v0, self.v1 = np.zeros(n), np.zeros(n)
        spin = layout.dofs.get("string.spin")
        self.reference = np.ascontiguousarray(reference)
        self.spin_at = np.zeros((0, 2), dtype=np.int32)
        if spin is not None:
            self.spin_at = np.ascontiguousarray(
                np.column_stack([spin[:, 0], layout.dofs["string.tangent"][:, 0]]), dtype=np.int32
            )
        self.spin_gradient = np.zeros((max(1, len(self.spin_at)), 3))
        local = {int(v): i for i, v in enumerate(layout.chain.vertices)}
        self.row_replacements = [
            RowReplacement(c, layout, local[c.vertex], self.bound_blocks)
            for c in prescribed
            if c.vertex in local
        ]
        self.after_blocks = size
        size = size + 49 * sum(f.owned for f in self.row_replacements)
        self.stabilized = [
            BoundStabilization(c, layout, self.bound_blocks, self.row_replacements) for c in stabilizations
        ]
        self._first_stabilization_entry = size  # these entries are the last ones
        self.values = np.zeros(size + sum(len(c.rows) for c in self.stabilized))
        self._event = {k: PETSc.Log.Event(k) for k in ("Residual", "Jacobian")}
        self._weights = np.zeros(3)
        self._weights_at, self._spin_at = pointer(self._weights), pointer(self.spin_gradient)
        for b in self.bound_blocks:
            b.values_at = pointer(self.values) + 8 * b.span.start
        self._nodes = (len(self.spin_at), pointer(self.spin_at), pointer(self.reference))
        #: addresses of v0, v1
        self.history_at = pointer(self.v0), pointer(self.v1)
        self._calls: StepCalls | None = None  # see ``calls``
        self._holds_rates = False  # of any block, see ``hold_rates``
        #: evaluate rows block by block, each with its event, for -log_view; otherwise all blocks are one call
        self.block_by_block = PETSc.Options().hasName("log_view")
        self.version = 0  # counts new Jacobian values
        self.evaluations = 0  # counts residuals
        self.dead_load: FloatArray | None = None  # (n,) dead load [N, N m] at owned unknowns (imperfection)
        #: (fixed dofs, blocks with them and (count, width) where they are, of the other entries those in their rows or columns and
        #: those on the diagonal)
        self._frozen: (
            tuple[np.ndarray, list[tuple[BoundBlock, np.ndarray]], np.ndarray, np.ndarray] | None
        ) = None
        #: (dofs, rates, entries of each block by other dofs, by the block's first entry)
        self._imposed: tuple[np.ndarray, FloatArray, dict[int, np.ndarray]] | None = None

    def places(self) -> tuple[np.ndarray, np.ndarray]:
        """Local dofs of the rows and of the columns of all Jacobian entries, (len(values),) each, -1 if an entry is left out.

        They are recomputed: stored, they would take as much memory as the entries.
        """
        both = np.empty((2, len(self.values)), dtype=np.int32)
        for b in self.bound_blocks:
            b.write_places(*(out[b.span].reshape(b.count, b.width, b.width) for out in both))
        both[:, self.after_blocks :] = self._places_after_blocks()
        return both[0], both[1]

    def _places_after_blocks(self) -> np.ndarray:
        """(2, k) the same for the entries after the blocks' entries."""
        parts = [(np.repeat(f.rows, 7), np.tile(f.rows, 7)) for f in self.row_replacements if f.owned]
        parts += [(c.rows, c.columns) for c in self.stabilized]
        return np.hstack([np.zeros((2, 0), dtype=np.int32), *map(np.array, parts)])

    def hold_rates(self, mask: np.ndarray | None, rates: FloatArray | None = None) -> None:
        """Evaluate blocks that have an unknown of ``mask`` (n,) with given rates and zero accelerations; None: no block.

        For frozen mud beside a string on a path: its forces are the forces on the string at rest or in a steady motion.

        rates: (n+1,) [SI of each field per second]; None: zero.
        """
        self._held_rates = np.zeros((2, len(self.x))), np.zeros(3), np.zeros_like(self.spin_gradient)
        values, weights, spin = self._held_rates
        if rates is not None:
            values[0, : len(rates)] = rates
        for b in self.bound_blocks:
            b.holds_rates = mask is not None and bool(np.isin(b.index, np.flatnonzero(mask)).any())
        self._holds_rates = any(b.holds_rates for b in self.bound_blocks)
        self._calls = None
        x, _, _, r = self.state_at
        self.held_state = x, pointer(values[0]), pointer(values[1]), r
        self._held_head = pointer(weights), pointer(spin), *self.held_state[:3]

    def freeze(self, mask: np.ndarray | None) -> None:
        """Fix the unknowns of ``mask`` (n,) at their values; None releases all.

        Rows and columns of fixed unknowns become rows and columns of the unit matrix.
        """
        fixed = np.append(
            np.zeros(len(self.x), dtype=bool) if mask is None else mask, False
        )  # -1 selects the appended False
        for b in self.bound_blocks:
            if b.block.freezes is not None:
                b.block.freezes(fixed[b.local])
        if mask is None or not mask.any():
            self._frozen = None
            return
        blocks = [(b, held) for b in self.bound_blocks if (held := fixed[b.local]).any()]
        rows, columns = self._places_after_blocks()
        others = fixed[rows] | fixed[columns]
        diagonal = fixed[rows] & (rows == columns)
        start = self.after_blocks
        self._frozen = (
            np.flatnonzero(mask),
            blocks,
            start + np.flatnonzero(others),
            start + np.flatnonzero(diagonal),
        )

    def _fix_matrix_entries(self) -> None:
        """Replace the rows and columns of fixed unknowns by rows and columns of the unit matrix."""
        assert self._frozen is not None
        _, blocks, others, diagonal = self._frozen
        for b, held in blocks:
            entries = self.values[b.span].reshape(b.count, b.width, b.width)
            entries[held] = 0.0
            entries.transpose(0, 2, 1)[held] = 0.0
            np.einsum("eii->ei", entries)[held] = 1.0
        self.values[others], self.values[diagonal] = 0.0, 1.0

    def set_imposed_rates(self, rates: FloatArray | None, mask: np.ndarray | None = None) -> None:
        """Impose rates on unknowns without inertia or storage; None ends it (manual: sec-time-imposed).

        rates: (n+1,) [SI of each field per second]; the array is read again at every evaluation.
        mask: (n,) unknowns with imposed rates.  Their accelerations are zero; all others follow the time
        formula.
        """
        if rates is None or mask is None or not mask.any():
            self._imposed = None
            return
        imposed = np.append(mask, True)
        other = {}
        for b in self.bound_blocks:
            by_row = np.broadcast_to(~imposed[b.local][:, None, :], (b.count, b.width, b.width))
            other[b.span.start] = np.flatnonzero(by_row)
        self._imposed = np.flatnonzero(mask), rates, other

    @property
    def imposed(self) -> np.ndarray | None:
        """Unknowns (n,) with imposed rates, as a mask; None if there are none."""
        if self._imposed is None:
            return None
        mask = np.zeros(self.layout.size, dtype=bool)
        mask[self._imposed[0]] = True
        return mask

    def apply_imposed_rates(self) -> None:
        """Overwrite the integrator's rates by the imposed ones."""
        if self._imposed is not None:
            dofs, rates, _ = self._imposed
            self.y[dofs], self.a[dofs] = rates[dofs], 0.0

    # ------------------------------------------------------------------ state
    def condense(self, sigma: float, second: float | None = None) -> None:
        """Compute rates and accelerations of a step from ``x`` (manual: eq-time-condensed).

        y = sigma x + v0, then the transport of the spin rates, then a = second y + v1.

        sigma: shift of the time formula [1/s]; second: da/dy [1/s], ``sigma`` unless given.
        """
        second = sigma if second is None else second
        x, y, a, _ = self.state_at
        _rates(self.layout.size, x, sigma, second, *self.history_at, *self._nodes, y, a)
        for c in self.stabilized:
            c.apply(self.x, self.y, self.a, self.v1, second)

    def apply_prescribed_rates(self, t: float, sigma: float) -> None:
        """Set rates along prescribed directions to the given ones (manual: eq-prescribed-rates).

        t: time [s]; sigma: da/dy of the time formula [1/s].
        """
        _, y, a, _ = self.state_at
        for f in self.row_replacements:
            f.evaluate(t, self.x, self.y)
            _fix_rates(*f.head, f.rate_at, sigma, self.history_at[1], y, a)
            if f.leans:
                f.lean_at(self.x)
                _lean_rates(f.head[2], f.lean_head[0], sigma, self.history_at[1], y, a)

    def invalidate_prescribed_values(self) -> None:
        """Re-evaluate prescribed values at the next call, for example after an end was moved at constant time."""
        for f in self.row_replacements:
            f.time = None

    def release(self, names: Sequence[str]) -> None:
        """Leave the rows of the prescribed reactions ``names`` to the equilibrium, and prescribe all others again."""
        for f in self.row_replacements:
            f.release(names)

    def transport(self) -> FloatArray:
        """Compute c(v).w (nv,) [rad/s]: spin rate minus rate of the spin angle.

        Manual: eq-time-spin-transport.
        """
        out = np.zeros(len(self.spin_at))
        _transport(
            len(out),
            pointer(self.spin_at),
            pointer(self.reference),
            pointer(self.x),
            pointer(self.y),
            pointer(out),
        )
        return out

    # ------------------------------------------------------------------ rows
    def residual(self, t: float) -> FloatArray:
        """Compute the residual of all local elements at time ``t`` [s] into ``r``, not summed over ranks."""
        self._event["Residual"].begin()
        self.evaluations += 1
        if self.block_by_block:
            self._residual_by_block(t)
        else:
            for b in self.bound_blocks:
                if b.block.update and b.count:
                    b.update_parameters(t)
            calls = self.calls
            if self.dead_load is None:
                _run_residuals(calls.count, calls.calls, len(self.r), self.state_at[3])
            else:
                self._start_with_dead_load()
                _run_residuals(calls.count, calls.calls, 0, self.state_at[3])
        if self._frozen is not None:
            self.r[self._frozen[0]] = 0.0
        self._event["Residual"].end()
        return self.r

    @property
    def calls(self) -> StepCalls:
        """Arguments of the compiled calls."""
        if self._calls is None:
            self._calls = StepCalls(self)
        return self._calls

    @property
    def spins_at(self) -> tuple[int, int, int]:
        """Number of nodes with a spin angle, addresses of ``spin_at`` and ``reference``."""
        return self._nodes

    @property
    def weights_at(self) -> tuple[int, int]:
        """Addresses of the weights of the Jacobian's parts and of the derivatives of the spin rates."""
        return self._weights_at, self._spin_at

    def prepare_step(self, t: float, sigma: float, second: float) -> StepCalls | None:
        """Set the data that the compiled calls of a condensed step at time ``t`` [s] need.

        None if the step needs more than these calls do, or prescribed motion first needs the state.

        sigma, second: as for ``condense``.
        """
        if self.stabilized or self._imposed or self._frozen or self.block_by_block:
            return None
        for f in self.row_replacements:
            if f.time != t and f.condition.along_path is not None:
                return None
            f.evaluate(t, self.x)
        calls, b = self.calls, None
        try:
            for b, update in calls.updates:  # noqa: B007  (named by the note)
                update(t)
        except Exception as error:
            assert b is not None
            b.note_place(error, t)
            raise
        step = calls.step
        step.sigma, step.second = sigma, second
        step.dead = None if self.dead_load is None else pointer(self.dead_load)
        return calls

    def weigh_next(self, c: tuple[float, float, float]) -> None:
        """Set the weights of the next entries that a compiled call computes; c: as for ``jacobian``."""
        w = self._weights
        w[0], w[1], w[2] = c

    def step_rows(
        self,
        t: float,
        sigma: float,
        second: float,
        at: tuple[int, int],
        ends: EndExchange | None = None,
        rows: FloatArray | None = None,
    ) -> bool:
        """Compute the residual of a condensed step at time ``t`` [s] in one compiled call, on several ranks in three.

        The same as ``condense``, ``apply_prescribed_rates``, ``residual`` and ``replace_rows``.  False, and nothing is
        done, if the step needs more than these, or prescribed motion first needs the state.

        sigma, second: as for ``condense``.
        at: addresses of the owned unknowns (n,) and of the residual (n,).
        ends: exchange with other ranks, None on one rank; rows: the residual, with ``ends``.  One rank may use this call and
        another the separate calls, because their messages are the same.
        """
        calls = self.prepare_step(t, sigma, second)
        if calls is None:
            return False
        self._event["Residual"].begin()
        self.evaluations += 1
        address = calls.step_at
        if ends is None or rows is None:
            _step_rows(address, *at)
        else:
            _step_state(address, at[0])
            ends.spread(self.x)
            _step_blocks(address, at[1])
            ends.add(self.r, rows)
            _step_prescribed(address, at[1])
        self._event["Residual"].end()
        return True

    def _start_with_dead_load(self) -> None:
        self.r[:] = 0.0
        if self.dead_load is not None:
            self.r[: self.layout.size] -= self.dead_load

    def _residual_by_block(self, t: float) -> None:
        """The same block by block, each with its event."""
        self._start_with_dead_load()
        for b in self.bound_blocks:
            if b.count:
                b.event.begin()
                if b.block.update:
                    b.update_parameters(t)
                b.residual(*b.head, *(self.held_state if b.holds_rates else self.state_at))
                b.event.end()

    def partial_residual(self, t: float, chosen: Callable[[ElementBlock], bool]) -> FloatArray:
        """Compute the residual of the ``chosen`` blocks at time ``t`` [s] into ``r``, not summed over ranks."""
        self.r[:] = 0.0
        for b in self.bound_blocks:
            if b.count and chosen(b.block):
                if b.block.update:
                    b.update_parameters(t)
                b.residual(*b.head, *self.state_at)
        return self.r

    def replace_rows(self, t: float, owned: FloatArray, owned_index: np.ndarray) -> None:
        """Replace the rows along prescribed directions; store the reactions (manual: eq-prescribed-rows).

        t: time [s].
        owned: owned part of the residual, summed over ranks.
        owned_index: (n,) index in ``owned`` of each local dof.
        """
        for f in self.row_replacements:
            if f.owned:
                f.evaluate(t, self.x)
                if f.owned_rows is None:
                    f.owned_rows = np.ascontiguousarray(owned_index[f.rows], dtype=np.int32)
                    f.owned_rows_at = pointer(f.owned_rows)
                _fix_rows(
                    *f.head,
                    f.owned_rows_at,
                    self.state_at[0],
                    f.value_at,
                    ROW_SCALE,
                    pointer(owned),
                    f.reaction_at,
                )
                if f.leans:
                    f.lean_at(self.x)
                    _lean_rows(f.owned_rows_at, f.lean_head[0], f.reaction.item(-1), pointer(owned))

    def jacobian(self, t: float, c: tuple[float, float, float], condensed: bool) -> None:
        """Compute all entries c0 dR/dx + c1 dR/dy + c2 dR/da into ``values`` (manual: eq-time-jacobian).

        t: time [s].
        c: weights [-, 1/s, 1/s2].
        condensed: y depends on x as in ``condense``, spin terms included (manual: eq-time-spin-gradient).
        """
        self._event["Jacobian"].begin()
        state = self.weigh(c, condensed)
        for b in self.bound_blocks:
            if b.count:
                b.event.begin()
                if b.block.update:
                    b.update_parameters(t)
                if b.holds_rates:
                    self._held_rates[1][0] = c[0]
                    b.jacobian(*b.matrix_head, *self._held_head, b.values_at)
                elif self._imposed is None or not condensed:
                    b.jacobian(*b.matrix_head, *state, b.values_at)
                else:
                    self._jacobian_with_imposed_rates(b, state)
                b.event.end()
        start = self._first_stabilization_entry
        for q in self.stabilized:
            q.fill(self.x, self.y, self.a, c, self.values[start : start + len(q.rows)])
            start += len(q.rows)
        _prescribed_entries(self.calls.jacobian_at, 1.0 if c[0] else 0.0)  # 1 with dR/dx in the sum
        if self._frozen is not None:
            self._fix_matrix_entries()
        self.version += 1
        self._event["Jacobian"].end()

    def weigh(self, c: tuple[float, float, float], condensed: bool) -> tuple[int, ...]:
        """Set the weights of the next entries, as ``jacobian`` has them; returns the kernels' arguments of the state."""
        if condensed and len(self.spin_at):
            _gradient(*self._nodes, *self.state_at[:2], c[1], 1.0 / c[1] if c[1] else 0.0, self._spin_at)
        else:
            self.spin_gradient[:] = 0.0
        self._weights[:] = c
        return (self._weights_at, self._spin_at, *self.state_at[:3])

    @property
    def plain(self) -> bool:
        """Whether all entries come from the blocks and from prescribed motion: nothing is held, imposed or stabilised."""
        return not (self.stabilized or self._imposed or self._frozen or self._holds_rates)

    def _jacobian_with_imposed_rates(self, b: BoundBlock, state: tuple) -> None:
        """Compute the entries of a block some of whose unknowns have imposed rates.

        Manual: sec-time-imposed.

        Their columns are dR/dx plus ``IMPOSED_RATE_WEIGHT`` dR/dy.
        """
        assert self._imposed is not None
        other = self._imposed[2][b.span.start]
        if len(other):
            b.jacobian(*b.matrix_head, *state, b.values_at)
            with_rates = self.values[b.span][other]
        weights = self._weights.copy()
        self._weights[1:] = IMPOSED_RATE_WEIGHT, 0.0
        b.jacobian(*b.matrix_head, *state, b.values_at)
        self._weights[:] = weights
        if len(other):
            self.values[b.span][other] = with_rates


def spin_derivatives(asm: Assembly) -> tuple[FloatArray, FloatArray]:
    """Compute the derivatives of c(v).w at each local vertex: by v (k, 3) and by w (k, 3) (which is c).

    k: number of local vertices with a spin angle.  Manual: eq-time-spin-gradient.
    """
    k = len(asm.spin_at)
    by_v, both = np.zeros((max(1, k), 3)), np.zeros((max(1, k), 3))
    arguments = (k, pointer(asm.spin_at), pointer(asm.reference), pointer(asm.x), pointer(asm.y))
    _gradient(*arguments, 0.0, 1.0, pointer(by_v))
    _gradient(*arguments, 1.0, 1.0, pointer(both))
    return by_v[:k], (both - by_v)[:k]


class StepCalls:
    """Arguments of the compiled calls of one assembly (kernels/core/step.hpp), as long as its blocks and their states are the same.

    step, jacobian: the records; step_at, jacobian_at: their addresses.
    blocks: the blocks with elements on this rank, in the order of the records.
    updates: those with time-dependent parameters, and the function of time that sets these.
    """

    def __init__(self, asm: Assembly):
        self.blocks = [b for b in asm.bound_blocks if b.count]
        self.updates = [(b, b.block.update) for b in self.blocks if b.block.update]
        calls = (_BlockCall * len(self.blocks))()
        for call, b in zip(calls, self.blocks, strict=True):
            block_call(call, b, asm.held_state if b.holds_rates else asm.state_at)
        self.count, self.calls = len(self.blocks), calls
        layout = asm.layout
        owned = np.ascontiguousarray(layout.local_of_owned, dtype=np.int32)
        places = np.full(layout.size, -1, dtype=np.int32)
        places[owned] = np.arange(len(owned))
        replacements = asm.row_replacements
        rows = [np.ascontiguousarray(places[f.rows]) for f in replacements]
        prescribed = (_PrescribedCall * len(replacements))()
        for p, f, at in zip(prescribed, replacements, rows, strict=True):
            p.count, p.directions, p.rows = f.head
            p.rate, p.value, p.reaction = f.rate_at, f.value_at, f.reaction_at
            p.rate_directions = pointer(f.rate_directions)
            p.places = pointer(at) if f.owned else None
            if f.leans:
                p.axis, (p.lean, p.keep, p.direction) = f.axis_at, f.lean_head
        x, y, a, r = asm.state_at
        spins, where, reference = asm.spins_at
        v0, v1 = asm.history_at
        self.step = _StepCall(
            owned=pointer(owned), x=x, y=y, a=a, r=r, v0=v0, v1=v1, where=where, reference=reference,
            prescribed=ctypes.addressof(prescribed), blocks=ctypes.addressof(calls), scale=ROW_SCALE, n=len(owned),
            size=layout.size, length=len(asm.r), spins=spins, prescriptions=len(prescribed), count=len(calls),
        )  # fmt: skip
        self.step_at = ctypes.addressof(self.step)
        matrices = self._matrices()
        own = self._prescribed_matrices(asm)
        weights, spin = asm.weights_at
        self.jacobian = _JacobianCall(
            step=self.step_at, blocks=ctypes.addressof(matrices), prescribed=ctypes.addressof(own), values=pointer(asm.values),
            weights=weights, spin=spin, count=len(matrices),
        )  # fmt: skip
        self.jacobian_at = ctypes.addressof(self.jacobian)
        self._keep = owned, rows, prescribed, matrices, own

    def _matrices(self) -> ctypes.Array:
        """The Jacobian of each block with its arguments."""
        calls = (_MatrixCall * len(self.blocks))()
        for call, b in zip(calls, self.blocks, strict=True):
            call.jacobian = ctypes.cast(b.jacobian, ctypes.c_void_p).value
            call.count, call.index, call.nodes, call.parameters, call.record = b.matrix_head
            call.values, call.width = b.values_at, b.width
        return calls

    @staticmethod
    def _prescribed_matrices(asm: Assembly) -> ctypes.Array:
        """Entries at prescribed motion; the entries of this rank's nodes follow the blocks' entries."""
        calls = (_PrescribedMatrix * len(asm.row_replacements))()
        at = pointer(asm.values) + 8 * asm.after_blocks
        for call, f in zip(calls, asm.row_replacements, strict=True):
            fill_prescribed(call, f, f.all_elements)
            call.projector, call.applied = pointer(f.projector), pointer(f.applied)
            if f.owned:
                call.own, at = at, at + 8 * 49
        return calls
