"""Free and damped motion against independent integration and closed forms; friction and impacts of a short
string."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drillpetsc import Case, run
from drillpetsc.fem.component import Component, PrescribedMotion
from drillpetsc.geometry.well import Well
from drillpetsc.physics.contact import Contact, ContactLaw
from drillpetsc.physics.rigid_bodies import RigidBodies
from tests.helpers import moving
from tests.helpers.motion import beam, fixed, integrate, sampled, straight
from tests.helpers.uniform_string import uniform_string


def rod(system) -> tuple[np.ndarray, np.ndarray]:
    """Momentum [kg m/s] and angular momentum [kg m2/s] of a string without bodies."""
    asm, place = system.assembly, system.layout.dofs
    x, y, a = asm.x.copy(), asm.y.copy(), asm.a.copy()
    asm.a[:], asm.y[:] = y, 0.0
    with_inertia = asm.residual(0.0).copy()
    asm.a[:] = 0.0
    p = with_inertia - asm.residual(0.0)
    asm.x[:], asm.y[:], asm.a[:] = x, y, a
    r, v = system.field("string.position"), system.field("string.tangent")
    linear, slope, spin = (p[place[f"string.{k}"]] for k in ("position", "tangent", "spin"))
    t = v / np.linalg.norm(v, axis=1)[:, None]
    return linear.sum(axis=0), (np.cross(r, linear) + np.cross(v, slope) + spin * t).sum(axis=0)


# ---------------------------------------------------------------------- free motion
def tumble(step: float, end: float) -> tuple[float, float, float]:
    """A stiff free string that tumbles and spins without forces: change of momentum, relative changes of
    energy and angular momentum."""
    model = straight(string=[beam(2.0, 6, 1e7, 4e3, 30.0, 1.0, 0.05)], top="free", bottom="free", gravity=0.0)
    m = model.system
    turn = np.array([1.0, 2.0, 0.0])
    m.set_field("string.position", np.cross(turn, model.position - [0, 0, 1.0]) + [0.3, -0.2, 0.1], "y")
    m.set_field("string.tangent", np.cross(turn, model.tangent), "y")
    m.set_field("string.spin", np.full((7, 1), 5.0), "y")
    (p, h), energy, reference = rod(m), sum(m.energies(0.0)), m.frames.reference.copy()
    integrate(m, end, fixed(step, q_snes_stol=1e-10))
    assert np.any(m.frames.reference != reference) == (
        end > 1.0
    )  # reference frames are updated beyond 120 degrees
    q, k = rod(m)
    return (
        float(np.abs(q - p).max()),
        abs(sum(m.energies(end)) / energy - 1),
        float(np.linalg.norm(k - h) / np.linalg.norm(h)),
    )


def test_free_tumbling_string_keeps_momentum_and_nearly_energy():
    """Momentum is conserved to rounding (a linear invariant of BDF); energy and angular momentum change with
    order 2, also across updates of the reference frames (manual: verif-free-tumbling)."""
    runs = np.array([tumble(h, 0.8) for h in (0.01, 0.005, 0.0025)])
    assert np.all(runs[:, 0] < 1e-10)
    assert np.log2(runs[:-1, 1:] / runs[1:, 1:]) == pytest.approx(2.0, abs=0.15)
    change, energy, turning = tumble(0.005, 3.0)
    assert change < 1e-10 and energy < 5e-4 and turning < 5e-4


SWING = 0.4


def pendulum():
    """The strip of the first benchmark with four elements, hinged and horizontal. Its weight increases within
    0.2 s as a half cosine, so that no unresolved modes are excited."""
    weight = {"from": 0.0, "to": 0.5, "force": [0, 0, 0.02 * 9.81], "value_over": {"ramp": 0.2, "value": 1.0}}
    return straight(
        string=[beam(0.5, 4, 2000.0, 6.6666667e-4, 1e-3, 0.02, 1.7333e-7)],
        top="pinned",
        gravity=0.0,
        loads=[weight],
        initial={"inclination": np.pi / 2},
    )


@pytest.fixture(scope="module")
def independent() -> np.ndarray:
    """Tip of the pendulum after SWING by DOP853 on M a = -R(x, y, a = 0), without the time integration of the
    package."""
    m = pendulum().system
    asm, layout = m.assembly, m.layout
    M = moving.matrices(m)[2]
    held = np.concatenate([f.rows[np.any(f.D != 0, axis=0)] for f in asm.row_replacements])
    free = np.setdiff1d(np.arange(layout.size), held)
    inverse, n = np.linalg.inv(M[np.ix_(free, free)]), len(free)

    def rate(t, z):
        asm.x[free], asm.y[free], asm.a[:] = z[:n], z[n:], 0.0
        a = -inverse @ asm.residual(t)[free]
        flow = asm.y.copy()
        flow[asm.spin_at[:, 0]] -= asm.transport()
        return np.concatenate([flow[free], a])

    start = np.concatenate([asm.x[free], asm.y[free]])
    asm.x[free] = solve_ivp(rate, (0.0, SWING), start, method="DOP853", rtol=1e-8, atol=1e-10).y[:n, -1]
    return m.field("string.position")[-1].copy()


def swing_error(exact: np.ndarray, options: dict) -> tuple[float, int]:
    """Error of the tip over the length, and the number of steps."""
    model = pendulum()
    integrator = integrate(model.system, SWING, options, breaks=model.breaks)
    return float(
        np.linalg.norm(model.system.field("string.position")[-1] - exact) / 0.5
    ), integrator.counters.steps


def test_flexible_pendulum_converges_with_order_two(independent):
    """Large rotation and bending: fixed steps of BDF2 against an independent integrator, order 2 +- 0.15."""
    errors = np.array([swing_error(independent, fixed(h, q_snes_stol=1e-11))[0] for h in (2e-3, 1e-3, 5e-4)])
    assert np.log2(errors[:-1] / errors[1:]) == pytest.approx(2.0, abs=0.15)
    assert errors[-1] < 2e-4


def test_tolerance_controls_the_error_of_the_pendulum(independent):
    """A hundred times smaller -ts_rtol gives more steps and an error at least ten times smaller, against the
    independent integrator."""
    (coarse, few), (fine, many) = (
        swing_error(independent, {"ts_rtol": tolerance}) for tolerance in (1e-3, 1e-5)
    )
    assert many > 3 * few and fine < 0.1 * coarse


# ---------------------------------------------------------------------- torsion


def test_a_jump_of_the_rotation_in_a_case_file(tmp_path):
    """A time that occurs twice is a jump: from then on the surface torque is Z_t (296.371 N m s) times 2
    rad/s, before it zero. The first reflection returns after 2L/c = 1.26 s (1000 m of open-ended pipe)."""
    rotation = {"time": [0.0, 0.2, 0.2, 1.0], "value": [0.0, 0.0, 2.0, 2.0]}
    case = Case(
        string=[{"kind": "pipe", "length": 1000.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}],
        top={"kind": "top_drive", "rotation": rotation},
        material={"young": 206e9, "poisson": 0.3, "density": 7850.0},
        gravity=0.0,
        initial={"from": "straight"},
        time={"end": 0.8},
        output={"history_every": 0.01, "field_every": 1.0},
    )
    result = run(case, out=tmp_path / "out", progress="silent")
    with open(result.folder / "history.csv") as file:
        names = [n.split(" [")[0] for n in file.readline().strip().split(",")]
    rows = np.loadtxt(result.folder / "history.csv", delimiter=",", skiprows=1)
    t, torque = rows[:, names.index("time")], rows[:, names.index("surface_torque")]
    assert np.abs(torque[t < 0.195]).max() < 1e-6
    assert torque[(t > 0.25) & (t < 0.75)].mean() == pytest.approx(2 * 296.371, rel=0.01)


# ---------------------------------------------------------------------- damping and whirl
SHAFT = {
    "axial_stiffness": 1e7,
    "bending_stiffness": 1e4,
    "torsional_stiffness": 1e6,
    "mass": 10.0,
    "polar_inertia": 1e-3,
}
LENGTH = 10.0
OMEGA = (np.pi / LENGTH) ** 2 * np.sqrt(1e4 / 10.0)  # first mode, hinged ends


class Spinning(Component):
    """A node with a given spin, free to tilt; with ``held`` its position is fixed."""

    def __init__(self, vertex: int, position: np.ndarray, speed: float, held: bool = True):
        D = np.zeros((4, 7))
        D[[0, 1, 2, 3], [0, 1, 2, 6]] = 1.0
        start, rate = np.append(position, 0.0), np.array([0.0, 0.0, 0.0, speed])
        keep = slice(None) if held else slice(3, 4)
        names = ("x", "y", "z", "torque")[keep]
        self._condition = PrescribedMotion(
            vertex, D[keep], lambda t: (start + rate * t)[keep], lambda t: rate[keep], names
        )

    def prescribed(self):
        return (self._condition,)


def hinged_shaft(n: int, speed: float, eccentricity: np.ndarray | None = None, **damping):
    """Rotating shaft between hinges, with its spin at the start."""
    mesh = uniform_string(LENGTH, n, **SHAFT, **damping)
    components = [lambda f, p, t: Spinning(0, p[0], speed), lambda f, p, t: Spinning(n, p[n], speed)]
    if eccentricity is not None:
        mesh = replace(mesh, eccentricity=np.column_stack([eccentricity, 0 * eccentricity]))
        components.append(lambda f, p, t: RigidBodies(mesh, f, np.zeros(3)))
    system = moving.straight_model(mesh, components)
    system.set_field("string.spin", np.full((n + 1, 1), speed), "y")
    return system


def bend(system, x: float, y: float, what: str) -> None:
    """Add the first mode with mid-span amplitudes x, y to positions (what = "x") or rates ("y")."""
    s, k = system.mesh.node_depth, np.pi / LENGTH
    side = np.array([[x, y, 0.0]])
    system.set_field(
        "string.position", system.field("string.position", what) + np.sin(k * s)[:, None] * side, what
    )
    system.set_field(
        "string.tangent", system.field("string.tangent", what) + k * np.cos(k * s)[:, None] * side, what
    )


def orbit(system, n: int) -> float:
    return float(np.hypot(*system.field("string.position")[n // 2, :2]))


def growth(speed: float, turns: float, **damping) -> float:
    """Growth rate of the amplitude of forward whirl in the first mode [1/s]: log of sqrt(x^2 + (x'/omega)^2)
    over several turns."""
    n = 8
    system = hinged_shaft(n, speed, **damping)
    bend(system, 1e-4, 0.0, "x")
    bend(system, 0.0, 1e-4 * OMEGA, "y")

    def size():
        x, u = (system.field("string.position", w)[n // 2, :2] for w in ("x", "y"))
        return np.sqrt(x @ x + u @ u / OMEGA**2)

    first, end = size(), turns * 2 * np.pi / OMEGA
    integrate(system, end, fixed(0.02 / OMEGA, q_snes_stol=1e-10))
    return float(np.log(size() / first) / end)


@pytest.mark.parametrize("share", [0.7, 1.3])
def test_internal_damping_whirl_in_a_run(share):
    """Forward whirl of a rotating shaft grows at (c_i (Omega/omega - 1) - c_e)/2, c_i = beta omega^2, c_e =
    alpha; the threshold is Omega = omega (1 + c_e/c_i), to first order in the damping (manual:
    verif-internal-damping-whirl)."""
    beta, alpha = 0.01 / OMEGA, 0.01 * OMEGA
    speed = share * OMEGA * (1 + alpha / (beta * OMEGA**2))
    rate = 0.5 * (beta * OMEGA**2 * (speed / OMEGA - 1) - alpha)
    assert growth(speed, 8.0, stiffness_damping=beta, mass_damping=alpha) == pytest.approx(rate, rel=0.03)


@pytest.mark.parametrize("ratio", [0.5, 1.5])
def test_synchronous_whirl_amplitude(ratio):
    """Eccentricity e sin(pi s/L), the shape of the first mode: started on the orbit e q/(1 - q), q =
    (Omega/omega)^2, the shaft stays on it (manual: verif-synchronous-whirl)."""
    n, e, speed = 32, 1e-3, ratio * OMEGA
    q = ratio**2
    system = hinged_shaft(n, speed, e * np.sin(np.pi * (np.arange(n) + 0.5) / n))
    amplitude, sampled = e * q / (1 - q), []
    second = system.frames.second_director[0]  # the eccentricity points this way at t = 0
    bend(system, *(amplitude * second[:2]), "x")
    bend(system, *(speed * amplitude * np.array([-second[1], second[0]])), "y")
    integrate(
        system, 3 * 2 * np.pi / OMEGA, fixed(0.02 / OMEGA), lambda t, dt: sampled.append(orbit(system, n))
    )
    assert np.array(sampled) == pytest.approx(abs(amplitude), rel=0.01)


# ---------------------------------------------------------------------- contact
def hole(radius: float, friction: float) -> Well:
    return Well.from_survey(np.array([0.0, 50.0]), np.zeros(2), np.zeros(2), [50.0], [radius], [friction])


def block(well: Well, law: ContactLaw, radius: float, components=(), mass: float = 25.0, polar: float = 0.1):
    """A stiff piece of 1 m in a vertical hole."""
    mesh = uniform_string(
        1.0,
        1,
        axial_stiffness=1e9,
        bending_stiffness=1e10,
        torsional_stiffness=1e8,
        mass=mass,
        polar_inertia=polar,
        outer_diameter=2 * radius,
    )
    return moving.straight_model(mesh, [*components, lambda f, p, t: Contact(mesh, well, law)])


def test_three_impacts_in_a_row():
    """From 1 m/s between the walls of a hole: speeds .5, .33670, .25428 (manual: verif-repeated-impacts)."""
    system = block(hole(0.102, 0.3), ContactLaw(restitution=0.5), 0.1)
    system.set_field("string.position", np.tile([1.0, 0, 0], (2, 1)), "y")
    sample = [lambda m, w=w: m.field("string.position", w)[0, 0] for w in "xy"]
    rows = sampled(system, 0.035, lambda m: [f(m) for f in sample], ts_rtol=1e-6, ts_dt=1e-5)
    flight = (rows[:-1, 1] * rows[1:, 1] < 0).nonzero()[0]  # steps across the middle of the hole
    assert np.abs(rows[flight, 2]) == pytest.approx([0.5, 0.33670, 0.25428], rel=0.01)


def whirl(friction: float) -> tuple[float, float]:
    """Rate [rad/s] and orbit radius [m] of a shaft at 120 rpm, driven by friction from half the rolling
    speed."""
    speed, pipe, wall = 4 * np.pi, 0.0857, 0.108
    components = [lambda f, p, t, k=k: Spinning(k, p[k], speed, held=False) for k in (0, 1)]
    system = block(hole(wall, friction), ContactLaw(slip_velocity=1e-3), pipe, components, mass=50.0)
    start = wall - pipe
    system.set_field("string.position", np.array([[start, 0, 0], [start, 0, 1.0]]))
    system.set_field("string.position", np.tile([0, -0.5 * speed * pipe, 0], (2, 1)), "y")
    system.set_field("string.spin", np.full((2, 1), speed), "y")
    rows = sampled(
        system,
        0.8,
        lambda m: [*m.field("string.position")[0, :2], *m.field("string.position", "y")[0, :2]],
        ts_rtol=1e-6,
        ts_dt=1e-5,
    )
    _, x, y, u, v = rows[rows[:, 0] > 0.7].T
    radius = np.hypot(x, y)
    return float(np.mean((x * v - y * u) / radius**2)), float(radius.mean())


def test_backward_whirl_comes_from_friction_alone():
    """Started at half the rolling speed, friction accelerates the whirl to -omega R_s/orbit radius (-48.2932
    rad/s for a rigid wall), within 0.5 %; the rate does not depend on the friction coefficient, within 1e-4
    (manual: verif-backward-whirl)."""
    rates = []
    for friction in (0.1, 0.25, 0.5):
        rate, radius = whirl(friction)
        assert rate == pytest.approx(-4 * np.pi * 0.0857 / radius, rel=0.005)
        assert rate == pytest.approx(-48.2932, rel=0.005)
        rates.append(rate)
    assert rates == pytest.approx([rates[0]] * 3, rel=1e-4)
