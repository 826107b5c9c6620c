"""Drilling fluid between string and hole, from the bit to the flow line (kernels/fluid/annulus_flow.hpp).

Manual: sec-mud, sec-mud-force-annulus, sec-mud-moving.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.component import Component, ElementBlock
from drillpetsc.fem.quantity import OneStep
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.well import Well
from drillpetsc.kernels.parameters import Parameters, Table
from drillpetsc.physics.fluid.channel_flow import SPEED, ChannelFlow, FluidConstants
from drillpetsc.physics.fluid.channels import Annulus
from drillpetsc.physics.fluid.moving_hole import OTHER_SIZE, LateralCoefficients, MovingHole
from drillpetsc.physics.fluid.swirl import OTHER_FLOW, MeanSpins, Swirl
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices
from drillpetsc.time_function import TimeFunction


@dataclass(frozen=True)
class HoleAround:
    """The hole around the elements of the string.

    sizes: of the annulus at the start; well: the hole; top: measured depth of the string's top there [m].
    moving: the hole around a moving string, with sizes and directions that depend on the position of the elements;
    None: they keep their initial values.
    """

    sizes: Annulus
    well: Well
    moving: MovingHole | None = None
    top: float = 0.0


@dataclass(frozen=True)
class FlowLine:
    """Outlet of the annulus.

    pressure: gauge pressure over time [Pa]; depth: below the rotary table [m].
    choke: 1/(2 C_d^2 A^2) of a valve [1/m4], 0 without one.
    """

    pressure: TimeFunction
    depth: float = 0.0
    choke: float = 0.0


class AnnulusFlow(ChannelFlow):
    """Flow in the annulus: pressure [Pa] at the nodes, flow rate at zero pressure [m3/s] in the elements,
    towards the bit.

    mesh: of the string; around: the hole around its elements; fluid: constants.
    poisson: (n,) Poisson's ratio [-], 0 if stretch does not narrow the string.
    lateral: added mass, damping and rotational drag of the elements.
    flow_line: its outlet.
    held_at: (n+1, 3) positions of the nodes of a held string [m], None for a string that moves.
    """

    name = "annulus"
    spins = (0, 1)
    resizes = True  # areas follow the hole as well as directions

    def __init__(
        self,
        mesh: StringMesh,
        around: HoleAround,
        fluid: FluidConstants,
        poisson: FloatArray,
        lateral: LateralCoefficients,
        flow_line: FlowLine,
        held_at: FloatArray | None = None,
    ):
        super().__init__(mesh, fluid, poisson, held_at)
        self.annulus, self.well, self.moving_hole = around.sizes, around.well, around.moving
        self.lateral, self.flow_line = lateral, flow_line
        #: (3,) upper node at the last evaluation of the hole [m]
        self._top_place = np.zeros(3)
        #: volume [m3] of the hole above the upper node, its area [m2] and depth [m] there, at that evaluation, first in each
        self._top_hole = np.zeros(1), self.annulus.hole, np.zeros(1)
        self._swirl: Swirl | None = None  # of a string that may turn
        self._flow_at: IntArray | None = None  # see ``_present_flow``
        self._outer, self._hole = (
            self.annulus.outer_diameter,
            self.annulus.hole_diameter,
        )  # (n,) diameters [m] to which ``lateral`` belongs
        self._resized = np.zeros(
            len(self._hole), dtype=bool
        )  # at the last evaluation of the hole around elements
        self._leader: AnnulusFlow | None = None

    def _directions(self, well: Well, upper: FloatArray, lower: FloatArray) -> dict[str, FloatArray]:
        """Points of the axis [m] and tangents (k, 3) at both ends, at measured depths (k,) [m], and curvature (k, 3) in the
        middle [1/m]."""
        axis, tangents, bends = well.at(np.concatenate([upper, lower, 0.5 * (upper + lower)]))
        first, second, _ = np.split(tangents, 3)
        points = dict(zip(("axis1", "axis2"), np.split(axis, 3), strict=False))
        return {"tangent1": first, "tangent2": second, "bend": np.split(bends, 3)[2], **points}

    def _level(self, well: Well, upper: FloatArray, lower: FloatArray) -> FloatArray:
        """(k,) height of the axis of elements between measured depths (k,) [m], times gravity [m2/s2].

        It is the part that does not change along the mean tangent of the element.
        """
        axis, tangents, _ = well.at(np.concatenate([upper, lower]))
        along = sum(np.split(tangents, 2))
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        middle, g = 0.5 * sum(np.split(axis, 2)), self.fluid.gravity
        return middle @ g - (along @ g) * np.sum(along * middle, axis=1)

    def parameters(self, e: np.ndarray) -> Table:
        a, zero = self.annulus, np.zeros(len(e))
        own, above = a.hole - a.outer, np.maximum(e - 1, 0)
        return Parameters(
            "annulus_flow",
            len(e),
            **self._channel(e),
            step=np.where(e > 0, 0.5 * (1 / own[e] ** 2 - 1 / own[above] ** 2), 0.0),
            loss=zero,
            shoulder=self._shoulders(e, a.only(e), a.only(above)),
            control=np.where(e == 0, 1.0, 0.0),
            widening=zero,
            **self._by_place(e),
            **dict.fromkeys(("place1", "place2", "excess1", "excess2", "moment"), zero),
            **self._beside(e, self.well, self.mesh.upper[e]),
            bent=self._bent_on_axis(e),
        )

    def _beside(self, e: np.ndarray, well: Well, lower: FloatArray) -> dict[str, FloatArray]:
        """Direction of the hole at the upper ends of the rigid items above the elements ``e`` (k,), and the height of its axis
        beside them, as in ``_level``; their lower ends are at measured depths ``lower`` (k,) [m]."""
        upper = lower - self.mesh.rigid_above[e]
        return {"tangent0": well.at(upper)[1], "level_above": self._level(well, upper, lower)}

    def _bent_on_axis(self, e: np.ndarray) -> FloatArray:
        """BENT (k,) of the elements ``e`` (k,) with their nodes on the axis of the hole [m]."""
        m = self.mesh
        upper, directions = m.upper[e] - m.rigid_above[e], self._directions(self.well, m.upper[e], m.lower[e])
        (above, tangent0, _), below = self.well.at(upper), self.well.at(m.lower[e])[0]
        return self._bent(e, m.lower[e] - m.upper[e], above, below, directions | {"tangent0": tangent0})

    def _bent(
        self,
        e: np.ndarray,
        way: FloatArray,
        above: FloatArray,
        below: FloatArray,
        directions: dict[str, FloatArray],
    ) -> FloatArray:
        """BENT (k,) of elements whose nodes are at ``above`` and ``below`` (k, 3) with ``way`` (k,) of hole between them [m]."""
        # a joint's own length is that of its travel, along the mean direction
        joint = self.mesh.is_joint[e] & (self.mesh.rigid_above[e] == 0)
        mean = directions["tangent1"] + directions["tangent2"]
        mean = np.where(joint[:, None], mean / np.linalg.norm(mean, axis=1, keepdims=True), 0.0)
        first = np.sum(above * (directions["tangent0"] - mean), axis=1)
        return np.where(joint, 0.0, way) + first - np.sum(below * (directions["tangent2"] - mean), axis=1)

    @property
    def kernel(self) -> str:
        return super().kernel + ("_aside" if self.lateral.by_place is not None and not self.held else "")

    def _by_place(self, e: np.ndarray) -> dict[str, FloatArray]:
        """Parameters of the added mass by the place of the elements ``e`` (k,) in their holes."""
        outer, hole, by_place = self._outer[e], self._hole[e], self.lateral.by_place
        clearance = 0.5 * (hole - outer)
        return {
            "chi_by": np.zeros((len(e), 5)) if by_place is None else by_place(outer, hole),
            "clearance": clearance,
        }

    def _shoulders(self, e: np.ndarray, own: Annulus, above: Annulus) -> FloatArray:
        """Lift by the shoulders at the upper ends of the elements ``e`` (k,), with their annuli and those above."""
        m, over = self.mesh, np.maximum(e - 1, 0)
        arm = m.rigid_above > 0
        lift = own.shoulders(arm[e], m.is_joint[e], above, arm[over], m.is_joint[over])
        return np.where(e > 0, lift, 0.0)

    def _channel(self, e: np.ndarray) -> dict[str, FloatArray]:
        """Parameters of the elements ``e`` (k,) that do not depend on how the flow is discretised."""
        m, a, s, zero = self.mesh, self.annulus, self.lateral, np.zeros(len(e))
        return {
            **self._along(e),
            "outer": a.outer[e],
            "hole": a.hole[e],
            "outer_above": np.where(m.is_joint & (m.rigid_above == 0), 0.0, a.outer_above)[e],
            "hole_above": a.hole_around[e],
            "wall": a.wall[e],
            "diameter": a.outer_diameter[e],
            "gap": a.gap[e],
            "gap_above": a.gap_above[e],
            "chi": s.added[e],
            "damping": s.damping[e],
            "turning": s.turning[e],
            **dict.fromkeys(("share", "swirl", "swirl_rate", "spin_rate"), zero),
            **{name: value[e] for name, value in a.friction().items()},
            "controlled": zero,
            "level": self._level(self.well, m.upper[e], m.lower[e]),
        } | self._directions(self.well, m.upper[e], m.lower[e])

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        elements = super().blocks(part)
        for b in elements:
            b.remembers = self.moving_hole is not None
        if self.lateral.swirl.any() and not self.held:
            across_joint = self.mesh.is_joint & (self.mesh.rigid_above == 0)
            self._swirl = Swirl(np.where(across_joint, 0.0, self.lateral.swirl)[part.cells])
            for b in elements:
                self._swirl.attach(b, b.update)
            self._spins = MeanSpins(part.ends)
        if self.moving_hole is not None:
            around = self.moving_hole
            around.attach(np.asarray(part.vertices), self.annulus.hole[0])
            if self.resizes:
                self._top_hole = around.volume, around.area, around.depth
        if self.flow_line.choke:
            elements = (*elements, self._valve(part))
        if self.held:
            return elements
        _, vertices = local_vertices(part, np.array([0]))
        area = Parameters("annulus_top", len(vertices), outer=self.annulus.outer[0])
        return (
            *elements,
            ElementBlock(
                "annulus_top",
                "annulus_top",
                "vertex",
                vertices,
                (*VERTEX_SLOTS, ("annulus.pressure", 0)),
                (),
                area.array,
            ),
        )

    def _valve(self, part) -> ElementBlock:
        """The choke at the flow line, above the upper node of the annulus."""
        first = np.flatnonzero(part.cells == 0).astype(np.int32)
        slots: tuple[tuple[str, int], ...] = ("annulus.pressure", 0), ("annulus.flow", 1)
        if self.held:
            kernel, params = "choke", Parameters("choke", len(first), loss=self.flow_line.choke)
        else:
            kernel, slots = "moving_choke", (*VERTEX_SLOTS, *slots)
            params = Parameters(
                "moving_choke", len(first), loss=self.flow_line.choke, area=0.0, direction=np.zeros(3)
            )

        def update(t: float) -> None:
            if self._top is not None:
                block, row = self._top
                area = self._top_hole[1][0] - self.annulus.outer[0]
                params["area"], params["direction"] = area, block.named["tangent1"][row]

        valve = ElementBlock(
            kernel,
            kernel,
            "cell",
            first,
            slots,
            (),
            params.array,
            context=self.fluid.address,
            constants=self.fluid.constants,
            update=None if self.held else update,
        )
        valve.keep = (self.fluid,)
        return valve

    @property
    def _flow_line_head(self) -> float:
        """Pressure of the mud at the rotary table over that at the flow line [Pa]."""
        return float(-self.fluid.density * self.fluid.gravity[2] * self.flow_line.depth)

    def _update_of(self, block: ElementBlock):
        if self._top is None or self._top[0] is not block:
            return None
        row, controlled = self._top[1], block.named["controlled"]
        head = self._flow_line_head
        if self.held_at is not None:
            head += self.fluid.density * float(self.fluid.gravity @ self.held_at[0])

        def update(t: float) -> None:
            controlled[row] = self.flow_line.pressure.value(t) + head

        return update

    # ------------------------------------------------------------------ the hole at the string's position
    def forget_hole(self) -> None:
        if self.moving_hole is not None:
            self.moving_hole.forget()

    def locate_hole(self, state) -> None:
        """Evaluate the hole at the string's present position, before a run or in statics, with mud at rest."""
        if self._swirl is not None:
            self._swirl.stop()
        self._update_hole(state, False)

    def follow(self, leader: Component, state) -> None:
        assert isinstance(leader, AnnulusFlow)
        self._leader = leader
        if self.moving_hole is not None:
            self.moving_hole.leader = leader.moving_hole
        if self._swirl is not None and leader._swirl is not None:
            self._swirl.join(leader._swirl, self._spins, state)

    def accept_beside(self, t, others) -> None:
        hole, swirl = self.moving_hole, self._swirl
        if swirl is None or swirl.renewed or (hole is not None and hole.moved is not None):
            super().accept_beside(t, others)
        else:  # nothing but the swirl changes
            swirl.accept_beside(t)

    def settle(self, t, state) -> None:
        """Set the swirl of the mud to its steady value for the present spins."""
        if self._swirl is not None:
            self._swirl.start(t, self._spins(state))

    def _renew_following(self, swirl: Swirl, state) -> None:
        """Compute the rates at which the swirl follows, if the flow has changed."""
        following, e = self.lateral.following, self._part.cells
        if following is None:
            return
        places, values = self._present_flow(state)
        if swirl.follows_other_flow(places, values, OTHER_FLOW * self.fluid.usual_flow):
            outer, hole = self._outer[e], self._hole[e]
            swirl.flow[:] = np.where(places >= 0, values[places], 0.0)
            swirl.follow[:] = following(4 / np.pi * swirl.flow / (hole**2 - outer**2), outer, hole)

    def _present_flow(self, state) -> tuple[IntArray, FloatArray]:
        """Places (nc,) of the flow rates of the local elements in an array of values [m3/s], -1 for none; that array."""
        if self._flow_at is None:
            self._flow_at = np.full(len(self._part.cells), -1, dtype=np.int32)
            for b in self._blocks:
                self._flow_at[b.points] = state.index_of(b)[:, -1]
        return self._flow_at, state.x

    def accept(self, t, state) -> None:
        """Update the hole to the string's position after an accepted step."""
        self._update_hole(state, True)
        if self._swirl is not None:
            self._renew_following(self._swirl, state)
            self._swirl.accept(t, self._spins(state))

    def _update_hole(self, state, keep: bool) -> None:
        around = self.moving_hole
        if around is None or self.held:
            return
        moved = around.follow(state, keep)
        if moved is None:
            return
        if moved[0] and self._top is not None and self.resizes:
            # in place: records of steps have its address
            self._top_place[:] = state.x[state.layout.dofs["string.position"][0]]
        moved = moved[self._part.ends].any(axis=1)
        for b in self._blocks:
            rows = np.flatnonzero(moved[b.points])
            if len(rows):
                self._renew(b.named, rows, b.points[rows], around)

    def _renew(self, params: Table, rows: np.ndarray, cells: np.ndarray, around: MovingHole) -> None:
        """Parameters of the ``rows`` (k,) of a block, which are the local ``cells`` (k,)."""
        e, nodes, m = self._part.cells[cells], self._part.ends[cells], self.mesh
        ends, without_length = around.depth[nodes], m.is_joint & (m.rigid_above == 0)
        directions = self._directions(around.current_well(), ends[:, 0] + m.rigid_above[e], ends[:, 1])
        for name, value in directions.items():
            params[name][rows] = value
        params["level"][rows] = self._level(around.current_well(), ends[:, 0] + m.rigid_above[e], ends[:, 1])
        beside = self._beside(e, around.current_well(), ends[:, 0] + m.rigid_above[e])
        for name, value in beside.items():
            params[name][rows] = value
        if not self.resizes:
            return
        own, over = around.annulus(e, ends), np.maximum(e - 1, 0)
        other = around.annulus(
            over, np.column_stack([ends[:, 0] - m.length[over] - m.rigid_above[over], ends[:, 0]])
        )
        params["hole_above"][rows] = own.hole_around
        rigid = np.where(m.is_joint[e], 0.0, m.rigid_above[e])
        params["hole"][rows], params["widening"][rows] = around.sizes(
            nodes, without_length[e], rigid, own.hole_around
        )
        axis = directions["tangent1"] + directions["tangent2"]
        axis /= np.linalg.norm(axis, axis=1, keepdims=True)
        above, below = (around.places[end] for end in nodes.T)
        way = ends[:, 1] - ends[:, 0] - rigid
        params["bent"][rows] = self._bent(e, way, above, below, directions | beside)
        for k, end in enumerate(nodes.T, 1):
            params[f"place{k}"][rows] = np.sum(around.places[end] * axis, axis=1)
            # a hole being reamed is reread after every 0.2 mm, and its areas ahead include rings not yet cut
            fixed = without_length[e] | bool(around.reamers)
            params[f"excess{k}"][rows] = np.where(fixed, 0.0, around.area[end] - params["hole"][rows])
        # of a joint's travel, and of a hole that is being reamed, it is left out
        moment = around.hole.moment(ends[:, 0] + m.rigid_above[e], ends[:, 1])
        params["moment"][rows] = np.where(without_length[e] | bool(around.reamers), 0.0, moment)
        params["wall"][rows] = own.wall
        params["gap"][rows], params["gap_above"][rows] = own.gap, own.gap_above
        for name, value in own.friction().items():
            params[name][rows] = value
        params["step"][rows] = np.where(
            e > 0, 0.5 * (1 / (own.hole - own.outer) ** 2 - 1 / (other.hole - other.outer) ** 2), 0.0
        )
        params["shoulder"][rows] = self._shoulders(e, own, other)
        new = np.abs(own.hole_diameter - self._hole[e]) > OTHER_SIZE * self._hole[e]
        if self._leader is not None:
            new = self._leader._resized[e]
        self._resized[e] = new
        if new.any():
            s = around.lateral(own.only(new))
            self._hole[e[new]] = own.hole_diameter[new]
            for name, value in (("chi", s.added), ("damping", s.damping), ("turning", s.turning)):
                params[name][rows[new]] = value
            for name, value in self._by_place(e[new]).items():
                params[name][rows[new]] = value
            if self._swirl is not None:
                share = self._swirl.share
                share[cells[new]] = np.where(share[cells[new]] > 0, s.swirl, 0.0)

    # ------------------------------------------------------------------ motion across the hole
    def lateral_sizes(self) -> FloatArray:
        cells = self._part.cells
        return np.column_stack([self._outer[cells], self._hole[cells]])

    def set_lateral(self, added: FloatArray, damping: FloatArray) -> None:
        for b in self._blocks:
            b.named["chi"], b.named["damping"] = added[b.points], damping[b.points]

    def get_local_state(self) -> dict[str, FloatArray]:
        """State of the hole at the local nodes (nv, 7) and elements (nc, p), for a checkpoint.

        Empty for a uniform hole.
        """
        swirl = {} if self._swirl is None else {"cell": self._swirl.get_state()}
        around, part = self.moving_hole, self._part
        if around is None or self.held or not around.evaluated:
            return swirl
        hole = around.get_state()
        nodes = np.hstack([hole, np.tile(self._top_place, (len(hole), 1))])
        elements = np.zeros((len(part.cells), self._blocks[0].params.shape[1] + 1))
        for b in self._blocks:
            elements[b.points] = np.column_stack([b.params, self._hole[part.cells[b.points]]])
        return {"vertex": nodes, "cell": np.hstack([elements, *swirl.values()])}

    def set_local_state(self, saved: dict[str, FloatArray]) -> None:
        """Continue from the local part of ``get_local_state``."""
        if self._swirl is not None and saved:
            self._swirl.set_state(saved["cell"][:, -Swirl.STATE :])
        around, part = self.moving_hole, self._part
        if around is None or "vertex" not in saved:
            return
        around.set_state(saved["vertex"][:, :-3])
        for b in self._blocks:
            b.params[:], self._hole[part.cells[b.points]] = (
                saved["cell"][b.points, : b.params.shape[1]],
                saved["cell"][b.points, b.params.shape[1]],
            )
        if self._top is not None and self.resizes:
            self._top_place[:] = saved["vertex"][0, -3:]

    def breaks(self) -> tuple[float, ...]:
        return self.flow_line.pressure.breaks()

    def outflow(self, state) -> float | None:
        """Flow rate out of the flow line [m3/s] at present; None on ranks without the upper end."""
        flow = self.outflow_of(OneStep(state, 0.0))
        return None if flow is None else float(flow[0])

    # ------------------------------------------------------------------ of steps
    def _upper_speed_of(self, steps) -> FloatArray:
        """(k,) speed of the upper node along the hole [m/s], on the rank that has it."""
        _, velocity = self._upper_motion_of(steps)
        return np.asarray(np.sum(velocity * self._upper_direction_of(steps), axis=1))

    def _upper_direction_of(self, steps, name: str = "tangent1") -> FloatArray:
        """(k, 3) direction of the hole at the upper node, or the parameter ``name`` of the element there."""
        block, row = self._upper_element
        return np.asarray(steps.parameters(block, name, row))

    def _upper_area_of(self, steps) -> FloatArray:
        """(k,) area of the annulus at the upper node [m2], on the rank that has it."""
        return np.asarray(steps.numbers(self._top_hole[1], 0) - self.annulus.outer[0])

    def outflow_of(self, steps) -> FloatArray | None:
        """(k,) flow rate out of the flow line [m3/s] after each of k steps; None on ranks without the upper end.

        It is the flow out of the upper node, minus the volume that the hole between the node and the fixed
        flow line gains while the node moves down.
        """
        flow = self.upper_flow_of(steps)
        if flow is None:
            return None
        return np.asarray(-flow - self._upper_area_of(steps) * self._upper_speed_of(steps))

    def content_above_of(self, steps) -> Any:
        """(k,) volume between the upper node and the flow line [m3], up to a constant; 0 on ranks without the end."""
        if self._top is None or self.held:
            return 0.0
        place, _ = self._upper_motion_of(steps)
        way = place - steps.numbers(self._top_place, range(3))
        way = np.sum(way * self._upper_direction_of(steps), axis=1)
        volume, area, depth = (steps.numbers(a, 0) for a in self._top_hole)
        return volume + area * way - self.annulus.outer[0] * (depth + way)

    def _upper_head_of(self, steps) -> FloatArray:
        """(k,) weight of the mud above the upper node, at the hole's axis [Pa]: density times gravity times depth."""
        (place, _), gravity = self._upper_motion_of(steps), self.fluid.gravity
        if self.held:
            return np.asarray(self.fluid.density * (place @ gravity))
        mean = self._upper_direction_of(steps) + self._upper_direction_of(steps, "tangent2")
        mean /= np.sqrt(np.sum(mean * mean, axis=1))[:, None]
        level = self._upper_direction_of(steps, "level")
        return np.asarray(self.fluid.density * ((mean @ gravity) * np.sum(place * mean, axis=1) + level))

    def powers_of(self, steps) -> tuple[Any, Any]:
        supplied: Any = 0.0
        flow = self.upper_flow_of(steps)
        if flow is not None:
            pressure, speed = self.upper_pressure_of(steps), self._top_result_of(steps, SPEED)
            along, kinetic = self._upper_speed_of(steps), 0.5 * self.fluid.density
            head = self._upper_head_of(steps)
            supplied = flow * (self.fluid.enthalpy(pressure) + kinetic * (speed + along) ** 2 - head)
            # the upper end of the channel moves with the string, against the pressure there
            supplied = supplied + pressure * self._upper_area_of(steps) * along
        return self._channel_powers_of(steps, supplied)

    def _string_speed(self, block: ElementBlock, rows: np.ndarray, state) -> FloatArray:
        if self.held:
            return np.zeros(len(rows))
        velocity, p = state.y[state.index_of(block)[rows, 7:10]], block.named  # of the lower node
        return np.asarray(np.sum(velocity * p["tangent2"][rows], axis=1))
