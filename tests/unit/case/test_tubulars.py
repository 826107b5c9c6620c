"""Pipe of the trade in a case: figures that are filled in, refusals, and what becomes of an item in the beam."""

from __future__ import annotations

import math
from typing import Any

import pytest

from drillpetsc.case import Case
from drillpetsc.case.pipe.section import ring, tubular_section
from drillpetsc.errors import CaseError
from tests.helpers.tables import each_row

INCH = 0.0254
LB_PER_FT = 0.45359237 / 0.3048
KSI = 6894757.293168361
G0 = 9.80665
PIPE = {"kind": "drill_pipe", "length": 300.0, "pipe": "5in 19.50 S-135 NC50"}
BARE = {"kind": "drill_pipe", "length": 300.0, "od": "5 in", "id": "4.276 in"}
JOINT = {"od": "6.625 in", "id": "2.75 in", "length": "17 in"}
COLLAR = {"kind": "drill_collar", "length": 30.0, "od": "8 in", "id": "3 in"}
STABILIZER = {
    "kind": "stabilizer",
    "length": 2.0,
    "od": "8.375 in",
    "body_od": "6.75 in",
    "id": "2.8125 in",
    "blade_length": 0.5,
}
BIT = {"kind": "bit", "length": 0.3, "od": "8.5 in", "mass": 50.0}


def case(*items: dict[str, Any], **keys: Any) -> Case:
    return Case(string=list(items), **({"top": "clamped"} | keys))


def item(given: dict[str, Any], **keys: Any):
    return case(given | keys).string[0]


def refused(*items: dict[str, Any], **keys: Any) -> CaseError:
    with pytest.raises(CaseError) as caught:
        case(*items, **keys)
    return caught.value


# ---------------------------------------------------------------------- drill pipe
def test_drill_pipe_by_reference() -> None:
    """5in 19.50 S-135 NC50, tool joint 6 5/8 x 2 3/4, 17 in tongs, 22.60 lb/ft (API RP 7G, tables 8 and 9).

    Section: two rings in series; bore 9016.5 mm2, outside 13300.9 mm2, +3.9 % EA, +4.0 % EI and GJ; buoyancy 0.81683 in 12 ppg.
    """
    pipe = item(PIPE)
    assert (pipe.od, pipe.id) == (pytest.approx(5 * INCH), pytest.approx(4.276 * INCH))
    joint = pipe.tool_joint
    assert (joint.od, joint.id, joint.length) == (6.625 * INCH, 2.75 * INCH, 17 * INCH)
    assert (pipe.grade, pipe.class_, pipe.remaining_wall) == ("S-135", "premium", 0.8)
    assert pipe.yield_strength == pytest.approx(135 * KSI)
    assert pipe.joint_length == pytest.approx(31 * 0.3048)
    assert pipe.contact_od == joint.od
    s = tubular_section(pipe)
    assert s.mass == pytest.approx(33.632, abs=1e-3)
    assert 1e6 * s.bore_area == pytest.approx(9016.5, abs=0.05)
    assert 1e6 * s.outer_area == pytest.approx(13300.9, abs=0.05)
    area, moment = ring(5 * INCH, 4.276 * INCH)
    young, shear = 206e9, 206e9 / 2.6
    assert s.axial_stiffness / (young * area) == pytest.approx(1.039, abs=5e-4)
    assert s.bending_stiffness / (young * moment) == pytest.approx(1.040, abs=5e-4)
    assert s.torsional_stiffness / (shear * 2 * moment) == pytest.approx(1.040, abs=5e-4)
    mud = 12 * 0.45359237 / 0.003785411784
    buoyed = s.mass + mud * s.bore_area - mud * s.outer_area
    assert buoyed / s.mass == pytest.approx(0.81683, abs=1e-5)
    assert s.worn_diameter == pytest.approx(4.855 * INCH, abs=1e-3 * INCH)
    f = 17 / 372
    metal = (1 - f) * area + f * ring(6.625 * INCH, 2.75 * INCH)[0]
    polar = (1 - f) * 2 * moment + f * 2 * ring(6.625 * INCH, 2.75 * INCH)[1]
    assert s.polar_inertia == pytest.approx(polar * s.mass / metal)


