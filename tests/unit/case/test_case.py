"""Cases that are right: values, defaults, the same objects from Python, round trips."""

import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from drillpetsc.case import Case, load_case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.time_function import Constant, PiecewiseLinear, Ramp
from tests.helpers.tables import each_row

CASES = Path(__file__).parents[3] / "cases"
PIPE: dict[str, Any] = {"kind": "pipe", "length": "90 m", "od": "5 in", "id": "4.276 in"}
BIT: dict[str, Any] = {"kind": "bit", "length": 0.5, "od": "8.5 in", "mass": "60 kg"}


def well(depth: float = 100.0, **section: Any) -> dict[str, Any]:
    return {
        "survey": {"md": [0, depth], "inclination": [0, 0], "azimuth": [0, 0]},
        "sections": [{"to": depth, "kind": "open_hole", "diameter": "8.5 in", **section}],
    }


def error_of(**keys: Any) -> CaseError:
    with pytest.raises(CaseError) as caught:
        Case(**{"string": [PIPE], "top": "clamped", **keys})
    return caught.value


def simple(**keys: Any) -> Case:
    return Case(**{"string": [PIPE], "top": "clamped", **keys})


def test_vertical_2000m() -> None:
    """Drillstring model of the reference paper: 2000 m, 225 elements, from rest to 80 rpm, a bit that drills (manual:
    sec-paper)."""
    case = load_case(CASES / "vertical-2000m.yaml")
    assert case.string_length == pytest.approx(2000.0, abs=1e-9)
    assert (case.item_depths[1][0], case.item_depths[2][1]) == (1800.0, 1998.0)
    meshed = [item for item in case.string if item.kind in ("pipe", "beam")]
    assert sum(round(item.length / item.element_length) for item in meshed) == 225
    assert case.top.kind == "top_drive"
    assert case.top.rotation.value(0.0) == 0.0
    assert case.top.rotation.value(2.0) == pytest.approx(80 * 2 * math.pi / 60)
    assert case.bottom.kind == "bit" and case.bottom.stiffness == 1e8 and case.formation is not None
    assert case.string[1].eccentricity == 0.0005
    assert case.initial.from_ == "statics" and case.initial.wob == 20e3
    assert case.time is not None and case.time.end == 12.0
    assert case.output.probes == (600.0, 1200.0, 1900.0)
    assert case.well is not None and case.contact is not None
    assert [section.friction for section in case.well.sections] == [0.2, 0.3]
    assert case.petsc == {} and case.time.integrator == "auto"
    assert case.material.damping.stiffness == 1e-4


def test_defaults() -> None:
    case = simple()
    assert (case.well, case.contact, case.time) == (None, None, None)
    assert case.bottom.kind == "free"
    assert case.gravity == (0.0, 0.0, 9.80665)
    assert (case.material.young, case.material.poisson, case.material.density) == (206e9, 0.3, 7850.0)
    assert (case.material.damping.stiffness, case.material.damping.mass) == (0.0, 0.0)
    assert case.string[0].element_length == "auto"
    assert case.string[0].name == "pipe"
    assert case.beam.formulation == "ancf"
    assert case.initial.from_ == "statics"


def test_contact_comes_with_the_well_unless_none() -> None:
    contact = simple(well=well()).contact
    assert contact is not None
    assert (contact.law, contact.stiffness, contact.restitution, contact.restitution_speed) == (
        "linear", 1e8, 0.5, 1.0,
    )  # fmt: skip
    assert (contact.slip_velocity, contact.points_per_element, contact.stribeck) == (0.01, 2, None)
    assert simple(well=well(), contact="none").contact is None
    assert simple(contact="none").contact is None


@pytest.mark.parametrize(("kind", "friction"), [("casing", 0.2), ("open_hole", 0.3)])
def test_default_friction_of_a_section(kind: str, friction: float) -> None:
    case = simple(well=well(kind=kind))
    assert case.well is not None and case.well.sections[0].friction == friction
    assert simple(well=well(kind=kind, friction=0.0)).well.sections[0].friction == 0.0  # type: ignore[union-attr]


