"""Jacobian entries of the contacts alone, recomputed while all others stay (manual: sec-time-contact-entries)."""

from __future__ import annotations

import ctypes

import numpy as np

from drillpetsc.fem.bound_parts import BoundBlock, fill_prescribed
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import structure

_renew = function("renew_contact_entries", "pipipi", ctypes.c_int)
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
        self._before = [np.empty(b.span.stop - b.span.start) for b in self._blocks]
        #: rows that prescribed motion replaces in these blocks; rows in other blocks are the same as long as it has not turned
        self._replaced = [f.elements_in(self._blocks) for f in asm.row_replacements]
        #: of each block: first node of an element or of any after it
        self._first = []
        for b in self._blocks:
            node = np.where(b.local >= 0, layout.vertex_of[np.maximum(b.local, 0)], self.nodes).min(axis=1)
            first = np.minimum.accumulate(node[::-1])[::-1]
            self._first.append(np.ascontiguousarray(first, dtype=np.int32))

    def replaced_record(self) -> ctypes.Array:
        """Rows that prescribed motion replaces in the blocks of contacts, for the compiled iteration."""
        calls = (_PrescribedMatrix * len(self._replaced))()
        for call, f, elements in zip(calls, self._asm.row_replacements, self._replaced, strict=True):
            fill_prescribed(call, f, elements)
        return calls

    def record(self, blocks: list[BoundBlock], flags_before: np.ndarray | None = None) -> ctypes.Array:
        """The blocks for the compiled iteration.

        blocks: of the assembly; flags_before: bytes of all contact flags at the factorisation, one after the other;
        None: elements without contact are computed as well.
        """
        calls = (_ContactCall * len(self._blocks))()
        starts = np.cumsum([0, *(flags.values.nbytes for flags in self._flags)])
        for call, b, first, before in zip(calls, self._blocks, self._first, self._before, strict=True):
            call.block = next(k for k, other in enumerate(blocks) if other is b)
            call.first, call.before = pointer(first), pointer(before)
            for flags, start in zip(self._flags, starts[:-1].tolist(), strict=True):
                if flags_before is not None and flags.context and flags.context == b.block.context:
                    call.touching, call.touched = pointer(flags.values), pointer(flags_before) + start
                    call.points = len(flags.values) // b.count
        return calls

    def update(self, t: float, c: tuple[float, float, float]) -> int:
        """Compute the contacts' entries of ``Assembly.jacobian(t, c, condensed=True)``, the others stay.

        Returns the first of this rank's nodes along the chain that has a changed entry, ``nodes`` where there is none.
        """
        asm = self._asm
        for b in self._blocks:
            if b.block.update:
                b.update_parameters(t)
        asm.weigh_next(c)
        calls, replaced = self.record(asm.calls.blocks), self.replaced_record()
        asm.calls.step.sigma = c[1]
        first: int = _renew(
            asm.calls.jacobian_at,
            len(calls),
            ctypes.addressof(calls),
            len(replaced),
            ctypes.addressof(replaced),
            self.nodes,
        )
        asm.version += 1
        return first
