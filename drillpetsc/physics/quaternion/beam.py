"""String element of the reference formulation: position, normal strain and Euler parameters at each node.

Kernel: kernels/quaternion/quaternion_beam.hpp.  Manual: sec-quaternion, sec-paper-source.

A multiplier keeps the Euler parameters at unit length, which makes the equations a DAE (manual:
eq-quat-constraint). The constraint is on positions (index 3), on velocities (index 2, the length drifts), or
on velocities with a projection after each step (stabilized: coordinate projection, Eich, SIAM J. Numer. Anal.
30, 1993).
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from dataclasses import replace
from itertools import product as product_of
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.component import ElementBlock, Energies, Field, Powers
from drillpetsc.fem.dof_layout import DofLayout
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import Parameters, structure
from drillpetsc.physics.beam import ENERGIES, POSITION_SCALE, results_of_cells, section_parameters
from drillpetsc.physics.interfaces import Beam
from drillpetsc.physics.rigid_bodies import local_vertices

_motion = function("quaternion_motion", "ippppp")
_view = function("quaternion_view", "ippppp")
_StartFrames = structure("start_frames")  # StartFrames of kernels/quaternion/on_quaternion.hpp
NODE = ("string.position", "string.strain", "string.quaternion")
SLOTS = tuple((name, end) for end in (0, 1) for name in NODE)
JUNCTION_SLOTS = (*SLOTS, ("string.ratio", 0))
NODE_SLOTS = tuple((name, 0) for name in NODE)
ANCF_NODE = ("string.position", "string.tangent", "string.spin")
LEVELS = {"index3": 3.0, "index2": 2.0, "stabilized": 2.0}
ROW_SCALE = 1.0e6  # of constraint rows, so that one norm fits them and the forces
# scale of a multiplier, which is linear in the rows and correct if the motion is correct; its rounding error grows
# as 1/step^2, so it takes no part in error control
UNCONTROLLED_SCALE = 1.0e30
DIFFERENCE = (
    1.0e-4  # time of differences along the motion [s]: rounding 1e-8, far below a period of the string
)


def quaternions(frames: Frames) -> FloatArray:
    """Compute the Euler parameters (n, 4) of the node frames (tangent, second director, third), scalar first.

    Neighbours have the same sign.
    """
    out = np.empty((len(frames.reference), 4))
    for i, (a, b) in enumerate(zip(frames.reference, frames.second_director, strict=True)):
        R = np.column_stack([a, b, np.cross(a, b)])
        # dividing by the largest of the four squares avoids cancellation (Shepperd, J. Guid. Control 1, 1978)
        w = np.array([[R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]]).T
        K = np.block([[np.array([[1 + np.trace(R)]]), w.T], [w, R + R.T + (1 - np.trace(R)) * np.eye(3)]])
        q = K[int(np.argmax(np.diag(K)))]
        q = q / np.linalg.norm(q)
        out[i] = -q if (i and q @ out[i - 1] < 0) or (not i and q[0] < 0) else q
    return out


def turned(q: FloatArray, angle: FloatArray | float) -> FloatArray:
    """Rotate orientations ``q`` (n, 4) by ``angle`` (n,) [rad] about their first axis."""
    half = 0.5 * np.asarray(angle, dtype=float)[..., None]
    return q * np.cos(half) + spun(q) * np.sin(half)


def spun(q: FloatArray) -> FloatArray:
    """Compute the product q e1 (n, 4).

    Half of it per rad/s is the rate of a q that spins about its first axis.
    """
    w, x, y, z = np.moveaxis(q, -1, 0)
    return np.stack([-x, w, z, -y], axis=-1)


def direction(q: FloatArray) -> FloatArray:
    """First axes (..., 3) of the sections with Euler parameters q (..., 4) of any length."""
    w, x, y, z = np.moveaxis(q, -1, 0)
    axis = np.stack([w * w + x * x - y * y - z * z, 2 * (x * y + w * z), 2 * (x * z - w * y)], axis=-1)
    return np.asarray(axis / np.sum(q * q, axis=-1, keepdims=True))


def product(p: FloatArray, q: FloatArray) -> FloatArray:
    """Compute the quaternion products p q (..., 4): the rotation q, then the rotation p."""
    a, u, b, v = p[..., :1], p[..., 1:], q[..., :1], q[..., 1:]
    scalar = a * b - np.sum(u * v, axis=-1, keepdims=True)
    return np.concatenate([scalar, a * v + b * u + np.cross(u, v)], axis=-1)


def as_quaternion(vectors: FloatArray) -> FloatArray:
    """Quaternions (..., 4) without scalar part of ``vectors`` (..., 3)."""
    return np.concatenate([np.zeros_like(vectors[..., :1]), vectors], axis=-1)


def minimal_rotation(a: FloatArray, t: FloatArray) -> FloatArray:
    """Compute the quaternions (..., 4) of the smallest rotation of unit vectors a to t, (..., 3) each.

    Manual: eq-beam-minimal-rotation.
    """
    out = np.concatenate([1.0 + np.sum(a * t, axis=-1, keepdims=True), np.cross(a, t)], axis=-1)
    return np.asarray(out / np.linalg.norm(out, axis=-1, keepdims=True))


class QuaternionBeam(Beam):
    """Elements of the string with unknowns r [m], eps [-], q [-] and the multiplier of |q| = 1 [N m] at every node.

    A node with a rigid item above further elements has a stretch ratio [-], as in the ANCF element.

    mesh: of the string; frames: at its nodes at the start; gravity: (3,) [m/s2].
    constraint: ``index3``, ``index2`` or ``stabilized`` (manual: sec-quaternion-constraints).
    finest_motion: penetration of impacts into the wall [m], infinite without contact; a limit of the position
    scale.
    """

    name = "beam"
    formulation = "quaternion"
    orientation = "string.quaternion"
    angle_period = 4 * np.pi
    needs_ancf_equilibrium = True
    has_constraints = True
    turns_with_string = True  # unknowns and Jacobian entries turn with the string
    derived_fields = {
        "string.tangent": 3,
        "string.spin": 1,
    }  # slope, spin angle and their rates, for components of the ANCF element (manual: sec-quaternion-view)

    def __init__(
        self,
        mesh: StringMesh,
        frames: Frames,
        gravity: FloatArray,
        constraint: str = "index3",
        finest_motion: float = np.inf,
    ):
        self.mesh, self.frames, self.constraint = mesh, frames, constraint
        self.position_scale = min(POSITION_SCALE, finest_motion)
        self.gravity = np.asarray(gravity, dtype=float)
        self.start, self.restores_constraints = quaternions(frames), constraint == "stabilized"
        self._layout: DofLayout | None = None
        self._records: list[Any] = []  # contexts of the kernels on derived fields
        self._spin = 0.0  # of sections that turn in place, besides the rates of q [rad/s]

    def fields(self) -> tuple[Field, ...]:
        always = (
            Field("string.position", 3, scale=self.position_scale),
            Field("string.strain", 1, scale=1e-2),
            Field("string.quaternion", 4, scale=5e-3),
            Field(
                "string.multiplier",
                1,
                scale=UNCONTROLLED_SCALE,
                second_order=False,
                differential=False,
                multiplier=True,
            ),
        )
        ratio = Field("string.ratio", 1, region="junction", scale=1e-2, default=1.0)
        return (*always, ratio) if self.mesh.below_junction.any() else always

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        """Blocks of the local cells of ``part`` (a Chain).

        With and without damping, below a rigid item or not, and of the nodes' unit lengths.
        """
        m, e, self._part = self.mesh, part.cells, part
        damped, below = (m.stiffness_damping != 0) | (m.mass_damping != 0), m.below_junction
        self._elements = []
        for is_below, is_damped in product_of((False, True), (False, True)):
            group = (damped == is_damped) & (below == is_below) & ~m.is_joint
            if group.any():
                chosen = np.flatnonzero(group[e]).astype(np.int32)
                name = "beam" + "_junction" * is_below + "_damped" * is_damped
                slots = JUNCTION_SLOTS if is_below else SLOTS
                params = self._params(e[chosen])
                self._elements.append(
                    ElementBlock(name, f"quaternion_{name}", "cell", chosen, slots, (), params)
                )
        _, vertices = local_vertices(part, np.arange(m.nodes))
        length = Parameters("unit_length", len(vertices), level=LEVELS[self.constraint], scale=ROW_SCALE)
        slots = (("string.quaternion", 0), ("string.multiplier", 0))
        self._length = ElementBlock("unit_length", "unit_length", "vertex", vertices, slots, (), length.array)
        return (*self._elements, self._length)

    def _params(self, e: np.ndarray) -> FloatArray:
        sections, curvature = section_parameters(self.mesh, e), self.mesh.curvature[e]
        return Parameters(
            "quaternion_beam", len(e), curvature=curvature, gravity=self.gravity, **sections
        ).array

    def translate(self, block: ElementBlock) -> ElementBlock:
        """Rewrite a block from the ANCF element's unknowns to this element's unknowns.

        Manual: sec-quaternion-view.

        Other blocks are returned unchanged.  The parameters are shared, so that a component updates both
        together. ``Assembly.index_of`` gives that component the derived fields.  Kernel:
        kernels/quaternion/on_quaternion.hpp.
        """
        if not any(name in self.derived_fields for name, _ in block.slots):
            return block
        nodes = sum(name == "string.position" for name, _ in block.slots)
        assert block.slots[: 3 * nodes] == tuple((name, end) for end in range(nodes) for name in ANCF_NODE)
        chain = self._part
        frames = self.start[
            chain.vertices[chain.ends[block.points] if block.on == "cell" else block.points[:, None]]
        ]
        frames = np.ascontiguousarray(frames, dtype=float)
        record = _StartFrames(inner=block.context, frames=pointer(frames), spin=self._spin)
        self._records.append(record)
        slots = tuple((name, end) for end in range(nodes) for name in NODE) + block.slots[3 * nodes :]
        return replace(
            block,
            kernel=f"quaternion_{block.kernel}",
            slots=slots,
            spins=(),
            context=ctypes.addressof(record),
            keep=(*block.keep, frames, record),
        )

    def derive(self, state) -> None:
        """Compute the derived fields (manual: eq-quat-tangent, eq-quat-spin-angle)."""
        at, frame = self._places(state.layout)
        out, view = np.zeros((len(at), 8)), state.layout.derived
        _view(len(at), pointer(at), pointer(frame), pointer(state.x), pointer(state.y), pointer(out))
        for array, columns in ((state.x, out[:, :4]), (state.y, out[:, 4:])):
            array[view["string.tangent"]], array[view["string.spin"]] = columns[:, :3], columns[:, 3:]
        state.y[view["string.spin"]] += self._spin

    def place(self, system, position: FloatArray, tangent: FloatArray) -> None:
        """Put the unstrained string at rest on ``position`` (n_nodes, 3) [m], oriented as at the start."""
        system.set_field("string.position", position)
        system.set_field("string.strain", np.zeros((self.mesh.nodes, 1)))
        system.set_field("string.quaternion", self.start)

    def set_rigid_motion(
        self,
        system,
        tangent: FloatArray,
        curvature: FloatArray,
        lowering: float | FloatArray,
        rotation: float | FloatArray,
    ) -> None:
        """Set the velocity of every node to ``lowering`` [m/s] along the hole, its spin to ``rotation`` [rad/s].

        lowering, rotation: (n_nodes,) if they differ along the string.
        tangent, curvature: (n_nodes, 3) of the hole at the nodes [-, 1/m].
        """
        along = np.broadcast_to(np.reshape(lowering, (-1, 1)), (self.mesh.nodes, 1))
        turn = np.broadcast_to(np.reshape(rotation, (-1, 1)), (self.mesh.nodes, 1))
        q, here = np.zeros((self.mesh.nodes, 4)), system.chain.vertices
        present = system.field("string.quaternion")
        bend = (along * np.cross(tangent, curvature))[here]
        q[here] = 0.5 * (turn[here] * spun(present) + product(as_quaternion(bend), present))
        system.set_field("string.position", along * tangent, "y")
        system.set_field("string.strain", self.mesh.slope_at_nodes(along[:, 0])[:, None], "y")
        system.set_field("string.quaternion", q, "y")

    def impose_rigid_motion(self, system, rates: FloatArray, lowering: float, rotation: float) -> None:
        """Write the rates of a string that moves along itself and turns in place.

        The spin of the sections is not in the rates of the Euler parameters, which would turn away from the shape within a solve.
        """
        dofs = system.layout.dofs
        rates[dofs["string.position"]] = lowering * direction(system.assembly.x[dofs["string.quaternion"]])
        self._spin = rotation
        for record in self._records:
            record.spin = rotation

    def first_node(self, fields: Mapping[str, FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position (3,) [m], slope (3,) [-] and spin angle (1,) [rad] of the top node."""
        place, strain, q = (fields[f"string.{name}"][0] for name in ("position", "strain", "quaternion"))
        frame = self.start[0]
        angle = 2 * np.arctan2(q @ spun(frame), q @ frame)
        return place, (1 + strain[0]) * direction(q), np.array([angle])

    def average_over_turn(self, turning: bool) -> None:
        """Leave out the stress-free curvature while the string turns: its effect averages out over a turn."""
        for block in self._elements:
            cells = self._part.cells[block.points]
            block.named["curvature"] = (0.0 if turning else 1.0) * self.mesh.curvature[cells]

    def constrain_positions(self, hold: bool) -> None:
        """The constraint on positions, whatever its form in motion: statics has no velocities."""
        self._length.named["level"] = 3.0 if hold else LEVELS[self.constraint]

    def restore_constraints(self, state) -> None:
        """Project onto unit length, with no rate along it, after a solve in the stabilized form.

        Manual: eq-quat-constraint.
        """
        at = state.layout.dofs["string.quaternion"]
        q, rate = state.x[at], state.y[at]
        q = q / np.linalg.norm(q, axis=1, keepdims=True)
        state.x[at], state.y[at] = q, rate - q * np.sum(q * rate, axis=1, keepdims=True)

    def balance_constraints(self, state, rows: FloatArray) -> None:
        """Balance the rows of Euler parameters along them (manual: eq-quat-constraint)."""
        dofs = state.layout.dofs
        along = np.sum(state.x[dofs["string.quaternion"]] * rows[dofs["string.quaternion"]], axis=1)
        state.x[dofs["string.multiplier"][:, 0]] -= 0.5 * along

    # ------------------------------------------------------------------ results
    def _node_motion(self, state) -> FloatArray:
        """(nv, 8) at the local vertices: slope r' (3), tangent (3), spin rate [rad/s], spin angle from the
        frame at the start [rad]."""
        return state.evaluate_once(self._evaluate_motion, state)

    def _evaluate_motion(self, state) -> FloatArray:
        at, frame = self._places(state.layout)
        out = np.zeros((len(at), 8))
        _motion(len(out), pointer(at), pointer(frame), pointer(state.x), pointer(state.y), pointer(out))
        out[:, 6] += self._spin
        return out

    def _places(self, layout: DofLayout) -> tuple[np.ndarray, FloatArray]:
        """Return the dofs (nv, 8) of the nodes and their Euler parameters (nv, 4) at the start."""
        if self._layout is not layout:
            self._layout = layout
            self._at = np.ascontiguousarray(np.hstack([layout.dofs[name] for name in NODE]), dtype=np.int32)
            self._frame = np.ascontiguousarray(self.start[layout.chain.vertices])
        return self._at, self._frame

    def section(self, state, vertex: int | IntArray) -> tuple[FloatArray, FloatArray, Any]:
        """Position [m], slope and spin rate [rad/s] of a local vertex, or of several."""
        motion = self._node_motion(state)[vertex]
        return state.x[state.layout.dofs["string.position"][vertex]], motion[..., :3], motion[..., 6]

    def nodal_motion(self, state, vertices: IntArray) -> FloatArray:
        """(3, k, 7) position, slope and spin angle of local vertices, their rates and accelerations.

        Derivatives of slope and spin rate are differences along the motion x + y t + a t^2/2, at DIFFERENCE [s] on both sides.
        """
        at, frame = self._places(state.layout)
        at, frame = np.ascontiguousarray(at[vertices]), np.ascontiguousarray(frame[vertices])
        out, sides = np.empty((3, len(at), 7)), []
        place = state.layout.dofs["string.position"][vertices]
        for level, values in enumerate((state.x, state.y, state.a)):
            out[level, :, :3] = values[place]
        for t in (-DIFFERENCE, 0.0, DIFFERENCE):
            x, y = state.x + t * state.y + 0.5 * t**2 * state.a, state.y + t * state.a
            moved = np.zeros((len(at), 8))
            _motion(len(at), pointer(at), pointer(frame), pointer(x), pointer(y), pointer(moved))
            sides.append(moved)
        before, now, after = sides
        out[0, :, 3:6], out[0, :, 6] = now[:, :3], now[:, 7]
        out[1, :, 3:6], out[1, :, 6] = (after - before)[:, :3] / (2 * DIFFERENCE), now[:, 6]
        out[2, :, 3:6] = (after - 2 * now + before)[:, :3] / DIFFERENCE**2
        out[2, :, 6] = (after - before)[:, 6] / (2 * DIFFERENCE)
        return out

    def columns(self, state) -> FloatArray:
        """(nv, 8) at the local vertices: position [m] and velocity [m/s], spin rate [rad/s], spin angle
        [rad]."""
        place, motion = state.layout.dofs["string.position"], self._node_motion(state)
        return np.hstack([state.x[place], state.y[place], motion[:, 6:]])

    def couple(self, values: FloatArray, rows: FloatArray) -> FloatArray:
        """Return (n, 3) the couples of forces conjugate to Euler parameters q: half their product with e_i q.

        A rotation by a small vector w changes q by w q/2 (manual: eq-quat-nodal-couple).
        """
        turns = product(as_quaternion(np.eye(3))[None], values[:, None])
        return np.asarray(0.5 * np.sum(turns * rows[:, None], axis=2))

    def element_results(self, state) -> FloatArray:
        """(nc, 9) per local cell in depth order: the columns of ``physics.beam.RESULT_NAMES``.

        The bending energy counts the bend beyond the stress-free shape.
        """
        return results_of_cells(state, self._elements, "quaternion_beam_results")

    def energies(self, t: float, state) -> Energies:
        return Energies(*map(float, self.element_results(state)[:, ENERGIES].sum(axis=0)))

    def powers(self, t: float, state: Any) -> Powers:
        damped = (b for b in self._elements if "damped" in b.kernel)
        return Powers(sum(state.evaluated(b, "quaternion_beam_dissipation", 1).sums.item() for b in damped))
