"""Mud while the hole grows: returned flow and mass balance (manual: sec-mud-cuttings,
verif-return-while-drilling, verif-drilling-mud-balance).

A bit drills with V below a string that is lowered with V. The entering steel displaces A_o V of the hole
above, A_o the section of the pipe at the top. The new hole takes A_w V. With cuttings removed mud fills it,
so the return is A_w V - A_o V = A_a V less than the pumped flow. With cuttings returned the rock is
transported as well, and the return is A_o V more than the pumped flow.
"""

from __future__ import annotations

import numpy as np
import pytest

import drillpetsc
from drillpetsc.analysis.statics.placement import place_along_hole
from drillpetsc.analysis.statics.steady_flow import steady_flow
from drillpetsc.case import Case
from drillpetsc.kernels.parameters import parameters_of
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output import read_table
from tests.helpers.mud import (
    DENSITY,
    GRAVITY,
    HOLE,
    MUD,
    NOZZLE,
    OPEN,
    OUTER,
    RIGID,
    SOLID,
    hole,
    loop,
    started,
)
from tests.verification.test_tripping import pipe

PUMP, TURNING, WEIGHT = 0.03, 12.0, 2e4  # [m3/s], [rad/s], [N]
ROP = 0.01  # [m/s]
BIT = {"kind": "bit", "od": HOLE, "mass": 60.0, "nozzle_area": NOZZLE}
BACK = {"removed": PUMP - OPEN * ROP, "returned": PUMP + SOLID * ROP}


def drilling(cuttings: str, length: float, modulus: float = 1e14, valve=None, **case) -> DrillingModel:
    """A stiff string that drills straight down at ``ROP`` under ``WEIGHT``; modulus: of the mud [Pa]."""
    string = [{**pipe(length, 10), "bending_stiffness": 1e9}, {**BIT, "length": 0.5}]
    top, rock = (
        {"kind": "top_drive", "lowering": ROP, "rotation": TURNING},
        {"drillability": ROP / WEIGHT, "reference_speed": TURNING},
    )
    mud = {**RIGID, "bulk_modulus": modulus, "flow_rate": PUMP, "cuttings": cuttings, **(valve or {})}
    return loop(
        mud,
        hold_string=False,
        top=top,
        bottom="bit",
        contact="none",
        formation=rock,
        well=hole(length + 0.5),
        string=string,
        initial={"wob": WEIGHT},
        **case,
    )


@pytest.mark.parametrize("cuttings", BACK)
def test_return_of_a_bit_that_drills(cuttings):
    """29.76058 l/s at 10 mm/s with cuttings removed, 30.12668 l/s with cuttings returned (mud of 1e14 Pa:
    1e-8; manual: verif-return-while-drilling)."""
    model = started(drilling(cuttings, 2000.0))
    system, n = model.system, model.mesh.nodes
    system.set_field("hole.end", np.tile([0.0, 0.0, ROP], (n, 1)), "y")
    system.set_field("hole.drilled", np.full((n, 1), ROP), "y")
    steady_flow(system)
    back = model.fluid.annulus.outflow(system.assembly)
    assert back == pytest.approx(BACK[cuttings], rel=1e-8)
    assert back == pytest.approx({"removed": 29.76058e-3, "returned": 30.12668e-3}[cuttings], rel=1e-6)


@pytest.mark.parametrize("cuttings", BACK)
@pytest.mark.parametrize(
    "mode, end, modulus, most", [("dynamic", 1.0, 1e14, 1e-8), ("quasi_static", 400.0, 2e9, 1e-5)]
)
def test_mass_balance_of_a_drilling_run(cuttings, mode, end, modulus, most, tmp_path):
    """From the start of drilling, 1 s dynamic and 400 s quasi-static: return of steady drilling, volume of
    cuttings A_w ROP t, and mud mass balance within 1e-8 of the pumped volume (manual:
    verif-drilling-mud-balance).

    At the start the hole does not grow yet; under 24 bar mud of 2 GPa is denser by 1.2e-3. Quasi-static
    within 1e-5, because its longer steps contain the jump of the hole's rate at the start.
    """
    case = drilling(
        cuttings, 200.0, modulus, time={"end": end, "mode": mode}, output={"history_every": end / 10}
    ).case
    result = drillpetsc.run(case, tmp_path / "run", progress="silent")
    table, mass = read_table(result.folder / "history.csv"), result.summary["mass"]
    assert table["rop [m/s]"][5:] == pytest.approx(ROP, rel=2e-3)
    assert table["outlet_flow [m3/s]"][5:] == pytest.approx(
        BACK[cuttings], rel=1e-5 if modulus > 1e12 else 3e-5
    )
    assert mass.get("cuttings", 0.0) == pytest.approx(
        0.25 * np.pi * HOLE**2 * ROP * end if cuttings == "returned" else 0.0, rel=2e-3
    )
    assert mass["content_change"] == pytest.approx(OPEN * ROP * end, rel=2e-3)
    assert abs(mass["error"]) < most * mass["pumped"]


