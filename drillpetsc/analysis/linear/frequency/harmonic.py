"""Harmonic response of the linearised model: excitation vectors, the solution, forces in the string, and stresses in its turning material.

Manual: sec-response, sec-response-stress.  All unknowns move as Re(u exp(i w t)); rows are (K + i w C - w^2 M) u = -f, where
Re(f exp(i w t)) is the excitation's part of the residual.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.linalg
import scipy.sparse as sparse
import scipy.sparse.linalg as sparse_linalg

from drillpetsc.arrays import FloatArray
from drillpetsc.fem.assembly import spin_derivatives
from drillpetsc.fem.string_mesh import StringMesh
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.output.measured.bending import end_forces
from drillpetsc.output.measured.flow_recorder import FlowRecorder
from drillpetsc.parallel import joined, largest, total
from drillpetsc.physics.beam import RESULT_NAMES
from drillpetsc.physics.tools.mud_motor import MudMotor
from drillpetsc.solvers.linear.linearization import Linearised, unknowns_of

#: blocks whose loads turn with the section
TURNING = ("bodies", "eccentric", "eccentric_junction", "curvature", "curvature_junction")
ROCK = ("bit_bottom", "bit_rock")  # blocks of the bit on the bottom of the hole
_COLUMNS = [RESULT_NAMES.index(name) for name in ("axial_upper", "axial_lower", "torque")]
RESONANT = 1e6  # relative sensitivity to the frequency beyond which the amplitude counts as infinite
STEP = 1e-6  # by which the bit is moved, to linearise its contact [m, m/s]
SMALL_MOTION = 3e-4  # motion by which forces are linearised, in the scales of the unknowns (1e-5 m)


# ---------------------------------------------------------------------- excitation
def turning_load(balanced: DrillingModel, asymmetric: DrillingModel) -> np.ndarray | None:
    """Amplitudes (n,) of the rows of unbalance, eccentricity, bends and curvature of a string that turns.

    They are evaluated in the state of the balanced model, at four angles of rotation: what changes its sign with half a
    turn is of the first order in the asymmetry (manual: eq-response-unbalance).

    Both models have the same elements.  The result is on rank 0, None elsewhere; collective.
    """
    state, system = balanced.system.assembly, asymmetric.system
    asm, layout = system.assembly, system.layout
    asm.x[:], asm.y[:], asm.a[:] = state.x, state.y, state.a
    frames = asymmetric.frames
    frames.reference[:], frames.second_director[:] = (
        balanced.frames.reference,
        balanced.frames.second_director,
    )
    for component in asymmetric.components:
        component.update_reference_frames()
    found = _turned(asymmetric, layout.dofs["string.spin"][:, 0], 1.0, TURNING)
    return _whole(
        asymmetric, found[0] - 1j * found[1]
    )  # R = a cos(Omega t) + b sin(Omega t) = Re((a - i b) exp(i Omega t))


def _turned(
    model: DrillingModel, spin: np.ndarray, per_turn: float, blocks: tuple[str, ...]
) -> tuple[np.ndarray, np.ndarray]:
    """Parts of the cosine and of the sine of an angle in this rank's rows of ``blocks``.

    spin: unknowns; the angle goes round ``per_turn`` times while they turn once.
    """
    asm, rows = model.system.assembly, []
    start = asm.x[spin].copy()
    for angle in (0.0, 0.5 * np.pi, np.pi, 1.5 * np.pi):
        asm.x[spin] = start + angle / per_turn
        rows.append(_rows(model, blocks))
    asm.x[spin] = start
    return 0.5 * (rows[0] - rows[2]), 0.5 * (rows[1] - rows[3])


def _rows(model: DrillingModel, blocks: tuple[str, ...]) -> np.ndarray:
    """This rank's rows of some blocks."""
    local = model.system.assembly.partial_residual(0.0, lambda block: block.name in blocks).copy()
    return model.system.sum_local(local)[model.system.layout.local_of_owned]


def _whole(model: DrillingModel, owned: np.ndarray) -> np.ndarray | None:
    """Amplitudes (n,) of all ranks on rank 0, None elsewhere; collective."""
    parts = joined(model.system.comm.tompi4py(), np.column_stack([owned.real, owned.imag]))
    return None if parts is None else parts[:, 0] + 1j * parts[:, 1]