def test_keys_win_over_the_reference() -> None:
    pipe = item(PIPE, tool_joint={"od": "6.5 in"}, yield_strength="120 ksi", range=3, stiffness="body")
    pipe_class = item(PIPE, **{"class": "class_2"})
    assert pipe.tool_joint.od == pytest.approx(6.5 * INCH)
    assert pipe.tool_joint.id == pytest.approx(2.75 * INCH)
    assert (pipe.grade, pipe.yield_strength) == (None, pytest.approx(120 * KSI))
    assert pipe.joint_length == pytest.approx(44 * 0.3048)
    s = tubular_section(pipe)
    assert s.axial_stiffness == pytest.approx(206e9 * ring(pipe.od, pipe.id)[0])
    # another tool joint than the row's: weight by the formula, a little less than 22.60 lb/ft
    assert 22.0 < pipe.adjusted_weight / LB_PER_FT < 22.6
    assert pipe_class.remaining_wall == 0.7
    assert item(PIPE, adjusted_weight="23.52 lb/ft").adjusted_weight == pytest.approx(23.52 * LB_PER_FT)
    assert item(PIPE, contact_on="body").contact_od == pytest.approx(5 * INCH)
    assert item(PIPE, remaining_wall=0.87).remaining_wall == 0.87


def test_by_nominal_weight() -> None:
    """od and nominal weight name the row as the text does; the grade selects the tool joint."""
    keys = {"od": "5 in", "nominal_weight": "19.50 lb/ft", "grade": "s135"}
    one = item({"kind": "drill_pipe", "length": 300.0} | keys)
    assert one == item(PIPE)


def test_by_dimensions() -> None:
    """Without a row: weight by the formula of API RP 7G, here computed by hand without upsets.

    w_tj = 0.222 L (D^2 - d^2) + 0.167 (D^3 - D_te^3) - 0.501 d^2 (D - D_te).
    """
    pipe = item(BARE, tool_joint=JOINT)
    joint = 0.222 * 17 * (6.625**2 - 2.75**2) + 0.167 * (6.625**3 - 125) - 0.501 * 2.75**2 * 1.625
    plain = 3.3996 * math.pi / 4 * (25 - 4.276**2)
    weight = (29.4 * plain + joint) / (29.4 + (17 + 2.253 * 1.625) / 12)
    assert pipe.adjusted_weight == pytest.approx(weight * LB_PER_FT)
    assert (pipe.grade, pipe.yield_strength) == ("E-75", pytest.approx(75 * KSI))
    by_wall = {key: value for key, value in BARE.items() if key != "id"} | {"wall": "0.362 in"}
    assert item(by_wall, tool_joint=JOINT).id == pytest.approx(4.276 * INCH)


