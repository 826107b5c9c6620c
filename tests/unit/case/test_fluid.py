"""The drilling fluid in a case: units, defaults, what follows from other blocks, what contradicts them."""

import math
from typing import Any

import pytest

from drillpetsc.case import Case
from drillpetsc.case.blocks.fluid import Casson, Fluid, flow_constants
from drillpetsc.case.quantities import largest
from drillpetsc.errors import CaseError
from drillpetsc.time_function import Constant, PiecewiseLinear, Ramp
from tests.helpers.tables import each_row

PIPE: dict[str, Any] = {"kind": "pipe", "length": "90 m", "od": "5 in", "id": "4.276 in"}
SOLID: dict[str, Any] = {**PIPE, "id": 0}
BIT: dict[str, Any] = {
    "kind": "bit",
    "length": 0.5,
    "od": "8.5 in",
    "mass": "60 kg",
    "nozzle_area": "400 mm2",
}
WATER: dict[str, Any] = {"density": 1000, "rheology": {"model": "newtonian", "viscosity": "1 cP"}}
WELL: dict[str, Any] = {
    "survey": {"md": [0, 100], "inclination": [0, 0], "azimuth": [0, 0]},
    "sections": [{"to": 100, "kind": "open_hole", "diameter": "8.5 in"}],
}
TURNING: dict[str, Any] = {"kind": "top_drive", "rotation": {"time": [0, 5], "value": [10, -20]}}


def make_case(**keys: Any) -> Case:
    return Case(**{"string": [PIPE], "top": "clamped", "fluid": WATER, **keys})


def fluid(**keys: Any) -> Fluid:
    made = make_case(well=WELL, fluid={**WATER, **keys}).fluid
    assert made is not None
    return made


def error_of(**keys: Any) -> CaseError:
    with pytest.raises(CaseError) as caught:
        make_case(**keys)
    return caught.value


def test_defaults() -> None:
    """Those of the case format."""
    made = fluid()
    assert (made.flow_rate, made.pump_pressure, made.outlet_pressure) == (Constant(0.0), None, Constant(0.0))
    assert (made.bulk_modulus, made.flow_line, made.bit_volume) == (2e9, 0.0, pytest.approx(7e-3))
    assert (made.discharge_coefficient, made.clinging) == (0.95, 0.45)
    assert (made.annulus, made.elastic_walls, made.check_valve, made.rotation_drag) == (
        True, True, False, False,
    )  # fmt: skip
    assert (made.formulation, made.dynamics, made.cuttings) == ("mixed", "full", "removed")
    assert (made.added_mass, made.lateral_damping, made.lateral_damping_speed) == ("confined", "stokes", 1.0)
    assert (made.rheology.law, made.rheology.shear_rate) == ("blend", 1.0)
    assert Case(string=[PIPE], top="clamped").fluid is None


def test_units() -> None:
    """Gallons are 3.785411784 l, pounds 0.45359237 kg, centipoise mPa s (all exact)."""
    made = fluid(
        density="12 lb/gal", flow_rate="500 gal/min", outlet_pressure="2 bar", bit_volume="5 l", added_mass=2.5,
        lateral_damping="20 N s/m^2", lateral_damping_speed="60 rpm", rheology={"model": "newtonian", "viscosity": "20 cP"},
    )  # fmt: skip
    assert made.density == pytest.approx(12 * 0.45359237 / 3.785411784e-3, rel=1e-14)
    assert made.flow_rate == Constant(pytest.approx(500 * 3.785411784e-3 / 60, rel=1e-14))
    assert made.outlet_pressure == Constant(2e5)
    assert (made.bit_volume, made.added_mass, made.lateral_damping) == (pytest.approx(5e-3), 2.5, 20.0)
    assert made.lateral_damping_speed == pytest.approx(2 * math.pi)
    assert made.rheology.viscosity == pytest.approx(0.02)
    assert fluid(flow_rate={"ramp": "5 s", "value": "30 l/s"}).flow_rate == Ramp(5.0, pytest.approx(0.03))