def orbit_load(model: DrillingModel) -> tuple[np.ndarray | None, float]:
    """Amplitudes (n,) of the rows of the orbit of a motor's rotor, and its angular frequency [rad/s] (manual: eq-response-orbit).

    The rotor is turned below its joint so that the orbit is at four angles.  The amplitudes are on rank 0, None
    elsewhere; collective.
    """
    motor, system = model.part(MudMotor), model.system
    assert motor is not None
    speed = float(total(system.comm, motor.orbit_speed(0.0, system.assembly)))
    below = system.layout.dofs["string.spin"][system.chain.vertices == motor.cell + 1, 0]
    motor.balance_orbit(False)
    found = _turned(model, below[below >= 0], -motor.rotor.lobes, ("mud_motor",))
    motor.balance_orbit()
    # R = a cos(theta) + b sin(theta), theta = speed t
    return _whole(model, found[0] - 1j * np.sign(speed) * found[1]), abs(speed)


def rock_load(model: DrillingModel, amplitude: float, omega: float) -> np.ndarray | None:
    """Amplitudes (n,) of the rows where the bottom of the hole moves by ``amplitude`` [m] along its axis.

    Only the distance between bit and rock acts, so it is the bit moved the other way, by central differences.
    The result is on rank 0, None elsewhere; collective.
    """
    system = model.system
    asm, layout, chain = system.assembly, system.layout, system.chain
    here = np.flatnonzero(chain.vertices == model.mesh.nodes - 1)
    dofs, along = layout.dofs["string.position"][here].ravel(), tangent_at(model, model.mesh.nodes - 1)
    parts = []
    for values, step in ((asm.x, STEP), (asm.y, STEP)):
        both = []
        for sign in (1.0, -1.0):
            values[dofs] += sign * step * along[: len(dofs)]
            both.append(_rows(model, ROCK))
            values[dofs] -= sign * step * along[: len(dofs)]
        parts.append((both[0] - both[1]) / (2 * step))
    return _whole(model, -amplitude * (parts[0] + 1j * omega * parts[1]))


@dataclass(frozen=True)
class EndMotion:
    """Place and direction of an excitation along the string: rows (3,) of its position, row of its spin angle, tangent (3,)."""

    position: np.ndarray
    spin: int
    tangent: FloatArray


def lower_end(model: DrillingModel, linearised: Linearised) -> EndMotion:
    """Rows and tangent of the lower end."""
    return motion_at(model, linearised, model.mesh.nodes - 1)


def motion_at(model: DrillingModel, linearised: Linearised, node: int) -> EndMotion:
    """Rows and tangent of a node."""
    names = [f.name for f in model.system.layout.fields]
    here = linearised.node == node
    at = {
        name: np.flatnonzero(here & (linearised.field == names.index(name)))
        for name in ("string.position", "string.spin")
    }
    position = at["string.position"][np.argsort(linearised.component[at["string.position"]])]
    return EndMotion(position, int(at["string.spin"][0]), tangent_at(model, node))


def tangent_at(model: DrillingModel, node: int) -> FloatArray:
    """Unit tangent (3,) of the hole's axis, or of the straight string, at a node."""
    return np.asarray(model.tangent[node]) / np.linalg.norm(model.tangent[node])


# ---------------------------------------------------------------------- solution
@dataclass(frozen=True)
class Response:
    """u: (n,) amplitudes of all unknowns; rows: (n,) of (K + i w C - w^2 M) u; sensitivity: |du/dw| w/|u| [-]."""

    u: np.ndarray
    rows: np.ndarray
    sensitivity: float

    @property
    def infinite(self) -> bool:
        """Whether the frequency is an undamped natural one, within ``RESONANT``."""
        return not self.sensitivity < RESONANT


