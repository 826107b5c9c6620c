"""Buoyancy in a whole model: hook load and tension with mud at rest and in motion (manual:
sec-mud-effective-tension, verif-buoyancy).

Drill pipe of 127 x 108.6 mm in a hole of 215.9 mm, mud of 1200 kg/m3, steel of 7850 kg/m3. ``stiff``: a beam
of axial stiffness 1e12 N without stretch, in rigid walls, for which closed forms hold to rounding.
"""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.statics.answer import static_summary
from drillpetsc.analysis.statics.equilibrium import StaticState
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output.static_table import static_table
from drillpetsc.physics.fluid.rheology import Rheology, wall_shear
from tests.helpers.wells import newtonian

G, LENGTH, MUD, STEEL = 9.81, 1000.0, 1200.0, 7850.0
OD, ID, HOLE = 0.127, 0.1086, 0.2159
OUTER, BORE, OPEN = (np.pi / 4 * d**2 for d in (OD, ID, HOLE))
METAL = OUTER - BORE
WEIGHT = STEEL * METAL * G * LENGTH  # 262.1933 kN
STIFF = 1e14  # bulk modulus [Pa] of a mud that does not give way
MUD_OF_TABLE = {
    "model": "herschel_bulkley",
    "law": "blend",
    "yield_stress": 3.0,
    "consistency": 0.3,
    "index": 0.75,
}  # manual: verif-steady-loop
PLUGGED = {"kind": "free", "plugged": True}


def piece(
    length: float = LENGTH, elements: int = 40, stiff: bool = True, od: float = OD, bore: float = ID
) -> dict:
    """One flexible item."""
    out = {"length": length, "od": od, "id": bore, "element_length": length / elements}
    if not stiff:
        return {"kind": "pipe", **out}
    mass = STEEL * np.pi / 4 * (od**2 - bore**2)
    inertia = np.pi / 64 * (od**4 - bore**4)
    return {
        "kind": "beam",
        "axial_stiffness": 1e12,
        "bending_stiffness": 206e9 * inertia,
        "torsional_stiffness": 1e6,
        "mass": mass,
        "polar_inertia": 0.1,
        **out,
    }


def bit(nozzles: float | None = None, **keys) -> dict:
    return {
        "kind": "bit",
        "length": 0.0,
        "od": 0.13,
        **({} if nozzles is None else {"nozzle_area": nozzles}),
        **keys,
    }


def straight_hole(inclination: float = 0.0, end: float = LENGTH + 20) -> dict:
    return {
        "survey": {"md": [0.0, end], "inclination": [inclination] * 2, "azimuth": [0.0, 0.0]},
        "sections": [{"to": end, "kind": "open_hole", "diameter": HOLE, "friction": 0.0}],
    }


def hung(
    string: list | None = None,
    modulus: float = STIFF,
    stiff: bool = True,
    fluid: dict | None = None,
    hole: dict | None = None,
    **keys,
) -> tuple[DrillingModel, StaticState, dict]:
    """DrillingModel, state and summary of a string that hangs at rest from a clamp."""
    mud = newtonian(MUD, 0.0, bulk_modulus=modulus, elastic_walls=not stiff)
    case = {
        "string": string or [piece(stiff=stiff)],
        "top": "clamped",
        "bottom": "free",
        "gravity": G,
        "fluid": mud | (fluid or {}),
    }
    if case["fluid"].get("annulus", True):
        case["well"] = hole or straight_hole()
    model = build_model(Case(**(case | keys)))
    state = find_equilibrium(model)
    return model, state, static_summary(model, state)


def pressure(modulus: float, depth: float = LENGTH) -> float:
    """Pressure of mud at rest: dp/dz = rho g, rho = rho_0 exp(p/K), p = 0 at the top."""
    return -modulus * np.log1p(-MUD * G * depth / modulus)


def column(model: DrillingModel, state: StaticState, name: str) -> np.ndarray:
    columns, table = static_table(model)
    return table[:, [c for c, _ in columns].index(name)]


