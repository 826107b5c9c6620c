"""The rock, the bit's laws and quasi-static time in a case: defaults, layers, what follows from other blocks,
round trips."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc.analysis.commands.check import describe
from drillpetsc.case import Case, load_case
from drillpetsc.case.blocks.formation import Formation, RockAnisotropy, check_turning, largest_turn_of_bit
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

PIPE: dict[str, Any] = {"kind": "pipe", "length": "90 m", "od": "5 in", "id": "4.276 in"}
BIT: dict[str, Any] = {"kind": "bit", "length": 0.5, "od": "8.5 in", "mass": "60 kg"}
SECTION: dict[str, Any] = {"to": 100, "kind": "open_hole", "diameter": "8.5 in"}
WELL: dict[str, Any] = {
    "survey": {"md": [0, 100], "inclination": [0, 0], "azimuth": [0, 0]},
    "sections": [SECTION],
}
WATER: dict[str, Any] = {"density": 1000, "rheology": {"model": "newtonian", "viscosity": "1 cP"}}
TURNING: dict[str, Any] = {"kind": "top_drive", "rotation": "80 rpm", "lowering": "10 m/h"}


def make_case(**keys: Any) -> Case:
    return Case(
        **{"string": [PIPE, BIT], "well": WELL, "top": TURNING, "bottom": "bit", "formation": {}, **keys}
    )


def rock(**keys: Any) -> Formation:
    made = make_case(formation=keys).formation
    assert made is not None
    return made


def error_of(**keys: Any) -> CaseError:
    with pytest.raises(CaseError) as caught:
        make_case(**keys)
    return caught.value


def test_defaults() -> None:
    """Defaults of the case format (manual: sec-bit-rate)."""
    made = rock()
    assert (made.drillability, made.bit_anisotropy, made.rotary_exponent, made.weight_exponent) == (
        2.8e-8, 0.2, 1.0, 1.0,
    )  # fmt: skip
    assert (made.threshold, made.reference_speed, made.reference_weight) == (0.0, 4 * math.pi, 1e5)
    beds = made.rock_anisotropy
    assert (beds.dip, beds.dip_azimuth, beds.index_dip, beds.index_strike) == (0.0, 0.0, 1.0, 1.0)
    assert (made.walk, made.overgauge, made.node_spacing) == (0.0, 0.0, 0.5)
    assert (made.growth, made.direction, made.layers) == ("state", "rop_vector", ())
    assert (made.bit_law.kind, made.bit_law.stiffness) == ("rop", None)
    assert make_case(formation=None).formation is None


def test_defaults_of_the_bit_laws() -> None:
    """Defaults of the drag bit (manual: sec-bit-drag)."""
    drag = rock(bit_law="drag_bit").bit_law
    assert (drag.blades, drag.specific_energy, drag.inclination_ratio) == (4, 60e6, 0.6)
    assert (drag.contact_stress, drag.wear_flat, drag.friction) == (60e6, 1.2e-3, 0.6)
    weak = rock(
        bit_law={"kind": "velocity_weakening", "static": "5 kN m", "dynamic": 3000, "speed": "10 rpm"}
    ).bit_law
    assert (weak.static, weak.dynamic, weak.static_friction, weak.dynamic_friction) == (5e3, 3e3, None, None)
    assert weak.speed == pytest.approx(math.pi / 3)
    keys = {"kind": "velocity_weakening", "static_friction": 0.5, "dynamic_friction": 0.5, "speed": 1}
    assert (rock(bit_law=keys).bit_law.static_friction, rock(bit_law=keys).bit_law.static) == (0.5, None)


def test_units() -> None:
    """10 m/h under 100 kN is 10/3600 m/s over 1e5 N."""
    made = rock(
        drillability="10 m/h/(100 kN)",
        walk="-10 deg",
        overgauge="-2 mm",
        reference_speed="60 rpm",
        threshold="1 t g_0",
    )
    assert made.drillability == pytest.approx(10 / 3600 / 1e5, rel=1e-12)
    assert (made.walk, made.overgauge) == (pytest.approx(-math.pi / 18), -2e-3)
    assert (made.reference_speed, made.threshold) == (pytest.approx(2 * math.pi), pytest.approx(9806.65))


def test_a_layer_takes_the_rest_from_the_formation() -> None:
    own = {
        "drillability": 5e-8,
        "bit_anisotropy": 0.3,
        "rotary_exponent": 0.8,
        "weight_exponent": 1.5,
        "threshold": "2 kN",
    }
    beds = {"dip": "20 deg", "dip_azimuth": "90 deg", "index_dip": 0.95}
    layers = [
        {"from": 100, "drillability": 0},
        {"from": "150 m", "rock_anisotropy": {"dip": 0, "index_strike": 1.1}, "threshold": 0},
    ]
    made = rock(**own, rock_anisotropy=beds, layers=layers)
    first, second = made.layers
    assert (first.from_, first.to, first.drillability) == (100.0, 150.0, 0.0)
    assert first.rock_anisotropy == made.rock_anisotropy
    assert (first.bit_anisotropy, first.rotary_exponent, first.weight_exponent, first.threshold) == (
        0.3, 0.8, 1.5, 2e3,
    )  # fmt: skip
    assert (second.from_, second.to, second.drillability, second.threshold) == (150.0, None, 5e-8, 0.0)
    mixed = second.rock_anisotropy
    assert (mixed.dip, mixed.dip_azimuth, mixed.index_dip, mixed.index_strike) == (
        0.0, pytest.approx(math.pi / 2), 0.95, 1.1,
    )  # fmt: skip


def test_which_rock_lies_where() -> None:
    """Above the first layer, and below a last one that ends, it is the formation's own."""
    made = rock(
        layers=[
            {"from": 100, "to": 110, "drillability": 1e-8},
            {"from": 110, "to": 120, "drillability": 2e-8},
        ]
    )
    values = [(layer.from_, layer.to, layer.drillability) for layer in made.layers]
    assert values == [(100, 110, 1e-8), (110, 120, 2e-8), (120, None, 2.8e-8)]
    open_below = rock(layers=[{"from": 0, "drillability": 1e-8}])
    assert [(layer.from_, layer.to, layer.drillability) for layer in open_below.layers] == [(0, None, 1e-8)]
    assert rock().layers == ()