def _without(T: sparse.csr_matrix, rows: np.ndarray, direction: FloatArray) -> sparse.csr_matrix:
    """Leave out of the free motions T (n, q) that of ``rows`` (3,) along ``direction`` (3,)."""
    columns = np.unique(T[rows].indices)
    block = T[rows][:, columns].toarray()
    kept = block @ scipy.linalg.null_space(direction[None, :] @ block) if len(columns) else block
    new = sparse.csr_matrix(
        (kept.ravel(), (np.repeat(rows, kept.shape[1]), np.tile(np.arange(kept.shape[1]), len(rows)))),
        shape=(T.shape[0], kept.shape[1]),
    )
    others = np.setdiff1d(np.arange(T.shape[1]), columns)
    return sparse.csr_matrix(sparse.hstack([T[:, others], new]))


def respond(
    system: Linearised,
    omega: float,
    load: np.ndarray,
    moved: tuple[np.ndarray, FloatArray, float] | None = None,
) -> Response:
    """Solve for the harmonic response at ``omega`` [rad/s].

    load: (n,) amplitudes f of the excitation's rows.
    moved: rows (3,), direction (3,) and amplitude [m] of a prescribed motion.
    """
    T, given = system.T, np.zeros(len(load), dtype=complex)
    if moved is not None:
        rows, direction, amplitude = moved
        T = _without(T, rows, direction)
        given[rows] = amplitude * direction
    s = 1j * omega
    D = sparse.csr_matrix(system.K + s * system.C + s**2 * system.M)
    parent = unknowns_of(T)
    columns = sparse.diags(system.scale[parent])
    A = sparse.csr_matrix(T.T @ D @ T @ columns)
    size: FloatArray = np.asarray(abs(A).max(axis=1).toarray(), dtype=float).ravel()
    size[size == 0] = 1.0
    weights = 1.0 / size
    try:
        factor = sparse_linalg.splu(sparse.csc_matrix(sparse.diags(weights) @ A))
    except RuntimeError:
        return Response(
            np.full(len(load), np.inf, dtype=complex), np.full(len(load), np.inf, dtype=complex), np.inf
        )

    def solve(rows: np.ndarray) -> np.ndarray:
        return columns @ factor.solve(np.asarray(weights * (T.T @ rows), dtype=complex))

    q = -solve(load + D @ given)
    u = T @ q + given
    # of D(w) u = -f: du/dw = -D^-1 (dD/dw) u
    change = T @ solve((1j * system.C - 2 * omega * system.M) @ u)
    scale = system.scale
    sensitivity = (
        omega * float(np.linalg.norm(change / scale)) / max(float(np.linalg.norm(u / scale)), 1e-300)
    )
    return Response(u, D @ u, float(sensitivity))


# ---------------------------------------------------------------------- forces
@dataclass(frozen=True)
class SectionForces:
    """Amplitudes at the ends of the elements: tension (n, 2) [N], torque (n,) [N m], bending moment (n, 2, 3) [N m]."""

    tension: np.ndarray
    torque: np.ndarray
    moment: np.ndarray