@pytest.mark.parametrize("cuttings", BACK)
def test_energy_balance_of_a_drilling_run(cuttings, tmp_path):
    """Below 1e-4 of the energy exchanged.  The pressure's work on the bottom that is drilled away, p A_w V = 4.6 kW at
    12.7 MPa, is 2 % of it; with cuttings returned it comes back with them, less their weight (manual: eq-mud-end-power)."""
    case = drilling(cuttings, 1000.0, 2e9, time={"end": 1.0}, output={"history_every": 0.1}).case
    energy = drillpetsc.run(case, tmp_path / "run", progress="silent").summary["energy"]
    assert abs(energy["error_share"]) < 1e-4


CURVED = {
    "survey": {"md": [0.0, 100.0, 300.0, 340.0], "inclination": [0.0, 0.0, 0.35, 0.35], "azimuth": [0.0] * 4},
    "sections": [
        {"to": 155.0, "kind": "casing", "diameter": 0.2445, "friction": 0.2},
        {"to": 340.0, "kind": "open_hole", "diameter": 0.2159, "friction": 0.2},
    ],
}


def in_curved_hole(**case) -> dict:
    """Case of 300 m of pipe in a hole that bends and narrows; still, stiff mud."""
    string = [
        {"kind": "pipe", "length": 200, "od": OUTER, "id": 0.1086, "element_length": 10.0},
        {"kind": "pipe", "length": 100, "od": 0.14, "id": 0.07, "element_length": 10.0},
    ]
    mud = {"density": DENSITY, "rheology": {"model": "newtonian", "viscosity": 0.0}, **RIGID}
    return {
        "well": CURVED,
        "string": string,
        "top": {"kind": "top_drive", "lowering": 0.1},
        "gravity": GRAVITY,
        "fluid": mud,
        **case,
    }


def shifted(model: DrillingModel, by: float) -> None:
    """The string ``by`` [m] further down along the hole's axis."""
    position, tangent, _ = model.well.at(model.mesh.node_depth + by)
    model.system.set_field("string.position", position)
    model.system.set_field("string.tangent", tangent)


