"""The string as a source of quantities at its nodes and elements, with the values of this rank."""

from __future__ import annotations

import numpy as np

from drillpetsc.fem.component import FloatArray
from drillpetsc.fem.quantity import Quantity, Sample
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.measured.bending import EndForces, all_across_hole, end_forces
from drillpetsc.output.measured.flow_recorder import FlowRecorder
from drillpetsc.output.measured.in_hole import offsets
from drillpetsc.output.quantities.along_string import HOLE_RADIUS, STRING_FIELDS
from drillpetsc.physics.beam import RESULT_NAMES

_COLUMN = {name: i for i, name in enumerate(RESULT_NAMES)}
SLOPES = "string.tangent"  # unknowns, which a string of quaternions does not have
_AXIAL = [_COLUMN["axial_upper"], _COLUMN["axial_lower"]]


class StringFields:
    """Motion, forces and surroundings of the string.

    mud: with mud, which stretches and loads the pipe.
    """

    def __init__(self, model: DrillingModel, mud: FlowRecorder | None) -> None:
        self.model, self.mud, chain = model, mud, model.system.chain
        self._cells, self._vertices = chain.cells, chain.vertices
        self._is_tube = bool((model.mesh.outer_diameter > 0).all())

    def quantities(self) -> tuple[Quantity, ...]:
        if not self.model.beam.moves:
            string = tuple(q for q in STRING_FIELDS if q.name in ("md", "outer_radius"))
        else:
            absent = {
                "stress": not self._is_tube,
                "effective_tension": self.mud is None,
                "slope": SLOPES not in self.model.system.layout.dofs,
            }
            string = tuple(q for q in STRING_FIELDS if not absent.get(q.name, False))
        return string + ((HOLE_RADIUS,) if self.model.well is not None else ())

    # ------------------------------------------------------------------ nodes
    @property
    def node_depth(self) -> FloatArray:
        """(nv,) measured depth [m]."""
        return self.model.mesh.node_depth[self._vertices]

    @property
    def start(self) -> FloatArray:
        """(n_nodes, 3) of the whole string: position [m] along the hole's axis, unstrained."""
        return self.model.position

    def motion(self, sample: Sample) -> FloatArray:
        """(nv, 8) position [m], velocity [m/s], spin rate [rad/s] and spin angle [rad]."""
        return np.asarray(sample.once(self.model.beam.columns))

    def position(self, sample: Sample) -> FloatArray:
        """(nv, 3) position [m]; for a held string, the initial position."""
        return self.motion(sample)[:, :3]

    def slope(self, sample: Sample) -> FloatArray:
        """(nv, 3) derivative of the position by the length of the unstrained string [-]."""
        return np.asarray(sample.assembly.x[self.model.system.layout.dofs[SLOPES]])

    def offset(self, position: FloatArray, depth: FloatArray) -> FloatArray:
        """(k, 2) offset [m] of points (k, 3) from the hole's axis."""
        return offsets(self.model, position)

    def hole_radius(self, position: FloatArray) -> FloatArray:
        """(k, 1) radius [m] of the hole at points (k, 3)."""
        return np.asarray(self.model.given_well.project(position).radius)[:, None]

    # ------------------------------------------------------------------ elements
    @property
    def outer_radius(self) -> FloatArray:
        """(nc,) outer radius of the pipe [m]."""
        return 0.5 * self.model.mesh.outer_diameter[self._cells]

    def _element_results(self, state) -> FloatArray:
        """(nc, 9) results of the beam, with the mud's share of the wall's tension."""
        beam = self.model.beam
        results = beam.element_results(state)
        if self.mud is not None:
            results[:, _AXIAL] += self.mud.wall_tension()
        return results

    def results(self, sample: Sample, name: str) -> FloatArray:
        """(nc,) result ``name`` of the beam's elements."""
        return np.asarray(sample.once(self._element_results)[:, _COLUMN[name]])

    def axial_force(self, sample: Sample) -> FloatArray:
        """(nc, 2) tension [N] of the pipe's wall at the upper and the lower end."""
        return np.asarray(sample.once(self._element_results)[:, _AXIAL])

    def tension_and_pressure(self, sample: Sample) -> FloatArray:
        """(nc, 2, 2) at both ends: tension [N] of the wall, and the contribution of the pressures to it."""
        assert self.mud is not None
        return np.stack([self.axial_force(sample), self.mud.pressure_force()], axis=2)

    def _end_forces(self, time: float, state) -> EndForces:
        return end_forces(self.model, time)

    def end_forces(self, sample: Sample) -> EndForces:
        """Forces and bending moments at both ends of the elements."""
        return sample.once(self._end_forces, sample.time)

    def bending_moment(self, sample: Sample) -> FloatArray:
        """(nc, 2) bending moment [N m] at both ends."""
        return self.end_forces(sample).moment_size

    def shear_force(self, sample: Sample) -> FloatArray:
        """(nc, 2) force across the string [N] at both ends."""
        return self.end_forces(sample).shear_size

    def _across(self, sample: Sample, state) -> list[FloatArray]:
        forces = self.end_forces(sample)
        return all_across_hole(self.model, forces.towards_bend, forces.shear)

    def bending_components(self, sample: Sample) -> FloatArray:
        """(nc, 2, 2) bending moment [N m] that bends the string to the high side, and to the right, at both ends."""
        return sample.once(self._across, sample)[0]

    def shear_components(self, sample: Sample) -> FloatArray:
        """(nc, 2, 2) shear force [N] to the high side, and to the right, at both ends."""
        return sample.once(self._across, sample)[1]

    def stress(self, sample: Sample) -> FloatArray:
        """(nc, 2) largest normal stress [Pa] of the section from axial force and bending, at both ends."""
        od, bore = (d[self._cells] for d in (self.model.mesh.outer_diameter, self.model.mesh.inner_diameter))
        area, modulus = np.pi / 4 * (od**2 - bore**2), np.pi / 32 * (od**4 - bore**4) / od
        axial, moment = self.axial_force(sample), self.bending_moment(sample)
        return np.abs(axial) / area[:, None] + moment / modulus[:, None]
