"""The paper's string element: position, normal strain and Euler parameters at each node
(kernels/quaternion/quaternion_beam.hpp).

The Euler parameters have unit length by a multiplier, which makes the equations a DAE.  The constraint may
stand on positions (index 3), on velocities (index 2, the length drifts), or on velocities with the length
restored after each step (stabilized: coordinate projection, Eich, SIAM J. Numer. Anal. 30, 1993).
"""

from __future__ import annotations

import ctypes
from dataclasses import replace
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.component import ElementBlock, Energies, Field, Powers
from drillpetsc.fem.dof_layout import DofLayout
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames
from drillpetsc.kernels import function, pointer
from drillpetsc.kernels.parameters import Parameters, structure
from drillpetsc.physics.beam import ENERGIES, POSITION_SCALE, REPORT
from drillpetsc.physics.interfaces import Beam
from drillpetsc.physics.rigid_bodies import local_vertices

_results = function("quaternion_beam_results", "ippppp")
_dissipation = function("quaternion_beam_dissipation", "ipppp", ctypes.c_double)
_motion = function("quaternion_motion", "ippppp")
_view = function("quaternion_view", "ippppp")
_StartFrames = structure("start_frames")  # StartFrames of kernels/quaternion/on_quaternion.hpp
NODE = ("string.position", "string.strain", "string.quaternion")
SLOTS = tuple((name, end) for end in (0, 1) for name in NODE)
NODE_SLOTS = tuple((name, 0) for name in NODE)
ANCF_NODE = ("string.position", "string.tangent", "string.spin")
LEVELS = {"index3": 3.0, "index2": 2.0, "stabilized": 2.0}
ROW_SCALE = 1.0e6  # of constraint rows, so that one norm fits them and the forces
# scale of a multiplier: it is linear in the rows and right where the motion is; its own rounding grows as
# 1/step^2
UNCONTROLLED_SCALE = 1.0e30


def quaternions(frames: Frames) -> FloatArray:
    """(n, 4) Euler parameters of the node frames (tangent, second director, third), scalar first; neighbours
    on one side."""
    out = np.empty((len(frames.reference), 4))
    for i, (a, b) in enumerate(zip(frames.reference, frames.second, strict=True)):
        R = np.column_stack([a, b, np.cross(a, b)])
        # the largest of the four squares keeps the division safe (Shepperd, J. Guid. Control 1, 1978)
        w = np.array([[R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]]).T
        K = np.block([[np.array([[1 + np.trace(R)]]), w.T], [w, R + R.T + (1 - np.trace(R)) * np.eye(3)]])
        q = K[int(np.argmax(np.diag(K)))]
        q = q / np.linalg.norm(q)
        out[i] = -q if (i and q @ out[i - 1] < 0) or (not i and q[0] < 0) else q
    return out


def turned(q: FloatArray, angle: FloatArray | float) -> FloatArray:
    """(n, 4) orientations ``q`` turned by ``angle`` (n,) [rad] about their own first axis."""
    half = 0.5 * np.asarray(angle, dtype=float)[..., None]
    return q * np.cos(half) + spun(q) * np.sin(half)


def spun(q: FloatArray) -> FloatArray:
    """(n, 4) product q e1: half of it per rad/s is the rate of q that spins about its first axis."""
    w, x, y, z = np.moveaxis(q, -1, 0)
    return np.stack([-x, w, z, -y], axis=-1)


