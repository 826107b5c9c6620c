"""Rotary steerable tools: pads that push the string, or a tilted shaft, towards a tool face fixed in space.

Kernel: kernels/tools/steering.hpp.  Manual: sec-steering.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import Component, ElementBlock, Powers
from drillpetsc.fem.quantity import Quantity
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames, tool_face_zero
from drillpetsc.geometry.well import Well
from drillpetsc.kernels.parameters import Parameters, constant
from drillpetsc.physics import quantities as declared
from drillpetsc.physics.beam import SLOTS
from drillpetsc.physics.rigid_bodies import VERTEX_SLOTS, local_vertices
from drillpetsc.time_function import TimeFunction

WINDOW, OVERLAP = constant("pad_window"), constant("pad_overlap")


@dataclass(frozen=True)
class Steer:
    """Command of the tool over time: share of its force or tilt [-], and tool face [rad]."""

    ratio: TimeFunction
    tool_face: TimeFunction

    @property
    def constant(self) -> bool:
        """Whether neither changes."""
        return not (self.ratio.breaks() or self.tool_face.breaks())


def mean_share() -> float:
    """Compute the mean force of three pads along the tool face over the force of one [-].

    It is (3/pi) int_0^(w+o) s(a) cos a da with the share s of a pad at the angle a; (3/pi) sin 60 deg = 0.827 for
    windows that change over at once.
    """
    from scipy.integrate import quad  # a slow import

    def share(a: float) -> float:
        u = min(max((WINDOW + OVERLAP - a) / (2 * OVERLAP), 0.0), 1.0)
        return u * u * (3 - 2 * u) * float(np.cos(a))

    whole = np.sin(WINDOW - OVERLAP)
    return float(3 / np.pi * (whole + quad(share, WINDOW - OVERLAP, WINDOW + OVERLAP)[0]))


class Steering(Component):
    """Base of rotary steerable tools: a direction fixed in space, about the axis of the hole.

    steer: the command.
    node: at which the hole's axis is taken; axis: (3,) unit direction of the hole there at the start.
    well: the hole, None without one: the axis stays.
    """

    name = "steering"
    update_size = 4
    _row = 0  # of the block, at which the hole's axis is taken
    _mine = False  # this rank has that row
    _block: ElementBlock

    def __init__(self, steer: Steer, node: int, axis: FloatArray, well: Well | None):
        self.steer, self.node, self._well = steer, node, well
        self._turn_axis(np.array(axis, dtype=float))

    def _turn_axis(self, axis: FloatArray) -> None:
        """Take ``axis`` (3,) as the direction of the hole; tool faces are measured from ``tool_face_zero``."""
        self.axis = axis
        self._zero = tool_face_zero(axis)
        self._right = np.cross(axis, self._zero)

    def _direction(self, t: float) -> FloatArray:
        """Unit vector (3,) of the commanded tool face at the time ``t`` [s]."""
        angle = self.steer.tool_face.value(t)
        return np.asarray(np.cos(angle) * self._zero + np.sin(angle) * self._right)

    def _command(self, t: float) -> None:
        """Put the command at the time ``t`` [s] into the parameters."""
        raise NotImplementedError

    def breaks(self) -> tuple[float, ...]:
        return (*self.steer.ratio.breaks(), *self.steer.tool_face.breaks())

    # ------------------------------------------------------------------ the hole's direction
    def follow_hole(self, well: Well) -> None:
        self._well = well if self._well is not None else None

    def local_update(self, state) -> FloatArray:
        """(4,) direction of the hole at the tool, and 1; zero on ranks without it."""
        now = np.zeros(4)
        if self._mine:
            now[:3], now[3] = self.axis, 1.0
            if self._well is not None:
                here = state.x[state.index_of(self._block)[self._row, :3]]
                depth = self._well.project(here[None, :]).md
                now[:3] = np.asarray(self._well.at(depth)[1])[0]
        return now

    def apply_update(self, total: FloatArray) -> None:
        """The direction of the command follows the hole between the steps."""
        self._turn_axis(total[:3] / np.linalg.norm(total[:3]))

    def get_state(self) -> dict[str, FloatArray]:
        return {"axis": self.axis.copy()}

    def set_state(self, state: dict[str, FloatArray]) -> None:
        self._turn_axis(np.array(state["axis"]))

    # ------------------------------------------------------------------ energy and outputs
    def powers(self, t: float, state) -> Powers:
        """The tool's actuators supply what its forces do on the string."""
        return Powers(supplied=-state.power(self._block, t))

    def share(self, t: float) -> float:
        """Commanded share of force or tilt [-] at the time ``t`` [s] on the rank with the tool, 0 elsewhere."""
        return self.steer.ratio.value(t) if self._mine else 0.0

    def tool_face(self, t: float) -> float:
        """Commanded tool face [rad] at the time ``t`` [s] on the rank with the tool, 0 elsewhere."""
        return self.steer.tool_face.value(t) if self._mine else 0.0


