"""The commands `hydraulics` and its losses against published examples and closed forms (manual: sec-guide-hydraulics).

Field units as published; stiff mud and walls, so that densities are those of the examples.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from drillpetsc.analysis.hydraulics import trade_formulas as trade
from drillpetsc.analysis.hydraulics.flow_model import FlowModel, string_at, whole_string
from drillpetsc.analysis.hydraulics.hydraulics import SPP, Hydraulics, flow_at_pressure, run_hydraulics
from drillpetsc.analysis.hydraulics.losses import balance
from drillpetsc.analysis.hydraulics.trade_formulas import FOOT, FOOT_PER_MINUTE, GPM, INCH, PPG, PSI
from drillpetsc.case import Case, load_case
from drillpetsc.errors import CaseError, SolveError
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from drillpetsc.units import to_si
from tests.helpers.tables import each_row
from tests.helpers.wells import newtonian, simple_well

STIFF = {"bulk_modulus": 1e14, "elastic_walls": False}
THREE_TWELVES = 3 * 0.25 * np.pi * (12 / 32 * INCH) ** 2
HP, LBF = 745.69987, to_si("1 lbf", "N")


def pipe(length: float, od: float, bore: float, element: float = 30.0) -> dict:
    """A pipe: length [ft], diameters [in]."""
    return {
        "kind": "pipe",
        "length": length * FOOT,
        "od": od * INCH,
        "id": bore * INCH,
        "element_length": element,
    }


def bit(od: float, area: float | None = None) -> dict:
    nozzles = {} if area is None else {"nozzle_area": area}
    return {"kind": "bit", "length": 0.0, "od": od * INCH, "mass": 50.0, **nozzles}


def well(*sections: tuple[str, float, float], inclination: float = 0.0) -> dict:
    """Sections: kind, lower end [ft], diameter [in]."""
    end = sections[-1][1] * FOOT
    return {
        "survey": {"md": [0, end], "inclination": [inclination, inclination], "azimuth": [0, 0]},
        "sections": [{"kind": k, "to": to * FOOT, "diameter": d * INCH} for k, to, d in sections],
    }


def case(string: list[dict], hole: dict | None, fluid: dict, **keys) -> Case:
    return Case(
        string=string, top="clamped", **({"well": hole} if hole else {}), fluid={**STIFF, **fluid}, **keys
    )


WATER = {"model": "newtonian", "viscosity": 1e-3}


def test_bit_through_the_solver():
    """400 gpm of 12 ppg through 3 x 12/32 in, Cd 0.95, 8 1/2 in bit: 1,610.3 psi (formulas of Baker Hughes, 2006)."""
    found = Hydraulics(
        case(
            [pipe(3000, 5, 4.276), bit(8.5, THREE_TWELVES)],
            well(("open_hole", 3000, 8.5)),
            {"density": 12 * PPG, "rheology": WATER, "flow_rate": 400 * GPM},
        )
    ).at(400 * GPM)
    s = found.summary
    assert s["bit_loss"] / PSI == pytest.approx(1610.3, rel=1e-3)
    assert s["bit_power"] / HP == pytest.approx(375.8, rel=1e-3)
    assert s["bit_power_per_area"] / (HP / INCH**2) == pytest.approx(6.62, rel=1e-3)
    assert s["jet_velocity"] / FOOT == pytest.approx(387.3, rel=1e-3)
    assert s["impact_force"] / LBF == pytest.approx(963.0, rel=1e-3)


def test_laminar_annulus_and_regimes():
    """9.5 ppg, dial 60/40, 650 gpm, 8 1/2 in hole: 271.3 psi along 10,000 ft of 5 in, laminar (drillingformulas.com)."""
    index = trade.power_law_index(60, 40)
    mud = {
        "model": "power_law",
        "index": index,
        "consistency": 60 / 1022**index * trade.LBF_PER_100FT2,
        "law": "exact",
    }
    found = Hydraulics(
        case(
            [pipe(10000, 5, 4.276), pipe(600, 6.75, 2.8125)],
            well(("open_hole", 10600, 8.5)),
            {"density": 9.5 * PPG, "rheology": mud, "flow_rate": 650 * GPM},
        )
    ).at(650 * GPM)
    annulus = [row for row in found.rows if row.channel == "annulus"]
    assert [row.velocity / FOOT_PER_MINUTE for row in annulus] == pytest.approx([337.0, 596.7], rel=1e-3)
    assert annulus[0].pressure_loss / PSI == pytest.approx(271.3, rel=5e-3)
    assert [row.regime for row in annulus] == ["laminar", "transitional"]
    bore = [row for row in found.rows if row.channel == "bore"]
    assert [row.regime for row in bore] == ["turbulent", "turbulent"]


def test_poiseuille_and_its_numbers():
    """Newtonian flow in a pipe: f = 16/Re, loss 128 mu L Q/(pi D^4), end of laminar flow at Re 2100."""
    mu, rho, d, length, q = 0.05, 1000.0, 0.1, 500.0, 2e-3
    string = [{"kind": "pipe", "length": length, "od": 0.127, "id": d}]
    found = Hydraulics(
        case(
            string,
            None,
            {"density": rho, "rheology": {"model": "newtonian", "viscosity": mu}, "flow_rate": q},
        )
    ).at(q)
    (row,) = found.rows
    reynolds = 4 * rho * q / (np.pi * d * mu)
    assert row.pressure_loss == pytest.approx(128 * mu * length * q / (np.pi * d**4), rel=1e-6)
    assert row.reynolds == pytest.approx(reynolds, rel=1e-9)
    assert row.friction_factor == pytest.approx(16 / reynolds, rel=1e-6)
    assert row.critical_flow == pytest.approx(2100 * np.pi * d * mu / (4 * rho), rel=1e-6)
    assert row.regime == "laminar" and row.volume == pytest.approx(np.pi / 4 * d**2 * length)


def test_a_mud_that_thickens_fast_stays_laminar_at_any_speed():
    """Re grows with v^(2 - n): n = 1.9 passes Re = 3470 - 1370 n first at (limit/Re)^10 times the speed, beyond 10 km/s."""
    mud = {"model": "power_law", "index": 1.9, "consistency": 0.4}
    string = [{"kind": "pipe", "length": 500.0, "od": 0.127, "id": 0.1}]
    found = Hydraulics(case(string, None, {"density": 1000.0, "rheology": mud, "flow_rate": 0.02})).at(0.02)
    (row,) = found.rows
    speed = 0.02 / (np.pi / 4 * 0.1**2)
    assert speed * ((3470 - 1370 * 1.9) / row.reynolds) ** 10 > 1e4
    assert row.regime == "laminar" and row.critical_flow == np.inf


CLOSING = {"vertical": "cases/vertical-2000m.yaml", "directional": "cases/directional.yaml"}


@pytest.mark.parametrize("name", CLOSING)
@pytest.mark.parametrize("rate", [0.0, 0.005, 0.06])
def test_losses_and_columns_add_up_to_the_pump_pressure(name, rate):
    """Pump pressure less outlet is the sum of all losses, heads and columns to 1 Pa; mud and walls are elastic."""
    c = load_case(CLOSING[name], ["fluid.outlet_pressure=12 bar", "fluid.flow_line=2 m"])
    flow = FlowModel(c, whole_string(c), "pumping")
    flow.solve(rate)
    b = balance(flow)
    total = sum(value for key, value in b.items() if key not in ("pump_pressure", "outlet"))
    assert b["outlet"] == 12e5
    assert total == pytest.approx(b["pump_pressure"] - b["outlet"], abs=1.0)


def test_rows_add_up_to_the_sums_of_the_balance():
    """Stabilizers between pipes, two hole sections and a choke: rows of a channel sum to its loss."""
    c = case(
        [
            pipe(1500, 5, 4.276),
            {
                "kind": "stabilizer",
                "name": "blades",
                "length": 2.0,
                "od": 8.4 * INCH,
                "id": 2.5 * INCH,
                "mass": 300.0,
            },
            pipe(300, 6.75, 2.8125),
            bit(8.5, THREE_TWELVES),
        ],
        well(("casing", 1000, 8.9), ("open_hole", 1900, 8.5)),
        {
            "density": 1200,
            "rheology": {"model": "herschel_bulkley", "yield_stress": 3, "consistency": 0.3, "index": 0.7},
            "choke": {"area": 5e-4},
            "outlet_pressure": 2e5,
        },
    )
    h = Hydraulics(c)
    found = h.at(0.03)
    sums = {"bore": "string_loss", "nozzles": "bit_loss", "annulus": "annulus_loss", "choke": "choke_loss"}
    for channel, key in sums.items():
        total = sum(row.pressure_loss for row in found.rows if row.channel == channel)
        assert total == pytest.approx(found.summary[key], rel=1e-12) and total > 0
    density = 1200 * np.exp(0)
    assert found.summary["choke_loss"] == pytest.approx(density * 0.03**2 / (2 * 0.95**2 * 25e-8), rel=1e-6)
    blades = [row for row in found.rows if row.item == "blades"]
    assert [row.channel for row in blades] == ["bore", "annulus"]
    assert [row.length for row in blades] == pytest.approx([2.0, 2.0])
    sizes = np.array([(row.od, row.id) for row in blades])
    steel = np.sqrt(
        (2.5 * INCH) ** 2 + 4 / np.pi * 300 / 7850 / 2
    )  # between the blades, as much as weighs 300 kg
    assert sizes == pytest.approx(np.array([(2.5 * INCH, 0.0), (8.5 * INCH, steel)]), rel=1e-9)
    area = np.pi / 4 * (sizes[:, 0] ** 2 - sizes[:, 1] ** 2)
    assert [row.velocity for row in blades] * area == pytest.approx([0.03, 0.03], rel=1e-6)
    ends = [(row.upper, row.lower) for row in found.rows if row.channel == "annulus"]
    assert all(a[1] == pytest.approx(b[0]) for a, b in zip(ends, ends[1:], strict=False))
    assert ends[0][0] == 0.0 and ends[-1][1] == pytest.approx(1800 * FOOT + 2.0)


def test_densities_of_still_and_flowing_mud():
    """In an inclined hole ECD is density + loss/(g TVD); a closed back pressure adds to it; ESD is that of still mud."""
    lean = np.radians(60)
    c = case(
        [pipe(4000, 5, 4.276), bit(8.5)],
        well(("casing", 2000, 8.9), ("open_hole", 5000, 8.5), inclination=lean),
        newtonian(1300, 0.02, outlet_pressure=3e5, flow_line=5.0),
    )
    h = Hydraulics(c)
    found = h.at(0.04)
    g = 9.80665

    def depth(feet: float) -> float:
        return feet * FOOT * np.cos(lean) - 5.0

    loss = {row.lower: row.pressure_loss for row in found.rows if row.channel == "annulus"}
    shoe, whole = loss[2000 * FOOT], sum(loss.values())
    cased, opened = (np.pi / 4 * (d**2 - 5**2) * INCH**2 for d in (8.9, 8.5))
    whole += 1300 / 2 * 0.04**2 * (1 / cased**2 - 1 / opened**2)  # the mud is faster in the open hole
    s = found.summary
    assert s["ecd_shoe"] == pytest.approx(1300 + (3e5 + shoe) / (g * depth(2000)), rel=1e-4)
    assert s["ecd_bit"] == pytest.approx(1300 + (3e5 + whole) / (g * depth(4000)), rel=1e-6)
    assert s["ecd_td"] == pytest.approx(1300 + (3e5 + whole) / (g * depth(5000)), rel=1e-6)
    esd = found.profile["esd"][20]
    assert esd == pytest.approx(1300 + 3e5 / (g * (found.profile["tvd"][20] - 5.0)), rel=1e-6)
    assert found.profile["md"][-1] == pytest.approx(5000 * FOOT)
    assert any("above the end of the hole" in note for note in h.notes)


def test_window_is_compared_in_the_open_hole():
    """1300 kg/m3 with 10 bar of loss: pore 1250 holds; frac between still and flowing density is named with its depth."""
    string, hole = [pipe(4000, 5, 4.276), bit(8.5)], well(("casing", 2000, 8.9), ("open_hole", 4000, 8.5))
    mud = {"density": 1300, "rheology": {"model": "newtonian", "viscosity": 0.05}}
    h = Hydraulics(case(string, hole, mud, window={"pore": 1250, "frac": 2000}))
    result = h.at(0.04)
    assert result.limited_by == "none" and not result.warnings
    ecd = result.summary["ecd_bit"]
    low = Hydraulics(case(string, hole, mud, window={"pore": 1250, "frac": ecd - 1.0})).at(0.04)
    assert low.limited_by.startswith("frac at TVD") and any("window" in w for w in low.warnings)
    high = Hydraulics(case(string, hole, mud, window={"pore": ecd + 1.0, "frac": 2000})).at(0.04)
    assert high.limited_by.startswith("pore at TVD")
    table = {"tvd": [700, 1300], "pore": [1200, 1200], "frac": [1500, 1500]}
    with pytest.raises(CaseError, match="cover the open hole"):
        Hydraulics(case(string, hole, mud, window={**table, "tvd": [700, 1300]}))


def test_flow_rate_of_a_pump_pressure(tmp_path: Path):
    """The flow rate found for the pressure of a flow rate is that flow rate; the files hold one of each table."""
    c = load_case("cases/vertical-2000m.yaml")
    pressure = Hydraulics(c).at(0.025).summary["pump_pressure"]
    result = run_hydraulics(Job(c, tmp_path / "out"), pump_pressure=pressure)
    assert result.summary["flows"][0]["pump_flow"] == pytest.approx(0.025, rel=1e-7)
    written = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert written["flows"][0]["pump_pressure"] == pytest.approx(pressure, rel=1e-7)
    rows = read_table(tmp_path / "out" / "hydraulics.csv")
    assert rows["pressure_loss [Pa]"].sum() == pytest.approx(
        sum(written["flows"][0][k] for k in ("string_loss", "bit_loss", "annulus_loss"))
    )
    curve = read_table(tmp_path / "out" / "flow_curve.csv")
    assert (np.diff(curve["pump_pressure [Pa]"]) > 0).all() and (np.diff(curve["ecd_bit [kg/m3]"]) > 0).all()
    profile = read_table(tmp_path / "out" / "pressure_profile.csv")
    assert np.nanmax(profile["internal_pressure [Pa]"]) > pressure


def test_free_fall_below_a_vacuum_is_told():
    """A light annulus beside a heavy bore cannot be; but a long open string with little flow and a low outlet can."""
    c = case([pipe(4000, 5, 4.276)], None, {"density": 1500, "rheology": WATER, "outlet_pressure": 0.0})
    result = Hydraulics(c).at(1e-3)
    assert any("vacuum" in w for w in result.warnings)


BAD = {
    "no mud": ({}, {"fluid": None}, "a fluid for hydraulics"),
    "no flow": ({"flow_rate": 0.0}, {}, "give --flow"),
    "reverse": ({"flow_rate": -0.01}, {}, "normal circulation"),
    "plugged": ({}, {"bottom": {"kind": "free", "plugged": True}}, "the mud must get out"),
}


@each_row("name", BAD)
def test_cases_without_a_flow_are_refused(name, tmp_path: Path):
    fluid, keys, words = BAD[name]
    mud = {**STIFF, "density": 1200, "rheology": WATER, **fluid}
    given = {
        "string": [pipe(1000, 5, 4.276)],
        "top": "clamped",
        "well": well(("open_hole", 1000, 8.5)),
        "fluid": mud,
    }
    given = {k: v for k, v in (given | keys).items() if v is not None}
    with pytest.raises(CaseError, match=words):
        run_hydraulics(Job(Case(**given), tmp_path / "out"))
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(("pressure", "words"), [(1e3, "starts the flow"), (1e12, "at most 60000 l/min")])
def test_pump_pressures_out_of_reach_are_refused(pressure, words, tmp_path: Path):
    c = case(
        [pipe(1000, 5, 4.276)],
        well(("open_hole", 1000, 8.5)),
        {"density": 1200, "rheology": {"model": "bingham", "yield_stress": 10.0, "plastic_viscosity": 0.02}},
    )
    with pytest.raises(CaseError, match=words):
        run_hydraulics(Job(c, tmp_path / "out"), pump_pressure=pressure)


def test_the_pressure_that_starts_a_gel_holds_its_yield_stress():
    """Refused below 4 tau L/d of bore and annulus: the rounding of small shear rates made a gel flow at a tenth of it."""
    mud = {
        "density": 1200.0,
        "rheology": {"model": "bingham", "yield_stress": 20.0, "plastic_viscosity": 0.03},
    }
    slow = case([pipe(3000, 5, 4)], well(("open_hole", 3000, 8.5)), {**mud, "flow_rate": 1e-3})
    length = 3000 * FOOT
    start = 4 * 20.0 * length * (1 / (4 * INCH) + 1 / (3.5 * INCH))
    flow = Hydraulics(slow).flow
    with pytest.raises(CaseError, match="starts the flow"):
        flow_at_pressure(flow, 0.98 * start, SPP)
    assert 0 < flow_at_pressure(flow, 1.1 * start, SPP) < 2e-3
    (said,) = [w for w in Hydraulics(slow).at(1e-4).warnings if "% too low here" in w]
    assert "0.01 1/s shows the gel" in said
    assert not [w for w in Hydraulics(slow).at(1e-2).warnings if "too low" in w]


def test_strings_at_a_depth():
    """The lowest metres of the string: the top pipe is cut or lengthened; inside a rigid item and below the hole refused."""
    c = load_case("cases/vertical-2000m.yaml")
    assert string_at(c, 1000.0).items[0].length == pytest.approx(800.0)
    assert string_at(c, 100.0).number == (1, 2, 3, 4)
    assert string_at(c, 2000.0).depth == pytest.approx(2000.0)
    shorter = c.model_copy(update={"string": c.string[1:]})
    assert string_at(shorter, 1500.0).items[0].length == pytest.approx(1500.0 - 26.0)
    for depth, words in ((1.0, "near-bit"), (2000.1, "end of the hole"), (0.2, "bit")):
        with pytest.raises(CaseError, match=words):
            string_at(c, depth)


def test_points_near_the_flow_line_have_no_density():
    """A level hole at the rig: no column above it, so no density and no window; without gravity the case is refused."""
    level = well(("open_hole", 2000, 8.5), inclination=np.pi / 2)
    mud = {"density": 1200, "rheology": WATER}
    h = Hydraulics(case([pipe(1000, 5, 4.276)], level, mud, window={"pore": 1000, "frac": 1500}))
    found = h.at(0.02)
    assert found.summary["ecd_bit"] is None and np.isnan(found.profile["ecd"]).all()
    assert found.limited_by == "none" and any("no open hole" in note for note in h.notes)
    with pytest.raises(CaseError, match="gravity"):
        Hydraulics(case([pipe(1000, 5, 4.276)], level, mud, gravity=0.0))


def test_a_flow_that_nothing_takes_names_the_flow_rate():
    """100 l/s through a choke of 10 mm2 would need 1e11 Pa: a SolveError with the flow rate, and no time."""
    mud = {"density": 1200, "rheology": WATER, "choke": {"area": 1e-5}, "bulk_modulus": 2e9}
    h = Hydraulics(case([pipe(150, 6.75, 4.5, 15)], well(("open_hole", 160, 8.5)), mud))
    with pytest.raises(SolveError) as raised:
        h.at(0.1)
    text = str(raised.value)
    assert "m3/s" in text and "time" not in text
    assert h.at(1e-3).summary["choke_loss"] == pytest.approx(1200 * 1e-6 / (2 * 0.95**2 * 1e-10), rel=1e-3)


def test_warnings_of_the_rig_and_of_a_short_string(tmp_path):
    """A pressure above rig.max_spp at one of two flow rates, and a string 100 m short of its hole, stand on the screen and in
    summary.json; without a rig and with a string that reaches the bottom nothing is said."""

    def lines(length, rig, flows):
        c = case(
            [pipe(length, 5, 4.276), bit(8.5, THREE_TWELVES)],
            well(("open_hole", 4000, 8.5)),
            {"density": 1300, "rheology": {"model": "newtonian", "viscosity": 0.02}},
            rig=rig,
            bottom="bit",
            initial={"wob": 1e4},
            output={"units": "field"},
        )
        result = run_hydraulics(Job(c, tmp_path / "out", overwrite=True), flows)
        summary = json.loads((tmp_path / "out" / "summary.json").read_text())
        said = [line for line in result.lines if "WARNING" in line]
        return said, [*summary["warnings"], *(w for f in summary["flows"] for w in f["warnings"])]

    assert lines(4000, None, [0.01, 0.03]) == ([], [])
    low, high = 0.01, 0.03
    screen, file = lines(4000, {"max_spp": "1500 psi"}, [low, high])
    assert len(screen) == len(file) == 1
    assert "at 475.51 gpm" in screen[0] and "exceeds rig.max_spp, 1500 psi" in screen[0]
    screen, file = lines(4000 - 100 / FOOT, None, [low])
    assert len(screen) == len(file) == 1 and "328.08 ft short of its hole of 4000 ft" in file[0]


def test_a_pressure_that_no_pump_delivers_is_doubted_with_its_place(tmp_path):
    """A tool 2 mm narrower than the hole. Laminar flow in a slot of height h loses 12 mu v L / h^2, here 1570 bar, all of it along the
    tool. With four times the clearance the loss is below 1 % of that, and nothing is said."""
    mu, rate, length, hole, gap = 0.1, 0.02, 20.0, 0.2159, 1e-3

    def told(gap):
        c = case(
            [
                pipe(500, 5, 4.276),
                {"kind": "pipe", "name": "tool", "length": length, "od": hole - 2 * gap, "id": 0.1},
            ],
            simple_well(600, hole),
            {"density": 1000, "rheology": {"model": "newtonian", "viscosity": mu}, "bulk_modulus": 1e12},
            output={"units": "metric"},
        )
        found = Hydraulics(c).at(rate)
        return found.warnings, next(
            q.pressure_loss for q in found.rows if q.item == "tool" and q.channel == "annulus"
        )

    warnings, loss = told(gap)
    speed = rate / (np.pi * (hole - gap) * gap)
    assert loss == pytest.approx(12 * mu * speed * length / gap**2, rel=0.02)
    (text,) = warnings
    assert "more than any mud pump delivers" in text
    assert (
        f"{loss / 1e5:.4g} bar of it in the annulus past tool" in text
        and "2 mm wider than the string" in text
    )
    assert told(4 * gap)[0] == []


def test_mud_that_takes_cuttings_is_said_to_have_none():
    """A case that drills: the pressures are those of clean mud, and the notes say so; one that does not drill needs no note."""
    drills = {
        "top": {"kind": "top_drive", "rotation": 10.0},
        "bottom": "bit",
        "formation": {"drillability": 4e-8},
        "initial": {"wob": 5e4},
    }
    fluid = {**STIFF, "density": 1200, "rheology": WATER, "flow_rate": 0.03}
    for more in ({"top": "clamped"}, drills):
        c = Case(
            string=[pipe(3000, 5, 4.276), bit(8.5, 5e-4)],
            well=well(("open_hole", 3001, 8.5)),
            fluid=fluid,
            **more,
        )
        assert any("without cuttings" in note for note in Hydraulics(c).notes) is (more is drills)


def test_still_mud_below_the_bit_has_the_density_of_its_pressure():
    """dp/dz = rho_0 exp(p/K) g at the bit, and (exp(-p_1/K) - exp(-p_2/K)) K = rho_0 g dz over 500 m, with a soft mud."""
    case = Case(
        well=simple_well(2000, 0.2159),
        string=[{"kind": "pipe", "length": 1500, "od": 0.127, "id": 0.1086, "element_length": 100}],
        top="clamped",
        bottom="free",
        fluid=newtonian(1500, 0.02, bulk_modulus=4e8, flow_rate=0.0),
    )
    flow = FlowModel(case, whole_string(case), "closed")
    flow.solve()
    p, q = flow.pressure_below(np.array([1500.0, 2000.0]))
    assert p == pytest.approx(flow.bottom_pressure(), rel=1e-9)
    assert 4e8 * (np.exp(-p / 4e8) - np.exp(-q / 4e8)) == pytest.approx(1500 * flow.gravity * 500, rel=1e-9)
