"""The command `limits` against published examples and closed forms (manual: sec-guide-limits).

Straight holes, in which tension, side force and buckling loads have closed forms.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from drillpetsc import limits, statics
from drillpetsc.analysis.hydraulics.trade_formulas import PPG
from drillpetsc.analysis.loads.limits.free_point import StuckString, free_points, slope
from drillpetsc.analysis.loads.limits.limits import _still_pressure, run_limits
from drillpetsc.analysis.loads.limits.soft_limits import SoftLimits
from drillpetsc.analysis.loads.limits.table import Choices
from drillpetsc.case import Case
from drillpetsc.case.catalogue.sizes import INCH, KSI, LB_PER_FT, LBF
from drillpetsc.case.options.free_point_options import Pair, read_pairs
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.output.job import Job
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well

FT, KLB, PSI, G = 0.3048, 1e3 * LBF, KSI / 1e3, 9.80665
STEEL = 65.5 * PPG  # the density behind the trade's buoyancy factors
E_STEEL = 30e6 * PSI
AREA = math.pi / 4 * (5**2 - 4.276**2)  # of 5 in 19.50 new [in2]


def hole(length: float, inclination: float, diameter: float, friction: float = 0.3) -> dict[str, Any]:
    """A straight open hole; inclination in rad, friction [-], SI."""
    return simple_well(length, diameter, inclination, friction=friction)


def case(string: list[dict[str, Any]], well: dict[str, Any] | None = None, **keys: Any) -> Case:
    top = keys.pop("top", "top_drive" if well else "clamped")
    top = {"kind": top} if top == "top_drive" else top
    return Case(string=string, top=top, **({"well": well} if well else {}), **keys)


def level_pipe(length: float, **more: Any) -> dict[str, Any]:
    """Coiled tubing of od 140, id 116 mm that weighs 315 N/m without mud, as of Wicks et al. (2008)."""
    density = 315 / G / (math.pi / 4 * (0.14**2 - 0.116**2))
    return {
        "kind": "pipe",
        "name": "tubing",
        "length": length,
        "od": 0.14,
        "id": 0.116,
        "material": {"young": 207e9, "density": density},
    } | more


STILL = {"bulk_modulus": 1e14, "elastic_walls": False, "flow_rate": 0.0}
WATER = {"model": "newtonian", "viscosity": 1e-3}


def test_margin_of_overpull_in_a_vertical_well(tmp_path):
    """8,000 ft x 23.5 + 900 ft x 58 + 20 klb of collars in 9.2 ppg: hook load 223,653, margin 168,747 lbf.

    Inputs of drillingformulas.com; a pull at yield of 436 klb, of which 0.9 is allowed.
    """

    def pipe(name: str, feet: float, weight: float) -> dict[str, Any]:
        bore = 3 * INCH
        metal = weight * LB_PER_FT / STEEL
        outer = math.sqrt(bore**2 + 4 / math.pi * metal)
        return {
            "kind": "pipe",
            "name": name,
            "length": feet * FT,
            "od": outer,
            "id": bore,
            "material": {"density": STEEL},
        }

    drill_pipe = {
        "kind": "drill_pipe",
        "pipe": "5in 19.50 E-75 NC50 new",
        "length": 8000 * FT,
        "adjusted_weight": 23.5 * LB_PER_FT,
        "yield_strength": 436 * KLB / (AREA * INCH**2),
        "material": {"density": STEEL},
    }
    string = [drill_pipe, pipe("light", 900, 58.0), pipe("heavy", 100, 200.0)]
    mud = {**STILL, "density": 9.2 * PPG, "rheology": WATER}
    found = run_limits(
        Job(case(string, hole(9000 * FT, 0.0, 12.25 * INCH), fluid=mud), tmp_path / "r"), "pickup"
    ).summary
    margin = found["margin_of_overpull"]
    assert found["hook_load"] / LBF == pytest.approx(223653, rel=2e-3)
    assert margin["hook_load"] / LBF == pytest.approx(223653, rel=2e-3)
    assert margin["margin"] / LBF == pytest.approx(168747, rel=2e-3)
    assert margin["ratio"] == pytest.approx(392400 / 223653, rel=2e-3)
    assert margin["md"] == 0.0 and margin["item"] == "drill pipe"
    assert found["neutral_point"]["effective"] is None  # it hangs


@pytest.mark.parametrize("law, helical", [("chen", 356.16e3), ("wu", 251.84e3 * (2 * math.sqrt(2) - 1))])
def test_buckling_limits_of_a_level_string(law, helical, tmp_path):
    """P_s 251.84 kN, P_h 356.16 kN (Wicks et al. 2008); weight on bit left above the drag of 1000 m, mu 0.3."""
    level = hole(1000, math.pi / 2, 0.222)
    bit = {"kind": "bit", "length": 0.0, "od": 0.2, "mass": 0.0}
    string = [level_pipe(1000.0, element_length=25.0), bit]
    given = case(string, level, bottom="bit", initial={"wob": 20e3})
    found = run_limits(Job(given, tmp_path / "r"), "sliding", Choices(helical=law))
    table = read_table(found.folder / "limits.csv")
    assert table["sinusoidal_limit [N]"] == pytest.approx(251.84e3, rel=1e-3)
    assert table["helical_limit [N]"] == pytest.approx(helical, rel=1e-3)
    assert set(table["buckling_state [-]"]) == {"none"}
    most = found.summary["max_wob"]["sliding"]
    drag = 0.3 * 315 * 1000
    assert most["sinusoidal"]["wob"] == pytest.approx(251.84e3 - drag, rel=2e-3)
    assert most["helical"]["wob"] == pytest.approx(helical - drag, rel=2e-3)
    assert most["sinusoidal"]["md"] == pytest.approx(0.0, abs=1.0)
    assert found.summary["max_slackoff"] == pytest.approx(helical - drag, rel=2e-3)
    speed, spin = 60 * FT / 3600, 100 * math.pi / 30 * 0.07
    share = speed / math.hypot(speed, spin)
    most = found.summary["max_wob"]["drilling"]
    assert most["sinusoidal"]["wob"] == pytest.approx(251.84e3 - share * drag, rel=2e-3)


def test_buckling_limits_of_drill_pipe_on_an_incline(tmp_path):
    """5 in 19.50 S-135 NC50 22.60 lb/ft, 12 ppg, 60 deg, 8.5 in hole, clearance at the joint: 49,328 and 69,760 lbf."""
    pipe = {
        "kind": "drill_pipe",
        "pipe": "5in 19.50 S-135 NC50 premium",
        "length": 300.0,
        "adjusted_weight": 22.60 * LB_PER_FT,
        "stiffness": "body",
        "tool_joint": {"od": 6.625 * INCH},
        "material": {"density": STEEL, "young": E_STEEL},
    }
    mud = {**STILL, "density": 12 * PPG, "rheology": WATER}
    given = case([pipe], hole(300.0, math.radians(60), 8.5 * INCH), fluid=mud)
    found = run_limits(Job(given, tmp_path / "r"), "trip_in")
    table = read_table(found.folder / "limits.csv")
    assert table["sinusoidal_limit [N]"] / LBF == pytest.approx(49328, rel=1e-3)
    assert table["helical_limit [N]"] / LBF == pytest.approx(69760, rel=1e-3)
    assert set(table["grade [-]"]) == {"S-135"} and set(table["class [-]"]) == {"premium"}
    across = 22.60 * LBF / FT * (1 - 12 / 65.5) * math.sin(math.radians(60))
    inner = slice(2, -2)
    assert table["contact_force [N/m]"][inner] == pytest.approx(across, rel=2e-2)
    assert table["side_force_per_joint [N]"][inner] == pytest.approx(across * 31 * FT, rel=2e-2)


def test_buckling_of_a_vertical_string_is_that_of_lubinski(tmp_path):
    """Collars 6 3/4 x 2 13/16, 100.5 lb/ft in 12 ppg: 10,043 and 19,413 lbf at the lower end; neutral point at WOB/w."""
    metal = math.pi / 4 * (6.75**2 - 2.8125**2) * INCH**2
    collar = {
        "kind": "drill_collar",
        "od": 6.75 * INCH,
        "id": 2.8125 * INCH,
        "length": 200.0,
        "adjusted_weight": 100.5 * LB_PER_FT,
        "material": {"density": 100.5 * LB_PER_FT / metal, "young": E_STEEL},
    }
    bit = {"kind": "bit", "length": 0.0, "od": 0.2159, "mass": 0.0}
    weight = 100.5 * LB_PER_FT * G
    given = case([collar, bit], hole(200, 0.0, 0.2159), bottom="bit", initial={"wob": 30e3})
    found = run_limits(Job(given, tmp_path / "dry"), "drilling")
    table = read_table(found.folder / "limits.csv")
    stiffness = E_STEEL * math.pi / 64 * (6.75**4 - 2.8125**4) * INCH**4
    first = 1.94 * (stiffness * weight**2) ** (1 / 3)
    assert first / LBF == pytest.approx(10043 / (1 - 12 / 65.5) ** (2 / 3), rel=1e-3)
    assert table["sinusoidal_limit [N]"] == pytest.approx(first, rel=1e-6)
    assert table["helical_limit [N]"] == pytest.approx(first * 3.75 / 1.94, rel=1e-6)
    for kind in ("effective", "true"):
        assert found.summary["neutral_point"][kind]["above_bit"] == pytest.approx(30e3 / weight, rel=1e-3)
    most = found.summary["max_wob"]["drilling"]["sinusoidal"]
    assert most["wob"] == pytest.approx(first, rel=2e-3) and most["md"] == pytest.approx(200.0)


def test_a_string_that_hangs_in_air(tmp_path):
    """Premium drill pipe without a hole: stress w L/A of the worn section at the top, safety factor, ratio of tension."""
    pipe = {"kind": "drill_pipe", "pipe": "5in 19.50 E-75 NC50 premium", "length": 2000.0}
    given = case([pipe])
    found = run_limits(Job(given, tmp_path / "r"))
    table = read_table(found.folder / "limits.csv")
    weight = given.string[0].adjusted_weight * G * 2000
    worn = math.pi / 4 * ((4.276 + 0.8 * 0.724) ** 2 - 4.276**2) * INCH**2
    assert table["axial_stress [Pa]"][0] == pytest.approx(weight / worn, rel=1e-6)
    assert table["von_mises [Pa]"][0] == pytest.approx(weight / worn, rel=1e-6)
    assert table["safety_factor [-]"][0] == pytest.approx(75e3 * PSI * worn / weight, rel=1e-6)
    assert table["tension_ratio [-]"][0] == pytest.approx(weight / (0.9 * 75e3 * PSI * worn), rel=1e-6)
    assert np.isnan(table["sinusoidal_limit [N]"]).all() and set(table["buckling_state [-]"]) == {"none"}
    assert found.summary["margin_of_overpull"] is None and found.summary["contacts"] == []
    assert any("no wall" in note for note in found.summary["notes"])


def test_stresses_of_the_table_are_those_of_its_forces(tmp_path):
    """An inclined string that turns under weight in mud under pressure: von Mises from forces and pressures by hand."""
    pipe = {"kind": "drill_pipe", "pipe": "5in 19.50 S-135 NC50 new", "length": 900.0, "contact_on": "body"}
    collar = {"kind": "drill_collar", "od": 6.75 * INCH, "id": 2.8125 * INCH, "length": 90.0}
    bit = {"kind": "bit", "length": 0.3, "od": 8.5 * INCH, "mass": 60.0, "nozzle_area": 3e-4}
    mud = {
        "density": 1200.0,
        "rheology": {"model": "bingham", "plastic_viscosity": 0.02, "yield_stress": 5.0},
    }
    top = {"kind": "top_drive", "rotation": 10.0}
    survey = {"md": [0, 300, 500, 991], "inclination": [0, 0, 0.6, 0.6], "azimuth": [0, 0, 0, 0]}
    sections = [{"to": 991, "kind": "open_hole", "diameter": 8.5 * INCH, "friction": 0.25}]
    given = Case(
        string=[pipe, collar, bit],
        top=top,
        bottom="bit",
        initial={"wob": 40e3},
        well={"survey": survey, "sections": sections},
        fluid={**mud, "flow_rate": 0.03},
    )
    found = run_limits(Job(given, tmp_path / "r"), "drilling")
    t = {name.partition(" [")[0]: values for name, values in read_table(found.folder / "limits.csv").items()}
    k = t["item"] == "drill pipe"
    o, i = 2.5 * INCH, 2.138 * INCH
    area, moment = math.pi * (o**2 - i**2), math.pi / 4 * (o**4 - i**4)
    inside, outside = t["internal_pressure"][k], t["annulus_pressure"][k]
    assert inside[0] > 1e6 > outside[0] >= 0 and outside[-1] > 5e6
    worst = []
    for r, hoop, radial in (
        (o, (2 * inside * i**2 - outside * (o**2 + i**2)) / (o**2 - i**2), -outside),
        (i, (inside * (o**2 + i**2) - 2 * outside * o**2) / (o**2 - i**2), -inside),
    ):
        shear = t["torque"][k] * r / (2 * moment)
        for side in (1, -1):
            axial = t["axial_force"][k] / area + side * t["bending_moment"][k] * r / moment
            s = np.array([axial, hoop, radial])
            deviator = s - s.mean(axis=0)
            worst.append(np.sqrt(1.5 * (deviator**2).sum(axis=0) + 3 * shear**2))
    assert t["von_mises"][k] == pytest.approx(np.max(worst, axis=0), rel=1e-9)
    between = math.pi * (
        inside * i**2 - outside * o**2
    )  # of the tube, whose wall it is, not the mean with tool joints
    assert (t["axial_force"] - t["effective_tension"])[k] == pytest.approx(between, rel=1e-9)
    contacts = read_table(found.folder / "contacts.csv")
    assert list(contacts["item [-]"]) == ["drill pipe", "drill collar", "bit"]
    assert found.summary["surface_torque"] == pytest.approx(
        found.summary["bit_torque"] - contacts["contact_torque [N m]"].sum(), rel=1e-3
    )


def test_overpull_at_the_bit_of_a_straight_incline(tmp_path):
    """Side forces of a straight hole do not depend on the pull: w L (cos + mu sin) at pick-up, the rest is left at the bit."""
    pipe = {"kind": "drill_pipe", "pipe": "5in 19.50 E-75 NC50 premium", "length": 1000.0}
    given = case([pipe], hole(1000, math.radians(60), 0.2159))
    found = run_limits(Job(given, tmp_path / "r"), "pickup", Choices(tension_fraction=0.8)).summary
    weight = given.string[0].adjusted_weight * G * 1000
    tension = weight * (math.cos(math.radians(60)) + 0.3 * math.sin(math.radians(60)))
    worn = math.pi / 4 * ((4.276 + 0.8 * 0.724) ** 2 - 4.276**2) * INCH**2
    limit = 0.8 * 75e3 * PSI * worn
    assert found["hook_load"] == pytest.approx(tension, rel=2e-3)
    assert found["margin_of_overpull"]["margin"] == pytest.approx(limit - tension, rel=2e-3)
    assert found["max_overpull_at_bit"]["pull"] == pytest.approx(limit - tension, rel=3e-3)


def test_pipe_without_a_grade_has_no_strength(tmp_path):
    """kind: pipe: empty cells and a note, not a guess; buckling limits are there."""
    pipe = {"kind": "pipe", "name": "plain", "length": 500.0, "od": 0.127, "id": 0.1086}
    found = run_limits(Job(case([pipe], hole(500, 1.0, 0.2159)), tmp_path / "r"), "rob")
    table = read_table(found.folder / "limits.csv")
    for name in ("yield_strength [Pa]", "safety_factor [-]", "tension_limit [N]", "torque_limit [N m]"):
        assert np.isnan(table[name]).all(), name
    for name in ("fatigue_dls [1/m]", "side_force_per_joint [N]", "tension_ratio [-]"):
        assert np.isnan(table[name]).all(), name
    assert np.isfinite(table["von_mises [Pa]"]).all() and np.isfinite(table["sinusoidal_limit [N]"]).all()
    assert found.summary["weakest"]["safety_factor"] is None
    assert found.summary["margin_of_overpull"] is None and found.summary["max_overpull_at_bit"] is None
    assert any("no yield strength" in note and "plain" in note for note in found.summary["notes"])


def test_rows_where_items_meet_and_around_rigid_items(tmp_path):
    """Both ends of each item have rows in the order of the string; a stabilizer has forces of the pipe and no limits."""
    string = [
        {"kind": "drill_pipe", "name": "dp", "pipe": "5in 19.50 S-135 NC50 premium", "length": 300.0},
        {"kind": "stabilizer", "name": "stab", "length": 2.0, "od": 0.21, "id": 0.07, "mass": 300.0},
        {"kind": "drill_collar", "name": "dc", "od": 0.1715, "id": 0.0714, "length": 60.0},
    ]
    given = case(string, hole(400, 0.9, 0.2159))
    found = run_limits(Job(given, tmp_path / "r"), "trip_out")
    table = read_table(found.folder / "limits.csv")
    names, md = list(table["item [-]"]), table["md [m]"]
    order = [name for k, name in enumerate(names) if k == 0 or names[k - 1] != name]
    assert order == ["dp", "stab", "dc"] and (np.diff(md) >= 0).all()
    at = {name: md[np.array(names) == name] for name in ("dp", "stab", "dc")}
    assert at["dp"][[0, -1]] == pytest.approx([0.0, 300.0]) and at["dc"][[0, -1]] == pytest.approx(
        [302.0, 362.0]
    )
    assert at["stab"] == pytest.approx([300.0, 302.0])
    stab = np.array(names) == "stab"
    assert np.isnan(table["von_mises [Pa]"][stab]).all() and np.isfinite(table["axial_force [N]"][stab]).all()
    beside = [np.flatnonzero(np.array(names) == "dp")[-1], np.flatnonzero(np.array(names) == "dc")[0]]
    for name in ("axial_force [N]", "effective_tension [N]", "torque [N m]"):
        assert table[name][stab] == pytest.approx(table[name][beside], rel=1e-12)
    assert table["tvd [m]"] == pytest.approx(md * math.cos(0.9))
    weight = (300 * given.string[0].adjusted_weight + 60 * given.string[2].adjusted_weight + 300) * G
    on_joint = given.string[0].adjusted_weight * G * math.sin(0.9) * 31 * FT
    assert table["side_force_per_joint [N]"][np.array(names) == "dp"].max() < 1.5 * on_joint
    rows = {row["item"]: row for row in found.summary["contacts"]}
    assert rows["stab"]["side_force"] > 0 and rows["stab"]["md"] == pytest.approx(301.0)
    assert (
        min(rows["stab"]["direction"], 2 * math.pi - rows["stab"]["direction"]) < 1e-3
    )  # pushed to the high side
    assert abs(rows["stab"]["gap"]) < 1e-3
    across = sum(row["side_force"] for row in rows.values())
    assert across == pytest.approx(weight * math.sin(0.9), rel=2e-2)
    drag = sum(row["axial_drag"] for row in rows.values())
    assert drag == pytest.approx(0.3 * across, rel=1e-3)  # hoisted: down the hole
    assert found.summary["hook_load"] == pytest.approx(weight * math.cos(0.9) + drag, rel=1e-3)


def test_wear_of_casing_below_a_string_that_turns(tmp_path):
    """Level pipe of 315 N/m and 140 mm at 100 rpm: 315 N/m times 0.733 m/s in casing, nothing below it."""
    well = hole(600, math.pi / 2, 0.222, friction=0.1)
    open_hole = {"to": 600, "kind": "open_hole", "diameter": 0.222, "friction": 0.1}
    well["sections"] = [open_hole | {"to": 300, "kind": "casing"}, open_hole]
    top = {"kind": "top_drive", "rotation": "100 rpm"}
    found = run_limits(Job(case([level_pipe(600.0, element_length=10.0)], well, top=top), tmp_path / "r"))
    table = read_table(found.folder / "limits.csv")
    inner = (table["md [m]"] > 100) & (table["md [m]"] < 290)
    expected = 315 * 100 * math.pi / 30 * 0.07
    assert table["casing_wear_rate [W/m]"][inner] == pytest.approx(expected, rel=0.02)
    assert np.isnan(table["casing_wear_rate [W/m]"][table["md [m]"] > 310]).all()
    assert any("Rate of casing wear" in line for line in found.lines)
    still = run_limits(Job(case([level_pipe(600.0, element_length=10.0)], well), tmp_path / "still"))
    assert "casing_wear_rate [W/m]" not in read_table(still.folder / "limits.csv")


def test_make_up_torque(tmp_path):
    """60 % of the torque at which an NC50 tool joint of 6 5/8 x 2 3/4 in yields: 63,406 ft-lbf (API RP 7G, table 8).

    A pipe in the vertical that is turned at its lower end has this torque all along; a warning from 38,044 ft-lbf on.
    """
    pipe = {"kind": "drill_pipe", "length": 100, "pipe": "5in 19.50 S-135 NC50", "element_length": 10}
    made_up = 0.6 * 63_406 * 12 * INCH * LBF
    for share, name in ((0.9, "below"), (1.1, "above")):
        torque = share * made_up
        found = run_limits(
            Job(case([pipe], loads=[{"at": 100.0, "moment": [0, 0, torque]}]), tmp_path / name)
        )
        table = read_table(found.folder / "limits.csv")
        assert table["make_up_torque [N m]"] == pytest.approx(made_up, rel=1e-4)
        assert table["make_up_ratio [-]"] == pytest.approx(share, rel=1e-4)
        assert any("times the make-up torque" in w for w in found.summary["warnings"]) == (share > 1)
    own = pipe | {"tool_joint": {"make_up_torque": "30 kft-lbf"}}
    unknown = pipe | {
        "name": "pipe with other threads",
        "tool_joint": {"connection": "HT55", "od": "7 in", "id": "4 in", "length": "25 in"},
    }
    small = pipe | {"name": "slim pipe", "tool_joint": {"od": "5.2 in"}}  # no metal outside the box
    found = run_limits(Job(case([own, unknown, small]), tmp_path / "own"))
    table = read_table(found.folder / "limits.csv")
    first = table["md [m]"] < 99
    assert table["make_up_torque [N m]"][first] == pytest.approx(30e3 * 12 * INCH * LBF)
    assert np.isnan(table["make_up_torque [N m]"][table["md [m]"] > 101]).all()
    assert any("pipe with other threads, slim pipe" in note for note in found.summary["notes"])


def test_limits_that_are_passed_are_warnings(tmp_path):
    """Pulled beyond: safety factor and tension flagged at the top. Pushed beyond both limits: state helical."""
    pipe = {"kind": "drill_pipe", "pipe": "5in 19.50 E-75 NC50 class_2", "length": 4500.0}
    with pytest.raises(CaseError):
        case([pipe | {"pipe": "no such pipe"}])
    pipe = {"kind": "drill_pipe", "pipe": "5in 19.50 E-75 NC50 premium", "length": 4500.0}
    found = run_limits(Job(case([pipe]), tmp_path / "pulled")).summary
    assert any(w.startswith("safety factor") and "MD 0 m" in w for w in found["warnings"])
    assert any(w.startswith("pull at yield over tension") for w in found["warnings"])
    level = hole(300, math.pi / 2, 0.222, friction=0.1)
    bit = {"kind": "bit", "length": 0.0, "od": 0.2, "mass": 0.0}
    tubing = level_pipe(300.0, element_length=2.0)
    found = run_limits(
        Job(case([tubing, bit], level, bottom="bit", initial={"wob": 270e3}), tmp_path / "pushed"), "drilling"
    )
    table = read_table(found.folder / "limits.csv")
    assert set(table["buckling_state [-]"]) == {"sinusoidal"}
    assert any("compression beyond the sinusoidal limit" in w for w in found.summary["warnings"])


@each_row(
    "word, keys, want",
    [
        ("tripping", {}, "trip_in"),
        ("drilling", {}, "initial.wob"),
        ("trip_out", {"bottom": "clamped"}, "a bottom that can move"),
        ("trip_out", {"top": {"kind": "top_drive", "force": 1e5}}, "no top.force"),
    ],
)
def test_operations_that_a_case_cannot_be_in_are_refused(word, keys, want, tmp_path):
    pipe = {"kind": "pipe", "length": 100.0, "od": 0.127, "id": 0.1086}
    with pytest.raises(CaseError) as error:
        run_limits(Job(case([pipe], hole(100, 0.5, 0.2159), **keys), tmp_path / "r"), word)
    assert want in str(error.value) and not (tmp_path / "r").exists()


@pytest.mark.parametrize(
    ("word", "share"), [("pickup", 1.0), ("slackoff", -1.0), ("rob", 0.0), ("rotate_off_bottom", 0.0)]
)
def test_statics_in_an_operation(word, share, tmp_path):
    """1000 m of pipe on an incline of 60 deg, mu 0.3: w L (cos I +- mu sin I). With a bit and a weight on it the string is off
    bottom all the same, and `limits` gives the same hook load."""
    pipe = {"kind": "pipe", "length": 1000.0, "od": 0.127, "id": 0.1086}
    bit = {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 1.0}
    well = hole(1000, math.radians(60), 0.2159, 0.3)
    result = statics(case([pipe], well), tmp_path / "s", operation=word)
    area = math.pi / 4 * (0.127**2 - 0.1086**2)
    expected = 7850 * 9.80665 * area * 1000 * (0.5 + share * 0.3 * math.sin(math.radians(60)))
    assert result.summary["hook_load"] == pytest.approx(expected, rel=3e-3)
    assert result.summary["motion"] in ("trip_in", "trip_out", "rotate_off_bottom")
    made = case([{**pipe, "length": 999.7}, bit], well, bottom="bit", initial={"wob": "20 kN"})
    found = statics(made, tmp_path / "b", operation=word).summary
    same = run_limits(Job(made, tmp_path / "l"), word).summary
    assert found["wob"] == 0 and found["hook_load"] == pytest.approx(same["hook_load"], rel=1e-9)
    with pytest.raises(CaseError, match="one of --motion and --operation"):
        statics(made, tmp_path / "t", operation=word, motion="hoist")


def test_bad_choices_and_cases_without_a_hole_are_refused(tmp_path):
    pipe = {"kind": "pipe", "length": 100.0, "od": 0.127, "id": 0.1086}
    for choice in ({"design_factor": 0.5}, {"tension_fraction": 0.0}, {"tension_fraction": math.nan}):
        with pytest.raises(CaseError, match="a number"):
            limits(case([pipe]), tmp_path / "r", **choice)
    with pytest.raises(CaseError, match="a case with a well"):
        run_limits(Job(case([pipe]), tmp_path / "r"), "trip_in")


# ---------------------------------------------------------------------- free point
def tube(outer: float, inner: float, feet: float) -> dict[str, Any]:
    return {
        "kind": "pipe",
        "name": "tubing",
        "length": feet * FT,
        "od": outer * INCH,
        "id": inner * INCH,
        "material": {"young": E_STEEL},
    }


@pytest.mark.parametrize(
    "outer, inner, inches, klb, feet, tolerance",
    [(5, 4.276, 24, 30, 10547, 2e-3), (2.875, 2.441, 25, 20, 5663, 1e-3), (3.5, 2.992, 20, 25, 5180, 1e-3)],
)
def test_free_point_of_one_size(outer, inner, inches, klb, feet, tolerance):
    """5 in 19.50: 10,547 ft (LAP); tubing 2 7/8 and 3 1/2: 5,663 and 5,180 ft (LAP, DF)."""
    found = StuckString(case([tube(outer, inner, 12000)])).find(inches * INCH, 0.0, klb * KLB)
    assert found.length is not None and found.length / FT == pytest.approx(feet, rel=tolerance)


def test_stretch_of_the_whole_string():
    """8,500 ft of area W/3.4 in2, W 23.52 lb/ft, under 230 klb: 113.05 in (DF, with E A instead of the weight)."""
    outer = math.sqrt(4.276**2 + 4 / math.pi * 23.52 / 3.4)
    found = StuckString(case([tube(outer, 4.276, 8500)])).find(100 * INCH, 0.0, 230 * KLB)
    assert found.whole / INCH == pytest.approx(113.05, rel=1e-4)


def test_free_point_in_a_tapered_string():
    """Two sizes and a rigid item between them: the stretch of the first, then that of the second."""
    first, second = tube(5, 4.276, 1000), tube(3.5, 2.602, 1000)
    rigid = {"kind": "body", "length": 10 * FT, "mass": 500.0}
    string = case([first, rigid, second])
    each = [12000.0 / (30e6 * math.pi / 4 * (a**2 - b**2)) * 50e3 for a, b in ((5, 4.276), (3.5, 2.602))]
    found = StuckString(string).find((each[0] + 0.25 * each[1]) * INCH, 0.0, 50 * KLB)
    assert found.length is not None and found.length / FT == pytest.approx(1260.0, rel=1e-9)
    assert StuckString(string).find((sum(each) + 0.1) * INCH, 0.0, 50 * KLB).length is None


def test_free_point_by_the_line_through_several_pairs():
    """A constant error of the stretch drops out; one pull alone has no line."""
    string = case([tube(5, 4.276, 12000)])
    per_pull = 8000 * 12 / (30e6 * AREA) * INCH / LBF
    pairs = [Pair(0.05 + per_pull * f, f) for f in (10 * KLB, 20 * KLB, 40 * KLB)]
    found = free_points(string, pairs)["slope"]
    assert found.length / FT == pytest.approx(8000, rel=1e-9)
    assert slope(pairs[:1]) is None and slope([Pair(1.0, 1e5), Pair(0.9, 2e5)]) is None


def test_free_point_below_a_bend():
    """Friction in a bend of radius R leaves exp(-mu theta) of the pull: stretch P/EA [a + R/mu (1 - exp(-mu theta)) + b exp(-mu theta)].

    Above a straight slant the weight's friction does not change with the pull (capstan; the tension holds the pipe to the upper side).
    """
    R, mu, theta, above, below = 600.0, 0.3, math.radians(60.0), 500.0, 700.0
    build = above + R * theta
    survey = {
        "md": [0.0, above, build, 3500.0],
        "inclination": [0.0, 0.0, theta, theta],
        "azimuth": [0.0] * 4,
    }
    well = {"survey": survey, "sections": [{"kind": "open_hole", "diameter": 0.2159, "friction": mu}]}
    string = case([tube(5, 4.276, 3000 / FT)], well, bottom="free")
    left = math.exp(-mu * theta)
    stretch = 120e3 / (E_STEEL * AREA * INCH**2) * (above + R / mu * (1 - left) + below * left)
    found = StuckString(string).find(stretch, 0.0, 120e3)
    assert found.length == pytest.approx(build + below, rel=1e-4)
    assert found.arrives == pytest.approx(left, rel=1e-5)
    assert found.frictionless == pytest.approx(stretch * E_STEEL * AREA * INCH**2 / 120e3, rel=1e-6)
    assert not any("WARNING" in line for line in free_points(string, [Pair(stretch, 120e3)]).lines)
    pairs = [Pair(0.1 + stretch * f, 120e3 * f) for f in (0.5, 1.0, 1.5)]  # with a wrong zero
    assert free_points(string, pairs)["slope"].length == pytest.approx(build + below, rel=1e-4)


def test_a_pull_that_parts_the_pipe_is_doubted():
    """5 in 19.50 G-105 yields at 105 ksi times its worn section; 0.9 of that less its weight may be pulled."""
    pipe = {"kind": "drill_pipe", "pipe": "5in 19.50 G-105 NC50 new", "length": 1000.0}
    string = case([pipe], hole(1500.0, 0.0, 0.2159), bottom="free")
    weight = StuckString(string).free.hook_load
    most = 0.9 * 105 * KSI * AREA * INCH**2 - weight
    for share, doubted in ((0.98, False), (1.02, True)):
        lines = free_points(string, [Pair(0.5, share * most)]).lines
        assert any("beyond 0.9 of its tension at yield" in line for line in lines) == doubted


def test_pairs_of_stretch_and_pull_are_read():
    """Pounds are a force here; lists of one length; numbers with units."""
    (pair,) = read_pairs("24 in", "30 klb")
    assert (pair.stretch, pair.pull) == pytest.approx((24 * INCH, 30 * KLB))
    assert [p.pull for p in read_pairs("10,24 in", "12 kN, 30 klbf")] == pytest.approx([12e3, 30 * KLB])
    assert read_pairs(0.6, 1e5) == (Pair(0.6, 1e5),)
    for bad in (
        ("24", "30 klb"),
        ("24 in", "30"),
        ("24 in", "30 psi"),
        ("24 in", "1 kN,2 kN"),
        ("-1 in", "1 kN"),
    ):
        with pytest.raises(CaseError):
            read_pairs(*bad)


def test_what_is_left_to_pull_at_the_bit_in_a_vertical_hole():
    """Without friction a pull at the bit is felt all along: the limit less the weight of the string and the pull of the pressures on
    its wall.  Still mud presses the wall of an open pipe by rho g z times its metal."""
    case = Case(
        well={
            "survey": {"md": [0, 1000], "inclination": [0, 0], "azimuth": [0, 0]},
            "sections": [{"to": 1000, "kind": "casing", "diameter": 0.2159, "friction": 0.3}],
        },
        string=[{"kind": "pipe", "length": 900, "od": 0.127, "id": 0.1086, "element_length": 50}],
        top="clamped",
        bottom="free",
        fluid={"density": 1200, "rheology": {"model": "newtonian", "viscosity": 0.02}, "flow_rate": 0.03},
    )
    model, area = build_model(case), np.pi / 4 * (0.127**2 - 0.1086**2)
    soft, ends = SoftLimits(model, "chen"), (len(model.mesh.upper), 2)
    weight = area * (7850 - 1200) * 9.80665 * 900
    assert soft.max_overpull(np.full(ends, 1.2e6), np.full(ends, 1e5)).load == pytest.approx(
        1.1e6 - weight, rel=3e-3
    )
    still = _still_pressure(model)
    assert still is not None and still[-1, 1] == pytest.approx(-1200 * 9.80665 * 900 * area, rel=1e-9)
