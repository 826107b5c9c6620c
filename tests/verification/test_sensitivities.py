"""Derivatives by numbers of the case against closed forms, and against differences of full solutions."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from petsc4py import PETSc

from drillpetsc.analysis.loads.torque_drag.batch import soft_strings
from drillpetsc.analysis.loads.torque_drag.roadmap import soft_problem
from drillpetsc.analysis.motion.run_options import options_of
from drillpetsc.analysis.sensitivities.command import Question, run_sensitivities
from drillpetsc.analysis.sensitivities.derivatives import DIFFERENCES, Derivative, checked, derivatives
from drillpetsc.analysis.sensitivities.hydraulics import SteadyHydraulics
from drillpetsc.analysis.sensitivities.keys import key_of
from drillpetsc.analysis.sensitivities.roadmap import SoftRoadmap, own_friction
from drillpetsc.analysis.sensitivities.solution import Solution
from drillpetsc.analysis.sensitivities.statics import StaticsSolution
from drillpetsc.analysis.sensitivities.stiff import StiffRoadmap
from drillpetsc.case import Case, load_case
from drillpetsc.case.writer import case_data
from drillpetsc.doubts import doubts_at
from drillpetsc.errors import CaseError
from drillpetsc.output.job import Job
from drillpetsc.parallel import initialise_petsc
from tests.helpers.wells import simple_well

ROOT = Path(__file__).resolve().parents[2]
OD, ID, LENGTH, GRAVITY, STEEL = 0.127, 0.1086, 1000.0, 9.81, 7850.0
AREA = np.pi / 4 * (OD**2 - ID**2)
PIPE = {"kind": "pipe", "name": "pipe", "length": LENGTH, "od": OD, "id": ID, "element_length": 10.0}


@pytest.fixture(scope="module", autouse=True)
def _petsc() -> None:
    initialise_petsc()


def slanted(inclination: float = 0.0, **changes: object) -> Case:
    """A pipe of 1000 m on the wall of a straight hole."""
    case = {
        "well": simple_well(1200.0, 0.2159, inclination, friction=0.25),
        "string": [PIPE],
        "material": {"density": STEEL},
        "top": {"kind": "top_drive"},
        "bottom": "free",
        "gravity": GRAVITY,
    }
    return Case(**(case | changes))


def found(make: Callable[[Case], Solution], case: Case, *names: str) -> dict[tuple[str, str], Derivative]:
    """Derivatives of all outputs by keys, by the names of both."""
    with options_of(case):
        solution = make(case)
        every = derivatives(case, solution, range(len(solution.outputs)), [key_of(case, n) for n in names])
    return {(d.output.name, d.key.name): d for d in every}


def statics(motion: str | None = None) -> Callable[[Case], Solution]:
    return lambda case: StaticsSolution(case, PETSc.COMM_SELF, motion)


# ---------------------------------------------------------------------- closed forms
def test_weight_of_a_hanging_string():
    """Hook load rho g A L: by density and by gravity; stretch rho g L^2/2E by the modulus."""
    case = slanted(contact="none")
    d = found(statics(), case, "material.density", "material.young", "string[pipe].id")
    assert d["hook_load", "material.density"].slope == pytest.approx(GRAVITY * AREA * LENGTH, rel=1e-7)
    assert d["hook_load", "string[0].id"].slope == pytest.approx(
        -STEEL * GRAVITY * LENGTH * np.pi / 2 * ID, rel=1e-7
    )
    assert d["stretch", "material.density"].relative == pytest.approx(1.0, rel=1e-7)
    assert d["stretch", "material.young"].relative == pytest.approx(-1.0, rel=1e-7)
    assert d["hook_load", "material.young"].slope == 0.0


def test_drag_on_a_slanted_wall():
    """H = w L (cos I +- mu sin I) (Johancsik et al. 1984): its derivatives by friction and density, with the soft string and the beam.

    Rounding of the soft string's hook load, 1e-13, over a step of 1e-4 leaves 1e-9 and some; 1e-8 is the limit.
    The beam's top lies on the wall with the pipe below it.
    """
    slope, weight = np.radians(50.0), STEEL * GRAVITY * AREA
    for motion, word, sign in (("hoist", "trip_out", 1.0), ("lower", "trip_in", -1.0)):
        by_friction = sign * weight * LENGTH * np.sin(slope)
        by_density = GRAVITY * AREA * LENGTH * (np.cos(slope) + sign * 0.25 * np.sin(slope))
        case = slanted(slope, roadmap={"operations": [word], "bit_depth": [LENGTH]})
        soft = found(SoftRoadmap, case, "well.sections[0].friction", "material.density")
        assert soft[f"{word}.hook_load", "well.sections[0].friction"].slope == pytest.approx(
            by_friction, rel=1e-8
        )
        assert soft[f"{word}.hook_load", "material.density"].slope == pytest.approx(by_density, rel=1e-8)
        d = found(statics(motion), case, "well.sections[0].friction", "material.density")
        for key, exact in (("well.sections[0].friction", by_friction), ("material.density", by_density)):
            here = d["hook_load", key]
            assert here.flag == ""
            assert here.slope == pytest.approx(exact, rel=1e-7)


def test_weight_in_a_bend_by_its_end():
    """H = int w cos I ds without friction, on an arc from the vertical to its end, at the places to which the string stretches.

    The hole moves further than the wall yields.  The string lies up to 1.5 mm beside the axis, and strains round in 1e-16 of 1 over a
    step of 6e-8: both are below 1e-4 of the derivative.
    """
    end, depth, young, s = 0.6, 1200.0, 206e9, np.linspace(0.0, LENGTH, 4001)
    case = slanted(
        material={"density": STEEL, "young": young},
        well=simple_well(depth, OD + 0.003, (0.0, end), friction=0.0),
    )
    here = found(statics(), case, "well.survey.inclination[1]")["hook_load", "well.survey.inclination[1]"]

    def along(values: np.ndarray) -> np.ndarray:
        return np.append(0.0, np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(s)))

    def weight(turn: float) -> float:
        place = s
        for _ in range(5):
            below = along(STEEL * GRAVITY * AREA * np.cos(turn * place / depth))
            place = s + along(below[-1] - below) / (young * AREA)
        return float(below[-1])

    exact = (weight(end + 1e-3) - weight(end - 1e-3)) / 2e-3
    assert here.flag == ""
    assert here.slope == pytest.approx(exact, rel=1e-4)


def test_torque_is_proportional_to_friction_and_to_the_radius():
    """T = mu N r: with the string turning, relative derivatives of one."""
    case = slanted(np.radians(50.0))
    d = found(statics("rotate"), case, "well.sections[0].friction")
    assert d["surface_torque", "well.sections[0].friction"].relative == pytest.approx(1.0, rel=1e-7)
    case = slanted(
        np.radians(50.0), roadmap={"operations": ["rotate_off_bottom"], "bit_depth": [LENGTH], "rpm": 10.0}
    )
    d = found(SoftRoadmap, case, "well.sections[0].friction", "roadmap.rpm")
    name = "rotate_off_bottom.surface_torque"
    assert d[name, "well.sections[0].friction"].relative == pytest.approx(1.0, rel=1e-10)
    assert d[name, "roadmap.rpm"].slope == 0.0


def test_capstan():
    """A string without weight that is pulled through a bend by theta: T = T0 exp(mu theta), and a change of its pull alike (Euler)."""
    bend, pull = np.radians(60.0), 2e5
    well = simple_well(1000.0, 0.2159, (0.0, bend), friction=0.2)
    case = slanted(well=well, gravity=1e-6, roadmap={"operations": ["trip_out"], "bit_depth": [LENGTH]})
    problem = soft_problem(own_friction(case, True), {})
    pulls = [pull, pull + 100.0]
    tops = [soft_strings(problem.hole, replace(problem.columns, wob=-q)).tension[0, 0] for q in pulls]
    assert tops[0] == pytest.approx(pull * np.exp(0.2 * bend), rel=1e-6)
    assert tops[1] - tops[0] == pytest.approx(100.0 * np.exp(0.2 * bend), rel=1e-6)


def laminar(**fluid: object) -> Case:
    """Newtonian mud in slow flow through a pipe with nozzles."""
    mud = {
        "density": 1000.0,
        "rheology": {"model": "newtonian", "viscosity": 0.1},
        "flow_rate": 1e-3,
        "bulk_modulus": 2e12,
    }
    string = [PIPE, {"kind": "bit", "length": 0.5, "od": 0.2, "mass": 50.0, "nozzle_area": 1e-4}]
    well = simple_well(1000.5, 0.2159, kind="casing")
    return slanted(well=well, string=string, bottom="bit", fluid=mud | fluid)


def test_laminar_loss_and_nozzles():
    """Hagen-Poiseuille in the bore, rho Q^2/(2 C^2 A^2) at the bit: relative derivatives of one, two, and minus two."""
    d = found(
        SteadyHydraulics,
        laminar(),
        "fluid.rheology.viscosity",
        "fluid.flow_rate",
        "fluid.density",
        "string[bit].nozzle_area",
    )
    assert d["string_loss", "fluid.rheology.viscosity"].relative == pytest.approx(1.0, rel=1e-6)
    assert d["string_loss", "fluid.flow_rate"].relative == pytest.approx(1.0, rel=1e-6)
    assert d["bit_loss", "fluid.flow_rate"].relative == pytest.approx(2.0, rel=1e-4)
    assert d["bit_loss", "fluid.density"].relative == pytest.approx(1.0, rel=1e-4)
    assert d["bit_loss", "string[1].nozzle_area"].relative == pytest.approx(-2.0, rel=1e-4)
    viscous = 128 * 0.1 * 1e-3 * LENGTH / (np.pi * ID**4)
    assert d["string_loss", "fluid.rheology.viscosity"].slope == pytest.approx(viscous / 0.1, rel=1e-5)


def test_flow_rate_at_a_pump_pressure():
    """With the pump's pressure given the flow rate follows: dQ/dp is one over dp/dQ at that rate."""
    d = found(SteadyHydraulics, laminar(), "fluid.flow_rate")
    by_rate, pressure = (
        d["pump_pressure", "fluid.flow_rate"].slope,
        d["pump_pressure", "fluid.flow_rate"].value,
    )
    case = laminar()
    keys = case_data(case)
    keys["fluid"] = {k: v for k, v in keys["fluid"].items() if k != "flow_rate"} | {"pump_pressure": pressure}
    case = Case(**keys)
    d = found(SteadyHydraulics, case, "fluid.pump_pressure")
    assert d["pump_flow", "fluid.pump_pressure"].value == pytest.approx(1e-3, rel=1e-7)
    assert d["pump_flow", "fluid.pump_pressure"].slope == pytest.approx(1 / by_rate, rel=1e-6)
    assert d["pump_pressure", "fluid.pump_pressure"].slope == pytest.approx(1.0, rel=1e-6)


