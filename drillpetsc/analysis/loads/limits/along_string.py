"""A static state at the ends of the elements, and what the hole and the pipe are there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.analysis.loads.limits import buckling_loads as buckling
from drillpetsc.analysis.statics.placement import top_depth
from drillpetsc.arrays import FloatArray
from drillpetsc.fem.quantity import Sample
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.measured.bending import curvatures
from drillpetsc.output.measured.flow_recorder import flow_recorder
from drillpetsc.output.measured.string_fields import StringFields

VERTICAL = np.radians(3.0)  # inclination below which a string buckles as in a vertical hole
LEAST_SIDE_LOAD = 1e-6  # of the weight per length, below which the wall does not hold a string
NOISE = 1e-11  # torque over axial force times radius, below which it is rounding


@dataclass(frozen=True)
class State:
    """A static state, (n, 2) at the upper and the lower end of each element; on rank 0.

    axial: tension of the pipe's wall [N]; effective: effective tension [N]; torque [N m], as the surface torque.
    moment: bending moment beyond the stress-free shape [N m]; dls: curvature of the string [1/m].
    side_force: of the wall per length [N/m], nan without contact.
    side_force_of_elements: (n,) its mean over each element.
    inside, outside: pressures [Pa], 0 where there is no mud.
    tangent: (nodes, 3) unit tangents of the nodes; nodes: (nodes, 3) their positions [m].
    """

    axial: FloatArray
    effective: FloatArray
    torque: FloatArray
    moment: FloatArray
    dls: FloatArray
    side_force: FloatArray
    side_force_of_elements: FloatArray
    inside: FloatArray
    outside: FloatArray
    nodes: FloatArray
    tangent: FloatArray


def static_state(model: DrillingModel) -> State | None:
    """The model's present state on rank 0, None elsewhere.  Collective."""
    system, mesh, sample = model.system, model.mesh, Sample(model.system, 0.0)
    mud = flow_recorder(model)
    string, local = StringFields(model, mud), system.chain.cells
    pushed = np.full(len(local), np.nan)
    if model.contact is not None:
        pushed = sample.once(model.contact.element_results)[0][:, 0] / mesh.length_divisor[local]
    total = np.linalg.norm(curvatures(model, string.end_forces(sample).moment), axis=2)
    columns = [
        string.axial_force(sample),
        string.bending_moment(sample),
        total,
        -string.results(sample, "torque"),
        pushed,
    ]
    nodal = [system.field("string.position"), system.field("string.tangent")]
    pressures = {} if mud is None else {name: mud.pressure(name) for name in mud.channels()}
    at_nodes = system.gather(np.column_stack([*nodal, *pressures.values()]))
    cell = system.gather(np.column_stack(columns), "cell")
    if at_nodes is None or cell is None:
        return None
    upper, lower = np.arange(mesh.nodes - 1), np.arange(1, mesh.nodes)
    ends = np.column_stack([upper, lower])
    both = {"bore": np.zeros(ends.shape), "annulus": np.zeros(ends.shape)}
    for name, values in zip(pressures, at_nodes[:, 6:].T, strict=True):
        both[name] = values[ends]
    effective = cell[:, :2].copy()
    if mud is not None:
        for name, _, area, sign in mud.pressed_areas():
            effective -= sign * both[name] * area[:, None]
    tangent = at_nodes[:, 3:6] / np.linalg.norm(at_nodes[:, 3:6], axis=1, keepdims=True)
    radius = 0.5 * float(mesh.outer_diameter.max())
    noise = NOISE * radius * float(np.abs(cell[:, :2]).max())
    torque = np.where(np.abs(cell[:, 6]) > noise, cell[:, 6], 0.0)
    return State(
        axial=cell[:, :2],
        effective=effective,
        torque=np.column_stack([torque, torque]),
        moment=cell[:, 2:4],
        dls=cell[:, 4:6],
        side_force=np.column_stack([cell[:, 7], cell[:, 7]]),
        side_force_of_elements=cell[:, 7],
        inside=both["bore"],
        outside=both["annulus"],
        nodes=at_nodes[:, :3],
        tangent=tangent,
    )


class Surroundings:
    """Hole and weight at the ends of the elements, for buckling loads under any effective tension.

    md: (n, 2) measured depths in the hole of the unstrained string [m]; tvd: (n, 2) vertical depths there [m].
    inclination: (n, 2) of the hole [rad]; clearance: (n, 2) radial, for buckling loads [m].
    weight: (n,) buoyed weight per length [N/m]; stiffness: (n,) EI [N m2].
    """

    def __init__(self, model: DrillingModel) -> None:
        mesh, well = model.mesh, model.well
        self.md = np.column_stack([mesh.upper, mesh.lower]) + top_depth(model)
        gravity = np.array(model.case.gravity, dtype=float)
        self.stiffness = mesh.bending_stiffness
        self.weight = model.effective_mass * float(np.linalg.norm(gravity))
        shape = self.md.shape
        self.tvd = self._vertical_depth(model)
        self.inclination, self.clearance = np.full(shape, np.nan), np.full(shape, np.nan)
        self._across, self._curvature = np.zeros((*shape, 3)), np.zeros((*shape, 3))
        if well is None:
            return
        inside = np.clip(self.md, 1e-6, None)
        # a radius or a curvature that jumps at an end of an element is taken from the element's side
        nudge = np.minimum(1e-3, 0.25 * (self.md[:, 1] - self.md[:, 0]))[:, None] * np.array([1.0, -1.0])
        _, tangent, self._curvature = (np.asarray(q) for q in well.at(inside + nudge))
        load = model.effective_mass[:, None, None] * gravity
        self._across = load - tangent * np.sum(load * tangent, axis=2, keepdims=True)
        if gravity.any():
            along = tangent @ gravity / float(np.linalg.norm(gravity))
            self.inclination = np.arccos(np.clip(along, -1.0, 1.0))
        if model.contact is not None:
            self.clearance = np.asarray(well.radius(inside + nudge)) - 0.5 * mesh.clearance_diameter[:, None]

    def _vertical_depth(self, model: DrillingModel) -> FloatArray:
        """(n, 2) [m]: along gravity from the top of the hole, or of the string without a hole; nan without gravity."""
        gravity = np.array(model.case.gravity, dtype=float)
        size = float(np.linalg.norm(gravity))
        if not size:
            return np.full(self.md.shape, np.nan)
        return np.asarray(model.axis.at(self.md)[0]) @ gravity / size

    def loads(self, tension: FloatArray, law: buckling.Helical) -> tuple[FloatArray, FloatArray]:
        """(n, 2) sinusoidal and helical buckling load [N] under an effective tension (n, 2) [N].

        Dawson-Paslay and `law` where the hole is inclined, Lubinski's loads below 3 deg; nan where nothing holds the
        string: no hole, no clearance, no weight and no curvature.
        """
        side = np.linalg.norm(self._across + tension[..., None] * self._curvature, axis=2)
        stiffness, weight = self.stiffness[:, None], self.weight[:, None]
        inside = (self.clearance > 0) & (stiffness > 0)
        held = inside & (side > LEAST_SIDE_LOAD * np.abs(weight)) & (side > 0)
        gap = np.where(held, self.clearance, 1.0)
        sinusoidal = np.where(held, buckling.dawson_paslay(stiffness, side, gap), np.nan)
        helical = np.where(held, buckling.helical(stiffness, side, gap, law), np.nan)
        vertical = inside & (self.inclination < VERTICAL)
        first, second = buckling.lubinski(stiffness, np.where(weight > 0, weight, np.nan))
        return np.where(vertical, first, sinusoidal), np.where(vertical, second, helical)
