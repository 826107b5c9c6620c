"""Free and damped motion against independent integration and closed forms; what friction and impacts do to a short string."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from drillpetsc import Case, run
from drillpetsc.field import Prescribed
from drillpetsc.rooms.bodies import Bodies, Passive
from drillpetsc.rooms.contact import Contact, ContactLaw
from drillpetsc.tubulars import uniform_string
from drillpetsc.well import Well
from tests.verify import moving
from tests.verify.motion import beam, fixed, integrate, straight


def rod(model) -> tuple[np.ndarray, np.ndarray]:
    """Momentum [kg m/s] and angular momentum [kg m2/s] of a string without bodies."""
    asm, place = model.assembly, model.layout.place
    x, y, a = asm.x.copy(), asm.y.copy(), asm.a.copy()
    asm.a[:], asm.y[:] = y, 0.0
    with_inertia = asm.residual(0.0).copy()
    asm.a[:] = 0.0
    p = with_inertia - asm.residual(0.0)
    asm.x[:], asm.y[:], asm.a[:] = x, y, a
    r, v = model.field("string.position"), model.field("string.tangent")
    linear, slope, spin = (p[place[f"string.{k}"]] for k in ("position", "tangent", "spin"))
    t = v / np.linalg.norm(v, axis=1)[:, None]
    return linear.sum(axis=0), (np.cross(r, linear) + np.cross(v, slope) + spin * t).sum(axis=0)


# ---------------------------------------------------------------------- free motion
def test_free_tumbling_string_keeps_momentum_and_nearly_energy():
    """No forces: momentum to rounding (a linear invariant of BDF); energy and angular momentum drift with order 2 or better."""
    drift = []
    for step in (0.02, 0.01, 0.005):
        scene = straight(string=[beam(2.0, 6, 1e5, 40.0, 30.0, 1.0, 0.05)], top="free", bottom="free", gravity=0.0)
        m = scene.model
        r, turn = scene.position - [0, 0, 1.0], np.array([1.0, 2.0, 0.0])
        m.set_field("string.position", np.cross(turn, r) + [0.3, -0.2, 0.1], "y")
        m.set_field("string.tangent", np.cross(turn, scene.tangent), "y")
        m.set_field("string.spin", np.full((7, 1), 5.0), "y")
        before, energy = rod(m), sum(m.energies(0.0))
        integrate(m, 3.0, fixed(step, q_snes_stol=1e-10))
        after = rod(m)
        assert after[0] == pytest.approx(before[0], abs=1e-9)
        drift.append([abs(sum(m.energies(3.0)) / energy - 1), np.linalg.norm(after[1] - before[1]) / np.linalg.norm(before[1])])
    drift = np.array(drift)
    assert np.all(drift[-1] < 2e-4)
    assert np.all(np.log2(drift[:-1] / drift[1:]) > 1.8)


def pendulum():
    """The strip of the first benchmark with four elements, hinged, from the horizontal."""
    return straight(string=[beam(0.5, 4, 2000.0, 6.6666667e-4, 1e-3, 0.02, 1.7333e-7)], top="pinned", gravity=9.81,
                    initial={"inclination": np.pi / 2})


def independent(end: float) -> np.ndarray:
    """Tip of the pendulum at ``end`` by DOP853 on M a = -R(x, y, a = 0), written out here without the time integration of the package."""
    m = pendulum().model
    asm, layout = m.assembly, m.layout
    asm.jacobian(0.0, (0.0, 0.0, 1.0), condensed=False)
    M = np.zeros((layout.size, layout.size))
    keep = (asm.rows >= 0) & (asm.columns >= 0)
    np.add.at(M, (asm.rows[keep], asm.columns[keep]), asm.values[keep])
    held = np.concatenate([f.rows[np.any(f.D != 0, axis=0)] for f in asm.fixed])
    free = np.setdiff1d(np.arange(layout.size), held)
    solve, n = scipy.linalg.lu_factor(M[np.ix_(free, free)]), len(free)

    def rate(t, z):
        asm.x[free], asm.y[free], asm.a[:] = z[:n], z[n:], 0.0
        a = -scipy.linalg.lu_solve(solve, asm.residual(t)[free])
        flow = asm.y.copy()
        flow[asm.spin_at[:, 0]] -= asm.transport()
        return np.concatenate([flow[free], a])

    start = np.concatenate([asm.x[free], asm.y[free]])
    asm.x[free] = solve_ivp(rate, (0.0, end), start, method="DOP853", rtol=1e-9, atol=1e-11).y[:n, -1]
    return m.field("string.position")[-1].copy()


def test_flexible_pendulum_converges_with_order_two():
    """Large rotation and bending: fixed steps of BDF2 against an independent integrator, order 2 +- 0.15."""
    exact, errors = independent(0.4), []
    for step in (1e-3, 5e-4, 2.5e-4):
        m = pendulum().model
        integrate(m, 0.4, fixed(step, q_snes_stol=1e-11))
        errors.append(np.linalg.norm(m.field("string.position")[-1] - exact) / 0.5)
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(2.0, abs=0.15)
    assert errors[-1] < 2e-4


def test_tolerance_rules_the_error_of_the_pendulum():
    """-ts_rtol a hundred times smaller: more steps, and an error at least ten times smaller, against the independent integrator."""
    exact, errors, steps = independent(0.4), [], []
    for tolerance in (1e-3, 1e-5):
        m = pendulum().model
        steps.append(integrate(m, 0.4, {"ts_rtol": tolerance}).counters.steps)
        errors.append(np.linalg.norm(m.field("string.position")[-1] - exact) / 0.5)
    assert steps[1] > 3 * steps[0] and errors[1] < 0.1 * errors[0]


# ---------------------------------------------------------------------- torsion
def test_torsional_frequencies_with_a_heavy_bit():
    """P24: 2000 m of drill pipe, J = 300 kg m2 at the free end: c tan x = (string inertia)/J with x = omega L/c; .180895 and .840968 Hz."""
    pipe = {"kind": "pipe", "length": 2000.0, "od": 0.127, "id": 0.1086, "element_length": 20.0}
    bit = {"kind": "body", "length": 0.0, "mass": 1.0, "inertia": {"axial": 300.0, "transverse": 1.0}}
    m = straight(string=[pipe, bit], top="clamped", bottom="free", gravity=0.0,
                 material={"young": 206e9, "poisson": 0.3, "density": 7850.0}).model
    K, _, M = moving.matrices(m)
    spin = m.layout.place["string.spin"][1:, 0]
    found = np.sqrt(scipy.linalg.eigh(K[np.ix_(spin, spin)], M[np.ix_(spin, spin)], eigvals_only=True)[:2]) / 2 / np.pi
    speed, share = np.sqrt(206e9 / 2.6 / 7850.0), 7850.0 * 2 * 5.941888e-6 * 2000.0 / 300.0
    exact = [brentq(lambda x: x * np.tan(x) - share, a + 1e-9, a + np.pi / 2 - 1e-9) * speed / 2000 / 2 / np.pi for a in (0.0, np.pi)]
    assert exact == pytest.approx([0.180895, 0.840968], rel=1e-5)
    assert found == pytest.approx(exact, rel=1e-4)


def test_a_jump_of_the_rotation_through_the_whole_program(tmp_path):
    """A time that stands twice: the surface torque is Z_t (296.371 N m s) times 2 rad/s from the jump on, and nothing before; the first
    characteristic is back after 2L/c = 1.26 s (1000 m of open-ended pipe at 0.63 s)."""
    rotation = {"time": [0.0, 0.2, 0.2, 1.0], "value": [0.0, 0.0, 2.0, 2.0]}
    case = Case(string=[{"kind": "pipe", "length": 1000.0, "od": 0.127, "id": 0.1086}], top={"kind": "top_drive", "rotation": rotation},
                material={"young": 206e9, "poisson": 0.3, "density": 7850.0}, gravity=0.0, initial={"from": "straight"},
                time={"end": 0.8}, output={"history_every": 0.01, "field_every": 1.0})
    result = run(case, out=tmp_path / "out", progress="silent")
    with open(result.folder / "history.csv") as file:
        names = [n.split(" [")[0] for n in file.readline().strip().split(",")]
    rows = np.loadtxt(result.folder / "history.csv", delimiter=",", skiprows=1)
    t, torque = rows[:, names.index("time")], rows[:, names.index("surface_torque")]
    assert np.abs(torque[t < 0.195]).max() < 1e-6
    assert torque[(t > 0.25) & (t < 0.75)].mean() == pytest.approx(2 * 296.371, rel=0.01)


# ---------------------------------------------------------------------- damping and whirl
SHAFT = {"axial_stiffness": 1e7, "bending_stiffness": 1e4, "torsional_stiffness": 1e6, "mass": 10.0, "polar_inertia": 1e-3}
LENGTH = 10.0
OMEGA = (np.pi / LENGTH) ** 2 * np.sqrt(1e4 / 10.0)  # first mode, hinged ends


class Spinning(Passive):
    """A node that is kept in place (where ``held``) and turns at a given speed, free to tilt."""

    def __init__(self, vertex: int, position: np.ndarray, speed: float, held: bool = True):
        D = np.zeros((4, 7))
        D[[0, 1, 2, 3], [0, 1, 2, 6]] = 1.0
        start, rate = np.append(position, 0.0), np.array([0.0, 0.0, 0.0, speed])
        keep = slice(None) if held else slice(3, 4)
        names = ("x", "y", "z", "torque")[keep]
        self._condition = Prescribed(vertex, D[keep], lambda t: (start + rate * t)[keep], lambda t: rate[keep], names)

    def prescribed(self):
        return (self._condition,)


def hinged_shaft(n: int, speed: float, eccentricity: np.ndarray | None = None, **damping):
    """Shaft that turns between hinges; spin already there."""
    mesh = uniform_string(LENGTH, n, **SHAFT, **damping)
    rooms = [lambda f, p, t: Spinning(0, p[0], speed), lambda f, p, t: Spinning(n, p[n], speed)]
    if eccentricity is not None:
        mesh = replace(mesh, eccentricity=np.column_stack([eccentricity, 0 * eccentricity]))
        rooms.append(lambda f, p, t: Bodies(mesh, f, np.zeros(3)))
    model = moving.straight_model(mesh, rooms)
    model.set_field("string.spin", np.full((n + 1, 1), speed), "y")
    return model


def bend(model, x: float, y: float, what: str) -> None:
    """Add the first mode with mid-span amplitudes x, y to positions (what = "x") or rates ("y")."""
    s, k = model.mesh.node_depth, np.pi / LENGTH
    side = np.array([[x, y, 0.0]])
    model.set_field("string.position", model.field("string.position", what) + np.sin(k * s)[:, None] * side, what)
    model.set_field("string.tangent", model.field("string.tangent", what) + k * np.cos(k * s)[:, None] * side, what)


def orbit(model, n: int) -> float:
    return float(np.hypot(*model.field("string.position")[n // 2, :2]))


def growth(speed: float, start: str, turns: float, **damping) -> float:
    """Growth rate of the first mode's amplitude [1/s]: log of sqrt(x^2 + (x'/omega)^2) over some turns."""
    n = 8
    model = hinged_shaft(n, speed, **damping)
    bend(model, 1e-4, 0.0, "x")
    if start == "forward":
        bend(model, 0.0, 1e-4 * OMEGA, "y")

    def size():
        x, u = (model.field("string.position", w)[n // 2, :2] for w in ("x", "y"))
        return np.sqrt(x @ x + u @ u / OMEGA**2)

    first, end = size(), turns * 2 * np.pi / OMEGA
    integrate(model, end, fixed(0.02 / OMEGA, q_snes_stol=1e-10))
    return float(np.log(size() / first) / end)


def test_kelvin_voigt_run_decays_at_beta_omega_squared_over_two():
    """In a run: a shaft at rest, its first mode let go, over 8 periods."""
    beta = 0.01 / OMEGA
    assert growth(0.0, "released", 8.0, stiffness_damping=beta) == pytest.approx(-beta * OMEGA**2 / 2, rel=0.01)


@pytest.mark.parametrize("share", [0.7, 1.3])
def test_internal_damping_whirl_in_a_run(share):
    """Forward whirl of a turning shaft grows at (c_i (Omega/omega - 1) - c_e)/2, c_i = beta omega^2, c_e = alpha: zero at
    Omega = omega (1 + c_e/c_i), the threshold (first order in the damping)."""
    beta, alpha = 0.01 / OMEGA, 0.01 * OMEGA
    speed = share * OMEGA * (1 + alpha / (beta * OMEGA**2))
    rate = 0.5 * (beta * OMEGA**2 * (speed / OMEGA - 1) - alpha)
    assert growth(speed, "forward", 8.0, stiffness_damping=beta, mass_damping=alpha) == pytest.approx(rate, rel=0.03)


@pytest.mark.parametrize("ratio", [0.5, 1.5])
def test_synchronous_whirl_amplitude(ratio):
    """Eccentricity e sin(pi s/L), which is the first mode: started on the orbit e q/(1 - q), q = (Omega/omega)^2, the shaft stays on it."""
    n, e, speed = 16, 1e-3, ratio * OMEGA
    q = ratio**2
    model = hinged_shaft(n, speed, e * np.sin(np.pi * (np.arange(n) + 0.5) / n))
    amplitude, watched = e * q / (1 - q), []
    second = model.frames.second[0]  # the eccentricity points this way at t = 0
    bend(model, *(amplitude * second[:2]), "x")
    bend(model, *(speed * amplitude * np.array([-second[1], second[0]])), "y")
    integrate(model, 3 * 2 * np.pi / OMEGA, fixed(0.02 / OMEGA), lambda t, dt: watched.append(orbit(model, n)))
    assert np.array(watched) == pytest.approx(abs(amplitude), rel=0.01)


# ---------------------------------------------------------------------- contact
def hole(radius: float, friction: float) -> Well:
    return Well.from_survey(np.array([0.0, 50.0]), np.zeros(2), np.zeros(2), [50.0], [radius], [friction])


def block(well: Well, law: ContactLaw, radius: float, rooms=(), mass: float = 25.0, polar: float = 0.1):
    """A stiff piece of 1 m in a vertical hole."""
    mesh = uniform_string(1.0, 1, axial_stiffness=1e9, bending_stiffness=1e10, torsional_stiffness=1e8, mass=mass, polar_inertia=polar,
                          outer_diameter=2 * radius)
    return moving.straight_model(mesh, [*rooms, lambda f, p, t: Contact(mesh, well, law)])


def test_three_impacts_in_a_row():
    """P05: from 1 m/s, between the walls of a hole: .5, .33670, .25428 at the standard rtol 1e-5."""
    model = block(hole(0.102, 0.3), ContactLaw(restitution=0.5), 0.1)
    model.set_field("string.position", np.tile([1.0, 0, 0], (2, 1)), "y")
    rows = moving.integrate(model, 0.035, lambda m: m.field("string.position", "y")[0, 0], ts_rtol=1e-5, ts_dt=1e-5)
    speeds = []  # where the speed stands still: flights
    for a, b in zip(rows[:-1, 1], rows[1:, 1], strict=True):
        if a == pytest.approx(b, abs=1e-9) and (not speeds or abs(abs(a) - speeds[-1]) > 1e-3):
            speeds.append(abs(a))
    assert speeds == pytest.approx([1.0, 0.5, 0.33670, 0.25428], rel=0.01)


def test_wall_brake():
    """P09: J 20 kg m2 at 15 rad/s, pressed on the wall with 2000 N, friction 0.3, radius 63.5 mm: stops after J w/(mu N R) = 7.8740 s and
    9.3989 turns (no slip velocity; the rest of it is left out by extending the straight line)."""
    depth = 2000.0 / 1e8
    well, place = hole(0.108, 0.3), np.array([0.108 - 0.0635 + depth, 0, 0])
    rooms = [lambda f, p, t, k=k: _Position(k, place + [0, 0, k]) for k in (0, 1)]
    model = block(well, ContactLaw(slip_velocity=1e-3, restitution=1.0), 0.0635, rooms, polar=20.0)
    model.set_field("string.position", place + [[0, 0, 0], [0, 0, 1]])
    model.set_field("string.spin", np.full((2, 1), 15.0), "y")
    rows = moving.integrate(model, 9.0, lambda m: [m.field("string.spin", "y")[0, 0], m.field("string.spin")[0, 0]], ts_rtol=1e-5)
    t, speed, angle = rows.T
    line = np.polyfit(t[(speed > 2) & (speed < 14)], speed[(speed > 2) & (speed < 14)], 1)
    assert -line[1] / line[0] == pytest.approx(7.8740, rel=0.005)
    assert angle[-1] / 2 / np.pi == pytest.approx(9.3989, rel=0.005)


class _Position(Passive):
    """Both ends stay where they are and may turn and tilt."""

    def __init__(self, vertex: int, position: np.ndarray):
        still = np.zeros(3)
        self._condition = Prescribed(vertex, np.eye(3, 7), lambda t: position, lambda t: still, ("x", "y", "z"))

    def prescribed(self):
        return (self._condition,)


def whirl(friction: float) -> tuple[float, float]:
    """Rate [rad/s] and orbit radius [m] of a shaft at 120 rpm that friction drives from half the rolling speed."""
    speed, pipe, wall = 4 * np.pi, 0.0857, 0.108
    rooms = [lambda f, p, t, k=k: Spinning(k, p[k], speed, held=False) for k in (0, 1)]
    model = block(hole(wall, friction), ContactLaw(slip_velocity=1e-3), pipe, rooms, mass=50.0)
    start = wall - pipe
    model.set_field("string.position", np.array([[start, 0, 0], [start, 0, 1.0]]))
    model.set_field("string.position", np.tile([0, -0.5 * speed * pipe, 0], (2, 1)), "y")
    model.set_field("string.spin", np.full((2, 1), speed), "y")
    rows = moving.integrate(model, 0.8, lambda m: [*m.field("string.position")[0, :2], *m.field("string.position", "y")[0, :2]],
                            ts_rtol=1e-5, ts_dt=1e-5)
    _, x, y, u, v = rows[rows[:, 0] > 0.7].T
    radius = np.hypot(x, y)
    return float(np.mean((x * v - y * u) / radius**2)), float(radius.mean())


def test_backward_whirl_comes_from_friction_alone():
    """P11: starting at half the rolling speed friction brings the whirl to -omega R_s/orbit radius (-48.2932 rad/s for a rigid wall), to
    0.5 %; the rate does not depend on the friction coefficient, to 1e-4."""
    rates = []
    for friction in (0.1, 0.25, 0.5):
        rate, radius = whirl(friction)
        assert rate == pytest.approx(-4 * np.pi * 0.0857 / radius, rel=0.005)
        assert rate == pytest.approx(-48.2932, rel=0.005)
        rates.append(rate)
    assert rates == pytest.approx([rates[0]] * 3, rel=1e-4)
