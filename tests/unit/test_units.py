"""Units: expected values follow from the definitions in NIST SP 811 (2008), appendix B, and ISO 80000."""

import math
from typing import get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from drillpetsc import unit_systems, units
from drillpetsc.unit_tables import DIMENSIONS
from drillpetsc.units import UnitError, to_si, wanted
from tests.helpers.tables import each_row

INCH = 0.0254  # [m] exact
POUND = 0.45359237  # [kg] exact
GALLON = 231 * INCH**3  # [m3] exact, US
POUND_FORCE = POUND * 9.80665  # [N] exact
FOOT = 12 * INCH


@each_row(
    ("text", "unit", "expected"),
    [
        ("9-5/8 in", "m", 9.625 * INCH),
        ("1/4 in", "m", INCH / 4),
        ("3937 ftUS", "m", 1200.0),  # the survey foot
        ("-1/4 in", "m", -INCH / 4),
        ("7 l", "m^3", 7e-3),
        ("1 bbl", "m^3", 42 * GALLON),  # an oil barrel, not a dry one
        ("0.05 kg m", "kg m", 0.05),
        ("200 kg m2", "kg m^2", 200.0),
        ("1.0e8 N/m^2", "Pa", 1e8),
        ("1.0e8 Pa", "Pa", 1e8),
        ("206 GPa", "Pa", 206e9),
        ("3e9 N/m^2.5", "N/m^2.5", 3e9),
        ("5 N m", "N m/rad", 5.0),
        ("5 N m/rad", "N m/rad", 5.0),
        ("1e-4 m-1", "1/m", 1e-4),
        ("2.8e-8 m/(s N)", "m/(s N)", 2.8e-8),
        ("9.80665 m/s2", "m/s^2", 9.80665),
        ("30 %", "", 0.3),
        ("0.3", "", 0.3),
        ("5", "m", 5.0),
    ],
)
def test_text_with_a_unit(text: str, unit: str, expected: float) -> None:
    """Spellings of rigs and reports are in test_field_units.py."""
    assert to_si(text, unit) == pytest.approx(expected, rel=1e-14)


def test_conversion_leaves_no_noise_in_the_last_digit() -> None:
    assert to_si("1.2 g/cm3", "kg/m^3") == 1200.0
    assert to_si("400 mm2", "m^2") == 0.0004


@each_row(
    ("text", "unit", "hint"),
    [
        ("5 Hz", "rad/s", "rpm or rad/s"), ("5 1/s", "rad/s", "rpm or rad/s"), ("10 kN", "N m", "force"),
        ("80 rpm", "1/s", "rotation speed"), ("80 rpm", "m", "rotation speed"),
        ("12 ppgg", "kg/m^3", "did you mean 'ppg'?"), ("9,5 in", "m", "point"), ("9 5 in", "m", "one number"),
        ("9 5/0 in", "m", ""), ("5 m + 3 m", "m", "one number"), ("5 __import__('os')", "m", "one number"),
        ("m", "m", "a number comes first"), ("", "m", "a number comes first"),
        ("nan m", "m", "a number comes first"), ("1e400 m", "m", ""), ("5 m/", "m", "cannot be read"),
        ("5 (m", "m", "cannot be read"), ("0.3 m", "", "length"),
    ],
)  # fmt: skip
def test_refused_text(text: str, unit: str, hint: str) -> None:
    with pytest.raises(UnitError) as caught:
        to_si(text, unit)
    assert hint in caught.value.hint
    assert wanted(unit) in caught.value.want


@each_row("value", [None, True, [1.0], {"a": 1}, math.nan, math.inf, np.array([1.0, 2.0])])
def test_refused_values(value: object) -> None:
    with pytest.raises(UnitError):
        to_si(value, "m")


def test_bare_numbers_are_si() -> None:
    assert to_si(5, "m") == 5.0
    assert to_si(np.float32(0.5), "rad/s") == 0.5
    assert to_si(np.int64(3), "") == 3.0


@each_row("unit", DIMENSIONS)
def test_examples_shown_to_the_user_are_accepted(unit: str) -> None:
    for example in DIMENSIONS[unit][1].split(" or "):
        assert to_si(example, unit) > 0


@given(st.floats(-1e12, 1e12), st.sampled_from([u for u in DIMENSIONS if u]))
def test_an_si_number_with_its_own_unit_is_itself(number: float, unit: str) -> None:
    assert to_si(f"{number!r} {unit}", unit) == pytest.approx(number, rel=1e-15, abs=0)


