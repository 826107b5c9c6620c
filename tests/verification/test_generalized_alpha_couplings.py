"""Generalised-alpha with first-order unknowns and multipliers: mud, growth of the hole, joints, controllers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.motion.initial_state import initial_state
from drillpetsc.case import load_case
from drillpetsc.case.blocks.settings import BeamTheory
from drillpetsc.errors import CaseError
from drillpetsc.fem.quantity import OneStep
from drillpetsc.model.drilling_model import build_model
from tests.helpers.joint_models import body, chain_of_bodies, place
from tests.helpers.motion import beam, fixed, integrate, straight
from tests.helpers.wells import newtonian, simple_well
from tests.verification.test_bit_growth import exact_depth, spring_bit
from tests.verification.test_joints import (
    EXACT,
    HINGE,
    NORTH,
    SCALE,
    EndPlace,
    FixedEnd,
    G,
    StringJoint,
)

ALPHA = {"ts_type": "alpha2"}
TIGHT = {"ts_type": "alpha2", "q_snes_stol": 1e-9, "drillpetsc_newton_work": 0}
FLYING = Path(__file__).parents[2] / "cases" / "verification" / "study-flying-beam.yaml"


# ---------------------------------------------------------------------- mud and rock
def test_order_two_of_pressures_and_flows():
    """A pump that starts smoothly into 2000 m of frictionless mud: values and rates of both fields.

    Differences of three runs.  Eight elements, whose highest mode the steps resolve.
    """
    found: dict[str, list[np.ndarray]] = {}
    for h in (8e-3, 4e-3, 2e-3):
        case = Case(
            hold_string=True,
            string=[{"kind": "pipe", "length": 2000.0, "od": 0.127, "id": 0.1086, "element_length": 250.0}],
            bottom="free",
            gravity=0.0,
            fluid=newtonian(
                1200.0, 0.0, bulk_modulus=2.2e9, elastic_walls=False, flow_rate={"ramp": 2.0, "value": 1e-3}
            ),
            time={"end": 2.0},
        )
        model = build_model(case)
        initial_state(model, case, None, None)
        integrate(model.system, 1.5, fixed(h, q_snes_stol=1e-12, **ALPHA), breaks=model.breaks)
        for name in ("bore.pressure", "bore.flow"):
            for what in "xy":
                found.setdefault(name + what, []).append(model.system.field(name, what).copy())
    for name, (a, b, c) in found.items():
        order = np.log2(np.linalg.norm(a - b) / np.linalg.norm(b - c))
        assert order == pytest.approx(2.0, abs=0.1), name


@pytest.mark.parametrize("radius", [0.8, 0.5])
def test_order_two_of_the_hole_depth(radius):
    """Against an explicit method of order 8, as for BDF (manual: verif-growth-order); half of BDF2's error."""
    errors, exact = [], exact_depth(1.0)
    for step in (0.01, 0.005, 0.0025):
        system, bit = spring_bit(False)
        options = {"q_snes_stol": 1e-14, "q_snes_linesearch_type": "basic", "ts_alpha_radius": radius}
        integrate(system, 1.0, fixed(step, **options, **ALPHA))
        errors.append(abs(bit.progress_of(OneStep(system.assembly, 0.0))[0, 0] - exact))
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2.0, abs=0.1)
    assert errors[-1] < 2.5e-9


# ---------------------------------------------------------------------- joints


@pytest.mark.parametrize("stabilised", [False, True])
def test_multipliers_have_order_two(stabilised):
    """Reaction of a hinge to a falling rod, m g c + m w^2 l/2 with w^2 = 3 g c/l: at the end of the step."""
    m, l, end, errors = 3.0, 1.2, 0.35, []
    for h in (4e-3, 2e-3, 1e-3):
        bodies = body(0, 0.5, 1.0, 1e-3, 0.1), body(1, l, m, 1e-3, m * l**2 / 12)
        mesh = chain_of_bodies(bodies, (StringJoint(0.5, "revolute", 0, HINGE, stabilised),))
        position = np.array([[0.0, 0, 0], [0.5, 0, 0]])
        system = place(
            mesh,
            position,
            NORTH,
            [lambda frames: FixedEnd(EndPlace(np.zeros(3), NORTH), "clamped")],
            [0, 0, G],
        )
        integrate(system, end, fixed(h, **EXACT, **ALPHA))
        t = system.field("string.tangent")[1]
        c = t[2] / np.linalg.norm(t)
        force = -SCALE * system.field("joint.load")[1, :3]
        errors.append(abs(-force @ t - m * G * c - 1.5 * m * G * c))
    assert np.log2(np.divide(errors[:-1], errors[1:])) == pytest.approx(2.0, abs=0.1)
    assert errors[-1] < 1e-5 * m * G


