"""Ends and loads of the quaternion string: constraints with multipliers, which are the reactions.

Kernel: kernels/quaternion/quaternion_ends.cpp.  Manual: sec-quaternion-constraints.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock, Field, Powers
from drillpetsc.geometry.frames import high_side
from drillpetsc.physics.end_conditions import Input, NodeLoad
from drillpetsc.physics.interfaces import Top
from drillpetsc.physics.quaternion.beam import LEVELS, NODE_SLOTS, ROW_SCALE, UNCONTROLLED_SCALE, spun, turned
from drillpetsc.physics.rigid_bodies import local_vertices

_AXES, _VALUE, _RATE, _GOAL, _GOAL_RATE = (
    slice(2, 11),
    slice(11, 14),
    slice(14, 17),
    slice(17, 21),
    slice(21, 25),
)
_PLACES = ("axial_reaction", "side_reaction_1", "side_reaction_2")
_TURNS = (
    "torque_reaction",
    "side_moment_1",
    "side_moment_2",
)  # about the tangent, and about the section's two axes


class ConstrainedEnd(Top):
    """End with prescribed position and orientation: clamped, pinned, or moved by a top drive.

    vertex: its node; nodes: of the string.
    places: number of prescribed positions: 3 along the tangent and across, 2 across only (the axial force is
    a load).
    turns: number of prescribed rotations: 3 the section, 1 its spin about the tangent, 0 none (manual:
    eq-quat-orientation).
    position: (3,) [m]; orientation: (4,) unit quaternion; tangent: (3,) unit; all at time 0.
    constraint: as in ``QuaternionBeam``.
    lowering [m/s], rotation [rad/s]: over time, None: at rest.
    """

    name = "guided_end"
    has_constraints = True

    def __init__(
        self,
        vertex: int,
        nodes: int,
        places: int,
        turns: int,
        position: FloatArray,
        orientation: FloatArray,
        tangent: FloatArray,
        constraint: str,
        lowering: Input | None = None,
        rotation: Input | None = None,
    ):
        self.vertex, self.nodes, self.places, self.turns, self.constraint = (
            vertex,
            nodes,
            places,
            turns,
            constraint,
        )
        self.inputs, self._orientation = (lowering, rotation), orientation
        side = high_side(tangent)
        self._axes = np.array([tangent, side, np.cross(tangent, side)])[3 - places :]
        self.anchor = np.append(self._axes @ position, 0.0)  # positions [m] and angle [rad] at time 0
        self._where = "top" if vertex == 0 else "bottom"
        self.restores_constraints = constraint == "stabilized"
        self.names = tuple(f"{self._where}.{n}" for n in (*_PLACES[3 - places :], *_TURNS[:turns]))

    def fields(self) -> tuple[Field, ...]:
        name = f"string.{self._where}_reaction"
        return (
            Field(
                name,
                len(self.names),
                region=self._where,
                scale=UNCONTROLLED_SCALE,
                second_order=False,
                differential=False,
            ),
        )

    def regions(self) -> dict[str, np.ndarray]:
        """The node of the end."""
        return {self._where: np.arange(self.nodes) == self.vertex}

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([self.vertex]))
        params = np.zeros((len(vertices), 25))
        params[:, :2] = LEVELS[self.constraint], ROW_SCALE
        params[:, _AXES] = np.vstack([self._axes, np.zeros((3 - self.places, 3))]).ravel()
        slots = (("string.position", 0), ("string.quaternion", 0), (f"string.{self._where}_reaction", 0))
        kernel = f"guided_{self.places}{self.turns}"
        self._block = ElementBlock(
            self.name, kernel, "vertex", vertices, slots, (), params, update=self._update
        )
        return (self._block,)

    def _update(self, t: float) -> None:
        p, n = self._block.params, self.places
        down, turn = self.inputs
        p[:, _VALUE.start : _VALUE.start + n] = self.anchor[:-1]
        if down is not None:
            p[:, _VALUE.start] += down.integral(t)
            p[:, _RATE.start] = down.value(t)
        angle = self.anchor[-1] + (turn.integral(t) if turn is not None else 0.0)
        goal = turned(self._orientation, angle)
        p[:, _GOAL] = goal
        p[:, _GOAL_RATE] = 0.5 * (turn.value(t) if turn is not None else 0.0) * spun(goal)

    def constrain_positions(self, hold: bool) -> None:
        """In statics impose the constraints at position level for every ``constraint`` option."""
        self._block.params[:, 0] = 3.0 if hold else LEVELS[self.constraint]

    def copy_position(self, other: Top) -> None:
        """Copy the prescribed position at time 0 from the top of another model with other elements."""
        self.anchor[: self.places] = other.anchor[: self.places]

    def shift(self, distance: float) -> None:
        """Move the axial position by ``distance`` [m], down positive."""
        if self.places == 3:
            self.anchor[0] += distance

    def breaks(self) -> tuple[float, ...]:
        return tuple(b for i in self.inputs if i is not None for b in i.breaks())

    def restore_constraints(self, state) -> None:
        """Set position and motion of the end to the prescribed ones at the time of the last residual.

        It is called after a solve in the stabilized form.
        """
        if len(self._block.points):
            p, index, n = self._block.params[0], state.index_of(self._block)[0], self.places
            r, q, axes = index[:3], index[3:7], self._axes
            state.x[r] += axes.T @ (p[_VALUE][:n] - axes @ state.x[r])
            state.y[r] += axes.T @ (p[_RATE][:n] - axes @ state.y[r])
            if self.turns == 3:
                state.x[q], state.y[q] = p[_GOAL], p[_GOAL_RATE]
            elif self.turns == 1:
                off = 2 * np.arctan2(spun(p[_GOAL]) @ state.x[q], p[_GOAL] @ state.x[q])
                state.x[q], state.y[q] = turned(state.x[q], -off), turned(state.y[q], -off)

    # ------------------------------------------------------------------ results
    def reaction(self, name: str, state) -> float:
        """Return the reaction ``name`` on the string, a force [N] or a moment [N m].

        Zero on ranks without the end.
        """
        if name not in self.names or not len(self._block.points):
            return 0.0
        return float(state.x[state.index_of(self._block)[0, 7 + self.names.index(name)]])

    def powers(self, t: float, state) -> Powers:
        if not len(self._block.points):
            return Powers()
        index, n = state.index_of(self._block)[0], self.places
        push, moment = np.split(state.x[index[7:]], [n])
        goal, supplied = self._block.params[0, _GOAL], float(push @ self._axes @ state.y[index[:3]])
        axes = np.array([spun(goal), _times_e2(goal), _times_e3(goal)])[: self.turns]
        return Powers(supplied=supplied + float(2 * moment @ axes @ state.y[index[3:7]]))


def _times_e2(q: FloatArray) -> FloatArray:
    return np.array([-q[2], -q[3], q[0], q[1]])


def _times_e3(q: FloatArray) -> FloatArray:
    return np.array([-q[3], q[2], -q[1], q[0]])


class QuaternionLoads(Component):
    """Forces and moments on nodes."""

    name = "loads"

    def __init__(self, loads: tuple[NodeLoad, ...], breaks: tuple[float, ...] = ()):
        self.loads, self._breaks = loads, breaks
        self.conservative = not any(load.section or any(load.moment) for load in loads)

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        chosen, vertices = local_vertices(part, np.array([q.node for q in self.loads]))
        on_rank = [self.loads[k] for k in chosen]
        rows = [[*q.force, *q.moment, *q.slope, float(q.section), 1.0] for q in on_rank]
        params = np.ascontiguousarray(np.array(rows).reshape(-1, 11))
        timed = [(i, q.factor) for i, q in enumerate(on_rank) if q.factor is not None]

        def update(t: float) -> None:
            for i, factor in timed:
                params[i, 10] = factor(t)

        self._block = ElementBlock(
            "loads",
            "quaternion_load",
            "vertex",
            vertices,
            NODE_SLOTS,
            (),
            params,
            update=update if timed else None,
        )
        return (self._block,)

    def breaks(self) -> tuple[float, ...]:
        return self._breaks

    def powers(self, t: float, state) -> Powers:
        return Powers(supplied=-state.power(self._block, t))
