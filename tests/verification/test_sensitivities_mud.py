"""Derivatives of runs with mud: closed forms of a bore, and a string in mud in a curved hole against runs with the same steps."""

from __future__ import annotations

import json

import numpy as np
import pytest
from petsc4py import PETSc

from drillpetsc.analysis.sensitivities.command import Question, run_sensitivities
from drillpetsc.analysis.sensitivities.keys import Key, key_of
from drillpetsc.analysis.sensitivities.motion.outputs import parsed_outputs
from drillpetsc.analysis.sensitivities.motion.run_of_case import RunOfCase, RunSeries
from drillpetsc.arrays import FloatArray
from drillpetsc.case import Case
from drillpetsc.errors import CaseError
from drillpetsc.output.job import Job
from drillpetsc.parallel import initialise_petsc
from tests.helpers.wells import simple_well
from tests.verification.test_sensitivities_run import series_of

OUTER, INNER, LENGTH, DENSITY, BULK = 0.127, 0.1086, 2000.0, 1200.0, 2e9
BORE = np.pi / 4 * INNER**2
INTEGRATORS = pytest.mark.parametrize("integrator", ["bdf", "generalized_alpha"])


@pytest.fixture(scope="module", autouse=True)
def _petsc() -> None:
    initialise_petsc()


def pipe(length: float, elements: int, outer: float = OUTER, inner: float = INNER) -> dict[str, object]:
    return {"kind": "pipe", "length": length, "od": outer, "id": inner, "element_length": length / elements}


def bore(integrator: str, viscosity: float, end: float, **fluid: object) -> Case:
    """The bore of a held pipe in free space, without gravity."""
    mud = {
        "density": DENSITY,
        "rheology": {"model": "newtonian", "viscosity": viscosity},
        "elastic_walls": False,
    }
    return Case(
        string=[pipe(LENGTH, 100)],
        hold_string=True,
        gravity=0.0,
        bottom="free",
        fluid=mud | {"bulk_modulus": BULK} | fluid,
        time={"end": end, "integrator": integrator},
        petsc={"ts_rtol": "1e-5"},
    )


def hanging(integrator: str, **changes: object) -> Case:
    """Pipe, collars and a bit above the bottom of a vertical hole, in mud."""
    case = {
        "well": simple_well(400.5, 0.2159),
        "string": [
            pipe(300.0, 10), pipe(100.0, 5, 0.1715, 0.0714), {"kind": "bit", "length": 0.5, "od": 0.2, "mass": 60.0, "nozzle_area": 4e-4},
        ],
        "top": {"kind": "top_drive", "rotation": {"time": [0.0, 0.5], "value": [2.0, 8.0]}, "lowering": 0.1},
        "bottom": "free",
        "contact": "none",
        "gravity": 9.81,
        "fluid": {
            "density": DENSITY, "rheology": {"model": "power_law", "consistency": 0.5, "index": 0.7}, "bulk_modulus": BULK,
            "flow_rate": {"time": [0, 0.2, 0.5], "value": [0.02, 0.02, 0.03]},
        },
        "initial": {"from": "statics"},
        "time": {"end": 0.6, "integrator": integrator},
    }  # fmt: skip
    return Case(**(case | changes))


#: casing above a smaller open hole, that build up an inclination
CURVED = {
    "well": {
        "survey": {"md": [0, 100, 400.5], "inclination": [0, 0.1, 0.7], "azimuth": [0, 0, 0.2]},
        "sections": [
            {"to": 200, "kind": "casing", "diameter": 0.2244, "friction": 0.2},
            {"to": 400.5, "kind": "open_hole", "diameter": 0.2159, "friction": 0.25},
        ],
    },
    "contact": {"stiffness": "physical"},
}


