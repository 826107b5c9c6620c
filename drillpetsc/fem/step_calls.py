"""Arguments of the compiled calls of a condensed step: its rows and its Jacobian entries (kernels/core/step.hpp)."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

import numpy as np

from drillpetsc.fem.bound_parts import ROW_SCALE, BoundBlock, RowReplacement
from drillpetsc.kernels import pointer
from drillpetsc.kernels.parameters import structure

if TYPE_CHECKING:
    from drillpetsc.fem.assembly import Assembly

_BlockCall, _PrescribedCall, _StepCall = map(structure, ("block_call", "prescribed_call", "step_call"))
_MatrixCall, _PrescribedMatrix = structure("matrix_call"), structure("prescribed_matrix")
_JacobianCall = structure("jacobian_call")


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


class StepCalls:
    """Arguments of the compiled calls of one assembly, as long as its blocks and their states are the same.

    step, jacobian: the records; step_at, jacobian_at: their addresses.
    blocks: those with elements on this rank, in the order of the records.
    """

    def __init__(self, asm: Assembly):
        self.blocks = [b for b in asm.bound_blocks if b.count]
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
        """Entries at prescribed motion; those of this rank's own nodes follow those of the blocks."""
        calls = (_PrescribedMatrix * len(asm.row_replacements))()
        at = pointer(asm.values) + 8 * asm.entries_of_blocks
        for call, f in zip(calls, asm.row_replacements, strict=True):
            fill_prescribed(call, f, f.all_elements)
            call.projector, call.applied = pointer(f.projector), pointer(f.applied)
            if f.owned:
                call.own, at = at, at + 8 * 49
        return calls