def test_hertz_stiffness_has_its_own_unit() -> None:
    contact = simple(well=well(), contact={"law": "hertz", "stiffness": "3e9 N/m^2.5"}).contact
    assert contact is not None and contact.stiffness == 3e9
    contact = simple(well=well(), contact={"stiffness": "1e10 N/m^1.5", "law": "hertz_point"}).contact
    assert contact is not None and contact.stiffness == 1e10
    assert error_of(well=well(), contact={"law": "hertz"}).at == "contact.stiffness"


@each_row("end", [0.5, 20.0, 36000.0])
def test_output_intervals_follow_from_the_end(end: float) -> None:
    output = simple(time={"end": end}).output
    assert output.history_every == pytest.approx({0.5: 1e-3, 20.0: 0.02, 36000.0: 0.1}[end])
    assert output.field_every == pytest.approx(end / 100)
    assert output.checkpoint_every == pytest.approx(end / 10)
    assert simple(time={"end": end}, output={"history_every": 0.25}).output.history_every == 0.25


def test_item_material_takes_the_rest_from_the_case() -> None:
    own = {"density": 2780, "damping": {"mass": 0.5}}
    base = {"young": "200 GPa", "density": 8000, "damping": {"stiffness": "1 ms"}}
    case = simple(string=[{**PIPE, "material": own}, PIPE], material=base)
    material = case.string[0].material
    assert (material.young, material.poisson, material.density) == (200e9, 0.3, 2780.0)
    assert (material.damping.stiffness, material.damping.mass) == (1e-3, 0.5)
    assert case.string[1].material == case.material


def test_a_beam_takes_its_damping_from_the_case() -> None:
    beam = {
        "kind": "beam",
        "length": 10,
        "axial_stiffness": "1 GN",
        "bending_stiffness": "1e7 N m^2",
        "torsional_stiffness": "8e6 N m2",
        "mass": "40 kg/m",
        "polar_inertia": "0.1 kg m",
    }
    case = simple(string=[beam, {**beam, "damping": {"mass": 1}}], material={"damping": {"stiffness": 1e-4}})
    assert (case.string[0].axial_stiffness, case.string[0].mass) == (1e9, 40.0)
    assert [item.damping.stiffness for item in case.string] == [1e-4, 1e-4]
    assert [item.damping.mass for item in case.string] == [0.0, 1.0]
    assert error_of(string=[beam], well=well()).at == "string[0].od"


def test_mass_and_inertia_of_a_rigid_item_are_those_of_a_tube() -> None:
    """A thick tube: m (ro^2 + ri^2)/2 along, m (3 (ro^2 + ri^2) + l^2)/12 across (any table of moments of
    inertia).

    Here ro 0.1 m, ri 0.05 m, l 2 m, density 1000 kg/m3.
    """
    body = {"kind": "body", "length": 2, "od": 0.2, "id": 0.1, "material": {"density": 1000}}
    item = simple(string=[PIPE, body]).string[1]
    mass = 1000 * math.pi * (0.1**2 - 0.05**2) * 2
    assert item.mass == pytest.approx(mass, rel=1e-14)
    assert item.inertia.axial == pytest.approx(mass * 0.0125 / 2, rel=1e-14)
    assert item.inertia.transverse == pytest.approx(mass * (3 * 0.0125 + 4) / 12, rel=1e-14)
    assert item.center_of_gravity == (1.0, 0.0, 0.0)
    given = simple(
        string=[PIPE, {**body, "mass": 5, "inertia": {"axial": "2 kg m2"}, "center_of_gravity": "10 cm"}]
    )
    item = given.string[1]
    assert (item.mass, item.inertia.axial, item.center_of_gravity) == (5.0, 2.0, (0.1, 0.0, 0.0))
    assert item.inertia.transverse == pytest.approx(5 * (3 * 0.0125 + 4) / 12, rel=1e-14)
    weight = simple(
        string=[PIPE, {"kind": "body", "mass": "1 t", "center_of_gravity": [0.1, "2 mm", 0]}]
    ).string[1]
    assert (weight.mass, weight.length, weight.inertia.axial, weight.inertia.transverse) == (
        1000.0, 0.0, 0.0, 0.0,
    )  # fmt: skip
    assert weight.center_of_gravity == (0.1, 0.002, 0.0)
    assert error_of(string=[PIPE, {"kind": "body"}]).at == "string[1].mass"


