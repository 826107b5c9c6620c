"""Modes of a string with mud that stands on the bottom of its hole: nothing gives work (manual: sec-eigen-bottom)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.linear.doubts import growth_of_mesh
from drillpetsc.analysis.linear.linearised_model import linearise_model
from drillpetsc.analysis.linear.modal import modes, moment_of, prepare_state, reference_rate
from drillpetsc.model.drilling_model import build_model
from drillpetsc.solvers.linear.linearization import linearise
from drillpetsc.solvers.linear.quadratic_eigenproblem import lowest_eigenvalues
from tests.helpers.wells import newtonian, simple_well


def case(formulation: str, deep: float, flow: float = 0.0, bottom=None, **keys) -> Case:
    """A pipe of 100 m with elements of 10 m in mud, its end near a hole's end at ``deep`` [m]."""
    return Case(
        well=simple_well(deep, 0.2159, friction=0.0),
        string=[{"kind": "pipe", "length": 100.0, "od": 0.127, "id": 0.1086, "element_length": 10.0}],
        top="clamped",
        bottom=bottom or "free",
        contact="none",
        fluid=newtonian(1200.0, 0.03, bulk_modulus=2e9, flow_rate=flow, formulation=formulation),
        gravity=9.81,
        **keys,
    )


@pytest.mark.parametrize(
    ("formulation", "bottom"), [("mixed", "free"), ("hermite", "free"), ("mixed", "bit")]
)
def test_a_closed_bottom_gives_no_work(formulation, bottom):
    """Mud at rest and an elastic string lose energy or keep it: no mode grows, whatever share of the end's face is closed.
    With `mixed` the discrete system alone has growing pairs, in which the bottom gives work; with `hermite` it has none."""
    keys = {"initial": {"wob": 4e3}} if bottom == "bit" else {}
    stands = {"kind": "bit", "stiffness": 4e6, "friction": 0.0} if bottom == "bit" else None
    model = build_model(case(formulation, 100.0, 0.0, stands, **keys))
    prepare_state(model, "rest")
    found = modes(model, 90)
    assert found.frequency.max() > 90.0
    assert found.unstable == 0
    raw = lowest_eigenvalues(linearise(model.system).eigenproblem(reference_rate(model)), 90)
    growth = raw.s.real.max()
    assert growth > 0.5 if formulation == "mixed" else growth < 1e-8


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
    (text,) = growth_of_mesh.sentences(moment_of(warned, found))
    assert f"{growing.min():.4g} Hz" in text
    still = build_model(case("mixed", 100.0))
    prepare_state(still, "rest")
    assert growth_of_mesh.sentences(moment_of(still, modes(still, 40))) == []


def test_shares_of_energy_where_mud_and_steel_move_against_each_other():
    """A plugged pipe, clamped and open at its top: waves of steel a sin(kx) and of mud b cos(qx) meet at the plug.

    a sin kL = b cos qL and EA a k cos kL = K A_i b q sin qL.  The string moves with its mud, the flow is that past the string.
    Of pressures the diagonal of the storage counts, 5/6 of all."""
    length, young, steel, bulk, mud = 100.0, 206e9, 7850.0, 2e9, 1200.0
    wall, bore = np.pi / 4 * (0.127**2 - 0.1086**2), np.pi / 4 * 0.1086**2
    material = {"young": young, "poisson": 0.0, "density": steel}
    pipe = {"kind": "pipe", "length": length, "od": 0.127, "id": 0.1086, "element_length": 2.0}
    model = build_model(
        Case(
            string=[pipe | {"material": material}],
            top="clamped",
            bottom={"kind": "free", "plugged": True},
            gravity=0.0,
            initial={"from": "straight"},
            fluid=newtonian(mud, 0.0, bulk_modulus=bulk, elastic_walls=False, pump_pressure=1e5),
        )
    )
    prepare_state(model)
    found = modes(model, 60)
    x = np.linspace(0.0, length, 10001)
    for rate in (19.730665, 57.998714, 80.657673, 104.079675):
        k, q = rate / np.sqrt(young / steel), rate / np.sqrt(bulk / mud)
        a, b = np.cos(q * length), np.sin(k * length)
        pull, push = young * wall * a * k * np.cos(k * length), bulk * bore * b * q * np.sin(q * length)
        assert pull == pytest.approx(push, rel=1e-5)
        u, past = a * np.sin(k * x), b * np.cos(q * x) - a * np.sin(k * x)
        moved = (steel * wall + mud * bore) * rate**2 * u**2
        string = moved + young * wall * (a * k * np.cos(k * x)) ** 2
        fluid = mud * bore * (rate * past) ** 2 + 5 / 6 * bulk * bore * (b * q * np.sin(q * x)) ** 2
        expected = fluid.sum() / (fluid + string).sum()
        n = int(np.abs(found.frequency - rate / (2 * np.pi)).argmin())
        assert found.frequency[n] == pytest.approx(rate / (2 * np.pi), rel=1e-4)
        assert found.share[n, 3] == pytest.approx(expected, abs=1e-3)
