"""Bending moment and shear force at the nodes, from the equilibrium of the elements (manual: verif-nodal-moments)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, statics
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from drillpetsc.output.measured.bending import across_hole, end_forces
from tests.helpers.motion import fixed, sampled, straight
from tests.helpers.wells import simple_well

OD, ID, LENGTH, YOUNG, DENSITY = 0.127, 0.1086, 12.0, 206e9, 7850.0
AREA, INERTIA = np.pi / 4 * (OD**2 - ID**2), np.pi / 64 * (OD**4 - ID**4)
BENDING = YOUNG * INERTIA
G = 1e-3  # so small that the beam hardly bends: closed forms of small deflections hold
WEIGHT = DENSITY * AREA * G
LEVEL = {"inclination": 0.5 * np.pi}


def pipe(*lengths: float) -> list[dict]:
    return [
        {
            "kind": "pipe",
            "length": x,
            "od": OD,
            "id": ID,
            "element_length": x,
            "material": {"young": YOUNG, "density": DENSITY},
        }
        for x in lengths
    ]


def beam(top, bottom, lengths=(2.0, 3.5, 6.5), **keys) -> Case:
    return Case(
        **{"string": pipe(*lengths), "top": top, "bottom": bottom, "gravity": G, "initial": LEVEL, **keys}
    )


@pytest.mark.parametrize("formulation", ["ancf", "quaternion"])
@pytest.mark.parametrize(
    ("ends", "at_left"), [("pinned", 0.0), ("clamped", -1.0 / 12.0)], ids=["pinned", "clamped"]
)
def test_uniform_load_is_exact_at_the_nodes(ends, at_left, formulation):
    """Level beam under its weight w on three unequal elements: M = M_0 + w x (L - x)/2 with M_0 = 0 or -w L^2/12, and
    V = w (L/2 - x) (Gere and Goodno, Mechanics of Materials, tables H-2 and H-4), at each node to rounding; the
    curvature of the cubic is off by w h^2/12.  The beam sags, so the moment bends it upwards between the supports."""
    model = build_model(beam(ends, ends, beam={"formulation": formulation}))
    find_equilibrium(model)
    found, x = end_forces(model), model.mesh.node_depth
    moment = at_left * WEIGHT * LENGTH**2 + 0.5 * WEIGHT * x * (LENGTH - x)
    shear = WEIGHT * (0.5 * LENGTH - x)
    nodes = np.column_stack([np.arange(3), np.arange(1, 4)])
    scale = WEIGHT * LENGTH
    # the high side is up (z points down); what lies to the right of a place pushes what lies to the left
    assert across_hole(model, found.towards_bend)[..., 0] == pytest.approx(
        moment[nodes], abs=1e-6 * scale * LENGTH
    )
    assert found.moment_size == pytest.approx(np.abs(moment)[nodes], abs=1e-6 * scale * LENGTH)
    assert np.abs(across_hole(model, found.towards_bend)[..., 1]).max() < 1e-6 * scale * LENGTH
    assert across_hole(model, found.shear)[..., 0] == pytest.approx(-shear[nodes], abs=1e-6 * scale)


def clamped_under_tension(elements: int, formulation: str) -> float:
    """Relative error of the moments at the clamped ends; the beam does not stretch."""
    tension, length = 1e5, 30.0
    bar = {
        "kind": "beam",
        "length": length,
        "axial_stiffness": 1e13,
        "bending_stiffness": BENDING,
        "torsional_stiffness": BENDING,
        "mass": 1.0,
        "polar_inertia": 1.0,
        "element_length": length / elements,
    }
    top = {"kind": "top_drive", "force": tension}
    model = build_model(beam(top, "clamped", string=[bar], beam={"formulation": formulation}))
    find_equilibrium(model)
    k = np.sqrt(tension / BENDING)
    x = 0.5 * length * k
    exact = G / k**2 * (x / np.tanh(x) - 1)
    return float(np.abs(end_forces(model).moment_size[[0, -1], [0, 1]] / exact - 1).max())


@pytest.mark.parametrize("formulation", ["ancf", "quaternion"])
def test_order_under_tension(formulation):
    """Level beam clamped at both ends under its weight and a tension, k L = 7.3: moment at the ends (w/k^2) ((kL/2)
    coth(kL/2) - 1), k^2 = T/EI (Roark's Formulas for Stress and Strain, beams under axial tension), of fourth
    order in the element length.  That of the interpolation is off by (k h)^2/12, of second order."""
    errors = [clamped_under_tension(n, formulation) for n in (6, 12, 24)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders == pytest.approx(4.0, abs=0.35)
    assert errors[-1] < 2e-4


def test_moment_beside_a_rigid_item():
    """A level cantilever with a rigid item in it, a force F at the tip: M = F times the distance to the tip at all four ends
    beside the item, shear F (equilibrium)."""
    body = {"kind": "body", "length": 1.5, "od": 0.16, "id": 0.0714, "mass": 1.0}
    case = beam(
        "clamped",
        {"kind": "force", "force": [0.0, 0.3, 0.0]},
        string=[*pipe(2.0, 3.0), body, *pipe(4.0)],
        gravity=0.0,
    )
    model = build_model(case)
    find_equilibrium(model)
    found, mesh = end_forces(model), model.mesh
    arm = mesh.total_length - np.column_stack([mesh.upper, mesh.lower])
    assert found.moment_size == pytest.approx(0.3 * arm, abs=1e-7)
    assert across_hole(model, found.towards_bend)[..., 1] == pytest.approx(
        0.3 * arm, abs=1e-7
    )  # east is right
    assert across_hole(model, found.shear)[..., 1] == pytest.approx(np.full((3, 2), 0.3), abs=1e-8)


@pytest.mark.parametrize("law", [{}, {"formulation": "hermite"}], ids=["mixed", "hermite"])
def test_mud_is_a_distributed_load(law):
    """Clamped level pipe with a rigid item, still mud in the bore and around: w = (rho_s - rho) A g downwards, the item's weight
    less that of the mud that it displaces.  Over each element, and over the item, forces and moments balance: N_2 - N_1 = -w h,
    M_2 - M_1 = -(r_2 - r_1) x N_2 - h/2 (r_2 - r_1) x w."""
    rho = 1400.0
    body = {"kind": "body", "length": 1.5, "od": OD, "id": ID, "mass": DENSITY * AREA * 1.5}
    case = Case(
        string=[*pipe(2.0, 3.0), body, *pipe(4.0)],
        top="clamped",
        bottom="clamped",
        well=simple_well(20.0, 0.16, 0.5 * np.pi, friction=0.0),
        gravity=9.81,
        fluid={
            "density": rho,
            "bulk_modulus": 1e14,
            "rheology": {"model": "newtonian", "viscosity": 0.02},
            **law,
        },
    )
    model = build_model(case)
    find_equilibrium(model)
    found, mesh = end_forces(model), model.mesh
    down = (DENSITY - rho) * AREA * 9.81 * np.array([0.0, 0.0, 1.0])
    r = model.system.field("string.position")
    upper, lower = r[:-1].copy(), r[1:]
    upper[2] += 1.5 * found.tangent[2, 0]
    pushed = model.contact.element_results(model.system.assembly)[0][:, 0]
    for e, h in enumerate(mesh.length):
        if pushed[e]:  # the wall holds it too
            continue
        d = lower[e] - upper[e]
        assert found.force[e, 1] - found.force[e, 0] == pytest.approx(-down * h, abs=2e-4 * down[2] * h)
        turn = -np.cross(d, found.force[e, 1]) - 0.5 * h * np.cross(d, down)
        assert found.moment[e, 1] - found.moment[e, 0] == pytest.approx(turn, abs=2e-3 * down[2] * h**2)
    assert not pushed[1:].any() or not pushed[:2].any()
    item = upper[2] - lower[1]
    assert found.force[2, 0] - found.force[1, 1] == pytest.approx(-down * 1.5, abs=2e-4 * down[2] * 1.5)
    turn = -np.cross(item, found.force[2, 0]) - 0.75 * np.cross(item, down)
    assert found.moment[2, 0] - found.moment[1, 1] == pytest.approx(turn, abs=2e-2 * down[2])


def test_inertia_is_a_distributed_load():
    """A pinned level beam, let go from rest without stress: M(L/2, t) = w L^2/8 - sum 4 w L^2/(n^3 pi^3) sin(n pi/2) cos(w_n t),
    w_n = n^2 pi^2 sqrt(EI/(m L^4)) (modal sum, Timoshenko, Vibration Problems in Engineering, section 53), on six elements;
    BDF2 damps the higher modes, so within 2 % of the largest value."""
    first = np.pi**2 / LENGTH**2 * np.sqrt(BENDING / (DENSITY * AREA))
    end = 1.3 * np.pi / first
    model = straight(string=pipe(*[2.0] * 6), top="pinned", bottom="pinned", gravity=G, initial=LEVEL)
    rows = sampled(
        model.system,
        end,
        lambda system: across_hole(model, end_forces(model).towards_bend)[3, 0, 0],
        **fixed(end / 800),
    )
    n = np.arange(1, 60, 2)
    waves = np.cos(np.outer(rows[:, 0], n**2 * first)) @ (np.sin(0.5 * n * np.pi) / n**3)
    exact = WEIGHT * LENGTH**2 * (1 / 8 - 4 / np.pi**3 * waves)
    assert np.abs(rows[:, 1] - exact).max() < 2e-2 * exact.max()


def test_line_load_and_point_load():
    """Pinned weightless beam, f N/m to the right over its lower half and P in the middle: M(x) by statics (equilibrium of the
    part above), at the nodes of three elements, and of six."""
    for lengths in ((2.0, 4.0, 6.0), (2.0,) * 6):
        f, force = 0.02, 0.1
        model = build_model(
            beam(
                "pinned",
                "pinned",
                lengths,
                gravity=0.0,
                loads=[
                    {"from": 6.0, "to": 12.0, "force": [0.0, f, 0.0]},
                    {"at": 6.0, "force": [0.0, force, 0.0]},
                ],
            )
        )
        find_equilibrium(model)
        left = f * 6.0 * 3.0 / LENGTH + 0.5 * force
        x = np.column_stack([model.mesh.upper, model.mesh.lower])
        past = np.maximum(x - 6.0, 0.0)
        exact = left * x - force * past - 0.5 * f * past**2
        found = across_hole(model, end_forces(model).towards_bend)[..., 1]
        assert found == pytest.approx(-exact, abs=1e-6)


def test_columns_of_statics(tmp_path):
    """A string in a hole that builds bends to the high side: M = EI times the dogleg away from the ends; the columns at the
    nodes agree with the ends of the elements."""
    rate = np.radians(3.0) / 30.0
    md = np.arange(0.0, 301.0, 30.0)
    case = Case(
        string=[{**pipe(240.0)[0], "element_length": 2.0}],
        well={
            "survey": {"md": list(md), "inclination": list(rate * md + 0.2), "azimuth": [0.7] * len(md)},
            "sections": [{"to": 300.0, "kind": "open_hole", "diameter": OD + 1e-3, "friction": 0.2}],
        },
        top={"kind": "top_drive"},
        gravity=9.81,
    )
    table = read_table(statics(case, tmp_path / "run").folder / "statics.csv")
    middle = (table["md [m]"] > 60) & (table["md [m]"] < 200)
    assert table["bending_moment_x [N m]"][middle].mean() == pytest.approx(BENDING * rate, rel=2e-2)
    assert np.abs(table["bending_moment_y [N m]"][middle]).max() < 1e-3 * BENDING * rate
    size = np.hypot(table["bending_moment_x [N m]"], table["bending_moment_y [N m]"])
    assert size[1:-1] == pytest.approx(table["bending_moment [N m]"][1:-1], rel=1e-3)


def test_twist_and_travel(tmp_path):
    """A hanging pipe of two sizes, a torque at its lower end: the twist from the top is M x/GJ of each size, and the top that is
    held does not travel.  Held at its lower end and pulled at the top with P instead, the top travels up by the stretch
    (P L - rho A g L^2/2)/EA."""
    moment, length = 2e3, 200.0
    small = {**pipe(100.0)[0], "element_length": 10.0}
    thick = {**small, "od": 0.2, "id": 0.1}
    hung = {"top": {"kind": "top_drive"}, "bottom": {"kind": "force", "moment": [0.0, 0.0, moment]}}
    result = statics(Case(string=[small, thick], gravity=9.81, **hung), tmp_path / "twist")
    table = read_table(result.folder / "statics.csv")
    polar = [np.pi / 32 * (p["od"] ** 4 - p["id"] ** 4) for p in (small, thick)]
    angles = np.cumsum([0.0, *(moment * 100.0 * 2.6 / (YOUNG * j) for j in polar)])
    exact = np.interp(table["md [m]"], [0.0, 100.0, length], angles)
    assert np.abs(table["twist_angle [rad]"]) == pytest.approx(exact, rel=1e-6, abs=1e-9)
    assert np.abs(exact[-1]) == pytest.approx(result.summary["twist"], rel=1e-9)
    assert result.summary["top_travel"] == pytest.approx(0.0, abs=1e-9)
    pull = 3e5
    pulled = Case(
        string=[{**small, "length": length}],
        top={"kind": "top_drive", "force": pull},
        bottom="pinned",
        gravity=9.81,
    )
    travel = statics(pulled, tmp_path / "pull").summary["top_travel"]
    stretch = (pull * length - 0.5 * DENSITY * AREA * 9.81 * length**2) / (YOUNG * AREA)
    assert travel == pytest.approx(-stretch, rel=1e-3)
