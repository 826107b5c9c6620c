"""Rows of the catalogue against formulas and published values."""

from __future__ import annotations

import math

import pytest

from drillpetsc.case.catalogue import Catalogue
from drillpetsc.case.catalogue.formulas import (
    adjusted_weight,
    plain_end_weight,
    tensile_strength,
    tool_joint_torque,
    torsional_strength,
    worn_diameter,
)
from drillpetsc.case.catalogue.tables import TABLES
from tests.helpers.tables import each_row

BUILT_IN = Catalogue.built_in()


def every_row(table: str):
    return each_row("row", BUILT_IN.rows[table], ids=lambda row: f"{row.file}-{row.line}".replace(".csv", ""))


def area(outer: float, inner: float) -> float:
    return math.pi / 4 * (outer**2 - inner**2)


@every_row("drill_pipe")
def test_drill_pipe(row):
    """Plain-end weight 3.3996 A (API RP 7G), tensile Y A, torsion 0.096167 J Y/D; worn on the outside to 80 and 70 % of the wall.

    The table of RP 7G is rounded to 1 lbf and 0.01 lb/ft: 0.1 %, and the rounding.
    """
    outer, inner = row["size"], row["id"]
    assert row["id"] == pytest.approx(outer - 2 * row["wall"], abs=2e-3)
    assert row["plain_end"] == pytest.approx(3.3996 * area(outer, inner), rel=1e-3, abs=0.0051)
    polar = math.pi / 32 * (outer**4 - inner**4)
    assert row["tensile_e75_new"] == pytest.approx(75e3 * area(outer, inner), rel=1e-3)
    assert row["torsion_e75_new"] == pytest.approx(0.096167 * 75e3 * polar / outer, rel=1e-3)
    for word, wall in (("premium", 0.8), ("class_2", 0.7)):
        worn = inner + 2 * wall * row["wall"]
        assert worn_diameter(outer, inner, wall) == pytest.approx(worn, abs=2e-3)
        assert tensile_strength(worn, inner, 75e3) == pytest.approx(row[f"tensile_e75_{word}"], rel=1e-3)
    worn = worn_diameter(outer, inner, 0.8)
    assert torsional_strength(worn, inner, 75e3) == pytest.approx(row["torsion_e75_premium"], rel=1e-3)


@each_row(
    ("size", "nominal", "wall", "pull", "torque"),
    [
        (5.0, 19.5, 1.0, 712_070, 74_100), (5.0, 19.5, 0.8, 560_764, 58_114),
        (5.5, 21.9, 1.0, 786_809, 91_278), (5.5, 21.9, 0.8, 620_604, 71_754),
        (4.0, 14.0, 1.0, 513_600, 41_900), (4.0, 14.0, 0.8, 403_500, 32_800),
    ],
)  # fmt: skip
def test_s135_strength(size, nominal, wall, pull, torque):
    """S-135 pipe, new and premium: Workstrings International, drill pipe sheets (the 4 in rows are rounded to 100)."""
    row = next(r for r in BUILT_IN.rows["drill_pipe"] if (r["size"], r["nominal"]) == (size, nominal))
    outer = worn_diameter(row["size"], row["id"], wall)
    assert tensile_strength(outer, row["id"], 135e3) == pytest.approx(pull, rel=1e-3)
    assert torsional_strength(outer, row["id"], 135e3) == pytest.approx(torque, rel=1e-3, abs=50)


def test_premium_pipe_of_5_7_8_inch():
    """X-95 pipe of 28.70 lb/ft, 80 % of the wall left: 629,700 lbf (NOV Grant Prideco, drill pipe performance sheet)."""
    assert tensile_strength(worn_diameter(5.875, 4.875, 0.8), 4.875, 95e3) == pytest.approx(629_700, rel=1e-4)


def test_premium_pipe_of_5_inch():
    """5in 19.50 S-135 premium: od 4.855 in, wall 0.290 in, 560,764 lbf, 58,114 ft-lbf (Workstrings: 560,800 and 58,100).

    Torque under a pull of 300 klb: API RP 7G, A.9.2.
    """
    outer = worn_diameter(5.0, 4.276, 0.8)
    assert outer == pytest.approx(4.855, abs=1e-3)
    assert (outer - 4.276) / 2 == pytest.approx(0.290, abs=5e-4)
    assert torsional_strength(outer, 4.276, 135e3, 300e3) == pytest.approx(49_098, rel=1e-3)
    assert torsional_strength(5.0, 4.276, 75e3, 200e3) == pytest.approx(35_518, rel=1e-3)
    assert torsional_strength(5.0, 4.276, 75e3, 400e3) == 0.0  # the pull alone exceeds the yield


def test_design_factor():
    """5in 19.50 premium with a design factor of 1.10: 283,214 lbf (E-75), 396,500 lbf (G-105) (PetroSkills drill string course)."""
    outer = worn_diameter(5.0, 4.276, 0.8)
    assert tensile_strength(outer, 4.276, 75e3) / 1.1 == pytest.approx(283_214, rel=1e-4)
    assert tensile_strength(outer, 4.276, 105e3) / 1.1 == pytest.approx(396_500, rel=1e-4)