@each_row(
    ("given", "keys", "at", "want"),
    [
        (PIPE, {"pipe": "5in 18 S"}, "pipe", "there is no 5 in 18.00"),
        (PIPE, {"od": "5.2 in"}, "od", "within 1 %"),
        (PIPE, {"wall": "0.5 in"}, "wall", "within 1 %"),
        (PIPE, {"nominal_weight": "19.5 lb/ft"}, "nominal_weight", "not both"),
        (PIPE, {"grade": "S-153"}, "pipe", "a grade: E-75"),
        (PIPE, {"grade": "S", "yield_strength": "120 ksi"}, "yield_strength", "not both"),
        (PIPE, {"class": "class_3"}, "class", "new, premium, class_2"),
        (PIPE, {"class": "premium", "remaining_wall": 0.9}, "remaining_wall", "not both"),
        (PIPE, {"class": "premium", "override": True, "od": "4.9 in"}, "class", "override"),
        (PIPE, {"adjusted_weight": "17 lb/ft"}, "adjusted_weight", "plain tube"),
        (PIPE, {"adjusted_weight": "90 lb/ft"}, "adjusted_weight", "solid bar"),
        (PIPE, {"adjusted_weight": 22.6}, "adjusted_weight", "plain tube"),
        (PIPE, {"range": 3, "joint_length": 9.0}, "range", "not both"),
        (PIPE, {"material": {"density": 2800}}, "adjusted_weight", "for steel"),
        (PIPE, {"tool_joint": {"length": "130 in"}}, "tool_joint.length", "a third of a joint"),
        (PIPE, {"tool_joint": {"id": "4.5 in"}}, "tool_joint.id", "1/8 in above the bore"),
        (PIPE, {"tool_joint": {"od": "4.9 in"}}, "tool_joint.od", "at least the diameter of the tube"),
        (PIPE, {"tfa": 1}, "tfa", "one of these keys"),
        (BARE, {}, "tool_joint.od", "or a pipe from the catalogue"),
        (BARE, {"tool_joint": {"od": "6 in"}}, "tool_joint.id", "or a pipe from the catalogue"),
        ({"kind": "drill_pipe", "length": 9.0}, {"tool_joint": JOINT}, "od", "an outer diameter"),
        ({"kind": "drill_pipe", "length": 9.0, "od": "5 in"}, {"tool_joint": JOINT}, "id", "a wall"),
        ({"kind": "drill_pipe", "length": 9.0}, {"nominal_weight": "19.5 lb/ft"}, "od", "together with"),
        ({"kind": "hwdp", "length": 9.0}, {"pipe": "5in 49.3 NC38"}, "pipe", "NC50"),
        (
            {"kind": "hwdp", "length": 9.0, "od": "5 in", "id": "3 in"},
            {"tool_joint": {"od": "6.5 in", "id": "3 in", "length": "48 in"}},
            "adjusted_weight",
            "or a pipe from the catalogue",
        ),
        (
            {"kind": "hwdp", "length": 9.0, "pipe": "5in 49.3"},
            {"center_upset": {"od": "7 in", "length": "24 in"}},
            "center_upset.od",
            "between the tube",
        ),
        (COLLAR, {"class": "premium"}, "class", "one of these keys"),
        (COLLAR, {"id": "8 in"}, "id", "an inner diameter below the outer"),
        (COLLAR, {"wall": "2.5 in"}, "wall", "id or wall, not both"),
        (COLLAR, {"grade": "S-135"}, "grade", "a grade"),
        ({"kind": "drill_collar", "length": 9.0}, {"od": "8 in"}, "id", "a wall"),
        ({"kind": "coiled_tubing", "length": 9.0}, {"od": "2 in", "wall": "1 in"}, "wall", "half the outer"),
        (
            {"kind": "casing", "length": 9.0, "od": "7 in"},
            {"nominal_weight": "28 lb/ft"},
            "nominal_weight",
            "there is no 7 in 28.00",
        ),
        ({"kind": "casing", "length": 9.0}, {"nominal_weight": "29 lb/ft"}, "od", "together with"),
    ],
)
def test_refused(given: dict[str, Any], keys: dict[str, Any], at: str, want: str) -> None:
    error = refused(given | keys)
    assert error.at == f"string[0].{at}"
    assert want in error.want


def test_words_of_the_trade_are_answered() -> None:
    assert (
        refused({"kind": "pipe", "length": 9, "od": 0.1}, BIT | {"tfa": "0.3 in2"}).hint
        == "did you mean 'nozzle_area'?"
    )
    assert (
        refused({"kind": "pipe", "length": 9, "od": 0.1}, BIT | {"weight": "80 lb"}).hint
        == "a rigid item has the key 'mass' for all of it"
    )


# ---------------------------------------------------------------------- other pipe
def test_heavy_pipe_and_defaults() -> None:
    pipe = item({"kind": "hwdp", "length": 9.0, "pipe": "5in 49.3 NC50"})
    assert pipe.adjusted_weight == pytest.approx(49.3 * LB_PER_FT)
    assert pipe.yield_strength == pytest.approx(55 * KSI)
    assert pipe.contact_od == pytest.approx(6.5 * INCH)
    assert pipe.center_upset.od == pytest.approx(5.5 * INCH)


