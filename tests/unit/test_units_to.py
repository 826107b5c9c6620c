"""`drillpetsc.units.to`: values of results in other units. Factors: NIST SP 811 (2008), appendix B."""

from __future__ import annotations

import math

import numpy as np
import pytest

import drillpetsc
from drillpetsc.units import UnitError, to
from tests.helpers.tables import each_row


class Variable:
    """A variable with attributes, as xarray has them."""

    def __init__(self, values, attrs):
        self.values, self.attrs = values, attrs

    def __mul__(self, factor):
        return Variable(self.values * factor, {})

    def __add__(self, more):
        return Variable(self.values + more, {})


@each_row(
    ("value", "unit", "wanted"),
    [
        (4448.2216152605, "klbf", 1.0), (0.2159, "in", 8.5), (119.826427, "ppg", 1.0), (6894.757, "psi", 1.0),
        (6.309020e-05, "gpm", 1.0), (1.355817948, "ft-lbf", 1.0), (14.59390, "lbf/ft", 1.0),
        (math.pi, "deg", 180.0), (math.pi, "rpm", 30.0), (310.9277778, "degF", 100.0),
        (1000.0, "N/m", 1000.0),
    ],
)  # fmt: skip
def test_numbers_in_si(value: float, unit: str, wanted: float) -> None:
    assert to(value, unit) == pytest.approx(wanted, rel=2e-6)


def test_arrays_and_the_name_in_the_package() -> None:
    changed = drillpetsc.units.to(np.array([0.0, 4448.2216152605]), "klbf")
    assert changed == pytest.approx([0.0, 1.0], abs=1e-9)


def test_variables_keep_their_attributes() -> None:
    changed = to(Variable(1.0, {"units": "deg/(30 m)", "label": "Dogleg severity"}), "deg/100ft")
    assert changed.values == pytest.approx(1.016, rel=1e-9)  # 100 ft = 30.48 m
    assert changed.attrs == {"units": "deg/100ft", "label": "Dogleg severity"}


def test_temperatures_keep_their_zeros() -> None:
    assert to(Variable(212.0, {"units": "degF"}), "degC").values == pytest.approx(100.0)
    assert to(Variable(20.0, {"units": "degC"}), "degF").values == pytest.approx(68.0)


def test_a_pound_of_a_force_is_a_force() -> None:
    assert to(Variable(1.0, {"units": "N"}), "lb").values == pytest.approx(1 / 4.4482216152605)
    with pytest.raises(UnitError, match="a mass and a force"):
        to(1.0, "lb")


@each_row("unit", ["furlong per fortnight!", "min/ft", ""])
def test_other_units_are_refused(unit: str) -> None:
    with pytest.raises(UnitError):
        to(1.0, unit)
    with pytest.raises(UnitError):
        to(Variable(1.0, {"units": "N"}), "m")
