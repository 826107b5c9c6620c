"""Joints against closed forms, independent integration and reactions from statics (manual:
sec-verif-joints)."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sparse
from scipy.integrate import solve_ivp
from scipy.linalg import eigvalsh
from scipy.optimize import brentq

from drillpetsc import Case
from drillpetsc.analysis.linear import modal as modes
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import move_rigidly, release
from drillpetsc.errors import CaseError
from drillpetsc.fem.component import Component, PrescribedMotion
from drillpetsc.fem.string_mesh import StringJoint
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output.recorder import Recorder
from drillpetsc.physics.end_conditions import EndPlace, FixedEnd, TopDrive
from drillpetsc.physics.joints import RESULT_NAMES, SCALE, STOP_ROUNDING
from drillpetsc.solvers.linear.linearization import linearise
from drillpetsc.solvers.linear.quadratic_eigenproblem import eigenvalues_near
from drillpetsc.time_function import Constant
from tests.helpers.joint_models import body, chain_of_bodies, joint_component, place
from tests.helpers.motion import beam, fixed, integrate, straight
from tests.helpers.wells import simple_well

G = 9.81
EXACT = {"q_snes_stol": 1e-12}
AXIAL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
HINGE = (
    (0.0, 0.0, 1.0),
    (0.0, 1.0, 0.0),
    (-1.0, 0.0, 0.0),
)  # about director 3: across the plane in which a level string swings
UP, NORTH = np.array([0.0, 0.0, -1.0]), np.array([1.0, 0.0, 0.0])


def figure(system, name: str) -> float:
    """A result of the first joint in the present state of the model."""
    return float(joint_component(system).element_results(system.assembly)[0, RESULT_NAMES.index(name)])


# ---------------------------------------------------------------------- double pendulum
def double_pendulum(t: float, inertia: float) -> np.ndarray:
    """Angles from the vertical and their rates of two rods of 1 m and 1 kg, from rest at 90 degrees, after
    ``t`` [s].

    Lagrange's equations of two bodies with centres half way and ``inertia`` about them [kg m2]; DOP853.
    """

    def rate(_, z):
        a, b, da, db = z
        c, s = 0.5 * np.cos(a - b), 0.5 * np.sin(a - b)
        M = np.array([[inertia + 1.25, c], [c, inertia + 0.25]])
        f = np.array([-s * db**2 - 1.5 * G * np.sin(a), s * da**2 - 0.5 * G * np.sin(b)])
        return [da, db, *np.linalg.solve(M, f)]

    return solve_ivp(
        rate, (0.0, t), [np.pi / 2, np.pi / 2, 0.0, 0.0], method="DOP853", rtol=1e-11, atol=1e-12
    ).y[:, -1]


def two_bodies():
    """Two rigid rods, level towards the north, on a pivot and a hinge: no element, 14 unknowns and six
    multipliers."""
    mesh = chain_of_bodies(
        (body(0, 1.0, 1.0, 1e-3, 1 / 12), body(1, 1.0, 1.0, 1e-3, 1 / 12)),
        (StringJoint(1.0, "revolute", 0, HINGE),),
    )
    position = np.array([[0.0, 0, 0], [1.0, 0, 0]])
    return place(
        mesh,
        position,
        NORTH,
        [lambda frames: FixedEnd(EndPlace(position[0], NORTH), "pinned", spin=False)],
        [0, 0, G],
    )


def angles(tangent: np.ndarray) -> np.ndarray:
    return np.arctan2(tangent[:, 0], tangent[:, 2])


@pytest.mark.parametrize("integrator, largest", [("bdf", 1e-4), ("alpha2", 2e-5)])
def test_rigid_double_pendulum_converges_with_order_two(integrator, largest):
    """Angles after 1 s against the independent integration: order 2 +- 0.15, below 1e-4 rad with steps of 1
    ms (manual: verif-double-pendulum); generalised-alpha has a fifth of BDF2's error."""
    exact, errors = double_pendulum(1.0, 1 / 12)[:2], []
    for h in (4e-3, 2e-3, 1e-3):
        system = two_bodies()
        integrate(system, 1.0, fixed(h, ts_type=integrator, **EXACT))
        errors.append(np.abs(angles(system.field("string.tangent")) - exact).max())
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2.0, abs=0.15)
    assert errors[-1] < largest


