"""Text references: grammar, and what bad ones are answered."""

from __future__ import annotations

import pytest

from drillpetsc.case.catalogue import Catalogue, find_heavy_pipe, find_pipe
from drillpetsc.case.catalogue.reference import ReferenceProblem
from drillpetsc.case.catalogue.sizes import inch_text, inches
from tests.helpers.tables import each_row

BUILT_IN = Catalogue.built_in()


@each_row(
    ("text", "value"),
    [
        ("5", 5.0), ("5in", 5.0), ('5"', 5.0), ("5 1/2", 5.5), ("5-1/2", 5.5), ("5-1/2 in", 5.5),
        ('2 3/8"', 2.375), ("127 mm", 5.0), ("6.75", 6.75), ("1/2 inch", 0.5), (".5", 0.5), ("x", None),
        ("5 x", None), ("5 1/0", None), ("5 m", None), ("", None), ("-5", None),
    ],
)  # fmt: skip
def test_sizes(text, value):
    assert inches(text) == (None if value is None else pytest.approx(value, rel=1e-12))


def test_size_text():
    assert [inch_text(v) for v in (5, 5.5, 0.4375, 4.276, 2.8125)] == [
        "5 in", "5 1/2 in", "7/16 in", "4.276 in", "2 13/16 in",
    ]  # fmt: skip


@each_row(
    ("text", "od", "wear"),
    [
        ("5in 19.50 S-135 NC50 premium", 6.625, "premium"),
        ("5in 19.50 s135 nc50", 6.625, None),
        ("5 19.50 S", 6.625, None),
        ('5" 19.5# premium NC50 S135', 6.625, "premium"),
        ("127 mm 19.5 lb/ft G-105 class 2", 6.5, "class_2"),
        ("5in 19.50 E-75 4 1/2 IF new", 6.375, "new"),
        ("5in 19.50 E 5 1/2 FH", 7.0, None),
        ("5in 19.50 E 5-1/2 FH", 7.0, None),
        ("5in 19.50 E XH", 6.375, None),
        ("5in 19.50 E XH NC50 IEU", 6.375, None),
        ("4 1/2 16.60 E XH", 6.25, None),
        ("4-1/2 16.60 EU", 6.375, None),
        ("4 1/2 16.55 EU NC50 class_2", 6.375, "class_2"),
        ("4 14.00 IU", 5.25, None),
        ("4in 14.00 4 IF", 6.0, None),
        ("4in 14.00 4 FH", 5.25, None),
        ("3 1/2 13.30 3 1/2 IF", 4.75, None),
        ("6 5/8 25.20 6 5/8 FH", 8.0, None),
        ("5 1/2 21.90 S-135 HT55", 7.0, None),
        ("4 14.00 XT39 S premium", 4.875, "premium"),
    ],
)
def test_good_references(text, od, wear):
    """Outer diameters of the tool joints: API RP 7G, tables 8 and 9, sheets of makers; names of connections: its interchange list."""
    choice = find_pipe(BUILT_IN, text)
    assert choice.joint is not None
    assert choice.joint["od"] == pytest.approx(od)
    assert choice.reference.wear == wear


@each_row(
    ("text", "want", "hint"),
    [
        ("", "5in 19.50", ""), ("premium", "SIZE WEIGHT", ""),
        ("5in", "a nominal weight", "16.25, 19.50, 25.60"),
        ("5in S-135", "a nominal weight", "16.25, 19.50, 25.60"),
        ("4.8in 19.50", "there is no 4.8 in", "5 in 16.25; 5 in 19.50; 5 in 25.60"),
        ("5in 18", "there is no 5 in 18.00", "weights of 5 in: 16.25, 19.50, 25.60 lb/ft"),
        ("5in 19.50", "NC50 6 3/8 in x 3 3/4 in and", "say the connection"),
        ("4 1/2 16.60 IEU", "4 1/2 FH", "say the connection"), ("5in 19.50 NC5O", "'NC5O'", "NC50"),
        ("5in 19.50 S-153", "'S-153'", "S135"), ("5in 19.50 premiun", "'premiun'", "premium"),
        ("5in 19.50 class 3", "class", "premium"),
        ("5in 19.50 NC50 5 1/2 FH", "NC50 and 5 1/2 FH do not agree", ""),
        ("5in 19.50 E S", "E-75 and S-135 do not agree", ""), ("5in 19.50 new premium", "one class", ""),
        ("4 14.00 S-135", "none for S-135", "tool_joint"), ("5in 19.50 S NC38", "with NC38", "S IEU NC50"),
        ("5in 16.25", "none for E-75", "give tool_joint"), ("5 1/2 21.90 S-135", "none for S-135", "S IEU HT55 7 in x 4 in"),
    ],
)  # fmt: skip
def test_bad_references(text, want, hint):
    with pytest.raises(ReferenceProblem) as caught:
        find_pipe(BUILT_IN, text)
    assert want in caught.value.want
    assert hint in caught.value.hint


def test_heavy_pipe():
    assert find_heavy_pipe(BUILT_IN, "5in 49.3 NC50")["tool_joint_od"] == 6.5
    assert find_heavy_pipe(BUILT_IN, "5in 50.1")["tool_joint_od"] == 6.625
    assert find_heavy_pipe(BUILT_IN, '3 1/2" 25.3# 3 1/2 IF')["connection"] == "NC38"
    for text, want in (
        ("5in 49.3 S-135", "no grade"),
        ("5in 49.3 premium", "no class"),
        ("5in 49.3 NC38", "a connection of this heavy-wall pipe: NC50"),
        ("5in 42", "there is no 5 in 42.00"),
    ):
        with pytest.raises(ReferenceProblem, match=want):
            find_heavy_pipe(BUILT_IN, text)