@INTEGRATORS
def test_water_hammer(integrator):
    """A pump that starts with Q presses by sqrt(rho K) Q/A until the wave comes back; derivatives by Q, rho and K."""
    flow = 2e-4  # so small that the pressure does not change the density
    case = bore(integrator, 0.0, 2.8, flow_rate={"time": [0.0, 0.1, 0.6], "value": [0.0, 0.0, flow]})
    names = ["fluid.flow_rate.value[2]", "fluid.density", "fluid.bulk_modulus"]
    found = series_of(case, names, ["pump_pressure"])
    (mean,) = parsed_outputs(["pump_pressure.mean[1:2.8]"], ["pump_pressure"], 2.8)
    value, slopes = mean.of(found.times, found.values[:, 0], found.slopes[:, 0])
    pressure = np.sqrt(DENSITY * BULK) * flow / BORE
    exact = [pressure / flow, pressure / (2 * DENSITY), pressure / (2 * BULK)]
    assert value == pytest.approx(pressure, rel=1e-4)
    assert slopes == pytest.approx(exact, rel=5e-4)


@INTEGRATORS
def test_laminar_loss(integrator):
    """p = 128 mu L Q/(pi d^4) at every moment of a steady flow; derivatives by mu, Q and d."""
    case = bore(integrator, 0.05, 0.2, flow_rate=1e-3, bulk_modulus=1e13)
    found = series_of(
        case, ["fluid.rheology.viscosity", "fluid.flow_rate", "string[0].id"], ["pump_pressure"]
    )
    pressure = 128 * 0.05 * LENGTH * 1e-3 / (np.pi * INNER**4)
    assert found.values[:, 0] == pytest.approx(pressure, rel=1e-6)
    exact = [pressure / 0.05, pressure / 1e-3, -4 * pressure / INNER]
    assert found.slopes[:, 0] == pytest.approx(np.tile(exact, (len(found.times), 1)), rel=1e-5)


@INTEGRATORS
def test_weight_of_mud(integrator):
    """Mud at rest under a string at rest: the pressure at the bit is rho g h; no friction of the hole acts on it."""
    case = hanging(
        integrator,
        top={"kind": "top_drive"},
        fluid={
            "density": DENSITY,
            "rheology": {"model": "newtonian", "viscosity": 0.02},
            "bulk_modulus": 1e13,
        },
        time={"end": 0.1, "integrator": integrator},
    )
    found = series_of(
        case, ["fluid.density", "gravity[2]", "well.sections[0].friction"], ["bit_pressure", "bit_speed"]
    )
    bit = 400.0  # pressure belongs to the bit's node
    assert found.slopes[:, 0, 0] == pytest.approx(9.81 * bit, rel=2e-3)
    assert found.slopes[:, 0, 1] == pytest.approx(DENSITY * bit, rel=2e-3)
    assert not found.slopes[:, 0, 2].any() and not found.slopes[:, 1].any()


def largest(run: RunSeries, key: Key, k: int) -> tuple[FloatArray, FloatArray]:
    """Largest size of p ds/dp by the key of number ``k``, and of the value, by column (n,)."""
    return np.abs(run.slopes[:, :, k] * key.size).max(axis=0), np.abs(run.values).max(axis=0)


def assert_slopes(
    case: Case, key: Key, k: int, columns: list[str], run: RunSeries, enough: FloatArray
) -> None:
    """Compare p ds/dp by the key of number ``k`` with differences of runs with the same steps, to ``enough`` (n,) in each column.

    The step of the differences at which a column is best depends on the key: further ones are tried while one is not near enough.
    Now and then a run jumps by 1e-7 of a column, which spoils the differences by one step and not by another.
    """
    best = np.full(len(columns), np.inf)
    for step in (3e-4, 1e-3, 1e-4, 5e-4, 2e-3, 2e-4):
        low, high = (
            series_of(key.changed(case, key.value + sign * step * key.size), [], columns, run.steps).values
            for sign in (-1, 1)
        )
        gap = np.abs(run.slopes[:, :, k] * key.size - (high - low) / (2 * step))
        best = np.minimum(best, gap.max(axis=0))
        if (best < enough).all():
            return
    raise AssertionError((key.name, best / enough))