def two_beams(constraint: str):
    return straight(
        string=[beam(2.0, 2, 1e9, 1e7, 1e7, 1.0, 1e-3)],
        top="pinned",
        gravity=G,
        initial={"inclination": np.pi / 2},
        joints=[{"at": 1.0, "kind": "revolute", "axis": [0, 0, 1], "constraint": constraint}],
    )


@pytest.mark.parametrize("constraint", ["position", "stabilised"])
def test_double_pendulum_of_two_stiff_beams(constraint):
    """From keys of a case file, adaptive steps: within 2e-3 rad of the rigid one after 1 s (-ts_rtol
    1e-5)."""
    model = two_beams(constraint)
    integrate(model.system, 1.0, {"ts_rtol": 1e-5})
    r = model.system.field("string.position")
    assert angles(np.array([r[1], r[3] - r[2]])) == pytest.approx(double_pendulum(1.0, 1 / 12)[:2], abs=2e-3)


def misfits(system) -> tuple[float, float]:
    """Largest violation of the first joint's constraints in position and angle [m, rad], and of their rates
    [m/s, rad/s] by central differences along the motion."""
    asm = system.assembly
    ready = next(b for b in asm.bound_blocks if b.block.name.startswith("joints"))
    flow, x0 = asm.y.copy(), asm.x.copy()
    flow[asm.spin_at[:, 0]] -= asm.transport()
    flow[ready.index[0, 14:]] = 0.0
    rows, h = [], 1e-4
    for k in (0, -2, -1, 1, 2):
        asm.x[:] = x0 + k * h * flow
        asm.x[ready.index[0, 14:]] = 0.0  # no rows of free directions
        rows.append(asm.block_rows(ready, 0.0)[0, 14:20] / SCALE)
    asm.x[:] = x0
    rate = (rows[1] - 8 * rows[2] + 8 * rows[3] - rows[4]) / (12 * h)
    return float(np.abs(rows[0]).max()), float(np.abs(rate).max())


@pytest.mark.parametrize(
    "integrator, step, constraint, end, speed",
    [
        ("bdf", 0.02, "position", 4.0, 1e-2),
        ("bdf", 0.02, "stabilised", 20.0, 2e-9),
        ("alpha2", 0.01, "position", 4.0, 1e-2),
        ("alpha2", 0.01, "stabilised", 4.0, 1e-8),
    ],
)
def test_constraints_do_not_drift(integrator, step, constraint, end, speed):
    """A soft rod with a body of 0.5 m at its end, and a universal joint with another rod below it, swing
    freely in space: violations below 1e-9 (manual: verif-joint-drift).

    Without stabilisation the velocities satisfy the constraints only to the order of the time formula, with it to the tolerance of
    Newton's method (manual: eq-time-convergence).
    """
    rod = beam(1.0, 1, 1e4, 1e2, 1e2, 1.0, 1e-2)
    model = straight(
        string=[
            rod,
            {"kind": "body", "length": 0.5, "mass": 0.4, "inertia": {"axial": 0.01, "transverse": 0.02}},
            rod,
        ],
        top="pinned",
        gravity=[2.0, 3.0, G],
        initial={"inclination": 0.7},
        joints=[{"at": 1.5, "kind": "universal", "axis": [0, 0.6, 0.8], "constraint": constraint}],
    )
    worst, bent = np.zeros(2), []

    def sample(t, dt):
        worst[:] = np.maximum(worst, misfits(model.system))
        bent.append(figure(model.system, "angle"))

    integrate(model.system, end, fixed(step, ts_type=integrator), sample)

    assert max(bent) > 0.3
    assert worst[0] < 1e-9 and worst[1] < speed
    assert constraint == "stabilised" or worst[1] > 1e-6


# ---------------------------------------------------------------------- universal joint
class HeldDirection(Component):
    """A shaft in a bearing: the direction of one node is constant."""

    def __init__(self, node: int, tangent: np.ndarray, across: np.ndarray):
        D = np.zeros((2, 7))
        D[:, 3:6] = across
        value = across @ tangent
        self._condition = PrescribedMotion(
            node, D, lambda t: value, lambda t: np.zeros(2), ("bearing_1", "bearing_2")
        )

    def prescribed(self):
        return (self._condition,)


