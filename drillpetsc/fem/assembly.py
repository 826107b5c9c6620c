"""Residual and Jacobian of a scene: the only module that knows both PETSc's vectors and the kernels."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import ElementBlock, PrescribedMotion, VelocityStabilization
from drillpetsc.fem.dof_layout import DofLayout
from drillpetsc.kernels import function, pointer

_rates = function("condensed_rates", "ipdppippp" + "p")
_transport = function("spin_transport", "ippppp")
_fix_rates = function("constraint_rates", "ipppdppp")
_fix_rows = function("constraint_rows", "ippppp" + "dpp")
_fix_matrix = function("constraint_matrix", "ippppp")
_gradient = function("spin_gradient", "ippppddp")

#: weight of a replaced row, position error [m or rad] to force [N]: of the order of a pipe's stiffness, so
#: that one norm fits both
ROW_SCALE = 1.0e6
#: weight of rates that are given [1/s]: where nothing is stored, a pressure would have no pivot in the block
#: of its own node
LEVEL = 1.0e-4


class BoundBlock:
    """A block with its tables in place and its kernel's arguments prepared."""

    def __init__(self, block: ElementBlock, layout: DofLayout, where: int):
        self.block = block
        self.count = len(block.points)
        self.index = layout.index(block)
        self.width = layout.width(block)
        self.spins = layout.spin_vertices(block)
        self.residual = function(f"{block.kernel}_residual", "ippppppp")
        self.jacobian = function(f"{block.kernel}_jacobian", "ipppppppppp")
        self.span = slice(where, where + self.count * self.width**2)
        self.event = PETSc.Log.Event(block.name)
        # addresses once: the arrays stay where they are, only their values change
        self.head = (self.count, pointer(self.index), pointer(block.params), block.context)
        self.matrix_head = (
            self.count,
            pointer(self.index),
            pointer(self.spins),
            pointer(block.params),
            block.context,
        )
        rows = np.where(self.index < layout.size, self.index, -1)
        self.values_at = 0  # address of the block's entries, set by the assembly
        self.rows = np.repeat(rows, self.width, axis=1).ravel()
        self.columns = np.tile(rows, (1, self.width)).ravel()
        self._numbers = (layout.chain.cells if block.on == "cell" else layout.chain.vertices)[block.points]

    def renew(self, t: float) -> None:
        """Refresh what depends on time; an exception says where it comes from."""
        try:
            self.block.update(t)  # type: ignore[misc]
        except Exception as error:
            error.add_note(
                f"in component {self.block.component}, element {self._numbers.min()} to {self._numbers.max()} of the string, time {t:g} s"
            )
            raise


class RowReplacement:
    """Row replacement at one vertex held by this rank (owner or not)."""

    def __init__(self, condition: PrescribedMotion, layout: DofLayout, local: int, ready: list[BoundBlock]):
        self.condition = condition
        self.D = np.ascontiguousarray(condition.directions)
        parts = [layout.dofs[name][local] for name in ("string.position", "string.tangent", "string.spin")]
        self.rows = np.concatenate(parts).astype(np.int32)
        self.owned = bool(layout.chain.owned[local])
        self.keep = np.eye(7) - self.D.T @ self.D
        self.touching = []  # (block, element, where in the element's rows the vertex's seven stand)
        for item in ready:
            for e in np.flatnonzero((item.index == self.rows[0]).any(axis=1)):
                slots = [
                    int(np.flatnonzero(item.index[e] == row)[0]) for row in self.rows if row in item.index[e]
                ]
                if len(slots) not in (0, 7):
                    raise ValueError(
                        f"{item.block.name}: a prescribed vertex needs all of r, v, phi in the block"
                    )
                self.touching.append((item, int(e), np.array(slots)))
        self.square = (self.D.T @ self.D).ravel()
        self.reaction, self.value, self.rate = (np.zeros(len(self.D)) for _ in range(3))
        self.time: float | None = None
        self.at = np.array(
            [item.span.start + e * item.width**2 for item, e, _ in self.touching], dtype=np.int64
        )
        self.width = np.array([item.width for item, _, _ in self.touching], dtype=np.int32)
        self.slots = np.ascontiguousarray([s for *_, s in self.touching], dtype=np.int32).reshape(-1, 7)
        self.keep = np.ascontiguousarray(self.keep)
        self.head = (len(self.D), pointer(self.D), pointer(self.rows))
        self.rate_at, self.value_at, self.reaction_at = (
            pointer(self.rate),
            pointer(self.value),
            pointer(self.reaction),
        )
        self.places_at = 0
        self.places: np.ndarray | None = None  # of the rows in the owned part of a vector
        self.matrix_head = (
            len(self.at),
            pointer(self.keep),
            pointer(self.at),
            pointer(self.width),
            pointer(self.slots),
        )

    def look_up(self, t: float) -> None:
        """Value and rate at ``t``; kept, as all evaluations of a step ask for the same time."""
        if t != self.time:
            self.value[:], self.rate[:] = self.condition.value(t), self.condition.rate(t)
            self.time = t


