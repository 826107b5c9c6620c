"""Parts of a discrete system bound to their unknowns on one rank: element blocks, prescribed motion, corrected rates.

Manual: sec-joints-prescribed (prescribed motion), eq-joint-ggl (corrected rates).
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

import numpy as np
from petsc4py import PETSc

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.component import ElementBlock, PrescribedMotion, VelocityStabilization
from drillpetsc.fem.dof_layout import DofLayout
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import structure

_run_results = function("run_results", "p")
_run_all_results = function("run_all_results", "ip")
_lean_at = function("lean_at", "pppppp")
_ResultCall = structure("result_call")  # ResultCall of kernels/core/rows.cpp

#: weight of a replaced row, position error [m or rad] to force [N or N m]; it has the order of a pipe's
#: stiffness, so that one norm serves all rows (manual: eq-prescribed-rows)
ROW_SCALE = 1.0e6
#: fields of the seven unknowns of a node: position, slope, spin angle
NODE_FIELDS = ("string.position", "string.tangent", "string.spin")


class BoundBlock:
    """An element block with its dof table and the prepared arguments of its kernel.

    index: (count, width) local dofs of each element; local: the same, -1 if an entry is left out.
    span: the block's entries in ``Assembly.values``, ``width**2`` an element.
    columns: the columns of each slot (field, end) in an element's unknowns.
    """

    def __init__(self, block: ElementBlock, layout: DofLayout, first_entry: int):
        self.block = block
        self.count = len(block.points)
        self.index = layout.index(block)
        self.width = layout.width(block)
        start, self.columns = 0, dict[tuple[str, int], slice]()
        for slot in block.slots:
            size = layout.dofs_of(slot[0]).shape[1]
            self.columns[slot] = slice(start, start + size)
            start += size
        self.spins = layout.spin_vertices(block)
        self.residual = function(f"{block.kernel}_residual", "ippppppp")
        self.residual_at = ctypes.cast(self.residual, ctypes.c_void_p).value
        self.jacobian = function(f"{block.kernel}_jacobian", "ipppppppppp")
        self.span = slice(first_entry, first_entry + self.count * self.width**2)
        self.event = PETSc.Log.Event(block.name)
        # addresses are taken once: the arrays are never reallocated, only their values change
        self.head = (self.count, pointer(self.index), pointer(block.params), block.context)
        self.matrix_head = (
            self.count,
            pointer(self.index),
            pointer(self.spins),
            pointer(block.params),
            block.context,
        )
        rows = np.where(self.index < layout.size, self.index, -1)
        self.holds_rates = False  # see ``Assembly.hold_rates``
        self.values_at = 0  # address of the block's entries, set by the assembly
        self.local = rows.astype(np.int32)
        self._numbers = (layout.chain.cells if block.on == "cell" else layout.chain.vertices)[block.points]

    def write_places(self, rows: np.ndarray, columns: np.ndarray) -> None:
        """Write the local dofs of the rows and of the columns of the block's entries, (count, width, width) each; -1 if an
        entry is left out."""
        rows[:], columns[:] = self.local[:, :, None], self.local[:, None, :]

    def update_parameters(self, t: float) -> None:
        """Evaluate time-dependent parameters at ``t`` [s].

        A note with component, elements and time is added to an exception.
        """
        update = self.block.update
        assert update is not None
        try:
            update(t)
        except Exception as error:
            self.note_place(error, t)
            raise

    def note_place(self, error: Exception, t: float) -> None:
        """Add component, elements and time [s] to an error of ``update_parameters``."""
        error.add_note(
            f"in component {self.block.component}, element {self._numbers.min()} to {self._numbers.max()} of the string, time {t:g} s"
        )


class BlockResults:
    """Results of the elements of a block, as its kernel computes them; the next evaluation overwrites them.

    table: (n, columns) of the elements; sums: (columns,) over the elements.
    """

    def __init__(
        self, kernel: str, columns: int, block: ElementBlock, index: IntArray, state: tuple[int, ...]
    ):
        """kernel: entry point of the results; index: (n, k) dofs of the elements; state: addresses of unknowns, rates, ..."""
        self.table, self.sums = np.zeros((len(index), columns)), np.zeros(columns)
        entry = function(kernel, "iippppp" + "p")
        self._call = _ResultCall(
            results=ctypes.cast(entry, ctypes.c_void_p).value,
            index=pointer(index),
            parameters=pointer(block.params),
            record=block.context,
            x=state[0],
            y=state[1],
            out=pointer(self.table),
            sums=pointer(self.sums),
            count=len(index),
            width=index.shape[1],
            columns=columns,
        )
        self.address = ctypes.addressof(self._call)

    def evaluate(self) -> None:
        """Compute the results at the present unknowns and rates."""
        _run_results(self.address)


class ResultGroup:
    """Results of several blocks, computed in one call.  members: the blocks, as the keys of a dictionary."""

    def __init__(self, members: dict[BlockResults, bool]):
        self.members = members
        self._calls = (ctypes.c_void_p * len(members))(*(one.address for one in members))

    def evaluate(self) -> None:
        """Compute the results at the present unknowns and rates."""
        _run_all_results(len(self._calls), self._calls)


class RowReplacement:
    """Row replacement at one vertex of this rank, owned or ghost (manual: eq-prescribed-rows).

    D: (m, 7) prescribed directions over the node's unknowns; complement: I - D^T D.  On a curved path both
    are from the last evaluation.
    rate_directions: (m, 7) prescribed directions over the node's rates; row_complement: (7, 7) what remains of the node's
    rows.  They are D and complement, except for a spin held at a free slope, for which they are set by ``lean_at``.
    rows: (7,) local dofs of the node.
    elements: (block, element, slots of the seven dofs in the element) of every element at the node.
    value [m, -, rad], rate [per second], reaction [N, N m]: (m,) each.
    """

    def __init__(
        self, condition: PrescribedMotion, layout: DofLayout, local: int, bound_blocks: list[BoundBlock]
    ):
        self.condition = condition
        self.D = np.array(condition.directions, order="C")
        parts = [layout.dofs[name][local] for name in NODE_FIELDS]
        self.rows = np.concatenate(parts).astype(np.int32)
        self.owned = bool(layout.chain.owned[local])
        self.complement = np.eye(7) - self.D.T @ self.D
        self.elements = []
        for item in bound_blocks:
            for e in np.flatnonzero((item.index == self.rows[0]).any(axis=1)):
                slots = [
                    int(np.flatnonzero(item.index[e] == row)[0]) for row in self.rows if row in item.index[e]
                ]
                if len(slots) not in (0, 7):
                    raise ValueError(
                        f"{item.block.name}: a prescribed vertex needs all of r, v, phi in the block"
                    )
                self.elements.append((item, int(e), np.array(slots)))
        self.projector = (self.D.T @ self.D).ravel()
        self.reaction, self.value, self.rate = (np.zeros(len(self.D)) for _ in range(3))
        self.time: float | None = None
        self._released: list[int] = []
        self.all_elements = self.elements_in(bound_blocks)
        self.complement = np.ascontiguousarray(self.complement)
        self.row_complement, self.rate_directions = self.complement.copy(), self.D.copy()
        #: (7, 7) ``row_complement`` of the last matrix, no numbers before the first
        self.applied = np.full((7, 7), np.nan)
        self.leans = condition.spin_reference is not None
        self.lean = np.zeros(3)  # c(v)
        #: the direction from which the spin counts, in the memory of its owner
        self._axis = np.zeros(3) if condition.spin_reference is None else condition.spin_reference
        self.axis_at = pointer(self._axis)
        #: addresses of c(v) and of what follows from it
        self.lean_head = (
            pointer(self.lean),
            pointer(self.row_complement),
            pointer(self.rate_directions) + 8 * 7 * (len(self.D) - 1),
        )
        self.head = (len(self.D), pointer(self.D), pointer(self.rows))
        self.rate_at, self.value_at, self.reaction_at = (
            pointer(self.rate),
            pointer(self.value),
            pointer(self.reaction),
        )
        self.owned_rows_at = 0  # address of owned_rows
        self.owned_rows: np.ndarray | None = None  # (7,) the rows' indices in the owned part of a vector

    def evaluate(self, t: float, x: FloatArray, y: FloatArray | None = None) -> None:
        """Set ``value`` and ``rate``, on a curved path also the directions, to those at ``t`` [s].

        They are evaluated once per time.  x: unknowns of the system; y: their rates, None if unknown.
        """
        if t == self.time or (self.condition.constant and self.time is not None):
            return
        if self.condition.along_path is None:
            self.value[:], self.rate[:] = self.condition.value(t), self.condition.rate(t)
        else:
            self.D[:], self.value[:], self.rate[:] = self.condition.along_path(
                t, x[self.rows], None if y is None else y[self.rows]
            )
        if self._released:
            self.D[self._released], self.value[self._released], self.rate[self._released] = 0.0, 0.0, 0.0
        if self._released or self.condition.along_path is not None:
            self._set_projector()
        self.time = t

    @property
    def turned(self) -> bool:
        """Whether the directions have changed since the last matrix."""
        return not np.array_equal(self.applied, self.row_complement)

    def elements_in(self, blocks: Sequence[BoundBlock]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Elements at the node that belong to ``blocks``, for ``fill_prescribed``.

        (k,) first entry of each in the matrix; (k,) its width; (k, 7) slots of the seven dofs in it.
        """
        chosen = [(item, e, slots) for item, e, slots in self.elements if any(item is b for b in blocks)]
        return (
            np.array([item.span.start + e * item.width**2 for item, e, _ in chosen], dtype=np.int64),
            np.array([item.width for item, _, _ in chosen], dtype=np.int32),
            np.ascontiguousarray([s for *_, s in chosen], dtype=np.int32).reshape(-1, 7),
        )

    def release(self, names: Sequence[str]) -> None:
        """Leave the rows of the reactions ``names`` to the equilibrium, and prescribe all others again."""
        self._released = [k for k, name in enumerate(self.condition.names) if name in names]
        self.D[:] = self.condition.directions
        self._set_projector()
        self.time = None

    def _set_projector(self) -> None:
        projector = self.D.T @ self.D
        self.projector[:] = projector.ravel()
        self.complement[:] = np.eye(7) - projector
        self.row_complement[:], self.rate_directions[:] = self.complement, self.D

    def lean_at(self, x: FloatArray) -> FloatArray:
        """Set the directions of a spin that is held at a free slope to the directions at ``x``; returns c(v) (3,).

        The spin rate is the rate of the angle plus c(v).w, so a torque on the angle acts on the spin and, times -c(v), on the
        slope (manual: eq-prescribed-lean).
        """
        _lean_at(self.head[2], self.axis_at, pointer(x), *self.lean_head)
        return self.lean


