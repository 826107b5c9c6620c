"""Measurements at the top and at the lower end of the string, and of the hole that the bit drills."""

from __future__ import annotations

from math import sqrt

import numpy as np

from drillpetsc.case.blocks.ends import TopEnd as TopKeys
from drillpetsc.fem.component import Component, FloatArray
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.quantity import OneStep, Quantity, Sample
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.hole import hole_depth
from drillpetsc.output import quantities as declared
from drillpetsc.output.measured.in_hole import along_hole, measured_depth, measured_depths
from drillpetsc.physics.interfaces import Drive
from drillpetsc.physics.top.hoist import Hoist
from drillpetsc.time_function import Constant


def top_reaction(system: DiscreteSystem, name: str) -> float:
    """Reaction ``name`` at the top [N or N m], this rank's share: of a replaced row, or of a multiplier."""
    for row in system.assembly.row_replacements:
        if row.owned and name in row.condition.names:
            return float(row.reaction[row.condition.names.index(name)])
    return float(sum(component.reaction(name, system.assembly) for component in system.components))


def moves(top: TopKeys) -> bool:
    """Whether the top can move along the hole: it is lowered, or a force is given instead of its motion."""
    lowering = top.lowering
    if top.hoist is not None and (top.hoist.line is not None or top.hoist.heave is not None):
        return True
    return top.force is not None or not (lowering is None or lowering == Constant(0.0))


def top_reactions(steps: OneStep, components: tuple[Component, ...], name: str) -> FloatArray | None:
    """(k,) ``top_reaction`` after each of k recorded steps; None if it is found one by one only."""
    for row in steps.assembly.row_replacements:
        if row.owned and name in row.condition.names:
            return steps.numbers(row.reaction, row.condition.names.index(name))
    if any(type(c).reaction is not Component.reaction for c in components):
        return None
    return np.zeros(len(steps))


class TopEnd:
    """Hook load and surface torque."""

    def __init__(self, model: DrillingModel) -> None:
        self.model, self.force = model, model.case.top.force
        rig, chain = model.case.rig, model.system.chain
        self._hoist, self._drive = model.part(Hoist), model.part(Drive)
        self.block = None if rig is None else rig.block_weight  # [N]
        self._is_here = bool((chain.owned & (chain.vertices == 0)).any())

    def quantities(self) -> tuple[Quantity, ...]:
        m = self.model
        exists = m.beam.moves and (m.top.prescribes or self.force is not None)
        if not exists:
            return ()
        total = () if self.block is None else (declared.HOOK_LOAD_TOTAL,)
        travel = (declared.TOP_TRAVEL,) if moves(m.case.top) else ()
        return (*declared.TOP_END, *total, *travel)

    def positions(self, steps: OneStep) -> FloatArray:
        """(k, 3) position of the top [m] after each of k steps; zero if another rank has it."""
        if not self._is_here:
            return np.zeros((len(steps), 3))
        vertex = int(np.flatnonzero(self.model.system.chain.vertices == 0)[0])
        return steps.unknowns(steps.assembly.layout.dofs["string.position"][vertex])

    def travel(self, point: FloatArray) -> float:
        """Distance [m] of the top at ``point`` (3,) along the hole, from its place in the string free of stress."""
        return along_hole(self.model, point) - along_hole(self.model, self.model.position[0])

    def hook_load(self, sample: Sample) -> float:
        """Pull on the string [N]."""
        if self.force is not None:
            return self.force.value(sample.time) if self._is_here else 0.0
        pull = None if self._hoist is None else self._hoist.hook_load(sample.time, sample.assembly)
        if pull is not None:
            return pull
        return -top_reaction(sample.system, "top.axial_reaction")

    def hook_loads(self, steps: OneStep) -> FloatArray | None:
        """(k,) ``hook_load`` after each of k recorded steps; None if it is found one by one only."""
        if self.force is not None or self._hoist is not None:
            return None
        found = top_reactions(steps, self.model.components, "top.axial_reaction")
        return None if found is None else -found

    def surface_torques(self, steps: OneStep) -> FloatArray | None:
        """(k,) ``surface_torque`` after each of k recorded steps; None if it is found one by one only."""
        return (
            None
            if self._drive is not None
            else top_reactions(steps, self.model.components, "top.torque_reaction")
        )

    def hook_load_total(self, sample: Sample) -> float:
        """Pull on the string and weight of the block [N]."""
        return self.hook_load(sample) + (self.block or 0.0 if self._is_here else 0.0)

    def surface_torque(self, sample: Sample) -> float:
        """Torque on the string [N m]: of a prescribed rotation, or of a rotary drive."""
        torque = top_reaction(sample.system, "top.torque_reaction")
        drive = self._drive
        return torque if drive is None else torque + drive.torque(sample.time, sample.assembly)


class LowerEnd:
    """Motion of the face of the string's lower end."""

    def __init__(self, model: DrillingModel) -> None:
        self.model, mesh, chain = model, model.mesh, model.system.chain
        self.face = mesh.total_length - mesh.node_depth[-1]  # below the last node [m]
        local = np.flatnonzero(chain.owned & (chain.vertices == mesh.nodes - 1))
        self.vertex = int(local[0]) if len(local) else None

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.LOWER_END if self.model.beam.moves else ()

    def motion(self, state) -> FloatArray:
        """(4,) position of the face [m] and spin rate [rad/s]; zero if another rank has the end."""
        out = np.zeros(4)
        if self.vertex is not None:
            end, slope, out[3] = self.model.beam.section(state, self.vertex)
            out[:3] = end + self.face * slope / sqrt(slope.dot(slope))
        return out

    def motions(self, steps: OneStep) -> FloatArray | None:
        """(k, 4) ``motion`` after each of k recorded steps; None if it is found one by one only."""
        beam = self.model.beam
        if self.vertex is None:
            return np.zeros((len(steps), 4))
        if beam.formulation != "ancf":
            return None
        place = steps.assembly.layout.dofs
        end, slope = (
            steps.unknowns(place[f"string.{name}"][self.vertex]) for name in ("position", "tangent")
        )
        spin = steps.rates(place["string.spin"][self.vertex].item(0))
        length = np.sqrt(np.sum(slope * slope, axis=1))[:, None]
        return np.column_stack([end + self.face * slope / length, spin])

    def depth_of(self, point: FloatArray) -> float:
        """Measured depth [m] of ``point`` (3,)."""
        return measured_depth(self.model, point)

    def depths_of(self, points: FloatArray) -> FloatArray:
        """(k,) measured depths [m] of ``points`` (k, 3)."""
        return measured_depths(self.model, points)


class DrilledHole:
    """End of the hole, and the rate at which it moves."""

    def __init__(self, model: DrillingModel) -> None:
        self.model, self.bit = model, model.bit
        self.start = hole_depth(model.case) if self.bit is not None else 0.0

    def quantities(self) -> tuple[Quantity, ...]:
        if self.bit is None:
            return ()
        return tuple(q for q in declared.HOLE if q.name != "rop" or self.model.drilling is not None)