@pytest.mark.parametrize("bend", [0.2, 0.7])
def test_speed_ratio_of_a_universal_joint(bend):
    """Two shafts at an angle b: omega2/omega1 = cos b/(1 - sin^2 b cos^2 theta), theta from the plane of the
    shafts to the driving pin (e.g. Shigley, Mechanical Engineering Design); the torques have the inverse
    ratio, so no power is lost (manual: verif-universal-joint)."""
    speed, axial, h = 3.0, 0.4, 2e-3
    mesh = chain_of_bodies(
        (body(0, 1.0, 2.0, 0.3, 0.5), body(1, 1.0, 2.0, axial, 0.5)),
        (StringJoint(1.0, "universal", 0, ((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0))),),
    )
    down = -UP
    lower = np.array(
        [0.0, np.sin(bend), np.cos(bend)]
    )  # bent about north, the pin of the part above at the start: theta 90 degrees
    across = np.array([NORTH, np.cross(lower, NORTH)])
    components = [
        lambda frames: TopDrive(EndPlace(np.zeros(3), down), Constant(speed), Constant(0.0)),
        lambda frames: HeldDirection(1, lower, across),
    ]
    system = place(mesh, np.array([[0.0, 0, 0], [0, 0, 1.0]]), down, components)
    tangent = np.array([down, lower])
    system.set_field("string.tangent", tangent)
    system.set_field("string.spin", np.array([[speed], [speed * np.cos(bend)]]), "y")
    ratios, torques = [], []

    def sample(t, dt):
        theta = np.pi / 2 + speed * t
        root = 1 - np.sin(bend) ** 2 * np.cos(theta) ** 2
        ratio = np.cos(bend) / root
        ratios.append(system.field("string.spin", "y")[1, 0] / speed - ratio)
        # torque on the driven shaft: axial inertia times d(omega2)/dt; the driving torque is that times the
        # ratio
        rate = -(speed**2) * np.cos(bend) * np.sin(bend) ** 2 * np.sin(2 * theta) / root**2
        torques.append(figure(system, "torque") - axial * rate * ratio)

    integrate(system, 2.0, fixed(h, **EXACT), sample)

    assert np.abs(ratios).max() < 2e-4
    assert np.abs(torques[4:]).max() < 2e-3 * axial * speed**2


# ---------------------------------------------------------------------- slider
def telescope(**slider):
    """2 m of 20 kg/m with a slider in the middle, hung from a clamp."""
    return {
        "string": [beam(2.0, 2, 1e8, 1e5, 1e5, 20.0, 0.01)],
        "top": "clamped",
        "gravity": G,
        "joints": [{"at": 1.0, "kind": "slider", **slider}],
    }


def test_part_below_a_slider_falls_freely():
    """travel = g t^2/2, no force; the part above is unchanged (manual: verif-slider)."""
    model = straight(**telescope())
    integrate(model.system, 0.3, fixed(1e-3))
    assert figure(model.system, "travel") == pytest.approx(0.5 * G * 0.3**2, rel=2e-5)
    assert abs(figure(model.system, "tension")) < 1e-6


def test_part_below_a_shock_sub_oscillates():
    """A slider with a spring: travel = (m g/k)(1 - cos sqrt(k/m) t) of the rigid part below (20 kg), within 2
    % because of its elasticity."""
    k = 2e4
    model = straight(**telescope(spring=k))
    w, seen = np.sqrt(k / 20.0), []
    integrate(model.system, 0.3, fixed(2e-4), lambda t, dt: seen.append((t, figure(model.system, "travel"))))
    t, travel = np.array(seen).T
    assert travel == pytest.approx(20 * G / k * (1 - np.cos(w * t)), abs=2e-5)


def test_part_below_a_slider_stops_and_comes_to_rest():
    """The part falls on a stop, bounces within the stroke, and is damped to rest, where the stop carries its
    weight: k/2 (q + sqrt(q^2 + e^2)) = m g, with zero force of the damper."""
    k, stroke = 1e6, 0.05
    model = straight(
        **telescope(stroke=[-0.01, stroke], stop_stiffness=k, damping=2e3),
        material={"damping": {"stiffness": 1e-4}},
    )
    most = []
    integrate(model.system, 2.0, {"ts_rtol": 1e-4}, lambda t, dt: most.append(figure(model.system, "travel")))
    rest = brentq(lambda q: 0.5 * k * (q + np.hypot(q, STOP_ROUNDING)) - 20 * G, -1, 1)
    assert most[-1] == pytest.approx(stroke + rest, abs=1e-7)
    assert figure(model.system, "tension") == pytest.approx(20 * G, rel=1e-4)


