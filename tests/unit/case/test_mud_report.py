"""Rheology as the mud report has it. Expected values: rules of API RP 13D by hand, figures of published examples."""

from __future__ import annotations

import math
from typing import Any

import pytest

from drillpetsc.analysis.hydraulics.rheology_fits import figures
from drillpetsc.case import Case
from drillpetsc.case.blocks.fluid import Bingham, HerschelBulkley, PowerLaw, SurfaceLine
from drillpetsc.case.files.mud_report import DEGREE, RPM, misfit
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

FOOT, INCH, PSI, GPM = 0.3048, 0.0254, 0.45359237 * 9.80665 / 0.0254**2, 231 * 0.0254**3 / 60
PER_100_FT2 = 0.45359237 * 9.80665 / (100 * FOOT**2)  # [Pa] lbf/100 ft2


def case(rheology: Any, **keys: Any) -> Case:
    fluid = {"density": "12.8 ppg", "flow_rate": "335 gpm", "rheology": rheology} | keys.pop("fluid", {})
    string = [{"kind": "pipe", "length": "100 m", "od": "5 in", "id": "4.276 in"}]
    return Case(**{"string": string, "top": "clamped", "fluid": fluid} | keys)


def rheology(value: Any) -> Any:
    return case(value).fluid.rheology  # type: ignore[union-attr]


@each_row(
    ("r600", "r300", "pv", "yp", "n"),
    [  # cP, lbf/100 ft2: drillingformulas.com; Lapeyrouse, Formulas and Calculations
        (60, 40, 20, 20, 0.585),
        (40, 25, 15, 10, 0.678),
        (53, 34, 19, 15, 0.640),
        (140, 80, 60, 20, 0.807),
    ],
)
def test_two_readings(r600: float, r300: float, pv: float, yp: float, n: float) -> None:
    found = rheology({"dial": {600: r600, 300: r300}, "model": "bingham"})
    assert isinstance(found, Bingham)
    assert found.plastic_viscosity == pytest.approx(pv * 1e-3) and found.yield_stress == pytest.approx(
        yp * PER_100_FT2
    )
    found = rheology({"dial": {600: r600, 300: r300}})
    assert isinstance(found, PowerLaw) and found.index == pytest.approx(n, rel=2e-3)
    assert found.consistency == pytest.approx(0.511 * r600 / 1022**found.index)


def test_api_rules_with_yield_stress() -> None:
    """tau_y 7 lbf/100 ft2, n 0.6097, K 0.8481 lbf s^n/100 ft2 from 65/45/9/8 (rule of API RP 13D, by hand)."""
    found = rheology({"dial": {600: 65, 300: 45, 6: 9, 3: 8}, "fit": "api"})
    assert isinstance(found, HerschelBulkley)
    assert found.yield_stress == pytest.approx(7 * PER_100_FT2, rel=1e-3)
    assert found.index == pytest.approx(0.6097, rel=1e-3)
    assert found.consistency == pytest.approx(0.8481 * PER_100_FT2, rel=1e-3)


@each_row(
    ("model", "stress", "constants"),
    [
        ("herschel_bulkley", lambda g: 4.0 + 0.6 * g**0.55, (4.0, 0.6, 0.55)),
        ("power_law", lambda g: 0.9 * g**0.48, (0.9, 0.48)),
        ("bingham", lambda g: 3.0 + 0.02 * g, (3.0, 0.02)),
        ("newtonian", lambda g: 0.03 * g, (0.03,)),
    ],
)
def test_exact_readings_give_the_constants(model: str, stress: Any, constants: tuple[float, ...]) -> None:
    dial = {speed: stress(speed * RPM) / DEGREE for speed in (600, 300, 200, 100, 6, 3)}
    found = rheology({"dial": dial, "model": model, "fit": "least_squares"})
    names = {
        "herschel_bulkley": ("yield_stress", "consistency", "index"),
        "power_law": ("consistency", "index"),
        "bingham": ("yield_stress", "plastic_viscosity"),
        "newtonian": ("viscosity",),
    }[model]
    assert [getattr(found, name) for name in names] == pytest.approx(constants, rel=1e-6)
    assert misfit(found.dial, stress) < 1e-9