PLASTIC = {"yield_stress": "25 lbf/100 ft^2", "plastic_viscosity": "20 mPa s"}


@each_row(
    ("rheology", "constants"),
    [
        ({"model": "newtonian", "viscosity": 0}, (0.0, 1.0, 0.0)),
        ({"model": "power_law", "consistency": "0.5 Pa s^n", "index": 0.7}, (0.5, 0.7, 0.0)),
        ({"model": "bingham", **PLASTIC}, (0.02, 1.0, 11.97006)),
        ({"model": "casson", **PLASTIC, "law": "exact"}, (0.02, 1.0, 11.97006)),
        (
            {
                "model": "herschel_bulkley",
                "consistency": "300 mPa s^n",
                "index": 0.75,
                "yield_stress": "3 Pa",
            },
            (0.3, 0.75, 3.0),
        ),
    ],
)
def test_flow_constants(rheology: dict[str, Any], constants: tuple[float, float, float]) -> None:
    """25 lbf/100 ft2 = 25 * 4.4482216 N / 9.290304 m2 = 11.97006 Pa."""
    made = fluid(rheology=rheology).rheology
    assert made.model == rheology["model"]
    assert flow_constants(made) == pytest.approx(constants, rel=1e-6)
    assert isinstance(made, Casson) == (rheology["model"] == "casson")


def test_none_is_nought() -> None:
    made = fluid(added_mass="none", lateral_damping="none")
    assert (made.added_mass, made.lateral_damping) == (0.0, 0.0)
    assert fluid(added_mass="paper_plug").added_mass == "paper_plug"


def test_annulus_comes_with_the_well() -> None:
    assert make_case(well=WELL).has_annulus
    assert not make_case(well=WELL, fluid={**WATER, "annulus": False}).has_annulus
    assert not make_case().has_annulus
    assert not Case(string=[PIPE], top="clamped", well=WELL).has_annulus


def test_which_strings_hold_fluid() -> None:
    """A plugged string that no pump pressure fills is empty: the closed one of Archimedes' principle."""
    plugged = {"bottom": {"kind": "free", "plugged": True}, "well": WELL}
    filled = {**WATER, "pump_pressure": 0}
    assert make_case().has_bore
    assert not make_case(**plugged).has_bore and make_case(**plugged).has_annulus
    assert make_case(**plugged, fluid=filled).has_bore
    assert make_case(bottom={"kind": "pinned", "plugged": True}, fluid=filled).has_bore
    assert not make_case(string=[SOLID], well=WELL).has_bore
    assert not Case(string=[PIPE], top="clamped").has_bore


@each_row(
    ("top", "speed"), [(TURNING, 20.0), ({**TURNING, "rotation": 0}, 1.0), ("pinned", 1.0),
                       ({"kind": "driven", "rotation": "60 rpm", "damping": 1}, 2 * math.pi)],
)  # fmt: skip
def test_lateral_damping_is_that_of_the_fastest_rotation(top: Any, speed: float) -> None:
    made = make_case(top=top).fluid
    assert made is not None and made.lateral_damping_speed == pytest.approx(speed)


def test_largest_magnitude() -> None:
    assert largest(Constant(-3.0)) == 3.0
    assert largest(Ramp(1.0, -2.0)) == 2.0
    assert largest(PiecewiseLinear((0.0, 1.0), (1.0, -4.0))) == 4.0
    assert largest(None) == 0.0


def test_compliance_of_a_section() -> None:
    soft = {**WELL, "sections": [{**WELL["sections"][0], "compliance": {"young": "20 GPa"}}]}
    case = make_case(well=soft)
    assert case.well is not None and case.well.sections[0].compliance is not None
    assert (case.well.sections[0].compliance.young, case.well.sections[0].compliance.poisson) == (20e9, 0.25)
    assert make_case(well=WELL).well.sections[0].compliance is None  # type: ignore[union-attr]


