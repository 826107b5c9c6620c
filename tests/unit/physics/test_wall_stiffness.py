"""Stiffness of the wall from the moduli of rock and steel (manual: sec-contact-physical)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.model.drilling_model import build_model
from drillpetsc.physics.contact import line_stiffness, ring_stiffness
from tests.helpers.tables import each_row

STEEL, HOLE = 206e9, 0.2159
#: section, load [N/m], secant stiffness [Pa] in rock of 5, 20 and 60 GPa and in casing, to two digits
TABLE = [
    ("pipe", 0.127, 0.1086, 1e4, (3.6e8, 4.4e8, 4.6e8, 4.7e8)),
    ("tool joint", 0.168, 0.0, 5e4, (1.7e9, 5.6e9, 1.3e10, 2.8e10)),
    ("collar", 0.1778, 0.0714, 1e4, (1.5e9, 5.0e9, 1.2e10, 2.5e10)),
    ("near-bit", 0.210, 0.0, 7e4, (2.4e9, 7.4e9, 1.7e10, 3.5e10)),
]
ROCK = 0.25


@each_row(("name", "outer", "inner", "load", "expected"), TABLE)
def test_secant_stiffness_at_a_load(name, outer, inner, load, expected):
    """Line contact in series with the ring of a tube: Johnson, Contact Mechanics, section 5.6, and Roark's thin ring; figures of
    an evaluation by hand, to 5 % (two digits)."""
    walls = [(5e9, ROCK), (20e9, ROCK), (60e9, ROCK), (STEEL, 0.3)]
    ring = float(ring_stiffness(outer, inner, STEEL))
    for (young, poisson), value in zip(walls, expected, strict=True):
        line = float(line_stiffness(load, 0.5 * outer, 0.5 * HOLE, STEEL, young, poisson))
        assert 1 / (1 / line + 1 / ring) == pytest.approx(value, rel=0.05)


def string_in(kind: str, young: float | None = None) -> Case:
    survey = {"md": [0.0, 100.0], "inclination": [np.pi / 2] * 2, "azimuth": [0.0, 0.0]}
    section = {"to": 100.0, "kind": kind, "diameter": HOLE, "friction": 0.0}
    more = {} if young is None else {"formation": {"drillability": 0, "young": young}}
    string = [
        {"kind": "pipe", "od": 0.127, "id": 0.1086, "length": 70.0},
        {"kind": "drill_collar", "od": 0.1778, "id": 0.0714, "length": 28.7},
        {"kind": "stabilizer", "od": 0.210, "length": 1.0, "mass": 200.0},
        {"kind": "bit", "od": HOLE, "length": 0.3, "mass": 50.0},
    ]
    return Case(
        well={"survey": survey, "sections": [section]},
        string=string,
        top={"kind": "top_drive"},
        bottom="bit",
        contact={"stiffness": "physical"},
        **more,
    )


@each_row(
    ("kind", "young", "column"),
    [("open_hole", None, 1), ("open_hole", 5e9, 0), ("open_hole", 60e9, 2), ("casing", None, 3)],
)
def test_each_part_of_a_string_has_its_stiffness(kind, young, column):
    """Pipe, collar and stabilizer of the table, in casing and in rock of the default and of a given modulus."""
    model = build_model(string_in(kind, young))
    contact = model.contact
    cells, bodies = (contact.law.stiffness * share for share in contact.hardness)
    assert cells[0] == pytest.approx(TABLE[0][4][column], rel=0.05)
    assert cells[-1] == pytest.approx(TABLE[2][4][column], rel=0.05)
    assert bodies[0] == pytest.approx(TABLE[3][4][column], rel=0.05)


def test_tool_joints_touch_over_their_length():
    """Tool joints twice as long on joints of the same length: twice the stiffness per length of pipe."""
    found = []
    for length in (0.3, 0.6):
        joint = {"od": 0.168, "id": 0.08, "length": length}
        pipe = {
            "kind": "drill_pipe",
            "od": 0.127,
            "id": 0.1086,
            "length": 98.0,
            "joint_length": 9.6,
            "tool_joint": joint,
        }
        case = string_in("open_hole")
        model = build_model(
            case.replace({"string": [pipe, {"kind": "bit", "od": HOLE, "length": 0.3, "mass": 50.0}]})
        )
        found.append(model.contact.law.stiffness * model.contact.hardness[0][0])
    assert found[1] == pytest.approx(2 * found[0], rel=1e-9)
    assert found[0] == pytest.approx(TABLE[1][4][1] * 0.3 / 9.6, rel=0.05)