def test_statics_finds_the_stop_of_a_slider():
    model = build_model(Case(**telescope(stroke=["0 m", "1.5 m"], stop_stiffness=1e8)))
    state = find_equilibrium(model)
    push = 0.5e8 * (np.hypot(1.5, STOP_ROUNDING) - 1.5)  # what the rounded law of the other stop still gives
    rest = brentq(lambda q: 0.5e8 * (q + np.hypot(q, STOP_ROUNDING)) - push - 20 * G, -1, 1)
    assert state.stable
    assert figure(model.system, "travel") == pytest.approx(1.5 + rest, abs=1e-8)
    assert figure(model.system, "tension") == pytest.approx(20 * G, rel=1e-6)


def test_modes_of_a_hinged_string():
    """Two rods of 1 m and 1 kg on pivots: det(K - w^2 M) = 0 of the double pendulum, in either plane (manual:
    verif-hinged-modes)."""
    model = build_model(
        Case(
            string=[beam(2.0, 4, 1e7, 1e5, 1e5, 1.0, 1e-3)],
            top="pinned",
            gravity=G,
            joints=[{"at": 1.0, "kind": "universal"}],
        )
    )
    modes.prepare_state(model)
    found = modes.modes(model, count=8)
    pendulum = [q for q in found.frequency if 0.1 < q < 10.0]
    M, K = np.array([[1 / 12 + 1.25, 0.5], [0.5, 1 / 12 + 0.25]]), np.diag([1.5 * G, 0.5 * G])
    assert pendulum == pytest.approx(np.repeat(np.sqrt(eigvalsh(K, M)) / (2 * np.pi), 2), rel=1e-5)


@pytest.mark.parametrize("constraint", ["position", "stabilised"])
@pytest.mark.parametrize("kind", ["fixed", "revolute", "universal"])
def test_constraints_leave_no_root_of_their_own(kind, constraint):
    """The multipliers and the motions across a constraint have no finite root: all roots of an undamped hanging string
    with two joints are those of its free motions (6 constraints of 7 unknowns for a fixed joint, its two slopes keep
    their lengths), each of them on the imaginary axis.  Their vectors satisfy the rows of the whole system, with the
    joints' forces (manual: sec-eigen-constraints)."""
    model = build_model(
        Case(
            string=[beam(2.0, 4, 1e7, 1e5, 1e5, 1.0, 1e-3)],
            top="clamped",
            gravity=G,
            joints=[{"at": 1.0, "kind": kind, "constraint": constraint}, {"at": 1.5, "kind": "universal"}],
        )
    )
    modes.prepare_state(model, "rest")
    system = linearise(model.system)
    problem = system.eigenproblem(10.0)
    held = {"fixed": 6, "revolute": 5, "universal": 4}[kind] + 4
    assert problem.K.shape[0] == 7 * model.mesh.nodes - 7 + 1 - held  # a clamp leaves the slope's length
    found = eigenvalues_near(problem, 3.0, 8, "dense")
    assert len(found.s) == problem.K.shape[0]
    assert np.abs(found.s.real).max() < 1e-6 * np.abs(found.s).max()
    assert not found.grows.any()
    u, names = system.vectors(found), [f.name for f in model.system.layout.fields]
    K, C, M = (sparse.csr_matrix(system.T.T @ A) for A in (system.K, system.C, system.M))
    low = np.abs(found.s) < 100.0
    parts = np.array([K @ u, (C @ u) * found.s, (M @ u) * found.s**2])[:, :, low]
    assert np.abs(parts.sum(axis=0)).max() < 1e-8 * np.abs(parts).max()
    loads = system.field == names.index("joint.load")
    assert (np.abs(u[loads]).max(axis=0)[low] * SCALE > 1e-3).all()


