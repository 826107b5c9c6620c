"""Drilling fluid at the string's lower end: nozzles or open end, mud under the bit, reaction of the jet.

Kernel: kernels/fluid/bit_flow.hpp.  Manual: sec-mud-bit, sec-mud-force-ends.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock, Energies, Field, Powers
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.kernels import function, pointer
from drillpetsc.physics.fluid.channel_flow import FLOW_SCALE, FluidConstants
from drillpetsc.physics.fluid.moving_hole import OTHER_SIZE, MovingHole
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices
from drillpetsc.time_function import TimeFunction

END_CORRECTION = 0.61  # of an open unflanged pipe, in radii: Levine and Schwinger, Phys. Rev. 73:383, 1948
# columns of the kernel
_AMBIENT, _HOLE, _VOLUME, _FACE, _ADDED, _OPEN, _END, _AXIS, _TANGENT = (
    4,
    5,
    6,
    8,
    9,
    10,
    slice(13, 16),
    slice(16, 19),
    slice(19, 22),
)
GAP_ROUNDING = 1e-3  # as in kernels/fluid/bit_flow.hpp [m]
NOZZLE_LENGTH = 0.1  # length over which mud accelerates in a nozzle [m]


@dataclass(frozen=True)
class BitEnd:
    """Lower end of the string.

    bore: area of the last element's bore [m2], 0: no link.
    nozzle: flow area [m2], 0: an open end without loss.
    discharge_coefficient: [-] (manual: eq-mud-nozzle); check_valve: (manual: eq-mud-check-valve).
    ambient: pressure outside over time [Pa], without an annulus.
    hole, open, outer: areas of the hole, of the last annulus and of the last element [m2]; hole 0: no
    annulus.
    elasticity: compliance d(ln content)/dp of the chamber's walls [1/Pa].
    volume: of the chamber with the bit on bottom [m3] (manual: eq-mud-chamber).
    face: distance of the face below the last node [m]; on bottom the face is at ``end``.
    added: added mass over displaced mass [-].
    metal: volume of rigid items below the last node [m3].
    end: (3,) lower end of the hole [m]; axis: (3,) its direction.
    tangent: (3,) of the hole at the last node, by default the axis.
    cut: rock that becomes part of the mud per length drilled [m2] (manual: sec-mud-cuttings).
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
    tangent: FloatArray | None = None
    cut: float = 0.0