RATES = ("string.position", "string.tangent", "string.spin")


class BoundStabilization:
    """Correction of rates by multipliers in an assembly (Gear, Gupta and Leimkuhler; manual: eq-joint-ggl).

    x' = y - B mu, and the constraint G y = 0 beside g(x) = 0: the rates of the corrected unknowns are
    y = shift x + v0 + B mu.  The entries by mu are those by the rates times B.  B's own change with x is left out
    of the Jacobian: mu is of the size of the time formula's error.

    touching: (block, element, where in its rows the seven rates of the vertex stand, which vertex); rows,
    columns: local numbers of the entries that ``fill`` gives.
    """

    def __init__(
        self,
        corrections: VelocityStabilization,
        layout: DofLayout,
        ready: list[BoundBlock],
        fixed: list[RowReplacement],
    ):
        self.corrections, self._layout = corrections, layout
        seven = np.hstack([layout.dofs[name][corrections.points] for name in RATES])
        self.rates = np.ascontiguousarray(seven, dtype=np.int32).reshape(-1, 7)
        self.by = layout.dofs[corrections.field][corrections.points]
        self.touching: list[tuple[BoundBlock, int, np.ndarray, int]] = []
        self._prescribed: list[
            list[tuple[np.ndarray, np.ndarray]]
        ] = []  # of each: rows of a prescribed vertex, what is kept of them
        rows, columns = [np.zeros(0, dtype=np.int32)], [np.zeros(0, dtype=np.int32)]
        for k, places in enumerate(self.rates):
            for item in ready:
                # contact keeps records by element; its damping at this one node is left out of the Jacobian
                if item.block.context:
                    continue
                for e in np.flatnonzero((item.index == places[0]).any(axis=1)):
                    slots = _slots(item.index[e], places)
                    self.touching.append((item, int(e), slots, k))
                    held = [
                        (_slots(item.index[e], f.rows), f.keep) for f in fixed if f.rows[0] in item.index[e]
                    ]
                    self._prescribed.append(held)
                    own = np.where(item.index[e] < layout.size, item.index[e], -1)
                    rows.append(np.repeat(own, 6))
                    columns.append(np.tile(self.by[k], item.width))
        self.rows, self.columns = (
            np.concatenate(rows).astype(np.int32),
            np.concatenate(columns).astype(np.int32),
        )
        self._flat = np.zeros((max(1, len(layout.chain.vertices)), 3))  # a corrected rate moves no spin rate

    def apply(self, asm: Assembly, sigma: float) -> None:
        """Correct the rates and accelerations of ``condense``."""
        B = self.corrections.directions(self.rates, asm.x)
        asm.y[self.rates] += np.einsum("kij,kj->ki", B, asm.x[self.by])
        asm.a[self.rates] = sigma * asm.y[self.rates] + asm.v1[self.rates]

    def fill(self, asm: Assembly, c: tuple[float, float, float], out: np.ndarray) -> None:
        """Entries by the corrections at the weights ``c`` of dR/dx, dR/dy, dR/da (c2/c1 is the shift)."""
        B = self.corrections.directions(self.rates, asm.x)
        weights = np.array([0.0, 1.0, c[2] / c[1]]) if c[1] else np.zeros(3)
        at = 0
        for (item, e, slots, k), held in zip(self.touching, self._prescribed, strict=True):
            K = np.zeros((item.width, item.width))
            item.jacobian(
                1,
                pointer(item.index[e]),
                pointer(item.spins[e]),
                pointer(item.block.params[e]),
                item.block.context,
                pointer(weights),
                pointer(self._flat),
                pointer(asm.x),
                pointer(asm.y),
                pointer(asm.a),
                pointer(K),
            )
            entries = K[:, slots] @ B[k]
            for rows, keep in held:
                entries[rows] = keep @ entries[rows]
            out[at : at + entries.size] = entries.ravel()
            at += entries.size


