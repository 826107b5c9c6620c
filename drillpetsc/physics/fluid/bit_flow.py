"""Drilling fluid at the string's lower end: nozzles or open end, mud under the bit, reaction of the jet.

Kernel: kernels/fluid/bit_flow.hpp.  Manual: sec-mud-bit, sec-mud-force-ends.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import sqrt
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.errors import CaseError
from drillpetsc.fem.component import Component, ElementBlock, Field
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well
from drillpetsc.kernels.parameters import Parameters, Table, columns, constant
from drillpetsc.physics.fluid.channel_flow import FluidConstants, ambient_update
from drillpetsc.physics.fluid.moving_hole import OTHER_SIZE, MovingHole
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices
from drillpetsc.time_function import TimeFunction

END_CORRECTION = 0.61  # of an open unflanged pipe, in radii: Levine and Schwinger, Phys. Rev. 73:383, 1948
GAP_ROUNDING = constant("gap_rounding")  # distance over which a bit on bottom stops displacing mud [m]
STRING_UNKNOWNS = 7  # of the last node, before the unknowns of the mud
NEAR = 2.0  # distance from the bottom up to which the mud under the bit is measured from the hole's end [m]
SAME_HOLE = 1e-6  # difference of two holes that is none [m]
RESULTS = columns("bit_flow_results")
LIFTED = columns("bit_flow_parameters").span("lift", "head")
_POTENTIAL, _CONTENT = RESULTS["potential"], RESULTS["content"]
SHUT = 1e14  # resistance of a shut check valve, which passes 1 mm3/s at 1 bar [Pa s/m3]
NOZZLE_LENGTH = 0.1  # length over which mud speeds up in a nozzle [m]


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
    more: length by which the hole goes on below the end of the well, where a free end is lowered further [m]: ``end`` is there, or ``volume``
    contains it.
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
    more: float = 0.0


class BitFlow(Component):
    """One link and one chamber at the last node: unknown q_b [m3/s] if the bore ends in a link.

    node: the last one; end: data of the lower end; fluid: constants.
    held_at: (n+1, 3) positions of the nodes of a held string [m], None for a string that moves.
    moving_hole: the hole around a moving string, whose size and direction depend on the position; None: they
    keep their initial values.
    hole: the growing hole, whose end moves by the fields hole.end (3,) [m] and hole.drilled [m] of the bit;
    None: the hole does not grow.
    """

    name = "bit_flow"
    _kernel = "bit_flow"  # common first part of the kernels' names

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
        self._well: Well | None = None  # that hole
        self._size = end.hole  # area of the hole to which the added mass belongs [m2]
        self._resized = False  # at the last evaluation of the hole
        self._leader: BitFlow | None = None

    def fields(self) -> tuple[Field, ...]:
        return (
            (
                Field(
                    "bit.flow",
                    1,
                    physics="fluid",
                    region="bottom",
                    scale=self.fluid.usual_flow,
                    second_order=False,
                ),
            )
            if self.has_link
            else ()
        )

    def _parameters(self) -> dict[str, Any]:
        e, f = self.end, self.fluid
        area = e.nozzle or e.bore
        length = NOZZLE_LENGTH if e.nozzle else END_CORRECTION * np.sqrt(e.bore / np.pi)
        orifice = 1 / (2 * e.discharge_coefficient**2 * area**2) if area else 0.0  # [1/m4]
        gap = 0.0 if self.held_at is None else float((e.end - self.held_at[-1]) @ e.axis) - e.face
        return {
            "inertance": f.density * length / max(area, 1e-300),
            "nozzle": max(area, 1e-300),
            "loss": orifice if e.nozzle else 0.0,
            "shut": SHUT if e.check_valve else 0.0,
            "ambient": e.ambient.value(0.0),
            "hole": e.hole,
            "volume": e.volume,
            "elastic": 1 / f.bulk_modulus + e.elasticity,
            "face": e.face,
            "added": e.added * e.outer,
            "open": max(e.open, 1e-300),
            "buoyant": e.metal,
            "held_gap": gap,
            "end": e.end,
            "axis": e.axis,
            "tangent": e.axis if e.tangent is None else e.tangent,
            "cut": e.cut,
            "lift": -f.density * e.volume * float(f.gravity @ e.end),
            "reference": e.volume,
            "head": float(f.gravity @ (e.end - e.face * np.asarray(e.axis))),
        }

    def _slots(self) -> tuple[tuple[str, int], ...]:
        held = self.held_at is not None
        slots: tuple[tuple[str, int], ...] = () if held else VERTEX_SLOTS
        if self.has_link:
            slots += (("bore.pressure", 0),)
        if self.has_annulus:
            slots += (("annulus.pressure", 0),) if held else (("annulus.pressure", 0), ("annulus.flow", 0))
        if self.has_link:
            slots += (("bit.flow", 0),)
        if self.growing is not None:
            slots += (("hole.end", 0), ("hole.drilled", 0))
        return slots

    def _update_of(self, params: Table) -> Callable[[float], None] | None:
        """Function of time that updates the block's parameters."""
        return None if self.has_annulus else ambient_update(params, self.end.ambient)

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([self.node]))
        kernel = self._kernel + (
            "" if self.has_link and self.has_annulus else "_jet" if self.has_link else "_closed"
        )
        kernel += "_held" * (self.held_at is not None) + "_grow" * (self.growing is not None)
        params = Parameters(kernel, len(vertices), **self._parameters())
        self._part = part
        self._block = ElementBlock(
            "bit_flow",
            kernel,
            "vertex",
            vertices,
            self._slots(),
            (),
            params.array,
            context=self.fluid.address,
            constants=self.fluid.constants,
            remembers=True,
            update=self._update_of(params),
        )
        self._block.keep = (self.fluid,)
        return (self._block,)

    # ------------------------------------------------------------------ the hole at the bit's position
    def locate_hole(self, state) -> None:
        """Evaluate the hole at the string's present position, before a run or in statics."""
        self._update_hole(state, False)
        self._lift(state)
        if self._moves_in_mud and len(
            self._block.points
        ):  # the chamber's mud is between the face and the hole's end
            p, x = self._block.named, state.x[state.index_of(self._block)[0]]
            middle = p["end"][0] - 0.5 * max(0.0, self._gap(p, x)) * p["axis"][0]
            p["lift"] = -self.fluid.density * p["reference"] * float(self.fluid.gravity @ middle)

    def follow(self, leader: Component, state) -> None:
        assert isinstance(leader, BitFlow)
        self._leader = leader

    def accept_beside(self, t, others) -> None:
        hole = self.moving_hole
        if hole is not None and (self.growing is not None or hole.moved is not None):
            super().accept_beside(t, others)

    def accept(self, t, state) -> None:
        """Update the hole to the bit's position after an accepted step."""
        if self._leader is None:  # energies beside a run are nobody's
            self._lift(state)
        self._update_hole(state, True)

    def _lift(self, state) -> None:
        """Count the flow through the lower end since the last call, with the height of the end.

        The potential of the chamber's mud changes by nothing else (manual: eq-mud-potential-chamber).
        """
        if not self._moves_in_mud or not len(self._block.points):
            return
        head = self.fluid.gravity.dot(state.x.take(state.index_of(self._block)[0, :3]))
        lifted = self._block.params[0, LIFTED]
        if (
            head == lifted[-1]
        ):  # a state that is counted, as after a restart: its rounding is not counted again
            return
        results = self.element_results(state)
        lifted[0], lifted[1], lifted[2] = results[_POTENTIAL], results[_CONTENT], head

    @property
    def _moves_in_mud(self) -> bool:
        return self.has_annulus and self.held_at is None

    def _update_hole(self, state, keep: bool) -> None:
        """Evaluate size and direction of the hole at the last node and at the hole's end.

        keep: during a run the volume of the chamber does not change, and only its further rate of change uses
        the new size.  Otherwise the volume becomes the volume of the hole below the bit.
        """
        around, block = self.moving_hole, self._block
        if around is None or not self.has_annulus or self.held_at is not None or not len(block.points):
            return
        node = int(block.points[0])
        depth = around.depth.item(node)
        well = around.current_well()
        # then the direction of the hole has not changed either
        if keep and depth == self._depth and (self.growing is None or well is self._well):
            return
        self._well = well
        p, x = block.named, state.x[state.index_of(block)[0]]
        end, axis, distance = self._lower_end(x, depth, p["face"][0])
        if depth == self._depth and np.array_equal(axis, p["axis"][0]):
            return
        keep, before = keep and self._depth is not None, self._chamber(p, x)
        p["hole"], p["axis"], p["end"] = around.area[node], axis, end
        p["tangent"] = around.current_well().at(depth)[1]
        area = float(around.area[node])
        p["open"], self._depth = area - self.end.outer, depth
        gap, bottom = max(0.0, self._gap(p, x)), depth + max(0.0, distance)
        below = float(around.hole.volume(np.array(bottom))) - around.volume[node]
        p["volume"] = (
            p["volume"] + before - self._chamber(p, x) if keep else self.end.volume + below - area * gap
        )
        resized = abs(area - self._size) > 2 * OTHER_SIZE * self._size
        self._resized = resized if self._leader is None else self._leader._resized
        if self._resized:
            last = np.array([self.node - 1])
            sizes = around.annulus(
                last, np.array([[depth - around.mesh.length[-1] - around.mesh.rigid_above[-1], depth]])
            )
            p["added"], self._size = float(around.lateral(sizes).added[0]) * self.end.outer, area

    def _lower_end(self, x: FloatArray, depth: float, face: float) -> tuple[FloatArray, FloatArray, float]:
        """End and direction (3,) of the hole for the gap of the chamber, and distance [m] of the face from the end.

        x: unknowns of the block; depth: measured depth of the last node [m]; face: distance of the face below it [m].
        Near the bottom they belong to the hole's end.  Far above it the mud under the bit is measured along the hole: the
        direction is the hole's direction at the bit. Along it, the end is as far ahead as along the hole.
        """
        around, grown = self.moving_hole, self.growing
        assert around is not None
        well, half = around.current_well(), 0.0
        if grown is None:
            end, axis = self.end.end, self.end.axis
        else:
            end, axis, half = grown.start_point, grown.direction, grown.half
        ahead = well.depth + self.end.more - half - depth
        distance = ahead - face
        if distance > NEAR:
            place, axis, _ = well.at(depth)
            end = np.asarray(place) + np.asarray(axis) * ahead
            if grown is not None:  # the kernel adds the motion of the end since the start
                end = end - x[-4:-1]
        return end, np.asarray(axis), distance

    def get_state(self) -> dict[str, FloatArray]:
        """How far the hole goes on below its end [m]."""
        return {"more": np.array([self.end.more])}

    def set_state(self, state: dict[str, FloatArray]) -> None:
        """Continue in the hole of the run that is continued: its mud has been there from the start.

        Raises CaseError if this run lowers a free end further below its hole.
        """
        further = self.end.more - float(state["more"][0])
        if further > SAME_HOLE:
            raise CaseError(
                at="time.end",
                want="not later than the run was begun for: its free end is lowered below the hole, and the mud there is that of the way till then",
                hint="start the run again with this time.end, or with a survey that goes on below the string",
            )
        self._shorten(further)

    def _shorten(self, less: float) -> None:
        """Let the hole end higher by ``less`` [m]."""
        e = self.end
        self.end = replace(e, end=np.asarray(e.end) - less * np.asarray(e.axis), more=e.more - less)

    def get_local_state(self) -> dict[str, FloatArray]:
        """State of the hole at the bit for a checkpoint: (nv, p), zero except at the bit's node."""
        if not self._moves_in_mud:
            return {}
        block, nodes = self._block, np.zeros((len(self._part.vertices), self._block.params.shape[1] + 2))
        if len(block.points):
            depth = np.inf if self._depth is None else self._depth
            nodes[block.points] = [*block.params[0], depth, self._size]
        return {"vertex": nodes}

    def set_local_state(self, saved: dict[str, FloatArray]) -> None:
        """Continue from the local part of ``get_local_state``."""
        if self._moves_in_mud and saved and len(self._block.points):
            row = saved["vertex"][self._block.points[0]]
            self._block.params[:], self._size = row[:-2], float(row[-1])
            self._depth = float(row[-2]) if np.isfinite(row[-2]) else None  # None: not evaluated yet

    def _gap(self, p: Table, x: FloatArray) -> float:
        """Distance from the bit's face to the hole's end [m] at unknowns ``x`` of the block, with parameters
        ``p``."""
        end, slope = p["end"][0], x[3:6]
        if self.growing is not None:
            end = end + x[-4:-1]
        return float((end - x[:3] - slope * (p["face"].item(0) / sqrt(slope.dot(slope)))).dot(p["axis"][0]))

    def _chamber(self, p: Table, x: FloatArray) -> float:
        """Volume of the chamber [m3]."""
        volume, hole = p["volume"].item(0), p["hole"].item(0)
        return float(volume + hole * GAP_ROUNDING * np.logaddexp(0.0, self._gap(p, x) / GAP_ROUNDING))

    def closed_face(self, state) -> FloatArray:
        """Area of the bit's face that does not displace mud, times the hole's direction (3,) [m2].

        Zero on ranks without the bit, without an annulus, for a held string, and in a growing hole.
        """
        if (
            not self.has_annulus
            or self.held_at is not None
            or self.growing is not None
            or not len(self._block.points)
        ):
            return np.zeros(3)
        params = self._block.named
        gap = self._gap(params, state.x[state.index_of(self._block)[0]])
        closed = 1.0 / (1.0 + np.exp(min(gap / GAP_ROUNDING, 700.0)))
        return closed * params["hole"][0] * np.asarray(params["axis"][0])

    def breaks(self) -> tuple[float, ...]:
        return () if self.has_annulus else self.end.ambient.breaks()

    def element_results(self, state) -> FloatArray:
        """(7,) the columns of ``RESULTS``: lost power [W], flow [m3/s], kinetic and stored energy [J], content
        [m3] and potential [J] of the chamber, cuttings that enter it [m3/s at zero pressure]; this rank's; not to be changed."""
        block = self._block  # of one element at most, whose results are the sums
        return state.results(block, block.results_kernel, RESULTS.width).sums

    def results_of(self, steps) -> FloatArray:
        """(k, 7) ``element_results`` after each of k steps."""
        return np.asarray(steps.sums(self._block, self._block.results_kernel, RESULTS.width))

    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        return tuple(
            self.results_of(steps)[:, [RESULTS[name] for name in ("kinetic", "stored", "potential")]].T
        )

    def powers_of(self, steps) -> tuple[Any, Any]:
        """Losses in the nozzles and of the jet, which comes to rest under the bit.

        Without an annulus, the energy of the jet counts as work done outside (manual: eq-mud-end-power).
        """
        if not len(self._block.points):
            return 0.0, 0.0
        e, f, results = self.end, self.fluid, self.results_of(steps)
        inside, outside, rising = self._end_flow(steps)
        if self.held_at is not None:
            place, velocity, slope = self.held_at[-1:], np.zeros((1, 3)), np.ones((1, 3))
        else:
            index = steps.assembly.index_of(self._block)[0]
            place, velocity = steps.unknowns(index[:3]), steps.rates(index[:3])
            slope = steps.unknowns(index[3:6])
        lost: Any = 0.0
        supplied: Any = 0.0
        if self.has_annulus:  # what enters the annulus starts from rest
            forward = np.sum(velocity * steps.parameters(self._block, "tangent", 0), axis=1)
            rise = rising * self._thinning(outside) / steps.parameters(self._block, "open", 0)
            lost = -(0.5 * f.density * rising * (forward - rise) ** 2)
            supplied = results[:, RESULTS["bottom"]]
        if self.has_link:
            flow = results[:, RESULTS["flow"]]
            jet = flow * self._thinning(outside) / (e.nozzle or e.bore)
            speed = flow * self._thinning(inside) / e.bore
            forward = np.sum(velocity * slope, axis=1) / np.sqrt(np.sum(slope * slope, axis=1))
            # power of the reaction on the moving string, transferred to the mud
            reaction = np.sum(velocity * velocity, axis=1) + 2 * jet * forward
            lost = lost + results[:, RESULTS["lost"]] + 0.5 * f.density * flow * (speed**2 + reaction)
            if not self.has_annulus:
                leaving = 0.5 * f.density * flow * (jet**2 + reaction)
                head = f.density * (place @ f.gravity)
                lost = lost - leaving
                supplied = supplied - flow * (f.enthalpy(outside) - head) - leaving
        return lost, supplied

    def ambient_of(self, steps) -> FloatArray:
        """(k,) pressure outside a lower end without an annulus [Pa]."""
        return np.array([self.end.ambient.value(t) for t in steps.times])

    def _end_flow(self, steps) -> tuple[FloatArray, FloatArray, FloatArray]:
        """(k,) each: pressures in the lowest node of the bore and outside it [Pa], and the flow that rises from there in the
        annulus [m3/s]; on the rank with the end."""
        held = self.held_at is not None
        own = steps.assembly.index_of(self._block)[0][0 if held else STRING_UNKNOWNS :].tolist()
        none = np.zeros(len(steps))
        inside = steps.unknowns(own[0]) if self.has_link else none
        if not self.has_annulus:
            return inside, self.ambient_of(steps), none
        after = own[int(self.has_link) :]
        rising = self.results_of(steps)[:, RESULTS["flow"]] if held else -steps.unknowns(after[1])
        return inside, steps.unknowns(after[0]), rising

    def _thinning(self, pressure: FloatArray) -> FloatArray:
        """Ratio of the density at zero pressure to the density at ``pressure`` [Pa]."""
        return np.asarray(np.exp(-pressure / self.fluid.bulk_modulus))
