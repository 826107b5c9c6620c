"""Flow in the channels by volumes, as in the reference formulation (``formulation: hermite``).

Kernel: kernels/fluid/hermite/hermite_flow.hpp.  Manual: eq-mud-hermite, eq-mud-hermite-momentum,
sec-paper-source.

Unknowns at every node: the volume that has passed it in excess of a reference flow Q(t), and the pressure
(including the velocity heads since the channel's uppermost element).  Q is arbitrary as long as volumes
stay small.  Here it is the pump's flow with its jumps distributed over a second, in the annulus with the
opposite sign. So steady circulation is a state of rest.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray, sums_from_below
from drillpetsc.fem.component import ElementBlock, Field
from drillpetsc.kernels.parameters import Parameters, Table
from drillpetsc.physics.fluid.annulus_flow import AnnulusFlow, HoleAround
from drillpetsc.physics.fluid.bit_flow import GAP_ROUNDING, RESULTS, BitFlow
from drillpetsc.physics.fluid.bore_flow import BoreFlow
from drillpetsc.physics.fluid.channel_flow import ChannelFlow, ambient_update
from drillpetsc.physics.fluid.channels import Bore
from drillpetsc.physics.fluid.moving_hole import MovingHole
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices
from drillpetsc.time_function import TimeFunction

VOLUME_SCALE = 1.0e-2  # [m3]
LEAST_VOLUME = 1e-3  # chamber under a bit on bottom if the case gives less [m3]
SMALLEST = 1e-4  # chamber that a bit leaves as it goes on below the hole's end [m3]
HOLE_AT_BIT = "end", "axis", "tangent"  # parameters of the chamber that turn with the hole
WINDOW = 1.0  # time over which the reference follows a jump of the pump [s]


@dataclass(frozen=True)
class Reference:
    """The pump's flow q(t) [m3/s] without jumps.

    It is q(t) - sum of D_k (1 + cos(pi (t - t_k)/W))/2 over the jumps D_k at t_k within the last W =
    ``WINDOW`` [s].
    """

    flow: TimeFunction

    @cached_property
    def _jumps(self) -> tuple[tuple[float, float], ...]:
        return tuple(
            (t, self.flow.value(t) - self.flow.value(t, before=True)) for t in self.flow.jumps() if t > 0
        )

    def value(self, t: float) -> float:
        late = sum(
            0.5 * d * (1 + np.cos(np.pi * (t - at) / WINDOW)) for at, d in self._jumps if 0 <= t - at < WINDOW
        )
        return float(self.flow.value(t) - late)

    def behind(self, t: float) -> float:
        """Compute the integral of the pump's flow minus this one, from 0 to t [m3]."""
        passed = [(min(t - at, WINDOW), d) for at, d in self._jumps if t >= at]
        return float(sum(0.5 * d * (s + WINDOW / np.pi * np.sin(np.pi * s / WINDOW)) for s, d in passed))

    def rate(self, t: float) -> float:
        """Return the rate just before ``t`` [s], for a step ending there [m3/s2]."""
        late = sum(
            0.5 * d * np.pi / WINDOW * np.sin(np.pi * (t - at) / WINDOW)
            for at, d in self._jumps
            if 0 <= t - at < WINDOW
        )
        return float(self.flow.rate(t, before=True) + late)


def _heads(area: FloatArray) -> FloatArray:
    """Compute (1/A^2 - 1/A_0^2)/2 (n,) of each element [1/m4]."""
    return 0.5 * (1 / area**2 - 1 / area[0] ** 2)