@given(st.text(max_size=20), st.sampled_from(list(DIMENSIONS)))
def test_any_text_is_a_finite_number_or_a_unit_error(text: str, unit: str) -> None:
    try:
        assert math.isfinite(to_si(text, unit))
    except UnitError as error:
        assert error.want


@given(st.text("0123456789.e-+/ *^()mskgNradin°%²", max_size=24))
def test_near_misses_are_a_finite_number_or_a_unit_error(text: str) -> None:
    try:
        assert math.isfinite(to_si("1" + text, "m"))
    except UnitError as error:
        assert error.want


# ---------------------------------------------------------------------- the table of factors
@each_row("unit", list(units.FACTORS))
def test_factors_are_those_of_pint(unit: str) -> None:
    for spelling, factor in units.FACTORS[unit].items():
        text = spelling.replace("second_to_the_n", "s^n")
        assert factor == pytest.approx(units._convert_by_pint(1.0, text, unit, text), rel=1e-14), spelling
        for number in (
            1.0,
            0.1,
            127.0,
            9.625,
        ):  # and so the numbers of a case, once the rounding error is taken off
            by_pint = units._neat(units._convert_by_pint(number, text, unit, text))
            assert to_si(f"{number} {text}", unit) == pytest.approx(by_pint, rel=1e-15), spelling


def test_units_of_the_example_of_each_dimension_need_no_pint() -> None:
    """Keys are read without the slow import as long as they have the usual units."""
    assert set(units.FACTORS) <= set(units.DIMENSIONS) and set(units.DIMENSIONS) - set(units.FACTORS) == set()
    for unit, factors in units.FACTORS.items():
        assert not unit or units._tidy(units.spelled(unit)) in factors or units._tidy(unit) in factors


def test_spelled() -> None:
    spellings = {"kg/m^3": "kg/m3", "Pa s^n": "Pa s^n", "N/m^2.5": "N/m^2.5", "N s/m^2": "N s/m2", "": ""}
    assert {unit: units.spelled(unit) for unit in spellings} == spellings


@each_row(
    "text",
    [
        "9 m%2", "9 m%", "9 %m", "9 percent m", "9 m*2", "9 m * 2", "9 m 2", "9 m/2", "9 m / 2.5", "9 m//s",
        "9 m/s/2",
    ],
)  # fmt: skip
def test_a_unit_is_no_sum_to_work_out(text: str) -> None:
    """A factor, a share or a divisor behind the unit is a slip of the pen, or two cells in one; it must not change the number."""
    with pytest.raises(UnitError):
        to_si(text, "m/s" if "s" in text.partition("m")[2] else "m")


@each_row(
    "text",
    [
        "9 m 9^9^9^9", "9 m3^7²8", "11 m8²^55²*m0", "1 m^2^9^9^9", "9 m²²²²²²²²²", "1 g5²²^8", "9 m³**99**99",
        "9 (m)²^99^99",
    ],
)  # fmt: skip
def test_a_power_of_a_power_is_refused_and_not_computed(text: str) -> None:
    """The units package would compute 3^7^28 as a whole number, for hours."""
    with pytest.raises(UnitError):
        to_si(text, "m")


@each_row(
    ("text", "unit", "value"),
    [
        ("1 deg / 100 ft", "1/m", 3.14159265358979 / 180 / 30.48),
        ("9 m ** 2", "m^2", 9.0),
        ("2 kg m^-3", "kg/m^3", 2.0),
        ("3 lbf/100 ft2", "Pa", 3 * 4.4482216152605 / 9.290304),
        ("20 %", "", 0.2),
    ],
)
def test_numbers_that_belong_to_a_unit_stay(text: str, unit: str, value: float) -> None:
    assert to_si(text, unit) == pytest.approx(value, rel=1e-12)


@each_row(
    "text, unit", [("2.5 J", "J"), ("3 ft-lbf", "J"), ("0.29 rev/gal", "rad/m^3"), ("0.5 rev/l", "rad/m^3"), ("7 rad/m3", "rad/m^3")]
)  # fmt: skip
def test_units_of_tools_are_those_of_pint(text: str, unit: str) -> None:
    number, spelling = text.split()
    assert to_si(text, unit) == units._neat(units._convert_by_pint(float(number), spelling, unit, text))


@each_row("kind", unit_systems.KINDS)
def test_printing_needs_no_pint(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Building its registry takes a third of a short run."""
    monkeypatch.setattr(units, "_convert_by_pint", lambda *_: pytest.fail("pint"))
    units._text_to_si.cache_clear()
    for system in get_args(unit_systems.System):
        for plot in (False, True):
            unit_systems.display_unit(kind, system, plot)