# ---------------------------------------------------------------------- mud at rest
@pytest.mark.parametrize("modulus", [STIFF, 2.5e9])
@pytest.mark.parametrize("inclination", [0.0, 60.0])
@pytest.mark.parametrize("plugged", [False, True])
def test_hook_load_of_a_stiff_string(plugged, inclination, modulus):
    """Hook load of a stiff string in mud at rest (manual: verif-buoyancy).

    W - p_b A_s with an open end (222.1128 kN vertical, incompressible; 222.018 kN at 2.5 GPa); W - p_b A_o
    plugged and empty (113.0693 kN). In a frictionless hole of 60 degrees: the components along it, and across
    it the weight minus the displaced mud.
    """
    tilt = np.radians(inclination)
    model, _, figures = hung(
        modulus=modulus,
        hole=straight_hole(tilt),
        bottom={"kind": "free", "plugged": plugged},
        string=[piece(elements=50)],
    )
    area = OUTER if plugged else METAL
    exact = WEIGHT * np.cos(tilt) - pressure(modulus, LENGTH * np.cos(tilt)) * area
    if inclination == 0 and not plugged:
        assert exact == pytest.approx(222.1128e3 if modulus == STIFF else 222.018e3, rel=2e-6)
    assert figures["hook_load"] == pytest.approx(exact, rel=1e-6)
    assert figures["bit_pressure"] == pytest.approx(
        pressure(modulus, LENGTH * np.cos(tilt)), rel=1e-6
    )  # at the hole's axis
    if inclination and modulus == STIFF:
        side = model.contact.element_results(model.system.assembly)[0][:, 0].sum()
        assert side == pytest.approx((WEIGHT - MUD * G * area * LENGTH) * np.sin(tilt), rel=1e-6)


@pytest.mark.parametrize("inclination", [0.0, 60.0])
@pytest.mark.parametrize("plugged", [False, True])
def test_hook_load_of_a_steel_string_in_compressible_mud(plugged, inclination):
    """The same with stretch, elastic walls and mud of 2.5 GPa; within 2e-4, because the stretched string
    reaches 0.15 m deeper (manual: verif-buoyancy)."""
    tilt = np.radians(inclination)
    _, _, figures = hung(
        modulus=2.5e9,
        stiff=False,
        hole=straight_hole(tilt),
        bottom={"kind": "free", "plugged": plugged},
        string=[piece(elements=50, stiff=False)],
    )
    exact = WEIGHT * np.cos(tilt) - pressure(2.5e9, LENGTH * np.cos(tilt)) * (OUTER if plugged else METAL)
    assert figures["hook_load"] == pytest.approx(exact, rel=2e-4)


def test_hook_load_with_mud_inside_only():
    """Plugged end, no annulus: W + p_b A_i, 371.2368 kN for incompressible mud (manual: verif-buoyancy)."""
    for modulus in (STIFF, 2.5e9):
        _, _, figures = hung(modulus=modulus, bottom=PLUGGED, fluid={"annulus": False, "pump_pressure": 0.0})
        assert figures["hook_load"] == pytest.approx(WEIGHT + pressure(modulus) * BORE, rel=1e-6)
        if modulus == STIFF:
            assert figures["hook_load"] == pytest.approx(371.2368e3, rel=1e-6)


def test_collars_and_pipe_are_buoyed_by_the_displaced_mud():
    """Two sizes of pipe in still mud, with shoulders: the hook load is the sum of W (1 - rho/rho_s), and the
    wall tension at the end is -p A_s."""
    string = [piece(800.0, 32), piece(200.0, 8, od=0.1715, bore=0.0714)]
    model, state, figures = hung(string)
    collar = np.pi / 4 * (0.1715**2 - 0.0714**2)
    assert figures["hook_load"] == pytest.approx((STEEL - MUD) * G * (METAL * 800 + collar * 200), rel=1e-6)
    assert column(model, state, "axial_force")[-1] == pytest.approx(-MUD * G * LENGTH * collar, rel=1e-6)


def test_hook_load_in_a_curved_hole():
    """Vertical, then 5 deg/30 m to 60 degrees, frictionless: the hook load is the buoyed weight per length
    times the true depth of the end, minus the thrust of the jet. Within 1e-4 (radial clearance 6.5 mm)."""
    radius, end = 30 / np.radians(5), 560.0
    md = [0.0, 100.0, *(100.0 + 30 * k for k in range(1, 13)), 600.0]
    tilt = [0.0, 0.0, *(np.radians(5.0 * k) for k in range(1, 13)), np.pi / 3]
    hole = {
        "survey": {"md": md, "inclination": tilt, "azimuth": [0.0] * len(md)},
        "sections": [{"to": 600.0, "kind": "open_hole", "diameter": 0.14, "friction": 0.0}],
    }
    depth, jet = 100 + radius * np.sin(np.pi / 3) + 0.5 * (end - 460), MUD * 0.02**2 / 380e-6
    for keys, line, thrust in (
        ({}, METAL, 0.0),
        ({"bottom": PLUGGED}, OUTER, 0.0),
        ({"fluid": {"flow_rate": 0.02}}, METAL, jet),
    ):
        string = [piece(end, 112)] + ([bit(380e-6)] if thrust else [])
        _, _, figures = hung(string, hole=hole, **keys)
        assert figures["hook_load"] == pytest.approx(
            (STEEL * METAL - MUD * line) * G * depth - thrust, rel=1e-4
        )