def test_annulus_follows_a_string_that_slides_down_a_curved_hole():
    """20 m further down in steps of 4 cm, the pressure under the string is that of its true vertical depth,
    and the content of the annulus that of the hole minus that of the pipe, as for a start at this depth.

    Within 2e-5: chord and arc of an element differ by angle^2/24, 1.3e-5.
    """
    model = build_model(Case(**in_curved_hole()))
    place_along_hole(model)
    component, asm = model.fluid.annulus, model.system.assembly
    component.locate_hole(asm)
    for by in np.arange(0.04, 20.01, 0.04):
        shifted(model, by)
        component.accept(0.0, asm)
    steady_flow(model.system)
    ends = model.mesh.node_depth[[0, -1]] + 20.0
    pipes = 0.25 * np.pi * (200 * OUTER**2 + 100 * 0.14**2)
    assert model.system.field("annulus.pressure")[-1, 0] == pytest.approx(
        DENSITY * GRAVITY * model.well.at(ends[1])[0][2], rel=1e-6
    )
    holes = np.pi * np.array([0.5 * 0.2445, 0.5 * 0.2159]) ** 2
    w, r, d = (
        0.5,
        0.5 * 0.2445,
        0.5 * (0.2159 - 0.2445),
    )  # transition: int (r + d (3 u^2 - 2 u^3))^2 du = r^2 + r d + 13/35 d^2
    around = (
        holes[0] * (155 - w / 2 - ends[0])
        + holes[1] * (ends[1] - 155 - w / 2)
        + np.pi * w * (r**2 + r * d + 13 / 35 * d**2)
    )
    assert component.element_results(asm)[:, 4].sum() == pytest.approx(around - pipes, rel=2e-5)
    walked = [b.params.copy() for b in component._blocks]
    fresh = build_model(Case(**in_curved_hole()))
    place_along_hole(fresh)
    shifted(fresh, 20.0)
    fresh.fluid.annulus.locate_hole(fresh.system.assembly)
    for b, params in zip(fresh.fluid.annulus._blocks, walked, strict=True):
        then, now = parameters_of(b.kernel, params), b.named
        sizes = "length rigid poisson outer hole outer_above wall diameter gap gap_above".split()
        for name in sizes:
            assert then[name] == pytest.approx(now[name], rel=1e-4)
        for name in ("chi", "damping", "turning"):  # updated at changes of diameter of a hundredth
            assert then[name] == pytest.approx(now[name], rel=2e-2)
        assert then["step"] == pytest.approx(now["step"], rel=1e-4, abs=1e-9)
        for name in ("tangent1", "tangent2", "bend", "head"):
            assert then[name] == pytest.approx(now[name], abs=2e-5)


def test_restart_restores_the_mud_in_the_hole():
    """The state that the components store in a checkpoint gives a new model's elements and chamber the same
    state, bit for bit."""
    model, again = (build_model(Case(**in_curved_hole(bottom="free"))) for _ in range(2))
    place_along_hole(model)
    steady_flow(model.system)
    for by in np.arange(0.3, 6.0, 0.3):
        shifted(model, by)
        model.system.accept(0.0)
    again.system.assembly.x[:] = model.system.assembly.x
    for old, new in zip(model.fluid.components[1:], again.fluid.components[1:], strict=True):
        new.set_local_state(old.get_local_state())
    again.system.accept(0.0)
    for old, new in zip(model.system.assembly.bound_blocks, again.system.assembly.bound_blocks, strict=True):
        if old.block.name.startswith(("annulus_flow", "bit_flow")):
            assert np.array_equal(old.block.params, new.block.params), old.block.name
    # on which the next renewal of the added mass depends
    old, new = (m.fluid.annulus.lateral_sizes() for m in (model, again))
    assert np.array_equal(old, new) and np.ptp(new[:, 1]) > 0.01


def test_drilling_round_a_bend(tmp_path):
    """Quasi-static, 5 m of new hole under a bent hole of two sizes: the return is the pumped flow minus A_a
    ROP, with A_a between the pipe at the top and the new hole; mud mass balance within 3e-6 of the pumped
    volume."""
    string = [
        {"kind": "pipe", "length": 269.7, "od": OUTER, "id": 0.1086, "element_length": 10.0},
        {"kind": "pipe", "length": 70, "od": 0.1715, "id": 0.0714, "element_length": 10.0},
        {**BIT, "length": 0.3},
    ]
    case = Case(
        **in_curved_hole(
            string=string,
            top={"kind": "top_drive", "lowering": 0.005, "rotation": TURNING},
            bottom="bit",
            initial={"wob": 3e4},
            formation={"drillability": 0.005 / 3e4, "reference_speed": TURNING},
            fluid={**MUD, "flow_rate": PUMP},
            time={"end": 1000.0, "mode": "quasi_static"},
            output={"history_every": 100.0},
        )
    )
    result = drillpetsc.run(case, tmp_path / "run", progress="silent")
    mass, table = result.summary["mass"], read_table(result.folder / "history.csv")
    assert table["hole_depth [m]"][-1] == pytest.approx(345.0, abs=0.05)
    assert table["outlet_flow [m3/s]"][5:] == pytest.approx(PUMP - OPEN * 0.005, rel=1e-4)
    assert mass["content_change"] == pytest.approx(5 * OPEN, rel=1e-2)
    assert abs(mass["error"]) < 3e-6 * mass["pumped"]