def volumes_at_rest(
    bore: HermiteBore | None,
    annulus: HermiteAnnulus | None,
    bit: HermiteBit | None,
    head: FloatArray,
    level: float,
) -> dict[str, FloatArray]:
    """Compute nodal volumes (n+1,) [m3] by field of fluid at rest under the pressures level + ``head`` (n+1,) [Pa].

    The volume is zero at the pump.  From there it decreases by the volumes that each element and the chamber
    store. The pressure is linear between the nodes.
    """
    out, passed = {}, 0.0
    pressure = level + head
    if bore is not None:
        taken = _taken_up(bore, bore.bore.wall, pressure)
        out["bore.volume"] = -np.concatenate([[0.0], np.cumsum(taken)])
        passed = float(out["bore.volume"][-1]) if not bore.closed else 0.0
    if annulus is not None:
        assert bit is not None
        taken = _taken_up(annulus, annulus.annulus.wall, pressure)
        give = 1 / bit.fluid.bulk_modulus + bit.end.elasticity
        below = bit._chamber_volume(bit.rest_gap) * float(np.expm1(pressure[-1] * give)) - passed
        out["annulus.volume"] = below + sums_from_below(taken)
    return out


def _taken_up(component: HermiteBore | HermiteAnnulus, wall: FloatArray, pressure: FloatArray) -> FloatArray:
    """Compute the stored volume (n,) of each element [m3]: content at ``pressure`` (n+1,) [Pa] minus the
    content at zero pressure.
    """
    m = component.mesh
    length = m.length + m.rigid_above
    ends = [
        np.expm1(p / component.fluid.bulk_modulus) * (1 + wall * p) + wall * p
        for p in (pressure[:-1], pressure[1:])
    ]
    return component.content * length * 0.5 * (ends[0] + ends[1])


def _wait(block: ElementBlock) -> None:
    """Let the kernel know when the flow's unknowns are fixed and the string's are not."""
    waits = block.named["waits"]

    def freezes(frozen: np.ndarray) -> None:
        waits[:] = frozen[:, -1] & ~frozen.all(axis=1)

    block.freezes = freezes


class _ByVolumes(ChannelFlow):
    """Channel with volumes and pressures as unknowns.  The subclass gives ``reference``, its ``sign``, and ``heads``."""

    reference: Reference
    heads: FloatArray
    sign = 1.0

    def _set_reference(self, pump: TimeFunction, section: FloatArray) -> None:
        """Set the flow of the pump over time, and the section at rest (n,) [m2]."""
        self.reference, self.content, self.heads = Reference(pump), section, _heads(section)
        #: (1,) the reference flow at present [m3/s], in place: records of steps have its address
        self._now = np.array([self.sign * self.reference.value(0.0)])

    def fields(self) -> tuple[Field, ...]:
        return (
            Field(f"{self.name}.volume", 1, physics="fluid", scale=VOLUME_SCALE),
            Field(f"{self.name}.pressure", 1, physics="fluid", scale=self.fluid.usual_pressure),
        )

    def own_slots(self) -> tuple[tuple[str, int], ...]:
        return tuple((f"{self.name}.{what}", end) for what in ("volume", "pressure") for end in (0, 1))

    @property
    def kernel(self) -> str:
        return f"hermite_{self.name}"

    def _update_of(self, block: ElementBlock):
        others = super()._update_of(block)
        reference, surge = block.named["reference_flow"], block.named["surge"]

        def update(t: float) -> None:
            if others is not None:
                others(t)
            self._now[0] = self.sign * self.reference.value(t)
            reference[:], surge[:] = self._now, self.sign * self.reference.rate(t)

        return update

    def upper_flow_of(self, steps) -> FloatArray | None:
        if self._top is None:
            return None
        block, row = self._top
        volume = steps.assembly.index_of(block).item(row, -4)
        return np.asarray(steps.rates(volume) + steps.numbers(self._now, 0))

    def flows(self, system) -> FloatArray:
        """Mean flow rates (nc,) of both ends of the local elements [m3/s]."""
        rate = system.field(f"{self.name}.volume", "y")[:, 0]
        return np.asarray(rate[system.chain.ends].mean(axis=1) + self._now)

    def pressures(self, system) -> FloatArray:
        flow = system.field(f"{self.name}.volume", "y")[:, 0] + self._now
        return self._pressure(system.field(f"{self.name}.pressure")[:, 0], flow, system.chain.vertices)

    def pressure_at_of(self, steps, vertex: int) -> FloatArray:
        layout = steps.assembly.layout
        volume, total = (
            layout.dofs[f"{self.name}.{what}"].item(vertex, 0) for what in ("volume", "pressure")
        )
        flow = steps.rates(volume) + steps.numbers(self._now, 0)
        return self._pressure(steps.unknowns(total), flow, layout.chain.vertices[vertex])

    def _pressure(self, total: FloatArray, flow: FloatArray, vertices: Any) -> FloatArray:
        """Pressures above nodes [Pa]: the unknown ``total`` minus the heads of the element above at the ``flow`` [m3/s]."""
        head = self.fluid.density * self.heads[np.maximum(vertices - 1, 0)] * flow**2
        return np.asarray(total - (1 - total / self.fluid.bulk_modulus) * head)

    def pressure_places(self, system) -> np.ndarray | None:
        return None