def test_a_fit_has_the_least_squares() -> None:
    """Any other constants within the bounds are worse."""
    dial = {600: 64, 300: 41, 200: 32, 100: 22, 6: 8, 3: 7}
    found = rheology({"dial": dial, "model": "herschel_bulkley"})

    def rms(stress: float, consistency: float, index: float) -> float:
        return misfit(found.dial, lambda rate: stress + consistency * rate**index)

    best = rms(found.yield_stress, found.consistency, found.index)
    assert 0 <= found.yield_stress <= 1.2 * 7 * DEGREE and best < 0.5
    for a in (0.99, 1.0, 1.01):
        for b in (0.99, 1.0, 1.01):
            for c in (0.998, 1.0, 1.002):
                assert rms(a * found.yield_stress, b * found.consistency, c * found.index) >= best * (
                    1 - 1e-9
                )


def test_yield_stress_stays_within_its_bounds() -> None:
    falling = {600: 100, 300: 30, 200: 15, 100: 5, 6: 4.9, 3: 4.8}  # the best line would start below 0
    assert rheology({"dial": falling, "model": "bingham", "fit": "least_squares"}).yield_stress == 0.0
    flat = {600: 30, 300: 29.5, 200: 29, 100: 28, 6: 5, 3: 4}
    found = rheology({"dial": flat, "model": "bingham", "fit": "least_squares"})
    assert found.yield_stress == pytest.approx(1.2 * 4 * DEGREE)


def test_short_forms() -> None:
    found = rheology({"pv": "23 cP", "yp": "18 lbf/100ft2"})
    assert isinstance(found, Bingham) and found.plastic_viscosity == pytest.approx(0.023)
    assert found.yield_stress == pytest.approx(18 * PER_100_FT2)
    found = rheology({"n": 0.65, "k": "1.2 lbf s^n/100ft2", "law": "exact"})
    assert (
        isinstance(found, PowerLaw)
        and found.consistency == pytest.approx(1.2 * PER_100_FT2)
        and found.law == "exact"
    )
    found = rheology({"ty": 3.0, "n": 0.65, "k": 0.5})
    assert isinstance(found, HerschelBulkley) and (found.yield_stress, found.consistency, found.index) == (
        3.0,
        0.5,
        0.65,
    )
    bare = Case(**{**case_data(case({"pv": 0.02, "yp": 5.0})), "units": "field", "gravity": "9.8 m/s2"}
                | {"string": [{"kind": "pipe", "length": 100, "od": 5, "id": 4}], "material": {}, "time": {"end": 1}}
                | {"fluid": {"density": 10.5, "flow_rate": 500, "rheology": {"pv": 23, "yp": 18}}})  # fmt: skip
    assert bare.fluid.rheology.plastic_viscosity == pytest.approx(0.023)  # type: ignore[union-attr]
    assert bare.fluid.rheology.yield_stress == pytest.approx(18 * PER_100_FT2)  # type: ignore[union-attr]


def test_numbers_of_a_fit_are_not_converted_by_the_units_of_the_case() -> None:
    dial = {"dial": {600: 64, 300: 41, 200: 32, 100: 22, 6: 8, 3: 7}}
    keys = {"units": "field", "string": [{"kind": "pipe", "length": 100, "od": 5, "id": 4}]}
    assert case(dial, **keys).fluid.rheology == rheology(dial)  # type: ignore[union-attr]


@each_row(
    ("value", "at", "text"),
    [
        ({"pv": 0.02}, "pv", "together"),
        ({"pv": 0.02, "yp": 3, "n": 0.5}, "n", "together"),
        ({"pv": 0.02, "yp": 3, "model": "power_law"}, "model", "bingham"),
        ({"dial": {600: 64}}, "dial", "two readings"),
        ({"dial": {600: 40, 300: 64}}, "dial", "do not fall"),
        ({"dial": {600: 64, "x": 3}}, "dial.x", "in rpm"),
        ({"dial": {600: 64, 300: -3}}, "dial.300", "a pure number"),
        ({"dial": {600: 64, 300: 41, 3: 7}, "fit": "api", "model": "herschel_bulkley"}, "dial", "6, 3"),
        ({"dial": {600: 64, 300: 41}, "model": "casson"}, "model", "one of newtonian"),
        ({"dial": {600: 64, 300: 41}, "model": "herschel_bulkley"}, "dial", "at least 3"),
        ({"dial": {600: 64, 300: 64}}, "dial", "flow index"),
        ({"dial": {600: 64, 300: 20}, "model": "bingham"}, "dial", "2 R300"),
        ({"dial": 5}, "dial", "two readings"),
        ({"dial": {600: 64, 300: 41}, "fit": "best"}, "fit", "least_squares"),
    ],
)  # fmt: skip
def test_refused(value: Any, at: str, text: str) -> None:
    with pytest.raises(CaseError) as caught:
        case(value)
    assert (
        caught.value.at.replace("[", ".").replace("]", "") == f"fluid.rheology.{at}"
        and text in caught.value.want
    )


