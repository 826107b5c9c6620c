"""Quaternion element in motion: effect of the time formulas on spin, constraints and multipliers; comparison
with the ANCF element (manual: verif-quaternion-motion, verif-quaternion-spin)."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.commands.statics import run_statics
from drillpetsc.analysis.linear.modal import run_modes
from drillpetsc.analysis.statics.quaternion_statics import solve_at_rest
from drillpetsc.errors import CaseError
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from drillpetsc.physics.quaternion.beam import spun
from tests.helpers.motion import beam, fixed, integrate, straight
from tests.helpers.wells import simple_well

FORMS = ("index3", "index2", "stabilized")
SPEED, POLAR, STRING = 8.4, 0.05, 2.0


def quaternion(constraint: str = "index3") -> dict:
    return {"formulation": "quaternion", "constraint": constraint}


# ---------------------------------------------------------------------- free rotation
@dataclass
class Spun:
    speed: float  # of the first node [rad/s]
    length: float  # of its parameters
    multiplier: float
    inertia: float  # of an end node [kg m2]


def spin_freely(constraint: str, order: int, step: float, end: float = 1.0) -> Spun:
    item = beam(STRING, 2, 1e6, 1e3, 800.0, 3.0, POLAR)
    model = straight(string=[item], top="free", bottom="free", gravity=0.0, beam=quaternion(constraint))
    m = model.system
    m.set_field("string.quaternion", 0.5 * SPEED * spun(m.field("string.quaternion")), "y")
    integrate(m, end, fixed(step, ts_bdf_order=order, q_snes_stol=1e-9))
    q = m.field("string.quaternion")[0]
    spin = float(model.beam._node_motion(m.assembly)[0, 6])
    return Spun(spin, float(np.linalg.norm(q)), float(m.field("string.multiplier")[0, 0]), POLAR * STRING / 4)


@pytest.mark.parametrize("constraint, share", [("index3", 4), ("stabilized", 8)])
def test_bdf1_brakes_a_free_spin(constraint, share):
    """dW/dt = -W^3 h/share, so W = W0/sqrt(1 + 2 W0^2 h t/share) without torque (manual:
    eq-quat-false-braking, verif-quaternion-spin).

    In the plane of q and q e1 a spinning q rotates by a = W h/2 per step. The rate (q_n - q_(n-1))/h has a
    component (1 - cos a)/h along q, and its difference a transverse component (1 - cos a) sin a 2/h^2 = W^3
    h/8: half of the spurious W' = W^3 h/4. If the rate has no component along q (stabilized), |q'|(1 - cos
    a)/h remains: half as much.
    """
    for step in (0.005, 0.0025):
        expected = SPEED / np.sqrt(1 + 2 * SPEED**2 * step / share)
        assert spin_freely(constraint, 1, step).speed - SPEED == pytest.approx(expected - SPEED, rel=0.02)


def test_bdf2_brakes_it_by_the_start_and_by_the_third_power():
    """Index 3: -W^3 h/4 over PETSc's first half step, then -W^5 h^3/32 (manual: verif-quaternion-spin)."""
    h = 0.01
    expected = SPEED**3 * h / 4 * h / 2 + SPEED**5 * h**3 / 32
    assert SPEED - spin_freely("index3", 2, h).speed == pytest.approx(expected, rel=0.05)


def test_index_2_keeps_the_spin_and_loses_the_length():
    """q_n = q_(n-1) + h q'_n with q_n.q'_n = 0: |q_n|^2 = |q_(n-1)|^2 - h^2 |q'_n|^2 with |q'| = W |q|/2, so
    |q| = (1 + W^2 h^2/4)^(-N/2); the spin rate of the rotating parameters is constant."""
    h = 0.01
    end = spin_freely("index2", 1, h)
    assert end.speed == pytest.approx(SPEED, rel=1e-5)
    assert end.length == pytest.approx((1 + SPEED**2 * h**2 / 4) ** -50, rel=1e-5)