class HermiteBore(_ByVolumes, BoreFlow):
    """Bore with a given flow of the pump.

    closed: the lower end is closed, and the volume there has the constant value ``kept`` [m3].
    Other arguments as in ``BoreFlow``.
    """

    def __init__(
        self,
        mesh,
        bore: Bore,
        fluid,
        poisson: FloatArray,
        flow_rate: TimeFunction,
        closed: bool,
        held_at: FloatArray | None = None,
    ):
        super().__init__(mesh, bore, fluid, poisson, flow_rate, None, held_at)
        self.closed, self.kept = closed, 0.0
        self._set_reference(flow_rate, bore.area)

    def parameters(self, e: np.ndarray) -> Table:
        return Parameters(
            self.kernel,
            len(e),
            **self._channel(e),
            heads=self.heads[e],
            reference_flow=0.0,
            given=e == 0,
            flow=0.0,
            surge=0.0,
            closed=self.closed * (e == len(self.mesh.upper) - 1),
            pumped=0.0,
            kept=self.kept,
            waits=0.0,
            open_above=self.bore.area_above[e],
        )

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        self._is_top = bool(len(local_vertices(part, np.array([0]))[1]))
        blocks = ChannelFlow.blocks(self, part)
        for block in blocks:
            _wait(block)
        return blocks

    def _update_of(self, block: ElementBlock):
        others, flow, pumped = super()._update_of(block), block.named["flow"], block.named["pumped"]

        def update(t: float) -> None:
            others(t)
            flow[:], pumped[:] = self.reference.flow.value(t), self.reference.behind(t)

        return update

    def pumped_of(self, steps) -> FloatArray | None:
        """The inflow by the formula of the time integrator [m3/s], with which the mass balance is exact."""
        return self.upper_flow_of(steps)

    def upper_pressure_of(self, steps) -> FloatArray:
        return self._top_unknown_of(steps, -2)


