"""The soft string of statics and limits carries rigid items with their own weight, less the mud that they displace."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.loads.torque_drag.string_rows import rows_at
from drillpetsc.analysis.statics.start.soft_string_start import soft_string
from drillpetsc.model.drilling_model import build_model
from drillpetsc.model.mud_sections import mud_of_rigid_items
from tests.helpers.tables import each_row
from tests.helpers.wells import simple_well

G = 9.80665
OD, ID, STEEL, MUD = 0.127, 0.1086, 7850.0, 1300.0


@each_row("fluid", [None, {"density": MUD, "rheology": {"model": "newtonian", "viscosity": 0.02}}])
@each_row("lean", [0.0, 0.7])
def test_hook_load_of_pipes_with_rigid_items(fluid, lean):
    """Sum of buoyed weights times the cosine of the inclination: metal less mud in its place, for pipes and rigid items.

    A 20 m tool between long elements of pipe, and a bit: the distance of two nodes is not the length of the element there.
    The tool does not stretch.
    """
    string = [
        {"kind": "pipe", "length": 200, "od": OD, "id": ID, "element_length": 25},
        {"kind": "body", "name": "tool", "length": 20, "od": 0.17, "id": 0.07, "mass": 2900},
        {"kind": "pipe", "length": 30, "od": OD, "id": ID, "element_length": 10},
        {"kind": "bit", "length": 0.3, "od": 0.2159, "mass": 60},
    ]
    case = Case(
        well=simple_well(300, 0.2159, lean, friction=0.3),
        string=string,
        top="clamped",
        bottom="free",
        **({} if fluid is None else {"fluid": fluid}),
    )
    steel = np.pi / 4 * (OD**2 - ID**2) * 230 * STEEL + 2960
    share = 1 - (0 if fluid is None else MUD) / STEEL
    soft = soft_string(build_model(case), (0.0, 10.0))
    assert soft is not None
    assert soft.hook_load == pytest.approx(steel * share * G * np.cos(lean), rel=1e-9)
    area = np.pi / 4 * (OD**2 - ID**2)
    pipe, tool = (q * share * G * np.cos(lean) for q in (area * STEEL, 2900))  # N/m, N
    pull = (
        200 * soft.hook_load
        - 200**2 / 2 * pipe
        + 30 * (soft.hook_load - 200 * pipe - tool)
        - 30**2 / 2 * pipe
    )
    # the element above the tool has the mean tension of both
    assert soft.stretch == pytest.approx(pull / (206e9 * area), rel=0.02)
    rows = rows_at(case, case.string_length)  # of the roadmap
    weight = float(rows.weight @ np.diff(rows.edges)) + rows.end_weight
    assert soft.hook_load == pytest.approx(weight * np.cos(lean), rel=1e-9)


@pytest.mark.parametrize("lean", [0.0, 0.9])
def test_a_moment_at_the_end_is_part_of_the_torque(lean):
    """Without friction the top brings -M . t of a moment M on the lower end; the moment was left out."""
    moment = np.array([-300.0, -200.0, -400.0])
    case = Case(
        well=simple_well(300, 0.2159, lean, 0.4, kind="casing", friction=0.0),
        string=[{"kind": "pipe", "length": 250, "od": OD, "id": ID}],
        top={"kind": "top_drive", "rotation": 3.0},
        bottom={"kind": "force", "moment": list(moment)},
    )
    tangent = np.array([np.sin(lean) * np.cos(0.4), np.sin(lean) * np.sin(0.4), np.cos(lean)])
    soft = soft_string(build_model(case), (0.0, 3.0))
    assert soft is not None
    assert soft.surface_torque == pytest.approx(-moment @ tangent, rel=1e-6)


def test_mud_of_rigid_items_counts_in_a_bore_without_an_annulus():
    """Density times the bore of a tool between two pipes; below the last node there is none, as in the equations of the bit's flow."""
    pipe = {"kind": "pipe", "length": 30, "od": OD, "id": ID}
    tool, bit = (
        {"kind": "body", "length": 20, "od": 0.17, "id": 0.07, "mass": 2900},
        {"kind": "bit", "length": 0.3, "od": 0.2},
    )
    case = Case(
        string=[pipe, tool, pipe, bit | {"id": 0.05, "mass": 60}],
        top="clamped",
        bottom="free",
        fluid={"density": MUD, "rheology": {"model": "newtonian", "viscosity": 0.02}, "annulus": False},
    )
    mesh = build_model(case).mesh
    expected = np.zeros(mesh.nodes)
    expected[mesh.bodies[0].node] = MUD * np.pi / 4 * 0.07**2 * 20
    assert mud_of_rigid_items(case, mesh) == pytest.approx(expected, rel=1e-12, abs=1e-9)
