"""`hydraulics` and `surge` with the mud report: dial readings, another rheology in the annulus, surface line, units."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc.analysis.hydraulics.flow_model import FlowModel, whole_string
from drillpetsc.analysis.hydraulics.hydraulics import Hydraulics, run_hydraulics
from drillpetsc.analysis.hydraulics.losses import balance
from drillpetsc.analysis.hydraulics.surge import Tripping, run_surge
from drillpetsc.analysis.hydraulics.trade_formulas import FOOT, GPM, INCH, PPG, PSI
from drillpetsc.case import Case
from drillpetsc.operations import Hydraulics as HydraulicsCommand
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from tests.helpers.trips import trips_of
from tests.helpers.wells import simple_well

STIFF = {"bulk_modulus": 1e14, "elastic_walls": False}


def example(**fluid) -> Case:
    """The example of API RP 13D: 12.8 ppg, dial 53/34/21/8, 335 gpm (github.com/BillyFrcs, slips corrected)."""
    return Case(
        string=[
            {
                "kind": "pipe",
                "name": "pipe",
                "length": 11641 * FOOT,
                "od": 4.5 * INCH,
                "id": 3.826 * INCH,
                "element_length": 60,
            },
            {
                "kind": "pipe",
                "name": "collar",
                "length": 390 * FOOT,
                "od": 7 * INCH,
                "id": 2.25 * INCH,
                "element_length": 10,
            },
        ],
        top="clamped",
        well={
            "survey": {"md": [0, 12031 * FOOT], "inclination": [0, 0], "azimuth": [0, 0]},
            "sections": [
                {"kind": "casing", "to": 10786 * FOOT, "diameter": 8.835 * INCH},
                {"kind": "open_hole", "diameter": 8.625 * INCH},
            ],
        },
        fluid={
            **STIFF,
            "density": 12.8 * PPG,
            "rheology": {"dial": {600: 53, 300: 34, 100: 21, 3: 8}, "law": "api"},
            "flow_rate": 335 * GPM,
            **fluid,
        },
    )


def test_example_of_api_in_one_case():
    """792.8, 277.9, 15.4 and 178.6 psi, and 41.5 psi in the surface line of case 3.

    Around the collars Re = 2917 lies between the limit of 1995, 2100, and that of the law, 3470 - 1370 n = 3093.  The
    example takes a/Re^b there, 16.7 psi, below its own laminar loss; the law stays laminar, K [12 v/d (2n+1)/(3n)]^n 4 L/d.
    """
    found = Hydraulics(example(surface_line={"case": 3})).at(335 * GPM)
    rows = {(row.channel, row.item, row.section[:4]): row.pressure_loss / PSI for row in found.rows}
    assert rows["surface line", "-", "-"] == pytest.approx(41.5, rel=5e-3)
    assert rows["bore", "collar", "-"] == pytest.approx(277.9, rel=5e-3)
    assert rows["annulus", "pipe", "casi"] == pytest.approx(178.6, rel=5e-3)
    assert rows["annulus", "pipe", "open"] == pytest.approx(15.4, rel=5e-3)
    n, consistency, gap = 0.2754, 2.609, 1.625 * INCH
    speed = 335 * GPM / (np.pi / 4 * (8.625**2 - 7**2) * INCH**2)
    stress = consistency * (12 * speed / gap * (2 * n + 1) / (3 * n)) ** n
    assert 2100 < 12 * 12.8 * PPG * speed**2 / stress < 3470 - 1370 * n
    laminar = 4 * stress * 390 * FOOT / gap / PSI
    assert rows["annulus", "collar", "open"] == pytest.approx(laminar, rel=5e-3)
    bore = sum(row.pressure_loss for row in found.rows if (row.channel, row.item) == ("bore", "pipe"))
    assert bore / PSI == pytest.approx(792.8, rel=5e-3)


def test_surface_line_is_part_of_the_pump_pressure():
    """A measured loss goes with the flow squared, is in the balance to 1 Pa, and not in the pressure of the bore."""
    line = {"loss": 50 * PSI, "at": 500 * GPM}
    with_line, without = (Hydraulics(example(**q)) for q in ({"surface_line": line}, {}))
    for rate in (200 * GPM, 400 * GPM):
        a, b = with_line.at(rate), without.at(rate)
        loss = 50 * PSI * (rate / (500 * GPM)) ** 2
        assert a.summary["surface_line_loss"] == pytest.approx(loss, rel=1e-12)
        assert a.summary["pump_pressure"] - b.summary["pump_pressure"] == pytest.approx(loss, rel=1e-6)
        assert a.profile["internal_pressure"] == pytest.approx(b.profile["internal_pressure"], rel=1e-9)
    sums = balance(with_line.flow)
    total = sum(v for k, v in sums.items() if k not in ("pump_pressure", "outlet"))
    assert total == pytest.approx(sums["pump_pressure"] - sums["outlet"], abs=1.0)


def test_pressure_of_the_key_is_at_the_string_and_that_of_the_option_at_the_pump(tmp_path: Path):
    line = {"surface_line": {"case": 1}}
    target = 100e5
    key = example(**line)
    key = key.model_copy(
        update={
            "fluid": key.fluid.model_copy(
                update={"flow_rate": None, "pump_pressure": type(key.fluid.outlet_pressure)(target)}
            )
        }
    )
    by_key = run_hydraulics(Job(key, tmp_path / "key")).summary["flows"][0]
    by_option = run_hydraulics(Job(example(**line), tmp_path / "option"), pump_pressure=target).summary[
        "flows"
    ][0]
    assert by_option["pump_pressure"] == pytest.approx(target, rel=1e-6)
    assert by_key["pump_pressure"] - by_key["surface_line_loss"] == pytest.approx(target, rel=1e-6)
    assert by_key["pump_flow"] > by_option["pump_flow"]


def test_another_rheology_in_the_annulus_acts_in_tables_and_trips():
    """Laminar Newtonian mud of 50 cP in the string and 100 cP around it: twice the loss and the surge of 50 cP."""
    thin, thick = ({"model": "newtonian", "viscosity": v, "law": "exact"} for v in (0.05, 0.1))
    found, surge = {}, {}
    for name, keys in (("one", {"rheology": thin}), ("two", {"rheology": thin, "annulus_rheology": thick})):
        case = Case(
            string=[{"kind": "pipe", "length": 1000, "od": 0.127, "id": 0.1086, "element_length": 50}],
            top="clamped",
            well=simple_well(1000, 0.2159),
            fluid={**STIFF, "density": 1200, "flow_rate": 0.005, **keys},
        )
        found[name] = Hydraulics(case).at(0.005)
        surge[name] = Tripping(case, whole_string(case), "closed").at("trip_in", 0.05).surge_pressure
    one, two = (found[name].summary for name in ("one", "two"))
    assert two["annulus_loss"] == pytest.approx(2 * one["annulus_loss"], rel=1e-6)
    assert two["string_loss"] == pytest.approx(one["string_loss"], rel=1e-6)
    numbers = [
        [row.reynolds for row in found[name].rows if row.channel == "annulus"][0] for name in ("one", "two")
    ]
    assert numbers[0] == pytest.approx(2 * numbers[1], rel=1e-6)
    assert surge["two"] == pytest.approx(2 * surge["one"], rel=1e-6)


def test_bare_numbers_have_the_units_of_the_case(tmp_path: Path):
    """units: field: --flow 400 is 400 gpm, a window file without units is in ft and ppg; the screen is in field units."""
    (tmp_path / "w.csv").write_text("tvd,pore,frac\n0,9,13\n4000,9.5,14\n")
    assert HydraulicsCommand(case=None, flow="400").read("field").flow == pytest.approx((400 * GPM,))
    trips = trips_of(speeds="60", window="9,12", bit_depth="1000", units="field")
    assert trips.speeds == pytest.approx((60 * FOOT / 60,)) and trips.bit_depths == pytest.approx(
        (1000 * FOOT,)
    )
    assert trips.window is not None and trips.window.pore == pytest.approx((9 * PPG,), rel=1e-6)
    case = Case(
        units="field",
        string=[{"kind": "pipe", "length": 3000, "od": 5, "id": 4.276, "element_length": 100}],
        top="clamped",
        well=simple_well(3500, 8.5),
        fluid={"density": 10.5, "rheology": {"pv": 20, "yp": 12}, "flow_rate": 400},
        window=str(tmp_path / "w.csv"),
    )
    assert case.window is not None and case.window.tvd == pytest.approx((0.0, 4000 * FOOT))
    assert case.window.frac == pytest.approx((13 * PPG, 14 * PPG), rel=1e-6)
    result = run_hydraulics(Job(case, tmp_path / "h"))
    assert result.summary["units"] == "field" and any(
        "400 gpm" in " ".join(line.split()) for line in result.lines
    )
    result = run_surge(Job(case, tmp_path / "s"), trips)
    assert any("ft/min" in line for line in result.lines)
    rows = read_table(tmp_path / "s" / "surge.csv")
    assert rows["bit_depth [m]"] == pytest.approx(1000 * FOOT) and np.isfinite(rows["ecd_bit [kg/m3]"]).all()


def test_closing_with_surface_line_choke_and_two_rheologies():
    """Everything at once closes to 1 Pa, with elastic mud."""
    case = example(
        bulk_modulus=2e9,
        surface_line={"length": 100.0, "id": 0.09},
        annulus_rheology={"model": "bingham", "plastic_viscosity": 0.03, "yield_stress": 5.0},
        choke={"area": 5e-4},
        outlet_pressure=3e5,
    )
    flow = FlowModel(case, whole_string(case), "pumping")
    flow.solve(0.03)
    sums = balance(flow)
    total = sum(v for k, v in sums.items() if k not in ("pump_pressure", "outlet"))
    assert total == pytest.approx(sums["pump_pressure"] - sums["outlet"], abs=1.0)
    assert min(sums[k] for k in ("surface_line_loss", "choke_loss", "annulus_loss")) > 0


def test_flow_curves_of_the_readings(tmp_path: Path):
    """PV, YP, n and K of 53/34/21/8; the api power law is exact at 600 and 300 rpm but for the rounding of 3.32.

    Least squares of a model never has a larger misfit than the rules for the same model; the fit in use is marked.
    """
    result = run_hydraulics(Job(example(), tmp_path / "out"))
    mud = result.summary["rheology"]
    assert mud["plastic_viscosity"] == pytest.approx(0.019) and mud["yield_point"] == pytest.approx(
        15 * 0.478803, rel=1e-5
    )
    assert mud["pipe_index"] == pytest.approx(0.640, rel=2e-3) and mud["annulus_index"] == pytest.approx(
        0.2754, rel=1e-3
    )
    readings, fits = (read_table(tmp_path / "out" / f) for f in ("dial_readings.csv", "rheology_fits.csv"))
    assert readings["shear_stress [Pa]"] == pytest.approx(0.5107 * np.array([53, 34, 21, 8]))
    assert list(fits["used [-]"]).count("yes") == 1 and fits["used [-]"][0] == "yes"
    y, k, n, rms = (
        fits[q] for q in ("yield_stress [Pa]", "consistency [Pa s^n]", "index [-]", "misfit [Pa]")
    )
    for i in range(len(n)):
        curve = y[i] + k[i] * readings["shear_rate [1/s]"] ** n[i]
        assert rms[i] == pytest.approx(
            np.sqrt(np.mean((curve - readings["shear_stress [Pa]"]) ** 2)), rel=1e-9
        )
    rules = (fits["model [-]"] == "power_law") & (fits["fit [-]"] == "api")
    at_600 = k[rules] * (1.7023 * 600) ** n[rules]
    assert at_600 == pytest.approx(0.5107 * 53, rel=2e-3)
    for model in ("power_law", "bingham"):
        by = {
            f: float(r) for m, f, r in zip(fits["model [-]"], fits["fit [-]"], rms, strict=True) if m == model
        }
        assert by["least_squares"] <= by["api"]
    assert any("* power_law" in line for line in result.lines)


def test_a_mud_without_readings_has_no_flow_curves(tmp_path: Path):
    mud = {"model": "bingham", "plastic_viscosity": 0.02, "yield_stress": 5.0}
    result = run_hydraulics(Job(example(rheology=mud), tmp_path / "out"))
    assert result.summary["rheology"] is None and not (tmp_path / "out" / "rheology_fits.csv").exists()
