"""Jacobian entries of the contacts alone, computed anew while all others stay (manual: sec-time-contact-entries)."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.discrete_system import DiscreteSystem


class ContactEntries:
    """Entries of the components with contact in the Jacobian of a system on one rank.

    ``nodes``: number of nodes of the chain.
    """

    def __init__(self, system: DiscreteSystem):
        asm, layout = system.assembly, system.layout
        self._asm, self.nodes = asm, len(layout.chain.vertices)
        pairs = zip(asm.bound_blocks, system.component_of, strict=True)
        self._blocks = [b for b, c in pairs if b.count and c.has_contact]
        self._components = [c for c in system.components if c.has_contact]
        self._values = [asm.values[b.span] for b in self._blocks]
        self._before = [np.empty(len(values)) for values in self._values]
        self._changed = [np.empty(len(values), dtype=bool) for values in self._values]
        #: rows that prescribed motion replaces in these blocks; those in other blocks stay with their entries
        self._replaced = [f.elements_in(self._blocks) for f in asm.row_replacements]
        #: of each block: first node of an element or of any after it
        self._first = []
        for b in self._blocks:
            node = np.where(b.local >= 0, layout.vertex_of[np.maximum(b.local, 0)], self.nodes).min(axis=1)
            self._first.append(np.minimum.accumulate(node[::-1])[::-1])

    @property
    def possible(self) -> bool:
        """Whether contacts can be computed apart from all else, and there are any at the wall: a bit alone has another cause."""
        return bool(self._blocks) and any(c.touches_wall for c in self._components) and self._asm.plain

    def update(self, t: float, c: tuple[float, float, float]) -> int:
        """Compute the contacts' entries of ``Assembly.jacobian(t, c, condensed=True)``, the others stay.

        Returns the first node along the chain that has a changed entry, ``nodes`` where there is none.
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