class PushTool(Steering):
    """Pads that push on the wall: a force on one node (manual: eq-steering-push).

    force: mean force at full command [N].
    rotating: three pads turn with the pipe, each acts in a window of 120 deg; else the force is constant in space.
    frames: of the nodes.
    """

    def __init__(
        self,
        steer: Steer,
        node: int,
        axis: FloatArray,
        well: Well | None,
        force: float,
        rotating: bool,
        frames: Frames,
    ):
        super().__init__(steer, node, axis, well)
        self.force, self.rotating, self.frames = force, rotating, frames
        self._turning = rotating  # the pads act in turn, not by their mean
        self._pad = force / mean_share() if rotating else 0.0

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        _, vertices = local_vertices(part, np.array([self.node]))
        self._mine = bool(len(vertices))
        self.params = Parameters(
            "push_pads",
            len(vertices),
            force=0.0,
            pad=0.0,
            towards=0.0,
            reference=self.frames.reference[self.node],
            second=self.frames.second_director[self.node],
        )
        self._block = ElementBlock(
            "steering",
            "push_pads",
            "vertex",
            vertices,
            VERTEX_SLOTS,
            (0,),
            self.params.array,
            update=self._command,
        )
        return (self._block,)

    def _command(self, t: float) -> None:
        towards, share = self._direction(t), self.steer.ratio.value(t)
        self.params["towards"] = towards
        self.params["pad"] = share * self._pad if self._turning else 0.0
        self.params["force"] = 0.0 if self._turning else share * self.force * towards

    def update_reference_frames(self) -> None:
        self.params["reference"] = self.frames.reference[self.node]
        self.params["second"] = self.frames.second_director[self.node]

    def impose_sliding_direction(
        self, axial: float, spin: float, side: float = 1.0, motor: float = 0.0
    ) -> None:
        self._turning = False

    def release_sliding_direction(self) -> None:
        self._turning = self.rotating

    def copy_sliding_direction(self, other: PushTool) -> None:
        self._turning = other._turning

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.STEERING_PUSH


class PointTool(Steering):
    """A shaft that is tilted towards the tool face while it turns (manual: eq-steering-point).

    tilt: angle at full command [rad]; cells: elements over which it is distributed; weights: (k,) their shares.
    """

    def __init__(
        self,
        steer: Steer,
        axis: FloatArray,
        well: Well | None,
        tilt: float,
        cells: np.ndarray,
        weights: FloatArray,
        mesh: StringMesh,
    ):
        super().__init__(steer, int(cells[0]), axis, well)
        self.tilt, self.cells = tilt, cells
        self._ei = mesh.bending_stiffness[cells]
        self._couple = self._ei * tilt * weights / mesh.length[cells]

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        place = {int(c): i for i, c in enumerate(part.cells)}
        chosen = [k for k, c in enumerate(self.cells) if int(c) in place]
        points = np.array([place[int(self.cells[k])] for k in chosen], dtype=np.int32)
        self._mine = 0 in chosen
        self._row = chosen.index(0) if self._mine else 0
        self._here = self._couple[chosen]
        self._stiffness = self._ei[chosen]
        self.params = Parameters("point_tilt", len(points), couple=0.0, towards=0.0)
        self._block = ElementBlock(
            "steering", "point_tilt", "cell", points, SLOTS, (0, 1), self.params.array, update=self._command
        )
        return (self._block,)

    def _command(self, t: float) -> None:
        self.params["couple"] = self.steer.ratio.value(t) * self._here
        self.params["towards"] = self._direction(t)

    def stress_free_curvature(self) -> tuple[np.ndarray, FloatArray]:
        """Local elements (k,) that the tool bends without stress, and their curvature towards the tool face (k, 3) [1/m]."""
        size = self.params["couple"] / self._stiffness
        return self._block.points, size[:, None] * self.params["towards"]

    def quantities(self) -> tuple[Quantity, ...]:
        return declared.STEERING_POINT