# ---------------------------------------------------------------------- full solutions
F5 = ROOT / "cases/measured/volve-f5/case.yaml"
POWER_LAW = {
    "fluid.flow_rate": "3500 l/min",
    "fluid.rheology": "{model: power_law, index: 0.6, consistency: 0.8 Pa s^n}",
}
TABLE = {
    "roadmap": (
        SoftRoadmap,
        F5,
        {},
        "well.sections[0].friction well.sections[1].friction string[0].weight fluid.density rig.block_weight roadmap.rpm "
        "roadmap.drilling.wob roadmap.drilling.tob string[0].tool_joint.od gravity[2]",
    ),
    "power-law hydraulics": (
        SteadyHydraulics,
        F5,
        POWER_LAW,
        "fluid.density fluid.flow_rate fluid.rheology.consistency fluid.rheology.index string[0].id string[0].od "
        "well.sections[1].diameter fluid.bulk_modulus",
    ),
    "J-well": (
        statics("hoist"),
        ROOT / "cases/verification/p16-j-well.yaml",
        {},
        "well.sections[0].friction string[0].material.density string[0].material.young string[0].od string[0].id "
        "well.sections[0].diameter string[0].material.poisson contact.stiffness",
    ),
}


@pytest.mark.parametrize("name", TABLE)
def test_equal_to_differences_of_full_solutions(name):
    """All outputs by all keys against central differences, extrapolated (Richardson): median 1e-6, worst without a flag 1e-4.

    Relative derivatives below 1e-4 are judged by their absolute error.
    """
    make, file, changes, keys = TABLE[name]
    case = load_case(file)
    case = case.replace(changes) if changes else case
    with options_of(case):
        solution = make(case)
        every = derivatives(
            case, solution, range(len(solution.outputs)), [key_of(case, key) for key in keys.split()]
        )
        compared = checked(case, solution, every, len(every))
    errors = np.array([at.error for at in compared])
    assert len(errors) > 8
    assert np.median(errors) < 1e-6
    bad = [(at.output, at.key, at.derivative, at.difference) for at in compared if at.error > 1e-4]
    assert not bad


