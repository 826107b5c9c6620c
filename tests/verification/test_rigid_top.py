"""A rigid item as the first of the string: weight, torque, stretch, motion and modes (manual: verif-rigid-top)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case, run, statics
from drillpetsc.analysis.linear.modal import modes, prepare_state
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.model.drilling_model import build_model
from drillpetsc.output import read_table
from tests.helpers.wells import simple_well

G = 9.81
OD, ID, LENGTH, RIGID, MASS = 0.127, 0.1086, 100.0, 3.0, 300.0
AREA, INERTIA = np.pi / 4 * (OD**2 - ID**2), np.pi / 64 * (OD**4 - ID**4)
YOUNG, SHEAR, DENSITY = 206e9, 206e9 / 2.6, 7850.0
BODY = {"kind": "body", "length": RIGID, "od": 0.16, "id": 0.0714, "mass": MASS}
PIPE = {"kind": "pipe", "length": LENGTH, "od": OD, "id": ID, "element_length": 5.0}
TOPS = ["clamped", "pinned", {"kind": "top_drive"}, {"kind": "driven", "stiffness": 1e6, "damping": 1e3}]


def case(**keys) -> Case:
    return Case(**{"string": [BODY, PIPE], "top": {"kind": "top_drive"}, "gravity": G, **keys})


@pytest.mark.parametrize("top", TOPS, ids=["clamped", "pinned", "top_drive", "driven"])
def test_weight_torque_and_stretch(tmp_path, top):
    """Hook load (M + rho A L) g; the moment at the lower end is the surface torque, and twists the pipe alone by
    M L/GJ; its stretch is rho g L^2/2E (the rigid item has none)."""
    moment = 2e3
    result = statics(
        case(top=top, bottom={"kind": "force", "moment": [0.0, 0.0, moment]}), tmp_path / "run"
    ).summary
    assert result["hook_load"] == pytest.approx((MASS + DENSITY * AREA * LENGTH) * G, rel=1e-9)
    assert abs(result["surface_torque"]) == pytest.approx(moment, rel=1e-6)
    assert result["twist"] == pytest.approx(moment * LENGTH / (SHEAR * 2 * INERTIA), rel=1e-6)
    assert result["stretch"] == pytest.approx(DENSITY * G * LENGTH**2 / (2 * YOUNG), rel=1e-5)
    assert result["stable"]


def test_the_rigid_item_is_a_lever(tmp_path):
    """A level cantilever clamped at the top, gravity zero, a small side force F at the tip: the rigid item does not
    bend; deflection F L^3/3EI (Gere and Goodno, Mechanics of Materials, table H-1)."""
    pipe = {**PIPE, "length": 10.0, "element_length": 1.0}
    made = case(
        string=[BODY, pipe], top="clamped", gravity=0.0, bottom={"kind": "force", "force": [10.0, 0, 0]}
    )
    folder = statics(made, tmp_path / "run").folder
    table = read_table(folder / "statics.csv")
    model = build_model(made)
    find_equilibrium(model)
    position = model.system.field("string.position")
    exact = 10.0 * 10.0**3 / (3 * YOUNG * INERTIA)
    assert position[-1, 0] == pytest.approx(exact, rel=1e-4)
    assert table["bending_moment [N m]"][0] == pytest.approx(
        10.0 * 10.0, rel=1e-3
    )  # in the pipe below the item
    assert position[-1, 2] == pytest.approx(RIGID + 10.0, abs=1e-4)


def test_weight_in_an_inclined_hole(tmp_path):
    """Without friction: hook load (M + rho A L) g cos I; the pipe alone below the rigid item."""
    inclination = np.radians(40.0)
    well = simple_well(150.0, 0.2159, inclination, friction=0.0)
    stabilizer = {**BODY, "kind": "stabilizer", "od": 0.21}
    weight = (MASS + DENSITY * AREA * LENGTH) * G
    for first in (BODY, stabilizer):
        result = statics(case(string=[first, PIPE], well=well), tmp_path / first["kind"])
        axial = read_table(result.folder / "statics.csv")["axial_force [N]"]
        assert axial[0] == pytest.approx(DENSITY * AREA * LENGTH * G * np.cos(inclination), rel=1e-3)
        assert result.summary["hook_load"] == pytest.approx(weight * np.cos(inclination), rel=1e-3)


def test_buoyed_weight_with_mud(tmp_path):
    """Mud in bore and annulus, at rest: hook load less the weight of the mud that all metal displaces (Archimedes);
    an open lower end."""
    well = simple_well(150.0, 0.2159, friction=0.0)
    density = 1200.0
    mud = {"density": density, "rheology": {"model": "newtonian", "viscosity": 0.02}, "flow_rate": 0.0,
           "bulk_modulus": 1e13}  # fmt: skip
    metal = MASS / (
        np.pi / 4 * (0.16**2 - 0.0714**2) * RIGID
    )  # its own density, so that mass and volume agree
    body = {**BODY, "material": {"density": metal}}
    summary = statics(case(string=[body, PIPE], well=well, fluid=mud), tmp_path / "run").summary
    volume = np.pi / 4 * (0.16**2 - 0.0714**2) * RIGID + AREA * LENGTH
    exact = (MASS + DENSITY * AREA * LENGTH - density * volume) * G
    assert summary["hook_load"] == pytest.approx(exact, rel=1e-3)


def test_a_run_keeps_the_weight_and_turns(tmp_path):
    """Rotation at constant speed from statics: every row has the weight, no torque and the speed of the top."""
    result = run(
        case(top={"kind": "top_drive", "rotation": "60 rpm"}, time={"end": 0.5}),
        tmp_path / "run",
        progress="silent",
    )
    table = read_table(result.folder / "history.csv")
    assert table["hook_load [N]"] == pytest.approx((MASS + DENSITY * AREA * LENGTH) * G, rel=1e-6)
    assert np.abs(table["surface_torque [N m]"]).max() < 1e-2
    assert table["bit_speed [rad/s]"] == pytest.approx(2 * np.pi, rel=1e-9)


def test_axial_release_keeps_energy(tmp_path):
    """A jump of the top's speed sends axial waves through the string: the hook load rises by Z V at the first
    moment, Z = sqrt(E rho) A, after the rigid item's inertia is overcome; the energy balance closes."""
    made = case(
        top={"kind": "top_drive", "lowering": {"time": [0.0, 0.02, 0.04], "value": [0.0, 0.0, -0.1]}},
        time={"end": 0.05},
        output={"history_every": 0.001},
        petsc={"ts_rtol": 1e-6},
    )
    result = run(made, tmp_path / "run", progress="silent")
    table = read_table(result.folder / "history.csv")
    rise = table["hook_load [N]"] - table["hook_load [N]"][0]
    # at the end of the ramp, before the wave returns from the lower end (40 ms): pipe at 0.1 m/s, item at 5 m/s2
    impedance = np.sqrt(YOUNG * DENSITY) * AREA
    k = int(np.argmin(np.abs(table["time [s]"] - 0.039)))
    assert rise[k] == pytest.approx(impedance * 0.095 + MASS * 5.0, rel=0.02)
    assert result.summary["energy"]["flag"] is False


