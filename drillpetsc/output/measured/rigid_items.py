"""Forces of the wall on the rigid items: stabilizers, other bodies with an outer diameter, and the bit."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.quantity import OneStep, Quantity, Sample
from drillpetsc.geometry.frames import cross, high_sides
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.quantities.probes import SIDE_FORCES, WALL_NUMBERS
from drillpetsc.physics.bit.rock_bit import RESULTS as BIT_RESULTS
from drillpetsc.physics.contact import RESULTS

#: columns of the wall contact's results that make up the loads of an item: sum of normal forces, vectors
_LOADS = [RESULTS["normal"], *range(RESULTS.width)[RESULTS.span("push", "along")]]
#: keys of the resultants in summary.json
TITLES = (
    "side_force [N]",
    "side_high [N]",
    "side_right [N]",
    "side_couple [N m]",
    "contact_force_sum [N]",
    "couple_high [N m]",
    "couple_right [N m]",
)


class RigidItems:
    """The rigid items of a string that can touch the wall; none without contact.

    names: of the items; depths: of their middles along the string [m].

    The loads of an item are 13 numbers: sum of its normal forces [N]; vectors of the wall's forces without and with friction
    [N], of their couple about its middle [N m], and of the hole's tangent times the normal force [N].
    """

    def __init__(self, model: DrillingModel) -> None:
        self.model, mesh = model, model.mesh
        touches = model.contact is not None
        self.items = np.array([k for k, b in enumerate(mesh.bodies) if touches and b.radius > 0], dtype=int)
        bodies = [mesh.bodies[k] for k in self.items]
        self.names = tuple(b.name for b in bodies)
        bits = [k for k, b in enumerate(mesh.bodies) if b.kind == "bit"]
        self._bit = bits[-1] if bits else None
        self.depths = tuple(float(mesh.node_depth[b.node]) + b.middle for b in bodies)

    def quantities(self) -> tuple[Quantity, ...]:
        """Columns of the history, if the case requests them."""
        asked = self.model.case.output.item_forces and len(self.items) > 0
        return SIDE_FORCES if asked else ()

    def _of_drilling_bit(self, found: FloatArray, axis: FloatArray) -> FloatArray:
        """(k, columns) results of the side of a bit that cuts: from its own results (k, columns), in a hole of direction ``axis``
        (k, 3)."""
        assert self.model.drilling is not None and self._bit is not None
        side, out = self.model.drilling.side_contact, np.zeros((len(found), RESULTS.width))
        assert side is not None
        body = self.model.mesh.bodies[self._bit]
        arm = (side.below - body.contact_above - 0.5 * body.contact_length) * axis
        force, normal = found[:, BIT_RESULTS["force"]], found[:, BIT_RESULTS["side"]]
        out[:, RESULTS["normal"]] = normal
        out[:, RESULTS["push"]], out[:, RESULTS["force"]] = found[:, BIT_RESULTS["push"]], force
        out[:, RESULTS["couple"]] = found[:, BIT_RESULTS["couple"]] + cross(arm, force)
        if side.stiffness > 0:
            out[:, RESULTS["penetration"]] = normal / side.stiffness
        out[:, RESULTS["along"]] = normal[:, None] * axis
        return out

    def loads(self, sample: Sample) -> FloatArray:
        """(items, 13) loads of the wall, zero on ranks without the item."""
        return np.asarray(self.loads_of(sample)[0])

    def loads_of(self, steps: OneStep) -> FloatArray:
        """(k, items, 13) ``loads`` after each of k steps."""
        if not len(self.items):
            return np.zeros((len(steps), 0, WALL_NUMBERS))
        return np.asarray(self.wall_results(steps)[:, self.items[:, None], _LOADS])

    def wall_results(self, steps: OneStep) -> FloatArray:
        """(k, bodies, columns) results of the wall contact of each rigid item of the mesh, including a bit that cuts.

        Zero on ranks without the item.
        """
        results, bit = self.model.given_contact.item_results_of(steps), self.model.drilling
        if bit is not None and self._bit is not None:  # it has a separate contact
            found = bit.element_results_of(steps)
            results[:, self._bit] += self._of_drilling_bit(found, bit.direction_of(steps))
        return results

    def resultants(self, loads: FloatArray) -> FloatArray:
        """(7,) or (k, 7) ``resultants`` of ``loads`` (13,) or (k, 13)."""
        rows = np.atleast_2d(loads)
        return resultants(rows[:, 0], across_hole(rows)).reshape(*loads.shape[:-1], len(TITLES))

    def at_nodes(self, loads: FloatArray) -> FloatArray:
        """(n_nodes,) side force [N] of the items that hang on each node, from their ``loads`` (items, 13)."""
        sums = np.zeros((self.model.mesh.nodes, WALL_NUMBERS))
        np.add.at(sums, [self.model.mesh.bodies[k].node for k in self.items], loads)
        return self.resultants(sums)[:, 0]

    def listed(self, loads: FloatArray, top: float) -> list[dict[str, Any]]:
        """Entry of summary.json for every item: name, measured depth in the hole, resultants of its ``loads`` (items * 13,).

        top: measured depth of the upper end of the unstrained string [m].
        """
        found = self.resultants(np.reshape(loads, (len(self.items), WALL_NUMBERS)))
        out = []
        for k, name, depth, row in zip(self.items, self.names, self.depths, found.tolist(), strict=True):
            item = {"name": name, "md [m]": top + depth, **dict(zip(TITLES, row, strict=True))}
            if k == self._bit:
                item["bit_force_on_rock_high [N]"] = -item["side_high [N]"]
            out.append(item)
        return out


def loads_in(results: FloatArray) -> FloatArray:
    """(k, 13) loads in ``results`` (k, columns) of the wall contact."""
    return np.asarray(results[:, _LOADS])


def across_hole(loads: FloatArray) -> FloatArray:
    """(k, 3, 2) components to the high side and to the right of the vectors in ``loads`` (k, 13): forces without and with friction
    [N], couple [N m]."""
    along = loads[:, 10:13]
    size = np.linalg.norm(along, axis=1, keepdims=True)
    t = np.divide(along, size, out=np.tile([0.0, 0.0, 1.0], (len(loads), 1)), where=size > 0)
    high = high_sides(t)
    axes = np.stack([high, cross(t, high)], axis=1)
    return np.asarray(np.einsum("kvi,kai->kva", loads[:, 1:10].reshape(-1, 3, 3), axes))


def resultants(normal: FloatArray, parts: FloatArray) -> FloatArray:
    """(k, 7) what ``TITLES`` names (manual: eq-contact-resultant).

    normal: (k,) sums of the normal forces [N]; parts: (k, 3, 2) of ``across_hole``.
    """
    push, force, couple = (parts[:, i] for i in range(3))
    side, turn = np.linalg.norm(push, axis=1), np.linalg.norm(couple, axis=1)
    # a couple about the right side turns the lower end to the high side, one about the high side to the left
    return np.column_stack([side, force, turn, normal, couple[:, 1], -couple[:, 0]])
