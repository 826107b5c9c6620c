"""`units:` of a case: what bare numbers mean. Expected values follow from the definitions of the units."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from drillpetsc.case import Case, load_case
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

FOOT, INCH, POUND, G0 = 0.3048, 0.0254, 0.45359237, 9.80665
LBF, GALLON, PSI = POUND * G0, 231 * INCH**3, POUND * G0 / INCH**2

FIELD: dict[str, Any] = {
    "units": "field",
    "well": {
        "survey": {"md": [0, 1000, 2000], "inclination": [0, 0, 10], "azimuth": [0, 0, 45]},
        "sections": [{"to": 1000, "kind": "casing", "diameter": 9.625}, {"kind": "open_hole", "diameter": "8 1/2"}],
    },
    "string": [
        {"kind": "pipe", "length": 1500, "od": 5, "id": "4.276"},
        {"kind": "pipe", "length": 400, "od": "6 3/4", "id": "2-13/16"},
        {"kind": "bit", "length": 1, "od": "8 1/2 in", "nozzle_area": 0.331, "mass": "100 lb"},
    ],
    "top": {"kind": "top_drive", "rotation": 120},
    "bottom": "bit",
    "initial": {"wob": 10},
    "fluid": {
        "density": 10.5,
        "flow_rate": 500,
        "rheology": {"model": "bingham", "yield_stress": 18, "plastic_viscosity": 23},
        "outlet_pressure": 100,
    },
    "time": {"end": 10},
    "output": {"probes": [1000]},
}  # fmt: skip


def in_metric() -> dict[str, Any]:
    """The same case in metric units, each number by hand from the definitions."""
    case: dict[str, Any] = {
        "units": "metric",
        "well": {
            "survey": {"md": [0, 304.8, 609.6], "inclination": [0, 0, 10], "azimuth": [0, 0, 45]},
            "sections": [{"to": 304.8, "kind": "casing", "diameter": 244.475}, {"kind": "open_hole", "diameter": 215.9}],
        },
        "string": [
            {"kind": "pipe", "length": 457.2, "od": 127, "id": 4.276 * 25.4},
            {"kind": "pipe", "length": 121.92, "od": 171.45, "id": 71.4375},
            {"kind": "bit", "length": 0.3048, "od": 215.9, "nozzle_area": 0.331 * 645.16, "mass": "45.359237 kg"},
        ],
        "top": {"kind": "top_drive", "rotation": 120},
        "bottom": "bit",
        "initial": {"wob": 10 * LBF},  # kN
        "fluid": {
            "density": 10.5 * POUND / GALLON / 1000,
            "flow_rate": 500 * GALLON * 1000,
            "rheology": {"model": "bingham", "yield_stress": 18 * LBF / (100 * FOOT**2), "plastic_viscosity": 23},
            "outlet_pressure": 100 * PSI / 1e5,
        },
        "time": {"end": 10},
        "output": {"probes": [304.8]},
    }  # fmt: skip
    return case


def in_si() -> dict[str, Any]:
    """The same case in SI."""
    return {
        "well": {
            "survey": {"md": [0, 304.8, 609.6], "inclination": [0, 0, math.pi / 18], "azimuth": [0, 0, math.pi / 4]},
            "sections": [{"to": 304.8, "kind": "casing", "diameter": 0.244475}, {"kind": "open_hole", "diameter": 0.2159}],
        },
        "string": [
            {"kind": "pipe", "length": 457.2, "od": 0.127, "id": 4.276 * INCH},
            {"kind": "pipe", "length": 121.92, "od": 0.17145, "id": 0.0714375},
            {"kind": "bit", "length": 0.3048, "od": 0.2159, "nozzle_area": 0.331 * INCH**2, "mass": 100 * POUND},
        ],
        "top": {"kind": "top_drive", "rotation": 4 * math.pi},
        "bottom": "bit",
        "initial": {"wob": 1e4 * LBF},
        "fluid": {
            "density": 10.5 * POUND / GALLON,
            "flow_rate": 500 * GALLON / 60,
            "rheology": {"model": "bingham", "yield_stress": 18 * LBF / (100 * FOOT**2), "plastic_viscosity": 0.023},
            "outlet_pressure": 100 * PSI,
        },
        "time": {"end": 10},
        "output": {"probes": [304.8]},
    }  # fmt: skip


def numbers(data: Any, at: str = "") -> dict[str, Any]:
    """Every value of a case by its path."""
    if isinstance(data, dict):
        return {k: v for key, part in data.items() for k, v in numbers(part, f"{at}.{key}").items()}
    if isinstance(data, (list, tuple)):
        return {k: v for i, part in enumerate(data) for k, v in numbers(part, f"{at}[{i}]").items()}
    return {at: data}


def test_the_same_case_in_three_systems() -> None:
    expected = numbers(case_data(Case(**in_si())))
    for data in (FIELD, in_metric()):
        found = numbers(case_data(Case(**data)))
        assert found.pop(".output.units") == data["units"]
        assert found.keys() == expected.keys()
        for at, value in expected.items():
            assert found[at] == (pytest.approx(value, rel=1e-9) if isinstance(value, float) else value), at


def test_a_case_is_in_si_once_read(tmp_path: Path) -> None:
    case = Case(**FIELD)
    assert case.units == "SI" and case.output.units == "field"
    case.dump(tmp_path / "case.yaml")
    assert load_case(tmp_path / "case.yaml") == case and "units: field" in case.to_yaml()
    assert Case(**case_data(case)) == case


def test_text_with_a_unit_wins() -> None:
    data = dict(in_si(), units="field")
    assert Case(**FIELD, material={"young": "30e6 psi"}).material.young == pytest.approx(30e6 * PSI)
    with pytest.raises(CaseError):
        Case(**data)  # 0.127 in of pipe in a hole of 0.2 in


@each_row(
    ("where", "value", "example"),
    [
        ("material", {"young": 30e6}, "Pa"),
        ("material", {"density": 490}, "kg/m3"),
        ("contact", {"slip_velocity": 1}, "m/s"),
        ("gravity", 32.2, "m/s2"),
    ],
)
def test_keys_without_a_row_need_a_unit(where: str, value: Any, example: str) -> None:
    with pytest.raises(CaseError) as caught:
        Case(**(FIELD | {where: value}))
    assert "units: field" in caught.value.hint and example in caught.value.hint


def test_lowering_needs_a_unit() -> None:
    """ft/h for a rate of penetration, ft/min for a trip: not to be guessed."""
    with pytest.raises(CaseError) as caught:
        Case(**(FIELD | {"top": {"kind": "top_drive", "rotation": 120, "lowering": 60}}))
    assert caught.value.at == "top.lowering"


def test_a_fraction_without_a_unit() -> None:
    """8 1/2 is 8 1/2 in for a diameter in field units, and refused elsewhere."""
    data = in_metric()
    data["string"][0]["od"] = "5 1/2"
    with pytest.raises(CaseError) as caught:
        Case(**data)
    assert "5 1/2 in" in caught.value.hint
    data = FIELD | {"output": {"probes": ["100 1/2"]}}
    with pytest.raises(CaseError):
        Case(**data)


def test_forces_in_tonnes() -> None:
    case = Case(**(in_metric() | {"force_unit": "t", "initial": {"wob": 4}}))
    assert case.initial.wob == pytest.approx(4000 * G0) and case.output.units == "metric_t"
    with pytest.raises(CaseError) as caught:
        Case(**(FIELD | {"force_unit": "t"}))
    assert caught.value.at == "force_unit"


def test_the_hint_names_the_unit_of_a_bare_number() -> None:
    data = FIELD | {"output": {"probes": [-5]}}
    with pytest.raises(CaseError) as caught:
        Case(**data)
    assert caught.value.hint == "a bare number is in ft"  # -5 m would be no better


def test_unknown_system() -> None:
    with pytest.raises(CaseError) as caught:
        Case(**(in_si() | {"units": "imperial"}))
    assert caught.value.at == "units" and "field" in caught.value.want


def test_unknown_system_is_the_only_error() -> None:
    """Numbers that were read in SI for want of a system are no errors of the file: one message."""
    with pytest.raises(CaseError) as caught:
        Case(**(FIELD | {"units": "imperial"}))
    assert caught.value.at == "units" and caught.value.also == ()


def test_the_hint_offers_si() -> None:
    with pytest.raises(CaseError) as caught:
        Case(**(FIELD | {"fluid": FIELD["fluid"] | {"density": 1200}}))
    assert "a bare number is in ppg; was '1200 kg/m3' meant?" in caught.value.hint


def test_string_of_the_tally_in_field_units() -> None:
    """Bare numbers and texts with units are the same string, figures of the catalogue included."""
    hole = {
        "survey": {
            "md": ["0 m", "2000 ft"],
            "inclination": ["0 deg", "0 deg"],
            "azimuth": ["0 deg", "0 deg"],
        },
        "sections": [{"kind": "open_hole", "diameter": "8.5 in"}],
    }
    bit = {"kind": "bit", "od": "8 1/2 in", "nozzles": "3 x 12/32 in"}
    joint = {"od": "6.5 in", "id": "3 in", "length": "20 in"}
    texts: list[dict[str, Any]] = [
        {"kind": "drill_pipe", "length": "1000 ft", "pipe": "5in 19.50 S-135 NC50 premium"},
        {
            "kind": "drill_pipe",
            "length": "100 ft",
            "od": "5 in",
            "id": "4.276 in",
            "adjusted_weight": "22 lb/ft",
            "tool_joint": joint,
        },
        {
            "kind": "drill_collar",
            "length": "180 ft",
            "od": "6 3/4 in",
            "id": "2 13/16 in",
            "joint_length": "30 ft",
            "yield_strength": "105000 psi",
            "bend": {"angle": "1 deg", "position": "100 ft"},
        },
        {"kind": "coiled_tubing", "length": "30 ft", "od": "2 in", "wall": "0.156 in"},
        {
            "kind": "stabilizer",
            "length": "6 ft",
            "blade_od": "8 3/8 in",
            "blade_length": "18 in",
            "body_od": "6 3/4 in",
            "id": "2 13/16 in",
            "bypass_area": "14 in2",
        },
        {**bit, "length": "1 ft"},
    ]
    bare: list[dict[str, Any]] = [
        {"kind": "drill_pipe", "length": 1000, "pipe": "5in 19.50 S-135 NC50 premium"},
        {"kind": "drill_pipe", "length": 100, "od": 5, "id": 4.276, "adjusted_weight": 22, "tool_joint": {**joint, "od": 6.5, "id": 3}},
        {"kind": "drill_collar", "length": 180, "od": "6 3/4", "id": "2 13/16", "joint_length": 30, "yield_strength": 105e3,
         "bend": {"angle": 1, "position": 100}},
        {"kind": "coiled_tubing", "length": 30, "od": 2, "wall": 0.156},
        {"kind": "stabilizer", "length": 6, "blade_od": "8 3/8", "blade_length": 18, "body_od": 6.75, "id": "2 13/16", "bypass_area": 14},
        {**bit, "length": 1, "od": 8.5},
    ]  # fmt: skip
    rig = {"block_weight": "60 klbf", "max_spp": "5000 psi"}
    expected = numbers(case_data(Case(string=texts, well=hole, top="clamped", rig=rig)))
    rig = {"block_weight": 60, "max_spp": 5000}
    found = numbers(case_data(Case(string=bare, well=hole, top="clamped", rig=rig, units="field")))
    assert found.pop(".output.units") == "field" and found.keys() == expected.keys()
    for at, value in expected.items():
        assert found[at] == (pytest.approx(value, rel=1e-9) if isinstance(value, float) else value), at
    bare[1]["tool_joint"]["length"] = 20  # inches or feet?
    with pytest.raises(CaseError) as caught:
        Case(string=bare, well=hole, top="clamped", units="field")
    assert caught.value.at == "string[1].tool_joint.length"


def test_rate_and_range_of_a_sensor_in_field_units() -> None:
    """A bare rate is in Hz in every system; `16 g` is an acceleration; depth in feet, radius in inches."""
    pipe = {"kind": "pipe", "length": 60, "od": 5, "id": 4.276}
    sensor = {"name": "mwd", "at": 20, "rate": 50, "range": "16 g", "radius": 2, "filter": {"cutoff": 20}}
    case = Case(units="field", string=[pipe], top="clamped", output={"sensors": [sensor]})
    (read,) = case.output.sensors
    assert read.rate == 50 and read.filter is not None and read.filter.cutoff == 20
    assert read.range == pytest.approx(16 * 9.80665)
    assert (read.at, read.radius) == (pytest.approx(20 * 0.3048), pytest.approx(2 * 0.0254))


@pytest.mark.parametrize("kind", [np.int64, np.int32, np.float32, np.float64])
def test_numbers_of_numpy_have_the_units_of_the_case(kind):
    """Whole numbers and short floats of numpy were read as SI in a field case: 100 was 100 m instead of 100 ft."""

    def made(number):
        def many(*values):
            return [number(v) for v in values]

        return Case(
            units="field",
            well={
                "survey": {"md": many(0, 2000, 6000), "inclination": many(0, 0, 40), "azimuth": many(0, 10, 20)},
                "sections": [{"to": "end", "kind": "open_hole", "diameter": number(9), "friction": 0.3}],
            },
            string=[
                {"kind": "drill_pipe", "length": number(5000), "pipe": "5in 19.50 S-135 NC50 premium"},
                {"kind": "bit", "length": number(1), "od": number(9), "nozzles": many(12, 12, 14)},
            ],
            top={"kind": "top_drive", "rotation": number(100)},
            fluid={"density": number(10), "flow_rate": number(500), "rheology": {"pv": number(20), "yp": number(15)}},
            time={"end": 1},
        )  # fmt: skip

    assert made(kind).to_yaml() == made(int).to_yaml()
    assert made(lambda v: np.array(kind(v))).to_yaml() == made(int).to_yaml()
    arrays = made(int).replace({"fluid.density": kind(11)})
    assert arrays.fluid.density == pytest.approx(11 * 0.45359237 / 0.003785411784)
