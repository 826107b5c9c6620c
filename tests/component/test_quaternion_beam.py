"""Rows of the quaternion element: exact Jacobian, rigid motion, momentum, energy, loads and constraints
(manual: verif-quaternion-component)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.geometry.frames import transported_frames
from drillpetsc.geometry.well import Well
from drillpetsc.physics.contact import ContactLaw
from drillpetsc.physics.end_conditions import EndPlace, NodeLoad
from drillpetsc.physics.quaternion.beam import QuaternionBeam, quaternions, spun, turned
from drillpetsc.physics.quaternion.contact import QuaternionContact
from drillpetsc.physics.quaternion.ends import ConstrainedEnd, QuaternionLoads
from drillpetsc.time_function import Constant, Ramp
from tests.helpers.component_models import GRAVITY, SECTION, SHIFT, both_jacobians, curved_tangents
from tests.helpers.tables import each_row
from tests.helpers.uniform_string import uniform_string

KINDS = [
    "beam", "beam_damped", "beam_curved", "beam_damped_curved", "junction", "junction_damped_curved", "loads",
    "topdrive", "weighted", "pinned", "clamped", "contact", "contact_hertz", "contact_junction",
]  # fmt: skip
FORMS = ["index3", "index2", "stabilized"]


def build(kind: str, seed: int = 3, constraint: str = "index3", gravity=GRAVITY) -> DiscreteSystem:
    """DiscreteSystem of ``kind`` (words joined by _): four bent, stretched, twisted, moving elements with
    random multipliers; |q| = 1."""
    rng = np.random.default_rng(seed)
    mesh, tangents = uniform_string(4.0, 4, **SECTION), curved_tangents(5)
    if "damped" in kind:
        mesh = replace(mesh, stiffness_damping=np.full(4, 0.05), mass_damping=np.full(4, 0.1))
    if "curved" in kind:
        mesh = replace(mesh, curvature=np.tile([0.1, -0.2], (4, 1)))
    if "junction" in kind:  # rigid items of 0.3 m on the second node and of 0.2 m on the last but one
        mesh = replace(mesh, junction=np.array([0, 1, 0, 1, 0], bool), rigid_above=np.array([0, 0.3, 0, 0.2]))
    frames = transported_frames(tangents)
    beam = QuaternionBeam(mesh, frames, np.asarray(gravity), constraint)
    components: list = [beam]
    position = np.cumsum(np.vstack([[0, 0, 0], tangents[:-1]]), axis=0)

    def end(node, places, turns, *inputs):
        components.append(
            ConstrainedEnd(beam, EndPlace(position[node], tangents[node], node), places, turns, *inputs)
        )

    if "loads" in kind:
        components.append(
            QuaternionLoads(
                (
                    NodeLoad(2, (1.0, -2.0, 3.0), (0.5, 0.2, -0.7), (0.3, -0.1, 0.4)),
                    NodeLoad(4, (4.0, 1.0, 2.0), (0.3, 2.0, 1.0), section=True, factor=lambda t: 1 + t),
                ),
                frames,
            )
        )
    if "topdrive" in kind or "weighted" in kind:
        end(
            0,
            2 if "weighted" in kind else 3,
            3,
            None if "weighted" in kind else Constant(0.3),
            Ramp(1.0, 2.0),
        )
    if "pinned" in kind:
        end(0, 3, 1)
        end(4, 3, 0)
    if "clamped" in kind:
        end(4, 3, 3)
    offset, noise = np.zeros(3), 0.1
    if "contact" in kind:
        inclination, azimuth = np.arccos(tangents[:, 2]), np.arctan2(tangents[:, 1], tangents[:, 0])
        well = Well.from_survey(
            np.arange(5.0), inclination, azimuth, [1.7, 10.0], [0.2, 0.26], [0.3, 0.2], max_step=1.0
        )
        law = ContactLaw(
            stiffness=500.0,
            law="hertz" if "hertz" in kind else "linear",
            slip_velocity=0.5,
            static_ratio=1.5,
            points=3,
        )
        components.append(QuaternionContact(mesh, well, law))
        position, offset, noise = np.asarray(well.at(np.arange(5.0))[0]), np.array([0.15, 0.1, 0.0]), 0.02
    system = DiscreteSystem(mesh, frames, components)
    q = turned(beam.start, 2 * rng.standard_normal(5)) + 2 * noise * rng.standard_normal((5, 4))
    system.set_field("string.position", position + offset + noise * rng.standard_normal((5, 3)))
    system.set_field("string.strain", 0.1 * rng.standard_normal((5, 1)))
    system.set_field("string.quaternion", q / np.linalg.norm(q, axis=1, keepdims=True))
    if "junction" in kind:
        system.set_field("string.ratio", 1.0 + 0.1 * rng.standard_normal((5, 1)))
    for f in system.layout.fields:
        if not f.differential:
            system.set_field(f.name, rng.standard_normal((5, f.size)))
    asm = system.assembly
    asm.v0[:], asm.v1[:] = rng.standard_normal(len(asm.v0)), rng.standard_normal(len(asm.v1))
    return system


def on_the_manifold(system: DiscreteSystem) -> None:
    """Rates of the present x without a component along q, and accelerations with the component -q'.q', as in
    the constraint."""
    asm, at = system.assembly, system.layout.dofs["string.quaternion"]
    q, y, a = asm.x[at], asm.y[at], asm.a[at]
    asm.y[at] = y = y - q * np.sum(q * y, axis=1, keepdims=True)
    asm.a[at] = a - q * (np.sum(q * a, axis=1, keepdims=True) + np.sum(y * y, axis=1, keepdims=True))


@each_row("constraint", FORMS)
@each_row("kind", KINDS)
def test_condensed_jacobian_matches_central_differences(kind, constraint):
    """K + shift C + shift^2 M of all rows, with constraints, against fourth-order differences, also for |q|
    != 1."""
    system, t = build(kind, constraint=constraint), 0.4
    at = system.layout.dofs["string.quaternion"]
    system.assembly.x[at] *= np.linspace(0.9, 1.1, 5)[:, None]
    J, F = both_jacobians(system, t, 1e-4)
    names = np.array([f.name for f in system.layout.fields])[system.layout.field_of]
    constrained = np.isin(names, [f.name for f in system.layout.fields if not f.differential])
    for rows in (constrained, ~constrained):
        assert np.abs(J[rows] - F[rows]).max() < 3e-7 * np.abs(J[rows]).max()


@each_row(
    "kind",
    [
        "beam", "beam_damped", "beam_curved", "beam_damped_curved", "junction_damped_curved", "loads",
        "contact", "contact_hertz", "contact_junction",
    ],
)  # fmt: skip
def test_rows_times_velocity_is_the_change_of_energy(kind):
    """y.R = d(kinetic + strain + potential)/dt + dissipated - supplied along a motion that keeps |q| = 1: the
    forces are the gradient of the energies."""
    system, t = build(kind), 0.4
    asm = system.assembly
    asm.condense(SHIFT)
    on_the_manifold(system)
    n = system.layout.size
    power = float(asm.residual(t)[:n] @ asm.y[:n])
    powers = system.powers(t)
    x0, y0, at = asm.x.copy(), asm.y.copy(), system.layout.dofs["string.quaternion"]

    def stored(h):
        asm.x[:], asm.y[:] = x0 + h * y0 + 0.5 * h * h * asm.a, y0 + h * asm.a
        length = np.linalg.norm(asm.x[at], axis=1, keepdims=True)
        asm.x[at] /= length
        return sum(system.energies(t + h))

    h = 1e-4
    rate = (stored(-2 * h) - 8 * stored(-h) + 8 * stored(h) - stored(2 * h)) / (12 * h)
    assert power == pytest.approx(
        rate + powers.dissipated - powers.supplied, rel=2e-7, abs=1e-6 * (abs(rate) + abs(power))
    )


def rigid(turn: np.ndarray, q: np.ndarray) -> np.ndarray:
    """(n, 4) product of the unit quaternion ``turn`` with each row."""
    w, u = turn[0], turn[1:]
    return np.column_stack([w * q[:, 0] - q[:, 1:] @ u, w * q[:, 1:] + q[:, :1] * u + np.cross(u, q[:, 1:])])


@pytest.mark.parametrize("kind", ["beam", "beam_curved"])
def test_a_rigid_motion_changes_no_strain_energy(kind):
    """Objectivity: rotated by half a turn and moved, a bent, twisted string has the same strain energy to
    rounding."""
    system = build(kind)
    before = system.energies(0.0).strain
    turn = np.array([0.1, 0.7, -0.5, 0.5]) / np.linalg.norm([0.1, 0.7, -0.5, 0.5])
    w, u = turn[0], turn[1:]
    R = (w * w - u @ u) * np.eye(3) + 2 * np.outer(u, u) + 2 * w * np.cross(np.eye(3), u)
    system.set_field("string.position", system.field("string.position") @ R.T + [3.0, -2.0, 5.0])
    system.set_field("string.quaternion", rigid(turn, system.field("string.quaternion")))
    assert before > 1.0
    assert system.energies(0.0).strain == pytest.approx(before, rel=1e-12)


def test_a_turning_straight_string_has_no_strain_rate():
    """Kelvin-Voigt damping does not dissipate in a rigid rotation about any axis."""
    system = build("beam_damped", gravity=np.zeros(3))
    m, asm = system.mesh, system.assembly
    for b in asm.bound_blocks:
        if b.block.kernel.startswith("quaternion"):
            b.block.named["alpha"] = 0.0  # damping of the motion in space
    omega = np.array([0.4, -1.1, 0.7])
    q = system.field("string.quaternion")
    asm.y[:] = 0.0
    system.set_field("string.position", np.cross(omega, system.field("string.position")), "y")
    system.set_field("string.quaternion", 0.5 * rigid(np.array([0.0, *omega]), q), "y")
    assert system.energies(0.0).kinetic > 1.0 and m.stiffness_damping.all()
    assert system.powers(0.0).dissipated < 1e-20 * SECTION["axial_stiffness"]


@each_row("kind", ["beam", "beam_damped", "beam_curved"])
def test_inner_forces_and_moments_sum_to_zero(kind):
    """Rows of the free string at rest without gravity do no work on a rigid virtual motion, dq = (0, turn) q
    / 2."""
    system = build(kind, gravity=np.zeros(3))
    asm, place = system.assembly, system.layout.dofs
    asm.x[place["string.multiplier"]] = 0.0
    asm.y[:], asm.a[:] = 0.0, 0.0
    asm.residual(0.0)
    r, q = system.field("string.position"), system.field("string.quaternion")
    F, f = asm.r[place["string.position"]], asm.r[place["string.quaternion"]]
    assert np.abs(F.sum(axis=0)).max() < 1e-11 * np.abs(F).max()
    for axis in np.eye(3):
        work = np.sum(np.cross(axis, r) * F) + np.sum(0.5 * rigid(np.array([0.0, *axis]), q) * f)
        assert abs(work) < 1e-11 * np.abs(F).max()


def test_pure_bending_and_twist_have_the_strains_of_the_arc():
    """Nodes on a helix-free circle of radius R, frames turned by tau per length about the tangent: interior
    curvature 1/R, twist tau, to the fourth order in the element's bend (Hermite interpolation of an arc)."""
    errors = []
    for n in (4, 8):
        mesh = uniform_string(
            1.0,
            n,
            axial_stiffness=1.0,
            bending_stiffness=1.0,
            torsional_stiffness=1.0,
            mass=1.0,
            polar_inertia=1.0,
        )
        s, tau = mesh.node_depth, 0.7
        t = np.column_stack([np.sin(s), 0 * s, np.cos(s)])
        frames = transported_frames(t)
        beam = QuaternionBeam(mesh, frames, np.zeros(3))
        system = DiscreteSystem(mesh, frames, [beam])
        system.set_field("string.position", np.column_stack([1 - np.cos(s), 0 * s, np.sin(s)]))
        system.set_field("string.strain", np.zeros((n + 1, 1)))
        system.set_field("string.quaternion", turned(beam.start, tau * s))
        report = beam.element_results(system.assembly)
        errors.append(
            (np.abs(report[:, 6] - tau).max(), abs(system.energies(0.0).strain - 0.5 * (1 + tau**2)))
        )
        assert errors[-1][0] < 0.02 and report[:, 7] == pytest.approx(1.0, rel=0.02)
    assert errors[0][1] > 10 * errors[1][1]