@pytest.mark.parametrize("plugged", [False, True])
def test_buoyancy_across_an_inclined_string(plugged):
    """20 m between hinges at 60 degrees, away from the wall: the side reactions are (m + rho A_i - rho A_o) g
    L sin I; plugged without rho A_i."""
    model, _, _ = hung(
        [piece(20.0, 8)],
        hole=straight_hole(np.pi / 3),
        contact="none",
        top="pinned",
        bottom={"kind": "pinned", "plugged": plugged},
    )
    sides = np.array(
        [[model.system.reaction(f"{end}.side_reaction_{k}") for k in (1, 2)] for end in ("top", "bottom")]
    ).sum(axis=0)
    line = STEEL * METAL - MUD * OUTER + (0.0 if plugged else MUD * BORE)
    assert np.linalg.norm(sides) == pytest.approx(line * G * 20.0 * np.sin(np.pi / 3), rel=1e-5)


# ---------------------------------------------------------------------- effective tension
@pytest.mark.parametrize(("modulus", "plugged"), [(STIFF, False), (STIFF, True), (2.5e9, False)])
def test_effective_tension_falls_by_the_buoyed_weight(modulus, plugged):
    """dT_eff/ds = -(rho_s A_s + rho_i A_i - rho_o A_o) g with the density of the mud at each depth (manual:
    eq-mud-buoyed-weight); hook load at the top, 0 at the end, open or plugged."""
    model, state, figures = hung(modulus=modulus, bottom={"kind": "free", "plugged": plugged})
    tension, s = column(model, state, "effective_tension"), model.mesh.node_depth
    bore = 0.0 if plugged else BORE
    below = np.array([pressure(modulus) - pressure(modulus, z) for z in s])
    exact = STEEL * METAL * G * (LENGTH - s) - below * (OUTER - bore)
    assert tension == pytest.approx(exact, abs=1e-6 * WEIGHT)
    assert tension[0] == pytest.approx(figures["hook_load"], rel=1e-6)
    assert column(model, state, "axial_force")[-1] == pytest.approx(
        -pressure(modulus) * (OUTER - bore), rel=1e-6
    )


@pytest.mark.parametrize("plugged", [False, True])
def test_effective_tension_with_elastic_walls(plugged):
    """With elastic walls T_wall = EA eps + 2 nu (p_i A_i - p_o A_o) and T_eff(L) = 0 (manual:
    eq-mud-effective-tension)."""
    model, state, figures = hung(stiff=False, bottom={"kind": "free", "plugged": plugged})
    tension = column(model, state, "effective_tension")
    assert tension[0] == pytest.approx(figures["hook_load"], rel=1e-6)
    assert tension[-1] == pytest.approx(0.0, abs=1e-4 * WEIGHT)


@pytest.mark.parametrize("fixed_end", [False, True])
def test_ballooning(fixed_end):
    """1000 m of steel pipe, 100 bar inside, no weight: +52.8 mm plugged, -79.2 mm if a force carries the load
    on the plug (manual: eq-mud-effective-tension, verif-ballooning).

    EA eps = [1 - 2 nu (1 + 2 eps)] p A_i - F, with the narrowing of a stretched bore.
    """
    p, EA, nu = 1e7, 206e9 * METAL, 0.3
    push = p * BORE if fixed_end else 0.0
    _, _, figures = hung(
        stiff=False,
        gravity=0.0,
        fluid={"annulus": False, "pump_pressure": p},
        bottom={"kind": "force", "force": [0.0, 0.0, -push], "plugged": True},
    )
    strain = ((1 - 2 * nu) * p * BORE - push) / (EA + 4 * nu * p * BORE)
    assert figures["stretch"] == pytest.approx(strain * LENGTH, rel=1e-7)
    assert figures["stretch"] == pytest.approx(-79.2e-3 if fixed_end else 52.8e-3, rel=1e-3)