def test_a_rigid_item_may_fill_the_hole_and_have_no_bore() -> None:
    case = make_case(string=[PIPE, BIT], well=WELL, contact="none", fluid={**WATER, "flow_rate": "30 l/s"})
    assert case.has_bore and case.string[1].nozzle_area == pytest.approx(4e-4)


def test_a_held_string() -> None:
    """Neither a top nor contact; the ends and the hole are still there for the fluid."""
    case = Case(
        string=[PIPE, BIT], well=WELL, hold_string=True, bottom="bit", fluid=WATER, contact={"stiffness": 1e7}
    )
    assert case.hold_string and case.contact is None and case.well is not None
    assert (case.top.kind, case.bottom.kind) == ("clamped", "bit")
    still = Case(string=[PIPE], hold_string=True, fluid=WATER, top={"kind": "top_drive", "lowering": 0})
    assert still.top.kind == "top_drive"
    assert not make_case().hold_string
    held = {"hold_string": True, "string": [PIPE], "fluid": WATER}
    for top, at in (
        ({"lowering": 1}, "top.lowering"),
        ({"force": "1 kN"}, "top.force"),
        (TURNING, "top.rotation"),
    ):
        with pytest.raises(CaseError) as caught:
            Case(**held, top={"kind": "top_drive", **top})
        assert caught.value.at == at
    assert error_of(hold_string=True, bottom={"kind": "force", "force": [0, 0, 1]}).at == "bottom.kind"


def test_all_mistakes_are_named_also_beside_a_missing_top() -> None:
    with pytest.raises(CaseError) as caught:
        Case(string=[PIPE], fluid={**WATER, "density": 0})
    assert {error.at for error in (caught.value, *caught.value.also)} == {"top", "fluid.density"}


@each_row(
    ("keys", "at"),
    [
        ({"density": None}, "density"), ({"bulk_modulus": "-1 GPa"}, "bulk_modulus"),
        ({"rheology": "newtonian"}, "rheology"), ({"rheology": {"viscosity": 1}}, "rheology.model"),
        ({"rheology": {"model": "newtonian", "viscosity": "-1 cP"}}, "rheology.viscosity"),
        ({"rheology": {"model": "newtonian", "viscosity": 1, "index": 1}}, "rheology.index"),
        ({"rheology": {"model": "newtonian", "viscosity": 1, "shear_rate": 0}}, "rheology.shear_rate"),
        ({"rheology": {"model": "power_law", "consistency": 1, "index": 0}}, "rheology.index"),
        ({"rheology": {"model": "power_law", "consistency": 0, "index": 1}}, "rheology.consistency"),
        ({"rheology": {"model": "bingham", "plastic_viscosity": 1}}, "rheology.yield_stress"),
        ({"added_mass": "2 kg"}, "added_mass"), ({"added_mass": True}, "added_mass"),
        ({"lateral_damping": "-1 N s/m^2"}, "lateral_damping"),
        ({"lateral_damping_speed": 0}, "lateral_damping_speed"), ({"clinging": 1.1}, "clinging"),
        ({"discharge_coefficient": 0}, "discharge_coefficient"), ({"bit_volume": "-1 l"}, "bit_volume"),
        ({"annulus": "yes"}, "annulus"), ({"check_valve": 1}, "check_valve"),
        ({"cuttings": "returned"}, "cuttings"), ({"dynamics": "steady"}, "dynamics"),
        ({"flow_line": 100}, "flow_line"),
    ],
)  # fmt: skip
def test_refused(keys: dict[str, Any], at: str) -> None:
    error = error_of(well=WELL, fluid={**WATER, **keys})
    assert error.at == f"fluid.{at}"
    assert error.want


def test_a_plugged_string_of_a_dry_scene_is_no_mistake() -> None:
    """The same case with and without its fluid, as a sweep varies it."""
    assert Case(string=[PIPE], top="clamped", bottom={"kind": "pinned", "plugged": True}).bottom.plugged
