"""Measurements at the top and at the lower end of the string, and of the hole that the bit drills."""

from __future__ import annotations

import numpy as np

from drillpetsc.case.blocks.ends import TopEnd as TopKeys
from drillpetsc.fem.component import Component, FloatArray
from drillpetsc.fem.quantity import OneStep, Quantity
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.model.hole import hole_depth
from drillpetsc.output.measured.in_hole import along_hole, measured_depth, measured_depths
from drillpetsc.output.quantities.history import HOLE, HOOK_LOAD_TOTAL, LOWER_END, TOP_END, TOP_TRAVEL
from drillpetsc.physics.interfaces import Drive
from drillpetsc.physics.top.hoist import Hoist, HoistLine
from drillpetsc.time_function import Constant


def moves(top: TopKeys) -> bool:
    """Whether the top can move along the hole: it is lowered, or a force is given instead of its motion."""
    lowering = top.lowering
    if top.hoist is not None and (top.hoist.line is not None or top.hoist.heave is not None):
        return True
    return top.force is not None or not (lowering is None or lowering == Constant(0.0))


def top_reactions(steps: OneStep, components: tuple[Component, ...], name: str) -> FloatArray:
    """(k,) reaction ``name`` at the top [N or N m], this rank's share, after each of k steps: of a replaced row, or of multipliers."""
    for row in steps.assembly.row_replacements:
        if row.owned and name in row.condition.names:
            return steps.numbers(row.reaction, row.condition.names.index(name))
    own = [c for c in components if type(c).reaction is not Component.reaction]
    if not own:
        return np.zeros(len(steps))
    return steps.computed(lambda at: sum(c.reaction(name, at.assembly) for c in own), 1, "reaction", name)[
        :, 0
    ]


class TopEnd:
    """Hook load and surface torque."""

    def __init__(self, model: DrillingModel) -> None:
        self.model, self.force = model, model.case.top.force
        rig = model.case.rig
        self._hoist, self._drive = model.part(Hoist), model.part(Drive)
        self.block = None if rig is None else rig.block_weight  # [N]
        self._vertex = model.system.chain.own(0)

    def quantities(self) -> tuple[Quantity, ...]:
        m = self.model
        exists = m.beam.moves and (m.top.prescribes or self.force is not None)
        if not exists:
            return ()
        total = () if self.block is None else (HOOK_LOAD_TOTAL,)
        travel = (TOP_TRAVEL,) if moves(m.case.top) else ()
        return (*TOP_END, *total, *travel)

    def positions(self, steps: OneStep) -> FloatArray:
        """(k, 3) position of the top [m] after each of k steps; zero if another rank has it."""
        if self._vertex is None:
            return np.zeros((len(steps), 3))
        return steps.unknowns(steps.assembly.layout.dofs["string.position"][self._vertex])

    def travel(self, point: FloatArray) -> float:
        """Distance [m] of the top at ``point`` (3,) along the hole, from its place in the string free of stress."""
        return along_hole(self.model, point) - along_hole(self.model, self.model.position[0])

    def hook_loads(self, steps: OneStep) -> FloatArray:
        """(k,) pull on the string [N] after each of k steps."""
        hoist = self._hoist
        if self.force is not None:
            return np.array([self.force.value(t) for t in steps.times]) * float(self._vertex is not None)
        if isinstance(hoist, HoistLine):
            return steps.computed(lambda at: hoist.hook_load(at.time, at.assembly), 1, "hook load")[:, 0]
        return -top_reactions(steps, self.model.components, "top.axial_reaction")

    def hook_load_totals(self, steps: OneStep) -> FloatArray:
        """(k,) pull on the string and weight of the block [N]."""
        return self.hook_loads(steps) + (self.block or 0.0) * float(self._vertex is not None)

    def surface_torques(self, steps: OneStep) -> FloatArray:
        """(k,) torque on the string [N m]: of a prescribed rotation, or of a rotary drive."""
        torque, drive = top_reactions(steps, self.model.components, "top.torque_reaction"), self._drive
        if drive is None:
            return torque
        return torque + steps.computed(lambda at: drive.torque(at.time, at.assembly), 1, "drive")[:, 0]


class LowerEnd:
    """Motion of the face of the string's lower end."""

    def __init__(self, model: DrillingModel) -> None:
        self.model, mesh = model, model.mesh
        self.face = mesh.total_length - mesh.node_depth[-1]  # below the last node [m]
        self.vertex = model.system.chain.own(mesh.nodes - 1)

    def quantities(self) -> tuple[Quantity, ...]:
        return LOWER_END if self.model.beam.moves else ()

    def motions(self, steps: OneStep) -> FloatArray:
        """(k, 4) position of the face [m] and spin rate [rad/s] after each of k steps; zero if another rank has the end."""
        beam, vertex = self.model.beam, self.vertex
        if vertex is None:
            return np.zeros((len(steps), 4))
        if beam.formulation == "ancf":
            place = steps.assembly.layout.dofs
            end, slope = (steps.unknowns(place[f"string.{name}"][vertex]) for name in ("position", "tangent"))
            spin = steps.rates(place["string.spin"][vertex])
        else:
            found = steps.computed(lambda at: np.hstack(beam.section(at.assembly, vertex)), 7, id(self))
            end, slope, spin = np.split(found, [3, 6], axis=1)
        length = np.sqrt(np.sum(slope * slope, axis=1))[:, None]
        return np.hstack([end + self.face * slope / length, spin])

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
        return tuple(q for q in HOLE if q.name != "rop" or self.model.drilling is not None)