def test_values_over_time() -> None:
    def rotation(value: Any) -> Any:
        return simple(top={"kind": "top_drive", "rotation": value}).top.rotation

    speed = 2 * math.pi
    assert rotation("60 rpm") == Constant(pytest.approx(speed))
    assert rotation({"ramp": "2 s", "value": "60 rpm"}) == Ramp(2.0, pytest.approx(speed))
    table = rotation({"time": ["0 s", "1 min", 60], "value": [0, "60 rpm", 0]})
    assert table.times == (0.0, 60.0, 60.0)
    assert table.values == (0.0, pytest.approx(speed), 0.0)
    assert rotation({"time": np.array([0.0, 1.0]), "value": np.array([0.0, 2.0])}) == PiecewiseLinear(
        (0, 1), (0, 2)
    )
    assert rotation(Ramp(1.0, 2.0)) == Ramp(1.0, 2.0)


@each_row(
    ("value", "at"),
    [
        ({"ramp": "2 s"}, "top.rotation"), ({"ramp": "2 s", "time": [0], "value": 1}, "top.rotation"),
        ({"ramp": "0 s", "value": 1}, "top.rotation.ramp"),
        ({"ramp": "1 s", "values": 1}, "top.rotation.values"),
        ({"time": [], "value": []}, "top.rotation.time"), ({"time": 1, "value": [1]}, "top.rotation.time"),
        ({"time": [0, 1], "value": [1, "2 m"]}, "top.rotation.value[1]"),
        ({"time": [0, 0, 0], "value": [1, 2, 3]}, "top.rotation.time"), ([1, 2], "top.rotation"),
    ],
)  # fmt: skip
def test_refused_values_over_time(value: Any, at: str) -> None:
    assert error_of(top={"kind": "top_drive", "rotation": value}).at == at


def test_gravity_and_loads() -> None:
    assert simple(gravity="10 m/s2").gravity == (0.0, 0.0, 10.0)
    assert simple(gravity=[1, 0, "9 m/s^2"]).gravity == (1.0, 0.0, 9.0)
    loads = [
        {"at": "90 m", "force": [0, 0, "-1 kN"], "value_over": {"ramp": 1, "value": 1}},
        {"from": 10, "to": "20 m", "force": ["1 N/m", 0, 0], "moment": [0, 0, "2 N m/m"], "frame": "section"},
    ]
    point, line = simple(loads=loads).loads
    assert (point.at, point.force, point.moment, point.frame) == (
        90.0, (0.0, 0.0, -1000.0), (0.0, 0.0, 0.0), "global",
    )  # fmt: skip
    assert point.value_over == Ramp(1.0, 1.0)
    assert (line.from_, line.to, line.force, line.moment) == (10.0, 20.0, (1.0, 0.0, 0.0), (0.0, 0.0, 2.0))


@each_row(
    ("load", "at"),
    [
        ({"force": [0, 0, 1]}, "loads[0].at"), ({"at": 1, "to": 2, "force": [0, 0, 1]}, "loads[0].at"),
        ({"from": 2, "to": 1, "force": [0, 0, 1]}, "loads[0].to"),
        ({"from": 2, "force": [0, 0, 1]}, "loads[0].to"),
        ({"from": 2, "to": 3, "force": [0, 0, "1 N"]}, "loads[0].force[2]"), ({"at": 2}, "loads[0].force"),
        ({"at": 2, "force": 5}, "loads[0].force"), ("1 kN", "loads[0]"),
    ],
)  # fmt: skip
def test_refused_loads(load: Any, at: str) -> None:
    assert error_of(loads=[load]).at == at


