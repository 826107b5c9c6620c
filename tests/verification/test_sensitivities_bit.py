"""Derivatives of runs whose bit cuts: steady drilling and the groove of the preceding blade in closed form, and runs with the same steps."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from drillpetsc.analysis.sensitivities.keys import key_of
from drillpetsc.analysis.sensitivities.motion.outputs import parsed_outputs
from drillpetsc.analysis.sensitivities.motion.run_of_case import RunSeries
from drillpetsc.case import Case
from drillpetsc.parallel import initialise_petsc
from tests.helpers.bit_models import DRAG, RADIUS, TURNING
from tests.helpers.wells import simple_well
from tests.verification.test_sensitivities_mud import CURVED, INTEGRATORS, assert_slopes, hanging, largest
from tests.verification.test_sensitivities_run import rock_bit, series_of

CUT, FLAT = 0.6 * 60e6 * RADIUS, 60e6 * RADIUS * 1.2e-3  # of DRAG: W = CUT d + FLAT [N/m], [N]


@pytest.fixture(scope="module", autouse=True)
def _petsc() -> None:
    initialise_petsc()


def rod(integrator: str, formation: dict[str, Any], end: float, **changes: Any) -> Case:
    """A rod of 1 m that hardly yields, lowered and turned with a bit on bottom."""
    beam = {
        "kind": "beam", "length": 1.0, "axial_stiffness": 1e12, "bending_stiffness": 1e9, "torsional_stiffness": 1e9, "mass": 10.0,
        "polar_inertia": 1.0, "od": 2 * RADIUS, "element_length": 1.0,
    }  # fmt: skip
    case = {
        "string": [beam],
        "well": simple_well(1.0, 2 * RADIUS),
        "contact": "none",
        "top": {"kind": "top_drive", "rotation": TURNING, "lowering": 8e-3},
        "bottom": {"kind": "bit", "stiffness": 1e8},
        "formation": formation,
        "gravity": 0.0,
        "initial": {"from": "rest"},
        "time": {"end": end, "integrator": integrator},
        "petsc": {"ts_rtol": "1e-5"},
    }
    return Case(**(case | changes))


def drilling(integrator: str, formation: dict[str, Any], end: float, **changes: Any) -> Case:
    """Pipe and collar, which vibrate along and about their axis above a bit that drills."""
    case = {
        "well": simple_well(150.5, 0.2159, friction=0.25),
        "string": [
            {"kind": "pipe", "length": 100.0, "od": 0.127, "id": 0.1086, "element_length": 25.0},
            {"kind": "pipe", "length": 50.0, "od": 0.1715, "id": 0.0714, "element_length": 25.0},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0},
        ],
        "material": {"damping": {"stiffness": 1e-3}},
        "top": {
            "kind": "top_drive",
            "rotation": {"time": [0.0, 0.5], "value": [6.0, 12.0]},
            "lowering": 5e-3,
        },
        "bottom": {"kind": "bit"},
        "contact": "none",
        "formation": formation,
        "initial": {"from": "statics", "wob": 20e3, "imperfection": 0},
        "time": {"end": end, "integrator": integrator},
        "petsc": {"ts_rtol": "1e-5"},
    }
    return Case(**(case | changes))


@INTEGRATORS
def test_a_rock_that_cannot_be_drilled_begins_to(integrator):
    """v = D W |Omega|/Omega_ref, with the speed rounded off at standstill: its derivative by D = 0 at each moment."""
    case = rock_bit(integrator)
    case = Case(**(case._given.keys | {"time": {"end": 3.0, "integrator": integrator}}))
    run = series_of(case, ["formation.drillability"], ["rop", "wob", "bit_speed"])
    q = np.abs(run.values[:, 2]) / (4 * np.pi)
    assert q.max() > 0.05
    exact = run.values[:, 1] * q**2 / np.sqrt(q**2 + 1e-6)
    assert run.flags == ["limit"] and not run.values[:, 0].any()
    assert run.slopes[:, 0, 0] == pytest.approx(exact, rel=1e-6, abs=1e-9 * exact.max())


@INTEGRATORS
def test_steady_drilling(integrator):
    """v = D (Omega/Omega_ref)^a (W/W_ref)^(b-1) W and a given v: d ln W is -1/b, 1/b and -a/b of D, v and Omega."""
    a, b = 0.8, 1.5
    law = {"drillability": 4e-7, "rotary_exponent": a, "weight_exponent": b}
    names = ["formation.drillability", "top.lowering", "top.rotation"]
    run = series_of(rod(integrator, law, 2.0), names, ["wob", "rop"])
    weight, rate = run.values[-1]
    assert rate == pytest.approx(8e-3, rel=1e-6)
    assert weight == pytest.approx(1e5 * (8e-3 / (4e-7 * 1e5)) ** (1 / b), rel=1e-5)
    relative = run.slopes[-1] * [4e-7, 8e-3, TURNING] / run.values[-1][:, None]
    assert relative[0] == pytest.approx([-1 / b, 1 / b, -a / b], rel=1e-5)
    assert relative[1] == pytest.approx([0.0, 1.0, 0.0], abs=1e-5)


@INTEGRATORS
def test_steady_cutting(integrator):
    """W = zeta eps a d + sigma a l, T = eps a^2 d/2 + mu gamma sigma a^2 l/2 with the depth of cut d = 2 pi v/Omega."""
    names = ["specific_energy", "inclination_ratio", "contact_stress", "wear_flat", "friction"]
    names = [*(f"formation.bit_law.{name}" for name in names), "top.lowering", "top.rotation"]
    case = rod(integrator, {"bit_law": DRAG}, 1.5)
    run = series_of(case, names, ["wob", "bit_torque", "rop"])
    cut, rub = CUT * 4e-3, 0.5 * 0.6 * FLAT * RADIUS
    turning = 0.5 * 60e6 * RADIUS**2 * 4e-3
    exact = [
        [cut, cut, FLAT, FLAT, 0.0, cut, -cut],
        [turning, 0.0, rub, rub, rub, turning, -turning],
        [0.0, 0.0, 0.0, 0.0, 0.0, 8e-3, 0.0],
    ]
    values, sizes = np.array([cut + FLAT, turning + rub, 8e-3]), [key_of(case, name).size for name in names]
    assert run.values[-1] == pytest.approx(values, rel=3e-5)
    relative = run.slopes[-1] * sizes / values[:, None]
    assert relative == pytest.approx(exact / values[:, None], abs=5e-5)


@INTEGRATORS
def test_groove_of_the_preceding_blade(integrator):
    """A blade cuts d = u(t) - u(t - tau), tau = 2 pi/(n Omega): by Omega, d(W) = n CUT u'(t - tau) dtau, with the speed a delay ago."""
    low, high, end = 4e-3, 2e-2, 1.0
    lowering = {"time": [0.0, end], "value": [low, high]}
    top = {"kind": "top_drive", "rotation": TURNING, "lowering": lowering}
    case = rod(integrator, {"bit_law": DRAG}, end, top=top)
    run = series_of(case, ["top.rotation"], ["wob"])
    delay = 2 * np.pi / (4 * TURNING)
    late = run.times > 3 * delay
    before = low + (high - low) / end * (run.times[late] - delay)
    exact = -4 * CUT * before * delay / TURNING
    assert run.slopes[late, 0, 0] == pytest.approx(exact, rel=1e-3)
    now = low + (high - low) / end * run.times[late]
    assert (now / before).max() > 1.2  # the present speed would not do