def test_a_stiff_row():
    """Hook load and torque of the beam pulled out of F-5 (the torque is that of a string held at its top) by friction and weight: 1e-5."""
    case = load_case(F5).replace({"roadmap.operations": ["trip_out"]})
    keys = [
        key_of(case, k)
        for k in ("well.sections[0].friction", "well.sections[1].friction", "string[0].weight")
    ]
    with options_of(case):
        solution = StiffRoadmap(case)
        chosen = [
            i for i, o in enumerate(solution.outputs) if o.quantity.name in ("hook_load", "surface_torque")
        ]
        every = derivatives(case, solution, chosen, keys)
        compared = checked(case, solution, every, 6)
    assert len(compared) == 6
    assert max(at.error for at in compared) < 1e-5


# ---------------------------------------------------------------------- refusals, kinks and limits
def test_a_change_that_the_case_refuses_names_the_key():
    """The roadmap of F-5 ends at the bit depth of its case: the depth alone cannot change to either side."""
    case = load_case(F5)
    with pytest.raises(CaseError) as error:
        run_sensitivities(Job(case), Question("roadmap", ["hook_load"], ["bit_depth"]))
    assert (error.value.at, error.value.got) == ("--to", "bit_depth")
    assert "roadmap.bit_depth" in error.value.want