# ---------------------------------------------------------------------- circulation
@pytest.mark.parametrize("rate", [0.03, -0.03])
def test_hook_load_under_circulation(rate):
    """30 l/s through 380 mm2: hook load at rest minus the hydraulic lift and the thrust of the jet (manual:
    verif-hydraulic-lift).

    The lift is (pi/4) D_o D_w dp of the annulus friction (wall shear pi D_o tau L and pressure A_o 4 tau
    L/(D_w - D_o)), the thrust rho q^2/A_n. In reverse circulation the lift acts downward and the thrust still
    upward. dp = 8.6809 bar (half of the loss in manual: verif-steady-loop). The friction in the bore has no
    further effect: its pressure carries it.
    """
    nozzles = 380e-6
    law = Rheology.herschel_bulkley(consistency=0.3, index=0.75, yield_stress=3.0)
    tau = float(wall_shear(law, rate / (OPEN - OUTER), HOLE - OD, 1, MUD))
    friction = 4 * tau * LENGTH / (HOLE - OD)
    assert abs(friction) == pytest.approx(8.6809e5, rel=1e-5)
    change = -np.pi / 4 * OD * HOLE * friction - MUD * rate**2 / nozzles
    string, fluid = [piece(), bit(nozzles)], {"rheology": MUD_OF_TABLE}
    still = hung(string, fluid=fluid)[2]["hook_load"]
    model, state, figures = hung(string, fluid={**fluid, "flow_rate": rate})
    assert figures["hook_load"] - still == pytest.approx(change, rel=1e-6)
    tension = column(model, state, "effective_tension")
    turned = MUD * rate**2 / BORE  # the swivel also turns the flow: hook load = T_eff - rho A_i U^2
    assert tension[0] - turned == pytest.approx(figures["hook_load"], rel=1e-6)
    assert tension[-1] - turned == pytest.approx(-MUD * rate**2 / nozzles, rel=1e-4)


@pytest.mark.parametrize("rate", [0.03, -0.03])
def test_hook_load_under_circulation_of_compressible_mud(rate):
    """Momentum balances of string with bore mud, hook = W + g M_i - p_b A_o - pi D_o tau L - (rho_0
    q)^2/(rho_b A_n), and of the annulus mud, p_b A_a = g M_a + pi (D_o + D_w) tau L.

    M_i, M_a: masses of mud in the channels.
    """
    model, _, figures = hung(
        [piece(), bit(380e-6)], modulus=2.5e9, fluid={"rheology": MUD_OF_TABLE, "flow_rate": rate}
    )
    inside, around = (
        MUD * channel.element_results(model.system.assembly)[:, 4].sum()
        for channel in (model.fluid.bore, model.fluid.annulus)
    )
    shear = (figures["bit_pressure"] * (OPEN - OUTER) - G * around) / (OD + HOLE) * OD
    thrust = MUD * rate**2 / 380e-6 * np.exp(-figures["bit_pressure"] / 2.5e9)
    exact = WEIGHT + G * inside - figures["bit_pressure"] * OUTER - shear - thrust
    assert figures["hook_load"] == pytest.approx(exact, rel=1e-6)
    assert abs(figures["hook_load"] - hung([piece(), bit(380e-6)], modulus=2.5e9)[2]["hook_load"]) > 1e4


def test_open_end_has_no_thrust():
    """Inviscid flow leaves the open bore with its momentum: T_eff = 0 there, and only rho A_i U^2 of the
    swivel remains."""
    rate = 0.03
    model, state, figures = hung(fluid={"flow_rate": rate})
    assert figures["hook_load"] == pytest.approx(WEIGHT * (1 - MUD / STEEL) - MUD * rate**2 / BORE, rel=1e-7)
    assert column(model, state, "effective_tension")[-1] == pytest.approx(0.0, abs=1e-6 * WEIGHT)


# ---------------------------------------------------------------------- rigid items
STABILIZER = {"kind": "stabilizer", "length": 2.0, "od": 0.2, "id": ID, "mass": 300.0}
BODY = {"kind": "body", "length": 3.0, "od": 0.16, "id": 0.08}
SHORT_BIT = bit(length=0.5, mass=120.0)