def section_forces(
    model: DrillingModel, mud: FlowRecorder | None, u: np.ndarray, omega: float
) -> SectionForces | None:
    """Forces in the string that oscillate with the motion u (n,) [SI] at ``omega``; on rank 0, collective.

    The forces of the program's outputs are linearised by central differences about the state.
    mud: pressures of the mud, None in a dry model.
    """
    asm = model.system.assembly
    numbers = model.system.layout.condensed_dm.getLGMap().getIndices()
    x, y, a = asm.x.copy(), asm.y.copy(), asm.a.copy()
    s, local = 1j * omega, u[numbers]
    size = float(np.max(np.abs(local) / model.system.scale[: len(local)], initial=1e-300))
    size = largest(model.system.comm, size)
    by_v, by_w = spin_derivatives(asm)
    rate = s * local
    spin, tangent = asm.spin_at[:, 0], asm.spin_at[:, 1:2] + np.arange(3)
    rate[spin] += np.sum((by_v + s * by_w) * local[tangent], axis=1)
    acceleration = np.where(model.system.layout.y_local >= 0, s * rate, 0.0)
    parts = []
    try:
        for factor in (1.0, -1j):  # real part, imaginary part
            both = []
            for sign in (1.0, -1.0):
                h = sign * SMALL_MOTION / size * factor
                asm.x[:-1] = x[:-1] + (h * local).real
                asm.y[:-1] = y[:-1] + (h * rate).real
                asm.a[:-1] = a[:-1] + (h * acceleration).real
                both.append(_forces(model, mud))
            parts.append((both[0] - both[1]) * (0.5 * size / SMALL_MOTION))
    finally:
        asm.x[:], asm.y[:], asm.a[:] = x, y, a
    both_parts = model.system.gather(np.hstack(parts), "cell")
    if both_parts is None:
        return None
    values = both_parts[:, : both_parts.shape[1] // 2] + 1j * both_parts[:, both_parts.shape[1] // 2 :]
    viscous = 1 + s * model.mesh.stiffness_damping[:, None]  # Kelvin-Voigt
    tension = values[:, :2] * viscous + values[:, 3:5]
    return SectionForces(tension, values[:, 2] * viscous[:, 0], values[:, 5:].reshape(-1, 2, 3))


def steady_forces(model: DrillingModel, mud: FlowRecorder | None) -> SectionForces | None:
    """Forces in the string in the present state; on rank 0, collective.  mud: pressures of the mud, None in a dry model."""
    values = model.system.gather(_forces(model, mud), "cell")
    if values is None:
        return None
    return SectionForces(values[:, :2] + values[:, 3:5], values[:, 2], values[:, 5:].reshape(-1, 2, 3))


def _forces(model: DrillingModel, mud: FlowRecorder | None) -> FloatArray:
    """(nc, 11) of the local elements in the present state: elastic tension at both ends, elastic torque, tension of the
    wall by the pressures at both ends, bending moment at both ends."""
    asm, beam = model.system.assembly, model.beam
    elastic = beam.element_results(asm)[:, _COLUMNS]
    pressed = np.zeros((len(elastic), 2)) if mud is None else mud.wall_tension()
    return np.hstack([elastic, pressed, end_forces(model).moment.reshape(len(elastic), 6)])


SAME = 1e-6  # relative difference of frequencies that are equal


def neighbours(mesh: StringMesh, node: int) -> list[tuple[int, int]]:
    """Elements that end at a node, as (element, 0 for its upper or 1 for its lower end); joints are passed over."""
    found = []
    above, below = node - 1, node
    while above >= 0 and mesh.is_joint[above]:
        above -= 1
    while below < len(mesh.length) and mesh.is_joint[below]:
        below += 1
    if above >= 0:
        found.append((above, 1))
    if below < len(mesh.length):
        found.append((below, 0))
    return found


def stresses(
    mesh: StringMesh,
    node: int,
    axes: FloatArray,
    moving: SectionForces,
    steady: SectionForces,
    frequency: float,
    rotation: float,
) -> tuple[float, float, float]:
    """Stresses at a node [Pa]: amplitude of the normal stress and of the shear stress, mean normal stress.

    axes: (3, 3) rows, two directions across the string and its tangent, right-handed.
    moving: amplitudes of the response at the angular frequency ``frequency``; steady: forces of the steady state.
    rotation: of the string, both positive [rad/s].
    Of the elements that meet at the node, each has its largest values. nan without a tube whose diameters are known.
    """
    found = [(np.nan, np.nan, np.nan)]
    for cell, end in neighbours(mesh, node):
        outer, inner = mesh.outer_diameter[cell], mesh.inner_diameter[cell]
        if not outer > inner:
            continue
        area, inertia = np.pi / 4 * (outer**2 - inner**2), np.pi / 64 * (outer**4 - inner**4)
        by_moment = 0.5 * outer / inertia
        one, other = axes[:2] @ moving.moment[cell, end]
        forward, backward = 0.5 * abs(one + 1j * other), 0.5 * abs(one - 1j * other)
        if abs(frequency - rotation) < SAME * rotation:
            forward = 0.0  # turns with the pipe: its stress stays what it is at each point of the section
        turning = float(np.linalg.norm(axes[:2] @ steady.moment[cell, end].real)) if rotation else 0.0
        normal = abs(moving.tension[cell, end]) / area + by_moment * (forward + backward + turning)
        shear = abs(moving.torque[cell]) * 0.5 * by_moment
        found.append((normal, shear, float(steady.tension[cell, end].real) / area))
    normal, shear, mean = np.array(found).T
    if len(found) == 1:
        return np.nan, np.nan, np.nan
    return float(np.nanmax(normal)), float(np.nanmax(shear)), float(np.nanmax(mean))
