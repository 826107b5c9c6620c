"""Probes: motion of the string and contact force at given measured depths."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.quantity import Quantity
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output import quantities as declared
from drillpetsc.output.in_hole import offsets


@dataclass(frozen=True)
class _Probe:
    """cell: number of the element from the top; share: position in it, 0 at its upper end, 1 at its lower."""

    cell: int
    share: float


class Probes:
    """The case's probes.  depths: measured depths [m]."""

    def __init__(self, model: DrillingModel) -> None:
        self.model = model
        self.depths = tuple(model.case.output.probes) if model.beam is not None else ()
        self._probes = [self._locate(depth) for depth in self.depths]
        self._local = {int(c): i for i, c in enumerate(model.system.chain.cells)}

    def _locate(self, depth: float) -> _Probe:
        mesh = self.model.mesh
        cell = int(np.clip(np.searchsorted(mesh.lower, depth), 0, len(mesh.lower) - 1))
        if mesh.is_joint[cell]:  # in a rigid item above a joint
            return _Probe(cell - 1, 1.0) if cell else _Probe(1, 0.0)
        return _Probe(cell, float(np.clip((depth - mesh.upper[cell]) / mesh.length[cell], 0.0, 1.0)))

    def quantities(self) -> tuple[Quantity, ...]:
        touches = self.model.contact is not None
        return tuple(q for q in declared.PROBES if touches or not q.matches("contact_0"))

    def motion(self, state) -> FloatArray:
        """(probes, 4) position [m] and spin rate [rad/s]; zero where another rank has the element."""
        out = np.zeros((len(self._probes), 4))
        for k, probe in enumerate(self._probes):
            if probe.cell in self._local:
                out[k] = self._at(probe, state)
        return out

    def _at(self, probe: _Probe, state) -> FloatArray:
        """(4,) by the element's cubic shape functions, the spin rate linearly (manual: eq-beam-tube)."""
        model, mesh = self.model, self.model.mesh
        a, b = model.system.chain.ends[self._local[probe.cell]]
        assert model.beam is not None
        r, v, spins = map(list, zip(*(model.beam.section(state, i) for i in (a, b)), strict=True))
        ratio = state.layout.dofs.get("string.ratio")
        r[0] = r[0] + mesh.rigid_above[probe.cell] * v[0] / np.linalg.norm(v[0])
        if ratio is not None and ratio[a, 0] >= 0:
            v[0] = v[0] * state.x[ratio[a, 0]]
        s, L = probe.share, mesh.length[probe.cell]
        x = (
            (1 - 3 * s**2 + 2 * s**3) * r[0]
            + L * (s - 2 * s**2 + s**3) * v[0]
            + (3 * s**2 - 2 * s**3) * r[1]
            + L * (s**3 - s**2) * v[1]
        )
        return np.array([*x, (1 - s) * spins[0] + s * spins[1]])

    def contact_force(self) -> FloatArray:
        """(probes,) normal force [N] on the probes' elements at the last evaluation of the rows."""
        contact, cells = self.model.contact, self._local
        assert contact is not None
        return np.array(
            [contact.normal_force(cells[p.cell]) if p.cell in cells else 0.0 for p in self._probes]
        )

    def offset(self, position: FloatArray, depth: float) -> FloatArray:
        """(2,) offset [m] of a probe at ``position`` (3,) from the hole's axis."""
        return offsets(self.model, position[None, :])[0]
