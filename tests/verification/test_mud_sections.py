"""`bore_volume` and `annulus_od` of tools: the sections that the mud meets where they are not those of id and od.

Closed forms: Archimedes' law with the metal's volume pi/4 annulus_od^2 L - bore_volume; speeds Q/A; laminar loss 128 mu L Q/(pi d^4) with
pi/4 d^2 = bore_volume/L; and the same mud as around a pipe that has these diameters (manual: sec-guide-mud-sections).
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import drillpetsc as dp
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.errors import CaseError
from drillpetsc.model.drilling_model import build_model
from drillpetsc.physics.fluid.channel_flow import RESULT_NAMES
from tests.helpers.tables import each_row
from tests.helpers.wells import newtonian

HOLE, LENGTH, BORE, OUTER = 0.2159, 9.0, 0.05, 0.19  # bore and outer diameter that the mud meets [m]
VOLUME = np.pi / 4 * BORE**2 * LENGTH
SECTIONS = {"bore_volume": VOLUME, "annulus_od": OUTER}
PIPE = {"kind": "pipe", "od": 0.127, "id": 0.1086}
TOOL = {"length": LENGTH, "od": 0.1715, "id": 0.07}
KINDS: dict[str, dict[str, Any]] = {
    "pipe": {"kind": "pipe"},
    "body": {"kind": "body"},
    "stabilizer": {"kind": "stabilizer", "od": 0.21, "body_od": 0.1715, "blade_length": 1.0},
    "shock_sub": {"kind": "shock_sub", "stiffness": 5e6, "mass": 1500.0},
    "jar": {"kind": "jar", "jar": {"stroke": 0.2, "trigger": "900 kN", "action": "mechanical"}},
    "pdm": {"kind": "pdm", "pdm": {"rev_per_volume": "0.29 rev/gal", "stall_torque": 14e3}},
}
DENSITY, VISCOSITY = 1200.0, 0.05


def case(tool: dict | None = None, shoe: float | None = None, **keys: Any) -> dp.Case:
    """A vertical string with a tool of 9 m above 20 m of pipe; mud that hardly compresses."""
    end = 150.0
    sections = [{"to": end, "kind": "open_hole", "diameter": HOLE}]
    if shoe is not None:
        sections.insert(0, {"to": shoe, "kind": "casing", "diameter": HOLE})
    values = {
        "well": {"survey": {"md": [0, end], "inclination": [0, 0], "azimuth": [0, 0]}, "sections": sections},
        "string": [
            PIPE | {"length": 100.0},
            TOOL | KINDS["pipe"] | (SECTIONS if tool is None else tool),
            PIPE | {"length": 20.0},
        ],
        "top": "clamped",
        "bottom": "free",
        "material": {"young": 1e14},
        "fluid": newtonian(DENSITY, VISCOSITY, flow_rate=0.002, bulk_modulus=1e14, elastic_walls=False),
    }
    fluid = values["fluid"] | keys.pop("fluid", {})
    return dp.Case(**values | {"fluid": fluid} | keys)


def tool_row(found: Any, channel: str) -> dict[str, float]:
    """Sums of length, loss and volume, and the speed, of the tool's rows of a channel."""
    table = found.tables["hydraulics"]
    rows = np.flatnonzero((np.asarray(table["channel"]) == channel) & (np.asarray(table["item"]) == "tool"))
    sums = {name: float(np.asarray(table[name])[rows].sum()) for name in ("pressure_loss", "volume")}
    return sums | {"velocity": float(np.asarray(table["mean_velocity"])[rows[0]]), "rows": len(rows)}