def test_the_stiffness_of_law_and_bottom_is_one() -> None:
    for law in ("rop", "drag_bit"):
        given = {"bit_law": {"kind": law, "stiffness": "2e8 N/m"}}
        assert make_case(formation=given).bottom.stiffness == 2e8
        assert make_case(formation=given, bottom={"kind": "bit", "friction": 0.5}).bottom.stiffness == 2e8
        assert make_case(formation=given, bottom={"kind": "bit", "stiffness": 2e8}).bottom.stiffness == 2e8
        assert (
            error_of(formation=given, bottom={"kind": "bit", "stiffness": 1e8}).at
            == "formation.bit_law.stiffness"
        )
    assert make_case(bottom={"kind": "bit", "stiffness": 3e8}).bottom.stiffness == 3e8
    assert make_case().bottom.stiffness == 1e8


def least_power(sideways: float, beds: RockAnisotropy, walk: float) -> float:
    """Smallest eigenvalue of sym(M_r M_b) over a sphere of axes e, by the matrices themselves (dip 0: n, d, s
    are z, x, y)."""
    m_rock = np.diag([beds.index_dip, beds.index_strike, 1.0])
    theta, phi = (
        q.ravel() for q in np.meshgrid(np.linspace(0, math.pi, 61), np.linspace(0, 2 * math.pi, 121))
    )
    e = np.stack((np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)), axis=1)
    along = e[:, :, None] * e[:, None, :]
    across = np.eye(3) - along
    about = np.cross(e[:, None, :], np.eye(3)).swapaxes(1, 2)  # columns e x (axis)
    power = m_rock @ (along + sideways * (math.cos(walk) * across + math.sin(walk) * about))
    return float(np.linalg.eigvalsh((power + power.swapaxes(1, 2)) / 2)[:, 0].min())


@each_row("walk", [0.0, 0.3, -math.pi / 4])
@each_row("sideways", [0.05, 0.2, 0.6, 1.0])
def test_where_the_bit_would_move_against_the_force(sideways: float, walk: float) -> None:
    """Just inside the limit on the ratio of the rock's indices sym(M_r M_b) is positive definite for every
    direction of the bit, just outside it is not: eigenvalues over a sphere of directions, 3 degrees apart."""
    bit = largest_turn_of_bit(sideways, walk)
    if bit < 1e-6:  # a round bit moves along with the force in any rock
        hard = RockAnisotropy(index_dip=1e-2, index_strike=2)
        check_turning(sideways, hard, walk, ())
        assert least_power(sideways, hard, walk) > 0
        return
    ratio = (1 + math.cos(bit)) / (1 - math.cos(bit))
    fine, wrong = (
        RockAnisotropy(index_dip=1 / r, index_strike=1 / math.sqrt(r)) for r in (0.97 * ratio, 1.03 * ratio)
    )
    check_turning(sideways, fine, walk, ())
    assert least_power(sideways, fine, walk) > 0
    assert least_power(sideways, wrong, walk) < 0
    beds = {"index_dip": wrong.index_dip, "index_strike": wrong.index_strike}
    assert (
        error_of(formation={"bit_anisotropy": sideways, "walk": walk, "rock_anisotropy": beds}).at
        == "formation.rock_anisotropy"
    )