def test_whole_assembled_system_takes_the_same_steps():
    """BDF with PETSc's own Newton solver on all unknowns; other integrators and stabilised velocities are
    refused."""
    tips = []
    for options in ({}, {"snes_type": "newtonls"}):
        model = straight(
            string=[beam(2.0, 2, 1e4, 1e2, 1e2, 1.0, 1e-3)],
            top="pinned",
            gravity=G,
            initial={"inclination": 0.7},
            joints=[{"at": 1.0, "kind": "revolute", "axis": [0, 0, 1]}],
        )
        integrate(model.system, 0.1, fixed(1e-3, **options))
        tips.append(model.system.field("string.position")[-1])
    assert tips[0] == pytest.approx(tips[1], abs=1e-8)
    with pytest.raises(CaseError, match="ts_type"):
        integrate(two_beams("position").system, 0.1, {"ts_type": "arkimex"})
    with pytest.raises(CaseError, match="joints"):
        integrate(two_beams("stabilised").system, 0.1, {"snes_type": "newtonls"})


def test_a_string_without_joints_has_no_joint_data():
    """Without joints no field, no block, no column; with one joint one more node (7 unknowns) and six
    multipliers."""
    case = {"string": [beam(2.0, 2, 1e4, 1e2, 1e2, 1.0, 1e-3)], "top": "pinned"}
    without, joined = (
        build_model(Case(**case, joints=joints)) for joints in ([], [{"at": 1.0, "kind": "universal"}])
    )
    assert joined.system.layout.size - without.system.layout.size == 13
    assert not any("joint" in name for name in without.system.layout.dofs) and without.system.multipliers == 0
    assert {b.block.name for b in without.system.assembly.bound_blocks} == {"beam"}
    assert not any(name.startswith("joint") for name, _ in Recorder(without).columns)
    assert {f"joint_1_{name}" for name in ("force", "torque", "angle", "travel")} <= {
        name for name, _ in Recorder(joined).columns
    }


# ---------------------------------------------------------------------- reactions worked out by hand
def test_reactions_of_a_swinging_rod():
    """A rod of mass m and length l falls from level about a hinge under a clamped body (manual:
    verif-joint-reactions).

    With c = cos of the angle from the vertical the hinge carries m g c + m w^2 l/2 along and m g sin/4 across
    the rod, w^2 = 3 g c/l (energy); order 2 in the step.
    """
    m, l, end, errors = 3.0, 1.2, 0.35, []
    for h in (2e-3, 1e-3):
        bodies = body(0, 0.5, 1.0, 1e-3, 0.1), body(1, l, m, 1e-3, m * l**2 / 12)
        mesh = chain_of_bodies(bodies, (StringJoint(0.5, "revolute", 0, HINGE),))
        position = np.array([[0.0, 0, 0], [0.5, 0, 0]])
        system = place(
            mesh,
            position,
            NORTH,
            [lambda frames: FixedEnd(EndPlace(np.zeros(3), NORTH), "clamped")],
            [0, 0, G],
        )
        integrate(system, end, fixed(h, **EXACT))
        t = system.field("string.tangent")[1]
        c = t[2] / np.linalg.norm(t)
        force = -SCALE * system.field("joint.load")[1, :3]  # on the rod
        side = np.cross([0, 1.0, 0], t)  # across, upwards on the way down
        along, across = -force @ t, force @ side
        errors.append([along - m * G * c - 1.5 * m * G * c, across - m * G * np.sqrt(1 - c**2) / 4])
    errors = np.abs(errors).max(axis=1)
    assert c > 0.5
    assert errors[-1] < 1e-4 * m * G
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.3)


def test_reactions_in_a_hanging_turned_string():
    """Weight of the part below a joint, and the moment at the lower end, through every kind of joint that
    carries them."""
    for kind in ("fixed", "revolute", "universal"):
        model = build_model(
            Case(
                string=[beam(6.0, 3, 1e8, 1e5, 1e5, 20.0, 0.01)],
                top="clamped",
                gravity=G,
                joints=[{"at": 2.5, "kind": kind}],
                bottom={"kind": "force", "force": [0, 0, 500], "moment": [0, 0, -70.0]},
            )
        )
        state = find_equilibrium(model)
        assert state.equilibrium.converged
        assert figure(model.system, "tension") == pytest.approx(20.0 * 3.5 * G + 500.0, rel=1e-9)
        assert figure(model.system, "torque") == pytest.approx(70.0, rel=1e-9)
        assert figure(model.system, "side_force") < 1e-6 and figure(model.system, "bending") < 1e-6