@pytest.mark.parametrize("shoe", [None, 104.0])
def test_volume_speeds_and_laminar_loss(shoe: float | None, tmp_path: Path) -> None:
    """In one piece, and cut by a casing shoe: the pieces share the volume by their length."""
    found = dp.hydraulics(case(SECTIONS | {"name": "tool"}, shoe, hold_string=True), tmp_path / "out")
    bore, annulus = tool_row(found, "bore"), tool_row(found, "annulus")
    assert bore["rows"] == (1 if shoe is None else 2)
    assert bore["volume"] == pytest.approx(VOLUME, rel=1e-9)
    assert bore["velocity"] == pytest.approx(0.002 / (np.pi / 4 * BORE**2), rel=1e-6)
    assert bore["pressure_loss"] == pytest.approx(
        128 * VISCOSITY * LENGTH * 0.002 / (np.pi * BORE**4), rel=1e-5
    )
    space = np.pi / 4 * (HOLE**2 - OUTER**2)
    assert abs(annulus["velocity"]) == pytest.approx(0.002 / space, rel=1e-6)
    assert annulus["volume"] == pytest.approx(space * LENGTH, rel=1e-9)


@pytest.mark.parametrize("command", ["hydraulics", "surge"])
def test_the_mud_is_that_around_a_pipe_with_these_diameters(command: str, tmp_path: Path) -> None:
    """Turbulent flow, and the pressures of tripping, open and closed."""
    rheology = {"pv": "20 cP", "yp": "10 lbf/100ft2"}
    keys = {"fluid": {"flow_rate": 0.03, "rheology": rheology}, "hold_string": command == "hydraulics"}
    other = {"od": OUTER, "id": BORE}
    trip = {"speeds": [0.5]} if command == "surge" else {}
    first, second = (
        getattr(dp, command)(case(tool, **keys), tmp_path / name, **trip).tables[command]
        for name, tool in (("tool", SECTIONS), ("pipe", other))
    )
    assert set(first) == set(second)
    for name in first:
        a, b = np.asarray(first[name]), np.asarray(second[name])
        if a.dtype.kind == "f":
            assert a == pytest.approx(b, rel=1e-6, abs=1e-9, nan_ok=True), name
        else:
            assert (a == b).all(), name


def weight(kind: str, values: dict) -> tuple[float, float]:
    """Mass [kg] of the string, and volume of the metal that the mud meets [m3]."""
    read = case(values)
    item = read.string[1]
    tube = np.pi / 4 * (0.1715**2 - 0.07**2) * LENGTH
    mass = getattr(item, "mass", None) or item.material.density * tube
    pipe = np.pi / 4 * (0.127**2 - 0.1086**2) * 120.0
    return mass + 7850.0 * pipe, np.pi / 4 * OUTER**2 * LENGTH - VOLUME + pipe


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_hook_load_by_archimedes(kind: str, tmp_path: Path) -> None:
    """Weight of the metal less that of the mud which it displaces, of an open string in mud at rest; soft string, too."""
    values = KINDS[kind] | SECTIONS
    mass, metal = weight(kind, values)
    summary = dp.statics(case(values, fluid={"flow_rate": 0.0}), tmp_path / "out").summary
    wanted = 9.80665 * (mass - DENSITY * metal)
    assert summary["hook_load"] == pytest.approx(wanted, rel=1e-6)
    assert summary["soft_string"]["hook_load"] == pytest.approx(wanted, rel=1e-6)


@pytest.mark.parametrize("kind", ["body", "stabilizer"])
def test_speed_past_and_mud_inside_a_rigid_tool(kind: str) -> None:
    """The rigid tool belongs to the element below: areas above it, and the mass of mud in all of the bore."""
    model = build_model(case(KINDS[kind] | SECTIONS))
    find_equilibrium(model)
    fluid = model.fluid
    assert fluid is not None and fluid.bore is not None and fluid.annulus is not None
    k = int(np.flatnonzero(model.mesh.rigid_above > 0)[0])
    assert fluid.bore.parameter("area_above")[k] == pytest.approx(VOLUME / LENGTH, rel=1e-12)
    assert fluid.annulus.parameter("outer_above")[k] == pytest.approx(np.pi / 4 * OUTER**2, rel=1e-12)
    content = fluid.bore.element_results(model.system.assembly)[:, RESULT_NAMES.index("content")].sum()
    assert content == pytest.approx(VOLUME + np.pi / 4 * 0.1086**2 * 120.0, rel=1e-6)