def test_a_layer_is_checked_with_what_it_takes_from_the_formation() -> None:
    beds = {"index_dip": 0.3}  # up to 6.85 with a bit_anisotropy of 0.2, not with 0.05
    assert rock(rock_anisotropy=beds).rock_anisotropy.index_dip == 0.3
    assert error_of(formation={"rock_anisotropy": beds, "layers": [{"from": 9, "bit_anisotropy": 0.05}]}).at == (
        "formation.layers[0].bit_anisotropy")  # fmt: skip
    assert error_of(formation={"bit_anisotropy": 0.05, "layers": [{"from": 9, "rock_anisotropy": beds}]}).at == (
        "formation.layers[0].rock_anisotropy")  # fmt: skip


def test_a_bit_passes_all_sections_above_it() -> None:
    """Also without a formation; what lies below the string does not matter."""

    def sections(first: str, second: str, depth: float) -> dict[str, Any]:
        return {
            **WELL,
            "sections": [{"to": depth, "kind": "casing", "diameter": first}, {**SECTION, "diameter": second}],
        }

    assert make_case(well=sections("8.5 in", "8.5 in", 50), formation=None).string[1].od == 0.2159
    for formation in ({}, None):
        assert error_of(well=sections("8.4 in", "9 in", 50), formation=formation).at == "string[1].od"
        assert error_of(well=sections("9 in", "8.4 in", 50), formation=formation).at == "string[1].od"
    assert make_case(well=sections("9 in", "8.4 in", 95), formation=None).string_length == 90.5


def test_formation_with_and_without_contact_and_fluid() -> None:
    assert make_case().contact is not None
    assert make_case(contact="none").contact is None
    wet = make_case(fluid={**WATER, "cuttings": "returned", "dynamics": "quasi_steady"}).fluid
    assert wet is not None and (wet.cuttings, wet.dynamics) == ("returned", "quasi_steady")
    assert error_of(fluid={**WATER, "cuttings": "returned"}, formation=None).at == "fluid.cuttings"


def test_hoisting_with_a_cutting_bit_is_allowed() -> None:
    """The bit lifts off and the hole stays as it is."""
    hoisted = make_case(
        top={"kind": "top_drive", "lowering": {"time": [0, 10, 10], "value": [0.003, 0.003, -0.1]}}
    )
    assert hoisted.formation is not None


def test_quasi_static_time(tmp_path: Path) -> None:
    time = make_case(time={"end": "1 hour", "mode": "quasi_static", "step": "30 s"}).time
    assert time is not None and (time.mode, time.end, time.step) == ("quasi_static", 3600.0, 30.0)
    free = make_case(time={"end": 5, "mode": "quasi_static"}, formation=None, initial={"wob": "10 kN"}).time
    assert free is not None and free.step is None
    assert make_case(time={"end": 5}).time.mode == "dynamic"  # type: ignore[union-attr]
    (tmp_path / "checkpoint.h5").touch()
    assert (
        make_case(time={"end": 5, "mode": "quasi_static"}, initial={"from": str(tmp_path)}).time.mode
        == "quasi_static"
    )  # type: ignore[union-attr]
    for start in ("rest", "straight"):
        assert error_of(time={"end": 5, "mode": "quasi_static"}, initial={"from": start}).at == "initial.from"


