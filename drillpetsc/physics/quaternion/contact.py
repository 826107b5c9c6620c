"""Contact of the quaternion string with the wall (kernels/quaternion/quaternion_contact.cpp)."""

from __future__ import annotations

from itertools import product

import numpy as np

from drillpetsc.fem.component import ElementBlock
from drillpetsc.kernels.parameters import Parameters
from drillpetsc.physics.beam import JUNCTION_SLOTS
from drillpetsc.physics.contact import Contact
from drillpetsc.physics.quaternion.beam import SLOTS


class QuaternionContact(Contact):
    """The wall contact of ``Contact``, on the unknowns of the quaternion element.

    The block below rigid items is taken from ``Contact``, and ``QuaternionBeam.translate`` rewrites it.
    """

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        m = self.mesh
        self._part, self._touching, self._normal, self._row_of = part, [], [], None
        self._blocks = []
        for below, (name, mask, ends) in product((False, True), self._groups()):
            on_rank = (m.below_junction == below) & (m.contact_diameter > 0) & ~m.is_joint & mask
            if not on_rank.any():
                continue
            chosen = np.flatnonzero(on_rank[part.cells]).astype(np.int32)
            e = part.cells[chosen]
            friction = np.where(np.isnan(m.friction[e]), -1.0, m.friction[e])
            params = Parameters(
                "contact_junction" if below else "quaternion_contact",
                len(e),
                length=m.length[e],
                rigid=m.rigid_above[e],
                radius=0.5 * m.contact_diameter[e],
                friction=friction,
                hardness=self.hardness[0][e],
            )
            self._blocks.append(
                ElementBlock(
                    f"contact_junction{name}" if below else f"contact{name}",
                    "contact_junction" if below else "quaternion_contact",
                    "cell",
                    chosen,
                    JUNCTION_SLOTS if below else SLOTS,
                    (0, 1) if below else (),
                    params.array,
                    context=self._context(len(chosen), ends),
                    component="contact",
                    update=self._update,
                )
            )
        self._blocks += self._on_items(part)
        return tuple(self._blocks)
