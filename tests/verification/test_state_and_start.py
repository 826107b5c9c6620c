"""The static state does not depend on its start, nor on whether flow and string are solved together (manual: sec-statics-sequence)."""

from __future__ import annotations

import numpy as np
import pytest

from drillpetsc import Case
from drillpetsc.analysis.statics import flow_coupling, friction_newton
from drillpetsc.analysis.statics.equilibrium import director_equilibrium
from drillpetsc.model.drilling_model import DrillingModel, build_model

FLUID = {
    "density": 1200.0,
    "rheology": {"model": "power_law", "consistency": 0.5, "index": 0.7},
    "flow_rate": 0.03,
}


def well(element: float, fluid: bool = True, **top) -> Case:
    """A string with a collar, a rigid stabiliser and a bit in an S-shaped hole of 1500 m."""
    pipe = {"kind": "pipe", "element_length": element}
    return Case(
        well={
            "survey": {
                "md": [0, 300, 800, 1100, 1500],
                "inclination": np.radians([0, 0, 50, 20, 20]),
                "azimuth": [0, 0, 0.4, 0.8, 0.8],
            },
            "sections": [
                {"to": 700.0, "kind": "casing", "diameter": 0.2244, "friction": 0.2},
                {"to": 1500.0, "kind": "open_hole", "diameter": 0.2159, "friction": 0.25},
            ],
        },
        string=[
            {**pipe, "length": 1409.5, "od": 0.127, "id": 0.1086},
            {**pipe, "length": 60.0, "od": 0.1715, "id": 0.0714},
            {"kind": "stabilizer", "length": 2.0, "od": 0.212, "mass": 300.0},
            {**pipe, "length": 28.0, "od": 0.1715, "id": 0.0714},
            {"kind": "bit", "length": 0.5, "od": 0.2159, "mass": 60.0},
        ],
        top={"kind": "top_drive", **(top or {"rotation": 10.0})},
        bottom={"kind": "bit"},
        gravity=9.81,
        initial={"from": "statics", "wob": 40e3},
        **({"fluid": FLUID} if fluid else {}),
    )


def loads(model: DrillingModel) -> np.ndarray:
    """Hook load [N] and weight on bit [N]."""
    return np.array(
        [
            -model.system.reaction("top.axial_reaction"),
            model.bit.weight_and_torque(model.system.assembly)[0],
        ]
    )


@pytest.mark.parametrize("fluid", [True, False])
@pytest.mark.parametrize("top", [{"rotation": 10.0}, {"lowering": 0.1}, {"lowering": -0.1}])
def test_the_lateral_equilibrium_and_the_march_lead_to_the_same_state(fluid, top, monkeypatch) -> None:
    """Loads to 1e-6, positions to 0.1 mm; with lateral friction where it is reached at all."""
    states = []
    for lateral in (True, False):
        if not lateral:
            monkeypatch.setattr(friction_newton, "lateral_start", lambda *_: None)
        model = build_model(well(3.0, fluid, **top))
        state = director_equilibrium(model)
        assert state.stable and state.equilibrium.converged and state.lateral_fraction == 1.0
        states.append((loads(model), model.system.field("string.position").copy()))
    (a, x), (b, y) = states
    assert b == pytest.approx(a, rel=1e-6)
    assert np.abs(x - y).max() < 1e-4


@pytest.mark.parametrize("flow", [0.0, 0.03])
def test_flow_and_string_together_are_flow_and_string_in_turn(flow, monkeypatch) -> None:
    """The same loads to 1e-9 and flow to 1e-8 of the pressures, in fewer factorisations."""
    case = well(10.0).replace({"fluid.flow_rate": flow})
    out = []
    for together in (True, False):
        if not together:
            monkeypatch.setattr(flow_coupling, "_flow_and_string_together", lambda *_: False)
        model = build_model(case)
        state = director_equilibrium(model)
        out.append((loads(model), model.system.field("bore.pressure").copy(), state.equilibrium.iterations))
    (a, p, few), (b, q, many) = out
    assert a == pytest.approx(b, rel=1e-9)
    assert np.abs(p - q).max() < 1e-8 * np.abs(q).max()
    assert few < many <= 60


def test_an_ordinary_wet_well_takes_at_most_30_steps() -> None:
    """In 300 elements; the flow's first solve takes two more."""
    state = director_equilibrium(build_model(well(5.0)))
    assert state.equilibrium.iterations <= 28