@each_row(
    ("keys", "at"),
    [
        ({"top": {"kind": "driven", "rotation": "80 rpm"}}, "top.stiffness"), ({"top": "top_drive"}, "top"),
        ({"top": 3}, "top"), ({"top": {"kind": "free", "rotation": 1}}, "top.rotation"),
        ({"bottom": "bit"}, "bottom"), ({"bottom": {"kind": "free", "plugged": "yes"}}, "bottom.plugged"),
        ({"bottom": {"kind": "bit", "stiffness": -1}}, "bottom.stiffness"), ({"contact": {}}, "contact"),
        ({"well": well(), "contact": {"restitution": 0}}, "contact.restitution"),
        ({"well": well(), "contact": {"stribeck": {"static": 0.2, "speed": 0.1}}}, "contact.stribeck.static"),
        ({"well": well(roughness=0.001)}, "well.sections[0].roughness"),
        ({"well": well(), "initial": {"inclination": 0.1}}, "initial.inclination"),
        ({"string": [BIT]}, "string"),
        ({"string": [{**PIPE, "eccentricity": 0.1}]}, "string[0].eccentricity"),
        ({"string": [{**PIPE, "joints": []}]}, "string[0].joints"),
        ({"string": [{**PIPE, "bend": {"tool_face": 0}}]}, "string[0].bend.angle"),
        ({"string": PIPE}, "string"), ({"string": [PIPE, 5]}, "string[1]"),
        ({"time": {"end": 1, "mode": "static"}}, "time.mode"), ({"time": "20 s"}, "time"),
        ({"output": {"probes": [1, 1.0]}}, "output.probes[1]"),
        ({"petsc": {"ts_type": [1]}}, "petsc.ts_type"), ({"petsc": [1]}, "petsc"),
        ({"hold_string": 1}, "hold_string"), ({"top": None}, "top"),
        ({"initial": {"from": "rest", "wob": 1}}, "initial.wob"),
        ({"material": {"young": 206}}, "material.young"),
        ({"material": {"poisson": 0.6}}, "material.poisson"),
    ],
)  # fmt: skip
def test_refused(keys: dict[str, Any], at: str) -> None:
    error = error_of(**keys)
    assert error.at == at
    assert error.want
    assert error.line is None


def test_wob_wants_a_top_that_can_be_set() -> None:
    keys = {"string": [PIPE, BIT], "well": well(), "bottom": "bit", "initial": {"wob": "5 kN"}}
    assert Case(**keys, top={"kind": "top_drive"}).initial.wob == 5e3
    assert error_of(**keys, top="free").at == "initial.wob"
    assert Case(**keys, top={"kind": "top_drive", "force": "1 kN"}).initial.wob == 5e3
    pulled = {"top": {"kind": "top_drive", "force": "1 kN"}, "beam": {"formulation": "quaternion"}}
    assert error_of(**keys, **pulled).at == "initial.wob"


def test_a_case_cannot_be_changed() -> None:
    with pytest.raises(ValidationError):
        simple().title = "other"  # type: ignore[misc]


def test_cases_and_errors_travel_between_ranks() -> None:
    case = load_case(CASES / "vertical-2000m.yaml")
    assert pickle.loads(pickle.dumps(case)) == case
    error = pickle.loads(pickle.dumps(error_of(tops=1)))
    assert (error.at, error.exit_status) == ("tops", 2) and "did you mean 'top'?" in str(error)
    failure = pickle.loads(
        pickle.dumps(SolveError("diverged", time=1.5, component="contact", element=3, measured_depth=27.0))
    )
    assert str(failure) == "diverged\n  where:   time 1.5 s, component contact, element 3, at MD 27 m"
    assert failure.exit_status == 1
