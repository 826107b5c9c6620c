"""The command `surge` against a published example, balances and closed forms (manual: sec-guide-surge)."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq

from drillpetsc.analysis.hydraulics import trade_formulas as trade
from drillpetsc.analysis.hydraulics.flow_model import FlowModel, string_at, whole_string
from drillpetsc.analysis.hydraulics.open_hole import OpenHole, open_hole
from drillpetsc.analysis.hydraulics.surge import (
    FASTEST,
    TOLERANCE,
    Tripping,
    Trips,
    run_surge,
)
from drillpetsc.analysis.hydraulics.trade_formulas import FOOT, FOOT_PER_MINUTE, INCH, PPG, PSI
from drillpetsc.case import Case, load_case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from drillpetsc.physics.fluid import bit_flow
from tests.helpers.tables import each_row
from tests.helpers.trips import trips_of
from tests.helpers.wells import simple_well

GRAVITY = 9.80665
STIFF = {"bulk_modulus": 1e14, "elastic_walls": False}


def vertical(
    length: float, od: float, bore: float, hole: float, mud: dict, depth: float | None = None, **keys
) -> Case:
    """One pipe in one hole; lengths and diameters in metres."""
    end = depth or length
    return Case(
        string=[{"kind": "pipe", "length": length, "od": od, "id": bore, "element_length": length / 40}],
        top="clamped",
        well=simple_well(end, hole),
        fluid={**STIFF, **mud},
        **keys,
    )


def test_surge_of_lapeyrouse():
    """15 ppg, dial 140/80, 14,300 ft of 4 1/2 x 3.82 in 7 7/8 in hole, 1.5 x 270 ft/min, clinging 0.45: 716.8 psi closed.

    The Reynolds number of 2190 is 93 % of the limit of the law, which begins to blend there: F = 1.012 times the laminar
    loss (manual: eq-mud-factor).  At 270 ft/min the flow is laminar.  The open pipe of the example shares the flow by areas: 467.5 psi.  The rule is printed beside the solver's figure.
    """
    index = trade.power_law_index(140, 80)
    mud = {
        "density": 15 * PPG,
        "rheology": {
            "model": "power_law",
            "index": index,
            "consistency": 140 / 1022**index * trade.LBF_PER_100FT2,
            "law": "exact",
        },
    }
    case = vertical(14300 * FOOT, 4.5 * INCH, 3.82 * INCH, 7.875 * INCH, mud)
    speed = 405 * FOOT_PER_MINUTE
    trip = Tripping(case, whole_string(case), "closed")
    closed = trip.at("trip_in", speed).surge_pressure / PSI
    flow = speed * (0.45 + 4.5**2 / (7.875**2 - 4.5**2))
    stress = 716.8 * PSI * 3.375 * INCH / (4 * 14300 * FOOT)
    reynolds = 8 * 15 * PPG * flow**2 / stress
    x = (reynolds / (3470 - 1370 * index)) ** 2
    y = (np.log10(index) + 3.93) / 50 * reynolds / reynolds ** ((1.75 - np.log10(index)) / 7) / 16
    factor = (1 + (x**-8 + y**-8) ** -1.5) ** (1 / 12)
    assert 1.011 < factor < 1.013
    assert closed == pytest.approx(716.8 * factor, rel=2e-3)
    laminar = trip.at("trip_in", 270 * FOOT_PER_MINUTE).surge_pressure / PSI
    assert laminar == pytest.approx(716.8 / 1.5**index, rel=2e-3)
    opened = Tripping(case, whole_string(case), "open")
    assert opened.by_area("trip_in", speed) / PSI == pytest.approx(467.5, rel=5e-3)


@pytest.mark.parametrize("operation", ["trip_in", "trip_out"])
def test_open_pipe_has_one_pressure_at_the_bit(operation):
    """Laminar Newtonian mud: the split between bore and annulus for which both columns lose the same (closed form).

    In the frame of the string A_w V enters from below; the annulus rubs with w' - V + Kc V, the bore with its own speed.
    """
    mu, length, od, bore, hole, speed, clinging = 0.2, 1000.0, 0.127, 0.1086, 0.2159, 0.3, 0.45
    mud = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": mu, "law": "exact"}}
    case = vertical(length, od, bore, hole, mud, depth=1100.0)
    whole, inside, outside = (np.pi / 4 * d for d in (hole**2, bore**2, hole**2 - od**2))

    def of_bore(q: float) -> float:
        return 32 * mu * length * (q / inside) / bore**2

    def of_annulus(q: float) -> float:
        return 48 * mu * length * (q / outside - speed + clinging * speed) / (hole - od) ** 2

    up_bore = brentq(lambda q: of_bore(q) - of_annulus(whole * speed - q), -1.0, 1.0, xtol=1e-14)
    row = Tripping(case, whole_string(case), "open").at(operation, speed)
    sign = 1.0 if operation == "trip_in" else -1.0
    assert row.surge_pressure == pytest.approx(sign * of_bore(up_bore), rel=1e-5)
    assert row.bit_flow == pytest.approx(-sign * up_bore, rel=1e-5)


@pytest.mark.parametrize("pipe", ("closed", "open", "pumping"))
def test_running_in_raises_and_pulling_out_lowers(pipe):
    """Signs of surge and swab, in a deviated well with collars, stabilizer, nozzles and casing; monotone in speed."""
    case = load_case("cases/directional.yaml")
    trip = Tripping(case, whole_string(case), pipe, flow=0.02)
    slow, fast = ([trip.at(op, v) for op in ("trip_in", "trip_out")] for v in (0.1, 0.5))
    assert slow[0].surge_pressure > 0 > slow[1].surge_pressure
    assert fast[0].surge_pressure > slow[0].surge_pressure and fast[1].surge_pressure < slow[1].surge_pressure
    assert slow[0].ecd_bit > slow[1].ecd_bit


@pytest.mark.parametrize(("pipe", "flow"), [("closed", 0.0), ("pumping", 0.02)])
def test_return_is_what_the_string_displaces(pipe, flow):
    """Stiff mud: out of the flow line comes the section of the string at the rig times its speed, and the pump's rate.

    The string has two sections and the hole three: what enters the well is the pipe at the top, closed or full.
    """
    case = Case(
        string=[
            {"kind": "pipe", "length": 900.0, "od": 0.127, "id": 0.1086},
            {"kind": "pipe", "length": 100.0, "od": 0.1715, "id": 0.0714},
        ],
        top="clamped",
        well={
            "survey": {"md": [0, 400, 1200], "inclination": [0, 0, 1.0], "azimuth": [0, 0, 0]},
            "sections": [
                {"kind": "casing", "to": 300, "diameter": 0.32},
                {"kind": "casing", "to": 700, "diameter": 0.2244},
                {"kind": "open_hole", "diameter": 0.2159},
            ],
        },
        fluid={**STIFF, "density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.02}},
    )
    row = Tripping(case, whole_string(case), pipe, flow=flow).at("trip_in", 0.4)
    # a full pipe brings its own mud along: the pump feeds the bore that moves away from it
    assert row.outlet_flow == pytest.approx(0.4 * np.pi / 4 * 0.127**2 + flow, rel=1e-4)


def test_largest_speed_of_a_linear_law():
    """Laminar Newtonian mud, closed pipe: the pressure is linear in the speed, so is the largest speed (closed form)."""
    mu, length, od, hole, density = 0.1, 1500.0, 0.127, 0.2159, 1200.0
    mud = {"density": density, "rheology": {"model": "newtonian", "viscosity": mu, "law": "exact"}}
    case = vertical(length, od, 0.1, hole, mud, window={"pore": 1150.0, "frac": 1230.0})
    per_speed = 48 * mu * length * (od**2 / (hole**2 - od**2) + 0.45) / (hole - od) ** 2
    trip = Tripping(case, whole_string(case), "closed", open_hole(case, case.window))
    for operation, margin in (("trip_in", 30.0), ("trip_out", 50.0)):
        speed, limit = trip.fastest(operation)
        exact = margin * GRAVITY * length / per_speed
        assert exact - TOLERANCE <= speed <= exact * (1 + 1e-6)
        assert limit.startswith("frac" if operation == "trip_in" else "pore")


def test_mud_outside_the_window_at_rest_and_a_window_that_nothing_passes():
    mud = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.01}}
    case = vertical(1000.0, 0.127, 0.1, 0.2159, mud)
    wide = trips_of(speeds=0.1, window=[100.0, 4900.0]).window
    narrow = trips_of(speeds=0.1, window=[1300.0, 1400.0]).window
    string = whole_string(case)
    assert Tripping(case, string, "closed", open_hole(case, wide)).fastest("trip_in") == (FASTEST, "none")
    speed, limit = Tripping(case, string, "closed", open_hole(case, narrow)).fastest("trip_in")
    assert speed == 0.0 and limit.startswith("pore") and limit.endswith("at rest")


def test_a_bit_on_bottom_displaces_mud_too():
    """The same string at the bottom of its hole and far above it has the same surge under equal length of annulus."""
    mud = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.05}}
    on, off = (vertical(1000.0, 0.127, 0.1, 0.2159, mud, depth=d) for d in (1000.0, 1500.0))
    found = [Tripping(c, whole_string(c), "closed").at("trip_out", 0.3).surge_pressure for c in (on, off)]
    assert found[0] == pytest.approx(found[1], rel=1e-6)


@pytest.mark.parametrize("leak", [0.1, 10.0])
@pytest.mark.parametrize("with_bit", [True, False])
def test_check_valve_shuts_an_open_pipe_while_running_in(with_bit, leak, monkeypatch):
    """Shut, it makes an open pipe a closed one, however slow the trip; what it leaks decides nothing (manual: eq-mud-check-valve).

    Pulled out, it resists nothing: the swab is that without a valve.
    """
    monkeypatch.setattr(bit_flow, "SHUT", bit_flow.SHUT / leak)
    mud = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.05}}
    case = vertical(1000.0, 0.127, 0.1, 0.2159, mud | {"check_valve": True}, depth=1500.0)
    free = vertical(1000.0, 0.127, 0.1, 0.2159, mud, depth=1500.0)
    if with_bit:
        nozzles = {"kind": "bit", "length": 0.0, "od": 0.2, "mass": 50.0, "nozzle_area": 4e-4}
        bit = Case(string=[{"kind": "pipe", "length": 1, "od": 0.1}, nozzles], top="clamped").string[1:]
        case, free = (c.model_copy(update={"string": (*c.string, *bit)}) for c in (case, free))
    shut, end, open_end = (
        Tripping(c, whole_string(c), p) for c, p in ((case, "closed"), (case, "open"), (free, "open"))
    )
    for speed in (1e-3, 0.03, 0.3):
        expected = shut.at("trip_in", speed).surge_pressure
        assert end.at("trip_in", speed).surge_pressure == pytest.approx(expected, rel=1e-5)
        out = end.at("trip_out", speed)
        assert out.surge_pressure == pytest.approx(open_end.at("trip_out", speed).surge_pressure, rel=1e-9)
        assert abs(out.surge_pressure) < 0.9 * expected and out.bit_flow > 1e-3 * speed


def test_files_of_the_command(tmp_path: Path):
    """A row for each operation, pipe and speed; a row of the largest speed for each depth."""
    case = load_case(
        "cases/vertical-2000m.yaml", ["string[0].element_length=50 m", "string[1].element_length=50 m"]
    )
    plan = trips_of(speeds=[0.2, 0.4], window="1150,1400 kg/m3")
    result = run_surge(Job(case, tmp_path / "out"), plan)
    rows = read_table(tmp_path / "out" / "surge.csv")
    assert len(rows["trip_speed [m/s]"]) == 8 and set(rows["operation [-]"]) == {"trip_in", "trip_out"}
    signs = np.where(rows["operation [-]"] == "trip_in", 1.0, -1.0)
    assert (signs * rows["surge_pressure [Pa]"] > 0).all()
    fastest = read_table(tmp_path / "out" / "max_trip_speed.csv")
    assert len(fastest["bit_depth [m]"]) == 6 * 4 and fastest["bit_depth [m]"].max() == pytest.approx(2000.0)
    assert any("largest trip speed" in line for line in result.lines)
    assert {found["bit_depth"] for found in result.summary["open_pipe_by_area"]} == {2000.0}


BAD = {
    "no mud": ({"fluid": None}, Trips((0.1,)), "a fluid for surge"),
    "no well": ({"well": None}, Trips((0.1,)), "a well with mud"),
    "no annulus": ({"fluid": {"annulus": False}}, Trips((0.1,)), "a well with mud"),
    "no flow": ({}, Trips((0.1,), pipes=("pumping",)), "give --flow"),
    "too deep": ({}, Trips((0.1,), bit_depths=(2000.0,)), "the end of the hole"),
}


@each_row("name", BAD)
def test_cases_without_surge_are_refused(name, tmp_path: Path):
    keys, plan, words = BAD[name]
    base = vertical(
        1000.0, 0.127, 0.1, 0.2159, {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.01}}
    )
    fluid = keys.pop("fluid", {}) if name == "no annulus" else None
    update = dict(keys)
    if fluid is not None:
        update["fluid"] = base.fluid.model_copy(update=fluid)
    with pytest.raises(CaseError, match=words):
        run_surge(Job(base.model_copy(update=update), tmp_path / "out"), plan)
    assert not (tmp_path / "out").exists()


def test_string_at_a_depth_trips_with_less_pressure():
    """Half as much string: half the loss of laminar mud."""
    mud = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.1, "law": "exact"}}
    case = vertical(1000.0, 0.127, 0.1, 0.2159, mud)
    half, whole = (Tripping(case, string_at(case, d), "closed").at("trip_in", 0.2) for d in (500.0, 1000.0))
    assert 2 * half.surge_pressure == pytest.approx(whole.surge_pressure, rel=1e-6)


def test_a_speed_without_a_steady_flow_is_marked(tmp_path: Path, monkeypatch):
    """One speed fails: its row has no numbers and says why, and the other rows are there."""
    mud = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.05}}
    case = vertical(1000.0, 0.127, 0.1, 0.2159, mud, window={"pore": 1000.0, "frac": 1500.0})
    solve = FlowModel.solve

    def fails_at_two(self, flow=0.0, speed=0.0):
        if abs(speed) > 1.5:
            raise SolveError("no steady flow")
        solve(self, flow, speed)

    monkeypatch.setattr(FlowModel, "solve", fails_at_two)
    result = run_surge(
        Job(case, tmp_path / "out"), trips_of(speeds=[0.5, 2.0], operation="trip_in", pipe="closed")
    )
    rows = read_table(tmp_path / "out" / "surge.csv")
    assert list(rows["limited_by [-]"]) == ["none", "failed"]
    assert np.isfinite(rows["surge_pressure [Pa]"]).tolist() == [True, False]
    assert any("no steady flow" in line for line in result.lines)
    assert {row["limited_by"] for row in result.summary["max_trip_speed"]} == {"failed"}
    with pytest.raises(SolveError, match="no trip has a steady flow"):
        run_surge(Job(case, tmp_path / "none"), trips_of(speeds=[2.0], operation="trip_in", pipe="closed"))
    assert not (tmp_path / "none").exists()


def test_the_explicit_law_of_a_yield_stress_says_by_how_much_it_is_too_high():
    """Slow trips: blend against exact, as reported, is the ratio of the two commands; no word with the exact law."""
    found = {}
    for law in ("blend", "exact"):
        mud = {"model": "bingham", "yield_stress": 10.0, "plastic_viscosity": 0.03, "law": law}
        case = vertical(1000.0, 0.127, 0.1, 0.2159, {"density": 1200, "rheology": mud})
        found[law] = Tripping(case, whole_string(case), "closed").at("trip_in", 0.1)
    ratio = found["blend"].surge_pressure / found["exact"].surge_pressure
    assert ratio > 1.1
    (note,) = found["blend"].warnings
    assert f"by {100 * (ratio - 1):.0f} %" in note and not found["exact"].warnings


def test_a_trip_through_a_gel_says_what_the_rounding_leaves_out():
    """Slow trip of a closed pipe: at least the yield stress acts on a wall of 4 tau/gap per length; the share of it that is missing is said.

    With a hundredth of the rounding the surge is right and nothing is said.
    """
    yield_stress, length, gap = 20.0, 1000.0, 0.4445 - 0.127
    found = []
    for rate in (1.0, 0.01):
        mud = {
            "model": "bingham",
            "yield_stress": yield_stress,
            "plastic_viscosity": 0.03,
            "shear_rate": rate,
        }
        case = vertical(length, 0.127, 0.1, 0.4445, {"density": 1200, "rheology": mud})
        found.append(Tripping(case, whole_string(case), "closed").at("trip_in", 0.01))
    rounded, sharp = (row.surge_pressure for row in found)
    assert 1 < sharp / (4 * yield_stress * length / gap) < 1.1
    (note,) = found[0].warnings
    assert f"friction is {100 * (1 - rounded / sharp):.0f} % too low" in note and not found[1].warnings


def test_open_pipe_is_full_to_the_flow_line_wherever_its_top_is():
    """A string lowered 50 m below the rig has the surge of one that begins at the rig, 50 m longer hole or not."""
    mud = {"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.05}}
    high = vertical(500.0, 0.127, 0.1, 0.2159, mud, depth=600.0)
    low = Case(
        **{
            "string": [{"kind": "pipe", "length": 500.0, "od": 0.127, "id": 0.1, "element_length": 12.5}],
            "top": "clamped",
            "bottom": "bit",
            "initial": {"wob": 1e4},
            "well": simple_well(550, 0.2159),
            "fluid": {**STIFF, **mud},
        }
    )
    assert whole_string(low).top == pytest.approx(50.0)
    found = [Tripping(c, whole_string(c), "open").at("trip_in", 0.3).surge_pressure for c in (high, low)]
    assert found[0] == pytest.approx(found[1], rel=1e-6)


def test_a_string_short_of_its_hole_trips_from_the_rig(tmp_path: Path):
    """A string of 500 m in a hole of 800 m has the surge of the string lengthened to the rig, which is said; before, the
    mud had friction along the 500 m only."""
    case = Case(
        string=[
            {
                "kind": "pipe",
                "name": "five inch",
                "length": 460.0,
                "od": 0.127,
                "id": 0.1,
                "element_length": 20.0,
            },
            {"kind": "pipe", "length": 40.0, "od": 0.1651, "id": 0.07, "element_length": 20.0},
        ],
        top="clamped",
        bottom="bit",
        initial={"wob": 1e4},
        well=simple_well(800, 0.2159, (0, 0.3)),
        fluid={**STIFF, "density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.05}},
        output={"units": "field"},
    )
    plan = trips_of(speeds=[0.3], window="1100,1500 kg/m3")
    result = run_surge(Job(case, tmp_path / "out"), plan)
    rows = read_table(tmp_path / "out" / "surge.csv")
    whole = Tripping(case, string_at(case, 800.0), "closed").at("trip_in", 0.3).surge_pressure
    short = Tripping(case, whole_string(case), "closed").at("trip_in", 0.3).surge_pressure
    mine = (rows["operation [-]"] == "trip_in") & (rows["pipe [-]"] == "closed")
    assert rows["surge_pressure [Pa]"][mine] == pytest.approx(whole, rel=1e-6)
    assert whole > 1.3 * short
    said = [line for line in result.lines if "top lies at MD" in line]
    assert len(said) == 1 and "984.252 ft" in said[0] and "five inch" in said[0]


def test_margins_are_those_of_the_worst_point():
    """Mud of 1200 kg/m3 between pore densities of 1100 and 1150 and fracture densities of 1300 and 1240."""
    depth = np.array([100.0, 200.0])
    hole = OpenHole(depth, depth, np.array([1100.0, 1150.0]), np.array([1300.0, 1240.0]))
    flow = SimpleNamespace(
        md=np.array([0.0, 300.0]),
        pressure=lambda channel: 1200 * 9.81 * np.array([0.0, 300.0]),
        pressure_above=lambda tvd: 0 * tvd,
        pressure_below=lambda tvd: 0 * tvd,
        equivalent_density=lambda pressure, tvd: pressure / (9.81 * tvd),
    )
    margins = hole.margins(flow)  # type: ignore[arg-type]
    assert margins == {"frac_margin": pytest.approx(40.0), "pore_margin": pytest.approx(50.0)}