@INTEGRATORS
@pytest.mark.parametrize("hole", ["vertical", "curved"])
def test_string_in_mud_with_frozen_steps(hole, integrator):
    """Four outputs by five or six keys, against differences of runs that take the same steps.

    In the curved hole the string turns on the wall and is lowered, so that hole and swirl about it are renewed on the way.
    Static starts of changed cases converge to 1e-10, which leaves a few 1e-6 of a column in differences.
    """
    case = hanging(integrator, **(CURVED if hole == "curved" else {}))
    names = [
        "fluid.density",
        "fluid.rheology.consistency",
        "fluid.flow_rate.value[2]",
        "string[2].nozzle_area",
    ]
    names.append("well.sections[1].friction" if hole == "curved" else "string[0].id")
    if hole == "curved" and integrator == "bdf":  # with the other, renewed holes leave 2e-3
        names.append("well.survey.inclination[2]")
    columns = ["hook_load", "pump_pressure", "bit_pressure", "surface_torque"]
    run = series_of(case, names, columns)
    assert run.flags == [""] * len(names)
    for k, key in enumerate(key_of(case, n) for n in names):
        sizes, values = largest(run, key, k)
        coupled, every = sizes > 0.05 * values, 5e-4 * sizes + 2e-5 * values
        assert coupled.any(), key.name
        assert_slopes(case, key, k, columns, run, np.where(coupled, np.minimum(every, 1e-3 * sizes), every))


@INTEGRATORS
def test_five_outputs_by_five_keys(integrator, tmp_path):
    """The command's own check, with its steps: 1e-3 of each derivative that matters, no warning about the others."""
    keys = "fluid.density,fluid.rheology.index,fluid.flow_rate.value[2],string[2].nozzle_area,string[0].id"
    of = "pump_pressure.mean,pump_pressure.max,bit_pressure.final,hook_load.mean[0.1:0.4],bit_flow.final"
    case = hanging(integrator, time={"end": 0.4, "integrator": integrator})
    question = Question("run", of.split(","), keys.split(","), check=5)
    run_sensitivities(Job(case, tmp_path / "r"), question)
    summary = json.loads((tmp_path / "r/summary.json").read_text())
    assert len(summary["checked"]) == 25 and not any("full solutions" in w for w in summary["warnings"])
    matter = [c for c in summary["checked"] if abs(c["difference"]) > 0.02]
    assert len(matter) > 15
    for c in matter:
        assert c["derivative"] == pytest.approx(c["difference"], rel=1e-3), c


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"fluid": {"formulation": "hermite"}}, "hermite"),
        ({"fluid": {"dynamics": "quasi_steady"}}, "quasi_steady"),
    ],
)
def test_refusals(changes, said):
    given = hanging("bdf")._given.keys
    case = Case(**(given | {"fluid": given["fluid"] | changes["fluid"]}))
    with pytest.raises(CaseError) as error:
        RunOfCase(case, PETSc.COMM_SELF)
    assert said in str(error.value)


@pytest.mark.parametrize(
    ("rheology", "told"),
    [
        ({"model": "power_law", "consistency": 0.5, "index": 0.7}, True),
        ({"model": "newtonian", "viscosity": 0.5}, False),
    ],
)
def test_mud_at_rest_has_a_word(rheology: dict[str, object], told: bool, tmp_path) -> None:
    """K Q^n has no derivative at rest unless n = 1: the number follows from the rounding of the stress."""
    case = bore("bdf", 0.5, 0.05, rheology=rheology, flow_rate=0.0)
    question = Question("run", ["pump_pressure.mean"], ["fluid.flow_rate"])
    run_sensitivities(Job(case, tmp_path / "out"), question)
    notes = json.loads((tmp_path / "out" / "summary.json").read_text())["notes"]
    assert any("mud is at rest" in note and "shear_rate" in note for note in notes) is told


@INTEGRATORS
def test_survey_keys_with_generalised_alpha_say_how_right_they_are(integrator, tmp_path):
    """Renewed holes leave 2e-3 with generalised-alpha (above); a key of the mud has nothing to say."""
    case = hanging(integrator, **CURVED, time={"end": 0.02, "integrator": integrator})
    said = {}
    for key in ("well.survey.inclination[2]", "fluid.density"):
        run_sensitivities(Job(case, tmp_path / key), Question("run", ["hook_load.mean"], [key]))
        said[key] = json.loads((tmp_path / key / "summary.json").read_text())["warnings"]
    assert not any("moves along the hole" in w for w in said["fluid.density"])
    found = [w for w in said["well.survey.inclination[2]"] if "moves along the hole" in w]
    assert len(found) == (integrator == "generalized_alpha")
