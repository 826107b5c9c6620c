"""Statics of the string in its hole: contact, torque and drag, buckling (manual:
sec-verif-statics-torque-drag, sec-verif-buckling).

Unless stated: drill pipe of 127 x 108.6 mm of 242 N/m in a hole of 215.9 mm.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from drillpetsc import Case, run
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.analysis.statics.relaxation import come_to_rest
from drillpetsc.case import load_case
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_frame, read_series
from drillpetsc.output.static_table import static_table
from drillpetsc.solvers.static.static_newton import Equilibrium, StaticNewton
from tests.helpers.bit_models import DRAG, drilling
from tests.helpers.buckling import buckling_load

AREA, BENDING = 3.4047325e-3, 1.2240289e6  # [m2], [N m2]
WEIGHT, CLEARANCE, CONTACT_RADIUS = 242.0, 0.04445, 0.0635  # [N/m], [m], [m]
PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086, "material": {"density": WEIGHT / 9.81 / AREA}}
CASES = Path(__file__).parents[2] / "cases" / "verification"
HOIST, LOWER, ROTATE = (-1.0, 0.0), (1.0, 0.0), (0.0, 1.0)
BUILD_RADIUS = 30 / np.radians(5)  # 5 deg/30 m


def hole(md, inclination, friction: float = 0.0):
    """A hole of 215.9 mm in one vertical plane; inclination [deg]."""
    survey = {"md": list(md), "inclination": list(np.radians(inclination)), "azimuth": [0.0] * len(md)}
    return {
        "survey": survey,
        "sections": [{"to": md[-1], "kind": "open_hole", "diameter": 0.2159, "friction": friction}],
    }


def string_in(well, item=PIPE, element_length: float = 10.0, **keys) -> Case:
    """One item over the whole hole below a top drive."""
    whole = {**item, "length": well["survey"]["md"][-1], "element_length": element_length}
    return Case(
        **{
            "well": well,
            "string": [whole],
            "top": {"kind": "top_drive"},
            "bottom": "free",
            "gravity": 9.81,
            **keys,
        }
    )


def solved(case: Case, motion=(0.0, 0.0), lateral_friction: bool = False):
    model = build_model(case)
    state = find_equilibrium(model, motion, lateral_friction)
    assert state.equilibrium.residual < 1e-6 * WEIGHT * model.mesh.total_length
    return model, state, static_summary(model, state)


# ---------------------------------------------------------------------- contact
@pytest.mark.parametrize("points", [2, 3, 5, 9])
def test_penetration_does_not_depend_on_the_number_of_points(points):
    """Pipe at rest on the low side, 10 m elements, k' = 1e6: penetration w/k' = 2.42e-4 m within 0.1 %
    (manual: verif-contact-quadrature)."""
    case = string_in(
        hole([0.0, 100.0], [90.0, 90.0]), contact={"stiffness": 1e6, "points_per_element": points}
    )
    model, _, _ = solved(case)
    cells, _ = model.contact.element_results(model.system.assembly)
    assert cells[3:7, 4] == pytest.approx(WEIGHT / 1e6, rel=1e-3)
    assert cells[3:7, 0] / 10 == pytest.approx(WEIGHT, rel=1e-3)


@pytest.mark.parametrize("elements", [2, 4])
@pytest.mark.parametrize("points", [1, 2, 4])
def test_tip_that_rests_on_the_wall(elements, points, tmp_path):
    """Collar of 10 m clamped along the axis of a level hole: its tip sags to the wall, c = 54.25 mm below the
    axis, with a force R = 3 EI/L^3 (w L^4/8EI - c) (propped cantilever; Gere and Goodno, Mechanics of
    Materials; manual: verif-tip-on-wall).

    With c > w L^4/72EI = 24 mm only the tip touches the wall. Its weight in Radau's rule of m points is
    1/m^2, so its penetration is m^2 R/(k' l), l the element length.
    """
    od, bore, length = 0.1715, 0.0714, 10.0
    area, second = np.pi / 4 * (od**2 - bore**2), np.pi / 64 * (od**4 - bore**4)
    bending, load, clearance = 206e9 * second, 7850 * area * 9.81, 0.5 * (0.28 - od)
    collar = {"kind": "pipe", "length": length, "od": od, "id": bore, "element_length": length / elements}
    well = hole([0.0, 20.0], [90.0, 90.0])
    well["sections"][0]["diameter"] = 0.28
    case = Case(
        well=well,
        string=[collar],
        top={"kind": "clamped"},
        bottom="free",
        gravity=9.81,
        material={"young": 206e9, "density": 7850.0, "damping": {"mass": 20.0}},
        contact={"points_per_element": points},
        initial={"from": "straight"},
        time={"end": 3.0},
        output={"field_every": 3.0},
    )
    frame = read_frame(read_series(run(case, tmp_path / "run", progress="silent").folder)[-1][1])
    down, contact = -frame.point_data["offset_x [m]"], frame.point_data["contact_force [N/m]"]
    force = 3 * bending / length**3 * (load * length**4 / (8 * bending) - clearance)
    assert abs(down[0]) < 1e-12
    assert down[-1] - clearance == pytest.approx(
        (points + 1) ** 2 * force / (1e8 * length / elements), abs=2e-5
    )
    assert contact[-1] * length / elements == pytest.approx(force, rel=0.01)


@pytest.mark.parametrize("friction", [0.1, 0.3])
def test_rotating_pipe_rests_beside_the_low_side(friction):
    """Contact at atan(mu) from the low side, on the side given by the rotation; N = W cos, torque = W sin R
    (manual: verif-rotating-shaft-on-wall)."""
    model, state, _ = solved(
        string_in(hole([0.0, 120.0], [90.0, 90.0], friction), element_length=4.0),
        ROTATE,
        lateral_friction=True,
    )
    assert not state.warnings
    angle = np.arctan(friction)
    middle = slice(12, 18)
    offset = model.system.field("string.position")[middle] - model.position[middle]
    # looking north along the hole, the lowest fibre of a clockwise turning pipe moves west and friction
    # pushes it east
    assert np.arctan2(offset[:, 1], offset[:, 2]) == pytest.approx(angle, abs=1e-3)
    cells, _ = model.contact.element_results(model.system.assembly)
    assert cells[middle, 0] / 4 == pytest.approx(WEIGHT * np.cos(angle), rel=1e-3)
    assert np.abs(cells[middle, 6]) / 4 == pytest.approx(WEIGHT * np.sin(angle) * CONTACT_RADIUS, rel=1e-3)


# ---------------------------------------------------------------------- torque and drag
def test_capstan():
    """Weightless string over 90 degrees, mu 0.25, 100 kN at the lower end: T = T0 exp(mu pi/2) = 148.097 kN
    within 0.5 % (manual: verif-capstan)."""
    md = np.linspace(0, BUILD_RADIUS * np.pi / 2, 19)
    case = string_in(
        hole(md, np.linspace(0, 90, 19), 0.25),
        element_length=5.0,
        gravity=0.0,
        bottom={"kind": "force", "force": [1e5, 0, 0]},
    )
    _, _, figures = solved(case, HOIST)
    assert 1e5 * np.exp(0.25 * np.pi / 2) == pytest.approx(148.097e3, rel=1e-5)
    assert figures["hook_load"] == pytest.approx(148.097e3, rel=2e-3)


INCLINE = [(HOIST, 183.873e3, 0.0), (LOWER, 58.127e3, 0.0), (ROTATE, 121.000e3, 3992.5)]


@pytest.mark.parametrize(("motion", "hook", "torque"), INCLINE)
def test_incline(motion, hook, torque):
    """60 degrees, 1000 m, mu 0.3: w L (cos I + mu sin I), w L (cos I - mu sin I), w L cos I and mu w L sin I
    R within 0.3 % (manual: verif-incline)."""
    model, state, figures = solved(string_in(hole([0.0, 1000.0], [60.0, 60.0], 0.3)), motion)
    assert figures["hook_load"] == pytest.approx(hook, rel=3e-4)
    assert figures["surface_torque"] == pytest.approx(torque, rel=1e-3)
    columns, table = static_table(model)
    names = [name for name, _ in columns]
    assert table[:, names.index("axial_force")] == pytest.approx(
        hook * (1 - table[:, 0] / 1000), abs=2e-3 * hook
    )
    assert table[:, names.index("torque")] == pytest.approx(
        torque * (1 - table[:, 0] / 1000), abs=max(1e-6, 3e-3 * torque)
    )
    assert table[5:-5, names.index("contact_force")] == pytest.approx(WEIGHT * np.sin(np.pi / 3), rel=1e-2)


def test_incline_rotating_pipe_beside_the_low_side():
    """The same with a pipe that may move up the wall: it rests at atan(mu), so the torque is smaller by
    cos(atan(mu)) (manual: verif-incline-free)."""
    _, _, figures = solved(string_in(hole([0.0, 1000.0], [60.0, 60.0], 0.3)), ROTATE, lateral_friction=True)
    assert figures["hook_load"] == pytest.approx(121.000e3, rel=1e-4)
    assert figures["surface_torque"] == pytest.approx(3992.5 / np.hypot(1, 0.3), rel=5e-3)


def test_incline_pulling_and_turning():
    """0.3 m/s with 60 rpm: slip components .600978/.799265, hook load 158.786 kN, torque 3191.0 N m within
    0.5 % (manual: verif-incline-pull-rotate)."""
    _, _, figures = solved(string_in(hole([0.0, 1000.0], [60.0, 60.0], 0.3)), (-0.3, 2 * np.pi))
    assert figures["hook_load"] == pytest.approx(158.786e3, rel=1e-3)
    assert figures["surface_torque"] == pytest.approx(3191.0, rel=2e-3)


BUILD = [(HOIST, 458.659e3, 0.0), (LOWER, 303.912e3, 0.0), (ROTATE, 372.048e3, 4864.3)]


@pytest.mark.parametrize(("motion", "hook", "torque"), BUILD)
def test_build_curve(motion, hook, torque):
    """0 to 60 degrees at 5 deg/30 m, mu 0.25, 300 kN at the lower end, within 1 % (manual:
    verif-build-curve)."""
    end = np.pi / 3
    md = np.linspace(0, BUILD_RADIUS * end, 13)
    bottom = {"kind": "force", "force": [3e5 * np.sin(end), 0, 3e5 * np.cos(end)]}
    _, _, figures = solved(
        string_in(hole(md, np.linspace(0, 60, 13), 0.25), element_length=5.0, bottom=bottom), motion
    )
    assert figures["hook_load"] == pytest.approx(hook, rel=2e-3)
    assert figures["surface_torque"] == pytest.approx(torque, rel=2e-3)


J_WELL = [(HOIST, 648.808e3, 0.0), (LOWER, 394.217e3, 0.0), (ROTATE, 495.548e3, 7884.9)]


@pytest.mark.parametrize(("motion", "hook", "torque"), J_WELL)
def test_j_well(motion, hook, torque):
    """1000 m vertical, the same curve, 1500 m of tangent, mu 0.25, no weight on bit, within 1 % (manual:
    verif-j-well)."""
    _, _, figures = solved(load_case(CASES / "p16-j-well.yaml"), motion)
    assert figures["hook_load"] == pytest.approx(hook, rel=5e-3)
    assert figures["surface_torque"] == pytest.approx(torque, rel=1e-2)


# ---------------------------------------------------------------------- stabiliserless collar
@pytest.mark.parametrize(
    ("stiffness", "element_length", "touches"), [(1e8, 1.0, (10.5, 12.8)), (1e9, 0.5, (11.5, 12.8))]
)
def test_pendulum_collar(stiffness, element_length, touches):
    """Collar of 1000 N/m in a straight 10 degree hole, bit hinged on the axis, no axial force: side force q
    L_T/2 = 1102.87 N with L_T = (24 EI r/q)^(1/4) = 12.7024 m, q = w sin I (manual: verif-pendulum-collar).

    Modelled by a horizontal hole and the weight w sin 10 deg, which avoids the axial force.
    """
    area = np.pi / 4 * (0.1715**2 - 0.0714**2)
    collar = {
        "kind": "pipe",
        "od": 0.1715,
        "id": 0.0714,
        "material": {"density": 1000 * np.sin(np.radians(10)) / 9.81 / area},
    }
    case = string_in(
        hole([0.0, 40.0], [90.0, 90.0]),
        collar,
        element_length,
        top={"kind": "top_drive", "force": 0.0},
        bottom="pinned",
        contact={"stiffness": stiffness},
    )
    model, _, _ = solved(case)
    assert abs(model.system.reaction("bottom.side_reaction_1")) == pytest.approx(1102.87, rel=1e-3)
    cells, _ = model.contact.element_results(model.system.assembly)
    last = np.flatnonzero(cells[:, 0] > 1.0)[-1]
    assert (
        touches[0] < 40 - model.mesh.lower[last] and 40 - model.mesh.upper[last] < touches[1] + element_length
    )


# ---------------------------------------------------------------------- buckling
DAWSON_PASLAY = 2 * np.sqrt(BENDING * WEIGHT / CLEARANCE)  # 163.267 kN
HORIZONTAL = hole([0.0, 200.0], [90.0, 90.0])


def pushed(force: float, imperfection: float = 0.0) -> Case:
    """200 m of drill pipe in a horizontal hole, compressed by ``force``; 50 elements of 4 m."""
    return string_in(
        HORIZONTAL,
        element_length=4.0,
        top={"kind": "top_drive", "force": -force},
        bottom="pinned",
        initial={"imperfection": imperfection},
    )


@pytest.mark.parametrize("element_length", [4.0, 2.0])
def test_sinusoidal_buckling_load_of_horizontal_pipe(element_length):
    """200 m of pipe hinged on the low side: the tangent gets a negative pivot at 163.508 kN (16 half waves;
    163.267 kN for an infinite pipe, 2 sqrt(EI w/r) of Dawson and Paslay), within 0.5 % for elements up to 4 m
    and k' = 1e8 (manual: verif-sinusoidal-buckling)."""
    assert DAWSON_PASLAY == pytest.approx(163.267e3, rel=1e-5)
    model = build_model(string_in(HORIZONTAL, element_length=element_length))
    assert buckling_load(model, CLEARANCE, DAWSON_PASLAY) == pytest.approx(163.508e3, rel=5e-3)


@pytest.mark.parametrize(
    ("share", "least", "most"), [(0.9, 0.0, 0.1), (1.1, 0.3, 1.5), (3.0, 1.6, np.pi + 0.1)]
)
def test_after_buckling(share, least, most):
    """Largest angle from the low side below 0.1 rad at 0.9 of the critical load, above 0.3 at 1.1; at 3 a
    helix (above pi/2 at least; loading changes the sinusoid to a helix at 2.83, Mitchell). No negative pivots
    at the end (manual: verif-post-buckling)."""
    case = pushed(share * DAWSON_PASLAY, imperfection=1e-2)
    rng = np.random.default_rng(5)
    loads = [
        {"at": float(4 * k), "force": [0.0, *(1e-2 * WEIGHT * 4 * rng.standard_normal(2))]}
        for k in range(2, 49)
    ]
    model, state, _ = solved(Case(**{**case_keys(case), "loads": loads}) if share < 1 else case)
    offset = model.system.field("string.position") - model.position
    angle = np.abs(np.arctan2(offset[:, 1], offset[:, 2]))[5:-5].max()
    assert least < angle < most
    assert state.equilibrium.negative_pivots == 0 and state.stable


def case_keys(case: Case) -> dict:
    return {
        name: getattr(case, name)
        for name in ("well", "string", "top", "bottom", "gravity", "initial", "contact")
    }


def test_contact_force_of_a_helix():
    """Weightless helix under 300 kN, 8 pitches, ends on the wall: mean contact force over the middle half r
    F^2/(4 EI) = 817.076 N/m, pitch 2 pi sqrt(2 EI/F) = 17.9486 m, bending moment r F/2 = 6667.5 N m
    (Lubinski; Mitchell): 2 %, 5 %, 3 % (manual: verif-helix-contact-force)."""
    force, elements = 3e5, 160
    pitch = 2 * np.pi * np.sqrt(2 * BENDING / force)
    length = 8 * pitch
    case = string_in(
        hole([0.0, length], [0.0, 0.0]),
        element_length=length / elements,
        gravity=0.0,
        bottom="pinned",
        top={"kind": "top_drive", "force": -force},
    )
    model = build_model(case)
    place_along_hole(model)
    system, depth = model.system, model.mesh.node_depth
    turn = 2 * np.pi * depth / pitch
    around = CLEARANCE * np.column_stack([np.cos(turn), np.sin(turn), np.zeros_like(turn)])
    slope = (
        CLEARANCE * 2 * np.pi / pitch * np.column_stack([-np.sin(turn), np.cos(turn), np.zeros_like(turn)])
    )
    system.set_field("string.position", model.position + around)
    system.set_field("string.tangent", model.tangent + slope)
    held = next(component for component in model.components if component.name == "held_end")
    for end, offset in ((model.top, around[0]), (held, around[-1])):
        end.anchor += end.prescribed()[0].directions[:, :3] @ offset
    model.contact.impose_sliding_direction(0.0, 0.0)
    solver = StaticNewton(system, clearance=CLEARANCE)
    come_to_rest(model, solver, Equilibrium())
    assert solver.negative_pivots() == 0
    middle = slice(elements // 4, 3 * elements // 4)
    cells, _ = model.contact.element_results(system.assembly)
    assert (cells[middle, 0] / model.mesh.length[middle]).mean() == pytest.approx(817.076, rel=2e-2)
    position = system.field("string.position")
    angle = np.unwrap(np.arctan2(position[:, 1], position[:, 0]))
    turns = (angle[middle.stop] - angle[middle.start]) / 2 / np.pi
    assert (depth[middle.stop] - depth[middle.start]) / abs(turns) == pytest.approx(17.9486, rel=5e-2)
    beam = model.beam.element_results(system.assembly)
    assert beam[middle, 7].mean() == pytest.approx(6667.5, rel=3e-2)


@pytest.mark.parametrize("multiple", [0.5, 1.0, 3.0, 10.0])
def test_weight_on_bit_in_a_vertical_hole(multiple):
    """Weight on bit up to ten times Lubinski's first critical load 1.94 (EI w^2)^(1/3), frictionless: stable,
    in contact with the wall (manual: verif-weight-on-bit-vertical)."""
    weight_on_bit = multiple * 1.94 * (BENDING * WEIGHT**2) ** (1 / 3)
    case = Case(
        well=hole([0.0, 500.0], [0.0, 0.0]),
        string=[
            {**PIPE, "length": 499.7, "element_length": 5.0},
            {"kind": "bit", "length": 0.3, "od": 0.2, "mass": 10.0},
        ],
        top={"kind": "top_drive"},
        bottom="bit",
        gravity=9.81,
        initial={"wob": weight_on_bit},
    )
    model, state, figures = solved(case)
    assert state.stable and figures["wob"] == pytest.approx(weight_on_bit, rel=1e-6)
    assert figures["hook_load"] == pytest.approx(WEIGHT * 499.7 + 98.1 - weight_on_bit, rel=1e-4)
    aside = np.linalg.norm(model.system.field("string.position")[:, :2], axis=1).max()
    assert aside < CLEARANCE + 1e-3
    assert (aside > 0.5 * CLEARANCE) == (multiple >= 1.0)


def test_vertical_string_on_bottom_with_bent_collars():
    """cases/vertical-2000m-dry.yaml: hook load = weight - 50 kN, torque at the bit mu W 2/3 R; the string
    stays in the hole (manual: verif-vertical-string-on-bottom)."""
    case = load_case(CASES.parent / "vertical-2000m-dry.yaml")
    model, state, figures = solved(case, (0.0, 8.4), lateral_friction=True)
    mesh = model.mesh
    weight = 9.80665 * (float(mesh.mass @ mesh.length) + sum(body.mass for body in mesh.bodies))
    assert figures["wob"] == pytest.approx(5e4, rel=1e-6)
    assert figures["hook_load"] == pytest.approx(weight - 5e4, rel=1e-4)
    assert figures["bit_torque"] == pytest.approx(0.3 * 5e4 * 2 / 3 * 0.2159 / 2, rel=1e-4)
    assert figures["surface_torque"] > figures["bit_torque"]
    assert (
        state.stable and figures["iterations"] < 50
    )  # 44: the guided bit starts with a friction that has no side force
    columns, table = static_table(model)
    at = dict(zip([name for name, _ in columns], table.T, strict=True))
    assert np.hypot(at["offset_x"], at["offset_y"]).max() < 0.1122 - 0.0635 + 1e-3


# ---------------------------------------------------------------------- long
@pytest.mark.parametrize("motion", [ROTATE, HOIST, LOWER])
@pytest.mark.parametrize("weight_on_bit", [0.0, 1e5])
def test_s_well_of_12_km(motion, weight_on_bit):
    """600 elements, fewer than 200 Newton iterations, hook load within 1.5 % of the soft string and torque
    within 2.5 %, residual below 1e-6 of the weight (``solved``); off bottom, and with 100 kN on the bit
    (manual: verif-deep-well-statics)."""
    case = load_case(CASES / "x01-s-well-12km.yaml")
    if not weight_on_bit:
        keys = {name: getattr(case, name) for name in ("well", "string", "top", "contact", "gravity")}
        case = Case(**keys, bottom="free")
    _, state, figures = solved(case, motion)
    assert figures["iterations"] < 200
    assert figures["hook_load"] == pytest.approx(figures["soft_string"]["hook_load"], rel=1.5e-2)
    assert figures["surface_torque"] == pytest.approx(figures["soft_string"]["surface_torque"], rel=2.5e-2)
    assert figures["wob"] == pytest.approx(weight_on_bit, rel=1e-6)
    assert state.stable


@pytest.mark.parametrize("formation", [None, {"drillability": 4e-8}])
@pytest.mark.parametrize("wob", [10.0, 100.0, 900.0, 5e3])
def test_a_small_weight_on_bit_is_met(wob, formation):
    """The onset of the bit's contact carries 250 N at no depth; asked: the weight to 0.1 %."""
    well = hole([0.0, 300.0], [0.0, 20.0], 0.2)
    made = Case(
        well=well,
        string=[
            {**PIPE, "length": 299.5, "element_length": 10.0},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0},
        ],
        top={"kind": "top_drive", "lowering": 0.1},
        bottom={"kind": "bit"},
        gravity=9.81,
        initial={"from": "statics", "wob": wob},
        **({"formation": formation} if formation else {}),
    )
    model = build_model(made)
    assert static_summary(model, find_equilibrium(model))["wob"] == pytest.approx(wob, rel=1e-3)


@pytest.mark.parametrize("law", [None, DRAG])
@pytest.mark.parametrize("stiffness", [1e8, 1e9, 1e11])
def test_a_stiff_bottom_under_a_drilling_bit_is_stable(stiffness, law):
    """A column of 100 m under its own 9.81 kN, its Euler load pi^2 EI/4 L^2 = 247 kN: no negative pivot.

    The unknowns of the rock were counted with the symmetric part of a one-sided coupling: one negative pivot from
    k^2/4 > (k + EA/h) 1e8 N/m on, with EA 1e10 N and elements of 10 m from 6.6e8 N/m on.
    """
    formation = {"drillability": 1e-8} | ({"bit_law": law} if law else {})
    model = drilling(
        formation, {"kind": "top_drive"}, length=100.0, elements=10, stiffness=stiffness, friction=0.0,
        gravity=9.81, initial={"from": "statics"},
    )  # fmt: skip
    state = find_equilibrium(model)
    assert (state.equilibrium.negative_pivots, state.stable, state.warnings) == (0, True, [])
    assert state.equilibrium.iterations <= 5