MOVING = {
    "top": {"kind": "top_drive", "rotation": 2.0},
    "contact": "none",
    "material": {},
    "fluid": {
        "flow_rate": {"time": [0.1, 0.9], "value": [0.01, 0.03]},
        "bulk_modulus": 2e9,
        "elastic_walls": True,
    },
    "time": {"end": 1.0},
    "output": {"history_every": 0.02},
    "petsc": {"ts_rtol": 1e-6},
}


@pytest.mark.parametrize("kind", ["pipe", "body", "shock_sub"])
def test_mass_and_energy_of_a_run(kind: str, tmp_path: Path) -> None:
    summary = dp.run(case(KINDS[kind] | SECTIONS, **MOVING), tmp_path / "run", progress="silent").summary
    assert abs(summary["energy"]["error_share"]) < 1e-3
    assert abs(summary["mass"]["error"]) < 1e-6


@each_row(
    ("kind", "keys", "more", "at"),
    [
        ("pipe", {"bore_volume": -1.0}, {}, "string[1].bore_volume"),
        ("pipe", {"bore_volume": 0.25}, {}, "string[1].bore_volume"),
        ("body", {"bore_volume": 0.01, "length": 0.0}, {}, "string[1].bore_volume"),
        ("pipe", {"annulus_od": 0.06}, {}, "string[1].annulus_od"),
        ("pipe", {"annulus_od": "3 kg"}, {}, "string[1].annulus_od"),
        ("body", {"annulus_od": 0.05}, {}, "string[1].annulus_od"),
        ("stabilizer", {"annulus_od": 0.19, "bypass_area": 0.01}, {}, "string[1].annulus_od"),
        ("stabilizer", {"annulus_od": 0.19, "stiff": False}, {}, "string[1].annulus_od"),
        (
            "pipe",
            {"bore_volume": 0.02},
            {"bottom": {"kind": "free", "plugged": True}, "fluid": {"flow_rate": 0}},
            "string[1].bore_volume",
        ),
    ],
)
def test_wrong_sections_are_refused(kind: str, keys: dict, more: dict, at: str) -> None:
    with pytest.raises(CaseError) as caught:
        case(KINDS[kind] | keys, **more)
    assert caught.value.at == at, caught.value


@pytest.mark.parametrize(("key", "value"), [("annulus_od", 0.19), ("bore_volume", 0.001)])
def test_sections_of_a_bit_are_refused(key: str, value: float) -> None:
    string = [PIPE | {"length": 100.0}, {"kind": "bit", "length": 0.3, "od": 0.2, key: value}]
    with pytest.raises(CaseError) as caught:
        case(string=string)
    assert caught.value.at == f"string[1].{key}"


@pytest.mark.parametrize("kind", ["pipe", "body"])
def test_a_tool_that_closes_the_annulus_is_refused(kind: str) -> None:
    with pytest.raises(CaseError) as caught:
        build_model(case(KINDS[kind] | {"annulus_od": 0.216}))
    assert caught.value.at.startswith("string[1]")


def test_walls_give_by_the_rock_of_their_section() -> None:
    """Lame's thick walls about a pipe of steel: 2/(Rw^2 - Ro^2) [Rw^2 (1 + nu_r)/E_r + (Ro^2/E) (2 (1 - nu^2) Ro^2/(Ro^2 - Ri^2) - 1 - nu)]."""
    rocks = [{"young": 20e9, "poisson": 0.25}, {"young": 5e9, "poisson": 0.4}]
    keys = {f"well.sections[{k}].compliance": rock for k, rock in enumerate(rocks)}
    model = build_model(case(PIPE, shoe=62.0).replace({**keys, "fluid.elastic_walls": True}))
    wall = model.annulus.parameter("wall")
    hole, outer, inner = (0.25 * d**2 for d in (HOLE, PIPE["od"], PIPE["id"]))
    steel = outer / 1e14 * (2 * (1 - 0.3**2) * outer / (outer - inner) - 1 - 0.3)
    for rock, there in zip(rocks, (model.mesh.lower < 62.0, model.mesh.upper > 62.0), strict=True):
        expected = 2 / (hole - outer) * (hole * (1 + rock["poisson"]) / rock["young"] + steel)
        assert there.sum() > 2
        assert wall[there] == pytest.approx(expected, rel=1e-9)