@pytest.mark.parametrize("plugged", [False, True])
@pytest.mark.parametrize("below", [[BODY], [STABILIZER, BODY]])
def test_rigid_items_are_buoyed_by_the_displaced_mud(below, plugged):
    """The volume of a rigid item is its mass over its density.

    Open: the hook load is the sum of W (1 - rho/rho_s) for any bores, which are full of mud. Plugged and
    empty: the bores are displaced, too. A bit at the end is solid.
    """
    string = [piece(300.0, 12), *below, piece(300.0, 12), SHORT_BIT]
    model, _, figures = hung(string, bottom={"kind": "free", "plugged": plugged})
    masses = [item.mass for item in model.case.string if item.kind not in ("beam",)]
    exact = (sum(masses) + STEEL * METAL * 600.0) * G * (1 - MUD / STEEL)
    empty = BORE * 600.0 + sum(np.pi / 4 * item["id"] ** 2 * item["length"] for item in below)
    assert figures["hook_load"] == pytest.approx(exact - (MUD * G * empty if plugged else 0.0), rel=1e-6)


def test_rigid_item_of_another_bore_between_pumped_pipes():
    """Inviscid flow through a rigid item: hook load at rest minus rho A_i U^2 of the swivel (open end)."""
    string = [piece(300.0, 12), BODY, piece(300.0, 12)]
    still, flowing = (hung(string, fluid={"flow_rate": q})[2]["hook_load"] for q in (0.0, 0.03))
    assert flowing - still == pytest.approx(-MUD * 0.03**2 / BORE, rel=1e-3)


def test_buoyancy_of_a_rigid_item_acts_in_its_middle():
    """A long item near the upper of two hinges at 60 degrees, empty of mud: the lower hinge bears each piece by its lever."""
    body = BODY | {"length": 6.0, "mass": 600.0}
    string = [piece(2.0, 2), body, piece(12.0, 6)]
    model, _, _ = hung(
        [item | {"bending_stiffness": 1e10} if item["kind"] == "beam" else item for item in string],
        hole=straight_hole(np.pi / 3),
        contact="none",
        top="pinned",
        bottom={"kind": "pinned", "plugged": True},
    )
    lower = np.linalg.norm([model.system.reaction(f"bottom.side_reaction_{k}") for k in (1, 2)])
    line = STEEL * METAL - MUD * OUTER
    long = 600.0 * (1 - MUD / STEEL) - MUD * np.pi / 4 * BODY["id"] ** 2 * 6.0
    levers = line * 2.0 * 1.0 + long * 5.0 + line * 12.0 * 14.0
    assert lower == pytest.approx(levers / 20.0 * G * np.sin(np.pi / 3), rel=1e-5)


@pytest.mark.parametrize("kind", ["body", "beam"])
def test_pressure_beside_a_rigid_item_in_a_bend(kind):
    """Mud at rest: rho g times the depth of the hole's axis, whether the tool in the bend is rigid or not.

    5 deg/30 m; the arc of one element, of 9 m, is 3.4 mm longer than its chord over the whole bend.
    """
    tool = {"kind": "body", "length": 9.0, "od": OD, "id": ID} if kind == "body" else piece(9.0, 1)
    tilt = np.radians([0.0, 0.0, 60.0, 60.0])
    hole = straight_hole() | {
        "survey": {"md": [0, 100, 460, 1020], "inclination": tilt, "azimuth": [0.0] * 4}
    }
    model, _, _ = hung([piece(200.0, 40), tool, piece(300.0, 60)], hole=hole)
    assert model.annulus is not None and model.well is not None
    bend, radius = np.minimum(model.mesh.node_depth[-1], 460.0) - 100.0, 360.0 / np.radians(60.0)
    depth = (
        100.0
        + radius * np.sin(bend / radius)
        + (model.mesh.node_depth[-1] - 460.0) * np.cos(np.radians(60.0))
    )
    assert model.annulus.pressures(model.system)[-1] == pytest.approx(MUD * G * depth, abs=20.0)


@pytest.mark.parametrize("plugged", [False, True])
def test_an_outlet_under_pressure_pushes_the_string_out(plugged):
    """A back pressure p at the outlet reduces the hook load by p A_s on the face of an open end (with p A_i
    on the swivel p A_o in all), and by p A_o on a plug.

    At the top no pressure acts on the section of the string.
    """
    end = {"kind": "free", "plugged": plugged}
    free, under = (hung(bottom=end, fluid={"outlet_pressure": p})[2]["hook_load"] for p in (0.0, 5e6))
    assert free - under == pytest.approx(5e6 * OUTER, rel=1e-6)
