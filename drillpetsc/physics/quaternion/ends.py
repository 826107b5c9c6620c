"""Ends and loads of the quaternion string: constraints with multipliers, which are the reactions.

Kernel: kernels/quaternion/quaternion_ends.cpp.  Manual: sec-quaternion-constraints.
"""

from __future__ import annotations

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import ElementBlock, Field, Powers
from drillpetsc.geometry.frames import smallest_rotation
from drillpetsc.kernels.parameters import Parameters
from drillpetsc.physics.end_conditions import EndPlace, Input, Loads, axes_of
from drillpetsc.physics.hole_path import HolePath, PathPoint
from drillpetsc.physics.interfaces import Top
from drillpetsc.physics.quaternion.beam import (
    LEVELS,
    NODE_SLOTS,
    ROW_SCALE,
    UNCONTROLLED_SCALE,
    QuaternionBeam,
    as_quaternion,
    minimal_rotation,
    product,
    spun,
    turned,
)
from drillpetsc.physics.rigid_bodies import local_vertices

_POSITION_NAMES = ("axial_reaction", "side_reaction_1", "side_reaction_2")
_ROTATION_NAMES = (
    "torque_reaction",
    "side_moment_1",
    "side_moment_2",
)  # about the tangent, and about the section's two axes


class ConstrainedEnd(Top):
    """End with prescribed position and orientation: clamped, pinned, or moved by a top drive.

    beam: gives the number of nodes, the orientation (4,) at time 0 and the form of the constraints.
    place: of the end, which moves along the path or, without one, along its tangent.  On a path ``anchor`` (4,) is the
    measured depth [m], the offsets along both normals [m] and the angle [rad] at time 0.
    prescribed_positions: number of prescribed positions: 3 along the tangent and across, 2 across only (the axial force is
    a load).
    prescribed_rotations: number of prescribed rotations: 3 the section, 1 its spin about the tangent, 0 none (manual:
    eq-quat-orientation).
    lowering [m/s], rotation [rad/s]: over time, None: at rest.
    """

    name = "guided_end"
    has_constraints = True

    def __init__(
        self,
        beam: QuaternionBeam,
        place: EndPlace,
        prescribed_positions: int,
        prescribed_rotations: int,
        lowering: Input | None = None,
        rotation: Input | None = None,
    ):
        position, tangent, path = place.position, place.tangent, place.path
        self.vertex, self.nodes, self.constraint = place.vertex, beam.mesh.nodes, beam.constraint
        self.prescribed_positions, self.prescribed_rotations = prescribed_positions, prescribed_rotations
        self.inputs, self._orientation = (lowering, rotation), beam.start[place.vertex]
        self._axes = axes_of(tangent)[3 - prescribed_positions :]
        self.anchor = np.append(self._axes @ position, 0.0)  # positions [m] and angle [rad] at time 0
        # without an axial position the end does not move along a path
        self._path = path if prescribed_positions == 3 else None
        self._start_axes = axes_of(tangent) if path is None else path.at(path.depth_of(position)).axes
        if self._path is not None:
            self.anchor = np.append(self._path.coordinates(position), 0.0)
        self._where = "top" if place.vertex == 0 else "bottom"
        self.restores_constraints = beam.constraint == "stabilized"
        self.names = tuple(
            f"{self._where}.{n}"
            for n in (*_POSITION_NAMES[3 - prescribed_positions :], *_ROTATION_NAMES[:prescribed_rotations])
        )

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
                multiplier=True,
            ),
        )

    def regions(self) -> dict[str, np.ndarray]:
        """The node of the end."""
        return {self._where: np.arange(self.nodes) == self.vertex}

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([self.vertex]))
        slots = (("string.position", 0), ("string.quaternion", 0), (f"string.{self._where}_reaction", 0))
        kernel = f"guided_{self.prescribed_positions}{self.prescribed_rotations}"
        self._given = Parameters(
            kernel,
            len(vertices),
            level=LEVELS[self.constraint],
            scale=ROW_SCALE,
            axes=np.vstack([self._axes, np.zeros((3 - self.prescribed_positions, 3))]).ravel(),
            value=0.0,
            rate=0.0,
            goal=0.0,
            goal_rate=0.0,
        )
        self._value, self._rate, self._goal, self._goal_rate = (
            self._given[name] for name in ("value", "rate", "goal", "goal_rate")
        )
        self._block = ElementBlock(
            self.name, kernel, "vertex", vertices, slots, (), self._given.array, update=self._update
        )
        return (self._block,)

    def _update(self, t: float) -> None:
        if self._path is not None:
            self._update_on_path(self._path, t)
            return
        down, turn = self.inputs
        self._value[:, : self.prescribed_positions] = self.anchor[:-1]
        if down is not None:
            self._value[:, 0] += down.integral(t)
            self._rate[:, 0] = down.value(t)
        angle = self.anchor[-1] + (turn.integral(t) if turn is not None else 0.0)
        goal = turned(self._orientation, angle)
        self._goal[:] = goal
        self._goal_rate[:] = 0.5 * (turn.value(t) if turn is not None else 0.0) * spun(goal)

    def _update_on_path(self, path: HolePath, t: float) -> None:
        """Evaluate the prescribed motion at the time ``t`` [s] on a curved path (manual: sec-prescribed-path)."""
        down, turn = self.inputs
        s0, one, two, angle = self.anchor
        speed = down.value(t) if down is not None else 0.0
        spin = turn.value(t) if turn is not None else 0.0
        here = path.at(s0 + (down.integral(t) if down is not None else 0.0))
        self._axes = here.axes
        offset = one * here.axes[1] + two * here.axes[2]
        self._given["axes"] = here.axes.ravel()
        self._value[:] = here.axes @ (here.centre + offset)
        self._rate[:, 0] = speed * (1 - here.curvature @ offset)
        # the section turns with the path's normals, which differ from the smallest rotation by ``turned_by``
        angle += self._angle_of_normals(here) + (turn.integral(t) if turn is not None else 0.0)
        carried = product(minimal_rotation(self._start_axes[0], here.axes[0]), self._orientation)
        goal = turned(carried, angle)
        self._goal[:] = goal
        bend = as_quaternion(speed * np.cross(here.axes[0], here.curvature))
        self._goal_rate[:] = 0.5 * (product(bend, goal) + spin * spun(goal))

    def prescribed_position(self) -> FloatArray:
        """Return the prescribed position (3,) at time 0 [m]."""
        if self._path is not None:
            return self._path.position(self.anchor[:3])
        return self._axes.T @ self.anchor[: self.prescribed_positions]

    def constrain_positions(self, hold: bool) -> None:
        """The constraints on positions, whatever their form in motion: statics has no velocities."""
        self._given["level"] = 3.0 if hold else LEVELS[self.constraint]

    def align(self, position: FloatArray, slope: FloatArray, spin: FloatArray) -> None:
        """Prescribe at time 0 the given position (3,) [m] and spin angle (1,) [rad] from the frame at the start.

        The section has the direction of the path.
        """
        if self._path is None:
            self.anchor[:-1] = self._axes @ position
            self.anchor[-1] = spin[0]
            return
        self.anchor[:3] = self._path.coordinates(position)
        self.anchor[3] = spin[0] - self._angle_of_normals(self._path.at(float(self.anchor[0])))

    def _angle_of_normals(self, here: PathPoint) -> float:
        """Angle [rad] between the path's normals at ``here`` and the smallest rotation of the initial normals."""
        first, side, _ = self._start_axes
        carried = smallest_rotation(first, here.axes[0], side)
        about = np.cross(here.axes[0], carried)
        return float(np.arctan2(here.axes[1] @ about, here.axes[1] @ carried))

    def copy_position(self, other: Top) -> None:
        """Copy the prescribed position at time 0 from the top of another model with other elements."""
        n = self.prescribed_positions
        if self._path is not None:
            self.anchor[:3] = other.anchor[:3]
        elif other.on_path:
            self.anchor[:n] = self._axes @ other.prescribed_position()
        else:
            self.anchor[:n] = other.anchor[:n]

    @property
    def on_path(self) -> bool:
        return self._path is not None

    def shift(self, distance: float) -> None:
        """Move the axial position by ``distance`` [m], down positive."""
        if self.prescribed_positions == 3:
            self.anchor[0] += distance

    def breaks(self) -> tuple[float, ...]:
        return tuple(b for i in self.inputs if i is not None for b in i.breaks())

    def restore_constraints(self, state) -> None:
        """Set position and motion of the end to the prescribed ones at the time of the last residual.

        It is called after a solve in the stabilized form.
        """
        if len(self._block.points):
            index, n = state.index_of(self._block)[0], self.prescribed_positions
            goal, goal_rate = self._goal[0], self._goal_rate[0]
            r, q, axes = index[:3], index[3:7], self._axes
            state.x[r] += axes.T @ (self._value[0, :n] - axes @ state.x[r])
            state.y[r] += axes.T @ (self._rate[0, :n] - axes @ state.y[r])
            if self.prescribed_rotations == 3:
                state.x[q], state.y[q] = goal, goal_rate
            elif self.prescribed_rotations == 1:
                off = 2 * np.arctan2(spun(goal) @ state.x[q], goal @ state.x[q])
                state.x[q], state.y[q] = turned(state.x[q], -off), turned(state.y[q], -off)

    def balance_constraints(self, state, rows: FloatArray) -> None:
        """Balance the rows along the prescribed directions; the end has its prescribed position and direction."""
        if len(self._block.points):
            index = state.index_of(self._block)[0]
            axes = self._rotation_axes()
            change = np.concatenate([self._axes @ rows[index[:3]], 0.5 * axes @ rows[index[3:7]]])
            state.x[index[7:]] += change

    def _rotation_axes(self) -> FloatArray:
        """(prescribed rotations, 4) products of the prescribed orientation with the unit vectors of the section."""
        goal = self._goal[0]
        return np.array([spun(goal), _times_e2(goal), _times_e3(goal)])[: self.prescribed_rotations]

    # ------------------------------------------------------------------ results
    def reaction(self, name: str, state) -> float:
        """Return the reaction ``name`` on the string, a force [N] or a moment [N m].

        Zero on ranks without the end.
        """
        if name not in self.names or not len(self._block.points):
            return 0.0
        index = state.index_of(self._block)[0]
        multiplier = float(state.x[index[7 + self.names.index(name)]])
        if self.prescribed_rotations != 1 or not name.endswith("torque_reaction"):
            return multiplier
        # a section whose direction is free tilts by an angle b: the moment about the tangent is cos(b/2) of the multiplier
        return multiplier * abs(float(self._goal[0] @ state.x[index[3:7]]))

    def powers(self, t: float, state) -> Powers:
        if not len(self._block.points):
            return Powers()
        index, n = state.index_of(self._block)[0], self.prescribed_positions
        push, moment = np.split(state.x[index[7:]], [n])
        supplied = float(push @ self._axes @ state.y[index[:3]])
        return Powers(supplied=supplied + float(2 * moment @ self._rotation_axes() @ state.y[index[3:7]]))


def _times_e2(q: FloatArray) -> FloatArray:
    return np.array([-q[2], -q[3], q[0], q[1]])


def _times_e3(q: FloatArray) -> FloatArray:
    return np.array([-q[3], q[2], -q[1], q[0]])


class QuaternionLoads(Loads):
    """Forces and moments on nodes, whose section has its own axes."""

    _element = "quaternion_load", NODE_SLOTS, ()

    def _axes(self) -> dict[str, FloatArray]:
        return {}
