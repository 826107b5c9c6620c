"""Probes: motion of the string and contact force at given measured depths."""

from __future__ import annotations

from typing import Any

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.quantity import OneStep, Quantity
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.measured.in_hole import offsets
from drillpetsc.output.quantities.probes import PROBES


def cubic_weights(s: Any, length: Any) -> tuple[Any, ...]:
    """Weights of upper position and slope, lower position and slope in the cubic of an element at the part ``s`` of its length [m]."""
    return (
        1 - 3 * s**2 + 2 * s**3,
        length * (s - 2 * s**2 + s**3),
        3 * s**2 - 2 * s**3,
        length * (s**3 - s**2),
    )


class Probes:
    """The case's probes.  depths: measured depths [m]."""

    def __init__(self, model: DrillingModel) -> None:
        self.model = model
        self.depths = tuple(model.case.output.probes) if model.beam.moves else ()
        self._places = [model.mesh.place_of(depth) for depth in self.depths]
        self._local = {int(c): i for i, c in enumerate(model.system.chain.cells)}
        here = [k for k, (cell, _) in enumerate(self._places) if cell in self._local]
        chosen = [self._places[k] for k in here]
        #: of the probes in elements of this rank: numbers, elements from the top, upper and lower vertices, shares
        self._here = np.array(here, dtype=int)
        self._cells = np.array([cell for cell, _ in chosen], dtype=int)
        ends = (
            model.system.chain.ends[[self._local[cell] for cell, _ in chosen]]
            if chosen
            else np.zeros((0, 2), int)
        )
        self._upper, self._lower = ends[:, 0], ends[:, 1]
        self._share = np.array([share for _, share in chosen])
        #: of upper position and slope, lower position and slope: the cubic shape functions at the probes
        self._weights = cubic_weights(self._share[:, None], model.mesh.length[self._cells][:, None])
        self._rigid = model.mesh.rigid_above[self._cells][:, None]
        self._below_item = bool(self._rigid.any())
        self._direct = self._direct_places()

    def _direct_places(self) -> tuple[FloatArray, FloatArray, FloatArray] | None:
        """Positions (4, k, 3) in the unknowns of positions and slopes at both ends, (2, k) of the spins, weights (4, k, 1), of the k probes
        of this rank; None if the motion between two nodes is not the cubic through them."""
        beam, dofs = self.model.beam, self.model.system.layout.dofs
        if beam.formulation != "ancf" or self._below_item or not len(self._here):
            return None
        ratio = dofs.get("string.ratio")
        if ratio is not None and ratio[self._upper].max() >= 0:
            return None
        ends = (
            ("position", self._upper),
            ("tangent", self._upper),
            ("position", self._lower),
            ("tangent", self._lower),
        )
        places = np.stack([dofs[f"string.{name}"][vertices] for name, vertices in ends])
        spins = np.stack([dofs["string.spin"][vertices, 0] for vertices in (self._upper, self._lower)])
        return places, spins, np.stack(self._weights)

    def quantities(self) -> tuple[Quantity, ...]:
        touches = self.model.contact is not None
        return tuple(q for q in PROBES if touches or not q.matches("contact_0"))

    def motions(self, steps: OneStep) -> FloatArray:
        """(k, probes, 4) position [m] and spin rate [rad/s] after each of k steps; zero on ranks without the element.

        By the element's cubic shape functions, the spin rate linearly (manual: eq-beam-tube).
        """
        out = np.zeros((len(steps), len(self._places), 4))
        if not len(self._here):
            return out
        if self._direct is None:
            found = steps.computed(lambda at: self._motion(at.assembly), 4 * len(self._here), id(self))
            out[:, self._here] = found.reshape(len(steps), -1, 4)
            return out
        places, spins, weights = self._direct
        at_ends = steps.unknowns(places).reshape(-1, *places.shape) * weights
        out[:, self._here, :3] = at_ends[:, 0] + at_ends[:, 1] + at_ends[:, 2] + at_ends[:, 3]
        spin0, spin1 = steps.rates(spins).reshape(-1, *spins.shape).transpose(1, 0, 2)
        out[:, self._here, 3] = (1 - self._share) * spin0 + self._share * spin1
        return out

    def _motion(self, state) -> FloatArray:
        """(4 n,) the same of the n probes in elements of this rank, where the motion is not the cubic through two nodes."""
        beam = self.model.beam
        r0, v0, spin0 = beam.section(state, self._upper)
        r1, v1, spin1 = beam.section(state, self._lower)
        if self._below_item:
            r0 = r0 + self._rigid * v0 / np.linalg.norm(v0, axis=1, keepdims=True)
        ratio = state.layout.dofs.get("string.ratio")
        if ratio is not None and (at := ratio[self._upper]).max() >= 0:
            v0 = v0 * np.where(at >= 0, state.x[np.maximum(at, 0)], 1.0)
        a, b, c, d = self._weights
        place = a * r0 + b * v0 + c * r1 + d * v1
        spin = (1 - self._share) * spin0 + self._share * spin1
        return np.column_stack([place, spin]).ravel()

    def contact_forces(self, steps: OneStep) -> FloatArray:
        """(k, probes) normal force [N] on the probes' elements, at the last evaluation of the rows of each of k steps."""
        contact, cells, out = self.model.given_contact, self._local, np.zeros((len(steps), len(self._places)))
        for k, (cell, _) in enumerate(self._places):
            if cell in cells:
                out[:, k] = contact.normal_force_of(cells[cell], steps)
        return out

    def offset(self, positions: FloatArray) -> FloatArray:
        """(probes, 2) offsets [m] of the probes at ``positions`` (probes, 3) from the hole's axis."""
        return offsets(self.model, positions)