def test_collars() -> None:
    """8 x 3 in: 146.9 lb/ft, in 16 ppg 111.0 lb/ft (Mitchell Engineering BHA sheet, 1990: 110.9); I 197.1 in4, Z 49.27 in3.

    Z of a 6 x 4.276 in tube 15.74 in3, ratio 3.13 (the same sheet). Yield 110 ksi up to 6 7/8 in, 100 ksi from 7 in (API Spec 7).
    """
    collar = item(COLLAR)
    s = tubular_section(collar)
    assert s.mass / LB_PER_FT == pytest.approx(146.9, rel=2e-3)
    mud = 16 * 0.45359237 / 0.003785411784
    assert (s.mass - mud * (s.outer_area - s.bore_area)) / LB_PER_FT == pytest.approx(111.0, rel=2e-3)
    moment = ring(8.0, 3.0)[1]
    assert moment == pytest.approx(197.1, rel=1e-3)
    assert moment / 4 == pytest.approx(49.27, rel=1e-3)
    assert moment / 4 / (ring(6.0, 4.276)[1] / 3) == pytest.approx(3.13, rel=1e-3)
    assert s.bending_stiffness == pytest.approx(206e9 * moment * INCH**4)
    assert collar.yield_strength == pytest.approx(100 * KSI)
    assert item(COLLAR, od="6.875 in").yield_strength == pytest.approx(110 * KSI)
    assert item(COLLAR, od="7 in").yield_strength == pytest.approx(100 * KSI)
    spiral = tubular_section(item(COLLAR, spiral=True))
    assert spiral.mass == pytest.approx(0.96 * s.mass)
    assert spiral.bending_stiffness == s.bending_stiffness
    assert spiral.outer_area - spiral.bore_area == pytest.approx(0.96 * (s.outer_area - s.bore_area))
    assert item(COLLAR, spiral=True, spiral_weight_factor=0.94).adjusted_weight == pytest.approx(
        0.94 * s.mass
    )
    monel = item(COLLAR, nonmagnetic=True)
    assert (monel.material.density, monel.material.young) == (7860.0, 193e9)
    own = item(COLLAR, nonmagnetic=True, material={"young": "200 GPa"})
    assert (own.material.density, own.material.young) == (7860.0, 200e9)


def test_casing_and_coiled_tubing() -> None:
    """9 5/8 47.00: wall 0.472 in (API Spec 5CT); the nominal weight is a name, the weight is that of the tube."""
    casing = item(
        {"kind": "casing", "length": 500.0, "od": "9.625 in", "nominal_weight": "47 lb/ft", "grade": "P110"}
    )
    assert casing.id == pytest.approx(8.681 * INCH)
    assert casing.adjusted_weight == pytest.approx(7850 * ring(9.625 * INCH, 8.681 * INCH)[0])
    assert (casing.grade, casing.yield_strength) == ("P-110", pytest.approx(110 * KSI))
    tubing = item({"kind": "coiled_tubing", "length": 500.0, "od": "2 in", "wall": "0.156 in"})
    assert tubing.id == pytest.approx(1.688 * INCH)
    assert math.isnan(tubular_section(tubing).yield_strength)


# ---------------------------------------------------------------------- stabilizer, bit, rig
def test_stabilizer() -> None:
    """Mass: body, and 45 % of the ring that the blades stand in; blades in the middle."""
    found = case(PIPE, STABILIZER, BIT).string[1]
    body = ring(6.75 * INCH, 2.8125 * INCH)[0] * 2.0
    blades = 0.45 * ring(8.375 * INCH, 6.75 * INCH)[0] * 0.5
    assert found.mass == pytest.approx(7850 * (body + blades))
    assert found.touching == pytest.approx((0.75, 0.5))
    low = case(PIPE, STABILIZER | {"blade_position": 0.3}, BIT).string[1]
    assert low.touching == pytest.approx((1.45, 0.5))
    plain = case(PIPE, {k: STABILIZER[k] for k in ("kind", "length", "od", "id")}, BIT).string[1]
    assert plain.touching == (0.0, 2.0)


