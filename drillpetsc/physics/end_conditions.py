"""End conditions of the string (clamped, pinned, free, top drive, driven), and loads at points or along the string.

Manual: sec-joints-prescribed.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock, Energies, Powers, PrescribedMotion
from drillpetsc.geometry.frames import Frames, high_side, smallest_rotation
from drillpetsc.kernels.parameters import Parameters
from drillpetsc.physics.hole_path import HolePath, PathPoint
from drillpetsc.physics.interfaces import Drive, Top
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices
from drillpetsc.time_function import Constant


class Input(Protocol):
    """A quantity over time (drillpetsc.time_function)."""

    def value(self, t: float) -> float: ...
    def rate(self, t: float) -> float: ...
    def integral(self, t: float) -> float: ...
    def breaks(self) -> tuple[float, ...]: ...


def axes_of(tangent: FloatArray) -> FloatArray:
    """Return (3, 3) rows: the tangent and two unit vectors across it."""
    side = high_side(tangent)
    return np.array([tangent, side, np.cross(tangent, side)])


def _rows(position: FloatArray, tangent: FloatArray, spin: bool) -> FloatArray:
    """Form the directions D (m, 7): rows of ``position`` act on r, of ``tangent`` on v.

    The spin angle is last.
    """
    m = len(position) + len(tangent) + spin
    D = np.zeros((m, 7))
    D[: len(position), :3] = position
    D[len(position) : len(position) + len(tangent), 3:6] = tangent
    if spin:
        D[-1, 6] = 1.0
    return D


@dataclass(frozen=True)
class EndPlace:
    """Where an end of the string is at time 0.

    position: (3,) [m]; tangent: (3,) unit.
    vertex: its node, 0 at the top; angle: spin angle [rad].
    path, frames: centreline along which the end moves, and the string's frames; None: its tangent.
    """

    position: FloatArray
    tangent: FloatArray
    vertex: int = 0
    angle: float = 0.0
    path: HolePath | None = None
    frames: Frames | None = None


class PathEnd(Top):
    """End whose prescribed position lies on a path: the centreline of the hole, or a straight line.

    A straight path keeps its directions D (m, 7), and the values are ``anchor`` (m,) plus the motion.  On a
    curved path (manual: sec-prescribed-path) ``anchor`` (4,) is the measured depth [m], the offsets from the
    centreline along both normals [m] and the angle of the section about the tangent [rad], all at time 0.

    The axial position is prescribed if ``axial``, the position across if ``across``, the slope's direction if
    ``tilt``, the spin if ``spin``.  Without ``across`` there is no ``axial`` either.
    """

    def __init__(
        self,
        place: EndPlace,
        *,
        axial: bool,
        across: bool = True,
        tilt: bool,
        spin: bool,
        rotation: Input | None = None,
        lowering: Input | None = None,
    ):
        zero, position, tangent, angle = Constant(0.0), place.position, place.tangent, place.angle
        vertex, path, frames = place.vertex, place.path, place.frames
        self._down, self._turn = lowering or zero, rotation or zero
        self.inputs = tuple(i for i in (rotation, lowering) if i is not None)
        self._axial_row, self._across, self._tilt, self._spin = axial, across, tilt, spin
        self._path, self._frames, self._vertex = path, frames, vertex
        axes = axes_of(tangent)
        where = "top" if vertex == 0 else "bottom"
        names = (
            ["axial_reaction"] * axial
            + ["side_reaction_1", "side_reaction_2"] * across
            + ["side_moment_1", "side_moment_2"] * tilt
            + ["torque_reaction"] * spin
        )
        D = _rows(self._position_rows(axes), axes[1:] if tilt else axes[:0], spin)
        along = np.zeros(len(D))
        along[:1] = float(axial)
        start = D @ np.concatenate([position, tangent, [angle]])
        if path is not None:
            start = np.append(path.coordinates(position), angle)
        self.anchor = start
        self.depth = (
            float(start[0]) if len(start) else 0.0
        )  # measured depth of the last evaluation on a path [m]
        down, turn, self._first_row = self._down, self._turn, along

        def moved(rows: FloatArray, along: float, about: float) -> FloatArray:
            # every step needs it: two sums instead of seven arrays
            if axial:
                rows[0] += along
            if spin:
                rows[-1] += about
            return rows

        self._condition = PrescribedMotion(
            vertex,
            D,
            lambda t: moved(start.copy(), down.integral(t), turn.integral(t)),
            lambda t: moved(np.zeros(len(D)), down.value(t), turn.value(t)),
            tuple(f"{where}.{n}" for n in names),
            along_path=None if path is None else self._at,
            advance=None if path is None else self._advance,
            spin_reference=frames.reference[vertex] if spin and not tilt and frames is not None else None,
            constant=rotation is None and lowering is None and path is None,
            inputs=(down, turn),
        )

    def _position_rows(self, axes: FloatArray) -> FloatArray:
        """Directions in which the position is prescribed, of the (3, 3) axes of the path."""
        return axes if self._axial_row else axes[1:] if self._across else axes[:0]

    def _spin_about_reference(self, here: PathPoint) -> float:
        """Compute the spin angle [rad] of a section whose first director is the path's first normal."""
        assert self._frames is not None
        t = here.axes[0]
        a, b = self._frames.reference[self._vertex], self._frames.second_director[self._vertex]
        one = smallest_rotation(a, t, b)
        return float(np.arctan2(here.axes[1] @ np.cross(t, one), here.axes[1] @ one))

    def _at(
        self, t: float, x: FloatArray, y: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Compute directions (m, 7), values and rates (m,) at the time ``t`` [s]; x, y: (7,) unknowns and rates."""
        assert self._path is not None
        s0, *offset, angle = self.anchor
        speed = 0.0
        if self._axial_row:
            depth, speed = s0 + self._down.integral(t), self._down.value(t)
        else:
            depth = self._path.depth_of(x[:3])
        self.depth = depth
        here = self._path.at(depth)
        axes, place = here.axes, here.centre + offset @ here.axes[1:]
        if not self._axial_row and y is not None:
            speed = float(axes[0] @ y[:3] / (1 - here.curvature @ (place - here.centre)))
        D = _rows(self._position_rows(axes), axes[1:] if self._tilt else axes[:0], self._spin)
        spin = angle + self._turn.integral(t) + self._spin_about_reference(here) if self._spin else 0.0
        value = D @ np.concatenate([place, axes[0], [spin]])
        rate = D @ np.concatenate(
            [
                speed * (1 - here.curvature @ (place - here.centre)) * axes[0],
                speed * (axes[0] @ x[3:6]) * here.curvature,
                [self._turn.value(t)],
            ]
        )
        return D, value, rate

    def _advance(self, x: FloatArray) -> FloatArray:
        """Change (7,) of the unknowns ``x`` (7,) by the measured depth of the end."""
        assert self._path is not None and self._frames is not None
        here = self._path.at(self._path.depth_of(x[:3]))
        v = x[3:6]
        n, a = np.linalg.norm(v), self._frames.reference[self._vertex]
        turn = n * here.curvature
        transport = float(np.cross(v, a) @ turn / (n * (n + v @ a)))
        return np.concatenate(
            [(1 - here.curvature @ (x[:3] - here.centre)) * here.axes[0], turn, [-transport]]
        )

    def prescribed(self) -> tuple[PrescribedMotion, ...]:
        return (self._condition,)

    @property
    def on_path(self) -> bool:
        return self._path is not None

    def prescribed_position(self) -> FloatArray:
        assert self._path is not None
        return self._path.position(self.anchor[:3])

    def shift(self, distance: float) -> None:
        """Move the axial position by ``distance`` [m], down positive."""
        if self._path is None:
            self.anchor += distance * self._first_row
        elif self._axial_row:
            self.anchor[0] += distance

    def displace(self, offset: FloatArray) -> None:
        if self._path is None:
            super().displace(offset)
        else:
            self.anchor[1:3] += self._path.at(self.anchor[0]).axes[1:] @ offset

    def place_across(self, position: FloatArray) -> None:
        if self._path is not None:
            self.anchor[1:3] = self._path.coordinates(position)[1:]
        elif self._across:
            rows = slice(int(self._axial_row), int(self._axial_row) + 2)
            self.anchor[rows] = self._condition.directions[rows, :3] @ position

    def align(self, position: FloatArray, slope: FloatArray, spin: FloatArray) -> None:
        if self._path is None:
            super().align(position, slope, spin)
            return
        self.anchor[:3] = self._path.coordinates(position)
        here = self._path.at(float(self.anchor[0]))
        self.anchor[3] = spin[0] - self._spin_about_reference(here)

    def breaks(self) -> tuple[float, ...]:
        return tuple(b for i in self.inputs for b in i.breaks())


class FixedEnd(PathEnd):
    """Fixed end: clamped (position, direction, spin) or pinned (position; at the top also spin).

    kind: ``clamped`` or ``pinned``; spin: the spin angle is fixed.  ``shift`` moves the end along its path.
    """

    name = "held_end"

    def __init__(self, place: EndPlace, kind: str, spin: bool = True):
        super().__init__(place, axial=True, tilt=kind == "clamped", spin=spin)


class TopDrive(PathEnd):
    """Prescribed rotation and lowering of the top node; the replaced rows are hook load and surface torque.

    rotation: over time [rad/s]; None: the spin is free (``driven``).
    lowering: over time [m/s]; None: the axial position is free, and a load prescribes the force.
    hinged: the direction of the string is free.
    guided: the position across the path is prescribed; otherwise lowering is None.
    """

    name = "top_drive"

    def __init__(
        self,
        place: EndPlace,
        rotation: Input | None,
        lowering: Input | None,
        hinged: bool = False,
        guided: bool = True,
    ):
        super().__init__(
            place, axial=lowering is not None, across=guided, tilt=not hinged,
            spin=rotation is not None, rotation=rotation, lowering=lowering,
        )  # fmt: skip


class RotaryDrive(Drive):
    """Rotary drive with spring [N m/rad], damper [N m s/rad] and rotor inertia [kg m2] at the top node."""

    name = "drive"

    def __init__(self, rotation: Input, stiffness: float, damping: float, inertia: float):
        self.rotation = rotation
        self.constants = (stiffness, damping, inertia)

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([0]))
        k, c, inertia = self.constants
        params = Parameters(
            "drive", len(vertices), stiffness=k, damping=c, inertia=inertia, angle=0.0, speed=0.0
        )
        angle, speed = params["angle"], params["speed"]

        def update(t: float) -> None:
            angle[:] = self.rotation.integral(t)
            speed[:] = self.rotation.value(t)

        self._block = ElementBlock(
            "drive", "drive", "vertex", vertices, VERTEX_SLOTS, (0,), params.array, update=update
        )
        return (self._block,)

    def breaks(self) -> tuple[float, ...]:
        return self.rotation.breaks()

    def torque(self, t: float, state) -> float:
        """Compute the torque of the drive on the string [N m], zero on ranks without the top.

        Manual: eq-prescribed-drive.
        """
        if not len(self._block.points):
            return 0.0
        here = state.layout.index(self._block)[0, 6]
        k, c, _ = self.constants
        error = self.rotation.integral(t) - state.x[here]
        return float(k * error + c * (self.rotation.value(t) - state.y[here]))

    def energies(self, t: float, state) -> Energies:
        if not len(self._block.points):
            return Energies()
        here = state.layout.index(self._block)[0, 6]
        k, c, inertia = self.constants
        error = self.rotation.integral(t) - state.x[here]
        return Energies(kinetic=0.5 * inertia * state.y[here] ** 2, strain=0.5 * k * error**2)

    def powers(self, t: float, state) -> Powers:
        if not len(self._block.points):
            return Powers()
        slip = self.rotation.value(t) - state.y[state.layout.index(self._block)[0, 6]]
        return Powers(self.constants[1] * slip**2, self.torque(t, state) * self.rotation.value(t))


@dataclass(frozen=True)
class NodeLoad:
    """Load at a node.

    force: (3,) [N]; moment: (3,) [N m].
    slope: (3,) dead load on the slope [N m], part of a load along the elements.
    section: components are along (tangent, director 2, director 3) instead of global axes.
    factor(t): factor over time [s], None: 1.
    cell: number of the element along which a distributed load acts; -1: the load acts at the node.
    """

    node: int
    force: tuple[float, float, float] = (0.0, 0.0, 0.0)
    moment: tuple[float, float, float] = (0.0, 0.0, 0.0)
    slope: tuple[float, float, float] = (0.0, 0.0, 0.0)
    section: bool = False
    factor: Callable[[float], float] | None = None
    cell: int = -1


def local_loads(part, loads: tuple[NodeLoad, ...]) -> tuple[list[NodeLoad], np.ndarray, np.ndarray]:
    """Find the ``loads`` of a rank: at nodes that it owns, and along elements that it has.

    Returns them, their local vertices and their local elements (-1: none), as int32.
    """
    vertex = {int(v): i for i, v in enumerate(part.vertices)}
    cell = {int(c): i for i, c in enumerate(part.cells)}
    found = [
        (q, vertex[q.node], cell.get(q.cell, -1))
        for q in loads
        if (q.cell in cell if q.cell >= 0 else q.node in vertex and part.owned[vertex[q.node]])
    ]
    vertices, cells = (np.array([row[k] for row in found], dtype=np.int32) for k in (1, 2))
    return [row[0] for row in found], vertices, cells


def load_rows(loads: list[NodeLoad]) -> dict[str, FloatArray]:
    """Force, moment and slope (n, 3), and section (n,), by the names of the kernels' parameters."""
    values = {
        name: np.array([getattr(q, name) for q in loads], dtype=float).reshape(-1, 3)
        for name in ("force", "moment", "slope")
    }
    return values | {"section": np.array([q.section for q in loads], dtype=float)}


class Loads(Component):
    """Forces and moments on nodes."""

    name = "loads"
    #: kernel, slots and ends with spins
    _element: tuple[str, tuple[tuple[str, int], ...], tuple[int, ...]] = ("load", VERTEX_SLOTS, (0,))

    def __init__(self, loads: tuple[NodeLoad, ...], frames: Frames, breaks: tuple[float, ...] = ()):
        self.loads, self.frames, self._breaks = loads, frames, breaks
        self.conservative = not any(load.section or any(load.moment) for load in loads)

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        on_rank, vertices, cells = local_loads(part, self.loads)
        self._nodes = np.array([q.node for q in on_rank], dtype=int)
        kernel, slots, spins = self._element
        params = Parameters(kernel, len(on_rank), **load_rows(on_rank), **self._axes(), factor=1.0)
        now = params["factor"]
        timed = [(i, q.factor) for i, q in enumerate(on_rank) if q.factor is not None]

        def update(t: float) -> None:
            for i, factor in timed:
                now[i] = factor(t)

        self._block = ElementBlock(
            "loads",
            kernel,
            "vertex",
            vertices,
            slots,
            spins,
            params.array,
            update=update if timed else None,
            elements=cells,
        )
        return (self._block,)

    def _axes(self) -> dict[str, FloatArray]:
        """Reference directions and second directors (n, 3) at the loads, by the names of the kernel's parameters."""
        nodes = self._nodes
        return {"reference": self.frames.reference[nodes], "second": self.frames.second_director[nodes]}

    def update_reference_frames(self) -> None:
        self._block.named.update(self._axes())

    def breaks(self) -> tuple[float, ...]:
        return self._breaks

    def powers(self, t: float, state) -> Powers:
        return Powers(supplied=-state.power(self._block, t))
