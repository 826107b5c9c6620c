"""Side force of a rigid item: the resultant of the wall's forces and their couple (manual: verif-side-force)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.loads.limits.along_string import static_state
from drillpetsc.analysis.loads.limits.contacts import contact_rows, item_forces
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.fem.quantity import Sample
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output.measured.string_fields import StringFields

HOLE, STIFFNESS, G = 0.2159, 1e8, 9.81


def hole(length: float, inclination: float, friction: float = 0.0) -> dict:
    survey = {"md": [0.0, length], "inclination": [inclination] * 2, "azimuth": [0.0, 0.0]}
    section = {"to": length, "kind": "open_hole", "diameter": HOLE, "friction": friction}
    return {"survey": survey, "sections": [section]}


def items_of(model: DrillingModel, state) -> list[dict]:
    return static_summary(model, state)["rigid_items"]


@pytest.mark.parametrize(("axis", "key"), [(1, "couple_high [N m]"), (2, "couple_right [N m]")])
def test_a_pure_couple_has_no_side_force(axis, key):
    """A moment M = 5 kN m on a stabilizer of l = 1 m between two pipes of L = 14.5 m, without gravity.

    The stabilizer turns by theta about its middle.  Its end points, a share 1/6 of its length each (Lobatto's rule with three
    points), sink in by theta l/2 - c and push with N = (k l/6)(theta l/2 - c): the couple is N l, the side force zero.  Each
    pipe, clamped at its far end, takes 4 EI theta/L + 6 EI theta l/L^2 + 3 EI theta l^2/L^3 (Gere and Goodno, Mechanics of
    Materials, end moments of a beam whose end turns and moves).  The sum of the sizes, 2 N = 7.8 kN, was printed as side
    force.
    """
    moment, length, od = 5000.0, 1.0, 0.2149
    pipe = {"kind": "pipe", "length": 14.5, "od": 0.127, "id": 0.1086, "element_length": 0.5}
    case = Case(
        well=hole(30.0, np.pi / 2),
        string=[pipe, {"kind": "stabilizer", "length": length, "od": od, "mass": 50.0}, pipe],
        top="clamped",
        bottom="clamped",
        contact={"stiffness": STIFFNESS},
        gravity=0.0,
        loads=[{"at": 15.0, "moment": [moment * (k == axis) for k in range(3)]}],
    )
    model = build_model(case)
    (item,) = items_of(model, find_equilibrium(model))
    bending, L, clearance = 206e9 * np.pi / 64 * (0.127**4 - 0.1086**4), 14.5, 0.5 * (HOLE - od)
    pipes = 2 * bending * (4 / L + 6 * length / L**2 + 3 * length**2 / L**3)
    wall = STIFFNESS * length / 6  # of one end point
    theta = (moment + wall * clearance * length) / (pipes + 0.5 * wall * length**2)
    push = wall * (0.5 * theta * length - clearance)
    assert item["contact_force_sum [N]"] == pytest.approx(2 * push, rel=2e-3)
    assert item["side_force [N]"] < 0.01 * 2 * push
    assert item["side_couple [N m]"] == pytest.approx(push * length, rel=2e-3)
    # the hole points north: M east turns the lower end to the high side, M down to the right; the wall turns it back
    assert item[key] == pytest.approx(-push * length, rel=2e-3)


def test_a_stabilizer_that_lies_even_has_no_couple():
    """Between two pipes that lie alike in a level hole: the couple of the wall about its middle is zero."""
    pipe = {"kind": "pipe", "length": 49.5, "od": 0.127, "id": 0.1086, "element_length": 4.5}
    case = Case(
        well=hole(100.0, np.pi / 2),
        string=[pipe, {"kind": "stabilizer", "length": 1.0, "od": 0.2149, "mass": 500.0}, pipe],
        top="clamped",
        bottom="clamped",
        contact={"stiffness": STIFFNESS},
        gravity=G,
    )
    model = build_model(case)
    (item,) = items_of(model, find_equilibrium(model))
    assert item["side_force [N]"] > 300.0 * G
    assert item["side_couple [N m]"] < 1e-3 * item["side_force [N]"]


def three_stabilizers() -> Case:
    """A string with three stabilizers, hoisted off bottom in a straight hole of 45 degrees."""
    stabilizer = {"kind": "stabilizer", "length": 1.5, "od": 0.2127, "id": 0.0714, "mass": 300.0}
    collar = {"kind": "drill_collar", "od": 0.1715, "id": 0.0714}
    string = [{"kind": "pipe", "od": 0.127, "id": 0.1086, "length": 300.0}, collar | {"length": 27.0}]
    for length in (18.0, 9.0, 2.0):
        string += [stabilizer, collar | {"length": length}]
    string.append({"kind": "bit", "length": 0.3, "od": HOLE, "mass": 80.0})
    return Case(
        well=hole(400.0, np.pi / 4, friction=0.2),
        string=string,
        top={"kind": "top_drive"},
        contact={"stiffness": STIFFNESS},
        gravity=G,
    )


def test_side_forces_of_a_packed_assembly_balance_the_weight_and_the_shear():
    """Over all items the forces to the high side are the weight across the hole; that of the bit is its own weight across
    and the shear force of the collar above it.

    The bit touches at one point, so that the sum of its normal forces is their resultant.  It was 2.3 times that of a bit that stood
    askew between its ends.
    """
    model = build_model(three_stabilizers())
    motion = (-0.1, 0.0)
    state = find_equilibrium(model, motion, False)
    found, forces = static_state(model), item_forces(model)
    rows = contact_rows(model, found.nodes, found.tangent, forces)
    mass = float(model.mesh.mass @ model.mesh.length) + sum(b.mass for b in model.mesh.bodies)
    across = mass * G * np.sin(np.pi / 4)
    assert sum(row["side_high"] for row in rows) == pytest.approx(across, rel=2e-3)
    assert abs(sum(row["side_right"] for row in rows)) < 1e-3 * across
    bit, item = rows[-1], items_of(model, state)[-1]
    assert bit["side_high"] == pytest.approx(item["side_high [N]"], rel=1e-9)
    shear = StringFields(model, None).end_forces(Sample(model.system, 0.0)).shear_size[-1, 1]
    assert item["side_high [N]"] - 80.0 * G * np.sin(np.pi / 4) == pytest.approx(shear, rel=5e-3)
    assert item["contact_force_sum [N]"] == pytest.approx(item["side_force [N]"], rel=1e-3)
    assert item["bit_force_on_rock_high [N]"] == -item["side_high [N]"]
    assert item["side_force [N]"] == pytest.approx(
        item["side_high [N]"], rel=1e-2
    )  # it is hoisted: no friction across


def test_items_off_the_wall_have_no_force():
    """A hanging string in a vertical hole: all zeros and no division by them."""
    model = build_model(
        Case(
            well=hole(40.0, 0.0),
            string=[{"kind": "pipe", "od": 0.127, "id": 0.1086, "length": 30.0}, {"kind": "bit", "length": 0.3, "od": 0.2, "mass": 80.0}],
            top={"kind": "top_drive"},
            gravity=G,
        )
    )  # fmt: skip
    (item,) = items_of(model, find_equilibrium(model))
    assert all(value == 0 for key, value in item.items() if key not in ("name", "md [m]"))


def test_each_of_two_stabilizers_below_each_other_has_the_gap_of_its_own_hole():
    """They hang below one pipe in a vertical hole that widens from 0.2159 to 0.25 m beside the upper one."""
    widths = (100.3, 0.2159), (110.0, 0.25)
    stabilizer = {"kind": "stabilizer", "length": 1.0, "mass": 80.0}
    pipe = {"kind": "pipe", "od": 0.127, "id": 0.1086, "length": 100.0}
    case = Case(
        well=hole(110.0, 0.0)
        | {"sections": [{"to": to, "kind": "open_hole", "diameter": d, "friction": 0.0} for to, d in widths]},
        string=[pipe, stabilizer | {"od": 0.2}, stabilizer | {"od": 0.19}],
        top={"kind": "top_drive"},
        gravity=G,
    )
    model = build_model(case)
    find_equilibrium(model)
    found = static_state(model)
    gaps = [row["gap"] for row in contact_rows(model, found.nodes, found.tangent, item_forces(model))[1:]]
    assert gaps == pytest.approx([0.5 * (0.2159 - 0.2), 0.5 * (0.25 - 0.19)], rel=1e-6)
