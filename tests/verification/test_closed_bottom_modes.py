"""Modes of a string with mud that stands on the bottom of its hole: nothing gives work (manual: sec-eigen-bottom)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.linear.doubts import GrowthOfMesh
from drillpetsc.analysis.linear.linearised_model import linearise_model
from drillpetsc.analysis.linear.modal import modes, moment_of, prepare_state, reference_rate
from drillpetsc.model.drilling_model import build_model
from drillpetsc.solvers.linear.linearization import linearise
from drillpetsc.solvers.linear.quadratic_eigenproblem import lowest_eigenvalues
from tests.helpers.wells import simple_well


def case(formulation: str, deep: float, flow: float = 0.0, bottom=None, **keys) -> Case:
    """A pipe of 100 m with elements of 10 m in mud, its end near a hole's end at ``deep`` [m]."""
    return Case(
        well=simple_well(deep, 0.2159, friction=0.0),
        string=[{"kind": "pipe", "length": 100.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}],
        top="clamped",
        bottom=bottom or "free",
        contact="none",
        fluid={
            "density": 1200.0,
            "rheology": {"model": "newtonian", "viscosity": 0.03},
            "bulk_modulus": 2e9,
            "flow_rate": flow,
            "formulation": formulation,
        },
        gravity=9.81,
        **keys,
    )


@pytest.mark.parametrize(
    ("formulation", "bottom"), [("mixed", "free"), ("hermite", "free"), ("mixed", "bit")]
)
def test_a_closed_bottom_gives_no_work(formulation, bottom):
    """Mud at rest and an elastic string lose energy or keep it: no mode grows, whatever share of the end's face is closed.
    The discrete system alone has growing pairs, in which the bottom gives work."""
    keys = {"initial": {"wob": 4e3}} if bottom == "bit" else {}
    stands = {"kind": "bit", "stiffness": 4e6, "friction": 0.0} if bottom == "bit" else None
    model = build_model(case(formulation, 100.0, 0.0, stands, **keys))
    prepare_state(model, "rest")
    found = modes(model, 90)
    assert found.frequency.max() > 90.0
    assert found.unstable == 0
    raw = lowest_eigenvalues(linearise(model.system).eigenproblem(reference_rate(model)), 90)
    assert raw.s.real.max() > 0.5


def test_the_force_is_that_of_the_face_over_which_mud_is_displaced():
    """The gap is half a rounding length: the closed share of the hole's area is 1/(1 + exp(1/2))."""
    model = build_model(case("mixed", 100.0))
    prepare_state(model, "rest")
    model.fluid.bit._block.named["end"] += np.array(
        [0.0, 0.0, model.system.field("string.position")[-1, 2] + 5e-4 - 100.0]
    )
    full, part = linearise(model.system), linearise_model(model)
    change = (full.K - part.K).tocoo()
    kept = np.abs(change.data) > 0
    area = np.pi / 4 * 0.2159**2 / (1 + np.exp(0.5))
    assert change.data[kept] == pytest.approx([area], rel=1e-6)
    names = [f.name for f in model.system.layout.fields]
    row, column = change.row[kept][0], change.col[kept][0]
    assert (names[full.field[row]], names[full.field[column]]) == ("string.position", "annulus.pressure")
    assert full.node[row] == full.node[column] == model.mesh.nodes - 1


def test_growth_that_the_mesh_does_not_resolve_is_named():
    """With flow, elements of 10 m let axial modes of one element per wave grow; the warning has their frequency.  A string
    of the same mesh without growing modes has none."""
    warned = build_model(case("mixed", 100.0, 0.03))
    prepare_state(warned, "rest")
    found = modes(warned, 110)
    growing = found.frequency[found.growth > 1e-3]
    assert len(growing) and growing.min() > 300.0
    (text,) = GrowthOfMesh().sentences(moment_of(warned, found))
    assert f"{growing.min():.4g} Hz" in text
    still = build_model(case("mixed", 100.0))
    prepare_state(still, "rest")
    assert GrowthOfMesh().sentences(moment_of(still, modes(still, 40))) == []
