"""Contact of the quaternion string with the wall (kernels/quaternion/quaternion_contact.cpp)."""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import ElementBlock
from drillpetsc.kernels import function, pointer
from drillpetsc.physics.contact import KINDS, REPORT, Contact
from drillpetsc.physics.contact import _report as item_report
from drillpetsc.physics.quaternion.beam import SLOTS

_report = function("quaternion_contact_report", "ipppppp")


class QuaternionContact(Contact):
    """The wall contact of ``Contact``, on the unknowns of the quaternion element."""

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        m = self.mesh
        self._part, self._touching, self._normal, self._row_of = part, [], [], None
        self._blocks = []
        for name, mask, ends in self._groups():
            chosen = np.flatnonzero((mask & (m.outer_diameter > 0))[part.cells]).astype(np.int32)
            e = part.cells[chosen]
            friction = np.where(np.isnan(m.friction[e]), -1.0, m.friction[e])
            params = np.ascontiguousarray(
                np.column_stack([m.length[e], np.zeros(len(e)), 0.5 * m.outer_diameter[e], friction])
            )
            self._blocks.append(
                ElementBlock(
                    f"contact{name}",
                    "quaternion_contact",
                    "cell",
                    chosen,
                    SLOTS,
                    (),
                    params,
                    context=self._context(len(chosen), ends),
                    component="contact",
                )
            )
        self._blocks += self._on_items(part)
        return tuple(self._blocks)

    def _figures(self, state) -> list[FloatArray]:
        tables = [np.zeros((len(b.points), len(REPORT))) for b in self._blocks]
        for b, out in zip(self._blocks, tables, strict=True):
            given = (
                pointer(state.index_of(b)),
                pointer(b.params),
                b.context,
                pointer(state.x),
                pointer(state.y),
                pointer(out),
            )
            if b.on == "cell":
                _report(len(out), *given)
            else:
                item_report(len(out), KINDS["body_contact"], *given)
        return tables