@every_row("tool_joint")
def test_adjusted_weight(row):
    """Formula of API RP 7G, section 4.4, against the weights of its tables 8 and 9.

    18 of the rows of the table agree within 0.25 %, the others within 1 %, one is 2 % off; these say so in their source.
    """
    tube = next(
        r for r in BUILT_IN.rows["drill_pipe"] if (r["size"], r["nominal"]) == (row["size"], row["nominal"])
    )
    weight = adjusted_weight(
        plain_end_weight(tube["size"], tube["id"]),
        row["upset_weight"] or 0.0,
        row["upset_od"],
        row["od"],
        row["id"],
        row["length"],
    )
    if row["make_up"] is not None:  # sheets of makers: real walls, and upsets that are not given
        assert 1.0 < row["adjusted"] / weight < 1.08
        return
    off = "the formula gives" in row.source
    assert weight == pytest.approx(row["adjusted"], rel=0.021 if off else 0.0085)
    if off:
        assert weight != pytest.approx(row["adjusted"], rel=0.005)  # else the remark is out of date


def test_adjusted_weights_mostly_within_a_quarter_percent():
    close = 0
    for row in BUILT_IN.rows["tool_joint"]:
        if row["upset_weight"] is None:
            continue
        tube = next(
            r
            for r in BUILT_IN.rows["drill_pipe"]
            if (r["size"], r["nominal"]) == (row["size"], row["nominal"])
        )
        keys = ("upset_weight", "upset_od", "od", "id", "length")
        weight = adjusted_weight(tube["plain_end"], *(row[key] for key in keys))
        close += abs(weight / row["adjusted"] - 1) < 0.0025
    assert close >= 18


@each_row(
    ("name", "outer", "inner", "torque"),
    [
        ("NC26", 3.375, 1.75, 6_875), ("NC46", 6.0, 3.25, 33_625), ("NC50", 6.375, 3.75, 37_676),
        ("NC50", 6.625, 2.75, 63_406), ("6 5/8 FH", 8.0, 5.0, 73_661), ("5 1/2 FH", 7.5, 3.0, 52_302 / 0.6),
    ],
)  # fmt: skip
def test_torque_of_tool_joints(name, outer, inner, torque):
    """API RP 7G: table 8, torsional yield of tool joints (as recalled), and the make-up torque of 5 1/2 in 21.90 S-135 pipe with
    5 1/2 FH tool joints, 52,302 ft-lbf (errata of May 2000 to table 10), which is 60 % of it."""
    row = next(row for row in BUILT_IN.rows["connection"] if row["connection"] == name)
    columns = ("taper", "threads", "thread_height", "root", "pitch_diameter", "pin_length", "counterbore")
    found = tool_joint_torque(*(row[c] for c in columns), outer, inner)
    assert found == pytest.approx(torque, rel=2e-4)


@every_row("connection")
def test_connection(row):
    """The number of a connection is its pitch diameter in tenths of an inch (API Spec 7-2), cut off; the pin ends inside the box."""
    if row["connection"].startswith("NC"):
        assert int(row["connection"][2:]) == int(10 * row["pitch_diameter"])
    assert 0 < row["counterbore"] - row["pitch_diameter"] < 0.36
    height = (
        math.cos(math.atan(row["taper"] / 24)) / row["threads"] * math.sqrt(3) / 2
    )  # of a sharp 60-degree thread
    assert row["thread_height"] == pytest.approx(height, rel=5e-3)


@every_row("hwdp")
def test_heavy_pipe(row):
    """Weight of tube, tool joints and centre upset of a joint of 30.5 ft, 3.3996 lb/ft per square inch of section: 1.2 %."""
    joint = 30.5 * 12
    ends, middle = row["tool_joint_length"], row["center_upset_length"]
    metal = (
        area(row["size"], row["id"]) * (joint - ends - middle)
        + area(row["tool_joint_od"], row["tool_joint_id"]) * ends
        + area(row["center_upset_od"], row["id"]) * middle
    )
    assert row["tube"] == pytest.approx(3.3996 * area(row["size"], row["id"]), rel=1e-3)
    assert row["weight"] == pytest.approx(3.3996 * metal / joint, rel=0.012)


@every_row("drill_collar")
def test_drill_collar(row):
    assert row["weight"] == pytest.approx(3.3996 * area(row["od"], row["id"]), abs=0.06)


@every_row("casing")
def test_casing(row):
    """id = od - 2 wall. Drift (API Spec 5CT): id less 1/8 in up to 8 5/8, 5/32 in up to 13 3/8, 3/16 in above.

    The weight with threads and coupling is up to 4.5 % above that of the plain tube.
    """
    assert row["id"] == pytest.approx(row["size"] - 2 * row["wall"], abs=1.1e-3)
    less = 1 / 8 if row["size"] <= 8.625 else 5 / 32 if row["size"] <= 13.375 else 3 / 16
    assert row["drift"] == pytest.approx(row["id"] - less, abs=1.1e-3)
    plain = 3.3996 * area(row["size"], row["id"])
    assert 0.99 < row["nominal"] / plain < 1.045


@every_row("grade")
def test_grade(row):
    """The number in the name of a grade is its yield strength in ksi."""
    assert row["grade"].split("-")[1] == f"{row['yield']:g}"
    assert row["yield_most"] is None or row["yield_most"] > row["yield"]
    assert row["tensile"] is None or row["tensile"] > row["yield"]


def test_classes():
    """API RP 7G, table 24: wall of a premium pipe 80 %, of class 2 70 %."""
    assert {row["class"]: row["wall"] for row in BUILT_IN.rows["class"]} == {
        "new": 1.0,
        "premium": 0.8,
        "class_2": 0.7,
    }


@each_row("table", TABLES)
def test_every_row_names_a_source(table):
    assert len(BUILT_IN.rows[table]) >= 3
    for row in BUILT_IN.rows[table]:
        assert row.source and "no source" not in row.source
        assert "as recalled" not in row.source or "unverified" in row.source
        assert ("(unverified)" in row.place) == ("unverified" in row.source) == (not row.verified)