def test_orientations_follow_the_frames():
    """Each q rotates e1, e2 into tangent and second director; rotated about its own axis, the second into cos
    b2 + sin b3."""
    frames = transported_frames(curved_tangents(6))
    q = turned(quaternions(frames), 0.4)
    e1, e2 = spun(q), np.column_stack([-q[:, 2], -q[:, 3], q[:, 0], q[:, 1]])  # q e1, q e2

    def vector(a, b):  # of a b*
        return b[:, :1] * a[:, 1:] - a[:, :1] * b[:, 1:] - np.cross(a[:, 1:], b[:, 1:])

    third = np.cross(frames.reference, frames.second_director)
    assert np.abs(vector(e1, q) - frames.reference).max() < 1e-14
    assert np.abs(vector(e2, q) - np.cos(0.4) * frames.second_director - np.sin(0.4) * third).max() < 1e-14


def test_first_node_of_a_stretched_section_that_turned():
    """Slope (1 + strain) times the axis, and the angle about it from the frame of the start."""
    beam = build("beam").components[0]
    frame, angle = beam.start[0], 0.7
    q = np.cos(angle / 2) * frame + np.sin(angle / 2) * spun(frame)
    fields = {"position": np.array([[1.0, 2.0, 3.0]]), "strain": np.array([[0.1]]), "quaternion": q[None]}
    place, slope, found = beam.first_node({f"string.{name}": values for name, values in fields.items()})
    assert place.tolist() == [1.0, 2.0, 3.0] and slope == pytest.approx(
        1.1 * curved_tangents(5)[0], rel=1e-12
    )
    assert found == pytest.approx([angle], rel=1e-12)
