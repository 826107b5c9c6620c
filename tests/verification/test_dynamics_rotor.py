"""Material damping, impacts and friction on the wall against closed forms; whirl is in
test_dynamics_motion."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg

from drillpetsc.geometry.well import Well
from drillpetsc.physics.contact import Contact, ContactLaw, damping_factor
from drillpetsc.physics.end_conditions import EndPlace, FixedEnd, Loads, NodeLoad
from tests.helpers.motion import sampled
from tests.helpers.moving import matrices, straight_model
from tests.helpers.uniform_string import uniform_string

SHAFT = {
    "axial_stiffness": 1e7,
    "bending_stiffness": 1e4,
    "torsional_stiffness": 1e6,
    "mass": 10.0,
    "polar_inertia": 0.01,
}
L = 10.0
OMEGA1 = (np.pi / L) ** 2 * np.sqrt(SHAFT["bending_stiffness"] / SHAFT["mass"])  # pinned-pinned, 3.121 rad/s


def shaft(n: int, **more):
    return uniform_string(L, n, **SHAFT, **more)


def _free(system) -> np.ndarray:
    """Free unknowns of a string between hinges with free direction: without positions of the ends and spin of
    the top."""
    place = system.layout.dofs
    gone = {*place["string.position"][0], *place["string.position"][-1], place["string.spin"][0, 0]}
    return np.array([i for i in range(system.layout.size) if i not in gone])


def _roots(system) -> np.ndarray:
    K, C, M = (A[np.ix_(_free(system), _free(system))] for A in matrices(system))
    n = len(K)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-K, -C]])
    B = np.block([[np.eye(n), np.zeros((n, n))], [np.zeros((n, n)), M]])
    return scipy.linalg.eigvals(A, B)


def test_kelvin_voigt_damps_a_bending_mode_with_beta_omega_squared_over_two():
    """sigma = E (eps + beta eps'): each mode decays at beta omega^2 / 2 (manual: verif-kelvin-voigt)."""
    beta = 1e-3
    roots = _roots(straight_model(shaft(16, stiffness_damping=beta)))
    for mode in (1, 2, 3):
        omega = mode**2 * OMEGA1
        found = roots[np.argmin(np.abs(roots - 1j * omega))]
        assert found.real == pytest.approx(-beta * omega**2 / 2, rel=2e-3)
        assert abs(found) == pytest.approx(omega, rel=1e-3)


# ---------------------------------------------------------------------- contact
HOLE = Well.from_survey(np.array([0.0, 50.0]), np.zeros(2), np.zeros(2), [50.0], [0.102], [0.3])
LYING = Well.from_survey(np.array([0.0, 50.0]), np.full(2, np.pi / 2), np.zeros(2), [50.0], [0.102], [0.3])


def _block(law: ContactLaw, speed: float):
    """A stiff piece of 1 m and 25 kg, radius 0.1 m, in a hole of radius 0.102 m, moving sideways."""
    mesh = uniform_string(
        1.0,
        1,
        axial_stiffness=1e9,
        bending_stiffness=1e8,
        torsional_stiffness=1e8,
        mass=25.0,
        polar_inertia=0.1,
        outer_diameter=0.2,
    )
    system = straight_model(mesh, [lambda f, p, t: Contact(mesh, HOLE, law)])
    system.set_field("string.position", np.tile([speed, 0.0, 0.0], (2, 1)), "y")
    return system


@pytest.mark.parametrize("tolerance, share", [(1e-5, 0.005), (1e-4, 0.02)])
@pytest.mark.parametrize("restitution", [0.8, 0.5, 0.2])
@pytest.mark.parametrize("law, stiffness", [("linear", 1e8), ("hertz", 1e9)])
def test_restitution_of_an_impact(law, stiffness, restitution, tolerance, share):
    """25 kg at 1 m/s against 1e8 N/m (linear) or 1e9 N/m^1.5 (Hertz) with the factor from d(1+e) =
    ln((1+d)/(1-de)): rebound e within 0.5 % at -ts_rtol 1e-5, within 2 % at the default 1e-4 (manual:
    verif-impact-restitution)."""
    system = _block(
        ContactLaw(stiffness=stiffness, law=law, restitution=restitution, slip_velocity=1e-2), 1.0
    )
    rows = sampled(system, 0.0065, lambda m: m.field("string.position", "y")[0, 0], ts_rtol=tolerance)
    assert rows[-1, 1] == pytest.approx(-restitution, rel=share)


@pytest.mark.parametrize(
    "law, stiffness, depth",
    [("linear", 1e8, 5.0e-4), ("hertz", 1e9, 9.952679e-4), ("hertz_point", 1e9, 0.75427e-3)],
)
def test_position_tolerance_follows_the_depth_of_impacts(law, stiffness, depth):
    """Elastic depths of 25 kg/m at 1 m/s (manual: verif-elastic-impact). A law per point has half of the mass
    on each of two points of a 1 m element, which multiplies the depth by 2^-0.4. For a soft wall the default
    scale of positions remains."""
    system = _block(ContactLaw(stiffness=stiffness, law=law), 1.0)
    scale = system.scale[system.layout.dofs["string.position"].ravel()]
    assert scale == pytest.approx(depth, rel=1e-5)
    soft = _block(ContactLaw(stiffness=1e3), 1.0)
    assert soft.scale[soft.layout.dofs["string.position"].ravel()] == pytest.approx(0.03)


@pytest.mark.parametrize("restitution, factor", [(0.8, 0.3731462), (0.5, 1.4327505), (0.2, 4.9191667)])
def test_damping_factor(restitution, factor):
    """Damping factor d of d(1+e) = ln((1+d)/(1-de)) (manual: verif-impact-restitution)."""
    assert damping_factor(restitution, 1.0) == pytest.approx(factor, rel=1e-6)


@pytest.mark.parametrize(
    "law, stiffness, duration, depth",
    [("linear", 1e8, 1.570796e-3, 5.0e-4), ("hertz", 1e9, 2.929347e-3, 9.952679e-4)],
)
def test_elastic_impact_duration_and_depth(law, stiffness, duration, depth):
    """Elastic impact of 25 kg at 1 m/s: exact durations and depths of the linear and the Hertz spring
    (manual: verif-elastic-impact)."""
    system = _block(ContactLaw(stiffness=stiffness, law=law, restitution=1.0), 1.0)
    rows = sampled(
        system, 0.007, lambda m: m.field("string.position")[0, 0] + 0.1 - 0.102, ts_rtol=1e-7, ts_dt=1e-5
    )
    t, deep = rows.T
    assert deep.max() == pytest.approx(depth, rel=0.005)
    change = np.flatnonzero(deep[:-1] * deep[1:] < 0)
    crossing = t[change] - deep[change] * (t[change + 1] - t[change]) / (deep[change + 1] - deep[change])
    assert crossing[1] - crossing[0] == pytest.approx(duration, rel=0.01)


def test_creep_of_regularised_friction():
    """F = mu N / 2 on a pipe in a horizontal hole: v = eps F / sqrt((mu N)^2 - F^2) = 5.7735e-4 m/s at eps =
    1e-3 (manual: verif-friction-creep)."""
    mesh = uniform_string(
        1.0,
        1,
        axial_stiffness=1e9,
        bending_stiffness=1e8,
        torsional_stiffness=1e8,
        mass=25.0,
        polar_inertia=0.1,
        outer_diameter=0.2,
    )
    weight = 25.0 * 9.81
    from drillpetsc.fem.discrete_system import DiscreteSystem
    from drillpetsc.geometry.frames import transported_frames
    from drillpetsc.physics.beam import AncfBeam

    position, tangent, _ = LYING.at(np.array([5.0, 6.0]))
    frames = transported_frames(tangent)
    law = ContactLaw(slip_velocity=1e-3, stiffness=1e7)
    load = Loads((NodeLoad(0, force=tuple(0.5 * 0.3 * weight * tangent[0])),), frames)
    system = DiscreteSystem(
        mesh, frames, [AncfBeam(mesh, frames, np.array([0, 0, 9.81])), load, Contact(mesh, LYING, law)]
    )
    system.set_field("string.position", position + np.array([0, 0, 0.002 + weight / 1e7]))
    system.set_field("string.tangent", tangent)
    rows = sampled(
        system, 0.2, lambda m: m.field("string.position", "y")[0] @ tangent[0], ts_rtol=1e-7, ts_dt=1e-5
    )
    # the pipe rocks a little on its elastic bed, undamped at this size: the mean creeps
    assert rows[:, 1][rows[:, 0] > 0.1].mean() == pytest.approx(5.7735e-4, rel=2e-3)


def test_wall_brake_stops_a_spinning_pipe():
    """J = 20 kg m2 at 15 rad/s, N = 2000 N, mu = 0.3, R = 0.0635 m: the pipe stops at 7.8740 s after 9.3989
    revolutions (manual: verif-wall-brake)."""
    hole = Well.from_survey(np.array([0.0, 50.0]), np.zeros(2), np.zeros(2), [50.0], [0.0655], [0.3])
    mesh = uniform_string(
        1.0,
        1,
        axial_stiffness=1e9,
        bending_stiffness=1e9,
        torsional_stiffness=1e9,
        mass=25.0,
        polar_inertia=20.0,
        outer_diameter=0.127,
    )
    pressed = np.array([0.002 + 2000.0 / 1e8, 0.0, 0.0])
    components = [
        lambda f, p, t: Contact(mesh, hole, ContactLaw(slip_velocity=1e-4)),
        lambda f, p, t: FixedEnd(EndPlace(p[0] + pressed, t[0]), "pinned", spin=False),
        lambda f, p, t: FixedEnd(EndPlace(p[1] + pressed, t[1], 1), "pinned", spin=False),
    ]
    system = straight_model(mesh, components)
    system.set_field("string.position", np.array([pressed, pressed + [0, 0, 1.0]]))
    system.set_field("string.spin", np.full((2, 1), 15.0), "y")
    rows = sampled(
        system, 8.5, lambda m: [m.field("string.spin", "y")[0, 0], m.field("string.spin")[0, 0]], ts_rtol=1e-5
    )
    t, speed, angle = rows.T
    assert 15.0 - np.interp(7.0, t, speed) == pytest.approx(1.905 * 7.0, rel=2e-3)
    assert t[np.flatnonzero(speed > 0.02)[-1]] == pytest.approx(7.8740, rel=0.005)
    assert angle[-1] / (2 * np.pi) == pytest.approx(9.3989, rel=0.005)
