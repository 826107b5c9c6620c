"""Drilling with a whole string: quasi-static against dynamic runs, step lengths, and balance of forces."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.motion.integrator_choice import make_integrator
from drillpetsc.analysis.motion.quasi_static import QuasiStatic
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import move_rigidly, release
from drillpetsc.fem.quantity import OneStep
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output.recorder import Recorder
from drillpetsc.solvers.petsc_options import applied
from drillpetsc.solvers.time.time_integrator import TimeIntegrator
from tests.helpers.wells import simple_well

GRAVITY, STEEL = 9.80665, 7850.0
PIPE, COLLAR = (0.127, 0.1086), (0.1715, 0.0714)  # outer and inner diameter [m]
PIPE_LENGTH, COLLAR_LENGTH, BIT_LENGTH, BIT_DIAMETER, BIT_MASS = 240.0, 59.5, 0.5, 0.2159, 60.0
DEPTH = PIPE_LENGTH + COLLAR_LENGTH + BIT_LENGTH
TEN_METRES_AN_HOUR = 10 / 3600
MUD = {
    "density": 1200.0,
    "rheology": {"model": "power_law", "consistency": 0.5, "index": 0.7},
    "bulk_modulus": 2e9,
    "flow_rate": 0.03,
}


class Run(NamedTuple):
    """Result of a run; arrays over its steps.

    t [s]; hook, weight: hook load and weight on bit [N]; torque: at the surface and the bit (n, 2) [N m];
    drilled [m]; end: end of the hole (n, 3) [m].
    """

    model: DrillingModel
    integrator: TimeIntegrator
    t: np.ndarray
    hook: np.ndarray
    weight: np.ndarray
    torque: np.ndarray
    drilled: np.ndarray
    end: np.ndarray


def case(
    inclination: float | list[float],
    mode: str,
    end: float,
    *,
    wob: float = 60e3,
    element: float = 10.0,
    **more: Any,
) -> Case:
    """300 m of pipe, collars and bit on bottom in a straight hole, or in one that builds to the last of
    several inclinations [rad]."""
    angles = inclination if isinstance(inclination, list) else [inclination] * 3
    well = simple_well([0, 100, DEPTH], BIT_DIAMETER, angles, 0.35, friction=0.25)
    string = [
        {"kind": "pipe", "length": length, "od": od, "id": bore, "element_length": size}
        for length, (od, bore), size in ((PIPE_LENGTH, PIPE, element), (COLLAR_LENGTH, COLLAR, 0.7 * element))
    ]
    bit = {"kind": "bit", "length": BIT_LENGTH, "od": BIT_DIAMETER, "mass": BIT_MASS, "nozzle_area": 4e-4}
    whole = {
        "well": well,
        "material": {"damping": {"stiffness": 1e-3}},
        "string": [*string, bit],
        "bottom": "bit",
        "formation": {"drillability": 2.8e-8},
        "top": {"kind": "top_drive", "rotation": 4 * np.pi, "lowering": TEN_METRES_AN_HOUR},
        "initial": {"from": "statics", "wob": wob},
        "time": {"end": end, "mode": mode},
    }
    return Case(**{**whole, **more})


def follow(case: Case) -> Run:
    """Run a case as ``drillpetsc run`` does, without files."""
    with applied(case.petsc):
        model = build_model(case)
        quasi = QuasiStatic(model) if case.time.mode == "quasi_static" else None  # type: ignore[union-attr]
        integrator, recorder, state = make_integrator(model, quasi), Recorder(model), find_equilibrium(model)
        if quasi is not None:
            quasi.start(lateral_fraction=state.lateral_fraction)
        else:
            release(model)
            move_rigidly(model)
        rows: list[np.ndarray] = []

        def look(t: float, dt: float) -> None:
            v, bit = recorder.sample(t), model.drilling
            assert bit is not None
            names = "hook_load", "wob", "surface_torque", "bit_torque"
            figures = [recorder.value(v, name) for name in names]
            rows.append(
                np.array(
                    [
                        t,
                        *figures,
                        bit.progress_of(OneStep(model.system.assembly, 0.0))[0, 0],
                        *model.system.field("hole.end")[-1],
                    ]
                )
            )

        integrator.after_step.append(look)
        integrator.run(0.0, case.time.end, model.breaks)  # type: ignore[union-attr]
    q = np.array(rows).T
    return Run(model, integrator, q[0], q[1], q[2], q[3:5].T, q[5], q[6:].T)


def section(diameters: tuple[float, float]) -> float:
    return 0.25 * np.pi * (diameters[0] ** 2 - diameters[1] ** 2)


# ---------------------------------------------------------------------- with inertia and without
def test_quasi_static_drilling_is_the_mean_of_the_motion() -> None:
    """Quasi-static run against the mean of the dynamic one: a hole that builds to 30 degrees, 120 rpm, weight
    on bit rising by a tenth in 6 s (manual: verif-quasi-static-drilling).

    Effect of inertia on the means: the string is a spring of k = 3.6 MN/m above a bit with D = 2.8e-8 m/(s N)
    (time constant 1/(k D) = 10 s), and its waves (2 L/c = 0.12 s) are a hundredth of that. So the difference
    is 1 % of the change of the forces, 0.1 % of the forces. Lateral motion has to displace mud, which
    equilibrium has not: another 0.2 %.  Without the swirl of the mud, which equilibrium leaves out: it adds 7 % to the torque here,
    and statics says so.
    """
    mud = {**MUD, "swirl": "none"}
    still, moving = (
        follow(case([0, 0, np.pi / 6], mode, 6.0, fluid=mud)) for mode in ("quasi_static", "dynamic")
    )
    late = moving.t > 2.0
    span = np.diff(moving.t, prepend=0.0)[late]

    def both(of: str) -> tuple[float, float]:
        ours = getattr(moving, of)[late]
        petsc_names = np.interp(moving.t[late], still.t, getattr(still, of))
        return float(ours @ span / span.sum()), float(petsc_names @ span / span.sum())

    assert moving.weight[-1] > 1.08 * 60e3
    for of in ("hook", "weight"):
        ours, petsc_names = both(of)
        assert ours == pytest.approx(petsc_names, abs=4e-3 * 60e3), (
            of
        )  # 3.003e-3 with a bit whose side is guided
    for k in (0, 1):
        petsc_names = np.interp(moving.t[late], still.t, still.torque[:, k])
        assert moving.torque[late, k] @ span == pytest.approx(petsc_names @ span, rel=5e-3)
    assert moving.drilled[-1] == pytest.approx(still.drilled[-1], abs=3e-3 * moving.drilled[-1])
    assert moving.end[-1] == pytest.approx(still.end[-1], abs=5e-3 * moving.drilled[-1])
    assert len(still.t) < 0.2 * len(moving.t)


# ---------------------------------------------------------------------- steps
def test_depth_does_not_depend_on_the_step() -> None:
    """Five minutes in a hole that builds to 30 degrees, three longest steps and three tolerances: depth within
    1 mm (manual: verif-drilling-step-independence)."""
    choices: list[dict[str, Any]] = [
        {"time": {"end": 300, "mode": "quasi_static", "step": step}} for step in (5, 20, 60)
    ]
    choices += [{"petsc": {"ts_rtol": tolerance}} for tolerance in (1e-3, 1e-5)]
    runs = [follow(case([0, 0, np.pi / 6], "quasi_static", 300.0, **choice)) for choice in choices]
    assert [np.diff(r.t).max() > 0.99 * step for r, step in zip(runs, (5, 20), strict=False)] == [True, True]
    depths, ends = [r.drilled[-1] for r in runs], [r.end[-1] for r in runs]
    assert min(depths) > 0.75
    assert np.ptp(depths) < 1e-3
    assert np.ptp(ends, axis=0).max() < 1e-3


# ---------------------------------------------------------------------- balance of forces
@pytest.mark.parametrize("density", [0.0, 1200.0], ids=["dry", "mud"])
def test_hook_load_weight_on_bit_and_weight_balance(density: float) -> None:
    """Vertical hole, mud at rest: hook load + weight on bit = weight minus that of the displaced mud, within
    0.1 % (manual: verif-drilling-force-balance).

    Steel of 7850 kg/m3, also in the bit, which has mud between its blades. Mud of 2 GPa is denser by 0.1 % at
    300 m (-20 N). Mud that follows the string down is partly carried by the wall (+60 N), and the lowered
    string displaces more mud (-40 N).
    """
    mud = {"fluid": {**MUD, "density": density, "flow_rate": 0.0}} if density else {}
    run = follow(
        case(
            0.0,
            "quasi_static",
            120.0,
            wob=20e3,
            **mud,
            initial={"from": "statics", "wob": 20e3, "imperfection": 0.0},
        )
    )
    volume = section(PIPE) * PIPE_LENGTH + section(COLLAR) * COLLAR_LENGTH
    weight = GRAVITY * (1 - density / STEEL) * (STEEL * volume + BIT_MASS)
    assert run.drilled[-1] > 0.15 and np.ptp(run.weight) > 10e3
    assert run.hook + run.weight == pytest.approx(np.full(len(run.t), weight), rel=1e-3)


def test_side_friction_carries_part_of_the_weight_when_sliding() -> None:
    """Straight hole of 30 degrees without rotation: hook load + weight on bit = W cos I - friction of the
    string and the bit on the wall.

    The friction is 0.25 of the normal force, W sin I minus the force on the top's bearing.
    """
    formation = {"drillability": 2.8e-8, "rotary_exponent": 0.0}
    top = {"kind": "top_drive", "rotation": 0.0, "lowering": TEN_METRES_AN_HOUR}
    run = follow(case(np.pi / 6, "quasi_static", 60.0, wob=20e3, formation=formation, top=top))
    model = run.model
    assert model.contact is not None and model.drilling is not None
    weight = GRAVITY * (STEEL * (section(PIPE) * PIPE_LENGTH + section(COLLAR) * COLLAR_LENGTH) + BIT_MASS)
    normal = sum(
        model.contact.normal_force_of(e, OneStep(model.system.assembly, 0.0))[0]
        for e in range(len(model.mesh.lower))
    )
    normal += model.drilling.element_results(model.system.assembly)[3]
    assert normal == pytest.approx(weight * 0.5, rel=0.03)
    assert run.drilled[-1] > 0.05
    assert run.hook[-1] + run.weight[-1] == pytest.approx(
        weight * np.cos(np.pi / 6) - 0.25 * normal, rel=1e-3
    )