@pytest.mark.parametrize("constraint", FORMS)
def test_the_multiplier_of_the_length_is_inertia_times_speed_squared(constraint):
    """Lagrange's equations of T = J W^2/2, W = 2 (q* q')_1, along q: 2 lambda |q|^2 = 2 J W^2; an end node
    has J = jp L/4."""
    end = spin_freely(constraint, 1, 0.0025)
    assert end.multiplier == pytest.approx(
        end.inertia * (end.speed * end.length**2) ** 2 / end.length**2, rel=1e-6
    )


# ---------------------------------------------------------------------- orders in time
def swing(constraint: str | None, step: float, order: int, end: float = 0.4):
    """Strip of the first benchmark, hinged and horizontal, with a smooth onset of its weight, damped so that
    no oscillation hides the orders: tip, its velocity, force on the hinge."""
    item = beam(0.5, 4, 2000.0, 6.6666667e-4, 1e-3, 0.02, 1.7333e-7, damping={"stiffness": 2e-3})
    weight = {"from": 0.0, "to": 0.5, "force": [0, 0, 0.02 * 9.81], "value_over": {"ramp": 0.2, "value": 1.0}}
    model = straight(
        string=[item],
        top="pinned",
        gravity=0.0,
        loads=[weight],
        initial={"inclination": np.pi / 2},
        beam=quaternion(constraint) if constraint else {},
    )
    m = model.system
    integrate(m, end, fixed(step, ts_bdf_order=order, q_snes_stol=1e-9), breaks=model.breaks)
    force = np.array([m.reaction("top.axial_reaction"), m.reaction("top.side_reaction_1")])
    return m.field("string.position")[-1].copy(), m.field("string.position", "y")[-1].copy(), force


@pytest.fixture(scope="module")
def finest() -> list[np.ndarray]:
    """Extrapolation from BDF2 at 0.2 and 0.4 ms."""
    fine, coarse = swing("index3", 2e-4, 2), swing("index3", 4e-4, 2)
    return [(4 * a - b) / 3 for a, b in zip(fine, coarse, strict=True)]


@pytest.mark.parametrize("constraint, order", [(c, k) for c in FORMS for k in (1, 2)])
def test_order_in_time(finest, constraint, order):
    """Constant steps: order k for positions, velocities and multipliers, also at index 3 (Loetstedt and
    Petzold, Math. Comp. 46, 1986; multipliers lose an order there with changing steps only; manual:
    verif-quaternion-order)."""
    errors = []
    for step in (4e-3, 2e-3, 1e-3):
        found = swing(constraint, step, order)
        errors.append([np.linalg.norm(a - b) for a, b in zip(found, finest, strict=True)])
    e = np.array(errors)
    assert np.log2(e[1] / e[2]) == pytest.approx(float(order), abs=0.2)
    assert e[2, 0] < (6e-4, 1e-4)[order - 1]


def test_it_swings_as_the_ancf_element(finest):
    """Comparison with the ANCF element: tip within a thousandth of the length with four elements."""
    reference = swing(None, 4e-4, 2)
    assert np.linalg.norm(reference[0] - finest[0]) < 5e-4
    assert reference[2] == pytest.approx(finest[2], rel=0.02)


# ---------------------------------------------------------------------- top drive
def driven(constraint: str | None, **case):
    data = {
        "string": [beam(20.0, 4, 1e7, 2e4, 1.5e4, 30.0, 0.3)],
        "gravity": 9.81,
        "initial": {"from": "rest"},
        "beam": quaternion(constraint) if constraint else {},
    }
    return straight(**(data | case))


def test_hook_load_and_torque_of_a_smooth_start_are_mass_times_acceleration():
    """Lowered and rotated by half-cosine ramps so slow that the string moves as a rigid body: hook load m (g
    - a), torque J dW/dt at the middle of the ramp (a = pi v/2T); waves are a per cent (travel time 0.03 s of
    4 s)."""
    T, v, w = 4.0, 2.0, 5.0
    top = {"kind": "top_drive", "rotation": {"ramp": T, "value": w}, "lowering": {"ramp": T, "value": v}}
    for constraint in FORMS:
        model = driven(
            constraint,
            top=top,
            string=[beam(20.0, 2, 1e8, 2e4, 1.5e6, 30.0, 0.3, damping={"stiffness": 5e-3})],
        )
        solve_at_rest(model.system)
        integrate(model.system, T / 2, fixed(0.01))
        m = model.system
        assert -m.reaction("top.axial_reaction") == pytest.approx(
            600.0 * (9.81 - np.pi * v / (2 * T)), rel=3e-3
        )
        assert m.reaction("top.torque_reaction") == pytest.approx(6.0 * np.pi * w / (2 * T), rel=1e-2)