def test_reactions_of_a_level_beam_with_a_hinge():
    """Gerber beam, clamped at one end and pinned at the other, with a hinge in the middle: the hinge carries
    the shear w l/4 of the simple beam and no moment; the clamp w l^2/4 (small deflection: 1e-4 of the
    length)."""
    w, length = 2.0 * G, 4.0
    model = build_model(
        Case(
            string=[beam(length, 8, 1e8, 1e6, 1e6, 2.0, 0.01)],
            top="clamped",
            bottom="pinned",
            gravity=G,
            initial={"inclination": np.pi / 2},
            joints=[{"at": 2.0, "kind": "revolute", "axis": [0, 0, 1]}],
        )
    )
    assert find_equilibrium(model).stable
    assert figure(model.system, "side_force") == pytest.approx(w * length / 4, rel=1e-5)
    assert figure(model.system, "bending") < 1e-5
    assert np.hypot(*(model.system.reaction(f"top.side_moment_{i}") for i in (1, 2))) == pytest.approx(
        w * length**2 / 4, rel=1e-5
    )


@pytest.mark.parametrize("first", [True, False])
def test_joint_in_a_pipe_below_a_rigid_item(first):
    """The rigid item lies above the pipe, not above the joint: the string keeps its length and its weight."""
    item = {"kind": "stabilizer", "length": 1.5, "od": 0.2, "mass": 200.0}
    pipe = {"kind": "pipe", "length": 20.0, "od": 0.127, "id": 0.1086, "element_length": 5.0}
    string = [item, pipe] if first else [pipe, item, pipe]
    length = sum(q["length"] for q in string)
    model = build_model(
        Case(string=string, top="clamped", bottom="free", joints=[{"at": length - 10.0, "kind": "universal"}])
    )
    free = build_model(Case(string=string, top="clamped", bottom="free"))
    for m in (model, free):
        assert find_equilibrium(m).stable
    assert model.mesh.rigid_above[model.mesh.is_joint].sum() == 0
    low, other = (m.system.field("string.position")[-1, 2] for m in (model, free))
    assert low == pytest.approx(other, abs=1e-6) and low == pytest.approx(length, abs=1e-3)
    assert model.system.reaction("top.axial_reaction") == pytest.approx(
        free.system.reaction("top.axial_reaction"), rel=1e-9
    )


# ---------------------------------------------------------------------- a joint that joins
def whirling(joints=()) -> np.ndarray:
    """Loads at the top, spin and position of the tip after 0.15 s of an eccentric pipe, a stabiliser and a
    pipe that rotate on the wall of a hole; first the static hook load."""
    pipe = {"kind": "pipe", "length": 6.0, "od": 0.127, "id": 0.1, "element_length": 3.0}
    ball = {"kind": "stabilizer", "length": 0.4, "od": 0.19, "mass": 40.0, "unbalance": 0.05}
    well = simple_well(20, 0.2, 0.5, kind="casing", friction=0.2)
    model = build_model(
        Case(
            string=[{**pipe, "eccentricity": 0.002}, ball, pipe],
            well=well,
            joints=joints,
            top={"kind": "top_drive", "rotation": 6.0},
            material={"damping": {"stiffness": 1e-3}},
        )
    )
    find_equilibrium(model)
    m = model.system
    start = -m.reaction("top.axial_reaction")
    release(model)
    move_rigidly(model)
    integrate(m, 0.15, fixed(1e-3, **EXACT))
    return np.array(
        [
            start, -m.reaction("top.axial_reaction"), m.reaction("top.torque_reaction"),
            m.field("string.spin", "y")[-1, 0], *m.field("string.position")[-1],
        ]
    )  # fmt: skip


@pytest.fixture(scope="module")
def jointless() -> np.ndarray:
    return whirling()


@pytest.mark.parametrize("constraint", ["position", "stabilised"])
@pytest.mark.parametrize("at", [3.0, 6.0, 6.4])
def test_a_fixed_joint_is_no_joint(at, constraint, jointless):
    """A fixed joint changes nothing, with contact, friction, damping and eccentric mass; in a pipe and at
    either end of a rigid item (manual: verif-fixed-joint).

    In a pipe the two parts have separate axial strains at the joint, so results are equal within the error of
    the mesh.
    """
    assert whirling([{"at": at, "kind": "fixed", "constraint": constraint}]) == pytest.approx(
        jointless, rel=1e-6, abs=1e-7
    )
