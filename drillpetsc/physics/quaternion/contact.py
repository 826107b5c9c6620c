"""Contact of the quaternion string with the wall (kernels/quaternion/quaternion_contact.cpp)."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.component import ElementBlock
from drillpetsc.kernels.parameters import Parameters
from drillpetsc.physics.contact import Contact
from drillpetsc.physics.quaternion.beam import SLOTS


class QuaternionContact(Contact):
    """The wall contact of ``Contact``, on the unknowns of the quaternion element."""

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        m = self.mesh
        self._part, self._touching, self._normal, self._row_of = part, [], [], None
        self._blocks = []
        for name, mask, ends in self._groups():
            chosen = np.flatnonzero((mask & (m.contact_diameter > 0))[part.cells]).astype(np.int32)
            e = part.cells[chosen]
            friction = np.where(np.isnan(m.friction[e]), -1.0, m.friction[e])
            params = Parameters(
                "quaternion_contact",
                len(e),
                length=m.length[e],
                rigid=0.0,
                radius=0.5 * m.contact_diameter[e],
                friction=friction,
            )
            self._blocks.append(
                ElementBlock(
                    f"contact{name}",
                    "quaternion_contact",
                    "cell",
                    chosen,
                    SLOTS,
                    (),
                    params.array,
                    context=self._context(len(chosen), ends),
                    component="contact",
                )
            )
        self._blocks += self._on_items(part)
        return tuple(self._blocks)