def frequencies(made: Case, kind: str) -> np.ndarray:
    model = build_model(made)
    prepare_state(model)
    m = modes(model, 8, kind=kind)
    return 2 * np.pi * m.frequency[[k == kind and f > 0 for k, f in zip(m.kind, m.frequency, strict=True)]]


def test_modes_of_a_cantilever_below_a_rigid_item():
    """Clamped at the top, no gravity: (1.8751/L)^2 sqrt(EI/rho A) of the pipe alone (Blevins, table 8-1)."""
    pipe = {**PIPE, "length": 10.0, "element_length": 0.5}
    found = frequencies(case(string=[BODY, pipe], top="clamped", gravity=0.0), "lateral")
    exact = (1.87510407 / 10.0) ** 2 * np.sqrt(YOUNG * INERTIA / (DENSITY * AREA))
    assert found[:2] == pytest.approx([exact, exact], rel=1e-4)


def test_modes_of_a_pinned_pendulum():
    """A rigid item and a stiff light rod on a pin: omega^2 = g sum(m z)/J (compound pendulum; J about the pin)."""
    rod = {
        "kind": "beam", "length": 1.0, "element_length": 0.5, "axial_stiffness": 1e9, "bending_stiffness": 1e9,
        "torsional_stiffness": 1e8, "mass": 10.0, "polar_inertia": 0.1,
    }  # fmt: skip
    body = {"kind": "body", "length": RIGID, "mass": MASS, "inertia": {"axial": 1.0, "transverse": 225.0}}
    found = frequencies(case(string=[body, rod], top="pinned"), "lateral")
    moment = MASS * 1.5 + 10.0 * 3.5
    inertia = 225.0 + MASS * 1.5**2 + 10.0 * (4.0**3 - 3.0**3) / 3
    exact = np.sqrt(G * moment / inertia)
    assert found[:2] == pytest.approx([exact, exact], rel=1e-4)
