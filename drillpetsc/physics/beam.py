"""ANCF beam of the drillstring: axial, bending, torsion, inertia, gravity, material damping (kernels/beam/beam.hpp).

Manual: sec-beam.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from drillpetsc.arrays import FloatArray, IntArray
from drillpetsc.fem.component import ElementBlock, Field
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.geometry.frames import Frames, cross
from drillpetsc.kernels.parameters import Parameters, columns
from drillpetsc.physics import interfaces
from drillpetsc.physics.reference_frames import renew_reference_frames

RESULT_NAMES = columns("beam_results").names
ENERGIES = columns("beam_results").span("kinetic", "potential")  # in the order of ``Energies``
_BALANCE = columns("beam_balance")
_STORED, _DISSIPATED = _BALANCE.span("stored_kinetic", "stored_potential"), _BALANCE["dissipated"]
SLOTS = (
    ("string.position", 0),
    ("string.tangent", 0),
    ("string.spin", 0),
    ("string.position", 1),
    ("string.tangent", 1),
    ("string.spin", 1),
)
JUNCTION_SLOTS = (*SLOTS, ("string.ratio", 0))

POSITION_SCALE = 0.03  # [m], of the order of a string's play in its hole


class AncfBeam(interfaces.Beam):
    """Elements of the string; unknowns r [m], v = dr/ds [-], phi [rad] at every node, a stretch ratio [-] at junctions.

    mesh: of the string; frames: reference frames of its nodes.
    gravity: (3,) [m/s2].
    finest_motion: penetration of impacts into the wall [m], infinite without contact.  If it is smaller
    than ``POSITION_SCALE`` it is the scale of positions (manual: sec-time-error).
    """

    name = "beam"
    formulation = "ancf"
    orientation = "string.tangent"

    def __init__(self, mesh: StringMesh, frames: Frames, gravity: FloatArray, finest_motion: float = np.inf):
        self.mesh, self.frames, self.gravity = mesh, frames, np.asarray(gravity, dtype=float)
        self.position_scale = min(POSITION_SCALE, finest_motion)
        self._blocks: tuple[ElementBlock, ...] = ()

    def fields(self) -> tuple[Field, ...]:
        always = (
            Field("string.position", 3, scale=self.position_scale),
            Field("string.tangent", 3, scale=1e-2),
            Field("string.spin", 1, scale=0.02),
        )
        ratio = Field("string.ratio", 1, region="junction", scale=1e-2, default=1.0)
        return (*always, ratio) if self.mesh.junction.any() or self.mesh.below_junction.any() else always

    def _params(self, e: np.ndarray) -> FloatArray:
        f = self.frames
        return Parameters(
            "beam",
            len(e),
            twist0=f.twist0[e],
            gravity=self.gravity,
            reference1=f.reference[e],
            reference2=f.reference[e + 1],
            **section_parameters(self.mesh, e),
        ).array

    def blocks(self, part) -> tuple[ElementBlock, ...]:
        """Blocks of the local cells of ``part`` (a Chain): with and without damping, below a junction or not."""
        e = part.cells
        damped = (self.mesh.stiffness_damping[e] != 0) | (self.mesh.mass_damping[e] != 0)
        all_below = self.mesh.below_junction
        below = all_below[e]
        any_damped = ((self.mesh.stiffness_damping != 0) | (self.mesh.mass_damping != 0)).any()
        all_damped = ((self.mesh.stiffness_damping != 0) | (self.mesh.mass_damping != 0)).all()
        element = ~self.mesh.is_joint[e]
        blocks = []
        for is_below in (False, True):
            for is_damped in (False, True):
                if (
                    (is_below and not all_below.any())
                    or (is_damped and not any_damped)
                    or (not is_damped and all_damped)
                ):
                    continue  # the same decision on every rank
                chosen = np.flatnonzero((below == is_below) & (damped == is_damped) & element).astype(
                    np.int32
                )
                kernel = "beam" + "_junction" * is_below + "_damped" * is_damped
                blocks.append(
                    ElementBlock(
                        kernel,
                        kernel,
                        "cell",
                        chosen,
                        JUNCTION_SLOTS if is_below else SLOTS,
                        (0, 1),
                        self._params(e[chosen]),
                        linear=("ea", "ei", "gj", "mass", "polar"),
                    )
                )
        self._blocks = tuple(blocks)
        self._part = part
        return self._blocks

    def place(self, system, position: FloatArray, tangent: FloatArray) -> None:
        """Put the unstrained string at rest on ``position`` (n_nodes, 3) [m] with directions ``tangent``."""
        system.set_field("string.position", position)
        system.set_field("string.tangent", tangent)
        system.set_field("string.spin", np.zeros((self.mesh.nodes, 1)))

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
        stretch = np.zeros((self.mesh.nodes, 1))
        stretch[system.chain.vertices] = np.linalg.norm(system.field("string.tangent"), axis=1, keepdims=True)
        system.set_field("string.position", along * tangent, "y")
        strain_rate = self.mesh.slope_at_nodes(along[:, 0])[:, None]
        system.set_field("string.tangent", along * stretch * curvature + strain_rate * tangent, "y")
        system.set_field(
            "string.spin", np.broadcast_to(np.reshape(rotation, (-1, 1)), (self.mesh.nodes, 1)), "y"
        )

    def impose_rigid_motion(self, system, rates: FloatArray, lowering: float, rotation: float) -> None:
        """Write the rates of a string that moves along itself and turns in place; its directors are fixed."""
        dofs = system.layout.dofs
        v = system.assembly.x[dofs["string.tangent"]]
        rates[dofs["string.position"]] = lowering * v / np.linalg.norm(v, axis=1, keepdims=True)
        rates[dofs["string.spin"][:, 0]] = rotation

    def first_node(self, fields: Mapping[str, FloatArray]) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position (3,) [m], slope (3,) [-] and spin angle (1,) [rad] of the top node."""
        place, slope, spin = (fields[f"string.{name}"][0] for name in ("position", "tangent", "spin"))
        return place, slope, spin

    def renew_reference_frames(self, system) -> bool:
        """Replace reference directions that are far from the tangent (manual: sec-beam-reference-update)."""
        return renew_reference_frames(system, self.frames, lambda: self._twists(system))

    def _twists(self, system) -> FloatArray:
        """Compute the twist (nc,) of each local element [rad]."""
        asm, cells = system.assembly, system.chain.cells
        torque = self.element_results(asm)[:, RESULT_NAMES.index("torque")]
        return torque * self.mesh.length[cells] / self.mesh.torsional_stiffness[cells]

    def update_reference_frames(self) -> None:
        """Copy changed reference frames and twist offsets from ``frames`` into the blocks' parameters."""
        for b in self._blocks:
            e = self._part.cells[b.points]
            p, f = b.named, self.frames
            p["reference1"], p["reference2"], p["twist0"] = f.reference[e], f.reference[e + 1], f.twist0[e]

    def section(self, state, vertex: int | IntArray) -> tuple[FloatArray, FloatArray, Any]:
        """Return position [m], slope [-] and spin rate [rad/s] of a local vertex, or of several."""
        place = state.layout.dofs
        return (
            state.x.take(place["string.position"][vertex]),
            state.x.take(place["string.tangent"][vertex]),
            state.y.take(place["string.spin"][vertex, 0]),
        )

    def nodal_motion(self, state, vertices: IntArray) -> FloatArray:
        """Return (3, k, 7) position, slope and spin angle of local vertices, their rates and accelerations."""
        places = state.layout.dofs
        at = np.hstack(
            [places[name][vertices] for name in ("string.position", "string.tangent", "string.spin")]
        )
        return np.stack([state.x[at], state.y[at], state.a[at]])

    def columns(self, state) -> FloatArray:
        """Return (nv, 8) at the local vertices: position [m], velocity [m/s], spin rate [rad/s], spin angle [rad]."""
        r, spin = state.layout.dofs["string.position"], state.layout.dofs["string.spin"]
        return np.hstack([state.x[r], state.y[r], state.y[spin], state.x[spin]])

    def couple(self, values: FloatArray, rows: FloatArray) -> FloatArray:
        """Return (n, 3) the couples v x G of forces G conjugate to slopes v (manual: eq-beam-nodal-couple)."""
        return cross(values, rows)

    def element_results(self, state) -> FloatArray:
        """(nc, 9) per local cell in depth order: the columns of ``RESULT_NAMES`` [J, J, J, N, N, N, N m, N m, N
        m]."""
        return results_of_cells(state, self._blocks, "beam_results")

    def energies_of(self, steps) -> tuple[Any, Any, Any]:
        parts = [steps.sums(b, "beam_balance", _BALANCE.width)[:, _STORED] for b in self._blocks]
        return tuple(sum(parts[1:], parts[0]).T)

    def powers_of(self, steps) -> tuple[Any, Any]:
        damped = (b for b in self._blocks if "damped" in b.kernel)
        return sum(steps.sums(b, "beam_balance", _BALANCE.width)[:, _DISSIPATED] for b in damped), 0.0


def section_parameters(mesh: StringMesh, e: np.ndarray) -> dict[str, FloatArray]:
    """Sections of the elements ``e``, by the names of the kernels' parameters."""
    return {
        "length": mesh.length[e],
        "ea": mesh.axial_stiffness[e],
        "ei": mesh.bending_stiffness[e],
        "gj": mesh.torsional_stiffness[e],
        "mass": mesh.mass[e],
        "polar": mesh.polar_inertia[e],
        "beta": mesh.stiffness_damping[e],
        "alpha": mesh.mass_damping[e],
        "rigid": mesh.rigid_above[e],
    }


def results_of_cells(state: Any, blocks: Iterable[ElementBlock], kernel: str) -> FloatArray:
    """(nc, ..) results of the ``RESULT_NAMES`` that a kernel computes, per local cell; zero in joints."""
    out = np.zeros((len(state.layout.chain.cells), len(RESULT_NAMES)))
    for b in blocks:
        out[b.points] = state.evaluated(b, kernel, len(RESULT_NAMES)).table
    return out