def test_a_written_case_keeps_readings_and_constants() -> None:
    found = case(
        {"dial": {600: 64, 300: 41, 200: 32, 100: 22, 6: 8, 3: 7}}, fluid={"surface_line": {"case": 3}}
    )
    assert Case(**case_data(found)) == found
    assert found.fluid.rheology.dial["600"] == 64  # type: ignore[union-attr, index]


def test_surface_lines() -> None:
    for number, feet in ((1, 2600), (2, 946), (3, 610), (4, 424)):
        line = SurfaceLine(case=number)
        assert line.length == pytest.approx(feet * FOOT) and line.id == pytest.approx(3.826 * INCH)
    for wrong in ({}, {"case": 1, "length": 3}, {"length": 3}, {"loss": 1e5}, {"case": 5}):
        with pytest.raises(CaseError):
            case({"pv": 0.02, "yp": 3}, fluid={"surface_line": wrong})
    with pytest.raises(CaseError) as caught:
        fluid = {"surface_line": {"case": 1}, "pump_pressure": 1e7, "flow_rate": None}
        case({"pv": 0.02, "yp": 3}, fluid={key: value for key, value in fluid.items() if value})
    assert "flow_rate" in caught.value.want


def test_power_law_of_the_annulus() -> None:
    """n_a 0.2754 and K_a 26.09 dyn s^n/cm2 from 21/8 at 100 and 3 rpm (worked example, github.com/BillyFrcs, slips corrected)."""
    well = {
        "survey": {"md": [0, 200], "inclination": [0, 0], "azimuth": [0, 0]},
        "sections": [{"kind": "open_hole", "diameter": "8 1/2 in"}],
    }
    dial = {"dial": {600: 53, 300: 34, 100: 21, 3: 8}, "law": "api"}
    fluid = case(dial, well=well).fluid
    assert fluid is not None and isinstance(fluid.annulus_rheology, PowerLaw)
    assert fluid.rheology.index == pytest.approx(0.640, rel=5e-3)  # type: ignore[attr-defined]
    assert fluid.rheology.consistency == pytest.approx(0.3209, rel=5e-3)  # type: ignore[attr-defined]
    assert fluid.annulus_rheology.index == pytest.approx(0.2754, rel=5e-3)
    assert fluid.annulus_rheology.consistency == pytest.approx(2.609, rel=5e-3)
    assert case(dial).fluid.annulus_rheology is None  # type: ignore[union-attr]
    assert case(dial | {"law": "blend"}, well=well).fluid.annulus_rheology is None  # type: ignore[union-attr]
    with pytest.raises(CaseError):
        case(dial, fluid={"annulus_rheology": {"pv": 0.02, "yp": 3}})


def test_units_of_constants() -> None:
    """1 degree of the dial is 0.5107 Pa at 1.7023 1/s for 1 rpm (R1-B1-F1)."""
    assert (DEGREE, RPM) == (0.5107, 1.7023)
    assert math.isclose(600 * RPM, 1022, rel_tol=1e-3)


def test_long_words_of_pv_and_yp() -> None:
    """plastic_viscosity and yield_point are a Bingham mud, as pv and yp are; without them yield_stress is the key."""
    long = rheology({"plastic_viscosity": "35 mPa s", "yield_point": "8.6 Pa"})
    short = rheology({"pv": "35 mPa s", "yp": "8.6 Pa"})
    model = rheology({"model": "bingham", "plastic_viscosity": "35 mPa s", "yield_stress": "8.6 Pa"})
    assert long == short == model
    for wrong in (
        {"yield_point": "8.6 Pa"},
        {"model": "power_law", "plastic_viscosity": "35 mPa s", "yield_point": "8.6 Pa"},
        {"plastic_viscosity": "35 mPa s", "pv": "35 mPa s", "yield_point": "8.6 Pa"},
    ):
        with pytest.raises(CaseError):
            rheology(wrong)


def test_the_power_law_of_the_trade_meets_the_fast_reading():
    """K 1022^n is the stress of 600 rpm as API rounds it, 0.511 Pa a degree (API RP 13D: K = 5.11 R600/1022^n, in dyn s^n/cm2)."""
    found = figures(rheology({"dial": {"600": 65, "300": 39}}))
    assert found["pipe_consistency"] * 1022 ** found["pipe_index"] == pytest.approx(0.511 * 65, rel=1e-12)
