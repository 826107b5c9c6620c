"""Drilling fluid between string and hole, from the bit to the flow line (kernels/annulus_flow.hpp)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from drillpetsc.channels import Annulus
from drillpetsc.field import Block, Energies, FloatArray, Powers
from drillpetsc.rooms.bodies import VERTEX_SLOTS, local_vertices
from drillpetsc.rooms.flow import FIGURES, Channel, FluidConstants
from drillpetsc.time_function import TimeFunction
from drillpetsc.tubulars import StringMesh
from drillpetsc.well import Well

_CHI, _CONTROLLED, _TANGENTS = 10, 16, slice(18, 27)  # columns of the kernel: added mass; given pressure; hole's tangents and curvature


@dataclass(frozen=True)
class Sideways:
    """What mud does to a string that moves across the hole: added mass over displaced mass (n,), damping (n,) [N s/m2], and torque
    per length and spin (n,) [N s].  by_eccentricity gives the added mass (k,) of the elements (k,) at eccentricities (k,) from 0 to 1."""

    added: FloatArray
    damping: FloatArray
    turning: FloatArray
    by_eccentricity: Callable[[FloatArray, np.ndarray], FloatArray] | None = None


class AnnulusFlow(Channel):
    """Flow in the annulus: pressure [Pa] at the nodes, flow rate at zero pressure [m3/s] in the elements, towards the bit.

    outlet: gauge pressure at the flow line over time, which lies ``flow_line`` [m] below the rotary table.  lowered: how far the string
    has been let down at a time [m] (None: it is not); hole sizes stay those at the start, directions follow.  choke: 1/(2 C_d^2 A^2) of a
    valve at the flow line [1/m4], 0 without one.
    """

    name = "annulus"
    spins = (0, 1)

    def __init__(self, mesh: StringMesh, annulus: Annulus, well: Well, fluid: FluidConstants, poisson: FloatArray, sideways: Sideways,
                 outlet: TimeFunction, flow_line: float = 0.0, lowered: Callable[[float], float] | None = None,
                 held_at: FloatArray | None = None, choke: float = 0.0):
        super().__init__(mesh, fluid, held_at is not None)
        self.choke = choke
        self.annulus, self.well, self.poisson, self.sideways, self.outlet = annulus, well, poisson, sideways, outlet
        self.flow_line, self.lowered, self.held_at = flow_line, lowered, held_at
        self._lowered_to = 0.0

    def _directions(self, e: np.ndarray, shift: float) -> FloatArray:
        m, well = self.mesh, self.well
        _, upper, _ = well.at(m.upper[e] + shift)
        _, lower, _ = well.at(m.lower[e] + shift)
        _, _, bend = well.at(0.5 * (m.upper[e] + m.lower[e]) + shift)
        return np.hstack([upper, lower, bend])

    def parameters(self, e: np.ndarray) -> FloatArray:
        m, a, s, zero = self.mesh, self.annulus, self.sideways, np.zeros(len(e))
        own, above = a.hole - a.outer, np.maximum(e - 1, 0)
        step = np.where(e > 0, 0.5 * (1 / own[e] ** 2 - 1 / own[above] ** 2), 0.0)
        length, drop, head = m.length[e], zero, zero
        if self.held_at is not None:
            length = length + m.rigid_above[e]
            drop = (self.held_at[e + 1] - self.held_at[e]) @ self.fluid.gravity
            head = 0.5 * (self.held_at[e + 1] + self.held_at[e]) @ self.fluid.gravity
        control = np.where(e == 0, 1.0, 0.0)
        return np.column_stack([
            length, m.rigid_above[e] if self.held_at is None else zero, self.poisson[e], a.outer[e], a.hole[e], a.outer_above[e], a.wall[e],
            a.outer_diameter[e], a.gap[e], a.gap_above[e], s.added[e], s.damping[e], s.turning[e], step, zero, control, zero, drop,
            self._directions(e, 0.0), head])

    def blocks(self, part) -> tuple[Block, ...]:
        elements = super().blocks(part)
        if self.choke:
            first = np.flatnonzero(part.cells == 0).astype(np.int32)
            slots = (("annulus.pressure", 0), ("annulus.flow", 1))
            valve = Block("choke", "choke", "cell", first, slots, (), np.full((len(first), 1), self.choke), context=self.fluid.address)
            valve.keep = (self.fluid,)
            elements = (*elements, valve)
        if self.held:
            return elements
        _, vertices = local_vertices(part, np.array([0]))
        area = np.full((len(vertices), 1), self.annulus.outer[0])
        return (*elements, Block("annulus_top", "annulus_top", "vertex", vertices, (*VERTEX_SLOTS, ("annulus.pressure", 0)), (), area))

    def _update_of(self, block: Block):
        has_top, part = self._top is not None and self._top[0] is block, self._part
        lowered = self.lowered
        if not has_top and lowered is None:
            return None
        head = -self.fluid.density * self.fluid.gravity[2] * self.flow_line
        if self.held_at is not None:
            head += self.fluid.density * float(self.fluid.gravity @ self.held_at[0])

        def update(t: float) -> None:
            if has_top:
                block.params[self._top[1], _CONTROLLED] = self.outlet.value(t) + head  # type: ignore[index]
            if lowered is not None and len(block.points):
                block.params[:, _TANGENTS] = self._directions(part.cells[block.points], lowered(t))

        return update

    def accept(self, state) -> None:
        """Renew the added mass for the string's place at an accepted state (where it depends on the place)."""
        chi, place = self.sideways.by_eccentricity, state.layout.place
        if chi is None:
            return
        line, m, a = self._part, self.mesh, self.annulus
        r, v = (state.x[place[f"string.{name}"]] for name in ("position", "tangent"))
        upper, lower, e = line.ends[:, 0], line.ends[:, 1], line.cells
        middle = 0.5 * (r[upper] + r[lower]) + 0.125 * m.length[e][:, None] * (v[upper] - v[lower])
        room = 0.5 * (a.hole_diameter[e] - a.outer_diameter[e])
        value = chi(np.linalg.norm(self.well.project(middle).offset, axis=1) / room, e)
        for b in self._blocks:
            b.params[:, _CHI] = value[b.points]

    def breaks(self) -> tuple[float, ...]:
        return self.outlet.breaks()

    def outflow(self, state) -> float | None:
        """Flow rate out of the flow line [m3/s]; None where this rank has not the upper end.

        What leaves the upper node, less what the hole takes up between it and the fixed flow line as the node moves down.
        """
        flow = self.upper_flow(state)
        if flow is None:
            return None
        speed = 0.0
        if not self.held:
            block, row = self._top  # type: ignore[misc]
            speed = float(state.y[state.index_of(block)[row, :3]] @ block.params[row, _TANGENTS][:3])
        return -flow - (self.annulus.hole[0] - self.annulus.outer[0]) * speed

    def content_above(self, state) -> float:
        """Volume between the upper node and the flow line [m3] (up to a constant); 0 where this rank has not the upper end."""
        if self._top is None or self.held:
            return 0.0
        block, row = self._top
        depth = float(state.x[state.index_of(block)[row, :3]] @ block.params[row, _TANGENTS][:3])
        return (self.annulus.hole[0] - self.annulus.outer[0]) * depth

    def energies(self, t: float, state) -> Energies:
        return Energies(*map(float, self.figures(state)[:, :3].sum(axis=0)))

    def powers(self, t: float, state) -> Powers:
        figures = self.figures(state)
        supplied, flow = 0.0, self.upper_flow(state)
        if flow is not None and self._top is not None:
            speed = figures[int(self._top[0].points[self._top[1]]), FIGURES.index("speed")]
            supplied = flow * (float(self.fluid.enthalpy(self.upper_pressure(state))) + 0.5 * self.fluid.density * speed**2)
        return Powers(float(figures[:, FIGURES.index("dissipated")].sum()), supplied)