def test_no_drift_over_100_seconds():
    """Stabilized, 2000 steps of 50 ms of a rotating, swinging string: lengths of q, their rates and the
    prescribed end are constant within 1e-9."""
    model = driven(
        "stabilized",
        top={"kind": "top_drive", "rotation": 8.0, "lowering": 0.05},
        gravity=[0.5, 0.0, 9.8],
        string=[beam(20.0, 2, 1e7, 2e4, 1.5e4, 30.0, 0.3, damping={"stiffness": 1e-3, "mass": 0.05})],
    )
    m = model.system
    worst = np.zeros(3)

    def sample(t, dt):
        q, y = m.field("string.quaternion"), m.field("string.quaternion", "y")
        length = np.abs(np.linalg.norm(q, axis=1) - 1).max()
        end = np.abs(m.field("string.position")[0] - [0, 0, 0.05 * t]).max()
        worst[:] = np.maximum(worst, [length, np.abs(np.sum(q * y, axis=1)).max(), end])

    integrate(m, 100.0, fixed(0.05), sample)
    assert np.all(worst < 1e-9)
    assert np.abs(m.field("string.position")[-1, :2]).max() > 0.1  # it does hang askew


# ---------------------------------------------------------------------- whole runs
CASE = {
    "string": [beam(20.0, 4, 1e7, 2e4, 1.5e4, 30.0, 0.3)],
    "gravity": [1.0, 0, 9.8],
    "beam": quaternion(),
    "time": {"end": 0.2},
    "top": {"kind": "top_drive", "rotation": {"ramp": 0.1, "value": 8.0}, "lowering": 0.2},
    "output": {"history_every": 0.02, "field_every": 0.1, "probes": [10.0], "checkpoint_every": 0.1},
    "petsc": fixed(2e-3),
}


def test_a_run_writes_its_files_and_restarts_from_its_checkpoint(tmp_path):
    """Histories, probes, fields and energy balance of a run; a run stopped in the middle and restarted has
    the same end."""
    whole = run(Case(**CASE), tmp_path / "whole", progress="silent")
    history = read_table(whole.folder / "history.csv")
    reference = run(Case(**(CASE | {"beam": {}})), tmp_path / "ancf", progress="silent")
    other = read_table(reference.folder / "history.csv")
    assert set(history) == set(other)
    assert history["bit_speed [rad/s]"][-1] == pytest.approx(other["bit_speed [rad/s]"][-1], rel=2e-3)
    assert history["hook_load [N]"][-1] == pytest.approx(other["hook_load [N]"][-1], rel=2e-3)
    assert history["kinetic_energy [J]"][-1] == pytest.approx(other["kinetic_energy [J]"][-1], rel=5e-3)
    assert abs(whole.summary["energy"]["error_share"]) < 0.02
    probes, others = read_table(whole.folder / "probes.csv"), read_table(reference.folder / "probes.csv")
    assert probes["x_10 [m]"][-1] == pytest.approx(others["x_10 [m]"][-1], rel=2e-3)
    assert len(list((whole.folder / "string").glob("*.vtu"))) == 3
    run(Case(**(CASE | {"time": {"end": 0.1}})), tmp_path / "half", progress="silent")
    rest = run(Case(**CASE), tmp_path / "half", restart=True, progress="silent")
    assert rest.summary["final"]["bit_depth [m]"] == pytest.approx(
        whole.summary["final"]["bit_depth [m]"], abs=1e-10
    )
    assert json.loads((whole.folder / "summary.json").read_text())["unknowns"] == 5 * 9 + 6