def test_a_motor_is_refused():
    """Its speed follows from the torque by rounds of statics, whose derivative is not taken."""
    with pytest.raises(CaseError) as error:
        StaticsSolution(load_case(ROOT / "cases/motor-slide.yaml"), PETSc.COMM_SELF)
    assert error.value.got == "pdm" and "--analysis roadmap" in error.value.want


def test_doubt_if_full_solutions_disagree():
    """A derivative that is wrong by 1e-3 is reported with both numbers."""
    case = slanted(np.radians(50.0), roadmap={"operations": ["trip_out"], "bit_depth": [LENGTH]})
    with options_of(case):
        solution = SoftRoadmap(case)
        d = derivatives(case, solution, [0], [key_of(case, "material.density")])
        (right,) = checked(case, solution, d, 3)
        (wrong,) = checked(case, solution, [replace(d[0], slope=d[0].slope * 1.001)], 1)
    assert not doubts_at(right)
    (sentence,) = doubts_at(wrong)
    assert "trip_out.hook_load at 1000 m by material.density is 1.001, full solutions give 1" in sentence


def test_key_at_its_limit():
    """Friction cannot be below zero: the derivative is that of the allowed side, and says so."""
    slope = np.radians(50.0)
    well = simple_well(1200.0, 0.2159, slope, friction=0.0)
    case = slanted(well=well, roadmap={"operations": ["trip_out"], "bit_depth": [LENGTH]})
    d = found(SoftRoadmap, case, "well.sections[0].friction")
    here = d["trip_out.hook_load", "well.sections[0].friction"]
    assert here.flag == "limit"
    assert np.isnan(here.relative)
    assert here.slope == pytest.approx(STEEL * GRAVITY * AREA * LENGTH * np.sin(slope), rel=1e-8)


def test_contact_at_its_threshold():
    """Of two pipes of one diameter on the wall one gets thicker by more than the wall yields: contacts beside the step open."""
    half = PIPE | {"length": LENGTH / 2}
    case = slanted(np.radians(50.0), string=[half | {"name": "upper"}, half | {"name": "lower"}])
    d = found(statics("hoist"), case, "string[upper].od")
    here = d["stretch", "string[0].od"]
    assert here.flag == "one-sided"
    assert np.isfinite(here.below) and np.isfinite(here.above)


def test_helix_closer_than_the_stated_change():
    """A push that makes the string coil 0.5 % above the present one: both sides by full solutions, of which one coils."""
    case = slanted(
        np.radians(50.0),
        string=[PIPE],
        roadmap={"operations": ["sliding"], "bit_depth": [LENGTH], "sliding": {"wob": 1.0}},
    )
    low, high = 1e4, 1e6
    for _ in range(30):
        middle = np.sqrt(low * high)
        solution = SoftRoadmap(case.replace({"roadmap.sliding.wob": float(middle)}))
        coiled = solution.found.states[0][0][0].strip(b"\0") != b""
        low, high = (low, middle) if coiled else (middle, high)
    d = found(SoftRoadmap, case.replace({"roadmap.sliding.wob": float(low / 1.005)}), "roadmap.sliding.wob")
    here = d["sliding.hook_load", "roadmap.sliding.wob"]
    assert here.flag == "one-sided"
    assert here.above < here.effect < 0  # the wall of a helix takes more
    assert here.below == pytest.approx(here.effect, rel=1e-2)


def test_statics_with_mud_is_differenced_and_says_so() -> None:
    """Two agitators in mud. The matrix of the string with the flow held gave a relative twist by density of 0.211; full solutions give 0.175."""
    case = load_case(ROOT / "cases/agitator-slide.yaml")
    solution = StaticsSolution(case, PETSc.COMM_SELF)
    key = key_of(case, "fluid.density")
    for d in derivatives(case, solution, range(len(solution.outputs)), [key]):
        assert DIFFERENCES in d.flag
        if d.output.name in ("pump_pressure", "bit_pressure"):
            assert (
                0.85 < d.relative < 1.0
            )  # turbulent and through nozzles: the exponent of the density is between 0.75 and 1