def _slots(index: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Where the unknowns ``rows`` stand among those of an element."""
    return np.array([int(np.flatnonzero(index == row)[0]) for row in rows])


class Assembly:
    """Evaluates the rows of all rooms on this rank.

    x, y, a: (n+1,) unknowns, rates, accelerations in condensed local numbering, the last place a stand-in for
    absent fields, behind it what follows from the unknowns (``derive`` fills it; DofLayout.derived); r: the
    residual; values: all Jacobian entries, in the order of ``rows`` and ``columns`` (local numbers, -1: left
    out).
    """

    def __init__(
        self,
        layout: DofLayout,
        blocks: tuple[ElementBlock, ...],
        prescribed: tuple[PrescribedMotion, ...],
        reference: FloatArray,
        corrections: tuple[VelocityStabilization, ...] = (),
    ):
        self.layout = layout
        n = layout.size
        self.x, self.y, self.a, self.r = (np.zeros(layout.array_length) for _ in range(4))
        self.derive: Callable[[Assembly], None] | None = None
        self._seen: dict[int, np.ndarray] = {}  # places of blocks that look at the view
        self.x[n] = 1.0  # an absent stretch ratio is one
        self.v0, self.v1 = np.zeros(n), np.zeros(n)
        where, self.bound_blocks = 0, []
        for block in blocks:
            self.bound_blocks.append(BoundBlock(block, layout, where))
            where = self.bound_blocks[-1].span.stop
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
        size = where + 49 * sum(f.owned for f in self.row_replacements)
        self.stabilized = [
            BoundStabilization(c, layout, self.bound_blocks, self.row_replacements) for c in corrections
        ]
        self._at_corrected = size  # their entries stand last
        self.values = np.zeros(size + sum(len(c.rows) for c in self.stabilized))
        rows, columns = [b.rows for b in self.bound_blocks], [b.columns for b in self.bound_blocks]
        for f in self.row_replacements:
            if f.owned:
                rows.append(np.repeat(f.rows, 7))
                columns.append(np.tile(f.rows, 7))
        rows += [c.rows for c in self.stabilized]
        columns += [c.columns for c in self.stabilized]
        empty = [np.zeros(0, dtype=np.int32)]
        self.rows = np.concatenate(rows + empty).astype(np.int32)
        self.columns = np.concatenate(columns + empty).astype(np.int32)
        self._event = {k: PETSc.Log.Event(k) for k in ("Residual", "Jacobian")}
        self._state = tuple(map(pointer, (self.x, self.y, self.a, self.r)))
        self._weights = np.zeros(3)
        self._weights_at, self._spin_at = pointer(self._weights), pointer(self.spin_gradient)
        self._values_at = pointer(self.values)
        for b in self.bound_blocks:
            b.values_at = pointer(self.values) + 8 * b.span.start
        self._nodes = (len(self.spin_at), pointer(self.spin_at), pointer(self.reference))
        self._history = pointer(self.v0), pointer(self.v1)
        self.version = 0  # counts new Jacobian values
        self.evaluations = 0  # of the rows
        self.dead_load: FloatArray | None = None  # (n,) constant forces at owned unknowns (imperfection)
        self._frozen: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None
        self._still: tuple[np.ndarray, FloatArray, dict[int, np.ndarray]] | None = None

    def freeze(self, mask: np.ndarray | None) -> None:
        """Keep the unknowns of ``mask`` (n,) where they are: their rows and columns are the unit matrix's;
        None lets all go."""
        if mask is None or not mask.any():
            self._frozen = None
            return
        by_row, by_column = (
            np.append(mask, False)[i] for i in (self.rows, self.columns)
        )  # -1 leads to the last place
        self._frozen = (
            np.flatnonzero(mask),
            np.flatnonzero(by_row | by_column),
            np.flatnonzero(by_row & (self.rows == self.columns)),
        )

    def take_rates_from(self, rates: FloatArray | None, mask: np.ndarray | None = None) -> None:
        """Without inertia: unknowns of ``mask`` (n,) move with ``rates`` (n+1,), looked up at every
        evaluation, and have no acceleration, whatever the time formula makes of them; the others keep their
        formula.  None ends it."""
        if rates is None or mask is None or not mask.any():
            self._still = None
            return
        by_column = np.append(mask, True)[self.columns]
        kept = {b.span.start: np.flatnonzero(~by_column[b.span]) for b in self.bound_blocks}
        self._still = np.flatnonzero(mask), rates, kept

    def settle_rates(self) -> None:
        """Put the rates of ``take_rates_from`` in the place of the formula's."""
        if self._still is not None:
            where, rates, _ = self._still
            self.y[where], self.a[where] = rates[where], 0.0

    # ------------------------------------------------------------------ state
    def condense(self, sigma: float) -> None:
        """Rates and accelerations of a step from ``x``: y = sigma x + v0, a = sigma y + v1, spin rates with
        their transport."""
        x, y, a, _ = self._state
        _rates(self.layout.size, x, sigma, *self._history, *self._nodes, y, a)
        for c in self.stabilized:
            c.apply(self, sigma)

    def impose_rates(self, t: float, sigma: float) -> None:
        """PrescribedMotion components move at the given rate exactly, not at the rate of the time formula."""
        _, y, a, _ = self._state
        for f in self.row_replacements:
            f.look_up(t)
            _fix_rates(*f.head, f.rate_at, sigma, self._history[1], y, a)

    def forget_inputs(self) -> None:
        """Look prescribed values up afresh: an anchor was moved while the time stood still."""
        for f in self.row_replacements:
            f.time = None

    def transport(self) -> FloatArray:
        """c(v).w at each local vertex: spin rate minus rate of the spin angle [rad/s]."""
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
        """Residual of all local elements in ``r`` (not yet summed over ranks)."""
        self._event["Residual"].begin()
        self.evaluations += 1
        self.r[:] = 0.0
        if self.dead_load is not None:
            self.r[: self.layout.size] -= self.dead_load
        state = self._state
        for b in self.bound_blocks:
            if b.count:
                b.event.begin()
                if b.block.update:
                    b.renew(t)
                b.residual(*b.head, *state)
                b.event.end()
        if self._frozen is not None:
            self.r[self._frozen[0]] = 0.0
        self._event["Residual"].end()
        return self.r

    def replace_rows(self, t: float, owned: FloatArray, owned_place: np.ndarray) -> None:
        """PrescribedMotion rows of the summed residual ``owned``; what stood there are the reactions.

        owned_place: (n,) position in ``owned`` of each local unknown.
        """
        for f in self.row_replacements:
            if f.owned:
                f.look_up(t)
                if f.places is None:
                    f.places = np.ascontiguousarray(owned_place[f.rows], dtype=np.int32)
                    f.places_at = pointer(f.places)
                _fix_rows(
                    *f.head, f.places_at, self._state[0], f.value_at, ROW_SCALE, pointer(owned), f.reaction_at
                )

    def jacobian(self, t: float, c: tuple[float, float, float], condensed: bool) -> None:
        """All entries c0 dR/dx + c1 dR/dy + c2 dR/da into ``values``; condensed: y moves with x as in
        ``condense``."""
        self._event["Jacobian"].begin()
        if condensed and len(self.spin_at):
            _gradient(*self._nodes, *self._state[:2], c[1], 1.0 / c[1] if c[1] else 0.0, self._spin_at)
        else:
            self.spin_gradient[:] = 0.0
        self._weights[:] = c
        state = (self._weights_at, self._spin_at, *self._state[:3])
        for b in self.bound_blocks:
            if b.count:
                b.event.begin()
                if b.block.update:
                    b.renew(t)
                if self._still is None or not condensed:
                    b.jacobian(*b.matrix_head, *state, b.values_at)
                else:
                    self._jacobian_without_rates(b, state)
                b.event.end()
        at = self._at_corrected
        for q in self.stabilized:
            q.fill(self, c, self.values[at : at + len(q.rows)])
            at += len(q.rows)
        self._replace_jacobian_rows(1.0 if c[0] else 0.0)
        if self._frozen is not None:
            self.values[self._frozen[1]], self.values[self._frozen[2]] = 0.0, 1.0
        self.version += 1
        self._event["Jacobian"].end()

    def _jacobian_without_rates(self, b: BoundBlock, state: tuple) -> None:
        """Entries of a block some or all of whose unknowns have given rates: their columns by the unknown
        alone."""
        assert self._still is not None
        keep = self._still[2][b.span.start]
        if len(keep):
            b.jacobian(*b.matrix_head, *state, b.values_at)
            with_rates = self.values[b.span][keep]
        weights = self._weights.copy()
        self._weights[1:] = LEVEL, 0.0
        b.jacobian(*b.matrix_head, *state, b.values_at)
        self._weights[:] = weights
        if len(keep):
            self.values[b.span][keep] = with_rates

    def _replace_jacobian_rows(self, by_position: float) -> None:
        for f in self.row_replacements:
            _fix_matrix(*f.matrix_head, self._values_at)
        start = self.bound_blocks[-1].span.stop if self.bound_blocks else 0
        for f in self.row_replacements:
            if f.owned:
                np.multiply(f.square, by_position * ROW_SCALE, out=self.values[start : start + 49])
                start += 49

    def index_of(self, block: ElementBlock) -> np.ndarray:
        """(n, d) places of a block's unknowns in x, y, a; of what it sees instead, as it is now, for a room
        of another element."""
        found = next((b.index for b in self.bound_blocks if b.block is block), None)
        if found is not None:
            return found
        if self.derive is not None:
            self.derive(self)
        if id(block) not in self._seen:
            self._seen[id(block)] = self.layout.index(block)
        return self._seen[id(block)]

    def where(self, name: str) -> np.ndarray:
        """(nv, size) places of a field in x and y, or of what is seen in its stead, as it is now."""
        if name not in self.layout.dofs and self.derive is not None:
            self.derive(self)
        return self.layout.dofs_of(name)

    def block_rows(self, ready: BoundBlock, t: float) -> FloatArray:
        """(n, d) rows of each element of one block at x, y, a."""
        if ready.block.update:
            ready.block.update(t)
        rows = np.zeros((ready.count, ready.width))
        apart = np.arange(rows.size, dtype=np.int32)  # every element on unknowns of its own
        state = [np.ascontiguousarray(values[ready.index]) for values in (self.x, self.y, self.a)]
        ready.residual(ready.count, pointer(apart), *ready.head[2:], *map(pointer, state), pointer(rows))
        return rows

    def power(self, block: ElementBlock, t: float) -> float:
        """Power that the rows of ``block`` take from the motion at x, y [W], on this rank."""
        ready = next(b for b in self.bound_blocks if b.block is block)
        if not ready.count:
            return 0.0
        if block.update:
            block.update(t)
        rows = np.zeros_like(self.r)
        ready.residual(
            ready.count,
            pointer(ready.index),
            pointer(block.params),
            block.context,
            pointer(self.x),
            pointer(self.y),
            pointer(self.a),
            pointer(rows),
        )
        return float(rows[: self.layout.size] @ self.y[: self.layout.size])


def spin_derivatives(asm: Assembly) -> tuple[FloatArray, FloatArray]:
    """Of c(v).w at each local vertex: by v (k, 3) and by w (k, 3), the latter being c itself."""
    k = len(asm.spin_at)
    by_v, both = np.zeros((max(1, k), 3)), np.zeros((max(1, k), 3))
    arguments = (k, pointer(asm.spin_at), pointer(asm.reference), pointer(asm.x), pointer(asm.y))
    _gradient(*arguments, 0.0, 1.0, pointer(by_v))
    _gradient(*arguments, 1.0, 1.0, pointer(both))
    return by_v[:k], (both - by_v)[:k]