class QuaternionBeam(Beam):
    """Elements of the string with unknowns r [m], eps [-], q [-] and the multiplier of |q| = 1 [N m] at every
    node."""

    name = "beam"
    formulation = "quaternion"
    needs_ancf_equilibrium = True
    has_constraints = True
    turns_with_string = True  # its unknowns turn with the string, and so do its Jacobian's entries
    derived_fields = {
        "string.tangent": 3,
        "string.spin": 1,
    }  # what rooms of the ANCF element see: slope, spin angle, and their rates

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

    def fields(self) -> tuple[Field, ...]:
        return (
            Field("string.position", 3, scale=self.position_scale),
            Field("string.strain", 1, scale=1e-2),
            Field("string.quaternion", 4, scale=5e-3),
            Field("string.multiplier", 1, scale=UNCONTROLLED_SCALE, second_order=False, differential=False),
        )

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        """Elements of the local cells of ``part`` (a Chain), damped ones apart, and the unit lengths of this
        rank's nodes."""
        m, e, self._part = self.mesh, part.cells, part
        damped = (m.stiffness_damping != 0) | (m.mass_damping != 0)
        self._elements = []
        for is_damped in (False, True):
            if (damped == is_damped).any():
                chosen = np.flatnonzero(damped[e] == is_damped).astype(np.int32)
                kernel = "quaternion_beam" + "_damped" * is_damped
                self._elements.append(
                    ElementBlock(
                        "beam" + "_damped" * is_damped,
                        kernel,
                        "cell",
                        chosen,
                        SLOTS,
                        (),
                        self._params(e[chosen]),
                    )
                )
        _, vertices = local_vertices(part, np.arange(m.nodes))
        length = Parameters("unit_length", len(vertices), level=LEVELS[self.constraint], scale=ROW_SCALE)
        slots = (("string.quaternion", 0), ("string.multiplier", 0))
        self._length = ElementBlock("unit_length", "unit_length", "vertex", vertices, slots, (), length.array)
        return (*self._elements, self._length)

    def _params(self, e: np.ndarray) -> FloatArray:
        m = self.mesh
        return Parameters(
            "quaternion_beam",
            len(e),
            length=m.length[e],
            ea=m.axial_stiffness[e],
            ei=m.bending_stiffness[e],
            gj=m.torsional_stiffness[e],
            mass=m.mass[e],
            polar=m.polar_inertia[e],
            beta=m.stiffness_damping[e],
            alpha=m.mass_damping[e],
            curvature=m.curvature[e],
            gravity=self.gravity,
        ).array

    def translate(self, block: ElementBlock) -> ElementBlock:
        """A block of the ANCF element's unknowns on those of this one (kernels/quaternion/on_quaternion.hpp);
        others as they are.

        Constants are shared, so that a room that renews its own renews these; Assembly.index_of leads it to
        the view.
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
        record = _StartFrames(inner=block.context, frames=pointer(frames))
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
        """Fill the state's view."""
        at, frame = self._places(state.layout)
        out, view = np.zeros((len(at), 8)), state.layout.derived
        _view(len(at), pointer(at), pointer(frame), pointer(state.x), pointer(state.y), pointer(out))
        for array, columns in ((state.x, out[:, :4]), (state.y, out[:, 4:])):
            array[view["string.tangent"]], array[view["string.spin"]] = columns[:, :3], columns[:, 3:]

    def place(self, system, position: FloatArray, tangent: FloatArray) -> None:
        """Put the unstrained string at rest on ``position`` (n_nodes, 3) [m], oriented as at the start."""
        system.set_field("string.position", position)
        system.set_field("string.strain", np.zeros((self.mesh.nodes, 1)))
        system.set_field("string.quaternion", self.start)

    def set_rigid_motion(self, system, tangent: FloatArray, lowering: float, rotation: float) -> None:
        """Give every node the velocity ``lowering`` [m/s] along ``tangent`` and the spin ``rotation`` [rad/s]."""
        q = np.zeros((self.mesh.nodes, 4))
        q[system.chain.vertices] = 0.5 * rotation * spun(system.field("string.quaternion"))
        system.set_field("string.position", lowering * tangent, "y")
        system.set_field("string.strain", np.zeros((self.mesh.nodes, 1)), "y")
        system.set_field("string.quaternion", q, "y")

    def constrain_positions(self, hold: bool) -> None:
        """The constraint on positions whatever its form in motion: statics knows no velocities."""
        self._length.named["level"] = 3.0 if hold else LEVELS[self.constraint]

    def restore_constraints(self, state) -> None:
        """At the end of a solve in the stabilized form: unit length, and no rate along it."""
        at = state.layout.dofs["string.quaternion"]
        q, rate = state.x[at], state.y[at]
        q = q / np.linalg.norm(q, axis=1, keepdims=True)
        state.x[at], state.y[at] = q, rate - q * np.sum(q * rate, axis=1, keepdims=True)

    # ------------------------------------------------------------------ figures
    def motion(self, state) -> FloatArray:
        """(nv, 8) at the local vertices: slope r' (3), tangent (3), spin rate [rad/s], spin angle from the
        frame at the start [rad]."""
        at, frame = self._places(state.layout)
        out = np.zeros((len(at), 8))
        _motion(len(out), pointer(at), pointer(frame), pointer(state.x), pointer(state.y), pointer(out))
        return out

    def _places(self, layout: DofLayout) -> tuple[np.ndarray, FloatArray]:
        """(nv, 8) places of the nodes' unknowns and (nv, 4) frames at the start."""
        if self._layout is not layout:
            self._layout = layout
            self._at = np.ascontiguousarray(np.hstack([layout.dofs[name] for name in NODE]), dtype=np.int32)
            self._frame = np.ascontiguousarray(self.start[layout.chain.vertices])
        return self._at, self._frame

    def section(self, state, vertex: int) -> tuple[FloatArray, FloatArray, float]:
        """Position [m], slope and spin rate [rad/s] of a local vertex."""
        motion = self.motion(state)[vertex]
        return state.x[state.layout.dofs["string.position"][vertex]], motion[:3], float(motion[6])

    def columns(self, state) -> FloatArray:
        """(nv, 8) at the local vertices: position [m] and velocity [m/s], spin rate [rad/s], spin angle
        [rad]."""
        place, motion = state.layout.dofs["string.position"], self.motion(state)
        return np.hstack([state.x[place], state.y[place], motion[:, 6:]])

    def report(self, layout: DofLayout, x: FloatArray, y: FloatArray) -> FloatArray:
        """(nc, 9) per local cell in depth order: the columns of ``rooms.beam.REPORT``; bending is that beyond
        the stress-free shape."""
        out = np.zeros((len(self._part.cells), len(REPORT)))
        for b in self._elements:
            if len(b.points):
                part, index = np.zeros((len(b.points), len(REPORT))), layout.index(b)
                _results(
                    len(b.points), pointer(index), pointer(b.params), pointer(x), pointer(y), pointer(part)
                )
                out[b.points] = part
        return out

    def energies(self, t: float, state) -> Energies:
        return Energies(*map(float, self.report(state.layout, state.x, state.y)[:, ENERGIES].sum(axis=0)))

    def powers(self, t: float, state: Any) -> Powers:
        lost = 0.0
        for b in self._elements:
            if "damped" in b.kernel and len(b.points):
                lost += _dissipation(
                    len(b.points),
                    pointer(state.index_of(b)),
                    pointer(b.params),
                    pointer(state.x),
                    pointer(state.y),
                )
        return Powers(lost)