@each_row(
    ("gauge", "od"),
    [("full", 8.5), ("1/8 in under", 8.375), ("1/16 under", 8.4375), ("3 mm under", 8.5 - 3 / 25.4)],
)
def test_gauge(gauge: str, od: float) -> None:
    keys = {k: v for k, v in STABILIZER.items() if k != "od"}
    assert case(PIPE, keys | {"gauge": gauge}, BIT).string[1].od == pytest.approx(od * INCH)
    assert case(PIPE, keys | {"blade_od": "8.25 in"}, BIT).string[1].od == pytest.approx(8.25 * INCH)


def test_stabilizer_whose_body_bends() -> None:
    """Pipe, blades, pipe: the same length and, at the blades, the same metal."""
    stiff = case(PIPE, STABILIZER | {"blade_position": 0.5}, BIT)
    soft = case(PIPE, STABILIZER | {"blade_position": 0.5, "stiff": False}, BIT)
    assert [i.kind for i in soft.string] == ["drill_pipe", "pipe", "stabilizer", "pipe", "bit"]
    assert soft.string_length == pytest.approx(stiff.string_length)
    assert [i.length for i in soft.string[1:4]] == pytest.approx([1.25, 0.5, 0.25])
    masses = [7850 * ring(i.od, i.id)[0] * i.length for i in (soft.string[1], soft.string[3])]
    assert sum(masses) + soft.string[2].mass == pytest.approx(stiff.string[1].mass)
    # errors name the item of the file
    error = refused(PIPE, STABILIZER | {"stiff": False}, {"kind": "bit", "length": 0.3, "od": "8.5 in"}, BIT)
    assert error.at == "string[2].kind"


@each_row(
    ("keys", "at", "want"),
    [
        ({"od": "8.6 in"}, "od", "1/16 in above the bit"),
        ({"blade_length": 3.0}, "blade_length", "at most the length of the item"),
        ({"blade_position": 0.1}, "blade_position", "blades inside the item"),
        ({"body_od": "8.4 in"}, "od", "at least body_od"),
        ({"blade_od": "8.3 in"}, "blade_od", "one of od, blade_od and gauge"),
        ({"bypass_area": "20 in2"}, "bypass_area", "no bypass_area without a well"),
        ({"stiff": False, "mass": 100}, "mass", "no mass"),
        ({"bend": {"angle": "1 deg", "position": 1.0}}, "bend.position", "the upper end"),
    ],
)
def test_refused_stabilizers(keys: dict[str, Any], at: str, want: str) -> None:
    error = refused(PIPE, STABILIZER | keys, BIT)
    assert error.at == f"string[1].{at}"
    assert want in error.want


def test_stabilizers_without_a_diameter() -> None:
    keys = {"kind": "stabilizer", "length": 1.0}
    assert "blade_od or gauge" in refused(PIPE, keys, BIT).want
    assert "full, or a size" in refused(PIPE, keys | {"gauge": "some"}, BIT).want
    assert "without a bit" in refused(PIPE, keys | {"gauge": "full"}).want


@each_row(
    ("nozzles", "area"),
    [
        ("3 x 12/32 in", 0.33134), ("3x12", 0.33134), ([12, 12, 12], 0.33134), ("2 x 12 + 1 x 12", 0.33134),
        (["2 x 12", 12], 0.33134), ("2 x 12/32 in + 12/32", 0.33134), ([10, 8, 8], 0.17487),
        ("3 x 9.525 mm", 0.33134), ([0.009525] * 3, 0.33134),
    ],
)  # fmt: skip
def test_nozzles(nozzles: Any, area: float) -> None:
    """3 x 12/32 in: 0.33134 in2, 10/8/8: 0.17487 in2 (sum of pi d^2/4)."""
    bit = case(PIPE, BIT | {"nozzles": nozzles}).string[-1]
    assert bit.nozzle_area / INCH**2 == pytest.approx(area, rel=3e-5)


@each_row(
    "nozzles",
    [
        "", "3 x", "3 x 5", "3 x 50", "0 x 12", "99 x 12", "3 x 12 ft", "3 x 12.5", "x", [], [True], [5],
        [-12], {}, 12, "3 x 3 in",
    ],
)  # fmt: skip
def test_refused_nozzles(nozzles: Any) -> None:
    assert refused(PIPE, BIT | {"nozzles": nozzles}).at.startswith("string[1].nozzles")


