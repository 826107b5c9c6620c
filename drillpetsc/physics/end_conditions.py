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
from drillpetsc.geometry.frames import Frames, high_side
from drillpetsc.kernels.parameters import Parameters
from drillpetsc.physics.interfaces import Drive, Top
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices


class Input(Protocol):
    """A quantity over time (drillpetsc.time_function)."""

    def value(self, t: float) -> float: ...
    def rate(self, t: float) -> float: ...
    def integral(self, t: float) -> float: ...
    def breaks(self) -> tuple[float, ...]: ...


def _axes(tangent: FloatArray) -> FloatArray:
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


class FixedEnd(Top):
    """Fixed end: clamped (position, direction, spin) or pinned (position).

    vertex: its node; kind: ``clamped`` or ``pinned``.
    position: (3,) [m]; tangent: (3,) unit.
    spin: the spin angle is fixed at ``angle`` [rad].
    """

    name = "held_end"

    def __init__(
        self,
        vertex: int,
        kind: str,
        position: FloatArray,
        tangent: FloatArray,
        spin: bool = True,
        angle: float = 0.0,
    ):
        axes = _axes(tangent)
        D = _rows(axes, axes[1:] if kind == "clamped" else axes[:0], spin)
        self.anchor = target = D @ np.concatenate([position, tangent, [angle]])
        still = np.zeros(len(D))
        tilt = ("side_moment_1", "side_moment_2") if kind == "clamped" else ()
        names = (
            "axial_reaction",
            "side_reaction_1",
            "side_reaction_2",
            *tilt,
            *(("torque_reaction",) if spin else ()),
        )
        where = "top" if vertex == 0 else "bottom"
        self._condition = PrescribedMotion(
            vertex, D, lambda t: target, lambda t: still, tuple(f"{where}.{n}" for n in names)
        )

    def shift(self, distance: float) -> None:
        """Move the axial position by ``distance`` [m], down positive."""
        self.anchor[0] += distance

    def prescribed(self) -> tuple[PrescribedMotion, ...]:
        return (self._condition,)


class TopDrive(Top):
    """Prescribed rotation and lowering of the top node; the replaced rows are hook load and surface torque.

    position: (3,) [m] and tangent: (3,) unit, at time 0; angle: spin angle at time 0 [rad].
    rotation: over time [rad/s]; None: the spin is free (``driven``).
    lowering: over time [m/s]; None: the axial position is free, and a load prescribes the force.
    """

    name = "top_drive"

    def __init__(
        self,
        position: FloatArray,
        tangent: FloatArray,
        rotation: Input | None,
        lowering: Input | None,
        angle: float = 0.0,
    ):
        axes = _axes(tangent)
        self.inputs = tuple(i for i in (rotation, lowering) if i is not None)
        D = _rows(axes if lowering is not None else axes[1:], axes[1:], rotation is not None)
        self.anchor = start = D @ np.concatenate([position, tangent, [angle]])
        self._axial = axial = np.zeros(len(D))
        spin = np.zeros(len(D))
        if lowering is not None:
            axial[0] = 1.0
        if rotation is not None:
            spin[-1] = 1.0
        zero = _Zero()
        down, turn = lowering or zero, rotation or zero
        names = (
            ["top.axial_reaction"] * (lowering is not None)
            + ["top.side_reaction_1", "top.side_reaction_2", "top.side_moment_1", "top.side_moment_2"]
            + ["top.torque_reaction"] * (rotation is not None)
        )
        self._condition = PrescribedMotion(
            0,
            D,
            lambda t: start + axial * down.integral(t) + spin * turn.integral(t),
            lambda t: axial * down.value(t) + spin * turn.value(t),
            tuple(names),
        )

    def prescribed(self) -> tuple[PrescribedMotion, ...]:
        return (self._condition,)

    def shift(self, distance: float) -> None:
        """Move the axial position by ``distance`` [m], down positive."""
        self.anchor += distance * self._axial

    def breaks(self) -> tuple[float, ...]:
        return tuple(b for i in self.inputs for b in i.breaks())


class _Zero:
    def value(self, t: float) -> float:
        return 0.0

    rate = integral = value


class RotaryDrive(Drive):
    """Rotary drive with spring [N m/rad], damper [N m s/rad] and rotor inertia [kg m2] at the top node."""

    name = "drive"

    def __init__(self, rotation: Input, stiffness: float, damping: float, inertia: float, angle: float = 0.0):
        self.rotation, self.angle = rotation, angle
        self.constants = (stiffness, damping, inertia)

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([0]))
        k, c, inertia = self.constants
        params = Parameters(
            "drive", len(vertices), stiffness=k, damping=c, inertia=inertia, angle=0.0, speed=0.0
        )
        angle, speed = params["angle"], params["speed"]

        def update(t: float) -> None:
            angle[:] = self.angle + self.rotation.integral(t)
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
        error = self.angle + self.rotation.integral(t) - state.x[here]
        return float(k * error + c * (self.rotation.value(t) - state.y[here]))

    def energies(self, t: float, state) -> Energies:
        if not len(self._block.points):
            return Energies()
        here = state.layout.index(self._block)[0, 6]
        k, c, inertia = self.constants
        error = self.angle + self.rotation.integral(t) - state.x[here]
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
    """

    node: int
    force: tuple[float, float, float] = (0.0, 0.0, 0.0)
    moment: tuple[float, float, float] = (0.0, 0.0, 0.0)
    slope: tuple[float, float, float] = (0.0, 0.0, 0.0)
    section: bool = False
    factor: Callable[[float], float] | None = None


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

    def __init__(self, loads: tuple[NodeLoad, ...], frames: Frames, breaks: tuple[float, ...] = ()):
        self.loads, self.frames, self._breaks = loads, frames, breaks
        self.conservative = not any(load.section or any(load.moment) for load in loads)

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        chosen, vertices = local_vertices(part, np.array([q.node for q in self.loads]))
        on_rank = [self.loads[k] for k in chosen]
        nodes = np.array([q.node for q in on_rank], dtype=int)
        params = Parameters(
            "load",
            len(on_rank),
            **load_rows(on_rank),
            reference=self.frames.reference[nodes],
            second=self.frames.second_director[nodes],
            factor=1.0,
        )
        now = params["factor"]
        timed = [(i, q.factor) for i, q in enumerate(on_rank) if q.factor is not None]

        def update(t: float) -> None:
            for i, factor in timed:
                now[i] = factor(t)

        self._block = ElementBlock(
            "loads",
            "load",
            "vertex",
            vertices,
            VERTEX_SLOTS,
            (0,),
            params.array,
            update=update if timed else None,
        )
        self._nodes = nodes
        return (self._block,)

    def update_reference_frames(self) -> None:
        p = self._block.named
        p["reference"], p["second"] = (
            self.frames.reference[self._nodes],
            self.frames.second_director[self._nodes],
        )

    def breaks(self) -> tuple[float, ...]:
        return self._breaks

    def powers(self, t: float, state) -> Powers:
        return Powers(supplied=-state.power(self._block, t))
