"""Burst and collapse of pipe against published tables.

API RP 7G, tables of internal and collapse pressure of drill pipe (new, premium, class 2); API 5C3, constants of the collapse
formulas. Values as recalled from the tables, which the formulas give to the last digit of psi.
"""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc.analysis.loads.limits.strength import (
    PSI,
    burst_pressure,
    collapse_constants,
    collapse_pressure,
    pressure_ratios,
    yield_under_tension,
)
from tests.helpers.tables import each_row

KSI = 1000 * PSI


def tube(size: float, wall: float, left: float) -> tuple[float, float]:
    """(outer diameter, wall) of a tube worn on the outside."""
    return size - 2 * (1 - left) * wall, left * wall


@each_row(
    ("size", "wall", "left", "ksi", "burst", "collapse"),
    [
        (5.0, 0.362, 1.0, 75, 9503, 9962), (5.0, 0.362, 0.8, 75, 8688, 7041),
        (5.0, 0.362, 0.7, 75, 7602, 5514), (5.0, 0.362, 1.0, 135, 17105, 15672),
        (5.0, 0.362, 0.8, 135, 15638, 10029), (4.5, 0.337, 1.0, 75, 9829, 10392),
        (4.5, 0.337, 0.8, 75, 8987, 7525), (3.5, 0.368, 1.0, 75, 13800, 14113),
    ],
)  # fmt: skip
def test_drill_pipe(size: float, wall: float, left: float, ksi: float, burst: float, collapse: float) -> None:
    worn, rest = tube(size, wall, left)
    found = float(burst_pressure(size, rest, ksi * KSI, left < 1)) / PSI
    assert found == pytest.approx(burst, abs=1.0)
    assert float(collapse_pressure(worn / rest, ksi * KSI)) / PSI == pytest.approx(collapse, abs=1.5)


@each_row(
    ("ksi", "constants"),
    [
        (55, (2.991, 0.0541, 1206, 1.989, 0.0360)),
        (75, (3.054, 0.0642, 1806, 1.990, 0.0418)),
        (80, (3.071, 0.0667, 1955, 1.998, 0.0434)),
        (110, (3.181, 0.0819, 2852, 2.066, 0.0532)),
    ],
)
def test_constants(ksi: float, constants: tuple[float, ...]) -> None:
    found = [float(x) for x in collapse_constants(1000 * ksi)]
    for value, wanted in zip(found, constants, strict=True):
        assert value == pytest.approx(wanted, rel=2e-3)


def test_the_four_formulas_meet_at_their_limits() -> None:
    """Continuous over the slenderness, falling, and elastic collapse does not know the yield strength."""
    x = np.linspace(5, 60, 20001)
    for ksi in (55, 75, 135):
        pressure = collapse_pressure(x, ksi * KSI)
        assert (np.diff(pressure) < 0).all() and np.abs(np.diff(pressure) / pressure[:-1]).max() < 2e-3
    assert float(collapse_pressure(50.0, 75 * KSI)) == float(collapse_pressure(50.0, 135 * KSI))


def test_tension_takes_away_strength() -> None:
    """By the ellipse of von Mises: none left at yield, all in compression."""
    assert float(yield_under_tension(75 * KSI, 0.0)) == 75 * KSI
    assert float(yield_under_tension(75 * KSI, -20 * KSI)) == 75 * KSI
    left = float(yield_under_tension(75 * KSI, 37.5 * KSI)) / KSI
    assert left == pytest.approx(75 * (np.sqrt(1 - 0.75 * 0.25) - 0.25))
    assert np.isnan(yield_under_tension(75 * KSI, 76 * KSI))


def test_ratios_have_the_sign_of_the_pressure_and_no_number_without_a_tube() -> None:
    one = np.ones((1, 2))
    d, worn, bore, strong = (np.full((1, 1), v) for v in (0.127, 0.127, 0.108612, 75 * KSI))
    found = pressure_ratios(d, worn, bore, strong, 0 * one, 2 * 9503 * PSI * one, 9503 * PSI * one)
    assert found["burst_ratio"] == pytest.approx(1.0, rel=1e-3) and (found["collapse_ratio"] == 0).all()
    found = pressure_ratios(d, worn, bore, strong, 0 * one, 0 * one, 9962 * PSI * one)
    assert found["collapse_ratio"] == pytest.approx(1.0, rel=1e-3) and (found["burst_ratio"] == 0).all()
    none = pressure_ratios(d * np.nan, worn * np.nan, bore, strong, one, one, 2 * one)
    assert all(np.isnan(values).all() for values in none.values())
    dry = pressure_ratios(d, worn, bore, strong, one, one * np.nan, one)
    assert all(np.isnan(values).all() for values in dry.values())