def test_flow_area_of_a_bit() -> None:
    assert "not both" in refused(PIPE, BIT | {"nozzles": "3x12", "nozzle_area": "1 in2"}).want
    small = BIT | {"od": "2 in", "nozzles": "3 x 1.5 in"}
    assert "area of the bit" in refused({"kind": "pipe", "length": 9, "od": 0.05}, small).want


def test_rig() -> None:
    """A weight may be a force or a mass: 60 klb is 60,000 lb times standard gravity."""
    rig = case(PIPE, rig={"datum": "RKB", "block_weight": "60 klb", "max_hookload": "1000 klbf"}).rig
    assert rig.block_weight == pytest.approx(60e3 * 0.45359237 * G0)
    assert case(PIPE, rig={"block_weight": "60 klbf"}).rig.block_weight == pytest.approx(rig.block_weight)
    assert refused(PIPE, rig={"block_weight": 5e5, "max_hookload": 4e5}).at == "rig.max_hookload"
    assert refused(PIPE, rig={"block_weight": "60 m"}).at == "rig.block_weight"
    assert refused(PIPE, rig={"max_spp": 0}).at == "rig.max_spp"


# ---------------------------------------------------------------------- in the hole
def well(diameter: str | float, inclination: float = 0.0, depth: float = 500.0) -> dict[str, Any]:
    survey = {"md": [0, depth], "inclination": [inclination] * 2, "azimuth": [0, 0]}
    return {"survey": survey, "sections": [{"to": "end", "kind": "casing", "diameter": diameter}]}


def test_tool_joints_pass_the_hole() -> None:
    error = refused(PIPE, well=well("6.5 in"))
    assert error.at == "string[0].tool_joint.od"
    assert "less than the diameter of the casing" in error.want
    case(PIPE, well=well("6.7 in"))
    error = refused(
        PIPE | {"contact_on": "body"}, well=well("6.5 in")
    )  # touches with its body, and does not pass
    assert error.at == "string[0].tool_joint.od"


def test_bit_in_its_hole() -> None:
    string = (PIPE, BIT | {"length": 1.0})
    keys = {"well": well("8.6 in", depth=301.0), "bottom": "bit"}
    case(*string, **keys)
    error = refused(*string, well=well("9.5 in", depth=301.0), bottom="bit")
    assert error.at == "string[1].od"
    assert "90%" in error.want


def test_bypass_area() -> None:
    keys = {"well": well("8.5 in")}
    case(PIPE, STABILIZER | {"bypass_area": "15 in2"}, BIT, **keys)
    error = refused(PIPE, STABILIZER | {"bypass_area": "25 in2"}, BIT, **keys)
    assert "the hole around the body" in error.want


# ---------------------------------------------------------------------- written out
def test_written_case_reads_back() -> None:
    string = (
        PIPE, {"kind": "hwdp", "length": 90.0, "pipe": "5in 49.3 NC50"},
        COLLAR | {"od": "6.75 in", "nonmagnetic": True, "spiral": True}, STABILIZER | {"stiff": False},
        {"kind": "casing", "length": 9.0, "od": "7 in", "nominal_weight": "29 lb/ft"},
        {"kind": "coiled_tubing", "length": 9.0, "od": "2 in", "wall": "0.156 in", "grade": "CT80"},
        STABILIZER, BIT | {"nozzles": "3x12"},
    )  # fmt: skip
    from ruamel.yaml import YAML

    one = case(*string)
    for text in (one.to_yaml(), one.to_sourced_yaml()):
        again = Case(**YAML(typ="safe").load(text))
        assert again == one
        assert again.to_yaml() == one.to_yaml()
    text = one.to_sourced_yaml()
    assert "od: 0.127  # from: catalogue drill_pipe.csv line 19" in text
    assert "# pipe: 5in 19.50 S-135 NC50" in text
    for number, figures in one.figures.of_item.items():
        assert figures, number
        for figure in figures:
            assert figure.source
            assert f"# from: {figure.source}" in text
