"""Drilling fluid at the string's lower end: nozzles or open end, mud under the bit, reaction of the jet (kernels/bit_flow.hpp)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.field import Block, Energies, Field, FloatArray, Powers
from drillpetsc.kernels import function, pointer
from drillpetsc.rooms.bodies import VERTEX_SLOTS, Passive, local_vertices
from drillpetsc.rooms.flow import FLOW_SCALE, FluidConstants
from drillpetsc.time_function import TimeFunction

END_CORRECTION = 0.61  # of an open unflanged pipe, in radii: Levine and Schwinger, Phys. Rev. 73:383, 1948
_AMBIENT = 4  # column of the kernel
NOZZLE_LENGTH = 0.1  # length over which mud speeds up in a nozzle [m]


@dataclass(frozen=True)
class BitEnd:
    """Lower end of the string.

    bore: area of the last element's bore [m2] (0: no link); nozzle: flow area [m2] (0: an open end, without loss);
    discharge coefficient; check_valve; ambient [Pa] over time: pressure outside where there is no annulus; hole, open, outer: areas of
    the hole and of the last annulus and string [m2] (hole 0: no annulus); elasticity d(ln content)/dp of the chamber's walls [1/Pa]; volume
    [m3] of the chamber with the bit on bottom; face [m] below the last node; added mass ratio; metal [m3] of rigid items below the last
    node; end, axis (3,): lower end of the hole and its direction.
    """

    bore: float
    nozzle: float
    discharge_coefficient: float
    check_valve: bool
    ambient: TimeFunction
    hole: float
    open: float
    outer: float
    elasticity: float
    volume: float
    face: float
    added: float
    metal: float
    end: FloatArray
    axis: FloatArray


class BitFlow(Passive):
    """One link and one chamber at the last node: unknown q_b [m3/s] where the bore ends in a link."""

    name = "bit_flow"

    def __init__(self, node: int, end: BitEnd, fluid: FluidConstants, held_at: FloatArray | None = None):
        self.node, self.end, self.fluid, self.held_at = node, end, fluid, held_at
        self.has_link, self.has_annulus = end.bore > 0, end.hole > 0

    def fields(self) -> tuple[Field, ...]:
        return (Field("bit.flow", 1, region="bottom", scale=FLOW_SCALE, second_order=False),) if self.has_link else ()

    def _parameters(self) -> list[float]:
        e, f = self.end, self.fluid
        area = e.nozzle or e.bore
        length = NOZZLE_LENGTH if e.nozzle else END_CORRECTION * np.sqrt(e.bore / np.pi)
        loss = 1 / (2 * e.discharge_coefficient**2 * area**2) if e.nozzle else 0.0
        gap = 0.0 if self.held_at is None else float((e.end - self.held_at[-1]) @ e.axis) - e.face
        return [f.density * length / max(area, 1e-300), max(area, 1e-300), loss, float(e.check_valve), e.ambient.value(0.0), e.hole,
                e.volume, 1 / f.bulk_modulus + e.elasticity, e.face, e.added * e.outer, max(e.open, 1e-300), e.metal, gap, *e.end,
                *e.axis, *e.axis]

    def blocks(self, part) -> tuple[Block, ...]:
        _, vertices = local_vertices(part, np.array([self.node]))
        held = self.held_at is not None
        slots: tuple = () if held else VERTEX_SLOTS
        if self.has_link:
            slots += (("pipe.pressure", 0),)
        if self.has_annulus:
            slots += (("annulus.pressure", 0),) if held else (("annulus.pressure", 0), ("annulus.flow", 0))
        if self.has_link:
            slots += (("bit.flow", 0),)
        kernel = "bit_flow" + ("" if self.has_link and self.has_annulus else "_jet" if self.has_link else "_closed") + "_held" * held
        params = np.ascontiguousarray(np.tile(self._parameters(), (len(vertices), 1)))
        update = None if self.has_annulus else lambda t: self.renew(params, t)
        self._block = Block("bit_flow", kernel, "vertex", vertices, slots, (), params, context=self.fluid.address, update=update)
        self._block.keep = (self.fluid,)
        self._report = function(f"{kernel}_report", "ipppppp")
        return (self._block,)

    def renew(self, params: FloatArray, t: float) -> None:
        """Pressure outside at ``t`` into the block's parameters."""
        params[:, _AMBIENT] = self.end.ambient.value(t)

    def breaks(self) -> tuple[float, ...]:
        return () if self.has_annulus else self.end.ambient.breaks()

    def figures(self, state) -> FloatArray:
        """(6,) lost power [W], flow [m3/s], kinetic and stored energy [J], content [m3] and potential [J] of the chamber; this rank's."""
        out = np.zeros((1, 6))
        if len(self._block.points):
            self._report(1, pointer(state.index_of(self._block)), pointer(self._block.params), self._block.context, pointer(state.x),
                         pointer(state.y), pointer(out))
        return out[0]

    def energies(self, t: float, state) -> Energies:
        _, _, kinetic, stored, _, potential = self.figures(state)
        return Energies(float(kinetic), float(stored), float(potential))

    def powers(self, t: float, state) -> Powers:
        """Loss in the nozzles; without an annulus, what the jet takes away counts as work done outside."""
        lost, flow, *_ = self.figures(state)
        if not self.has_link:
            return Powers()
        e, mass = self.end, self.fluid.density * flow
        arriving = 0.5 * mass * (flow / e.bore) ** 2  # what the bore's flow brings; a nozzle's pressure loss makes the jet afresh
        if self.has_annulus:  # the jet comes to rest in the chamber, the annulus starts with a speed of its own
            return Powers(float(lost + arriving - 0.5 * mass * (flow / e.open) ** 2))
        jet = 0.5 * mass * (flow / (e.nozzle or e.bore)) ** 2
        return Powers(float(lost + arriving - jet), float(-flow * self.fluid.enthalpy(e.ambient.value(t)) - jet))