def test_jump_of_a_prescribed_velocity_with_a_joint():
    """Two steps after the top begins to turn and to go down at once: rates as with BDF at a fourth of the step."""
    rates = []
    for kind, h in (("alpha2", 1e-6), ("bdf", 2.5e-7)):
        times = [0.0, 0.01, 0.01, 1.0]
        model = straight(
            string=[beam(2.0, 4, 1e5, 100.0, 50.0, 1.0, 0.1)],
            top={
                "kind": "top_drive",
                "rotation": {"time": times, "value": [0.0, 0.0, 10.0, 10.0]},
                "lowering": {"time": times, "value": [0.0, 0.0, 0.5, 0.5]},
            },
            gravity=G,
            joints=[{"at": 0.8, "kind": "universal", "constraint": "stabilised"}],
        )
        options = fixed(h, ts_type=kind, q_snes_stol=1e-10, drillpetsc_newton_work=0)
        integrate(model.system, 0.010002, options, breaks=model.breaks, start=0.00999)
        spin, speed = (model.system.field(name, "y") for name in ("string.spin", "string.position"))
        rates.append(np.hstack([spin[:, 0], speed[:, 2]]))
    assert np.abs(rates[1]).max() == pytest.approx(10.0)
    assert rates[0] == pytest.approx(rates[1], abs=5e-4)


# ---------------------------------------------------------------------- the quaternion element
@pytest.mark.parametrize("constraint", ["index3", "index2", "stabilized"])
def test_order_two_of_the_quaternion_element(constraint):
    """A beam that flies in space after a push (cases/verification/study-flying-beam.yaml), by differences."""
    found = []
    for h in (4e-3, 2e-3, 1e-3):
        case = load_case(FLYING)
        keys = case.model_copy(update={"beam": BeamTheory(formulation="quaternion", constraint=constraint)})
        model = build_model(keys)
        initial_state(model, keys, None, None)
        integrate(model.system, 0.5, fixed(h, **TIGHT), breaks=model.breaks)
        found.append(model.system.field("string.position").copy())
    order = np.log2(np.linalg.norm(found[0] - found[1]) / np.linalg.norm(found[1] - found[2]))
    assert order == pytest.approx(2.0, abs=0.1)


# ---------------------------------------------------------------------- controller of the top drive
def test_controller_states_follow_as_with_fine_steps_of_bdf():
    """A PI-controlled drive spins a string up: speed and torque states against BDF2 with 20 times shorter steps."""

    def end(step: float, **more) -> np.ndarray:
        case = Case(
            string=[beam(50.0, 4, 1e6, 1e3, 2e3, 5.0, 0.5)],
            top={
                "kind": "top_drive",
                "rotation": {"time": [0.0, 0.5, 5.0], "value": [0.0, 5.0, 5.0]},
                "motor": {"inertia": 20.0, "time_constant": 0.02},
                "control": {"kind": "pi", "p": 60.0, "i": 100.0},
            },
            gravity=9.81,
            initial={"from": "statics"},
            time={"end": 1.0},
        )
        model = build_model(case)
        initial_state(model, case, None, None)
        integrate(model.system, 1.0, fixed(step, q_snes_stol=1e-9, **more), breaks=model.breaks)
        names = [f.name for f in model.system.layout.fields if f.physics == "drive"]
        states = [model.system.field(name)[0] for name in names]
        return np.concatenate([*states, model.system.field("string.spin", "y")[0]])

    fine = end(2.5e-4)
    coarse, finer = np.abs(end(5e-3, **ALPHA) - fine), np.abs(end(2.5e-3, **ALPHA) - fine)
    size = np.maximum(np.abs(fine), 1e-6)
    assert (finer / size)[fine != 0].max() < 2e-3
    assert np.linalg.norm(coarse / size) > 2.5 * np.linalg.norm(finer / size)


# ---------------------------------------------------------------------- contact
def test_fixed_steps_across_impacts_are_refused(tmp_path):
    """Above a radius of 0.5 they make energy; the message has the longest step."""
    case = Case(
        well=simple_well(30.0, 0.2159, friction=0.3),
        top="clamped",
        string=[{"kind": "pipe", "length": 20.0, "od": 0.1778, "id": 0.0714, "element_length": 4.0}],
        time={"end": 0.1, "integrator": "generalized_alpha"},
        petsc={"ts_adapt_type": "none", "ts_dt": 0.05},
    )
    with pytest.raises(CaseError, match="shortest impact"):
        run(case, out=tmp_path / "a", progress="silent")