def block_call(call: Any, b: BoundBlock, state: tuple[int, ...]) -> None:
    """Fill the ``call`` of a block's residual; state: addresses of its unknowns, rates, accelerations and rows."""
    call.residual = b.residual_at
    call.count, call.index, call.parameters, call.record = b.head
    call.x, call.y, call.a, _ = state


def fill_prescribed(
    call: Any, f: RowReplacement, elements: tuple[np.ndarray, np.ndarray, np.ndarray]
) -> None:
    """Fill the ``call`` that replaces rows in the entries of ``elements`` (``RowReplacement.elements_in``)."""
    first, width, slots = elements
    call.count, call.keep = len(first), pointer(f.row_complement)
    call.at, call.width, call.slots = pointer(first), pointer(width), pointer(slots)


class BoundStabilization:
    """Correction of rates by multipliers in an assembly (Gear, Gupta and Leimkuhler 1985; manual: eq-joint-ggl).

    With x' = y - B mu, the velocity constraint G y = 0 is added to g(x) = 0.  The rates of the corrected
    unknowns are y = shift x + v0 + B mu (manual: eq-joint-corrected-rates).  The Jacobian columns by mu are
    the columns by the rates, times B.  The derivative of B by x is left out, since mu has the size of the
    time formula's error.

    rates: (k, 7) local dofs of the corrected nodes; multipliers: (k, 6) local dofs of mu.
    elements: (block, element, slots of the seven dofs in the element, number k of the node).
    rows, columns: local dofs of the entries that ``fill`` computes.
    """

    def __init__(
        self,
        stabilization: VelocityStabilization,
        layout: DofLayout,
        bound_blocks: list[BoundBlock],
        replacements: list[RowReplacement],
    ):
        self.stabilization, self._layout = stabilization, layout
        node_dofs = np.hstack([layout.dofs[name][stabilization.points] for name in NODE_FIELDS])
        self.rates = np.ascontiguousarray(node_dofs, dtype=np.int32).reshape(-1, 7)
        self.multipliers = layout.dofs[stabilization.field][stabilization.points]
        self.elements: list[tuple[BoundBlock, int, np.ndarray, int]] = []
        #: for each element: (slots of a prescribed node in the element, I - D^T D of its condition)
        self._prescribed: list[list[tuple[np.ndarray, np.ndarray]]] = []
        rows, columns = [np.zeros(0, dtype=np.int32)], [np.zeros(0, dtype=np.int32)]
        for k, dofs in enumerate(self.rates):
            for item in bound_blocks:
                # contact stores records by element; its damping at this one node is left out of the Jacobian
                if item.block.context:
                    continue
                for e in np.flatnonzero((item.index == dofs[0]).any(axis=1)):
                    slots = _slots(item.index[e], dofs)
                    self.elements.append((item, int(e), slots, k))
                    prescribed = [
                        (_slots(item.index[e], f.rows), f.complement)
                        for f in replacements
                        if f.rows[0] in item.index[e]
                    ]
                    self._prescribed.append(prescribed)
                    element_rows = np.where(item.index[e] < layout.size, item.index[e], -1)
                    rows.append(np.repeat(element_rows, 6))
                    columns.append(np.tile(self.multipliers[k], item.width))
        self.rows, self.columns = (
            np.concatenate(rows).astype(np.int32),
            np.concatenate(columns).astype(np.int32),
        )
        # a corrected rate does not change the spin rate
        self._no_spin_gradient = np.zeros((max(1, len(layout.chain.vertices)), 3))

    def apply(self, x: FloatArray, y: FloatArray, a: FloatArray, v1: FloatArray, sigma: float) -> None:
        """Correct the rates y and accelerations a of ``Assembly.condense`` in place (manual: eq-joint-corrected-rates).

        x: unknowns; v1: constant part of the accelerations; sigma: da/dy of the time formula [1/s].
        """
        B = self.stabilization.directions(self.rates, x)
        y[self.rates] += np.einsum("kij,kj->ki", B, x[self.multipliers])
        a[self.rates] = sigma * y[self.rates] + v1[self.rates]

    def fill(
        self, x: FloatArray, y: FloatArray, a: FloatArray, c: tuple[float, float, float], out: np.ndarray
    ) -> None:
        """Write the entries by the multipliers mu into ``out`` (len(rows),).

        x, y, a: unknowns, rates and accelerations; c: weights of dR/dx, dR/dy, dR/da; c2/c1 is da/dy [1/s].
        """
        B = self.stabilization.directions(self.rates, x)
        weights = np.array([0.0, 1.0, c[2] / c[1]]) if c[1] else np.zeros(3)
        position = 0
        for (item, e, slots, k), prescribed in zip(self.elements, self._prescribed, strict=True):
            K = np.zeros((item.width, item.width))
            item.jacobian(
                1,
                pointer(item.index[e]),
                pointer(item.spins[e]),
                pointer(item.block.params[e]),
                item.block.context,
                pointer(weights),
                pointer(self._no_spin_gradient),
                pointer(x),
                pointer(y),
                pointer(a),
                pointer(K),
            )
            entries = K[:, slots] @ B[k]
            for rows, complement in prescribed:
                entries[rows] = complement @ entries[rows]
            out[position : position + entries.size] = entries.ravel()
            position += entries.size


def _slots(index: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return the positions of the dofs ``rows`` in an element's dofs ``index`` (width,)."""
    return np.array([int(np.flatnonzero(index == row)[0]) for row in rows])
