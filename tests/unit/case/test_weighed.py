"""Weight of string items as weighed: mass, buoyancy, stiffness, and weights that no item of the size has."""

from __future__ import annotations

import math
from typing import Any

import pytest

import drillpetsc as dp
from drillpetsc.analysis.loads.torque_drag.string_rows import rows_at
from drillpetsc.case.plausible.plausibility import plausibility
from drillpetsc.case.writer import case_data
from drillpetsc.errors import CaseError

G, STEEL = 9.80665, 7850.0
JAR: dict[str, Any] = {"length": "10 m", "od": "212.725 mm", "id": "82.55 mm"}
RING = math.pi / 4 * (0.212725**2 - 0.08255**2)  # [m2]
WELL = {
    "survey": {"md": [0, 100], "inclination": [0, 0], "azimuth": [0, 0]},
    "sections": [{"kind": "casing", "diameter": 0.4}],
}
MUD = {"density": 1490.0, "rheology": {"model": "newtonian", "viscosity": 0.02}}


def case(*items: dict[str, Any], **keys: Any) -> dp.Case:
    """Items in a vertical hole of 100 m."""
    return dp.Case(string=list(items), well=WELL, top="clamped", **keys)


@pytest.mark.parametrize("kind", ["pipe", "tool", "drill_collar", "casing", "coiled_tubing"])
def test_hook_load_is_the_weight_less_the_mud_that_the_ring_displaces(kind: str) -> None:
    """W = L (w - rho g (outside - inside area)); the soft string of one vertical item."""
    found = rows_at(case(JAR | {"kind": kind, "weight": "1824 N/m"}, fluid=MUD), 10.0)
    assert found.air_weight == pytest.approx(18240, rel=1e-9)
    assert found.weight[0] == pytest.approx(1824 - 1490 * G * RING, rel=1e-9)


def test_a_weight_is_the_density_that_gives_it() -> None:
    """The jar of Volve F-5: 1824 N/m is 6161 kg/m3 over its ring (contract A1)."""
    weighed = case(JAR | {"kind": "tool", "weight": "1824 N/m"}, fluid=MUD)
    dense = case(JAR | {"kind": "pipe", "material": {"density": 6161}}, fluid=MUD)
    assert rows_at(weighed, 10.0).weight == pytest.approx(rows_at(dense, 10.0).weight, rel=1e-4)
    assert dp.Case(**case_data(weighed)) == weighed


@pytest.mark.parametrize(
    ("item", "mass"),
    [
        ({"kind": "body"}, 1824 / G * 10),
        ({"kind": "stabilizer"}, 1824 / G * 10),
        ({"kind": "bit", "od": 0.3}, 1824 / G * 10),
    ],
)
def test_mass_of_a_rigid_item(item: dict[str, Any], mass: float) -> None:
    pipe = {"kind": "pipe", "length": 10, "od": 0.2, "id": 0.08}
    found = case(pipe, JAR | item | {"weight": "1824 N/m"}).string[1]
    assert found.mass == pytest.approx(mass, rel=1e-9)  # type: ignore[attr-defined]
    if item["kind"] != "bit":
        assert found.material.density == pytest.approx(1824 / G / RING, rel=1e-9)  # type: ignore[union-attr]


def test_pipe_with_tool_joints_keeps_the_density_of_its_steel() -> None:
    """Its tool joints and upsets are in the weight: mud displaces m/rho_s (manual: eq-tubulars-areas)."""
    joint = {"od": 0.168, "id": 0.07, "length": 0.43}
    pipe = {"kind": "drill_pipe", "length": 50, "od": 0.127, "id": 0.1086, "tool_joint": joint}
    found = rows_at(case(pipe | {"weight": "330 N/m"}, fluid=MUD), 50.0)
    assert found.weight[0] == pytest.approx(330 * (1 - 1490 / STEEL), rel=1e-9)


def test_stiffness_of_a_tool_is_a_tubes_unless_given() -> None:
    tool = JAR | {"kind": "tool", "weight": "1824 N/m", "bending_stiffness": "2e6 N m2"}
    found = rows_at(case(tool), 10.0)
    assert found.bending_stiffness[0] == 2e6
    assert found.axial_stiffness[0] == pytest.approx(206e9 * RING, rel=1e-12)


@pytest.mark.parametrize(
    ("weight", "hint"),
    [("18240 N/m", "weight of the whole item"), ("7.3 kg/m", "unit"), ("1267 lb/ft", "whole item|unit")],
)
def test_weights_that_no_item_of_the_size_has(weight: str, hint: str) -> None:
    with pytest.raises(CaseError, match=rf"string\[0\].weight[\s\S]*({hint})"):
        case(JAR | {"kind": "tool", "weight": weight})


@pytest.mark.parametrize("key", [{"material": {"density": 6000}}, {"adjusted_weight": "190 kg/m"}])
def test_one_source_of_the_mass(key: dict[str, Any]) -> None:
    with pytest.raises(CaseError, match="not both"):
        case(JAR | {"kind": "drill_collar", "weight": "1824 N/m"} | key)
    with pytest.raises(CaseError, match="not both"):
        case(
            JAR | {"kind": "rss", "weight": "1824 N/m", "mass": 1860, "rss": {"kind": "point", "tilt": 0.01}}
        )


@pytest.mark.parametrize(("ratio", "doubted"), [(0.55, True), (0.65, False), (1.35, False), (1.45, True)])
def test_a_weight_far_from_a_steel_tube_is_doubted(ratio: float, doubted: bool) -> None:
    weight = f"{ratio * STEEL * RING} kg/m"
    lines = [q for q in plausibility(case(JAR | {"kind": "tool", "weight": weight})) if "steel tube" in q]
    assert bool(lines) is doubted
    if doubted:
        assert f"{ratio:.2g} times" in lines[0] and "string[0]" in lines[0]


def test_swapped_rows_of_a_string_sheet() -> None:
    """Heavyweight pipe's weight on plain pipe: 21,560 kg/m3 (contract, issue 33)."""
    ring = math.pi / 4 * (0.127**2 - 0.1086**2)
    lines = plausibility(
        case({"kind": "pipe", "length": 50, "od": 0.127, "id": 0.1086, "weight": 21560 * ring})
    )
    assert any("2.7 times a steel tube" in line for line in lines)


def test_aluminium_is_as_light_as_it_is() -> None:
    alloy = {"density": 2780.0, "young": 71e9}
    assert not [q for q in plausibility(case(JAR | {"kind": "pipe", "material": alloy})) if "steel tube" in q]