#: new hole of 0.2 m in a slant hole, with nodes of its own: its wall is next to the collar, and the bit pushes on its side
SLANT = {
    "well": simple_well(150.5, 0.2259, 0.6, friction=0.25),
    "contact": {"stiffness": "physical", "restitution": 0.5},
    "top": {"kind": "top_drive", "rotation": {"time": [0.0, 0.5], "value": [6.0, 7.0]}, "lowering": 0.1},
}
#: of a bit that drills: formation, its keys, end [s], other changes of the case
LAWS = {
    "rate of penetration": ({"drillability": 4e-8}, ["formation.drillability", "bottom.friction"], 2.0, {}),
    "axial and torsional": (
        {"drillability": 4e-8, "bit_law": {"kind": "velocity_weakening", "static_friction": 0.5, "dynamic_friction": 0.2, "speed": 3.0}},
        ["formation.drillability", "formation.bit_law.dynamic_friction"],
        2.0,
        {},
    ),
    "groove": ({"bit_law": DRAG}, ["formation.bit_law.specific_energy", "formation.bit_law.wear_flat"], 0.8, {}),
    "slant hole": (
        {"drillability": 1e-5, "bit_anisotropy": 0.2, "overgauge": 1e-3, "node_spacing": 0.25},
        ["formation.drillability", "well.sections[0].friction"],
        2.0,
        SLANT,
    ),
}  # fmt: skip