class HermiteAnnulus(_ByVolumes, AnnulusFlow):
    """Annulus with the pump's flow upwards as reference flow.

    Its sizes keep their initial values: the pressure follows from the content of an element, and would jump
    with it. Arguments as in ``AnnulusFlow``; pump: its flow over time [m3/s].
    """

    resizes = False
    sign = -1.0

    def __init__(self, mesh, around: HoleAround, *arguments, pump: TimeFunction):
        super().__init__(mesh, around, *arguments)
        self._set_reference(pump, self.annulus.hole - self.annulus.outer)
        self._turned_at: FloatArray | None = (
            None  # (nv, 3) nodes where the hole is evaluated during a run [m]
        )
        m, top, hole = self.mesh, around.top, self.annulus.hole
        #: (n,) measured depth of upper node, lower end of the rigid item above, lower node, at the start [m]
        self._start = top + m.upper - m.rigid_above, top + m.upper, top + m.lower
        depth = np.append(self._start[0], self._start[2][-1:])
        #: (n+1, 3) volume of hole that a node passes per length of its way [m2] (kernels/fluid/hermite/hermite_annulus.hpp)
        self.passed = np.append(hole, hole[-1:])[:, None] * self.well.at(depth)[1]

    def parameters(self, e: np.ndarray) -> Table:
        return Parameters(
            self.kernel,
            len(e),
            **self._channel(e),
            heads=self.heads[e],
            reference_flow=0.0,
            open=e == 0,
            surge=0.0,
            bent=self._bent_on_axis(e),
            waits=0.0,
            open_above=(self.annulus.hole_around - self.annulus.outer_above)[e],
            passed1=self.passed[e],
            passed2=self.passed[e + 1],
            **self._ledges(e),
            **self._beside(e, self.well, self.mesh.upper[e]),
            # the element below a shoulder presses on it with the pressure beside itself, not with that above
            shoulder=self._shoulders(e, self.annulus.only(e), self.annulus.only(np.maximum(e - 1, 0)))
            - np.diff(self.heads, prepend=0.0)[e] * self.annulus.outer[e],
        )

    def _ledges(self, e: np.ndarray) -> dict[str, FloatArray]:
        """Parameters of the ledges of the hole at the elements ``e`` (k,) (manual: eq-mud-hermite-ledge)."""
        a, fluid, beta = self.annulus, self.fluid, 1 / self.fluid.bulk_modulus
        node, item, lower = (self.well.at(depth[e]) for depth in self._start)
        first = np.where(self.mesh.rigid_above > 0, a.hole_around, a.hole)
        below = np.append(first[1:], a.hole[-1:])
        outlet = self.flow_line.pressure.value(0.0) + self._flow_line_head
        found = dict[str, FloatArray]()
        for name, narrowed, at, (place, along, _) in (
            ("_above", first - a.hole, item[0], node),
            ("", a.hole - below, lower[0], lower),
        ):
            pressure = outlet + fluid.density * (at @ fluid.gravity)
            found |= {
                f"ledge{name}": narrowed[e] * np.exp(beta * pressure),
                f"push{name}": narrowed[e] * (np.expm1(beta * pressure) / beta - pressure),
                f"ledge_place{name}": np.sum(place * along, axis=1),
            }
        return found

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        # the outlet's pressure on the annulus is among the rows of the uppermost element
        blocks = tuple(block for block in super().blocks(part) if block.name != "annulus_top")
        for block in blocks:
            _wait(block)
        return blocks

    def _update_hole(self, state, keep: bool) -> None:
        self._turned_at = None if not keep or self.held else state.x[state.layout.dofs["string.position"]]
        super()._update_hole(state, keep)

    def _renew(self, params: Table, rows: np.ndarray, cells: np.ndarray, around: MovingHole) -> None:
        """Directions only.  During a run the hole between two nodes keeps its length, which is the content's."""
        nodes, e = self._part.ends[cells], self._part.cells[cells]
        places = around.places if self._turned_at is None else self._turned_at
        above, below = (places[end] for end in nodes.T)

        def along() -> tuple[FloatArray, FloatArray]:
            directions = params["tangent0"][rows], params["tangent2"][rows]
            return np.sum(above * directions[0], axis=1), np.sum(below * directions[1], axis=1)

        depth = around.depth[nodes[:, 0]], around.depth[nodes[:, 1]]
        length, way = (
            depth[1] - depth[0] - self.mesh.rigid_above[e],
            (depth[0] - self._start[0][e], depth[1] - self._start[2][e]),
        )
        if self._turned_at is not None:
            upper, lower = along()
            length = params["bent"][rows] + lower - upper
            way = upper - params["ledge_place_above"][rows], lower - params["ledge_place"][rows]
        super()._renew(params, rows, cells, around)
        upper, lower = along()
        params["bent"][rows] = length - (lower - upper)
        params["ledge_place_above"][rows], params["ledge_place"][rows] = upper - way[0], lower - way[1]

    def other_hole(self) -> float:
        """Largest change of the hole's diameter since the start, over that diameter, beside the elements of this rank [-]."""
        around, e = self.moving_hole, self._part.cells
        if around is None or self.held:
            return 0.0
        now, then = around.annulus(e, around.depth[self._part.ends]), self.annulus.only(e)
        return float(np.abs(now.hole_diameter / then.hole_diameter - 1).max(initial=0.0))

    def flows(self, system) -> FloatArray:
        flow = super().flows(system)
        if self.held:
            return flow
        upper, lower = (system.field("string.position", "y")[end] for end in system.chain.ends.T)
        # past a ledge the flow relative to the string changes
        gained = self.parameter("ledge_above") * np.sum(upper * self.parameter("tangent0"), axis=1)
        gained -= self.parameter("ledge") * np.sum(lower * self.parameter("tangent2"), axis=1)
        return np.asarray(flow + 0.5 * gained)

    def direction_at_bit(self) -> FloatArray | None:
        """(3,) direction of the hole at the lowest node; None on ranks without it."""
        last = len(self.mesh.upper) - 1
        for b in self._blocks:
            rows = np.flatnonzero(self._part.cells[b.points] == last)
            if len(rows):
                return np.array(b.named["tangent2"][rows[0]])
        return None

    def _present_flow(self, state) -> tuple[IntArray, FloatArray]:
        return np.zeros(len(self._part.cells), dtype=np.int32), self._now

    def upper_pressure_of(self, steps) -> FloatArray:
        """(k,) given pressure at the upper end [Pa], which the unknown at the node meets only in the mean."""
        block, row = self._upper_element
        pressure = np.asarray(steps.parameters(block, "controlled", row))
        return pressure if self.held else pressure + self._upper_head_of(steps)