class BitFlow(Component):
    """One link and one chamber at the last node; unknown q_b [m3/s] where the bore ends in a link.

    node: the last one; end: data of the lower end; fluid: constants.
    held_at: (n+1, 3) positions of the nodes of a held string [m], None for a string that moves.
    moving_hole: the hole around a moving string, where size and direction depend on the position; None: they
    remain those at the start.
    hole: the growing hole, whose end moves by the fields hole.end (3,) [m] and hole.drilled [m] of the bit;
    None: the hole does not grow.
    """

    name = "bit_flow"

    def __init__(
        self,
        node: int,
        end: BitEnd,
        fluid: FluidConstants,
        held_at: FloatArray | None = None,
        moving_hole: MovingHole | None = None,
        hole: GrowingHole | None = None,
    ):
        self.node, self.end, self.fluid, self.held_at, self.moving_hole = (
            node,
            end,
            fluid,
            held_at,
            moving_hole,
        )
        self.has_link, self.has_annulus = end.bore > 0, end.hole > 0
        self.growing = hole if self.has_annulus and held_at is None else None
        self._depth: float | None = None  # measured depth of the node at the last evaluation of the hole [m]
        self._size = end.hole  # area of the hole to which the added mass belongs [m2]

    def fields(self) -> tuple[Field, ...]:
        return (
            (Field("bit.flow", 1, physics="fluid", region="bottom", scale=FLOW_SCALE, second_order=False),)
            if self.has_link
            else ()
        )

    def _parameters(self) -> list[float]:
        e, f = self.end, self.fluid
        area = e.nozzle or e.bore
        length = NOZZLE_LENGTH if e.nozzle else END_CORRECTION * np.sqrt(e.bore / np.pi)
        loss = 1 / (2 * e.discharge_coefficient**2 * area**2) if e.nozzle else 0.0
        gap = 0.0 if self.held_at is None else float((e.end - self.held_at[-1]) @ e.axis) - e.face
        return [
            f.density * length / max(area, 1e-300),
            max(area, 1e-300),
            loss,
            float(e.check_valve),
            e.ambient.value(0.0),
            e.hole,
            e.volume,
            1 / f.bulk_modulus + e.elasticity,
            e.face,
            e.added * e.outer,
            max(e.open, 1e-300),
            e.metal,
            gap,
            *e.end,
            *e.axis,
            *(e.axis if e.tangent is None else e.tangent),
            e.cut,
        ]

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([self.node]))
        held = self.held_at is not None
        slots: tuple = () if held else VERTEX_SLOTS
        if self.has_link:
            slots += (("bore.pressure", 0),)
        if self.has_annulus:
            slots += (("annulus.pressure", 0),) if held else (("annulus.pressure", 0), ("annulus.flow", 0))
        if self.has_link:
            slots += (("bit.flow", 0),)
        if self.growing is not None:
            slots += (("hole.end", 0), ("hole.drilled", 0))
        kernel = "bit_flow" + (
            "" if self.has_link and self.has_annulus else "_jet" if self.has_link else "_closed"
        )
        kernel += "_held" * held + "_grow" * (self.growing is not None)
        params = np.ascontiguousarray(np.tile(self._parameters(), (len(vertices), 1)))
        update = None if self.has_annulus else lambda t: self.renew(params, t)
        self._part = part
        self._block = ElementBlock(
            "bit_flow",
            kernel,
            "vertex",
            vertices,
            slots,
            (),
            params,
            context=self.fluid.address,
            update=update,
        )
        self._block.keep = (self.fluid,)
        self._report = function(f"{kernel}_report", "ipppppp")
        return (self._block,)

    def renew(self, params: FloatArray, t: float) -> None:
        """Set the pressure outside at ``t`` [s] in the block's parameters."""
        params[:, _AMBIENT] = self.end.ambient.value(t)

    # ------------------------------------------------------------------ the hole at the bit's position
    def locate_hole(self, state) -> None:
        """Evaluate the hole at the string's present position, before a run or in statics."""
        self._look(state, False)

    def accept(self, state) -> None:
        """Update the hole to the bit's position after an accepted step."""
        self._look(state, True)

    def _look(self, state, keep: bool) -> None:
        """Evaluate size and direction of the hole at the last node and at the hole's end.

        keep: during a run the volume of the chamber does not change, and only its further rate of change is
        that of the new size.  Otherwise the volume becomes that of the hole below the bit.
        """
        around, block = self.moving_hole, self._block
        if around is None or not self.has_annulus or self.held_at is not None or not len(block.points):
            return
        p, x, grown = block.params[0], state.x[state.index_of(block)[0]], self.growing
        node = int(block.points[0])
        depth = float(around.depth[node])
        end, axis = (p[_END], p[_AXIS]) if grown is None else (grown.first, grown.direction)
        if depth == self._depth and np.array_equal(axis, p[_AXIS]):
            return
        keep, before = keep and self._depth is not None, self._chamber(p, x)
        p[_HOLE], p[_TANGENT], p[_AXIS], p[_END] = (
            around.area[node],
            around.current_well().at(depth)[1],
            axis,
            end,
        )
        p[_OPEN], self._depth = p[_HOLE] - self.end.outer, depth
        gap = max(0.0, self._gap(p, x))
        below = float(around.hole.volume(np.array(depth + gap))) - around.volume[node]
        p[_VOLUME] = (
            p[_VOLUME] + before - self._chamber(p, x) if keep else self.end.volume + below - p[_HOLE] * gap
        )
        if abs(p[_HOLE] - self._size) > 2 * OTHER_SIZE * self._size:
            last = np.array([self.node - 1])
            sizes = around.annulus(
                last, np.array([[depth - around.mesh.length[-1] - around.mesh.rigid_above[-1], depth]])
            )
            p[_ADDED], self._size = float(around.sideways(sizes).added[0]) * self.end.outer, p[_HOLE]

    def get_local_state(self) -> dict[str, FloatArray]:
        """State of the hole at the bit for a checkpoint: (nv, p), zero except at the bit's node."""
        if self.moving_hole is None or self.held_at is not None:
            return {}
        block, nodes = self._block, np.zeros((len(self._part.vertices), self._block.params.shape[1] + 2))
        if self._depth is not None:
            nodes[block.points] = [*block.params[0], self._depth, self._size]
        return {"vertex": nodes}

    def set_local_state(self, memory: dict[str, FloatArray]) -> None:
        """Continue from the local part of ``get_local_state``."""
        if self.moving_hole is not None and memory and len(self._block.points):
            row = memory["vertex"][self._block.points[0]]
            if not row.any():  # the hole had not been evaluated yet
                return
            self._block.params[:], self._depth, self._size = row[:-2], float(row[-2]), float(row[-1])

    def _gap(self, p: FloatArray, x: FloatArray) -> float:
        """Compute the distance from the bit's face to the hole's end [m].

        With parameters ``p`` and unknowns ``x`` of the block.
        """
        end = p[_END] + (x[-4:-1] if self.growing is not None else 0.0)
        return float((end - x[:3] - x[3:6] * (p[_FACE] / np.linalg.norm(x[3:6]))) @ p[_AXIS])

    def _chamber(self, p: FloatArray, x: FloatArray) -> float:
        """Compute the volume of the chamber [m3] (manual: eq-mud-chamber)."""
        return float(p[_VOLUME] + p[_HOLE] * GAP_ROUNDING * np.logaddexp(0.0, self._gap(p, x) / GAP_ROUNDING))

    def breaks(self) -> tuple[float, ...]:
        return () if self.has_annulus else self.end.ambient.breaks()

    def figures(self, state) -> FloatArray:
        """Compute (7,) results, zero on ranks without the bit.

        Dissipated power [W], flow [m3/s], kinetic and stored energy [J], content [m3] and potential energy
        [J] of the chamber, cuttings into the chamber [m3/s at zero pressure].
        """
        out = np.zeros((1, 7))
        if len(self._block.points):
            self._report(
                1,
                pointer(state.index_of(self._block)),
                pointer(self._block.params),
                self._block.context,
                pointer(state.x),
                pointer(state.y),
                pointer(out),
            )
        return out[0]

    def energies(self, t: float, state) -> Energies:
        _, _, kinetic, stored, _, potential, _ = self.figures(state)
        return Energies(float(kinetic), float(stored), float(potential))

    def powers(self, t: float, state) -> Powers:
        """Compute the power lost in the nozzles.

        Without an annulus the power of the jet is work done outside.
        """
        lost, flow, *_ = self.figures(state)
        if not self.has_link:
            return Powers()
        e, mass = self.end, self.fluid.density * flow
        arriving = (
            0.5 * mass * (flow / e.bore) ** 2
        )  # kinetic power from the bore; the pressure loss of a nozzle accelerates the jet again
        if (
            self.has_annulus
        ):  # the jet comes to rest in the chamber, from which the annulus accelerates the flow
            return Powers(float(lost + arriving - 0.5 * mass * (flow / e.open) ** 2))
        jet = 0.5 * mass * (flow / (e.nozzle or e.bore)) ** 2
        return Powers(
            float(lost + arriving - jet), float(-flow * self.fluid.enthalpy(e.ambient.value(t)) - jet)
        )