@INTEGRATORS
@pytest.mark.parametrize("name", LAWS)
def test_five_outputs_by_five_keys(name, integrator):
    """Against differences of runs with the same steps: 2e-5 of output or derivative, whichever is larger.

    The step of the differences at which they are best depends on the key, and further ones are tried while an output is not near
    enough; positions that are rounded leave a few 1e-6 in them.
    """
    formation, own, end, changes = LAWS[name]
    names = [*own, "top.lowering", "top.rotation.value[1]", "string[0].od"]
    words = ["wob.mean", "rop.mean", "surface_torque.rms", "bit_speed.final", "hook_load.mean[0.2:0.7]"]
    columns = [word.partition(".")[0] for word in words]
    case = drilling(integrator, formation, end, **changes)
    outputs = parsed_outputs(words, columns, end)

    def numbers(run: RunSeries) -> list[tuple[float, np.ndarray]]:
        return [q.of(run.times, run.values[:, i], run.slopes[:, i]) for i, q in enumerate(outputs)]

    run = series_of(case, names, columns)
    values, slopes = (np.array(q) for q in zip(*numbers(run), strict=True))
    assert run.flags == [""] * 5
    for k, key in enumerate(key_of(case, n) for n in names):
        sizes = np.maximum(np.abs(values), np.abs(slopes[:, k] * key.size))
        best = np.full(len(words), np.inf)
        for step in (1e-4, 3e-5, 3e-4, 1e-3):
            sides = []
            for sign in (-1, 1):
                beside = series_of(
                    key.changed(case, key.value + sign * step * key.size), [], columns, run.steps
                )
                assert len(beside.times) == len(run.times)
                sides.append(np.array([value for value, _ in numbers(beside)]))
            gap = np.abs(slopes[:, k] * key.size - (sides[1] - sides[0]) / (2 * step))
            best = np.minimum(best, gap)
            if (best < 2e-5 * sizes).all():
                break
        else:
            raise AssertionError((key.name, best / sizes))


@INTEGRATORS
def test_drilling_in_mud(integrator):
    """A bit that builds in flowing mud, its string on the wall of a curved hole: differences of runs with the same steps."""
    string = [
        *hanging(integrator)._given.keys["string"][:2],
        {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0, "nozzle_area": 4e-4},
    ]
    case = hanging(
        integrator,
        **CURVED,
        string=string,
        bottom={"kind": "bit"},
        material={"damping": {"stiffness": 1e-3}},
        formation={"drillability": 4e-6, "bit_anisotropy": 0.2},
        initial={"from": "statics", "wob": 20e3},
        top={"kind": "top_drive", "rotation": {"time": [0.0, 0.5], "value": [5.0, 8.0]}, "lowering": 0.04},
        time={"end": 0.6, "integrator": integrator},
    )
    names = ["formation.drillability", "top.lowering", "fluid.flow_rate.value[2]", "fluid.density"]
    columns = ["hook_load", "pump_pressure", "surface_torque", "rop", "wob"]
    run = series_of(case, names, columns)
    assert run.flags == [""] * 4
    for k, key in enumerate(key_of(case, n) for n in names):
        sizes, values = largest(run, key, k)
        # the weight on bit is read from positions of 400 m, which are rounded
        enough = 5e-4 * sizes + [2e-5, 2e-5, 2e-5, 2e-4, 2e-4] * values
        assert_slopes(case, key, k, columns, run, enough)