@each_row(
    ("keys", "at"),
    [
        ({"drillability": -1e-9}, "drillability"),
        ({"bit_anisotropy": 0}, "bit_anisotropy"),
        ({"rock_anisotropy": {"index_dip": 0}}, "rock_anisotropy.index_dip"),
        ({"rock_anisotropy": {"index_strike": 2.1}}, "rock_anisotropy.index_strike"),
        ({"rock_anisotropy": {"dip": "-1 deg"}}, "rock_anisotropy.dip"),
        ({"rock_anisotropy": 0.9}, "rock_anisotropy"),
        ({"rotary_exponent": 3.1}, "rotary_exponent"),
        ({"weight_exponent": 0}, "weight_exponent"),
        ({"threshold": "-1 N"}, "threshold"),
        ({"threshold": "1 kg"}, "threshold"),
        ({"reference_speed": "10 Hz"}, "reference_speed"),
        ({"reference_weight": 0}, "reference_weight"),
        ({"walk": "50 deg"}, "walk"),
        ({"overgauge": "-25 mm"}, "overgauge"),
        ({"growth": "states"}, "growth"),
        ({"direction": "axis"}, "direction"),
        ({"node_spacing": 0}, "node_spacing"),
        ({"node_spacing": "11 m"}, "node_spacing"),
        ({"layers": {"from": 100}}, "layers"),
        ({"layers": [{"drillability": 1e-8}]}, "layers[0].from"),
        ({"layers": [{"from": 5}, {"from": 5}]}, "layers[1].from"),
        ({"layers": [{"from": 5, "to": 5}]}, "layers[0].to"),
        ({"layers": [{"from": 5, "to": 6}, {"from": 7}]}, "layers[1].from"),
        ({"layers": [{"from": 5, "bit_law": "rop"}]}, "layers[0].bit_law"),
        ({"bit_law": "velocity_weakening"}, "bit_law"),
        ({"bit_law": {"kind": "velocity_weakening", "static": 2, "dynamic": 1}}, "bit_law.speed"),
        ({"bit_law": {"kind": "velocity_weakening", "static": 2, "speed": 1}}, "bit_law.dynamic"),
        (
            {"bit_law": {"kind": "velocity_weakening", "dynamic_friction": 2, "speed": 1}},
            "bit_law.static_friction",
        ),
        (
            {"bit_law": {"kind": "velocity_weakening", "static": 1, "dynamic": 2, "speed": 1}},
            "bit_law.dynamic",
        ),
        ({"bit_law": {"kind": "drag_bit", "blades": 21}}, "bit_law.blades"),
        ({"bit_law": {"kind": "drag_bit", "wear_flat": "-1 mm"}}, "bit_law.wear_flat"),
        ({"bit_law": {"kind": "drag_bit", "stiffness": 0}}, "bit_law.stiffness"),
    ],
)
def test_refused(keys: dict[str, Any], at: str) -> None:
    error = error_of(formation=keys)
    assert error.at == f"formation.{at}"
    assert error.want


def test_a_value_out_of_range_is_explained() -> None:
    assert "sideways" in error_of(formation={"bit_anisotropy": 1.5}).hint
    assert "0.9 to 1.1" in error_of(formation={"rock_anisotropy": {"index_dip": 3}}).hint


@each_row(
    "keys",
    [
        {},
        {
            "formation": {
                "layers": [
                    {"from": 100, "to": 110, "drillability": 0},
                    {"from": 110, "to": 150, "rock_anisotropy": {"dip": 0.1}},
                ]
            }
        },
        {
            "formation": {
                "bit_law": {"kind": "drag_bit", "blades": 5, "stiffness": 5e7},
                "rock_anisotropy": {"index_dip": 0.9},
            }
        },
        {
            "formation": {
                "bit_law": {"kind": "velocity_weakening", "static": 2, "dynamic": 1, "speed": 1},
                "growth": "post_step",
            }
        },
        {
            "formation": {"overgauge": -1e-3},
            "contact": "none",
            "time": {"end": 60, "mode": "quasi_static", "step": 5},
        },
        {
            "fluid": {**WATER, "cuttings": "returned", "dynamics": "quasi_steady"},
            "bottom": {"kind": "bit", "stiffness": 2e8},
        },
    ],
)
def test_a_written_case_reads_back_the_same(keys: dict[str, Any], tmp_path: Path) -> None:
    case = make_case(**keys)
    case.dump(tmp_path / "case.yaml")
    assert load_case(tmp_path / "case.yaml") == case
    assert Case(**case_data(case)) == case


def test_described_in_words() -> None:
    formation = {"bit_law": "drag_bit", "layers": [{"from": 100, "drillability": 1e-9}]}
    has, lacks = describe(make_case(formation=formation, time={"end": 60, "mode": "quasi_static"})).split(
        "leaves out"
    )
    assert "bit cutting rock (law drag_bit, drillability 1e-09 m/(s N) to 2.8e-08 m/(s N), 1 layer)" in has
    assert "quasi-static" in has and "inertia" not in has and "inertia" in lacks
    has, lacks = describe(make_case(formation=None, time={"end": 60})).split("leaves out")
    assert "bit cutting rock" in lacks and "inertia" in has and "quasi-static" not in has