def test_the_error_control_works_on_the_motion_alone(tmp_path):
    """Adaptive BDF2 at index 3: multipliers and rates are left out of the error norm; with them no step would
    be accepted."""
    result = run(Case(**(CASE | {"petsc": {"ts_rtol": 1e-4}})), tmp_path / "run", progress="silent")
    fixed_run = run(Case(**CASE), tmp_path / "fixed", progress="silent")
    assert result.summary["rejected_steps"] < 0.2 * result.summary["steps"]
    name = "bit_speed [rad/s]"
    assert result.summary["final"][name] == pytest.approx(fixed_run.summary["final"][name], rel=0.01)


PIPE = {"kind": "pipe", "length": 90, "od": 0.127, "id": 0.1086}
WELL = simple_well(100, 0.2159, kind="casing", friction=0.2)
MUD = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.02}}


JOINT = {"kind": "universal", "at": 45.0, "constraint": "stabilised"}
MOTOR = {"kind": "top_drive", "rotation": 8.0, "motor": {"inertia": 2900.0}, "control": {"kind": "stiff"}}


@pytest.mark.parametrize("key, more", [
    ("joints[0].constraint", {"joints": [JOINT]}),
    ("top.kind", {"top": {"kind": "driven", "stiffness": 1e3}}),
    ("top.motor", {"top": MOTOR}),
    ("string", {"string": [{"kind": "body", "length": 1.0, "mass": 100.0, "od": 0.1}]}),
])  # fmt: skip
def test_unsupported_parts_are_refused(key, more):
    with pytest.raises(CaseError) as refused:
        Case(**({"string": [PIPE], "top": "clamped", "beam": quaternion()} | more))
    assert refused.value.at == key and ("quaternion" in refused.value.want or key == "string")


def test_the_end_of_a_run_with_the_other_element_is_refused(tmp_path):
    run(Case(string=[PIPE], top="clamped", time={"end": 1e-3}), tmp_path / "run", progress="silent")
    case = Case(
        string=[PIPE],
        top="clamped",
        beam=quaternion(),
        initial={"from": str(tmp_path / "run")},
        time={"end": 1.0},
    )
    with pytest.raises(CaseError, match="the same string .* with string.strain"):
        run(case, tmp_path / "other", progress="silent")


@pytest.mark.parametrize("command", [lambda case: run_statics(Job(case)), lambda case: run_modes(Job(case))])
def test_commands_for_the_ancf_element_only(command):
    with pytest.raises(CaseError, match="not with quaternion yet"):
        command(Case(string=[PIPE], top="clamped", beam=quaternion()))


@pytest.mark.parametrize("constraint, options, key", [
    ("index3", {"ts_type": "arkimex"}, "petsc.ts_type"),
    ("stabilized", {"snes_type": "newtonls"}, "beam.constraint"),
])  # fmt: skip
def test_solvers_for_other_systems_are_refused(constraint, options, key):
    with pytest.raises(CaseError) as refused:
        integrate(driven(constraint, top="clamped").system, 0.01, fixed(1e-3, **options))
    assert refused.value.at == key


@pytest.mark.parametrize("constraint", ["index3", "index2"])
def test_the_assembled_system_takes_the_same_steps(constraint):
    """PETSc's Newton solver on the whole first-order system, and beuler for BDF1: the condensed solution
    within its tolerance."""
    top = {"kind": "top_drive", "rotation": {"ramp": 0.02, "value": 8.0}}

    def end(**options):
        m = driven(constraint, top=top, gravity=[3.0, 0.0, 9.81]).system
        integrate(m, 0.02, fixed(1e-3, q_snes_stol=1e-9, **options))
        return np.append(m.field("string.position")[-1], m.reaction("top.axial_reaction") * 1e-5)

    assert end(snes_type="newtonls") == pytest.approx(end(), abs=1e-7)
    assert end(ts_type="beuler") == pytest.approx(end(ts_bdf_order=1), abs=1e-7)


def test_a_constraint_belongs_to_the_quaternion():
    with pytest.raises(CaseError, match="constraint"):
        Case(string=[PIPE], top="clamped", beam={"constraint": "index2"})
    case = Case(string=[PIPE], top="clamped", beam={"formulation": "quaternion"})
    assert case.beam.constraint == "index3"
