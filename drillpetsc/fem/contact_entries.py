"""Jacobian entries of the contacts alone, computed anew while all others stay (manual: sec-time-contact-entries)."""

from __future__ import annotations

import ctypes

import numpy as np

from drillpetsc.fem.bound_parts import BoundBlock, fill_prescribed
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.kernels import pointer
from drillpetsc.kernels.parameters import structure

_ContactCall = structure("contact_call")  # ContactCall of kernels/newton/newton.cpp
_PrescribedMatrix = structure("prescribed_matrix")


class ContactEntries:
    """Entries of the components with contact in this rank's part of the Jacobian of a system.

    ``nodes``: number of this rank's nodes.
    """

    def __init__(self, system: DiscreteSystem):
        asm, layout = system.assembly, system.layout
        self._asm, self.nodes = asm, len(layout.chain.vertices)
        pairs = zip(asm.bound_blocks, system.component_of, strict=True)
        self._blocks = [b for b, c in pairs if b.count and c.has_contact]
        self._flags = system.contact_flags
        self._at_wall = [flags.values for flags in self._flags if flags.wall]
        self._values = [asm.values[b.span] for b in self._blocks]
        self._before = [np.empty(len(values)) for values in self._values]
        self._changed = [np.empty(len(values), dtype=bool) for values in self._values]
        #: rows that prescribed motion replaces in these blocks; those in other blocks are the same as long as it has not turned
        self._replaced = [f.elements_in(self._blocks) for f in asm.row_replacements]
        #: of each block: first node of an element or of any after it
        self._first = []
        for b in self._blocks:
            node = np.where(b.local >= 0, layout.vertex_of[np.maximum(b.local, 0)], self.nodes).min(axis=1)
            first = np.minimum.accumulate(node[::-1])[::-1]
            self._first.append(np.ascontiguousarray(first, dtype=np.int32))

    @property
    def at_wall(self) -> bool:
        """Whether any contact of this rank is at the wall: a bit alone has another cause of slow convergence."""
        return bool(self._blocks) and any(bool(touching.any()) for touching in self._at_wall)

    @property
    def hindered(self) -> bool:
        """Whether contacts of this rank cannot be computed apart from all else.

        So it is where a prescribed motion has turned, since its rows are in the entries of other elements, too.
        """
        return not self._asm.plain or any(f.turned for f in self._asm.row_replacements)

    def replaced_record(self) -> ctypes.Array:
        """Rows that prescribed motion replaces in the blocks of contacts, for the compiled iteration."""
        calls = (_PrescribedMatrix * len(self._replaced))()
        for call, f, elements in zip(calls, self._asm.row_replacements, self._replaced, strict=True):
            fill_prescribed(call, f, elements)
        return calls

    def record(self, blocks: list[BoundBlock], flags_before: np.ndarray) -> ctypes.Array:
        """The blocks for the compiled iteration.

        blocks: of the assembly; flags_before: bytes of all contact flags at the factorisation, one after the other.
        """
        calls = (_ContactCall * len(self._blocks))()
        starts = np.cumsum([0, *(flags.values.nbytes for flags in self._flags)])
        for call, b, first, before in zip(calls, self._blocks, self._first, self._before, strict=True):
            call.block = next(k for k, other in enumerate(blocks) if other is b)
            call.first, call.before = pointer(first), pointer(before)
            for flags, start in zip(self._flags, starts[:-1].tolist(), strict=True):
                if flags.context and flags.context == b.block.context:
                    call.touching, call.touched = pointer(flags.values), pointer(flags_before) + start
                    call.points = len(flags.values) // b.count
        return calls

    def update(self, t: float, c: tuple[float, float, float]) -> int:
        """Compute the contacts' entries of ``Assembly.jacobian(t, c, condensed=True)``, the others stay.

        Returns the first of this rank's nodes along the chain that has a changed entry, ``nodes`` where there is none.
        """
        asm = self._asm
        state = asm.weigh(c, True)
        for b, values, before in zip(self._blocks, self._values, self._before, strict=True):
            before[:] = values
            if b.block.update:
                b.update_parameters(t)
            b.jacobian(*b.matrix_head, *state, b.values_at)
        for replacement, elements in zip(asm.row_replacements, self._replaced, strict=True):
            replacement.replace_matrix_rows(asm.values, elements)
        asm.version += 1
        first = self.nodes
        for k, b in enumerate(self._blocks):
            changed = np.not_equal(self._values[k], self._before[k], out=self._changed[k])
            entry = int(changed.argmax())
            if changed[entry]:
                first = min(first, int(self._first[k][entry // b.width**2]))
        return first
