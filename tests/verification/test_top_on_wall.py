"""The top of a string inside the hole lies where nothing pushes it across (manual: sec-statics-top-on-wall)."""

from __future__ import annotations

import numpy as np
import pytest
from petsc4py import PETSc

from drillpetsc import Case
from drillpetsc.analysis.statics.equilibrium import MOTIONS
from drillpetsc.analysis.statics.find_equilibrium import find_equilibrium
from drillpetsc.geometry.frames import high_side
from drillpetsc.model.drilling_model import DrillingModel, build_model
from drillpetsc.output.measured.bending import end_forces

BENDING = 206e9 * np.pi / 64 * (0.127**4 - 0.1086**4)
REACTIONS = ("top.side_reaction_1", "top.side_reaction_2")


def case(element: float, inclination: list[float]) -> Case:
    """1300 m of drill pipe and a bit in a 1500 m hole: its top lies at MD 200 m."""
    md = [0.0, 100.0, 700.0, 1500.0]
    return Case(
        well={
            "survey": {"md": md, "inclination": list(np.radians(inclination)), "azimuth": [0.3] * 4},
            "sections": [{"to": 1500.0, "kind": "open_hole", "diameter": 0.2159, "friction": 0.3}],
        },
        string=[
            {"kind": "pipe", "length": 1299.5, "od": 0.127, "id": 0.1086, "element_length": element},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0},
        ],
        top={"kind": "top_drive"},
        bottom={"kind": "bit"},
        initial={"wob": 20e3},
    )


def solved(element: float, inclination: list[float], motion: str) -> DrillingModel:
    model = build_model(case(element, inclination), PETSc.COMM_WORLD, MOTIONS[motion])
    find_equilibrium(model, MOTIONS[motion])
    return model


@pytest.mark.parametrize("motion", ["rotate", "hoist"])
def test_coarse_mesh_in_a_build(motion):
    """Pipe on the wall of a hole of constant curvature bends as the hole: EI times its curvature, also at the top.

    Held where the march puts it, 10.6 m elements give more than twice this moment, and in a shorter build with more
    tension ten times the moment, 22 kN across and 5 % more torque.
    """
    curvature = np.radians(48.0) / 600.0
    torques = []
    for element in (10.6, 2.65):
        model = solved(element, [0.0, 0.0, 48.0, 48.0], motion)
        top = end_forces(model).moment_size[0, 0]
        assert top == pytest.approx(BENDING * curvature, rel=0.04)
        assert max(abs(model.system.reaction(name)) for name in REACTIONS) < 1.0
        name = "top.torque_reaction" if motion == "rotate" else "top.axial_reaction"
        torques.append(model.system.reaction(name))
    assert torques[0] == pytest.approx(torques[1], rel=0.01)


def test_straight_inclined_hole():
    """A turning pipe lies at the angle of friction up the wall, at its top as well."""
    model = solved(10.6, [40.0, 40.0, 40.0, 40.0], "rotate")
    assert max(abs(model.system.reaction(name)) for name in REACTIONS) < 0.1
    centre, tangent, _ = (np.asarray(q)[0] for q in model.well.at(np.array([200.0])))
    offset = model.system.field("string.position")[0] - centre
    up = high_side(tangent)
    angle = np.arctan2(abs(offset @ np.cross(tangent, up)), -offset @ up)
    assert np.tan(angle) == pytest.approx(0.3, rel=0.01)


def test_a_place_that_is_not_found_is_said(monkeypatch):
    """The state is then that of the top where the march put it, and a warning says so."""
    monkeypatch.setattr("drillpetsc.analysis.statics.equilibrium.balance_across", lambda *arguments: False)
    model = build_model(case(10.6, [0.0, 0.0, 48.0, 48.0]), PETSc.COMM_WORLD, MOTIONS["hoist"])
    state = find_equilibrium(model, MOTIONS["hoist"])
    assert any("held on the wall" in line for line in state.warnings)
