"""Contact forces of the rigid items: stabilizers, other bodies with an outer diameter, and the bit."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.quantity import Quantity, Sample
from drillpetsc.fem.step_record import StepRecord
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output import quantities as declared
from drillpetsc.physics.rock_bit import RESULTS as BIT_RESULTS


class RigidItems:
    """The rigid items of a string that can touch the wall; none without contact.

    names: of the items; depths: of their middles along the string [m].
    """

    def __init__(self, model: DrillingModel) -> None:
        self.model, mesh = model, model.mesh
        touches = model.contact is not None
        self.items = np.array([k for k, b in enumerate(mesh.bodies) if touches and b.radius > 0], dtype=int)
        bodies = [mesh.bodies[k] for k in self.items]
        self.names = tuple(b.name for b in bodies)
        bits = [k for k, b in enumerate(mesh.bodies) if b.kind == "bit"]
        self._bit = bits[-1] if bits else None
        self.depths = tuple(
            float(mesh.node_depth[b.node]) + b.contact_above + 0.5 * b.contact_length for b in bodies
        )

    def quantities(self) -> tuple[Quantity, ...]:
        """Columns of the history, where the case asks for them."""
        asked = self.model.case.output.item_forces and len(self.items) > 0
        return (declared.SIDE_FORCE,) if asked else ()

    def forces(self, sample: Sample) -> FloatArray:
        """(items,) normal force of the wall [N], zero where another rank has the item."""
        if self.model.contact is None:
            return np.zeros(0)
        out: FloatArray = self.model.contact.item_forces(sample.assembly).copy()
        bit = self.model.drilling
        if bit is not None and self._bit is not None:  # a bit that cuts has a contact of its own
            out[self._bit] += float(sample.once(bit.element_results)[BIT_RESULTS["side"]])
        return np.asarray(out[self.items])

    def forces_of(self, steps: StepRecord) -> FloatArray | None:
        """(k, items) ``forces`` after each of k recorded steps; None where they are found one by one only."""
        if self.model.contact is None:
            return np.zeros((len(steps), 0))
        if self.model.drilling is not None and self._bit is not None:
            return None
        return np.asarray(self.model.contact.item_forces_of(steps)[:, self.items])

    def at_nodes(self, forces: FloatArray) -> FloatArray:
        """(n_nodes,) sums of ``forces`` (items,) over the items that hang on each node [N]."""
        out = np.zeros(self.model.mesh.nodes)
        np.add.at(out, [self.model.mesh.bodies[k].node for k in self.items], forces)
        return out

    def listed(self, forces: FloatArray, top: float) -> list[dict[str, Any]]:
        """Name, measured depth in the hole and side force of every item, for summary.json.

        top: measured depth of the upper end of the unstrained string [m].
        """
        rows = zip(self.names, self.depths, forces, strict=True)
        return [
            {"name": name, "md [m]": top + depth, "side_force [N]": float(force)}
            for name, depth, force in rows
        ]