class HermiteBit(BitFlow):
    """Nozzles and chamber without unknowns (kernels/fluid/hermite/hermite_bit.hpp).

    node, end, fluid, held_at: as in ``BitFlow``; pump: its flow over time [m3/s].
    channels: bore and annulus, whose lowest elements give the heads; None if absent.
    rest_at: (3,) position of the lowest node at which volumes are zero [m].
    """

    _kernel = "hermite_bit"

    def __init__(
        self,
        node: int,
        end,
        fluid,
        pump: TimeFunction,
        channels: tuple[HermiteBore | None, HermiteAnnulus | None],
        rest_at: FloatArray,
        held_at: FloatArray | None = None,
    ):
        self.travel = (max(end.volume, LEAST_VOLUME) - SMALLEST) / end.hole if end.hole else 0.0
        gap = float((end.end - rest_at) @ end.axis) - end.face
        axis = np.asarray(end.axis if end.tangent is None else end.tangent)
        end = replace(end, volume=SMALLEST, axis=axis, end=rest_at + axis * (gap + end.face))
        super().__init__(node, end, fluid, held_at)
        self.reference, self.rest_gap, self.annulus = Reference(pump), gap, channels[1]
        self.last_heads = [0.0 if component is None else float(component.heads[-1]) for component in channels]

    def fields(self) -> tuple[Field, ...]:
        return ()

    def _slots(self) -> tuple[tuple[str, int], ...]:
        slots: tuple[tuple[str, int], ...] = () if self.held_at is not None else VERTEX_SLOTS
        outside = ("annulus.volume", 0), ("annulus.pressure", 0)
        return slots + (("bore.volume", 0),) * self.has_link + outside * self.has_annulus

    def _parameters(self) -> dict[str, Any]:
        pipe, annulus = self.last_heads
        return super()._parameters() | {
            "held_gap": self.rest_gap,
            "reference_flow": 0.0,
            "surge": 0.0,
            "heads_pipe": pipe,
            "heads_annulus": annulus,
            "travel": self.travel,
            "waits": 0.0,
            "passed": 0.0 if self.annulus is None else self.annulus.passed[-1],
        }

    def _update_of(self, params: Table) -> Callable[[float], None]:
        reference, surge, ambient = (
            params["reference_flow"],
            params["surge"],
            ambient_update(params, self.end.ambient),
        )

        def update(t: float) -> None:
            reference[:], surge[:] = self.reference.value(t), self.reference.rate(t)
            ambient(t)

        update(0.0)
        return update

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        blocks = super().blocks(part)
        _wait(self._block)
        return blocks

    def locate_hole(self, state) -> None:
        self._turn(state)

    def accept(self, t, state) -> None:
        self._turn(state)

    def _turn(self, state) -> None:
        """Measure the gap along the hole beside the bit; it does not change when the direction does."""
        if self.annulus is None or self.held_at is not None or not len(self._block.points):
            return
        p, place = self._block.named, state.x[state.index_of(self._block)[0, :3]]
        axis = self.annulus.direction_at_bit()
        if axis is not None and not np.array_equal(axis, p["axis"][0]):
            ahead = float((p["end"][0] - place) @ p["axis"][0])
            p["axis"], p["end"], p["tangent"] = axis, place + axis * ahead, axis

    def _shorten(self, less: float) -> None:
        self.end, self.travel = replace(self.end, more=self.end.more - less), self.travel - less
        self._block.named["travel"] = self.travel

    def get_local_state(self) -> dict[str, FloatArray]:
        """End and direction of the hole beside the bit, for a checkpoint: (nv, 9), zero except at the bit's node."""
        if self.annulus is None or self.held_at is not None:
            return {}
        nodes = np.zeros((len(self._part.vertices), 9))
        nodes[self._block.points] = np.hstack([self._block.named[name] for name in HOLE_AT_BIT])
        return {"vertex": nodes}

    def set_local_state(self, saved: dict[str, FloatArray]) -> None:
        """Continue from the local part of ``get_local_state``."""
        if saved and self.annulus is not None and self.held_at is None:
            for name, part in zip(
                HOLE_AT_BIT, np.hsplit(saved["vertex"][self._block.points], 3), strict=True
            ):
                self._block.named[name] = part

    def closed_face(self, state) -> FloatArray:
        """Zero: a bit that goes on into rock that gives way displaces mud with its whole face."""
        return np.zeros(3)

    _moves_in_mud = False  # the kernel places the chamber's mud itself

    def _end_flow(self, steps) -> tuple[FloatArray, FloatArray, FloatArray]:
        """As for ``BitFlow``: the bore's pressure is not an unknown of the bit, and its mud has the density of the mud outside."""
        outside = self.ambient_of(steps)
        if self.has_annulus:
            outside = steps.unknowns(steps.assembly.index_of(self._block).item(0, -1))
        return outside, outside, self.results_of(steps)[:, RESULTS["flow"]]

    def _chamber_volume(self, gap: float) -> float:
        """Volume [m3] about the bit at a distance between its face and the hole's end [m]."""
        below = (gap + self.travel) / GAP_ROUNDING
        return self.end.volume + self.end.hole * GAP_ROUNDING * float(np.logaddexp(0.0, below))

    def missing_volume(self, state) -> tuple[float, float] | None:
        """Compute volume [m3] and volume rate [m3/s] at zero pressure to add to the annulus' volumes.

        With the volume the chamber has the annulus' lowest pressure; with the rate it keeps this pressure
        while the bit moves.  Both are zero on ranks without the bit.
        """
        index, e, p = state.index_of(self._block), self.end, self._block.named
        if not self.has_annulus or not len(index):
            return 0.0, 0.0
        gap, widens = self.rest_gap, 0.0
        if self.held_at is None:
            place, velocity = (which[index[0, :3]] for which in (state.x, state.y))
            gap = float((p["end"][0] - place) @ p["axis"][0]) - e.face
            below = np.clip((gap + self.travel) / GAP_ROUNDING, -700.0, 700.0)
            widens = -e.hole / (1 + np.exp(-below)) * float(velocity @ p["axis"][0])
        pressure = state.x[index[0, -1]]
        theta = np.exp(pressure / self.fluid.bulk_modulus) * (1 + pressure * e.elasticity)
        passed = state.x[index[0, -2]] + (state.x[index[0, -3]] if self.has_link else 0.0)
        volume = self._chamber_volume(gap)
        return float((volume - self._chamber_volume(self.rest_gap)) + volume * (theta - 1) - passed), float(
            theta * widens
        )
