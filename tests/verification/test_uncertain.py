"""Quantiles of a measured well: both methods, full solutions, and the measured points in the band."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc.analysis.sensitivities.roadmap import SoftRoadmap
from drillpetsc.analysis.uncertain.beside_points import inside_band
from drillpetsc.analysis.uncertain.calibrated import calibrated
from drillpetsc.analysis.uncertain.draws import correlation_of, draw
from drillpetsc.analysis.uncertain.limits import limits_of, passed
from drillpetsc.analysis.uncertain.linear import slopes_of
from drillpetsc.analysis.uncertain.responses import HydraulicsResponse, RoadmapResponse
from drillpetsc.analysis.uncertain.spread import spreads_of
from drillpetsc.analysis.uncertain.uncertain_keys import case_at, uncertain_keys
from drillpetsc.case import Case, load_case
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError
from drillpetsc.output import write_summary
from drillpetsc.parallel import initialise_petsc

F5 = Path(__file__).resolve().parents[2] / "cases/measured/volve-f5/case.yaml"
CASED, OPEN = "well.sections[0].friction", "well.sections[1].friction"
WELL = {
    CASED: {"normal": [0.20, 0.04]},
    OPEN: {"normal": [0.22, 0.05]},
    "string.weight_factor": {"normal": [1.0, 0.01]},
    "rig.block_weight": {"normal": ["623 kN", "10 kN"]},
}


@pytest.fixture(scope="module", autouse=True)
def _petsc() -> None:
    initialise_petsc()


def f5(spreads, **changes) -> Case:
    """The measured well with cased friction of 0.20 and other values."""
    case = load_case(F5).replace({CASED: 0.20} | changes)
    return Case(**{**case_data(case), "uncertain": spreads})


def sampled(case, samples, seed=1):
    """Keys, samples, response and its values."""
    keys = uncertain_keys(case)
    spreads = [key.spread for key in keys]
    draws = draw(spreads, correlation_of([key.name for key in keys], spreads), samples, seed)
    response = RoadmapResponse(case, keys)
    return keys, draws, response, response.values(draws)


def test_f5_at_2385_m():
    """Trip out and drilling torque of an independent prototype of the requirement: 1574, 1628, 1691 kN and 18.62, 22.05, 25.62 kN m.

    The torque on bit measured there is 4.36 kN m.  String and mean block weight of the prototype are not stated: 1 % and 3 % are allowed, 5 % of the widths.
    """
    case = f5(WELL, **{"roadmap.bit_depth": "2385 m", "roadmap.drilling.tob": "4.36 kN m"})
    keys, draws, response, values = sampled(case, 4000)
    levels = (0.1, 0.5, 0.9)
    monte_carlo = spreads_of("monte-carlo", draws, values, levels)
    slopes, _ = slopes_of(case, "roadmap", response, keys, None)
    here = np.array([key.value for key in keys])
    linear = spreads_of("linear", draws, response.base + (draws - here) @ slopes.T, levels, slopes)
    names = [output.name for output in response.outputs]
    for name, wanted, allowed in (
        ("trip_out.hook_load_total", (1574e3, 1628e3, 1691e3), 0.01),
        ("drilling.surface_torque", (18620.0, 22050.0, 25620.0), 0.03),
    ):
        i = names.index(name)
        for found in (monte_carlo, linear):
            assert found.quantiles[i] == pytest.approx(wanted, rel=allowed)
            width = found.quantiles[i, 2] - found.quantiles[i, 0]
            assert width == pytest.approx(wanted[2] - wanted[0], rel=0.05)
        width = monte_carlo.quantiles[i, 2] - monte_carlo.quantiles[i, 0]
        assert np.abs(linear.quantiles[i] - monte_carlo.quantiles[i]).max() < 0.1 * width
        assert monte_carlo.shares[i] == pytest.approx(linear.shares[i], abs=0.02)


def test_f5_points_in_the_90_percent_band():
    """At least 36 of the 40 measured values, hook loads and torques of 20 points, lie in the band of this wide prior."""
    case = f5(WELL)
    _, draws, response, values = sampled(case, 500)
    found = spreads_of("monte-carlo", draws, values, (0.05, 0.95))
    points = inside_band(case, response.outputs, found.quantiles)
    assert len(points) == 40
    assert sum(point["inside"] for point in points) >= 36


@pytest.mark.parametrize("heavy", ({}, {"fluid.density": {"normal": ["1490 kg/m3", "10 kg/m3"]}}))
def test_samples_equal_full_solutions(heavy):
    """Numbers that only change friction and the block, and those for which strings are prepared anew, agree with the roadmap of the changed case.

    To 1e-4: the strings here have steps of their own and not those of all bit depths.
    """
    spreads = {k: v for k, v in WELL.items() if k != "string.weight_factor"} | heavy
    case = f5(spreads, **{"roadmap.bit_depth": ["1900 m", "2400 m"]})
    keys, draws, response, values = sampled(case, 20)
    for n in (0, 7):
        full = SoftRoadmap(case_at(case, keys, draws[n]))
        known = {(q.name, q.bit_depth): v for q, v in zip(full.outputs, full.found.values, strict=True)}
        wanted = [known[q.name, q.bit_depth] for q in response.outputs]
        assert values[n] == pytest.approx(wanted, rel=1e-4, abs=1e-6)


def test_rows_do_not_depend_on_their_neighbours():
    """A sample alone has the number that it has among others: the ranks share samples out."""
    _, draws, response, values = sampled(f5(WELL, **{"roadmap.bit_depth": "2400 m"}), 20)
    assert np.array_equal(response.values(draws[3::4]), values[3::4], equal_nan=True)


def test_a_group_is_each_of_its_sections():
    """The friction of a group varies in all its sections together, as two sections with the same samples do."""
    case = f5({"cased": {"normal": [0.2, 0.04]}}, **{"roadmap.bit_depth": "2400 m", OPEN: 0.2})
    grouped = case.replace({"well.sections[1].ff_group": "cased"})
    _, draws, response, values = sampled(grouped, 20)
    alone = RoadmapResponse(
        case,
        uncertain_keys(
            f5(
                {CASED: {"normal": [0.2, 0.04]}, OPEN: {"normal": [0.2, 0.04]}},
                **{OPEN: 0.2, "roadmap.bit_depth": "2400 m"},
            )
        ),
    )
    assert np.array_equal(values, alone.values(np.repeat(draws, 2, axis=1)))
    slopes, _ = slopes_of(grouped, "roadmap", response, uncertain_keys(grouped), None)
    step = np.diff(response.values(np.array([[0.2 - 1e-5], [0.2 + 1e-5]])), axis=0)[0] / 2e-5
    assert slopes[:, 0] == pytest.approx(step, rel=1e-4, abs=1.0)


def test_numbers_of_a_calibration(tmp_path):
    """Deviations are the half widths of 95 % intervals over 1.96, with their correlation: a linear output has the deviation sqrt(g C g).

    g: slopes of the output, here of the hook load by block weight (1) and friction; C: covariance.  What the calibration does not
    determine keeps the case's value and distribution.
    """
    fit = {
        "open_hole": {"value": 0.25, "interval": [0.25 - 0.0392, 0.25 + 0.0392], "unit": ""},
        "block_weight": {"value": 650e3, "interval": [650e3 - 19600, 650e3 + 19600], "unit": "N"},
        "cased": {"value": None, "interval": None, "unit": ""},
        "running_drag": {"value": 1e3, "interval": [0.0, 2e3], "unit": "N s/m"},
    }
    correlation = np.eye(4)
    correlation[0, 1] = correlation[1, 0] = -0.6
    file = tmp_path / "summary.json"
    write_summary(file, {"fit": fit, "parameters": [*fit], "correlation": correlation.tolist()})
    case, notes = calibrated(f5(WELL, **{"roadmap.bit_depth": "2400 m"}), tmp_path)
    assert "cased, running_drag" in notes[0]
    assert (case.well.sections[1].friction, case.rig.block_weight) == (0.25, 650e3)
    assert set(case.uncertain) == {CASED, "open_hole", "string.weight_factor", "rig.block_weight"}
    case = Case(
        **{
            **case_data(case),
            "uncertain": {q: case_data(case)["uncertain"][q] for q in ("open_hole", "rig.block_weight")},
        }
    )
    keys, draws, response, values = sampled(case, 2000)
    slopes, _ = slopes_of(case, "roadmap", response, keys, None)
    i = [output.name for output in response.outputs].index("trip_out.hook_load_total")
    deviation = np.array([0.02, 10e3])
    covariance = deviation[:, None] * deviation * np.array([[1, -0.6], [-0.6, 1]])
    assert slopes[i, 1] == pytest.approx(1.0, rel=1e-6)
    assert values[:, i].std(ddof=1) == pytest.approx(np.sqrt(slopes[i] @ covariance @ slopes[i]), rel=0.03)
    assert "another case" in notes[1]
    write_summary(file, {"fit": {"cased": {"value": 0.2}}, "parameters": ["cased"], "correlation": [[1.0]]})
    with pytest.raises(CaseError, match="damaged"):
        calibrated(case, tmp_path)
    lost = {"formation.bit_law.static": fit["block_weight"]}
    write_summary(file, {"fit": lost, "parameters": [*lost], "correlation": [[1.0]]})
    with pytest.raises(CaseError, match="calibration of this case"):
        calibrated(case, tmp_path)
    with pytest.raises(CaseError, match="run folder of calibrate"):
        calibrated(case, tmp_path / "none")
    write_summary(file, {"fit": {"cased": fit["cased"]}, "parameters": ["cased"], "correlation": [[1.0]]})
    with pytest.raises(CaseError, match="at least one number"):
        calibrated(case, tmp_path)
    write_summary(file, {"status": "done"})
    with pytest.raises(CaseError, match="of another command"):
        calibrated(case, tmp_path)


def test_negative_friction_fails():
    """A sample of negative friction has no solution, in place of friction that is cut off."""
    case = f5({OPEN: {"normal": [0.22, 0.2]}}, **{"roadmap.bit_depth": "2400 m"})
    _, draws, _, values = sampled(case, 100)
    assert (draws[:, 0] < 0).any()
    assert np.array_equal(np.isnan(values).all(axis=1), draws[:, 0] < 0)


def test_hydrostatic_pressure_is_linear_in_the_density():
    """The equivalent density of stiff mud that hardly moves grows by as much as its density."""
    still = {"fluid.flow_rate": "1e-6 m3/s", "fluid.bulk_modulus": "1e15 Pa"}
    case = f5({"fluid.density": {"uniform": [1450.0, 1550.0]}}, **still)
    keys = uncertain_keys(case)
    draws = draw([keys[0].spread], np.eye(1), 40, 1)
    response = HydraulicsResponse(case, keys)
    ecd = [output.name for output in response.outputs].index("ecd_bit")
    slope = np.polyfit(draws[:, 0], response.values(draws)[:, ecd], 1)[0]
    assert slope == pytest.approx(1.0, rel=1e-3)


def test_probability_of_buckling_in_a_straight_hole():
    """Pushed with the force F at the bit, a pipe in a straight inclined hole buckles at 2 sqrt(EI w sin I/r), and coils at sqrt(2) times that.

    Dawson and Paslay, SPE 11167; Chen, Lin and Cheatham 1990.  The share of samples beyond is that of the forces beyond.
    """
    incline, radius, tube = np.radians(60.0), 0.5 * (0.2159 - 0.127), 0.25 * np.pi * (0.127**2 - 0.1086**2)
    weight, stiffness = 7850 * tube * 9.80665, 206e9 * np.pi / 64 * (0.127**4 - 0.1086**4)
    limit = 2.0 * np.sqrt(stiffness * weight * np.sin(incline) / radius)
    well = {
        "survey": {"md": [0.0, 2000.0], "inclination": [incline] * 2, "azimuth": [0.0, 0.0]},
        "sections": [{"kind": "open_hole", "diameter": 0.2159, "friction": 0.2}],
    }
    case = Case(
        well=well,
        string=[
            {"kind": "pipe", "length": 2000.0, "od": 0.127, "id": 0.1086},
            {"kind": "bit", "length": 0.0, "od": 0.2159, "mass": 0.0},
        ],
        top={"kind": "top_drive"},
        bottom="bit",
        initial={"wob": limit},
        roadmap={"operations": ["drilling"], "drilling": {"wob": limit, "tob": 1e3}},
        uncertain={"roadmap.drilling.wob": {"normal": [limit, 0.2 * limit]}},
    )
    _, draws, response, values = sampled(case, 400)
    base = {q.quantity.name: v for q, v in zip(response.outputs, response.base, strict=True)}
    assert base["sinusoidal_ratio"] == pytest.approx(1.0, rel=1e-6)
    assert base["helical_ratio"] == pytest.approx(np.sqrt(0.5), rel=1e-6)
    assert SoftRoadmap(case).found.values[
        [q.quantity.name for q in SoftRoadmap(case).outputs].index("helical_ratio")
    ] == pytest.approx(base["helical_ratio"], rel=1e-12)
    rows = {
        q["meaning"]: q["beyond"]
        for q in passed(limits_of(case, response.outputs), response.outputs, values, "monte-carlo")
    }
    assert rows["buckles sinusoidally"] == np.mean(draws[:, 0] > limit * (1 + 1e-9))
    assert rows["coils"] == np.mean(draws[:, 0] > np.sqrt(2) * limit)


def test_probability_of_leaving_the_window():
    """In mud that hardly moves the equivalent density is its density, and the margins are its distances from the window.

    To 2e-5 of the density: pressures are summed along the elements, whose depths differ so much from the arcs'.
    """
    still = {
        "fluid.flow_rate": "1e-6 m3/s",
        "fluid.bulk_modulus": "1e15 Pa",
        "fluid.rheology": {"model": "newtonian", "viscosity": 1e-6},
    }
    case = f5({"fluid.density": {"uniform": [1450.0, 1550.0]}}, **still)
    case = case.replace({"window": {"pore": 1470.0, "frac": 1530.0}})
    keys = uncertain_keys(case)
    draws = draw([keys[0].spread], np.eye(1), 50, 1)
    response = HydraulicsResponse(case, keys)
    values = response.values(draws)
    names = [output.name for output in response.outputs]
    assert values[:, names.index("frac_margin")] == pytest.approx(1530.0 - draws[:, 0], abs=0.03)
    assert values[:, names.index("pore_margin")] == pytest.approx(draws[:, 0] - 1470.0, abs=0.03)
    rows = {
        q["meaning"]: q["beyond"]
        for q in passed(limits_of(case, response.outputs), response.outputs, values, "monte-carlo")
    }
    assert rows["above the fracture density"] == np.mean(draws[:, 0] > 1530.0)
    assert rows["below the pore density"] == np.mean(draws[:, 0] < 1470.0)
