"""One table of units by kind. Expected values: NIST SP 811 (2008), appendix B."""

import math

import numpy as np
import pytest

from drillpetsc.unit_systems import KINDS, SYSTEMS, display, kind_of, plain, shown, unit_of_bare_number
from drillpetsc.units import to_si
from tests.helpers.tables import each_row

INCH, POUND, G0 = 0.0254, 0.45359237, 9.80665
FOOT, LBF, GALLON = 12 * INCH, POUND * G0, 231 * INCH**3


@each_row(
    ("kind", "field", "metric"),
    [  # size of the unit in SI, and its text
        ("length", (FOOT, "ft"), (1.0, "m")),
        ("diameter", (INCH, "in"), (1e-3, "mm")),
        ("force", (1e3 * LBF, "klbf"), (1e3, "kN")),
        ("torque", (FOOT * LBF, "ft-lbf"), (1e3, "kN m")),
        ("side_force", (LBF / FOOT, "lbf/ft"), (1e3, "kN/m")),
        ("weight_per_length", (POUND / FOOT, "lb/ft"), (1.0, "kg/m")),
        ("pressure", (LBF / INCH**2, "psi"), (1e5, "bar")),
        ("pressure_gradient", (LBF / INCH**2 / FOOT, "psi/ft"), (1e5, "bar/m")),
        ("stress", (LBF / INCH**2, "psi"), (1e6, "MPa")),
        ("mud_weight", (POUND / GALLON, "ppg"), (1e3, "sg")),
        ("flow", (GALLON / 60, "gpm"), (1e-3 / 60, "l/min")),
        ("rop", (FOOT / 3600, "ft/h"), (1 / 3600, "m/h")),
        ("trip_speed", (FOOT / 60, "ft/min"), (1 / 60, "m/min")),
        ("rotation", (math.pi / 30, "rpm"), (math.pi / 30, "rpm")),
        ("dogleg", (math.radians(1) / (100 * FOOT), "deg/100ft"), (math.radians(1) / 30, "deg/30m")),
        ("viscosity", (1e-3, "cP"), (1e-3, "mPa s")),
        ("yield_point", (LBF / (100 * FOOT**2), "lbf/100ft2"), (1.0, "Pa")),
        ("consistency", (LBF / (100 * FOOT**2), "lbf s^n/100ft2"), (1.0, "Pa s^n")),
        ("flow_area", (INCH**2, "in2"), (1e-6, "mm2")),
        ("volume", (42 * GALLON, "bbl"), (1.0, "m3")),
        ("angle", (math.radians(1), "deg"), (math.radians(1), "deg")),
        ("power", (550 * FOOT * LBF, "hp"), (1e3, "kW")),
        ("wear_rate", (LBF / 3600, "ft-lbf/ft/h"), (1.0, "W/m")),
        ("time", (1.0, "s"), (1.0, "s")),
        ("shear_rate", (1.0, "1/s"), (1.0, "1/s")),
    ],
)
def test_units_of_each_kind(kind: str, field: tuple[float, str], metric: tuple[float, str]) -> None:
    for system, (size, text) in (("field", field), ("metric", metric)):
        number, unit = display(3.0 * size, kind, system)  # type: ignore[arg-type]
        assert number == pytest.approx(3.0, rel=1e-12) and unit == text
    assert display(3.0, kind, "SI")[0] == 3.0


def test_temperatures_have_a_zero_of_their_own() -> None:
    assert display(373.15, "temperature", "field") == (pytest.approx(212.0), "degF")
    assert display(373.15, "temperature", "metric") == (pytest.approx(100.0), "degC")
    assert display(373.15, "temperature", "SI") == (373.15, "K")


def test_forces_in_tonnes_and_torque_of_plots() -> None:
    assert display(9806.65, "force", "metric_t") == (pytest.approx(1.0), "t")
    assert display(1e3, "torque", "metric_t") == (pytest.approx(1.0), "kN m")
    assert display(1e3 * FOOT * LBF, "torque", "field", plot=True) == (pytest.approx(1.0), "kft-lbf")


def test_arrays() -> None:
    numbers, unit = display(np.array([0.0, FOOT]), "length", "field")
    assert unit == "ft" and numbers == pytest.approx([0.0, 1.0])


@each_row("kind", KINDS)
def test_every_text_is_read_back(kind: str) -> None:
    """What is printed can be typed: text and number together are the value."""
    if kind == "pressure_gradient":
        return  # no key takes one
    for system in SYSTEMS:
        for plot in (False, True):
            number, unit = display(321.5, kind, system, plot)
            assert to_si(f"{number!r} {unit}", KINDS[kind].si) == pytest.approx(321.5, rel=1e-12)


def test_kinds_of_columns_and_keys() -> None:
    assert kind_of("m") == "length" and kind_of("m", "diameter") == "diameter"
    assert kind_of("m3/s") == kind_of("m^3/s") == "flow"
    assert kind_of("Pa") == "" and kind_of("Pa", "pressure") == "pressure" and kind_of("N", "none") == ""


def test_units_of_bare_numbers() -> None:
    assert unit_of_bare_number("m", "diameter", "field") == "in"
    assert unit_of_bare_number("m", "", "field") == "ft"
    assert unit_of_bare_number("m", "", "SI") == "m"
    assert unit_of_bare_number("Pa", "", "field") is None  # a modulus
    assert unit_of_bare_number("", "", "field") == ""
    assert unit_of_bare_number("N/m", "", "metric") is None


def test_shown() -> None:
    assert shown(0.2159, "diameter", "field") == "8.5 in"
    assert shown(2804.16, "length", "field") == "9200 ft"
    assert shown(1e6, "length", "metric") == "1000000 m"
    assert shown(1000.0, "mud_weight", "SI") == "1000 kg/m3"


def test_no_exponent_from_one_on() -> None:
    assert [plain(x, 1) for x in (0.23, 9.6, 12.4, 99.7)] == ["0.2", "10", "12", "100"]
    assert [plain(x, 3) for x in (1234.5, 1.23e-7)] == ["1234", "1.23e-07"]
