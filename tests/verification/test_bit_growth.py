"""Growth of the hole: order in time (manual: verif-growth-order), independence of the node spacing (manual:
verif-freezing-neutral), and rejected steps without effect (manual: verif-rejected-steps)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from drillpetsc import Case, run
from drillpetsc.fem.discrete_system import DiscreteSystem
from drillpetsc.fem.quantity import OneStep
from drillpetsc.fem.string_mesh import RigidItem
from drillpetsc.geometry.growing_hole import GrowingHole
from drillpetsc.geometry.well import Well
from drillpetsc.model.drilling_model import DrillingModel
from drillpetsc.physics.bit.bit_laws import BitContact, BitShape, Layer, Rock
from drillpetsc.physics.bit.bit_side import SideLaw
from drillpetsc.physics.bit.rock_bit import RockBit
from drillpetsc.physics.end_conditions import EndPlace, TopDrive
from drillpetsc.physics.rigid_bodies import RigidBodies
from drillpetsc.solvers.petsc_options import applied
from drillpetsc.solvers.time.time_integrator import TimeIntegrator
from drillpetsc.time_function import Constant
from tests.helpers.bit_models import DRAG, RADIUS, bit_of, drilling, lowered, unknowns
from tests.helpers.motion import beam, fixed, integrate
from tests.helpers.moving import straight_model
from tests.helpers.uniform_string import uniform_string
from tests.helpers.wells import simple_well

MASS, DAMPING, SPRING, BOTTOM, DRILLABILITY = 5e3, 2e4, 2e5, 2e8, 1e-7
LENGTH, RAMP, DOWN = 10.0, 1e-5, np.array([0.0, 0.0, 1.0])


class Wave:
    """Motion of the top: 0.01 t + 0.1 (1 - cos 3t) [m] beyond its start (manual: verif-growth-order)."""

    def value(self, t: float) -> float:
        return 0.01 + 0.3 * np.sin(3 * t)

    def rate(self, t: float) -> float:
        return 0.9 * np.cos(3 * t)

    def integral(self, t: float) -> float:
        return 0.01 * t + 0.1 * (1 - np.cos(3 * t))

    def breaks(self) -> tuple[float, ...]:
        return ()


def spring_bit(post_step: bool) -> tuple[DiscreteSystem, RockBit]:
    """Bit below a spring in equilibrium at t = 0 (100 kN: spring compressed by 0.5 m, bit 0.5 mm in the
    bottom), everything moving down at 10 mm/s.

    The spring is a massless beam with a parallel damper (Kelvin-Voigt) of time constant c/k = 0.1 s.
    """
    mesh = uniform_string(
        LENGTH,
        1,
        axial_stiffness=SPRING * LENGTH,
        bending_stiffness=1e13,
        torsional_stiffness=1e6,
        mass=1e-9,
        polar_inertia=1e-9,
        stiffness_damping=DAMPING / SPRING,
        outer_diameter=0.2,
    )
    mesh = replace(
        mesh, bodies=(RigidItem("bit", "bit", 1, 0.0, 0.0, MASS, 0.0, (0.0, 0.0), 100.0, 100.0, 0.1),)
    )
    depth = LENGTH - 5e-4
    hole = GrowingHole(Well.from_survey([0, depth], [0, 0], [0, 0], [depth], [0.1], [0.0]), 0.05, 0.1, 0.0)
    rock = Rock((Layer(-1.0, DRILLABILITY, 0.0, 1.0, 0.0, 0.2, np.eye(3)),), post_step=post_step)
    bit = RockBit(
        1, BitShape(0.0, 0.1, 0.05), BitContact(BOTTOM, 0.0, SideLaw(BOTTOM, 0.0)), None, rock, hole
    )
    system = straight_model(
        mesh,
        [
            lambda frames, x, t: RigidBodies(mesh, frames, np.zeros(3)),
            lambda frames, x, t: TopDrive(EndPlace(x[0] + 0.5 * DOWN, t[0]), Constant(0.0), Wave()),
            lambda frames, x, t: bit,
        ],
    )
    system.set_field("string.position", np.outer([0.5, LENGTH], DOWN))
    system.set_field("string.tangent", np.outer([1 - 0.5 / LENGTH] * 2, DOWN))
    bit.release_sliding_direction()
    system.set_field("string.position", np.outer([0.01, 0.01], DOWN), "y")
    bit.first_cut(system.assembly)
    return system, bit


def exact_depth(end: float) -> float:
    """Drilled length: m x'' = k (T - x) + c (T' - x') - W, s' = D W, with W the bottom spring with its C1
    onset; explicit method of order 8."""
    top = Wave()

    def weight(d: float) -> float:
        return BOTTOM * (0.0 if d < -RAMP else d if d > RAMP else (d + RAMP) ** 2 / (4 * RAMP))

    def rates(t, q):
        W = weight(q[0] - q[2])
        pull = SPRING * (0.5005 + top.integral(t) - q[0]) + DAMPING * (top.value(t) - q[1])
        return [q[1], (pull - W) / MASS, DRILLABILITY * W]

    return float(
        solve_ivp(rates, (0.0, end), [5e-4, 0.01, 0.0], method="DOP853", rtol=1e-12, atol=1e-16).y[2, -1]
    )


@pytest.mark.parametrize(
    ("post_step", "order", "least", "most"),
    [(False, 2, 1.9, 2.1), (False, 1, 0.95, 1.05), (True, 2, 0.9, 1.1)],
    ids=["bdf2", "bdf1", "post_step"],
)
def test_order_of_the_hole_depth(post_step, order, least, most):
    """With the end of the hole as a state the depth has the order of the integrator; updated between the
    steps, as in the reference paper, it is of order 1 for every integrator (manual: verif-growth-order,
    sec-bit-growth)."""
    errors, exact = [], exact_depth(1.0)
    for step in (0.01, 0.005, 0.0025):
        system, bit = spring_bit(post_step)
        integrate(
            system, 1.0, fixed(step, ts_bdf_order=order, q_snes_stol=1e-14, q_snes_linesearch_type="basic")
        )
        errors.append(abs(bit.progress_of(OneStep(system.assembly, 0.0))[0, 0] - exact))
    measured = np.log2(np.array(errors[:-1]) / errors[1:])
    assert (measured >= least).all() and (measured <= most).all()
    assert errors[-1] < (1e-8 if not post_step and order == 2 else 1e-5)


# ---------------------------------------------------------------------- independence of the node spacing
def vertical_case(freeze: float, rows: float, frames: float) -> Case:
    """Half a metre of new hole in 5 s, vertical, in unsteady motion."""
    lowering = {"time": [0.0, 1.0, 2.0, 5.0], "value": [0.05, 0.15, 0.1, 0.1]}
    pipe = beam(20.0, 2, 6e8, 1e6, 9e5, 30.0, 0.1, od=0.127)
    well = simple_well(20.2, 2 * RADIUS, friction=0.25)
    formation = {"drillability": 2e-6, "rotary_exponent": 0.0, "node_spacing": freeze}
    return Case(
        string=[pipe, {"kind": "bit", "length": 0.2, "od": 2 * RADIUS, "mass": 60.0}],
        well=well,
        bottom="bit",
        top={"kind": "top_drive", "rotation": 0.0, "lowering": lowering},
        formation=formation,
        initial={"from": "straight"},
        time={"end": 5.0},
        output={"history_every": rows, "field_every": frames},
    )


def test_node_spacing_and_output_change_no_step(tmp_path):
    """Nodes of the new hole every 2 cm or every 10 m, 500 rows or 5: identical steps and Newton iterations
    (manual: verif-freezing-neutral)."""
    found = []
    for i, keys in enumerate([(0.02, 0.01, 0.2), (10.0, 1.0, 5.0)]):
        summary = run(vertical_case(*keys), out=tmp_path / f"run{i}", progress="silent").summary
        found.append((summary["steps"], summary["newton_iterations"], summary["rejected_steps"]))
    assert found[0] == found[1]
    stations = [len((tmp_path / f"run{i}" / "trajectory.csv").read_text().splitlines()) for i in (0, 1)]
    assert stations[0] > stations[1] + 15


# ---------------------------------------------------------------------- rejected steps
BEDS = {"dip": 0.6, "dip_azimuth": 1.0, "index_dip": 0.8, "index_strike": 0.9}


def go(model: DrillingModel, times: np.ndarray, every: int, **petsc) -> tuple[np.ndarray, TimeIntegrator]:
    """States (drilled length, position of the end, profile) at ``times``. Every ``every``-th Newton solve is
    made to fail; 0 for none."""
    rows, calls = [], 0
    with applied(petsc):
        integrator = TimeIntegrator(model.system)
        solve = integrator.newton.solve

        def failing(t: float, shift: float) -> int:
            nonlocal calls
            calls += 1
            reason = solve(t, shift)
            return -3 if every and calls % every == 0 else reason

        integrator.newton.solve = failing  # type: ignore[method-assign]
        for a, b in zip([0.0, *times[:-1]], times, strict=True):
            integrator.run(a, b)
            chips = unknowns(model, "bit.chips") if bit_of(model).profiled else []
            rows.append(np.concatenate([unknowns(model, "hole.drilled"), unknowns(model, "hole.end"), chips]))
    return np.array(rows), integrator


@pytest.mark.parametrize("law", ["rop", DRAG | {"exposure": 0.02}], ids=["rop", "drag_bit"])
def test_rejected_steps_have_no_effect(law):
    """With every 7th solve failing after it has changed the state, depth, end, profile and fixed nodes are
    equal within 10 rtol of the drilled length (manual: verif-rejected-steps)."""
    rtol = 1e-5
    runs = []
    times = np.array([0.4, 0.8, 1.2]) if law == "rop" else np.array([0.25, 0.5, 0.75])
    for every in (0, 7):
        formation = {"bit_law": law, "node_spacing": 0.01, "drillability": 1e-6, "rock_anisotropy": BEDS}
        model = drilling(
            formation, lowered(0.08), axial=1e9, bending=1e5, damping=1e-2, stiffness=1e7, inclination=0.3
        )
        states, integrator = go(model, times, every, ts_rtol=rtol)
        runs.append((states, bit_of(model).hole, integrator))
    (one, hole, quiet), (other, beside, noisy) = runs
    assert noisy.counters.rejected > 10 + quiet.counters.rejected
    assert one[-1, 0] > 0.05 and abs(one[-1, 2]) > 1e-3  # new hole, and it walks
    assert other[:, :4] == pytest.approx(one[:, :4], abs=10 * rtol * one[-1, 0])
    assert other[-1] == pytest.approx(
        one[-1], abs=10 * rtol * one[-1, 0]
    )  # the profile once the kink of the first touch is cut away
    a, b = hole.get_state()["nodes"], beside.get_state()["nodes"]
    assert len(a) == len(b)
    assert b[:, :4] == pytest.approx(a[:, :4], abs=10 * rtol * one[-1, 0])
    assert b[:, 4:] == pytest.approx(
        a[:, 4:], abs=10 * rtol * one[-1, 0] / 0.005
    )  # slopes over half an interval


def test_a_reamed_section_ends_the_next_one_where_too_little_is_left_of_it():
    """Sections to 10, 12 and 20 m: reamed to 11.5 m half a metre of the second is left, reamed to 11.95 m none."""
    well = Well.from_survey([0, 20], [0, 0], [0, 0], [10.0, 12.0, 20.0], [0.2, 0.15, 0.1], [0.0, 0.1, 0.2])
    hole = GrowingHole(well, 0.05, 0.1, 0.0)
    hole.widen(0)
    for reamed, to in ((1.5, [11.5, 12.0, 20.0]), (1.95, [11.95, 20.0])):
        hole.widen_to(0, reamed)
        assert hole.well.section_to == pytest.approx(to)
    assert list(hole.well.section_radius) == [0.2, 0.1]
