"""Pipe of the trade in whole models: weight in mud, contact on tool joints and blades, kinks at a position
(manual: verif-field-string)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run, statics
from drillpetsc.analysis.loads.torque_drag.circulation import circulation
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.case.pipe.section import ring, tubular_section
from drillpetsc.model.drilling_model import build_model
from drillpetsc.model.mesh import _section, build_mesh
from drillpetsc.model.string_forces import estimate_forces
from drillpetsc.output import read_table
from drillpetsc.output.static_table import static_table
from drillpetsc.physics.fluid.rheology import Rheology, pressure_gradient

FOOT, INCH, LBF, G0 = 0.3048, 0.0254, 4.4482216152605, 9.80665
PPG = 0.45359237 / 0.003785411784
PIPE = {"kind": "drill_pipe", "pipe": "5in 19.50 S-135 NC50"}
JOINT_RADIUS = 0.5 * 6.625 * INCH


def well(depth: float, inclination: float, diameter: float | str, friction: float = 0.0) -> dict:
    """A straight hole."""
    return {
        "survey": {"md": [0, depth], "inclination": [inclination] * 2, "azimuth": [0, 0]},
        "sections": [{"to": "end", "kind": "open_hole", "diameter": diameter, "friction": friction}],
    }


def mud(density: float) -> dict:
    """Mud that does not give way, at rest."""
    rheology = {"model": "bingham", "yield_stress": 0.0, "plastic_viscosity": 0.02}
    return {"density": density, "rheology": rheology, "bulk_modulus": 1e14, "elastic_walls": False}


def test_hook_load_of_a_field_string():
    """8000 ft x 23.5 lb/ft, 900 ft x 58 lb/ft and 20 klb in 9.2 ppg: 223,653 lbf (inputs of drillingformulas.com, margin of overpull).

    The stretch of the string in the mud moves its lower end by 1 m, 3e-4 of the pressures' depth.
    """
    string = [
        PIPE | {"length": "8000 ft", "adjusted_weight": "23.5 lb/ft", "element_length": 50.0},
        {"kind": "hwdp", "pipe": "5 1/2 57.0", "length": "900 ft", "adjusted_weight": "58 lb/ft"},
        {
            "kind": "drill_collar",
            "od": "6.5 in",
            "id": "2.25 in",
            "length": "200 ft",
            "adjusted_weight": "100 lb/ft",
        },
    ]
    case = Case(
        string=string, top="clamped", well=well(3000.0, 0.0, "12.25 in"), contact="none", fluid=mud(9.2 * PPG)
    )
    model = build_model(case)
    load = static_summary(model, find_equilibrium(model))["hook_load"]
    assert load / LBF == pytest.approx(223_653, rel=2e-3)
    weight = sum(i.adjusted_weight * i.length for i in case.string) * G0
    assert load == pytest.approx(weight * (1 - 9.2 * PPG / 7850), rel=1e-4)


def test_weight_in_mud_of_each_kind():
    """m g (1 - rho/rho_s) for each item, spiral and nonmagnetic collars with their own densities."""
    string = [
        PIPE | {"length": 300.0},
        {"kind": "hwdp", "pipe": "5in 49.3", "length": 90.0},
        {"kind": "drill_collar", "od": "8 in", "id": "3 in", "length": 60.0, "spiral": True},
        {"kind": "drill_collar", "od": "6.75 in", "id": "2.8125 in", "length": 30.0, "nonmagnetic": True},
    ]
    case = Case(
        string=string, top="clamped", well=well(600.0, 0.0, "12.25 in"), contact="none", fluid=mud(1400)
    )
    model = build_model(case)
    load = static_summary(model, find_equilibrium(model))["hook_load"]
    expected = sum(i.adjusted_weight * i.length * (1 - 1400 / i.material.density) for i in case.string) * G0
    assert load == pytest.approx(expected, rel=3e-5)
    # the masses themselves, in lb/ft: API RP 7G (pipe), makers' tables (HWDP), section times density (collars)
    masses = [i.adjusted_weight / 0.45359237 * FOOT for i in case.string]
    assert masses == pytest.approx([22.60, 49.3, 0.96 * 146.9, 100.5 * 7860 / 7850], rel=2e-3)


def test_buckling_load_with_the_clearance_of_the_tool_joint():
    """5in 19.50 S-135 NC50 at 60 deg in an 8.5 in hole and 12 ppg, E 30e6 psi: 2 sqrt(EI w sin/r) = 49,328 lbf.

    API RP 7G, 550 sqrt(I w (65.5 - MW) sin/(D_h - D_t)): 49,097 lbf, 0.6 % less.
    """
    pipe = PIPE | {"length": 600.0, "stiffness": "body", "material": {"young": "30e6 psi"}}
    case = Case(string=[pipe], top="clamped", well=well(700.0, np.pi / 3, "8.5 in"), fluid=mud(12 * PPG))
    model = build_model(case)
    find_equilibrium(model)
    columns, values = static_table(model)
    table = dict(zip([c[0] for c in columns], values.T, strict=True))
    load = float(np.median(table["buckling_load"])) / LBF
    assert load == pytest.approx(49_328, rel=1e-3)
    assert load == pytest.approx(49_097, rel=6e-3)


@pytest.mark.parametrize("climbs", [False, True])
@pytest.mark.parametrize("contact_on", ["tool_joint", "body"])
def test_rotating_pipe_lies_on_its_tool_joints(contact_on, climbs):
    """A horizontal drill pipe rotates: torque mu W D_t/2, axis (hole - D_t)/2 from that of the hole; the soft string agrees.

    With friction across the pipe it climbs the wall by the angle of friction, and the wall carries W/sqrt(1 + mu^2).
    The top, held on the axis of the hole, carries some 13 m of the pipe.
    """
    length, hole = 3000.0, 0.2159
    pipe = PIPE | {"length": length, "contact_on": contact_on, "element_length": 25.0}
    case = Case(
        string=[pipe],
        top={"kind": "top_drive", "rotation": 6.0},
        well=well(length, np.pi / 2, hole, 0.25),
        contact={"stiffness": 1e8},
    )
    model = build_model(case)
    state = find_equilibrium(model, lateral_friction=climbs)
    assert state.lateral_fraction == climbs
    radius = JOINT_RADIUS if contact_on == "tool_joint" else 2.5 * INCH
    assert model.mesh.contact_diameter == pytest.approx(2 * radius)
    weight = case.string[0].adjusted_weight * G0
    torque = 0.25 * weight * length * radius
    summary = static_summary(model, state)
    carried = torque / np.hypot(1.0, 0.25) if climbs else torque
    assert summary["surface_torque"] == pytest.approx(carried, rel=5e-3)
    assert summary["soft_string"]["surface_torque"] == pytest.approx(torque, rel=1e-6)
    columns, values = static_table(model)
    table = dict(zip([c[0] for c in columns], values.T, strict=True))
    middle = np.hypot(table["offset_x"], table["offset_y"])[len(values) // 2]
    assert middle == pytest.approx(0.5 * hole - radius + weight / 1e8, rel=5e-3)


@pytest.mark.parametrize("position", [None, 0.5])
def test_stabilizer_touches_with_its_blades(position):
    """A stabilizer of 1 m with blades of 0.3 m is the middle support of a clamped beam.

    Each half of length l would sink by w l^4/24 EI and a force moves it by F l^3/12 EI (Gere and Goodno, tables H-1, H-2);
    the wall gives way by F over its stiffness times the length of the blades.
    """
    span, hole, length, blades, stiffness, g = 30.0, 0.2159, 1.0, 0.3, 1e8, 9.81
    pipe = {"kind": "pipe", "length": 0.5 * (span - length), "od": 0.127, "id": 0.1086, "element_length": 1.0}
    item = {"kind": "stabilizer", "length": length, "blade_od": 0.212, "blade_length": blades, "mass": 50.0}
    if position is not None:
        item["blade_position"] = position
    case = Case(
        string=[pipe, item | {"body_od": 0.17, "id": 0.07}, pipe],
        top="clamped",
        bottom="clamped",
        well=well(span, np.pi / 2, hole),
        contact={"stiffness": stiffness},
        gravity=g,
    )
    model = build_model(case)
    summary = static_summary(model, find_equilibrium(model))
    area, moment = ring(0.127, 0.1086)
    half, bending, weight = 0.5 * (span - length), 206e9 * moment, 7850 * area * g
    stand_off = 0.5 * (hole - 0.212)
    expected = (weight * half + 50 * g - 24 * bending / half**3 * stand_off) / (
        1 + 24 * bending / half**3 / (stiffness * blades)
    )
    side = summary["rigid_items"][0]
    assert side["side_force [N]"] == pytest.approx(expected, rel=5e-3)
    assert side["md [m]"] == pytest.approx(span / 2)


def test_blades_beside_the_middle_move_the_contact():
    """Blades at the lower end of a stabilizer of 2 m touch 0.85 m below its middle."""
    pipe = {"kind": "pipe", "length": 9.0, "od": 0.127, "id": 0.1086}
    item = {"kind": "stabilizer", "length": 2.0, "od": 0.2, "blade_length": 0.3, "blade_position": 0.15}
    case = Case(string=[pipe, item], top="clamped", well=well(20.0, 1.0, 0.2159))
    body = build_mesh(case).bodies[0]
    assert body.contact_above + 0.5 * body.contact_length == pytest.approx(1.85)
    assert body.end_radii == (0.0, 0.1)


@pytest.mark.parametrize("position", [None, 0.0, 2.5, 6.0, 9.9, 10.0])
def test_a_kink_at_a_position(position):
    """A weightless pipe of 10 m, clamped above: its end is off the axis by the kink's angle times its height above the end.

    The kink is distributed over 0.5 m about its position, or below the upper end: its middle counts.
    """
    angle = np.radians(1.0)
    bend = {"angle": angle, "tool_face": 0.0} | ({} if position is None else {"position": position})
    pipe = {"kind": "pipe", "od": 0.1, "id": 0.06, "length": 10.0, "element_length": 2.0, "bend": bend}
    case = Case(string=[pipe], top="clamped", gravity=0.0, initial={"inclination": 0.5})
    model = build_model(case)
    find_equilibrium(model)
    end = model.system.field("string.position")[-1]
    along = np.array([np.sin(0.5), 0.0, np.cos(0.5)])
    off = np.linalg.norm(end - (end @ along) * along)
    height = 9.75 if position is None else min(max(position, 0.25), 9.75)
    assert off == pytest.approx(np.sin(angle) * height, rel=1e-3)
    slope = model.system.field("string.tangent")[-1]
    assert np.arccos(slope @ along / np.linalg.norm(slope)) == pytest.approx(angle, rel=1e-3)


def test_round_collar_is_a_pipe():
    """A round collar has the section of the same tube."""
    keys = {"length": 30.0, "od": 0.2, "id": 0.07}
    collar = build_mesh(Case(string=[{"kind": "drill_collar"} | keys], top="clamped"))
    pipe = build_mesh(Case(string=[{"kind": "pipe"} | keys], top="clamped"))
    for name in ("axial_stiffness", "bending_stiffness", "torsional_stiffness", "mass", "polar_inertia"):
        assert getattr(collar, name) == pytest.approx(getattr(pipe, name), rel=1e-12)
    for name in ("outer_area", "bore_area", "contact_diameter", "worn_diameter"):
        assert getattr(collar, name) == pytest.approx(getattr(pipe, name), rel=1e-12)
    assert np.isnan(pipe.yield_strength).all() and np.isnan(pipe.joint_length).all()
    assert collar.joint_length == pytest.approx(31 * FOOT)


def test_arrays_of_the_mesh():
    case = Case(string=[PIPE | {"length": 100.0}], top="clamped")
    mesh, s = build_mesh(case), tubular_section(case.string[0])
    assert mesh.outer_diameter == pytest.approx(5 * INCH)
    assert mesh.contact_diameter == pytest.approx(6.625 * INCH)
    assert mesh.worn_diameter == pytest.approx(4.855 * INCH, abs=2e-5)
    assert mesh.yield_strength == pytest.approx(135e3 * LBF / INCH**2)
    assert mesh.mass == pytest.approx(s.mass)


def test_block_weight_is_reported(tmp_path):
    """hook_load_total is the hook load and the weight of the block; a hook load beyond the rig is reported; absent without a block."""
    string = [{"kind": "pipe", "length": 90.0, "od": 0.2, "id": 0.1}]
    keys = {"time": {"end": 0.01}, "output": {"history_every": 0.005}}
    top = {"kind": "top_drive", "rotation": 0.0}
    plain = run(Case(string=string, top=top, **keys), tmp_path / "plain", progress="silent")
    assert not any("hook_load_total" in name for name in read_table(plain.folder / "history.csv"))
    case = Case(string=string, top=top, rig={"block_weight": "50 kN", "max_hookload": "60 kN"}, **keys)
    whole = run(case, tmp_path / "rig", progress="silent")
    table = read_table(whole.folder / "history.csv")
    assert table["hook_load_total [N]"] == pytest.approx(table["hook_load [N]"] + 50e3, rel=1e-9)
    still = statics(case, tmp_path / "statics")
    summary = still.summary
    load, total = summary["hook_load"], summary["hook_load_total"]
    assert total == pytest.approx(load + 50e3)
    assert load == pytest.approx(7850 * ring(0.2, 0.1)[0] * 90 * G0, rel=1e-6)
    assert any("exceeds rig.max_hookload" in text for text in summary["warnings"])
    assert not (still.folder / "case.resolved.yaml").exists()  # nothing was filled in


@pytest.mark.parametrize(("viscosity", "flow"), [(0.5, 0.002), (0.02, 0.03)])
@pytest.mark.parametrize("formulation", ["mixed", "hermite"])
def test_friction_of_tube_and_tool_joints_in_series(viscosity, flow, formulation):
    """Loss in bore and annulus of a horizontal string (manual: eq-tubulars-friction, eq-tubulars-annulus).

    Laminar: Hagen and Poiseuille, 128 mu Q/pi [(1 - f)/d^4 + f/d_t^4], and the narrow slot, 48 mu v/(D_w - D)^2; turbulent: the law of
    the program for tube and tool joint each.
    """
    length = 300.0
    case = Case(
        string=[PIPE | {"length": length}],
        top="clamped",
        hold_string=True,
        well=well(length, np.pi / 2, 0.3),
        fluid=mud(1200.0)
        | {
            "rheology": {
                "model": "bingham",
                "yield_stress": 0.0,
                "plastic_viscosity": viscosity,
                "law": "exact",
            },
            "flow_rate": flow,
            "formulation": formulation,
        },
    )
    model = build_model(case)
    summary = static_summary(model, find_equilibrium(model))
    loss = summary["pump_pressure"] - summary["bit_pressure"]
    f, bores = 17 / 372, (4.276 * INCH, 2.75 * INCH)
    speeds = [4 * flow / (np.pi * d**2) for d in bores]
    reynolds = [1200 * v * d / viscosity for v, d in zip(speeds, bores, strict=True)]
    if viscosity == 0.5:
        assert max(reynolds) < 1000
        gradients = [128 * viscosity * flow / (np.pi * d**4) for d in bores]
    else:
        assert min(reynolds) > 10_000
        law = Rheology.herschel_bulkley(viscosity, 1.0, 0.0, law="exact", shear_rate_eps=1e-3)
        gradients = [
            float(pressure_gradient(law, v, d, False, 1200.0)) for v, d in zip(speeds, bores, strict=True)
        ]
    expected = length * ((1 - f) * gradients[0] + f * gradients[1])
    assert loss == pytest.approx(expected, rel=2e-4)
    assert loss > 1.2 * length * gradients[0]
    outers = (5 * INCH, 6.625 * INCH)
    speeds = [4 * flow / (np.pi * (0.3**2 - d**2)) for d in outers]
    if viscosity == 0.5:
        gradients = [48 * viscosity * v / (0.3 - d) ** 2 for v, d in zip(speeds, outers, strict=True)]
    else:
        law = Rheology.herschel_bulkley(viscosity, 1.0, 0.0, law="exact", shear_rate_eps=1e-3)
        gradients = [
            float(pressure_gradient(law, v, 0.3 - d, True, 1200.0))
            for v, d in zip(speeds, outers, strict=True)
        ]
    expected = length * ((1 - f) * gradients[0] + f * gradients[1])
    assert summary["bit_pressure"] == pytest.approx(expected, rel=2e-4)
    assert summary["bit_pressure"] > 1.01 * length * gradients[0]


@pytest.mark.parametrize("hole", [0.2, 0.3])
def test_lift_of_the_flow_past_tool_joints(hole):
    """Lift of the friction on tube and tool joints, shoulders included: pi/4 D_w (D dp + D_t dp_t) with the loss of each part.

    That is the balance of a slot, pi/4 D_w D dp for each part; the hook load falls by it and by the thrust of the jets, rho Q^2/A_n.
    The weight is that of the dimensions, so that mean areas are exact.
    """
    f, viscosity, flow, length = 17 / 372, 0.05, 0.01, 300.0
    outers, bores = (5 * INCH, 6.625 * INCH), (4.276 * INCH, 2.75 * INCH)
    areas = [np.pi / 4 * (D**2 - d**2) for D, d in zip(outers, bores, strict=True)]
    weight = 7850 * ((1 - f) * areas[0] + f * areas[1])
    bit = {"kind": "bit", "length": 0.0, "od": 0.19, "mass": 50, "nozzle_area": 400e-6}
    law = {"model": "bingham", "yield_stress": 0.0, "plastic_viscosity": viscosity, "law": "exact"}
    still, case = (
        Case(
            string=[PIPE | {"length": length, "adjusted_weight": weight}, bit],
            top="clamped",
            well=well(length + 1, 0.0, hole),
            contact=None,
            fluid=mud(1200.0) | {"rheology": law, "flow_rate": q},
        )
        for q in (0.0, flow)
    )
    speeds = [4 * flow / (np.pi * (hole**2 - d**2)) for d in outers]
    losses = [48 * viscosity * v / (hole - d) ** 2 for v, d in zip(speeds, outers, strict=True)]
    shares = (length * (1 - f), length * f)
    lift = np.pi / 4 * hole * sum(D * p * s for D, p, s in zip(outers, losses, shares, strict=True))
    found = circulation(case, length, flow, "flow_rate")
    assert found.below[0] == pytest.approx(lift, rel=1e-3)
    loads = [static_summary(m, find_equilibrium(m))["hook_load"] for m in map(build_model, (still, case))]
    assert loads[0] - loads[1] == pytest.approx(lift + 1200 * flow**2 / 400e-6, rel=1e-3)


def test_automatic_element_lengths_use_weight_and_clearance_of_tool_joints():
    """Forces that choose element lengths: m g (1 - rho/rho_s) per length, clearance to the tool joint."""
    case = Case(
        string=[PIPE | {"length": 300.0}], top="clamped", well=well(310.0, 0.5, "8.5 in"), fluid=mud(1300.0)
    )
    forces = estimate_forces(case, build_model(case).well, {0: _section(case.string[0], "field")}, None)
    assert forces.weight == pytest.approx(case.string[0].adjusted_weight * G0 * (1 - 1300 / 7850), rel=1e-9)
    assert forces.clearance == pytest.approx(0.5 * 8.5 * INCH - JOINT_RADIUS, rel=1e-9)
