"""Nozzles above the bit, of reamers and stabilisers: branches of the flow from the bore to the annulus.

Kernel: kernels/fluid/side_nozzle.hpp.  Manual: sec-mud-side-nozzles.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock, Field, Powers
from drillpetsc.fem.quantity import OneStep
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.kernels.parameters import Parameters, columns
from drillpetsc.physics.fluid.bit_flow import NOZZLE_LENGTH
from drillpetsc.physics.fluid.bore_flow import BoreFlow
from drillpetsc.physics.fluid.channel_flow import ChannelFlow, ambient_update
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices
from drillpetsc.time_function import TimeFunction

RESULTS = columns("side_nozzle_results")
_LOST, _FLOW, _KINETIC, _JET = (RESULTS[name] for name in ("lost", "flow", "kinetic", "jet"))


@dataclass(frozen=True)
class SideLink:
    """All nozzles at one node.

    node: number from the top; area: of all its nozzles [m2]; items: (number of the string item, area [m2]) of each.
    """

    node: int
    area: float
    items: tuple[tuple[int, float], ...]


class SideNozzles(Component):
    """One link a node with nozzles: unknown flow rate out of the string at zero pressure [m3/s].

    links: from the top down; discharge_coefficient: [-] (manual: eq-mud-side-nozzle).
    bore, annulus: the channels; without an annulus the nozzles discharge to the pressure ``ambient`` over time [Pa].
    lower_end: (area of the bit's nozzles or of the open end [m2], discharge coefficient [-]), area 0: closed; for the start of
    the steady flow.
    """

    name = "side_nozzles"

    def __init__(
        self,
        mesh: StringMesh,
        links: tuple[SideLink, ...],
        discharge_coefficient: float,
        bore: BoreFlow,
        annulus: ChannelFlow | None,
        ambient: TimeFunction,
        lower_end: tuple[float, float],
    ):
        self.mesh, self.links, self.bore, self.annulus = mesh, links, bore, annulus
        self.coefficient, self.ambient, self.lower_end = discharge_coefficient, ambient, lower_end
        self.fluid, self.held_at = bore.fluid, bore.held_at

    def regions(self) -> dict[str, np.ndarray]:
        mask = np.zeros(self.mesh.nodes, dtype=bool)
        mask[[link.node for link in self.links]] = True
        return {"side_nozzles": mask}

    def fields(self) -> tuple[Field, ...]:
        return (
            Field(
                "side.flow",
                1,
                physics="fluid",
                region="side_nozzles",
                scale=self.fluid.usual_flow,
                second_order=False,
            ),
        )

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        chosen, vertices = local_vertices(part, np.array([link.node for link in self.links]))
        held, wet = self.held_at is not None, self.annulus is not None
        slots: tuple = () if held else VERTEX_SLOTS
        slots += (("bore.pressure", 0),) + ((("annulus.pressure", 0),) if wet else ())
        kernel = "side_nozzle" + "_jet" * (not wet) + "_held" * held
        area = np.array([self.links[k].area for k in chosen])
        params = Parameters(
            kernel,
            len(vertices),
            inertance=self.fluid.density * NOZZLE_LENGTH / area,
            nozzle=area,
            loss=1 / (2 * self.coefficient**2 * area**2),
            ambient=self.ambient.value(0.0),
        )
        self._part = part
        self._chosen: tuple[int, ...] = tuple(int(k) for k in chosen)
        self._block = ElementBlock(
            "side_nozzles",
            kernel,
            "vertex",
            vertices,
            (*slots, ("side.flow", 0)),
            (),
            params.array,
            context=self.fluid.address,
            constants=self.fluid.constants,
            update=None if wet else ambient_update(params, self.ambient),
        )
        self._block.keep = (self.fluid,)
        self._beside = self._cells_beside()
        return (self._block,)

    def _cells_beside(self) -> tuple[np.ndarray, np.ndarray]:
        """Local cells that end, and that begin, at a node with nozzles."""
        nodes = np.array([link.node for link in self.links])
        above, below = (np.flatnonzero(np.isin(self._part.cells + end, nodes)) for end in (1, 0))
        return above, below

    def breaks(self) -> tuple[float, ...]:
        return () if self.annulus is not None else self.ambient.breaks()

    def shares_of_pump(self) -> FloatArray:
        """(links,) shares of the pump's flow by areas alone [-], with which the steady flow starts."""
        areas = np.array([link.area * self.coefficient for link in self.links])
        return areas / (areas.sum() + self.lower_end[0] * self.lower_end[1])

    # ------------------------------------------------------------------ results
    def element_results(self, state) -> FloatArray:
        """(k, 4) of the local links: the columns of ``physics.fluid.side_nozzles.RESULTS``."""
        return np.asarray(state.results(self._block, self._block.results_kernel, RESULTS.width).table)

    def _sums_of(self, steps) -> FloatArray:
        return np.asarray(steps.sums(self._block, self._block.results_kernel, RESULTS.width))

    def outflow(self, state) -> float:
        """Flow rate out of the string through the local links [m3/s]."""
        return float(self.outflow_of(OneStep(state, 0.0))[0])

    def outflow_of(self, steps) -> FloatArray:
        """(k,) ``outflow`` after each of k steps."""
        return self._sums_of(steps)[:, _FLOW]

    def local_links(self) -> tuple[int, ...]:
        """Numbers of the links at nodes of this rank, in the order of ``element_results``."""
        return self._chosen

    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        return self._sums_of(steps)[:, _KINETIC], 0.0, 0.0

    def powers(self, t: float, state) -> Powers:
        """Losses in the nozzles and of the jets, which come to rest beside the string.

        The mud remaining in the bore, and the mud rising in the annulus, dissipate or gain the difference of the velocity heads
        (manual: eq-mud-side-power).
        """
        lost = supplied = 0.0
        for channel in (self.bore, self.annulus):
            if channel is not None:
                lost += channel.velocity_power(self._beside[0], self._beside[1], state)
        f, moving = self.fluid, self.held_at is None
        index = state.index_of(self._block)
        for row, result in enumerate(self.element_results(state)):
            flow = result[_FLOW]
            velocity = state.y[index[row, :3]] if moving else np.zeros(3)
            reaction = float(
                velocity @ velocity
            )  # power of the reaction on the string, transferred to the mud
            lost += result[_LOST] + 0.5 * f.density * flow * reaction
            if self.annulus is None:
                node = self.links[self._chosen[row]].node
                place = state.x[index[row, :3]] if moving else self.held_at[node]  # type: ignore[index]
                leaving = 0.5 * f.density * flow * (result[_JET] ** 2 + reaction)
                lost -= leaving
                head = f.density * float(f.gravity @ place)
                supplied -= flow * (float(f.enthalpy(self.ambient.value(t))) - head) + leaving
        return Powers(float(lost), float(supplied))
